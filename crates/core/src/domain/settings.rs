//! A map's settings: every threshold of the method, with its default, its bounds and its source.
//!
//! This is the only file with bare numbers of the method in it. One table below makes the
//! struct, the defaults, the bounds, the names and the API document's descriptions, so that
//! they cannot drift apart.

use std::f64::consts::FRAC_PI_3;

use self::SettingSource::{OrbSlam, Ours, Paper, Storage};
use super::setting::Field;
pub use super::setting::{Setting, SettingError, SettingKind, SettingSource, SettingValue};
use crate::named::named;
use crate::semantics::Patterns;

named! {
    /// The method by which a map decides.
    Method default Revisit {
        /// Revisit's: a loop is a bet with known odds.
        Revisit = "revisit",
        /// The paper's, to the letter.
        Paper = "paper",
    }
}

named! {
    /// The decision on a candidate when either local anchor map is empty: §V-B leaves 0/0 open.
    WithoutAnchors default Undecided {
        /// The anchors cannot tell.
        Undecided = "undecided",
        /// No semantic agreement, no loop.
        Reject = "reject",
        /// Geometry alone decides.
        Geometry = "geometry",
    }
}

named! {
    /// The geometric models that may verify a candidate.
    GeometryModels default Auto {
        /// A similarity where points are triangulated, else the model that the two images allow.
        Auto = "auto",
        /// A similarity and nothing else, as ORB-SLAM.
        Sim3 = "sim3",
    }
}

named! {
    /// The rule by which inliers are enough.
    GeometryAcceptance default Significance {
        /// Chance does not explain as many.
        Significance = "significance",
        /// There are `geometry_min_inliers`, as in ORB-SLAM.
        Count = "count",
    }
}

macro_rules! setting_kind {
    (Choice, $type:ty) => {
        SettingKind::Choice { names: <$type>::NAMES }
    };
    ($kind:ident, $type:ty $(, $min:expr, $max:expr)?) => {
        SettingKind::$kind { $(min: $min, max: $max)? }
    };
}

macro_rules! setting_value {
    (Choice, $type:ty, $value:expr) => {
        SettingValue::Choice(<$type>::as_str($value))
    };
    ($kind:ident, $type:ty, $value:expr) => {
        SettingValue::$kind($value)
    };
}

/// Gives the first of several values.
macro_rules! first {
    ($first:expr $(, $($rest:expr),+)?) => {
        $first
    };
}

// A row: name, type, default, bounds, unit, value in the paper's method if it has another, source, meaning.
macro_rules! settings {
    ($($name:ident: $type:ty = $kind:ident { $default:expr $(, $min:expr, $max:expr, $unit:literal)? $(; paper: $paper:expr)? },
        $source:expr, $doc:literal;)*) => {
        /// A map's settings; [`super::method::Method`] tells the paper's from ours.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Settings {
            $(#[doc = $doc] pub $name: $type,)*
        }

        impl Default for Settings {
            fn default() -> Self {
                Self { $($name: $default,)* }
            }
        }

        impl Settings {
            /// Every setting, in the order of the API document.
            pub const TABLE: &'static [Setting] = &[
                $(Setting {
                    name: stringify!($name),
                    unit: first!($(Some($unit),)? None),
                    kind: setting_kind!($kind, $type $(, $min, $max)?),
                    default: setting_value!($kind, $type, $default),
                    paper: first!($(Some(setting_value!($kind, $type, $paper)),)? None),
                    source: $source,
                    doc: $doc,
                },)*
            ];

            /// Returns the value of a setting by name.
            pub fn get(&self, name: &str) -> Option<SettingValue> {
                match name {
                    $(stringify!($name) => Some(Field::read(&self.$name)),)*
                    _ => None,
                }
            }

            /// Returns the settings that differ from their defaults.
            pub fn changed(&self) -> impl Iterator<Item = (&'static str, SettingValue)> {
                let defaults = Self::default();
                Self::TABLE.iter().filter_map(move |row| {
                    let value = self.get(row.name).filter(|value| Some(value) != defaults.get(row.name).as_ref())?;
                    Some((row.name, value))
                })
            }

            /// Sets a setting by name, within its bounds.
            pub fn set(&mut self, name: &str, value: SettingValue) -> Result<(), SettingError> {
                let row = Self::TABLE.iter().find(|row| row.name == name).ok_or(SettingError::Unknown)?;
                match name {
                    $(stringify!($name) => self.$name = Field::accept(&row.kind, value)?,)*
                    _ => return Err(SettingError::Unknown),
                }
                Ok(())
            }
        }
    };
}

