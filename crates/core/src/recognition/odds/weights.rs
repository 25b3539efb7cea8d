//! The weights of evidence, as log-odds, each with its source.

use super::log_odds::LogOdds;

/// A name that is read here and there and hangs in one place: of 200 such pairs one is misread, or hangs twice.
pub const NAME: LogOdds = LogOdds::of_thousandths(5_300);
/// The same, where either was read once, by a reader that was not confident: that alone is no loop.
pub const NAME_DOUBTFUL: LogOdds = LogOdds::of_thousandths(3_800);
/// Two names at one spot that exclude each other.
pub const OTHER_NAME: LogOdds = LogOdds::of_thousandths(-5_400);
/// The same, where either was read once, by a reader that was not confident.
pub const OTHER_NAME_DOUBTFUL: LogOdds = LogOdds::of_thousandths(-3_000);
/// A name that would hang in two places under a transformation with a length.
pub const DISPLACED: LogOdds = LogOdds::of_thousandths(-2_500);
/// Names that would be two places where nothing but bearing and distance from the two cameras is compared, however many: the
/// cameras may look from different spots.
pub const DISPLACED_BY_BEARING: LogOdds = LogOdds::of_thousandths(-1_000);
/// A name on either side that excludes all names of its class on the other: a place is read a second time with half of its
/// names, and another place with none.
pub const STRANGE_NAMES: LogOdds = LogOdds::of_thousandths(-700);
/// A sign around the query that nobody read around the candidate: of five that hang at both, a reader misses one.
pub const ABSENT: LogOdds = LogOdds::of_thousandths(-200);
/// All such signs together.
pub const ABSENT_MAX: LogOdds = LogOdds::of_thousandths(-1_000);
/// Cells of the view that a place explains and a rival does not, at which the two are as likely as not; and the cells that
/// multiply the odds by e. Fitted to development photographs of floors that look alike: of those with 40 cells or more all
/// were right, of those with 30 to 39 four of five.
pub const EVEN_CELLS: f64 = 12.4;
/// Cells that multiply the odds by e.
pub const CELLS_PER_LOG_ODDS: f64 = 6.0;
/// A view that geometry on map points verifies, where nothing repeats.
pub const VIEW_THAT_DOES_NOT_REPEAT: LogOdds = LogOdds::of_thousandths(6_000);
/// A description that says enough.
pub const DESCRIPTION: LogOdds = LogOdds::of_thousandths(1_500);
/// Any other text without a name.
pub const TEXT: LogOdds = LogOdds::of_thousandths(500);
/// All texts without names together.
pub const TEXTS_MAX: LogOdds = LogOdds::of_thousandths(3_000);
/// Geometry on map points finds no common view.
pub const NO_VIEW: LogOdds = LogOdds::of_thousandths(-6_000);
/// Geometry on images finds a common view, and on the map points of both keyframes none.
pub const NO_COMMON_POINTS: LogOdds = LogOdds::of_thousandths(-3_000);
/// Geometry on images alone finds none, and not both images show a sign that agrees.
pub const NO_VIEW_OF_A_SIGN: LogOdds = LogOdds::of_thousandths(-2_400);
/// Geometry on images alone finds none, though both show such a sign: from far apart they have little else in common.
pub const NO_VIEW_IN_IMAGES: LogOdds = LogOdds::of_thousandths(-600);
/// Names around two cameras say that they are near each other, and no more than this that they stand at one place.
pub const HERE: LogOdds = LogOdds::of_thousandths(6_900);
/// The same where neither a view nor a sign in both local anchor maps places them.
pub const NEAR: LogOdds = LogOdds::of_thousandths(4_000);
/// Odometry has the robot elsewhere.
pub const ELSEWHERE: LogOdds = LogOdds::of_thousandths(-6_000);
/// All that a copy of the place would share proves no more than this: one place in three has a copy.
pub const NO_COPY: LogOdds = LogOdds::of_thousandths(700);
/// A crop that nobody has read yet may turn out to contradict.
pub const UNREAD: LogOdds = LogOdds::of_thousandths(-4_700);
