//! One map: can its index be built, from facts told in either order, and are its numbers dense?

use sqlx::SqliteConnection;

use super::{MAP_FAULTS_MAX, rows};
use crate::domain::ids::MapId;
use crate::domain::map::MapFigures;
use crate::store::StoreError;
use crate::store::rows::load::{Loaded, Order, load};

/// What was found in a map.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MapCheck {
    /// Its name.
    pub id: String,
    /// Its version.
    pub version: u64,
    /// Its keyframes.
    pub keyframes: u64,
    /// Its anchors, those that are one counted once.
    pub anchors: u64,
    /// Its confirmed loops.
    pub loops: u64,
    /// Its events that are kept.
    pub events: u64,
    /// What is wrong with it.
    pub faults: Vec<String>,
}

/// Checks a map within a read transaction.
pub(super) async fn check(db: &mut SqliteConnection, id: &MapId) -> MapCheck {
    let mut found = MapCheck { id: id.to_string(), ..MapCheck::default() };
    match load(&mut *db, id, Order::Forwards).await {
        Ok(Some(loaded)) => {
            found.version = loaded.version;
            found.keyframes = loaded.index.keyframe_count() as u64;
            found.anchors = loaded.index.objects().len() as u64;
            found.loops = loaded.index.loops().len() as u64;
            figure_faults(loaded.figures, loaded.index.figures(), &mut found.faults);
            if loaded.learned.as_ref().is_some_and(|shown| *shown != loaded.index.learned()) {
                found.faults.push("its numbering or twins, as shown, are not those of its facts".to_owned());
            }
            if let Err(error) = law(&mut *db, id, &loaded, &mut found.faults).await {
                found.faults.push(format!("told backwards: {}", error.fault()));
            }
            if let Err(error) = rows::check(&mut *db, &loaded, &mut found).await {
                found.faults.push(error.fault());
            }
        }
        Ok(None) => {
            found.faults.push("it is in the list of maps, but cannot be found by its name".to_owned());
        }
        Err(error) => found.faults.push(error.fault()),
    }
    found.faults.truncate(MAP_FAULTS_MAX);
    found
}

/// The law that can be proven from the disk alone: the same facts make the same index in whatever order they are told.
async fn law(
    db: &mut SqliteConnection,
    id: &MapId,
    loaded: &Loaded,
    faults: &mut Vec<String>,
) -> Result<(), StoreError> {
    let backwards = load(db, id, Order::Backwards).await?;
    if backwards.is_none_or(|backwards| backwards.index != loaded.index) {
        faults.push("its index depends on the order in which its facts are told".to_owned());
    }
    Ok(())
}

/// Tells which figures of the map's row are not those of its facts.
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
