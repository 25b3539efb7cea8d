//! §V, the last step, over HTTP: planted rooms, planted motions, and what the service makes of them.

mod alone;
mod anchors;
mod changed_signs;
mod images;
mod neighbours;
pub mod scene;
mod transformation;
mod twins;
