//! The README's commands are run, and their answers are those that it shows.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::support::Server;

const SHOWN_ADDRESS: &str = "http://127.0.0.1:7878";

/// The fenced blocks of the README, with their language.
fn blocks() -> Vec<(String, String)> {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let mut blocks = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in readme.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(language), None) => open = Some((language.to_owned(), String::new())),
            (None, Some((_, text))) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    blocks
}

/// The shown answer is a part of the real one: it may leave members out, and say so with "...".
fn shows(shown: &Value, real: &Value, at: &str) {
    match (shown, real) {
        (Value::Object(shown), Value::Object(real)) => {
            for (name, value) in shown {
                shows(value, real.get(name).unwrap_or(&Value::Null), &format!("{at}/{name}"));
            }
        }
        (Value::Array(shown), Value::Array(real)) => {
            assert!(shown.len() <= real.len(), "{at}");
            shown.iter().zip(real).enumerate().for_each(|(n, (s, r))| shows(s, r, &format!("{at}/{n}")));
        }
        _ => assert_eq!(shown, real, "{at}"),
    }
}

#[tokio::test]
async fn the_curls_of_the_readme_get_the_answers_it_shows() {
    assert!(Command::new("curl").arg("--version").output().is_ok(), "the README's commands need curl");
    let server = Server::start().await;
    let mut asked = 0;
    let mut answer: Option<Value> = None;
    for (language, text) in blocks() {
        if language == "sh" && text.contains("curl ") {
            let command = text.replace(SHOWN_ADDRESS, &server.url("")).replace("curl ", "curl -s ");
            let run = move || Command::new("sh").arg("-c").arg(command).output();
            let output = tokio::task::spawn_blocking(run).await.unwrap().unwrap();
            answer = serde_json::from_slice(&output.stdout).ok();
            assert!(answer.is_some(), "{text}\n{}", String::from_utf8_lossy(&output.stdout));
            asked += 1;
        }
        if let (true, Some(answer)) = (language == "json", answer.take()) {
            shows(&serde_json::from_str(&text).unwrap(), &answer, "");
        }
    }
    assert_eq!(asked, 4, "four curls are the newcomer's first five minutes");
}
