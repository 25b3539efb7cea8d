//! From rows to changes: the facts of a map, in an order in which every change finds what it names.
//!
//! An index that is built from them equals the live one; the engine builds it, and its tests hold that law.

use std::collections::HashSet;
use std::sync::Arc;

use revisit_core::domain::bow::BowVector;
use revisit_core::domain::change::{Change, Declared, Keyframe, Merge, MergeCause};
use revisit_core::domain::ids::{KeyframeSeq, MapId, SessionSeq};
use sqlx::AssertSqlSafe;

use crate::StoreError;
use crate::facts::{MapFacts, Order};
use crate::loading::deferred;
use crate::map_key::MapKey;
use crate::rows::decode;
use crate::rows::point_blocks::points_of;
use crate::rows::validate::{self, Known, KnownAnchor};
use crate::rows::{
    changed_sign_rows, map_rows, model_rows, observation_rows, prior_rows, session_merge_rows, twin_rows,
};
use crate::sizes::sizes;
use crate::sql::{self, Connection, Row};

/// Loads a map within a read transaction. An error about one of its rows names the map and the row.
pub(crate) async fn load(
    db: &mut Db,
    id: &MapId,
    order: Order,
    take: impl FnMut(Vec<Change>) + Send,
) -> Result<Option<MapFacts>, StoreError> {
    load_rows(db, id, order, take).await.map_err(|error| error.of_map(id))
}

async fn load_rows(
    db: &mut Db,
    id: &MapId,
    order: Order,
    mut take: impl FnMut(Vec<Change>) + Send,
) -> Result<Option<MapFacts>, StoreError> {
    let Some(row) = map_row(db, id).await? else { return Ok(None) };
    let key: MapKey = row.try_get("map_key")?;
    take(vec![Change::MapSet(Box::new(map_rows::properties(&row)?))]);
    if let Some(vocabulary) = row.try_get::<Option<String>, _>("vocabulary")? {
        take(vec![Change::VocabularySet(vocabulary.into())]);
    }
    let sessions = sessions(db, key).await?;
    let merges_of_sessions = session_merge_rows::all(db, key).await?;
    let mut known = Known::of_sessions(sessions.len(), merges_of_sessions);
    let next = (row.try_get("next_keyframe")?, row.try_get("next_anchor")?);
    match order {
        Order::Forwards => {
            take(sessions);
            load_points(db, key, &known, &mut take).await?;
            load_keyframes(db, key, order, &mut known, &mut take).await?;
            take(model_rows::verdicts(db, key).await?);
            take(anchors(db, key, &mut known).await?);
            take(prior_rows::all(db, key, &known).await?);
            load_observations(db, key, &known, &mut take).await?;
            let (loops, merges) = loops_and_merges(db, key).await?;
            validate::merges(&loops, &merges, &known)?;
            validate::numbers(next, &loops, &known)?;
            take(loops);
            take(merges);
        }
        Order::Backwards => {
            take(reversed(sessions));
            load_keyframes(db, key, order, &mut known, &mut take).await?;
            take(anchors(db, key, &mut known).await?);
            let mut observed = Vec::new();
            load_observations(db, key, &known, &mut |part| observed.extend(part)).await?;
            take(reversed(prior_rows::all(db, key, &known).await?));
            let (loops, merges) = loops_and_merges(db, key).await?;
            take(reversed(merges));
            take(reversed(loops));
            for change in reversed(observed) {
                take(vec![change]);
            }
            load_points(db, key, &known, &mut take).await?;
            take(reversed(model_rows::verdicts(db, key).await?));
        }
    }
    take(twin_rows::all(db, key).await?);
    take(changed_sign_rows::all(db, key).await?);
    take(session_merge_rows::open(&known.merges));
    // On top of the rows, in their order.
    deferred::apply(db, key, &mut known, &mut take).await?;
    Ok(Some(facts_of(db, &row).await?))
}

/// Returns the row of a map.
pub(crate) async fn map_row(db: &mut Db, id: &MapId) -> Result<Option<Row>, StoreError> {
    Ok(sql::query("select * from maps where id = $1").bind(id).fetch_optional(&mut *db).await?)
}

/// Returns what the row of a map tells.
pub(crate) async fn facts_of(db: &mut Db, row: &Row) -> Result<MapFacts, StoreError> {
    let key: MapKey = row.try_get("map_key")?;
    let next_kept =
        sql::query_scalar("select coalesce(max(kept), 0) + 1 from loop_queries where map_key = $1");
    Ok(MapFacts {
        key,
        version: row.try_get("version")?,
        next_keyframe: row.try_get("next_keyframe")?,
        next_anchor: row.try_get("next_anchor")?,
        next_event: row.try_get("next_event")?,
        next_kept: next_kept.bind(key).fetch_one(&mut *db).await?,
        owner: row.try_get("owner")?,
        digest: row.try_get("digest")?,
        figures: map_rows::figures(row)?,
        learned: map_rows::learned(row)?,
    })
}

