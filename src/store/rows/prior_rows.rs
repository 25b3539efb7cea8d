//! Prior anchors as rows, to the database and back.

use super::blob::{pack, unpack_array};
use super::decode;
use super::statement::run;
use super::validate::{self, Known};
use crate::domain::change::Change;
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::domain::prior::Prior;
use crate::geometry::Point3;
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection, Row};

/// Adds a prior anchor, whose anchor and frame are there.
pub(in crate::store) async fn add(
    db: &mut Connection,
    map: MapKey,
    anchor: AnchorSeq,
    prior: &Prior,
) -> Result<(), StoreError> {
    let insert =
        "insert into prior_anchors (map_key, anchor, id, frame, description, position, normal, source)
        values ($1, $2, $3, $4, $5, $6, $7, $8)";
    let Point3 { coords } = prior.position_in_frame;
    let query = sql::query(insert)
        .bind(map)
        .bind(anchor.0)
        .bind(prior.id.as_str())
        .bind(prior.frame.0)
        .bind(&*prior.description)
        .bind(pack([coords.x, coords.y, coords.z]))
        .bind(prior.normal_in_frame.map(pack))
        .bind(prior.source.as_deref());
    run(db, query).await
}

/// Removes a prior anchor; does nothing if the anchor is none.
pub(in crate::store) async fn remove(
    db: &mut Connection,
    map: MapKey,
    anchor: AnchorSeq,
) -> Result<(), StoreError> {
    let delete = "delete from prior_anchors where map_key = $1 and anchor = $2";
    run(db, sql::query(delete).bind(map).bind(anchor.0)).await
}

/// Returns the prior anchors of a map, by number.
pub(in crate::store) async fn all(
    db: &mut Connection,
    map: MapKey,
    known: &Known,
) -> Result<Vec<Change>, StoreError> {
    let select = "select * from prior_anchors where map_key = $1 order by anchor";
    let rows = sql::query(select).bind(map).fetch_all(db).await?;
    let read = |row: Row| {
        let number: u32 = row.try_get("anchor")?;
        let prior = prior(&row).map_err(|error| error.of_row(format!("prior anchor number {number}")))?;
        validate::prior(AnchorSeq(number), &prior, known)?;
        Ok(Change::PriorSet(AnchorSeq(number), Box::new(prior)))
    };
    rows.into_iter().map(read).collect()
}

fn prior(row: &Row) -> Result<Prior, StoreError> {
    let normal: Option<&[u8]> = row.try_get("normal")?;
    Ok(Prior {
        id: decode::id(row.try_get("id")?)?,
        frame: SessionSeq(row.try_get("frame")?),
        description: row.try_get::<String, _>("description")?.into(),
        position_in_frame: decode::point(row.try_get("position")?)?,
        normal_in_frame: normal.map(unpack_array::<f64, 3>).transpose()?,
        source: row.try_get::<Option<String>, _>("source")?.map(Into::into),
    })
}
