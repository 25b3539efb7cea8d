//! A scene: one map in memory, and the few words needed to fill it and to ask it.

use std::collections::BTreeMap;
use std::sync::Arc;

use revisit_core::domain::anchor::Outcome;
use revisit_core::domain::change::{Change, Loop, Merge};
use revisit_core::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq, LoopId, PointId, SessionId};
use revisit_core::domain::loop_warning::LoopWarning;
use revisit_core::domain::method::Method;
use revisit_core::geometry::Pose;
use revisit_core::recognition::anchors::describing::describe;
use revisit_core::recognition::anchors::ingest::Ingested;
use revisit_core::recognition::extensions::distinctiveness::PlaceCounts;
use revisit_core::recognition::loops::anchor_map::{LocalAnchor, local_anchor_map};
use revisit_core::recognition::loops::centre::Centre;
use revisit_core::recognition::map::recorder::{Decided, Recorder};
use revisit_core::{
    BowVector, Candidate, Correction, FeatureSet, Features, MapIndex, MapProperties, MatchableFeatures,
    Query, Settings, Verdict, Verify, check_loop, close_loop, correct, cull_keyframe, ingest, revoke_loop,
};

pub use self::sent::{Keyframe, Thing, door, keyframe, thing, unread};
pub use self::shown::{
    Sign, anchors, candidates, close_to, close_to_all, code, confidence, descriptions, ids, named, reason,
    terms, told,
};

mod sent;
mod shown;

/// Names of rooms, each a valid description, no two of them alike.
pub const NAMES: [&str; 6] = ["Turing", "Curie", "Noether", "Kepler", "Lovelace", "Gauss"];

/// One map with the words of its keyframes, which a map itself does not keep.
#[derive(Clone)]
pub struct Scene {
    map: MapIndex,
    words: BTreeMap<KeyframeSeq, Arc<BowVector>>,
}

/// Returns the settings with which the core is the paper's method to the letter.
pub fn to_the_letter() -> Settings {
    let mut settings = Settings::default();
    for (name, value) in Method::Paper.settings() {
        settings.set(name, value).expect("a setting");
    }
    settings
}

impl Scene {
    /// Makes a map with the default settings.
    pub fn new() -> Self {
        Self::with(Settings::default())
    }

    /// Makes a map with these settings.
    pub fn with(settings: Settings) -> Self {
        Self::of(MapProperties { settings, ..MapProperties::default() })
    }

    /// Makes a map with these properties.
    pub fn of(properties: MapProperties) -> Self {
        let mut map = MapIndex::default();
        map.apply(&[Change::MapSet(Box::new(properties))]);
        Self { map, words: BTreeMap::new() }
    }

    /// Returns the map itself.
    pub fn map(&self) -> &MapIndex {
        &self.map
    }

    /// Stores a keyframe; what became of it.
    pub fn put(&mut self, id: &str, keyframe: Keyframe) -> Ingested {
        let new = keyframe.under(id);
        let ingested = ingest(&mut self.map, &new);
        self.words.insert(ingested.keyframe, Arc::new(new.bow));
        ingested
    }

    /// Returns the anchors that a keyframe's detections feed, by the names that these go by now.
    pub fn fed(&self, ingested: &Ingested) -> Vec<AnchorSeq> {
        let root = |anchor: &AnchorSeq| self.map.objects().root(*anchor).unwrap_or(*anchor);
        let anchor = |outcome: &Outcome| match outcome {
            Outcome::Created(anchor) | Outcome::Observed(anchor) => root(anchor),
            Outcome::Ignored(reason) => panic!("a detection feeds no anchor: {}", reason.as_str()),
        };
        ingested.outcomes.iter().map(anchor).collect()
    }

    /// Changes settings.
    pub fn set(&mut self, change: impl FnOnce(&mut Settings)) {
        let mut properties = self.map.properties().clone();
        change(&mut properties.settings);
        let mut record = Recorder::new(&mut self.map);
        record.apply(vec![Change::MapSet(Box::new(properties))]);
        record.finish();
    }

    /// Describes an anchor by hand, or gives it back to its readings.
    pub fn describe(&mut self, anchor: AnchorSeq, description: Option<&str>) {
        describe(&mut self.map, anchor, description.map(Into::into));
    }

    /// Asks about a stored keyframe.
    pub fn ask(&self, keyframe: &str) -> Verdict {
        self.ask_verifying(keyframe, Verify::default())
    }

    /// Asks about a stored keyframe, and says which checks are to run.
    pub fn ask_verifying(&self, keyframe: &str, verify: Verify) -> Verdict {
        let seq = self.seq(keyframe);
        let query = Query::stored(&self.map, seq, &self.words[&seq]).expect("it is stored");
        check_loop(&self.map, &query, verify, &FeatureSet::default(), 0)
    }

    /// Asks about a stored keyframe, and wants loops that repeat a confirmed one, too.
    pub fn ask_again(&self, keyframe: &str) -> Verdict {
        let seq = self.seq(keyframe);
        let query = Query::stored(&self.map, seq, &self.words[&seq]).expect("it is stored").asked(true);
        check_loop(&self.map, &query, Verify::default(), &FeatureSet::default(), 0)
    }

