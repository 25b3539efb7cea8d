//! Placement: the server that should have a map, by rendezvous hashing (Thaler and Ravishankar, "Using Name-Based Mappings to
//! Increase Hit Rates", IEEE/ACM Transactions on Networking 6(1), 1998).
//!
//! Every server computes the same from the list of servers that are there. When one joins, it takes its share of the maps and
//! no other map moves; when one goes, only its own maps move.

use crate::domain::ids::MapId;
use crate::store::Node;

/// Returns the one of these servers that should have a map; its releases are where it is. `None` of none.
pub(super) fn placed<'n>(nodes: impl IntoIterator<Item = &'n Node>, map: &MapId) -> Option<&'n Node> {
    nodes.into_iter().max_by_key(|node| (weight(node, map), &node.id))
}

fn weight(node: &Node, map: &MapId) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(node.id.as_bytes());
    // No id has this byte, so that two pairs are never the same text.
    hasher.update(b"/");
    hasher.update(map.parts().0.as_bytes());
    *hasher.finalize().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(number: usize) -> Node {
        Node { id: format!("node-{number}"), address: String::new(), secret: String::new() }
    }

    fn maps() -> Vec<MapId> {
        (0..300).map(|number| format!("map-{number}").parse().expect("an id")).collect()
    }

    #[test]
    fn a_server_that_joins_takes_its_share_and_moves_no_other_map() {
        let (two, three) = ([node(0), node(1)], [node(0), node(1), node(2)]);
        let mut moved = 0;
        for map in maps() {
            let (before, after) = (placed(&two, &map).expect("one"), placed(&three, &map).expect("one"));
            if before != after {
                assert_eq!(after.id, "node-2");
                moved += 1;
            }
        }
        assert!((70..130).contains(&moved), "{moved} of 300 moved to the third of three");
    }

    #[test]
    fn every_server_computes_the_same_whatever_order_it_knows_the_others_in() {
        let (one, other) = ([node(0), node(1), node(2)], [node(2), node(0), node(1)]);
        for map in maps() {
            assert_eq!(placed(&one, &map), placed(&other, &map));
            let release = MapId::of_release(&map, &"v1".parse().expect("a name"));
            assert_eq!(placed(&one, &map), placed(&one, &release), "a release is where its map is");
        }
        assert!(placed(&[] as &[Node], &maps()[0]).is_none());
    }
}
