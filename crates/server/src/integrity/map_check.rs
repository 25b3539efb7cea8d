//! One map: can its index be built, from facts told in either order, and are its numbers dense?

use serde::Serialize;

use super::rebuild::{RebuiltMap, rebuild};
use crate::domain::ids::MapId;
use crate::domain::map::MapFigures;
use crate::recognition::loops::features::MatchableFeatures;
use crate::recognition::map::index::MapIndex;
use crate::store::{Inspected, MapFacts, Order, RowFindings, StoreError};

/// The most faults that are listed of one map: a torn table has one in every row.
const MAP_FAULTS_MAX: usize = 100;

/// Findings in a map.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MapCheck {
    /// Its name.
    pub id: String,
    /// Its version.
    #[serde(rename = "map_version")]
    pub version: u64,
    /// Its keyframes.
    pub keyframes: u64,
    /// Its anchors, those that are one counted once.
    pub anchors: u64,
    /// Its confirmed loops.
    pub loops: u64,
    /// Its events that are kept.
    pub events: u64,
    /// Its faults.
    pub faults: Vec<String>,
}

/// Checks a map within a read transaction.
pub(super) async fn check(db: &mut Inspected, id: &MapId) -> MapCheck {
    let mut found = MapCheck { id: id.to_string(), ..MapCheck::default() };
    match rebuild(&mut *db, id, Order::Forwards).await {
        Ok(Some(RebuiltMap { facts, index })) => check_loaded(db, id, &facts, &index, &mut found).await,
        Ok(None) => {
            found.faults.push("it is in the list of maps, but cannot be found by its name".to_owned());
        }
        Err(error) => found.faults.push(error.fault()),
    }
    found.faults.truncate(MAP_FAULTS_MAX);
    found
}

async fn check_loaded(
    db: &mut Inspected,
    id: &MapId,
    facts: &MapFacts,
    index: &MapIndex,
    found: &mut MapCheck,
) {
    found.version = facts.version;
    found.keyframes = index.keyframe_count() as u64;
    found.anchors = index.objects().len() as u64;
    found.loops = index.loops().len() as u64;
    figure_faults(facts.figures, index.figures(), &mut found.faults);
    if facts.learned != index.learned() {
        found.faults.push("its numbering or twins, as shown, are not those of its facts".to_owned());
    }
    if let Err(error) = law(db, id, index, &mut found.faults).await {
        found.faults.push(format!("told backwards: {}", error.fault()));
    }
    let mut rows = RowFindings::default();
    let fit = |features| MatchableFeatures::of(features).is_some();
    let checked = db.check_rows(facts, fit, &mut rows).await;
    found.events = rows.events;
    found.faults.extend(rows.faults);
    if let Err(error) = checked {
        found.faults.push(error.fault());
    }
}

/// Checks the law that can be proven from the disk alone: the same facts make the same index in whatever order they are told.
async fn law(
    db: &mut Inspected,
    id: &MapId,
    forwards: &MapIndex,
    faults: &mut Vec<String>,
) -> Result<(), StoreError> {
    let backwards = rebuild(db, id, Order::Backwards).await?;
    if backwards.is_none_or(|backwards| backwards.index != *forwards) {
        faults.push("its index depends on the order in which its facts are told".to_owned());
    }
    Ok(())
}

/// Notes which figures of the map's row are not those of its facts.
fn figure_faults(shown: MapFigures, held: MapFigures, faults: &mut Vec<String>) {
    let figures = [
        ("keyframes", shown.keyframes, held.keyframes),
        ("anchors", shown.anchors, held.anchors),
        ("sessions", shown.sessions, held.sessions),
        ("loops", shown.loops, held.loops),
        ("bytes", shown.bytes, held.bytes),
    ];
    let wrong = figures.into_iter().filter(|(_, shown, held)| shown != held);
    faults.extend(
        wrong.map(|(what, shown, held)| format!("lists of maps show {shown} {what}, and it holds {held}")),
    );
}
