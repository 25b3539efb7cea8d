//! Map: what a client says of a map, and what it reads of it (`openapi/openapi.yaml`).

use std::collections::BTreeMap;

use revisit_core::domain::ids::{MapId, ReleaseName};
use revisit_core::domain::map::NamedTwins;
use revisit_core::domain::release::MapBase;
use revisit_core::domain::report::MapReport;
use revisit_core::domain::request::{Detail, MapPatch, NewMap};
use revisit_core::geometry::Gravity;
use revisit_shapes::{answer, body};
use utoipa::ToSchema;

use super::decoding::read::{self, Decode, Node, Object};
use super::limits;
use super::settings::{ChosenSettings, MapSettings};

/// A map to be made.
#[answer]
#[derive(Default)]
#[serde(deny_unknown_fields)]
pub struct MapBody {
    /// Free text for people.
    #[schema(max_length = 4096)]
    pub description: Option<String>,
    /// Whether its lengths are metres. Then the scale between two sessions is 1. If not, settings in metres are in the unit of the
    /// poses that it is sent.
    #[schema(default = true)]
    pub metric: Option<bool>,
    /// The unit vector of gravity in the frame of each of its sessions, if they have it in common: `[0,1,0]` where a session's
    /// frame is its first camera, held upright. Left out, it is not known; once given, it may be changed and not withdrawn.
    #[schema(value_type = Option<[f64; 3]>, min_items = 3, max_items = 3, minimum = -1.001, maximum = 1.001)]
    pub gravity: Option<Gravity>,
    /// The classes of which anchors are made; empty means every class.
    #[schema(max_items = 256, value_type = Option<Vec<ClassName>>, inline)]
    pub anchor_classes: Option<Vec<String>>,
    /// The classes whose texts are codes, such as fiducial markers and asset numbers. Codes are compared exactly: case and each
    /// character count.
    #[schema(max_items = 256, value_type = Option<Vec<ClassName>>, inline)]
    pub code_classes: Option<Vec<String>>,
    /// The settings that differ from their defaults.
    pub settings: Option<MapSettings>,
    /// What the map begins as: a copy of a release, or of a map as it stands, with its keyframes, anchors and loops. The other
    /// members then change what it has from there. The copy and the map go different ways from then on.
    pub base: Option<MapBaseShape>,
}

/// The map that a new one begins as.
#[body(same MapBase)]
#[schema(as = MapBase)]
pub struct MapBaseShape {
    /// The map.
    #[id]
    pub map: MapId,
    /// Its release; left out: the map as it stands.
    #[id]
    pub release: Option<ReleaseName>,
}

/// Changes of a map; a field that is left out stays as it is.
#[answer(of = MapPatch)]
#[derive(Default)]
#[serde(deny_unknown_fields)]
pub struct MapPatchBody {
    /// Free text for people.
    #[schema(max_length = 4096)]
    pub description: Option<String>,
    /// Whether its lengths are metres.
    pub metric: Option<bool>,
    /// The unit vector of gravity in the frame of each of its sessions, if they have it in common: `[0,1,0]` where a session's
    /// frame is its first camera, held upright. Left out, it is not known; once given, it may be changed and not withdrawn.
    #[schema(value_type = Option<[f64; 3]>, min_items = 3, max_items = 3, minimum = -1.001, maximum = 1.001)]
    pub gravity: Option<Gravity>,
    /// The classes of which anchors are made from now on; empty means every class.
    #[schema(max_items = 256, value_type = Option<Vec<ClassName>>, inline)]
    pub anchor_classes: Option<Vec<String>>,
    /// The classes whose texts are codes, compared exactly. What was read of them before is compared so, too.
    #[schema(max_items = 256, value_type = Option<Vec<ClassName>>, inline)]
    pub code_classes: Option<Vec<String>>,
    /// The settings to be set; the others stay as they are.
    #[is((!of.settings.is_empty()).then(|| of.settings.into()))]
    pub settings: Option<MapSettings>,
}

