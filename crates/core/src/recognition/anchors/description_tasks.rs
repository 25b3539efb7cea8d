//! What a map's anchors lack and a model could give: the worker's jobs, found anew whenever it looks (§IV-A.3, §IV-B).
//!
//! There is no queue that a crash could lose: what is lacking is a question to the index.

use crate::domain::ids::{AnchorSeq, KeyframeSeq};

/// Something a model could give.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DescriptionTask {
    /// A description of a detection's crop.
    Reading {
        /// The anchor that the detection feeds.
        anchor: AnchorSeq,
        /// The keyframe.
        keyframe: KeyframeSeq,
        /// The detection.
        detection: u16,
        /// The object's class.
        class: Box<str>,
        /// What the client read, if that says too little.
        hint: Option<Box<str>>,
    },
    /// InformationLevel of a text in normal form.
    Information {
        /// The object's class.
        class: Box<str>,
        /// The text.
        text: Box<str>,
    },
    /// SimilarityLevel of two texts in normal form, the smaller first.
    Similarity {
        /// The objects' class.
        class: Box<str>,
        /// The smaller text.
        a: Box<str>,
        /// The larger text.
        b: Box<str>,
    },
    /// An embedding of a text in normal form.
    Embedding {
        /// The text.
        text: Box<str>,
    },
    /// MergeText of two readings in normal form, the smaller first.
    Merge {
        /// The object's class.
        class: Box<str>,
        /// The smaller text.
        a: Box<str>,
        /// The larger text.
        b: Box<str>,
        /// Both as they were read, with their capital letters.
        as_read: [Box<str>; 2],
    },
}

/// Things that are lacking, as far as the map was looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DescriptionTasks {
    /// Those that were found.
    pub found: Vec<DescriptionTask>,
    /// Whether there is no more at this version of the map.
    pub is_all: bool,
}
