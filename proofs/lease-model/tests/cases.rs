//! The protocol holds for two nodes, and each part that is left out is missed.

use revisit_lease_model::cases::{Case, faulty, harmless, protocol};
use revisit_lease_model::cluster::Cluster;

fn check(case: &Case) {
    let outcome = case.run();
    assert!(outcome.is_expected, "{}: {:?}", case.name, outcome.found);
}

#[test]
fn the_protocol_holds_for_two_nodes() {
    let case = protocol(&[])[0];
    check(&Case { cluster: Cluster { nodes: 2, ..case.cluster }, ..case });
    harmless().iter().for_each(check);
}

#[test]
fn each_part_that_is_left_out_is_missed() {
    faulty().iter().for_each(check);
}
