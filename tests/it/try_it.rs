//! Every "Try it" of `/docs` is run in the page's order against a fresh server. The commands are made by the page's own
//! scripts, as the server serves them.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};

use reqwest::Method;
use serde::Deserialize;
use serde_json::Value;
use tokio::task::spawn_blocking;

use crate::support::{Answer, Server};

/// The scripts that make the commands.
const SCRIPTS: [&str; 5] = ["docs_start.js", "docs_try.js", "docs_schema.js", "docs_prose.js", "dom.js"];

/// One "Try it" of the page.
#[derive(Clone, Debug, Deserialize)]
struct TryIt {
    id: String,
    text: String,
    /// The refusal that the page announces for a server without options.
    status: Option<u16>,
}

/// What a "Try it" printed: the status of each answer, and the body of the last one.
#[derive(Debug)]
struct Printed {
    statuses: Vec<u16>,
    body: String,
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs node and curl"]
async fn every_try_it_of_the_docs_works_in_the_pages_order_on_a_fresh_server() {
    let server = Server::start().await;
    let folder = tempfile::tempdir().unwrap();
    fetch_scripts(&server, folder.path()).await;
    let page = page(&server, folder.path(), false).await;
    assert!(page.len() > 35, "{page:#?}");
    assert_eq!(page[2].id, "start_ask", "the three calls come first");
    let mut key = String::new();
    for try_it in &page {
        let printed = run(try_it, folder.path(), &key).await;
        let (last, before) = printed.statuses.split_last().unwrap_or_else(|| panic!("{try_it:#?}"));
        assert!(before.iter().all(|status| (200..300).contains(status)), "{try_it:#?}\n{printed:#?}");
        match try_it.status {
            Some(announced) => assert_eq!(*last, announced, "{try_it:#?}"),
            None => assert!((200..300).contains(last), "{}\n{printed:#?}", try_it.text),
        }
        match &*try_it.id {
            "start_ask" => {
                let answer: Value = serde_json::from_str(&printed.body).unwrap();
                let [verdict, best] = [&answer["loop"]["verdict"], &answer["loop"]["best"]];
                assert_eq!(
                    [verdict, best],
                    ["loop", "kf-1"],
                    "the three calls at the top of the page find a loop"
                );
            }
            "query_loop" => {
                let answer: Value = serde_json::from_str(&printed.body).unwrap();
                assert_eq!([&answer["verdict"], &answer["best"]], ["loop", "kf-3"], "the page tells a story");
            }
            "confirm_loop" => assert!(printed.body.contains(r#""warnings":[]"#), "{printed:?}"),
            "create_key" => {
                let made: Value = serde_json::from_str(&printed.body).unwrap();
                key = made["secret"].as_str().unwrap().to_owned();
            }
            _ => {}
        }
    }
    // The page of a server that wants a key sends it everywhere.
    assert!(!key.is_empty());
    let keyed = self::page(&server, folder.path(), true).await;
    let lists =
        keyed.iter().filter(|try_it| ["list_maps", "list_backups", "get_usage"].contains(&&*try_it.id));
    for try_it in lists {
        assert_eq!(run(try_it, folder.path(), &key).await.statuses, [200], "{try_it:#?}");
        assert_eq!(run(try_it, folder.path(), "nonsense").await.statuses, [401], "{try_it:#?}");
    }
}

async fn fetch_scripts(server: &Server, folder: &Path) {
    let script =
        async |name: &str| Answer::text(server.request(Method::GET, &format!("/assets/{name}"))).await;
    assert!(script("docs.js").await.contains("commands.of(id)"), "the page shows what these scripts make");
    std::fs::write(folder.join("package.json"), r#"{"type": "module"}"#).unwrap();
    for name in SCRIPTS {
        std::fs::write(folder.join(name), script(name).await).unwrap();
    }
}

/// The page's commands, in its order.
async fn page(server: &Server, folder: &Path, keyed: bool) -> Vec<TryIt> {
    let document = Answer::text(server.request(Method::GET, "/openapi.json")).await;
    let program = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/docs/commands.mjs");
    let mut node = Command::new("node");
    node.arg(program).arg(folder).arg(server.url("/")).arg(keyed.to_string());
    let made = spawn_blocking(move || {
        let mut child = node.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(document.as_bytes()).unwrap();
        child.wait_with_output().unwrap()
    });
    let made = made.await.unwrap();
    assert!(made.status.success(), "{made:?}");
    let lines = String::from_utf8(made.stdout).unwrap();
    lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Pastes a "Try it" into a shell. Curl also prints the head of each answer; of a stream only its first line is read.
async fn run(try_it: &TryIt, folder: &Path, key: &str) -> Printed {
    let is_stream = try_it.text.contains("curl -N");
    let script = if is_stream {
        try_it.text.replacen("curl ", "exec curl -sS -D - ", 1)
    } else {
        format!("curl() {{ command curl -sS -D - \"$@\"; }}\n{}", try_it.text)
    };
    let mut shell = Command::new("sh");
    shell.args(["-c", &script]).current_dir(folder).env("REVISIT_KEY", key).stdout(Stdio::piped());
    let printed = spawn_blocking(move || {
        let mut child = shell.spawn().unwrap();
        if !is_stream {
            return child.wait_with_output().unwrap().stdout;
        }
        let mut line = Vec::new();
        BufReader::new(child.stdout.take().unwrap()).read_until(b'\n', &mut line).unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
        line
    });
    let printed = String::from_utf8_lossy(&printed.await.unwrap()).into_owned();
    let heads = printed.lines().filter_map(|line| line.strip_prefix("HTTP/1.1 "));
    let statuses = heads.map(|rest| rest[..3].parse().unwrap()).collect();
    let body = printed.rsplit("\r\n\r\n").next().unwrap_or_default().to_owned();
    Printed { statuses, body }
}
