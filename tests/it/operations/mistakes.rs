//! What operators mistype or forget, and what they are told.

use std::os::unix::fs::PermissionsExt as _;

use serde_json::json;

use super::{Places, names, revisit, url};
use crate::crash::server::Server;

#[test]
fn a_mistyped_database_or_filter_is_refused_and_makes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("nope.db").display().to_string();
    for database in [missing.clone(), format!("sqlite:{missing}"), format!("sqlite://{missing}")] {
        revisit(&["keys", "list", "--database", &database]).refused("there is no database");
        revisit(&["keys", "revoke", "key-1", "--database", &database]).refused("there is no database");
    }
    for database in ["", "sqlite://", "mysql://host/base"] {
        revisit(&["serve", "--listen", "127.0.0.1:0", "--database", database]).refused("names no database");
    }
    for filter in ["warning", "verbose", "info;debug", "warn,revisit=loud"] {
        revisit(&["serve", "--listen", "127.0.0.1:0", "--log", filter, "--database", &missing])
            .refused("has no level");
    }
    assert!(names(folder.path()).is_empty(), "{:?}", names(folder.path()));
}

#[cfg(feature = "hotel")]
#[test]
fn a_demo_listens_on_its_own_machine_and_keeps_its_data_in_a_new_folder() {
    let folder = tempfile::tempdir().unwrap();
    revisit(&["demo", "--listen", "0.0.0.0:0"]).refused("give 127.0.0.1");
    revisit(&["demo", "--keep", folder.path().to_str().unwrap()]).refused("--keep takes a new folder");
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_database_that_cannot_be_opened_is_named_and_nothing_is_left_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    std::fs::write(place("letter.db"), "Dear Sir or Madam, ".repeat(100)).unwrap();
    std::fs::create_dir(place("folder.db")).unwrap();
    let before = names(folder.path());
    for (name, because) in [
        ("letter.db", "not a database"),
        ("folder.db", "is not a regular file"),
        ("nowhere/new.db", "No such file or directory"),
    ] {
        for command in [&["serve", "--listen", "127.0.0.1:0"][..], &["keys", "create"]] {
            let database = url(&place(name));
            let ran = revisit(&[command, &["--database", &database]].concat());
            assert!(ran.err.contains(name) && !ran.err.contains(".lock"), "{name}: {ran:?}");
            ran.refused(because);
            assert_eq!(names(folder.path()), before, "{name}");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_database_is_its_owners_only_and_a_restore_tells_which_keys_are_good_again() {
    let at = Places::new();
    for name in ["robots", "guests"] {
        revisit(&["keys", "create", "--name", name, "--actions", "read", "--database", &url(&at.database)])
            .well();
    }
    revisit(&["keys", "revoke", "key-2", "--database", &url(&at.database)]).well();
    at.run("backup", &[]).well();
    revisit(&["keys", "revoke", "key-1", "--database", &url(&at.database)]).well();
    let told = at.run("restore", &["--force"]).well();
    assert!(
        told.contains("key-1 \"robots\" is not revoked in the backup") && !told.contains("guests"),
        "{told}"
    );

    let fresh = at.folder.path().join("fresh.db");
    let mut server = Server::start(&fresh);
    assert_eq!(server.api().put("/v1/maps/m", &json!({})).await.status, 201);
    for name in names(at.folder.path()).iter().filter(|name| name.contains(".db")) {
        let mode = std::fs::metadata(at.folder.path().join(name)).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode, 0o600, "{name}");
    }
    assert!(server.terminate().success());
}
