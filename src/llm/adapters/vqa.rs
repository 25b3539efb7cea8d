//! Visual question answering, by the protocol of BLIP-2 and LAVIS servers: a POST of `{image, question, history} ->
//! {answer}`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use futures_util::future::BoxFuture;
use serde_json::{Value, json};

use super::wire::Endpoint;
use crate::llm::port::{Fault, Model, Question, Reply};

/// A model that sees, and judges nothing.
#[derive(Debug)]
pub struct Vqa {
    endpoint: Endpoint,
    name: String,
}

impl Vqa {
    /// Returns the server at this address.
    pub fn new(endpoint: Endpoint, name: impl Into<String>) -> Self {
        Self { endpoint, name: name.into() }
    }
}

impl Model for Vqa {
    fn name(&self) -> &str {
        &self.name
    }

    fn identity(&self) -> String {
        format!("vqa {} {}", self.endpoint.identity(), self.name)
    }

    fn can(&self, question: &Question) -> bool {
        question.needs_eyes()
    }

    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(async move {
            let Question::Look { picture, question, history, .. } = question else {
                return Err(Fault::Unable);
            };
            let body = json!({
                "image": STANDARD.encode(&picture.png),
                "question": question,
                "history": history
            });
            let answer = self.endpoint.post(&body).await?;
            let content = answer.get("answer").and_then(Value::as_str);
            Ok(Reply {
                content: content.ok_or(Fault::Garbled("no answer"))?.to_owned(),
                input_tokens: None,
                output_tokens: None,
            })
        })
    }
}
