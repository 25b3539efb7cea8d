//! Followed maps: those that other servers follow, and the time for which the log of changes is kept for them.

use std::time::Duration;

use super::key_list::list;
use crate::StoreError;
use crate::map_key::MapKey;
use crate::sql::{self, Pool};

/// Time for which the changes of a version are kept in the log.
const LOGGED: Duration = Duration::from_mins(1);

/// Returns which of these maps a server follows, and removes what the log need not tell any more, of whatever map.
pub(super) async fn followed(pool: &Pool, maps: &[MapKey]) -> Result<Vec<MapKey>, StoreError> {
    let delete = "delete from map_changes where written < clock_timestamp() - make_interval(secs => $1)";
    sql::query(delete).bind(LOGGED.as_secs_f64()).execute(pool).await?;
    let select = "select distinct map_key from map_followers
        where map_key in (select cast(value as bigint) from json_each($1)) and expires > clock_timestamp()";
    Ok(sql::query_scalar(select).bind(list(maps)).fetch_all(pool).await?)
}