settings! {
    method: Method = Choice { Method::Revisit; paper: Method::Paper }, Ours,
        "decides on loops: revisit by the odds of all that is known (M64), paper by the paper's letter. To set it sets every setting that has a value of its own under the paper; a setting named beside it wins";
    loop_min_confidence: f64 = Number { 0.99, 0.5, 0.999_999, "1" }, Ours,
        "a loop is reported from this confidence on";
    building_repeats: bool = Switch { true; paper: false }, Ours,
        "a place may have a copy elsewhere that nobody has mapped, which shows the same looks, pictures and notices: only names and codes tell the two apart. Off, nothing repeats, and looks may close a loop";
    association_min_point_share: f64 = Number { 0.2, 0.0, 1.0, "1" }, Paper("§IV-C.1"),
        "sigma, the least share of a detection's map points that an anchor's box must cover";
    covisibility_min_shared_points: u32 = Count { 15, 1, 1_000_000, "1" }, OrbSlam,
        "keyframes of a session that share at least this many map points are covisible";
    covisibility_max_way_m: f64 = Number { 3.0, 0.0, 1e6, "m"; paper: 0.0 }, Ours,
        "a keyframe without map points and without `covisible` is covisible with the keyframes of its session to which the robot drove no farther, in metres, within 20 s by their clock; 0 joins none";
    description_min_information_level: u32 = Count { 4, 1, 5, "1" }, Paper("§IV-B"),
        "an anchor is valid when its description's InformationLevel is no smaller";
    description_min_crop_area_px: f64 = Number { 256.0, 0.0, 1e9, "px^2" }, Paper("§IV-B"),
        "a model describes a crop whose box has at least this area, in square pixels; a smaller one only once description_refresh_s have passed";
    description_refresh_s: f64 = Number { 600.0, 0.0, 1e9, "s" }, Paper("§IV-B"),
        "an anchor not described for this long, by the clock of its keyframes, is described again, in seconds";
    agreeing_reads: u32 = Count { 1, 1, 9, "1" }, Ours,
        "a model reads an anchor's crops until this many reads agree; fewer alike are not sure by themselves";
    matching_min_similarity_level: u32 = Count { 4, 1, 5, "1" }, Paper("§IV-C.2"),
        "two anchors match when their descriptions' SimilarityLevel is no smaller";
    candidates_max: u32 = Count { 20, 1, 1000, "1" }, Paper("§V, check 2"),
        "how many places each channel brings; a place is the best keyframe of a covisible group";
    candidates_min_gap_s: f64 = Number { 0.0, 0.0, 1e9, "s" }, Ours,
        "a keyframe of the query's session taken less than this long before or after it, by their clock, is no candidate, in seconds; 0 excludes none";
    anchor_map_max_angle_difference_rad: f64 = Number { FRAC_PI_3, 0.0, 4.0, "rad" }, Paper("§V-B"),
        "matching anchors differ by less than this in bearing, in radians";
    anchor_map_max_distance_difference_m: f64 = Number { 1.0, 0.0, 1000.0, "m" }, Paper("§V-B"),
        "matching anchors differ by less than this in distance, in metres";
    anchor_map_min_similarity: f64 = Number { 0.3, 0.0, 1000.0, "1"; paper: 0.3 }, Paper("§V-B"),
        "two local anchor maps match when S of Eq. (2) is greater";
    distinctive_place_radius_m: f64 = Number { 3.0, 0.0, 1e6, "m" }, Ours,
        "anchors farther apart than this stand in different places, in metres";
    reading_min_confidence: f64 = Number { 0.8, 0.0, 1.0, "1"; paper: 0.0 }, Ours,
        "a text of fewer than three specific words that a detection of less confidence read tells nothing until another keyframe of the map reads it alike; 0 = off";
    identifier_patterns: Patterns = Patterns { Patterns::NONE; paper: Patterns::NONE }, Ours,
        "regular expressions of this building's own numbers, at most 16 of 256 bytes; a text that one matches whole, whatever its case, is an identifier, and no other text is one; empty: see learned_identifiers";
    learned_identifiers: bool = Switch { true; paper: false }, Ours,
        "learns for each class how the building writes its numbers, from ten values that were read alike in two keyframes or more each; from then on no other text of the class is an identifier";
    odometry_max_drift_share: f64 = Number { 0.05, 0.0, 1000.0, "1"; paper: 0.0 }, Ours,
        "along an unbroken chain of a session's keyframes odometry is off by at most this share of the way; no transformation may contradict it, and two sightings are two places only if it can tell; 0 = off";
    without_anchors: WithoutAnchors = Choice { WithoutAnchors::Undecided }, Paper("§V-B"),
        "the verdict when either local anchor map is empty, which the paper leaves open (0/0): undecided, reject or geometry";
    association_position_radius_m: f64 = Number { 0.75, 0.0, 1000.0, "m" }, Ours,
        "a detection with a position and no map points joins the nearest anchor of its class that a covisible keyframe saw, within this distance, in metres; also the distance at which covisible anchors that match are merged";
    candidates_min_score_ratio: f64 = Number { 0.0, 0.0, 1000.0, "1" }, Ours,
        "a bag-of-words candidate must score at least this share of reference_score; 0 is off";
    geometry_min_matches: u32 = Count { 20, 3, 100_000, "1" }, OrbSlam,
        "the fewest descriptor matches with which a transformation is estimated; with fewer geometry is skipped and rejects nothing";
    geometry_min_inliers: u32 = Count { 20, 3, 100_000, "1" }, OrbSlam,
        "the fewest inliers of a verified transformation, where geometry_acceptance is count";
    geometry_landmark_sigma_px: f64 = Number { 3.35, 0.0, 100.0, "px"; paper: 0.0 }, Ours,
        "what the error of a map point's own place adds to that of a keypoint, standard deviation in pixels at any octave; 0 = the letter: keypoints alone scatter";
    signs_may_change: bool = Switch { true; paper: false }, Ours,
        "a sign that three separate passages of a session that has read it had in view and did not see, or read otherwise, is retired: it neither agrees nor contradicts, until one passage reads it twice as before";
    keep_history: bool = Switch { true }, Storage,
        "keeps what corrections replace, so that export gives what was sent; decides no verdict. Off, a corrected map takes less room on disk, and export gives poses and points as last corrected";
    revoke_suspects: bool = Switch { false }, Ours,
        "revokes a confirmed loop as soon as it contradicts the others (GET .../frames): its anchors part again. Off, it is listed, and a person decides";
    keep_crops: bool = Switch { true }, Storage,
        "keeps the image crops of detections. Off, a crop goes once it was read, or at once where no model of this server reads crops; its text stays";
    keep_readings: bool = Switch { true }, Storage,
        "keeps the record of what models said: their dialogues, and the verdicts and readings that later ones replaced. Off, only what is in force stays; decides no verdict";
    keep_descriptors_days: u32 = Count { 0, 0, 36_500, "d" }, Storage,
        "after so many days a keyframe's features and global descriptor go: it is found by its words and anchors then, and geometry is not verified with it; 0 = for ever";
    keep_keyframes_days: u32 = Count { 0, 0, 36_500, "d" }, Storage,
        "after so many days keyframes are thinned: those go of whose map points others see nine in ten, and every anchor (redundant=true), so that no place is forgotten; 0 = for ever";
    geometry_models: GeometryModels = Choice { GeometryModels::Auto; paper: GeometryModels::Sim3 }, Ours,
        "auto verifies by a similarity where enough points are triangulated, else by an essential matrix, a homography or a rotation, whichever the two images allow; sim3 is the letter: a similarity or nothing";
    geometry_acceptance: GeometryAcceptance = Choice { GeometryAcceptance::Significance; paper: GeometryAcceptance::Count }, Ours,
        "significance accepts inliers that matches placed at random would give less than once in a million candidates (log10 of the number of false alarms at most -6; Moisan and Stival 2004); count is the letter: geometry_min_inliers, 60 % of which, and an eighth of the matches, have near descriptors and points on both sides";
}

