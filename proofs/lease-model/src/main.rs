//! Runs all cases and prints their figures; fails if one has another outcome than it must have.

use std::io::Write as _;
use std::process::ExitCode;

use revisit_lease_model::cases::{Case, Expected, LONG, SHORT, faulty, harmless, protocol};
use revisit_lease_model::rules::{LEASE, Limits, Rules};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let two_maps = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => LONG.to_vec(),
        ["--short"] => vec![SHORT],
        _ => {
            eprintln!("usage: proofs/lease [--short]");
            return ExitCode::from(2);
        }
    };
    println!(
        "a lease of {LEASE} ticks, which a node's own clock ends {} tick earlier",
        Rules::PROTOCOL.margin
    );
    let cases: Vec<Case> = [protocol(&two_maps), harmless(), faulty()].concat();
    let unexpected = cases.iter().filter(|case| !is_expected(case)).count();
    println!("{} runs, {unexpected} with another outcome than expected", cases.len());
    ExitCode::from(u8::from(unexpected > 0))
}

/// Runs a case and prints it.
fn is_expected(case: &Case) -> bool {
    let cluster = &case.cluster;
    print!("\n{}, nodes: {}, maps: {}, {}", case.name, cluster.nodes, cluster.maps, limits(cluster.limits));
    let _ = std::io::stdout().flush();
    let outcome = case.run();
    println!("\n  {} states, {} steps, {:.1} s", outcome.states, outcome.steps, outcome.seconds);
    for (property, path) in &outcome.found {
        let verb = if case.expected == Expected::Occurs { "occurs" } else { "VIOLATED" };
        println!("  {verb}: {property}\n{}", path.trim_end());
    }
    if outcome.found.is_empty() {
        println!("  all properties hold");
    }
    if !outcome.is_expected {
        println!("  FAILED: expected {:?}", case.expected);
    }
    outcome.is_expected
}

fn limits(limits: Limits) -> String {
    if limits == Limits::NONE {
        return "without limit of time, take-overs, writes and failures".to_owned();
    }
    format!(
        "at most {} take-overs, {} writes and {} failures in all, any time",
        limits.take_overs, limits.writes, limits.failures
    )
}
