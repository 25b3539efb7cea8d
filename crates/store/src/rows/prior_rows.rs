//! Prior anchors as rows, to the database and back.

use revisit_core::domain::change::Change;
use revisit_core::domain::ids::AnchorSeq;
use revisit_core::domain::prior::Prior;

use crate::StoreError;
use crate::map_key::MapKey;
use crate::rows::validate::{self, Known};
use crate::sql::{self, Connection, Query, Row};

/// Adds a prior anchor, whose anchor and frame are there.
pub(crate) fn add(map: MapKey, anchor: AnchorSeq, prior: &Prior) -> Query {
    let Prior { id, frame, description, position_in_frame, normal_in_frame, source } = prior;
    let insert =
        "insert into prior_anchors (map_key, anchor, id, frame, description, position, normal, source)
        values ($1, $2, $3, $4, $5, $6, $7, $8)";
    let source = source.as_deref();
    sql::statement(
        insert,
        (map, anchor, id, *frame, description, *position_in_frame, *normal_in_frame, source),
    )
}

/// Removes a prior anchor; does nothing if the anchor is none.
pub(crate) fn remove(map: MapKey, anchor: AnchorSeq) -> Query {
    sql::statement("delete from prior_anchors where map_key = $1 and anchor = $2", (map, anchor))
}

/// Returns the prior anchors of a map, by number.
pub(crate) async fn all(db: &mut Connection, map: MapKey, known: &Known) -> Result<Vec<Change>, StoreError> {
    let select = "select * from prior_anchors where map_key = $1 order by anchor";
    let rows = sql::query(select).bind(map).fetch_all(db).await?;
    let read = |row: Row| {
        let anchor: AnchorSeq = row.try_get("anchor")?;
        let prior = prior(&row).map_err(|error| error.of_row(format!("prior anchor number {}", anchor.0)))?;
        validate::prior(anchor, &prior, known)?;
        Ok(Change::PriorSet(anchor, Box::new(prior)))
    };
    rows.into_iter().map(read).collect()
}

fn prior(row: &Row) -> Result<Prior, StoreError> {
    Ok(Prior {
        id: row.try_get("id")?,
        frame: row.try_get("frame")?,
        description: row.try_get("description")?,
        position_in_frame: row.try_get("position")?,
        normal_in_frame: row.try_get("normal")?,
        source: row.try_get("source")?,
    })
}
