//! Semantics: the three functions of §IV-A.2, verdicts of models brought from elsewhere, and models asked again.

use reqwest::Method;

use super::body::Body;
use super::connection::{Client, Written};
use super::error::ClientError;
use crate::api::judgement::{JudgementBody, JudgementView};
use crate::api::model_verdict::{ModelVerdictAnswer, ModelVerdictBody};
use crate::api::semantics::{LevelAnswer, MergeAnswer, OneText, TextPair};
use crate::api::usage::Usage;

impl Client {
    /// Asks for the SimilarityLevel of two texts.
    pub async fn similarity(&self, body: &impl Body<TextPair>) -> Result<LevelAnswer, ClientError> {
        Ok(self.write(Method::POST, &["v1", "semantics", "similarity"], &[], body).await?.answer)
    }

    /// Asks for the InformationLevel of a text.
    pub async fn information(&self, body: &impl Body<OneText>) -> Result<LevelAnswer, ClientError> {
        Ok(self.write(Method::POST, &["v1", "semantics", "information"], &[], body).await?.answer)
    }

    /// Asks for the text that says what both say.
    pub async fn merge_text(&self, body: &impl Body<TextPair>) -> Result<MergeAnswer, ClientError> {
        Ok(self.write(Method::POST, &["v1", "semantics", "merge"], &[], body).await?.answer)
    }

    /// Brings a verdict of a model.
    pub async fn post_model_verdict(
        &self,
        map: &str,
        body: &impl Body<ModelVerdictBody>,
    ) -> Result<ModelVerdictAnswer, ClientError> {
        Ok(self.write(Method::POST, &["v1", "maps", map, "model-verdicts"], &[], body).await?.answer)
    }

    /// Has a changed model asked again about a map's verdicts.
    pub async fn post_judgement(
        &self,
        map: &str,
        body: &impl Body<JudgementBody>,
    ) -> Result<Written<JudgementView>, ClientError> {
        self.write(Method::POST, &["v1", "maps", map, "judgements"], &[], body).await
    }

    /// Reads how such a job stands.
    pub async fn judgement(&self, map: &str, id: &str) -> Result<JudgementView, ClientError> {
        self.read(&["v1", "maps", map, "judgements", id], &[]).await
    }

    /// Stops such a job.
    pub async fn delete_judgement(&self, map: &str, id: &str) -> Result<JudgementView, ClientError> {
        self.remove(&["v1", "maps", map, "judgements", id], &[]).await?.decode()
    }

    /// Reads what models have cost.
    pub async fn usage(&self) -> Result<Usage, ClientError> {
        self.read(&["v1", "usage"], &[]).await
    }
}
