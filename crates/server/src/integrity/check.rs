//! Check: is a database whole, and does every map in it hold the law?
//!
//! Nothing is written. What it cannot find: writes that a shortened log no longer holds, once its index is deleted; a value
//! that was replaced by another one that could have stood there, as SQLite keeps no checksums; a last detection or a
//! setting that is missing without a trace.

use super::map_check::{self, MapCheck};
use crate::store::files::paths::DatabaseFiles;
use crate::store::{Holdings, Inspected, Inspection, StoreError, newest_schema};

/// Findings in a database.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IntegrityReport {
    /// Its contents, if they can be counted.
    pub holds: Option<Holdings>,
    /// Faults of the database as a whole.
    pub faults: Vec<String>,
    /// Limits of the check; they are no faults.
    pub notes: Vec<String>,
    /// Each map, by name.
    pub maps: Vec<MapCheck>,
    /// The schema's version, if it is newer than this program's: nothing but the structure was looked into.
    pub(super) newer: Option<i64>,
}

impl IntegrityReport {
    /// Returns every fault, those of a map under its name.
    pub fn all_faults(&self) -> impl Iterator<Item = String> + '_ {
        let of_maps = self.maps.iter().flat_map(|map| {
            let id = &map.id;
            map.faults.iter().map(move |fault| format!("map {id}: {fault}"))
        });
        self.faults.iter().cloned().chain(of_maps)
    }
}

/// Checks the database, also beside a running server, in one read transaction. Fails if there is nothing to look at.
///
/// `check`, `backup` and `restore` share it: a file that it finds faults in is not restored, and no backup of that content
/// is called verified.
pub async fn check(files: &DatabaseFiles) -> Result<IntegrityReport, StoreError> {
    match check_any_schema(files).await? {
        IntegrityReport { newer: Some(found), .. } => {
            Err(StoreError::Newer { found, known: newest_schema() })
        }
        checked => Ok(checked),
    }
}

/// Checks a database of any version; maps of a newer one are not looked into.
pub(super) async fn check_any_schema(files: &DatabaseFiles) -> Result<IntegrityReport, StoreError> {
    let inspection = Inspection::of(files)?;
    let mut db = match inspection.open().await {
        Ok(db) => db,
        Err(error) => {
            return Ok(IntegrityReport { faults: vec![error.to_string()], ..IntegrityReport::default() });
        }
    };
    let mut checked = IntegrityReport::default();
    if let Err(error) = check_all(&mut db, &mut checked).await {
        checked.faults.push(error.to_string());
    }
    if checked.holds.is_some() {
        note(&mut checked.faults, inspection.wrong_length(&mut db).await);
    }
    db.close().await?;
    checked.faults.extend(inspection.log.faults);
    checked.notes.extend(inspection.log.notes);
    Ok(checked)
}

/// Checks everything, until something fails without which what follows would say the same again.
async fn check_all(db: &mut Inspected, checked: &mut IntegrityReport) -> Result<(), StoreError> {
    checked.faults = db.structural_faults().await?;
    let version = db.schema().await?;
    if version > newest_schema() {
        checked.newer = Some(version);
        return Ok(());
    }
    note(&mut checked.faults, db.dangling_rows().await);
    match db.holdings().await {
        Ok(holds) => checked.holds = Some(holds),
        Err(error) => checked.faults.push(error.to_string()),
    }
    note(&mut checked.faults, db.key_faults().await);
    for id in db.maps().await? {
        match id {
            Ok(id) => checked.maps.push(map_check::check(db, &id).await),
            Err(fault) => checked.faults.push(fault),
        }
    }
    Ok(())
}

fn note(faults: &mut Vec<String>, found: Result<Vec<String>, StoreError>) {
    match found {
        Ok(found) => faults.extend(found),
        Err(error) => faults.push(error.to_string()),
    }
}
