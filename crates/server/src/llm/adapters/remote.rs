//! Models behind HTTP, whatever protocol they speak.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use futures_util::future::BoxFuture;
use serde_json::{Value, json};

use super::chat::{self, Dialect};
use super::wire::Endpoint;
use crate::config::models::ImageForm;
use crate::llm::parse::write_embedding;
use crate::llm::port::{Fault, Model, Question, Reply, Role};
use crate::semantics::Embedding;

/// The protocol of a server.
#[derive(Clone, Debug, PartialEq)]
pub enum Protocol {
    /// Chat completions.
    Chat(Dialect),
    /// Visual question answering, by the protocol of BLIP-2 and LAVIS servers: a POST of `{image, question, history} ->
    /// {answer}`. Such a model sees, and judges nothing.
    Vqa,
    /// Embeddings, by the protocol of OpenAI, Ollama, vLLM, llama.cpp's server and text-embeddings-inference.
    Embeddings,
}

impl Protocol {
    /// Returns the path below a server's base address.
    pub fn path(&self) -> &'static str {
        match self {
            Self::Chat(_) => "chat/completions",
            Self::Vqa => "",
            Self::Embeddings => "embeddings",
        }
    }
}

/// A model behind HTTP.
#[derive(Debug)]
pub struct Remote {
    endpoint: Endpoint,
    name: String,
    protocol: Protocol,
}

impl Remote {
    /// Returns the model of this name at this address.
    pub fn new(endpoint: Endpoint, name: impl Into<String>, protocol: Protocol) -> Self {
        Self { endpoint, name: name.into(), protocol }
    }
}

impl Model for Remote {
    fn name(&self) -> &str {
        &self.name
    }

    fn identity(&self) -> String {
        let (address, name) = (self.endpoint.identity(), &self.name);
        match &self.protocol {
            Protocol::Chat(dialect) => format!("openai {address} {name} {dialect:?}"),
            Protocol::Vqa => format!("vqa {address} {name}"),
            Protocol::Embeddings => format!("embeddings {address} {name}"),
        }
    }

    fn can(&self, role: Role) -> bool {
        match &self.protocol {
            Protocol::Chat(dialect) if role == Role::Vision => dialect.image_form != ImageForm::None,
            Protocol::Chat(_) => role == Role::Text,
            Protocol::Vqa => role == Role::Vision,
            Protocol::Embeddings => role == Role::Embeddings,
        }
    }

    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(async move {
            match (&self.protocol, question) {
                (Protocol::Chat(dialect), question) if self.can(question.role()) => {
                    chat::reply(&self.endpoint.post(&dialect.body(&self.name, question)).await?)
                }
                (Protocol::Vqa, Question::Look { picture, question, history, .. }) => {
                    let image = STANDARD.encode(&picture.png);
                    let body = json!({"image": image, "question": question, "history": history});
                    let answer = self.endpoint.post(&body).await?;
                    let content = answer.get("answer").and_then(Value::as_str);
                    let content = content.ok_or(Fault::Garbled("no answer"))?.to_owned();
                    Ok(Reply { content, input_tokens: None, output_tokens: None })
                }
                (Protocol::Embeddings, Question::Embed { text }) => {
                    let body = json!({"model": self.name, "input": text, "encoding_format": "float"});
                    embedding(&self.endpoint.post(&body).await?)
                }
                _ => Err(Fault::Unable),
            }
        })
    }
}

/// Returns the single vector of an answer, rounded.
fn embedding(answer: &Value) -> Result<Reply, Fault> {
    let vector = answer.pointer("/data/0/embedding").and_then(Value::as_array);
    let vector: Option<Vec<f64>> = vector.and_then(|vector| vector.iter().map(Value::as_f64).collect());
    let embedding = vector.and_then(|vector| Embedding::round(&vector));
    Ok(Reply {
        content: write_embedding(&embedding.ok_or(Fault::Garbled("no embedding"))?),
        input_tokens: answer.pointer("/usage/prompt_tokens").and_then(Value::as_u64),
        output_tokens: Some(0),
    })
}
