//! Two images of points that nobody has triangulated yet (monocular, before scale): three models, and the choice among them.
//!
//! | the camera | explained by | file |
//! |---|---|---|
//! | moved, in a scene with depth | an essential matrix | [`essential`], [`eight_points`] |
//! | moved before a flat or far scene | a homography | [`homography`], [`decomposition`] |
//! | only turned, as far as can be told | a rotation | [`rotation`] |
//! | how each is looked for | RANSAC, refined | [`mod@consensus`] |
//!
//! **The rule.** All three are looked for, and scored as ORB-SLAM's initialiser does (R. Mur-Artal, J. M. M. Montiel,
//! J. D. Tardos, T-RO 2015, section IV): a match adds, for each image, what its squared error lacks of the limit. The
//! simplest model is preferred that explains nearly as much as each more general one: the rotation if `S_R / (S_R + S_H)`
//! and `S_R / (S_R + S_E)` exceed `MIN_RATIO`, else the homography if `S_H / (S_H + S_E)` does, else the essential matrix.
//! The others follow; the first that is neither degenerate nor explained by chance verifies the candidate. If none does, the
//! first one's failure is told.

pub mod consensus;
pub mod decomposition;
mod eight_points;
pub mod essential;
mod explained;
pub mod homography;
pub mod image_model;
mod model_choice;
pub mod pairs;
pub mod rotation;
#[cfg(test)]
mod tests;

pub(in crate::recognition) use model_choice::MIN_RATIO;
pub use model_choice::verify_two_views;
