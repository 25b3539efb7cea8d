//! Fixtures: a database as each released version left it opens, is migrated, and holds what it held.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::Path;

use flate2::read::GzDecoder;
use serde_json::Value;

use super::{keyframe, sound};
use crate::support::{Server, assert_part_of};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/databases");

/// The fixtures by name: the database, unpacked.
pub(super) fn databases() -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path());
    let packed = entries.filter_map(|path| {
        let name = path.file_name()?.to_str()?.strip_suffix(".db.gz")?.to_owned();
        assert!(path.metadata().unwrap().len() < 100_000, "{name} is too large to be kept");
        let mut bytes = Vec::new();
        GzDecoder::new(std::fs::File::open(&path).unwrap()).read_to_end(&mut bytes).unwrap();
        Some((name, bytes))
    });
    packed.collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_of_each_released_version_opens_and_says_what_it_said() {
    let databases = databases();
    assert!(
        ["0001_facts", "0002_models"].iter().all(|name| databases.contains_key(*name)),
        "{:?}",
        databases.keys()
    );
    for (name, bytes) in databases {
        let folder = tempfile::tempdir().unwrap();
        let database = folder.path().join("test.db");
        std::fs::write(&database, bytes).unwrap();
        let before = sound(&database).await;
        let schema = before.holds.unwrap().schema;
        assert!(name.starts_with(&format!("{schema:04}_")), "{name} has schema {schema}");

        let server = Server::on(folder.path()).await;
        let answers = std::fs::read(Path::new(FOLDER).join(format!("{name}.json"))).unwrap();
        let answers: BTreeMap<String, Value> = serde_json::from_slice(&answers).unwrap();
        assert!(answers.len() >= 5);
        for (path, then) in answers {
            let now = server.get(&path).await.expect(200);
            assert_part_of(&then, &now, usize::eq, &format!("{name}: {path}"));
        }
        // And it is not only to be looked at.
        server.put("/v1/maps/tower/keyframes/new?query=loop", &keyframe("day-3", 2)).await.expect(201);
        server.stop().await;
        let after = sound(&database).await;
        assert!(!after.is_older && after.maps.len() == 2, "{name}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_from_before_history_was_kept_is_exported_as_it_was_then_and_plays() {
    for (name, bytes) in databases() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("test.db"), bytes).unwrap();
        let server = Server::on(folder.path()).await;
        let keyframes = server.get("/v1/maps/tower").await.expect(200)["keyframes"].clone();
        server.stop().await;
        let database = format!("sqlite://{}/test.db", folder.path().display());
        let recording = folder.path().join("tower.ndjson");
        let recording = recording.to_str().unwrap();
        run(&["export", "tower", recording, "--database", &database]).await;
        let played: Value = serde_json::from_str(&run(&["replay", recording, "--json"]).await).unwrap();
        assert_eq!(played["keyframes"], keyframes, "{name}");
        assert!(played["closed_loops"].as_u64().unwrap() > 0, "{name}: {played}");
    }
}

/// Runs the program, and returns what it says.
async fn run(args: &[&str]) -> String {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_revisit"));
    command.args(args);
    let output = tokio::task::spawn_blocking(move || command.output().unwrap()).await.unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