    /// Asks about a stored keyframe, with the features that geometry reads.
    pub fn ask_seeing(&self, keyframe: &str, features: &[(&str, Features)]) -> Verdict {
        let seq = self.seq(keyframe);
        let query = Query::stored(&self.map, seq, &self.words[&seq]).expect("it is stored");
        let read =
            |features: &Features| MatchableFeatures::of(features.clone()).expect("lists of one length");
        let stored = features.iter().map(|(id, features)| (self.seq(id), Arc::new(read(features)))).collect();
        let features = FeatureSet { inline: None, stored };
        check_loop(&self.map, &query, Verify::default(), &features, 0)
    }

    /// Asks about a keyframe that is not stored.
    pub fn ask_inline(&self, keyframe: &Keyframe) -> Verdict {
        let new = keyframe.clone().under("inline");
        let query = Query::inline(&self.map, &new);
        check_loop(&self.map, &query, Verify::default(), &FeatureSet::default(), 0)
    }

    /// Returns what the query about one keyframe says of another.
    pub fn compare(&self, query: &str, candidate: &str) -> Candidate {
        let verdict = self.ask(query);
        let found = candidate_of(&verdict, candidate);
        found.unwrap_or_else(|| panic!("{candidate} is no candidate of {query}: {verdict:#?}"))
    }

    /// Confirms a loop; what speaks against it, if anything does.
    pub fn close(&mut self, id: &str, keyframe: &str, candidate: &str) -> (Option<LoopWarning>, Decided) {
        let closed = Loop {
            id: loop_id(id),
            keyframe: self.seq(keyframe),
            candidate: self.seq(candidate),
            keyframe_id: keyframe_id(keyframe),
            candidate_id: keyframe_id(candidate),
            query: None,
            candidate_from_query: None,
        };
        close_loop(&mut self.map, closed)
    }

    /// Returns the anchors that a confirmed loop merged.
    pub fn merged_by(&self, id: &str) -> Vec<Merge> {
        self.map.objects().links_of_loop(&loop_id(id))
    }

    /// Takes a loop back; the anchors that part.
    pub fn revoke(&mut self, id: &str) -> (Vec<Merge>, Decided) {
        revoke_loop(&mut self.map, &loop_id(id))
    }

    /// Moves keyframes and map points of the session `default`.
    pub fn correct(&mut self, poses: &[(&str, Pose)], points: &[(PointId, [f64; 3])]) {
        let session = self.map.session(&SessionId::default()).expect("the session is known");
        let poses = poses.iter().map(|(id, pose)| (self.seq(id), *pose)).collect();
        let map_points = points.iter().map(|(id, at)| (*id, (*at).into())).collect();
        correct(&mut self.map, session, &Correction { poses, map_points });
    }

    /// Whether the map has this keyframe.
    pub fn has(&self, keyframe: &str) -> bool {
        self.map.keyframe_seq(&keyframe_id(keyframe)).is_some()
    }

    /// Culls a keyframe.
    pub fn cull(&mut self, keyframe: &str) {
        let seq = self.seq(keyframe);
        let words = self.words.remove(&seq).expect("it is stored");
        cull_keyframe(&mut self.map, seq, words);
    }

    /// Returns an anchor as it stands; of a merged one, what is its own.
    pub fn anchor(&self, anchor: AnchorSeq) -> Sign {
        Sign::of(&self.map, anchor).unwrap_or_else(|| panic!("{} is gone", anchor.public()))
    }

    /// Returns all anchors that go by their own name, oldest first.
    pub fn anchors(&self) -> Vec<Sign> {
        let roots = self.map.objects().iter().map(|(root, _)| root);
        roots.map(|root| self.anchor(root)).collect()
    }

    /// Returns M_k of a keyframe.
    pub fn local_map(&self, keyframe: &str) -> Vec<LocalAnchor> {
        let centre = Centre::stored(&self.map, self.seq(keyframe)).expect("it is stored");
        local_anchor_map(&self.map, &centre, &mut PlaceCounts::default()).anchors
    }

    /// Returns the keyframes covisible with one, sorted.
    pub fn covisible(&self, keyframe: &str) -> Vec<String> {
        let mut ids: Vec<String> = self.shared(keyframe).into_iter().map(|(id, _)| id).collect();
        ids.sort();
        ids
    }

    /// Returns the keyframes covisible with one, each with its number of shared map points.
    pub fn shared(&self, keyframe: &str) -> Vec<(String, u32)> {
        let shared = self.map.covisibility().shared(self.seq(keyframe));
        let id = |seq| self.map.keyframe(seq).expect("it is stored").id.to_string();
        shared.map(|(seq, points)| (id(seq), points)).collect()
    }

    /// Returns the number of a stored keyframe.
    fn seq(&self, keyframe: &str) -> KeyframeSeq {
        let seq = self.map.keyframe_seq(&keyframe_id(keyframe));
        seq.unwrap_or_else(|| panic!("there is no keyframe {keyframe}"))
    }
}

/// Returns one candidate of a verdict.
pub fn candidate_of(verdict: &Verdict, keyframe: &str) -> Option<Candidate> {
    verdict.candidates.iter().find(|candidate| candidate.keyframe.as_str() == keyframe).cloned()
}

/// Returns a pose at a place, turned by a quaternion `[x,y,z,w]`.
pub fn turned(place: [f64; 3], rotation: [f64; 4]) -> Pose {
    Pose::new(place, rotation).expect("a rotation")
}

fn keyframe_id(id: &str) -> KeyframeId {
    id.parse().expect("an id")
}

fn loop_id(id: &str) -> LoopId {
    id.parse().expect("an id")
}
