//! Key: an API key as it is made, and as it is read back without its secret.

use revisit_core::domain::key::{Key, KeyProperties, MadeKey, MapPattern, PatternError};
use revisit_core::domain::keyframe::Stamp;
use revisit_shapes::{answer, body};
use utoipa::ToSchema;

use super::decoding::read::{Decode, Node};
use super::names::ActionName;
use super::space::Time;

/// The notice in the answer to a server's first key.
pub(super) const FIRST_KEY_NOTICE: &str = "This is the server's first key: from now on every request needs a key, sent as \
    `authorization: Bearer <secret>`, and the viewer asks for one. Keep the secret; it is not shown again.";

/// A key to be made.
#[body(KeyProperties)]
#[derive(Default)]
pub struct KeyBody {
    /// Whose it is, for people.
    #[schema(min_length = 1, max_length = 128)]
    pub name: Option<String>,
    /// Its permissions, at least one.
    #[schema(min_items = 1, max_items = 4, inline)]
    pub actions: Vec<ActionName>,
    /// The maps that exist for it: ids in which `*` stands for any characters. Left out: every map.
    #[schema(min_items = 1, max_items = 100, value_type = Option<Vec<PatternShape>>, inline)]
    pub maps: Option<Vec<MapPattern>>,
    /// From when on it is no longer good. Left out: never.
    pub expires: Option<Time>,
    /// Requests a second; a second's worth may come at once, and a bulk line counts as a request. Left out: any number.
    #[schema(minimum = 1, maximum = 1_000_000)]
    pub rate_per_s: Option<u32>,
    /// Maximum maps that it made and that exist: it cannot make more (507). Left out: any number.
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub max_maps: Option<u32>,
    /// Maximum bytes of these maps, with their releases: what would add to them is refused (507), whoever sends it. What they
    /// hold is looked up once a second. Left out: any number.
    #[schema(minimum = 0, maximum = 9_007_199_254_740_992_i64)]
    pub max_bytes: Option<u64>,
    /// Calls of models a day (UTC) for the maps it makes and the texts it asks about. Left out: any number.
    #[schema(minimum = 0, maximum = 1_000_000_000)]
    pub model_daily_calls: Option<u32>,
    /// Maximum cost of these calls, in US dollars. Left out: any sum.
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub model_daily_usd: Option<f64>,
}

/// A map's id in which `*` stands for any number of characters.
#[derive(ToSchema)]
#[schema(min_length = 1, max_length = 128, pattern = "^(\\.{0,2}[A-Za-z0-9_:*-]|\\.{3})[A-Za-z0-9._:*-]*$")]
pub struct PatternShape(#[expect(dead_code, reason = "a schema only")] String);

/// A key, without its secret.
#[answer(of = Key)]
pub struct KeyView {
    /// Its id, `key-7`.
    #[from(of.seq.public())]
    pub id: String,
    /// Whose it is.
    #[from(of.properties.name)]
    pub name: String,
    /// Its permissions.
    #[schema(inline)]
    #[from(of.properties.actions.iter().collect::<Vec<_>>())]
    pub actions: Vec<ActionName>,
    /// The maps that exist for it.
    #[from(of.properties.maps)]
    pub maps: Vec<String>,
    /// The time when it was made.
    #[from(second(of.created_sec))]
    pub created: Time,
    /// From when on it is no longer good; left out if it does not expire.
    #[from(of.properties.expires)]
    pub expires: Option<Time>,
    /// The time when it was revoked; left out while it is good.
    #[from(of.revoked_sec.map(second))]
    pub revoked: Option<Time>,
    /// Requests a second.
    #[from(of.properties.rate_per_s)]
    pub rate_per_s: Option<u32>,
    /// Maximum maps that it made and that exist.
    #[from(of.properties.max_maps)]
    pub max_maps: Option<u32>,
    /// Maximum bytes of these maps with their releases.
    #[from(of.properties.max_bytes)]
    pub max_bytes: Option<u64>,
    /// Calls of models a day.
    #[from(of.properties.model_daily_calls)]
    pub model_daily_calls: Option<u32>,
    /// Maximum cost of these calls, in US dollars.
    #[from(of.properties.model_daily_microusd.map(|microusd| microusd as f64 / 1e6))]
    pub model_daily_usd: Option<f64>,
    /// When the server that answers was last asked with it; left out if it was not since that server started.
    #[is(None)]
    pub last_used: Option<Time>,
    /// The secret, to be sent as `authorization: Bearer <secret>`. Shown once, when the key is made, and kept nowhere.
    #[is(None)]
    pub secret: Option<String>,
    /// The consequences, if this is the server's first key.
    #[is(None)]
    pub notice: Option<String>,
}

impl From<KeyBody> for KeyProperties {
    fn from(body: KeyBody) -> Self {
        Self {
            name: body.name.unwrap_or_default(),
            actions: body.actions.into_iter().map(|action| action.0).collect(),
            maps: body.maps.unwrap_or_else(|| vec![MapPattern::every()]),
            expires: body.expires.map(Stamp::from),
            rate_per_s: body.rate_per_s,
            max_maps: body.max_maps,
            max_bytes: body.max_bytes,
            model_daily_calls: body.model_daily_calls,
            model_daily_microusd: body.model_daily_usd.map(|usd| (usd * 1e6).round() as u64),
        }
    }
}

impl Decode for MapPattern {
    fn decode(node: &Node<'_>) -> Option<Self> {
        match node.string()?.parse() {
            Ok(pattern) => Some(pattern),
            Err(error) => {
                let error: PatternError = error;
                node.refuse(error.to_string(), "[A-Za-z0-9._:*-]{1,128}, but neither . nor ..")
            }
        }
    }
}

fn second(sec: i64) -> Stamp {
    Stamp { sec, nanosec: 0 }
}

impl From<MadeKey> for KeyView {
    fn from(made: MadeKey) -> Self {
        let notice = made.is_first.then(|| FIRST_KEY_NOTICE.to_owned());
        Self { secret: Some(made.secret), notice, ..made.key.into() }
    }
}
