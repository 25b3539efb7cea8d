//! Metrics: the dashboard asks for what there is, and labels stay few.

use std::collections::BTreeSet;

use serde_json::Value;

use super::keyframe;
use crate::support::Server;

const DASHBOARD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docker/grafana/revisit.json");
const ALERTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docker/prometheus/alerts.yml");

async fn metrics(server: &Server) -> String {
    let answer = server.request(reqwest::Method::GET, "/metrics").send().await.unwrap();
    assert_eq!(answer.status(), 200);
    answer.text().await.unwrap()
}

/// Every expression of the dashboard.
fn expressions(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            for (name, value) in members {
                match (name.as_str(), value) {
                    ("expr" | "query" | "definition", Value::String(text)) => found.push(text.clone()),
                    _ => expressions(value, found),
                }
            }
        }
        Value::Array(items) => items.iter().for_each(|item| expressions(item, found)),
        _ => {}
    }
}

/// The names in an expression that begin like ours.
fn names(expression: &str) -> impl Iterator<Item = &str> {
    let words = expression.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
    words.filter(|word| word.starts_with("revisit_"))
}

#[tokio::test(flavor = "multi_thread")]
async fn the_dashboard_and_the_alerts_ask_for_metrics_and_labels_that_there_are() {
    let server = Server::with_map("tower").await;
    server.put("/v1/maps/tower/keyframes/kf-1?query=loop", &keyframe("a", 1)).await.expect(201);
    server.get("/nothing").await.expect(404);
    let text = metrics(&server).await;
    let there: BTreeSet<&str> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split([' ', '{']).next())
        .collect();
    let dashboard: Value = serde_json::from_slice(&std::fs::read(DASHBOARD).unwrap()).unwrap();
    let mut asked = Vec::new();
    expressions(&dashboard, &mut asked);
    let alerts = std::fs::read_to_string(ALERTS).unwrap();
    asked.extend(alerts.lines().filter_map(|line| Some(line.trim().strip_prefix("expr: ")?.to_owned())));
    let mut used = BTreeSet::new();
    for expression in &asked {
        for name in names(expression) {
            assert!(there.contains(name), "{name} of {expression} is not told");
            used.insert(name);
        }
        for label in
            expression.split(" by (").skip(1).flat_map(|rest| rest.split(')').next().unwrap().split(','))
        {
            let label = label.trim();
            assert!(label == "instance" || text.contains(&format!("{label}=\"")), "{label} of {expression}");
        }
    }
    assert!(asked.len() >= 15 && used.len() >= 15, "{used:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_thousand_names_make_no_more_labels_than_one() {
    let server = Server::start().await;
    for number in 0..40 {
        server.get(&format!("/v1/maps/map-{number}")).await.expect(404);
        server.get(&format!("/somewhere/{number}")).await.expect(404);
    }
    let text = metrics(&server).await;
    let counted: Vec<&str> =
        text.lines().filter(|line| line.starts_with("revisit_http_requests_total")).collect();
    assert_eq!(counted.len(), 2, "{counted:#?}");
    assert!(counted.iter().all(|line| line.ends_with(" 40")), "{counted:#?}");
    for told in ["revisit_open_fds ", "revisit_resident_memory_bytes ", "revisit_database_bytes "] {
        let line = text.lines().find_map(|line| line.strip_prefix(told)).unwrap();
        assert_ne!(line, "0", "{told}");
    }
}
