//! Embeddings, by the protocol of OpenAI, Ollama, vLLM, llama.cpp's server and text-embeddings-inference.

use futures_util::future::BoxFuture;
use serde_json::{Value, json};

use super::wire::Endpoint;
use crate::llm::parse::write_embedding;
use crate::llm::port::{Fault, Model, Question, Reply};
use crate::semantics::Embedding;

/// A model behind `/embeddings`.
#[derive(Debug)]
pub struct Embeddings {
    endpoint: Endpoint,
    name: String,
}

impl Embeddings {
    /// Returns the model of this name at this address.
    pub fn new(endpoint: Endpoint, name: impl Into<String>) -> Self {
        Self { endpoint, name: name.into() }
    }
}

impl Model for Embeddings {
    fn name(&self) -> &str {
        &self.name
    }

    fn identity(&self) -> String {
        format!("embeddings {} {}", self.endpoint.identity(), self.name)
    }

    fn can(&self, question: &Question) -> bool {
        matches!(question, Question::Embed { .. })
    }

    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(async move {
            let Question::Embed { text } = question else { return Err(Fault::Unable) };
            let body = json!({"model": self.name, "input": text, "encoding_format": "float"});
            reply(&self.endpoint.post(&body).await?)
        })
    }
}

/// Returns the single vector of an answer, rounded.
fn reply(answer: &Value) -> Result<Reply, Fault> {
    let vector = answer.pointer("/data/0/embedding").and_then(Value::as_array);
    let vector: Option<Vec<f64>> = vector.and_then(|vector| vector.iter().map(Value::as_f64).collect());
    let embedding = vector.and_then(|vector| Embedding::round(&vector));
    Ok(Reply {
        content: write_embedding(&embedding.ok_or(Fault::Garbled("no embedding"))?),
        input_tokens: answer.pointer("/usage/prompt_tokens").and_then(Value::as_u64),
        output_tokens: Some(0),
    })
}
