//! Map points, in blocks of 64 numbers: to the database and back.
//!
//! A client numbers its points one after the other, so that the 500 new ones of a keyframe are eight or nine rows. A
//! point whose number stands alone takes a row of its own.

use std::collections::BTreeMap;

use revisit_core::domain::ids::{PointId, SessionSeq};
use revisit_core::geometry::Point3;

use crate::StoreError;
use crate::columns::blob::{pack, unpack};
use crate::columns::bulk_insert::write_rows;
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection};

/// Numbers of a block, as a power of two.
const BLOCK_BITS: u32 = 6;

/// Blocks that are read and written at a time.
const BLOCKS_AT_A_TIME: usize = 512;

/// The points of a block, each at the last bits of its number.
struct Block([Option<Point3>; 1 << BLOCK_BITS]);

impl Block {
    const EMPTY: Self = Self([None; 1 << BLOCK_BITS]);

    fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }

    fn pack(&self) -> Vec<u8> {
        let present = |(at, point): (u32, &Option<Point3>)| u64::from(point.is_some()) << at;
        let mask: u64 = (0..).zip(&self.0).map(present).sum();
        let mut bytes = mask.to_le_bytes().to_vec();
        bytes.extend(pack(self.0.iter().flatten().map(|at| [at.x, at.y, at.z])));
        bytes
    }

    fn of(bytes: &[u8]) -> Result<Self, StoreError> {
        let corrupt = || StoreError::corrupt("a block of map points has another length");
        let (mask, positions) = bytes.split_first_chunk::<8>().ok_or_else(corrupt)?;
        let mask = u64::from_le_bytes(*mask);
        let positions: Vec<[f64; 3]> = unpack(positions)?;
        if positions.len() != mask.count_ones() as usize {
            return Err(corrupt());
        }
        let (mut block, mut positions) = (Self::EMPTY, positions.into_iter());
        for (at, point) in block.0.iter_mut().enumerate() {
            if mask & 1 << at != 0 {
                *point = positions.next().map(Point3::from);
            }
        }
        Ok(block)
    }
}

/// Points to be set, by their places in a block; those without a position are removed.
type Changes = Vec<(usize, Option<Point3>)>;

/// Returns the points that a row holds, ascending.
pub(crate) fn points_of(
    block: i64,
    bytes: &[u8],
) -> Result<impl Iterator<Item = (PointId, Point3)>, StoreError> {
    let points = Block::of(bytes)?.0;
    Ok((0_i64..).zip(points).filter_map(move |(at, point)| Some((block << BLOCK_BITS | at, point?))))
}

/// Sets points, and removes those without a position. Of one that is given twice the last counts.
pub(crate) async fn change(
    db: &mut Connection,
    map: MapKey,
    points: impl IntoIterator<Item = (SessionSeq, PointId, Option<Point3>)>,
) -> Result<(), StoreError> {
    let mut changed: BTreeMap<(SessionSeq, i64), Changes> = BTreeMap::new();
    for (session, id, at) in points {
        let place = (id & ((1 << BLOCK_BITS) - 1)) as usize;
        changed.entry((session, id >> BLOCK_BITS)).or_default().push((place, at));
    }
    let changed: Vec<_> = changed.into_iter().collect();
    for of_session in changed.chunk_by(|a, b| a.0.0 == b.0.0) {
        for chunk in of_session.chunks(BLOCKS_AT_A_TIME) {
            change_blocks(db, map, chunk[0].0.0, chunk).await?;
        }
    }
    Ok(())
}

/// Changes the points of blocks of one session.
async fn change_blocks(
    db: &mut Connection,
    map: MapKey,
    session: SessionSeq,
    changed: &[((SessionSeq, i64), Changes)],
) -> Result<(), StoreError> {
    let numbers: Vec<i64> = changed.iter().map(|((_, block), _)| *block).collect();
    let mut standing = blocks(db, map, session, &numbers).await?;
    let (mut written, mut emptied) = (Vec::new(), Vec::new());
    for ((_, number), points) in changed {
        let mut block = standing.remove(number).unwrap_or(Block::EMPTY);
        for (place, at) in points {
            block.0[*place] = *at;
        }
        if block.is_empty() {
            emptied.push(*number);
        } else {
            written.push((*number, block.pack()));
        }
    }
    let head = "insert into point_blocks (map_key, session, block, points) ";
    let tail = " on conflict (map_key, session, block) do update set points = excluded.points";
    write_rows(db, head, tail, &written, |row, (block, points)| {
        row.push_bind(map).push_bind(session).push_bind(*block).push_bind(points);
    })
    .await?;
    for block in emptied {
        let delete = "delete from point_blocks where map_key = $1 and session = $2 and block = $3";
        run(db, sql::statement(delete, (map, session, block))).await?;
    }
    Ok(())
}

/// Returns those of these blocks that are there.
async fn blocks(
    db: &mut Connection,
    map: MapKey,
    session: SessionSeq,
    numbers: &[i64],
) -> Result<BTreeMap<i64, Block>, StoreError> {
    let select = "select block, points from point_blocks
        where map_key = $1 and session = $2 and block in (select cast(value as bigint) from json_each($3))";
    let list = serde_json::json!(numbers).to_string();
    let rows: Vec<(i64, Vec<u8>)> =
        sql::query_as(select).bind(map).bind(session).bind(list).fetch_all(db).await?;
    rows.into_iter().map(|(number, points)| Ok((number, Block::of(&points)?))).collect()
}

/// Returns the positions of those of these points that have one.
pub(crate) async fn positions(
    db: &mut Connection,
    map: MapKey,
    session: SessionSeq,
    ids: &[PointId],
) -> Result<Vec<(PointId, Point3)>, StoreError> {
    let mut found = Vec::with_capacity(ids.len());
    let mut sorted = ids.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    let of_block: Vec<&[PointId]> = sorted.chunk_by(|a, b| a >> BLOCK_BITS == b >> BLOCK_BITS).collect();
    for chunk in of_block.chunks(BLOCKS_AT_A_TIME) {
        let numbers: Vec<i64> = chunk.iter().map(|ids| ids[0] >> BLOCK_BITS).collect();
        let standing = blocks(db, map, session, &numbers).await?;
        for id in chunk.iter().copied().flatten() {
            let place = (id & ((1 << BLOCK_BITS) - 1)) as usize;
            let at = standing.get(&(id >> BLOCK_BITS)).and_then(|block| block.0[place]);
            found.extend(at.map(|at| (*id, at)));
        }
    }
    Ok(found)
}

/// Unpacks a blob as a block of points, for fuzzing: what fits reads back.
///
/// # Panics
/// If a block that was unpacked is packed into other bytes.
pub(crate) fn unpacks(bytes: &[u8]) {
    if let Ok(block) = Block::of(bytes) {
        assert_eq!(block.pack(), bytes);
    }
}