fn reversed(mut changes: Vec<Change>) -> Vec<Change> {
    changes.reverse();
    changes
}

pub(crate) type Db = Connection;

async fn sessions(db: &mut Db, key: MapKey) -> Result<Vec<Change>, StoreError> {
    let select = "select session, id from sessions where map_key = $1 order by session";
    let rows = sql::query(select).bind(key).fetch_all(db).await?;
    let numbers = rows.iter().map(|row| row.try_get("session")).collect::<Result<Vec<u32>, _>>()?;
    validate::sessions(&numbers)?;
    let added = |(row, seq): (&Row, u32)| {
        let id = row.try_get("id").map_err(StoreError::from);
        let id = id.map_err(|error| error.of_row(format!("session number {seq}")))?;
        Ok(Change::SessionAdded(SessionSeq(seq), id))
    };
    rows.iter().zip(numbers).map(added).collect()
}

async fn load_points(
    db: &mut Db,
    key: MapKey,
    known: &Known,
    take: &mut (impl FnMut(Vec<Change>) + Send),
) -> Result<(), StoreError> {
    let select = "select session, block, points from point_blocks
        where map_key = $1 and (session, block) > ($2, $3) order by session, block limit $4";
    let (mut session, mut block) = (-1_i64, i64::MIN);
    loop {
        let rows: Vec<(u32, i64, Vec<u8>)> = sql::query_as(select)
            .bind(key)
            .bind(session)
            .bind(block)
            .bind(sizes().keyframes)
            .fetch_all(&mut *db)
            .await?;
        let Some(last) = rows.last() else { return Ok(()) };
        (session, block) = (i64::from(last.0), last.1);
        let mut points = Vec::new();
        for (s, block, bytes) in &rows {
            let of_block = points_of(*block, bytes);
            for (id, at) in of_block.map_err(|error| error.of_row(format!("block {block} of map points")))? {
                validate::point(*s, id, &at, known)?;
                points.push(Change::PointSet(SessionSeq(*s), id, at));
            }
        }
        take(points);
    }
}

async fn load_keyframes(
    db: &mut Db,
    key: MapKey,
    order: Order,
    known: &mut Known,
    take: &mut (impl FnMut(Vec<Change>) + Send),
) -> Result<(), StoreError> {
    // An older keyframe may be declared covisible with a younger one, by what its client said later.
    known.keyframes = standing(db, key).await?;
    let (mut last, condition) = match order {
        Order::Forwards => (-1_i64, "keyframe > $2 order by keyframe"),
        Order::Backwards => (i64::MAX, "keyframe < $2 order by keyframe desc"),
    };
    let select = format!(
        "select {}, {} from keyframes left join keyframe_points using (map_key, keyframe)
        where map_key = $1 and {condition} limit $3",
        decode::KEYFRAME,
        observation_rows::JOINED
    );
    loop {
        let select = AssertSqlSafe(select.as_str());
        let rows =
            sql::query(select).bind(key).bind(last).bind(sizes().keyframes).fetch_all(&mut *db).await?;
        let Some(row) = rows.last() else { return Ok(()) };
        last = row.try_get("keyframe")?;
        let mut added = Vec::with_capacity(rows.len());
        for row in &rows {
            let (mut keyframe, bow) = keyframe(row, known)?;
            let seq = keyframe.seq;
            // What was declared about keyframes that were culled since is no fact any more.
            keyframe.declared = declared_of(&keyframe, &known.keyframes);
            added.push(Change::KeyframeAdded(Box::new(keyframe), Arc::new(bow)));
            added.extend(global_descriptor(row, seq, known)?);
        }
        match order {
            Order::Forwards => take(added),
            // One by one: the index derives all that it holds at every part.
            Order::Backwards => added.into_iter().for_each(|change| take(vec![change])),
        }
    }
}

/// Returns the keyframes of a map.
async fn standing(db: &mut Db, key: MapKey) -> Result<HashSet<KeyframeSeq>, StoreError> {
    let select = "select keyframe from keyframes where map_key = $1";
    Ok(sql::query_scalar(select).bind(key).fetch_all(&mut *db).await?.into_iter().collect())
}

/// Returns the declared covisibility of a keyframe with those that stand.
fn declared_of(keyframe: &Keyframe, standing: &HashSet<KeyframeSeq>) -> Declared {
    let listed = keyframe.declared.as_ref()?;
    Some(listed.iter().copied().filter(|(other, _)| standing.contains(other)).collect())
}

