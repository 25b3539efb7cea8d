//! Chat completions, by the protocol of OpenAI, vLLM, Ollama, LM Studio and llama.cpp's server.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::config::models::{ImageForm, ModelArgs, ResponseFormat, SystemRole, TokenParameter};
use crate::llm::picture::Picture;
use crate::llm::port::{Fault, Question, Reply};
use crate::llm::prompts::{Prompt, prompt};

/// The differences between servers.
#[derive(Clone, Debug, PartialEq)]
pub struct Dialect {
    /// The parameter that limits the length of the answer.
    pub token_parameter: TokenParameter,
    /// Maximum tokens of an answer.
    pub max_tokens: u32,
    /// The temperature, if the model accepts one.
    pub temperature: Option<f64>,
    /// The seed, if the model accepts one.
    pub seed: Option<i64>,
    /// Form in which JSON output is requested.
    pub response_format: ResponseFormat,
    /// Place of the instructions.
    pub system_role: SystemRole,
    /// Encoding of an image.
    pub image_form: ImageForm,
}

impl From<&ModelArgs> for Dialect {
    fn from(args: &ModelArgs) -> Self {
        Self {
            token_parameter: args.model_token_parameter,
            max_tokens: args.model_max_tokens,
            temperature: args.model_temperature.0,
            seed: args.model_seed,
            response_format: args.model_response_format,
            system_role: args.model_system_role,
            image_form: args.model_image_form,
        }
    }
}

impl Dialect {
    /// Returns the body that asks a model of this name.
    pub(super) fn body(&self, name: &str, question: &Question) -> Value {
        let Prompt { rules, data, schema } = prompt(question);
        let picture = match question {
            Question::Look { picture, .. } => Some(picture.as_ref()),
            _ => None,
        };
        let tokens_as =
            |parameter| (self.token_parameter == parameter).then_some(Value::from(self.max_tokens));
        let messages = self.messages(rules, data, schema.is_some(), picture);
        let format = schema.and_then(|(name, schema)| match self.response_format {
            ResponseFormat::JsonSchema => Some(json!({
                "type": "json_schema",
                "json_schema": {"name": name, "strict": true, "schema": schema}
            })),
            ResponseFormat::JsonObject => Some(json!({"type": "json_object"})),
            ResponseFormat::None => None,
        });
        let members = [
            ("model", Some(json!(name))),
            ("messages", Some(messages)),
            ("max_tokens", tokens_as(TokenParameter::MaxTokens)),
            ("max_completion_tokens", tokens_as(TokenParameter::MaxCompletionTokens)),
            ("temperature", self.temperature.map(Value::from)),
            ("seed", self.seed.map(Value::from)),
            ("response_format", format),
        ];
        members.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
    }

    fn messages(&self, mut rules: String, data: String, json: bool, picture: Option<&Picture>) -> Value {
        if json {
            rules.push_str("\nAnswer with one JSON object and nothing else.");
        }
        let (head, text) = match self.system_role {
            SystemRole::System => (Some(json!({"role": "system", "content": rules})), data),
            SystemRole::Developer => (Some(json!({"role": "developer", "content": rules})), data),
            SystemRole::Inline => (None, format!("{rules}\n\n{data}")),
        };
        let content = match picture {
            Some(picture) => json!([{"type": "text", "text": text}, self.image(picture)]),
            None => json!(text),
        };
        Value::Array(head.into_iter().chain([json!({"role": "user", "content": content})]).collect())
    }

    fn image(&self, picture: &Picture) -> Value {
        let uri = format!("data:image/png;base64,{}", STANDARD.encode(&picture.png));
        match self.image_form {
            ImageForm::PlainUri => json!({"type": "image_url", "image_url": uri}),
            ImageForm::DataUri | ImageForm::None => json!({"type": "image_url", "image_url": {"url": uri}}),
        }
    }
}

/// Returns the first choice of a completion, if it is complete.
pub(super) fn reply(answer: &Value) -> Result<Reply, Fault> {
    let choice = answer.pointer("/choices/0").ok_or(Fault::Garbled("no choices"))?;
    if choice.pointer("/message/refusal").is_some_and(|refusal| !refusal.is_null()) {
        return Err(Fault::Garbled("a refusal"));
    }
    match choice["finish_reason"].as_str() {
        Some("length") => return Err(Fault::Garbled("an answer cut short")),
        Some("content_filter") => return Err(Fault::Garbled("a refusal")),
        _ => {}
    }
    let content = choice.pointer("/message/content").and_then(Value::as_str);
    Ok(Reply {
        content: content.ok_or(Fault::Garbled("no content"))?.to_owned(),
        input_tokens: answer.pointer("/usage/prompt_tokens").and_then(Value::as_u64),
        output_tokens: answer.pointer("/usage/completion_tokens").and_then(Value::as_u64),
    })
}