/// The class of a detected object, such as `door_number`; printable.
#[derive(ToSchema)]
#[schema(min_length = 1, max_length = 64)]
pub struct ClassName(#[expect(dead_code, reason = "a schema only")] String);

/// A map at one version.
#[answer(of = MapReport)]
pub struct MapView {
    /// Its id.
    pub id: String,
    /// Grows by one with each write to the map.
    #[from(of.version)]
    pub map_version: u64,
    /// Free text for people.
    #[from(of.properties.description)]
    pub description: String,
    /// Whether its lengths are metres.
    #[from(of.properties.metric)]
    pub metric: bool,
    /// The unit vector of gravity in the frame of each of its sessions; left out while it is not known.
    #[schema(value_type = Option<[f64; 3]>, min_items = 3, max_items = 3, minimum = -1.001, maximum = 1.001)]
    #[from(of.properties.gravity)]
    pub gravity: Option<Gravity>,
    /// The classes of which anchors are made, sorted; empty means every class.
    #[from(of.properties.anchor_classes)]
    pub anchor_classes: Vec<String>,
    /// The classes whose texts are codes, compared exactly, sorted.
    #[from(of.properties.code_classes)]
    pub code_classes: Vec<String>,
    /// Every setting in force; with `?detail=brief` those that differ from their defaults.
    #[is(MapSettings::from(&of.properties.settings))]
    pub settings: MapSettings,
    /// The vocabulary its words belong to: a fingerprint, a name that a client gave, or `client`; left out while it has none.
    pub vocabulary: Option<String>,
    /// Number of its keyframes.
    pub keyframes: usize,
    /// Number of its anchors, merged ones counted once.
    pub anchors: usize,
    /// Number of sessions that have written to it.
    pub sessions: usize,
    /// Number of its confirmed loops.
    pub loops: usize,
    /// Size of its facts on disk, in bytes: keyframes with their words, features, detections, texts and crops, map points
    /// with a position (once each, however often sent), sessions, and loops with what they merge.
    pub bytes: u64,
    /// By class, how the building writes its numbers, as learned from ten values or more: `#` stands for the first run of
    /// digits, a `9` for each digit of the others (`#.99` for 7.04 and 10.01). Patterns that were given stand in `settings`.
    #[schema(value_type = BTreeMap<String, Vec<String>>)]
    #[is((*of.learned.numbering).clone())]
    pub numbering: BTreeMap<Box<str>, Vec<String>>,
    /// The views that this map has in two places; around the two, different signs hang. Looked
    /// for where `without_anchors` is `geometry`.
    #[schema(max_items = 8)]
    #[from(of.learned.twins)]
    pub twins: Vec<TwinsView>,
}

/// Two keyframes of one view, by geometry, around which different signs hang.
#[answer(of = NamedTwins)]
#[schema(as = Twins)]
pub struct TwinsView {
    /// The keyframe that was written last.
    pub keyframe: String,
    /// The keyframe that it was taken for.
    pub candidate: String,
    /// A sign around the first.
    pub anchor: String,
    /// The sign that hangs in its place around the second.
    pub candidate_anchor: String,
}

/// The map's version after a write that has nothing else to tell.
#[answer]
#[derive(Copy)]
pub struct MapVersion {
    /// Grows by one with each write to the map.
    pub map_version: u64,
}

const FIELDS: [&str; 6] = ["description", "metric", "gravity", "anchor_classes", "code_classes", "settings"];

impl Decode for NewMap {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let map = node.object(&[&FIELDS[..], &["base"]].concat())?;
        let base = map.optional("base", MapBase::decode);
        let patch = patch(&map)?;
        Some(Self { patch, base: base? })
    }
}

impl Decode for MapPatch {
    fn decode(node: &Node<'_>) -> Option<Self> {
        patch(&node.object(&FIELDS)?)
    }
}

fn patch(map: &Object<'_>) -> Option<MapPatch> {
    let description = map.optional("description", |node| node.text(limits::TEXT_CHARS));
    let metric = map.optional("metric", read::switch);
    let gravity = map.optional("gravity", Gravity::decode);
    let anchor_classes = map.optional("anchor_classes", classes);
    let code_classes = map.optional("code_classes", classes);
    let settings = map.optional("settings", ChosenSettings::decode);
    Some(MapPatch {
        description: description?,
        anchor_classes: anchor_classes?,
        code_classes: code_classes?,
        metric: metric?,
        gravity: gravity?,
        settings: settings?.unwrap_or_default().0,
    })
}

/// Returns a set: neither the order nor a class named twice makes another map.
fn classes(node: &Node<'_>) -> Option<Vec<String>> {
    let mut classes = node.list(limits::CLASSES, |node| node.name(limits::CLASS_CHARS))?;
    classes.sort_unstable();
    classes.dedup();
    Some(classes)
}

impl MapView {
    /// Returns a map; in brief, with the settings alone that differ from their defaults.
    pub fn of(map: MapReport, detail: Detail) -> Self {
        let changed = (detail == Detail::Brief).then(|| MapSettings::changed(&map.properties.settings));
        let whole = Self::from(map);
        Self { settings: changed.unwrap_or(whole.settings), ..whole }
    }
}
