//! Semantics: the three functions of §IV-A.2, verdicts of models brought from elsewhere, and models asked again.

use revisit_api::judgement::{JudgementBody, JudgementView};
use revisit_api::model_verdict::{ModelVerdictAnswer, ModelVerdictBody};
use revisit_api::semantics::{LevelAnswer, MergeAnswer, OneText, TextPair};
use revisit_api::usage::Usage;

use super::operation::operations;

operations! {
    /// Asks for the SimilarityLevel of two texts.
    send similarity() ["v1", "semantics", "similarity"] TextPair, LevelAnswer;
    /// Asks for the InformationLevel of a text.
    send information() ["v1", "semantics", "information"] OneText, LevelAnswer;
    /// Asks for the text that says what both say.
    send merge_text() ["v1", "semantics", "merge"] TextPair, MergeAnswer;
    /// Brings a verdict of a model.
    send post_model_verdict(map) ["v1", "maps", map, "model-verdicts"] ModelVerdictBody, ModelVerdictAnswer;
    /// Has a changed model asked again about a map's verdicts.
    post post_judgement(map) ["v1", "maps", map, "judgements"] JudgementBody, JudgementView;
    /// Reads how such a job stands.
    read judgement(map, id) ["v1", "maps", map, "judgements", id] JudgementView;
    /// Stops such a job.
    remove delete_judgement(map, id) ["v1", "maps", map, "judgements", id] JudgementView;
    /// Reads what models have cost.
    read usage() ["v1", "usage"] Usage;
}