fn keyframe(row: &Row, known: &Known) -> Result<(Keyframe, BowVector), StoreError> {
    let number: i64 = row.try_get("keyframe")?;
    let of_row = |error: StoreError| error.of_row(format!("keyframe number {number}"));
    let (mut keyframe, bow) = decode::keyframe(row).map_err(of_row)?;
    observation_rows::bring_up_to_date(&mut keyframe, row).map_err(of_row)?;
    keyframe.session = session_merge_rows::session_after(&known.merges, keyframe.seq, keyframe.session);
    validate::keyframe(&keyframe, known)?;
    Ok((keyframe, bow))
}

/// Returns the global descriptor of a keyframe, if it has one, and notes the form of the map's.
fn global_descriptor(
    row: &Row,
    keyframe: KeyframeSeq,
    known: &mut Known,
) -> Result<Option<Change>, StoreError> {
    let of_row = |error: StoreError| error.of_row(format!("keyframe number {}", keyframe.0));
    let Some(descriptor) = decode::global_descriptor(row).map_err(of_row)? else { return Ok(None) };
    validate::global_descriptor(&descriptor, known).map_err(of_row)?;
    Ok(Some(Change::GlobalDescriptorSet(keyframe, Box::new(descriptor))))
}

/// Returns the anchors, and notes the class and version of each.
async fn anchors(db: &mut Db, key: MapKey, known: &mut Known) -> Result<Vec<Change>, StoreError> {
    let mut changes = Vec::new();
    let select =
        "select anchor, class, description_by_hand, version from anchors where map_key = $1 order by anchor";
    let rows: Vec<(_, Box<str>, Option<_>, u64)> =
        sql::query_as(select).bind(key).fetch_all(&mut *db).await?;
    for (seq, class, by_hand, version) in rows {
        known.anchors.insert(seq, KnownAnchor { class: class.clone(), version });
        changes.push(Change::AnchorAdded(seq, class));
        changes.push(Change::AnchorTouched(seq, version));
        if by_hand.is_some() {
            changes.push(Change::DescriptionSet(seq, by_hand));
        }
    }
    Ok(changes)
}

/// Loads what was observed of the anchors.
async fn load_observations(
    db: &mut Db,
    key: MapKey,
    known: &Known,
    take: &mut (impl FnMut(Vec<Change>) + Send),
) -> Result<(), StoreError> {
    let select = "select keyframe, detection from crops where map_key = $1";
    let crops: Vec<(u32, u16)> = sql::query_as(select).bind(key).fetch_all(&mut *db).await?;
    let crops: HashSet<(u32, u16)> = crops.into_iter().collect();
    let mut readings = model_rows::readings(&mut *db, key).await?;
    let select = "select keyframe, detection, anchor, class, confidence, box_px, map_points, position, text, description, range_assumed, points_now
        from detections where map_key = $1 and (keyframe, detection) > ($2, $3) and anchor is not null
        order by keyframe, detection limit $4";
    let mut last = (-1_i64, -1_i64);
    loop {
        let query = sql::query(select).bind(key).bind(last.0).bind(last.1).bind(sizes().detections);
        let rows = query.fetch_all(&mut *db).await?;
        let Some(row) = rows.last() else { return Ok(()) };
        last = (row.try_get("keyframe")?, row.try_get("detection")?);
        let mut observed = Vec::with_capacity(rows.len());
        for row in &rows {
            let at: (u32, u16) = (row.try_get("keyframe")?, row.try_get("detection")?);
            let of_row =
                |error: StoreError| error.of_row(format!("detection {} of keyframe number {}", at.1, at.0));
            let mut observation = decode::observation(row, crops.contains(&at)).map_err(of_row)?;
            if let Some(points) = observation_rows::points_of_detection(row).map_err(of_row)? {
                observation.map_points = points.into();
            }
            let anchor = row.try_get("anchor")?;
            validate::observation(anchor, row.try_get("class")?, &observation, known)?;
            observation.crop_reading = readings.remove(&at);
            observed.push(Change::Observed(anchor, Box::new(observation)));
        }
        take(observed);
    }
}

async fn loops_and_merges(db: &mut Db, key: MapKey) -> Result<(Vec<Change>, Vec<Change>), StoreError> {
    let (mut loops, mut merges) = (Vec::new(), Vec::new());
    for row in
        sql::query("select * from loops where map_key = $1 order by id").bind(key).fetch_all(&mut *db).await?
    {
        let closed = decode::closed_loop(&row).map_err(|error| error.of_row("a loop"))?;
        loops.push(Change::LoopAdded(closed));
    }
    let select = "select into_anchor, from_anchor, nullif(loop_id, '') from anchor_merges where map_key = $1";
    let rows: Vec<(_, _, Option<_>)> = sql::query_as(select).bind(key).fetch_all(&mut *db).await?;
    for (into, from, by) in rows {
        let cause = by.map_or(MergeCause::Covisible, MergeCause::Loop);
        merges.push(Change::Merged(Merge { into, from, cause }));
    }
    Ok((loops, merges))
}
