//! Models: a stub over HTTP answers as told, or fails in every way that servers do.

mod canary;
mod contract;
mod dialogue;
mod embeddings;
mod eviction;
mod faults;
mod injections;
mod judgements;
mod judging;
mod killed;
mod roles;
pub mod scene;
pub mod stub;
mod tesseract;
mod wording;
mod worker;
mod world;

#[path = "../../../benches/models/world.rs"]
mod generated;
#[path = "../../../benches/models/wording.rs"]
mod measured_wording;