impl Settings {
    /// Whether the map decides by Revisit's method, and not by the paper's letter.
    pub fn is_ours(&self) -> bool {
        self.method == Method::Revisit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_table_reads_its_own_default_back() {
        let mut settings = Settings::default();
        for row in Settings::TABLE {
            let value = settings.get(row.name).expect("a row of the table");
            assert_eq!(settings.set(row.name, value), Ok(()), "{}", row.name);
        }
        assert_eq!(settings, Settings::default());
    }

    #[test]
    fn every_row_has_the_unit_of_its_name_a_source_and_a_meaning() {
        for row in Settings::TABLE {
            let units = [
                ("_days", "d"),
                ("_rad", "rad"),
                ("_area_px", "px^2"),
                ("_px", "px"),
                ("_m", "m"),
                ("_s", "s"),
            ];
            let of_name = units.into_iter().find(|(suffix, _)| row.name.ends_with(suffix));
            let is_number = matches!(row.kind, SettingKind::Number { .. } | SettingKind::Count { .. });
            assert_eq!(row.unit, is_number.then(|| of_name.map_or("1", |(_, unit)| unit)), "{}", row.name);
            let from_paper = matches!(row.source, Paper(section) if !section.starts_with('§'));
            assert!(!from_paper && !row.doc.is_empty() && !row.doc.ends_with('.'), "{}", row.name);
        }
    }

    #[test]
    fn a_value_out_of_bounds_or_of_another_type_is_refused() {
        let mut settings = Settings::default();
        let mut check = |name: &str, value, expected: Result<(), SettingError>| {
            assert_eq!(settings.set(name, value), expected, "{name}");
        };
        check(
            "association_min_point_share",
            SettingValue::Number(1.5),
            Err(SettingError::Range { min: 0.0, max: 1.0 }),
        );
        check("association_min_point_share", SettingValue::Count(1), Ok(()));
        check("candidates_max", SettingValue::Number(1.5), Err(SettingError::Type("a whole number")));
        check(
            "candidates_max",
            SettingValue::Number(-1.0),
            Err(SettingError::Range { min: 1.0, max: 1000.0 }),
        );
        check("building_repeats", SettingValue::Count(1), Err(SettingError::Type("true or false")));
        check("geometry_models", SettingValue::Choice("se3"), Err(SettingError::Choice(&["auto", "sim3"])));
        check("sigma", SettingValue::Count(1), Err(SettingError::Unknown));
        let patterns = Patterns::new(vec![r"\d\.\d\d".to_owned()]).expect("a pattern");
        check("identifier_patterns", SettingValue::Patterns(patterns), Ok(()));
        check(
            "identifier_patterns",
            SettingValue::Count(1),
            Err(SettingError::Type("a list of regular expressions")),
        );
        check(
            "anchor_map_min_similarity",
            SettingValue::Number(f64::NAN),
            Err(SettingError::Range { min: 0.0, max: 1000.0 }),
        );
    }
}
