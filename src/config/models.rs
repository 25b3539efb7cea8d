//! Models: which language and vision models to ask, how to speak to them, and what they may cost.
//!
//! Without any of these the built-in judge answers everything. Keys come from the environment or from a file, never
//! from the command line, where every user of the machine could read them.

use std::path::PathBuf;

use clap::{Args, Parser, ValueEnum};
use secrecy::SecretString;

/// Which models, and how.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Models")]
pub struct ModelArgs {
    /// A model's address: an OpenAI-compatible base (`https://api.openai.com/v1`, `http://127.0.0.1:11434/v1`), or a
    /// VQA server's. Its key: REVISIT_MODEL_KEY, or --model-key-file
    #[arg(long, env = "REVISIT_MODEL_URL", value_name = "URL")]
    pub model_url: Option<String>,
    /// The model's name at that address
    #[arg(long, env = "REVISIT_MODEL_NAME", value_name = "NAME")]
    pub model_name: Option<String>,
    /// How to speak to it
    #[arg(long, env = "REVISIT_MODEL_KIND", value_enum, default_value_t = Kind::Openai)]
    pub model_kind: Kind,
    /// A file with the key, instead of REVISIT_MODEL_KEY
    #[arg(long, env = "REVISIT_MODEL_KEY_FILE", value_name = "FILE")]
    pub model_key_file: Option<PathBuf>,

    /// Another model for the images, such as a BLIP-2 server; without it the same one looks at them. Its key:
    /// REVISIT_MODEL_VISION_KEY, or --model-vision-key-file
    #[arg(long, env = "REVISIT_MODEL_VISION_URL", value_name = "URL")]
    pub model_vision_url: Option<String>,
    /// The vision model's name
    #[arg(long, env = "REVISIT_MODEL_VISION_NAME", value_name = "NAME")]
    pub model_vision_name: Option<String>,
    /// How to speak to the vision model
    #[arg(long, env = "REVISIT_MODEL_VISION_KIND", value_enum, default_value_t = Kind::Openai)]
    pub model_vision_kind: Kind,
    /// A file with the vision model's key
    #[arg(long, env = "REVISIT_MODEL_VISION_KEY_FILE", value_name = "FILE")]
    pub model_vision_key_file: Option<PathBuf>,

    /// A model of embeddings beside the language model, such as Ollama's `nomic-embed-text`: it chooses the pairs of texts
    /// that the language model is asked about. An OpenAI-compatible base; its key: REVISIT_MODEL_EMBEDDINGS_KEY, or
    /// --model-embeddings-key-file
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_URL", value_name = "URL")]
    pub model_embeddings_url: Option<String>,
    /// The embeddings model's name
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_NAME", value_name = "NAME")]
    pub model_embeddings_name: Option<String>,
    /// A file with the embeddings model's key
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_KEY_FILE", value_name = "FILE")]
    pub model_embeddings_key_file: Option<PathBuf>,

    /// A reader of characters on this machine: hints for the vision model, and readings without one
    #[arg(long, env = "REVISIT_READER", value_enum, default_value_t = Reader::None)]
    pub reader: Reader,

    /// Which parameter bounds the answer
    #[arg(long, env = "REVISIT_MODEL_TOKEN_PARAMETER", value_enum, default_value_t = TokenParameter::MaxTokens)]
    pub model_token_parameter: TokenParameter,
    /// The most tokens of an answer; models that think aloud need more
    #[arg(long, env = "REVISIT_MODEL_MAX_TOKENS", value_name = "N", default_value_t = 300,
        value_parser = clap::value_parser!(u32).range(16..=100_000))]
    pub model_max_tokens: u32,
    /// The temperature; `none` for models that do not take one
    #[arg(long, env = "REVISIT_MODEL_TEMPERATURE", value_name = "T", default_value = "0", value_parser = temperature)]
    pub model_temperature: Temperature,
    /// The seed, for models that take one
    #[arg(long, env = "REVISIT_MODEL_SEED", value_name = "N")]
    pub model_seed: Option<i64>,
    /// How to ask for JSON
    #[arg(long, env = "REVISIT_MODEL_RESPONSE_FORMAT", value_enum, default_value_t = ResponseFormat::JsonSchema)]
    pub model_response_format: ResponseFormat,
    /// Where the rules stand in a question
    #[arg(long, env = "REVISIT_MODEL_SYSTEM_ROLE", value_enum, default_value_t = SystemRole::System)]
    pub model_system_role: SystemRole,
    /// How an image is sent
    #[arg(long, env = "REVISIT_MODEL_IMAGE_FORM", value_enum, default_value_t = ImageForm::DataUri)]
    pub model_image_form: ImageForm,

    /// Price of a million tokens sent, in US dollars
    #[arg(long, env = "REVISIT_MODEL_INPUT_USD", value_name = "USD", default_value = "0", value_parser = money)]
    pub model_input_usd: f64,
    /// Price of a million tokens received, in US dollars
    #[arg(long, env = "REVISIT_MODEL_OUTPUT_USD", value_name = "USD", default_value = "0", value_parser = money)]
    pub model_output_usd: f64,
    /// Price of a million tokens sent with images, in US dollars; as --model-input-usd if it is left out
    #[arg(long, env = "REVISIT_MODEL_VISION_INPUT_USD", value_name = "USD", value_parser = money)]
    pub model_vision_input_usd: Option<f64>,
    /// Price of a million tokens received about images, in US dollars; as --model-output-usd if it is left out
    #[arg(long, env = "REVISIT_MODEL_VISION_OUTPUT_USD", value_name = "USD", value_parser = money)]
    pub model_vision_output_usd: Option<f64>,
    /// Price of a million tokens of embeddings, in US dollars
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_USD", value_name = "USD", default_value = "0", value_parser = money)]
    pub model_embeddings_usd: f64,
    /// The most that a day (UTC) may cost, in US dollars; a hard stop
    #[arg(long, env = "REVISIT_MODEL_DAILY_USD", value_name = "USD", value_parser = money)]
    pub model_daily_usd: Option<f64>,
    /// The most calls of a day (UTC); a hard stop
    #[arg(long, env = "REVISIT_MODEL_DAILY_CALLS", value_name = "N")]
    pub model_daily_calls: Option<u32>,

    /// Calls at once
    #[arg(long, env = "REVISIT_MODEL_CALLS_AT_ONCE", value_name = "N", default_value_t = 4,
        value_parser = clap::value_parser!(u16).range(1..=256))]
    pub model_calls_at_once: u16,
    /// How long a connection may take, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_CONNECT_TIMEOUT_MS", value_name = "MS", default_value_t = 5_000)]
    pub model_connect_timeout_ms: u64,
    /// How long an answer about texts may take, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_TEXT_TIMEOUT_MS", value_name = "MS", default_value_t = 30_000)]
    pub model_text_timeout_ms: u64,
    /// How long a client that asks about texts itself waits for a model before the built-in judge answers, in
    /// milliseconds; the call goes on, and its answer is kept
    #[arg(long, env = "REVISIT_MODEL_CLIENT_TIMEOUT_MS", value_name = "MS", default_value_t = 5_000)]
    pub model_client_timeout_ms: u64,
    /// How long an answer about an image may take, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_VISION_TIMEOUT_MS", value_name = "MS", default_value_t = 60_000)]
    pub model_vision_timeout_ms: u64,
    /// How often a call that failed in passing is tried again
    #[arg(long, env = "REVISIT_MODEL_RETRIES", value_name = "N", default_value_t = 3,
        value_parser = clap::value_parser!(u8).range(0..=10))]
    pub model_retries: u8,
    /// The first pause before a call is tried again, in milliseconds; it doubles, and `retry-after` wins
    #[arg(long, env = "REVISIT_MODEL_RETRY_DELAY_MS", value_name = "MS", default_value_t = 500)]
    pub model_retry_delay_ms: u64,
    /// Consecutive failures after which a model counts as unavailable
    #[arg(long, env = "REVISIT_MODEL_BREAKER_FAILURES", value_name = "N", default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..))]
    pub model_breaker_failures: u32,
    /// How long a model that is away is left alone, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_BREAKER_PAUSE_MS", value_name = "MS", default_value_t = 30_000)]
    pub model_breaker_pause_ms: u64,
}

/// How to speak to a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Chat completions: OpenAI, vLLM, Ollama, LM Studio, llama.cpp's server
    Openai,
    /// One POST of `{image, question, history}`, answered by `{answer}`: BLIP-2, LAVIS
    Vqa,
    /// No model at all, in its form: to count calls and tokens without paying for them
    Scripted,
}

/// A reader of characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Reader {
    /// None
    None,
    /// Tesseract's command line, which must be installed
    Tesseract,
}

/// Which parameter bounds an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TokenParameter {
    /// `max_tokens`, which most servers take
    #[value(name = "max_tokens")]
    MaxTokens,
    /// `max_completion_tokens`, which OpenAI's newer models ask for
    #[value(name = "max_completion_tokens")]
    MaxCompletionTokens,
    /// Neither
    #[value(name = "none")]
    None,
}

/// How to ask for JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ResponseFormat {
    /// By a schema, which the server enforces
    #[value(name = "json_schema")]
    JsonSchema,
    /// By JSON mode
    #[value(name = "json_object")]
    JsonObject,
    /// By asking
    #[value(name = "none")]
    None,
}

/// Where the rules stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SystemRole {
    /// In a message of the role `system`
    System,
    /// In a message of the role `developer`
    Developer,
    /// At the head of the user's message, for models without such a role
    Inline,
}

/// How an image is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ImageForm {
    /// `{"type":"image_url","image_url":{"url":"data:..."}}`, as OpenAI does
    #[value(name = "data_uri")]
    DataUri,
    /// `{"type":"image_url","image_url":"data:..."}`, as some servers want it
    #[value(name = "plain_uri")]
    PlainUri,
    /// Not at all: the model reads texts only
    #[value(name = "none")]
    None,
}

/// A temperature, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature(pub Option<f64>);

fn temperature(text: &str) -> Result<Temperature, String> {
    if text == "none" {
        return Ok(Temperature(None));
    }
    match text.parse::<f64>() {
        Ok(value) if (0.0..=2.0).contains(&value) => Ok(Temperature(Some(value))),
        _ => Err("expected a number in [0, 2], or none".to_owned()),
    }
}

fn money(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1e6).contains(&value) => Ok(value),
        _ => Err("expected an amount of US dollars in [0, 1000000]".to_owned()),
    }
}

#[derive(Parser)]
struct OnlyModels {
    #[command(flatten)]
    models: ModelArgs,
}

impl ModelArgs {
    /// These flags, as a command line would give them; for tests and benchmarks.
    pub fn of<T: AsRef<str>>(flags: &[T]) -> Result<Self, clap::Error> {
        let line = std::iter::once("revisit").chain(flags.iter().map(AsRef::as_ref));
        OnlyModels::try_parse_from(line).map(|parsed| parsed.models)
    }

    /// Whether there is anything to ask.
    pub fn any(&self) -> bool {
        let scripted = self.model_kind == Kind::Scripted;
        let urls = [&self.model_url, &self.model_vision_url, &self.model_embeddings_url];
        scripted || urls.into_iter().any(Option::is_some) || self.reader != Reader::None
    }

    /// Returns the model's key, from REVISIT_MODEL_KEY or the file.
    pub fn model_key(&self) -> Result<Option<SecretString>, String> {
        key("REVISIT_MODEL_KEY", self.model_key_file.as_ref())
    }

    /// Returns the vision model's key, from REVISIT_MODEL_VISION_KEY or the file.
    pub fn model_vision_key(&self) -> Result<Option<SecretString>, String> {
        key("REVISIT_MODEL_VISION_KEY", self.model_vision_key_file.as_ref())
    }

    /// Returns the embeddings model's key, from REVISIT_MODEL_EMBEDDINGS_KEY or the file.
    pub fn model_embeddings_key(&self) -> Result<Option<SecretString>, String> {
        key("REVISIT_MODEL_EMBEDDINGS_KEY", self.model_embeddings_key_file.as_ref())
    }
}

fn key(variable: &str, file: Option<&PathBuf>) -> Result<Option<SecretString>, String> {
    let key = match file {
        Some(path) => {
            let read = std::fs::read_to_string(path);
            Some(read.map_err(|error| format!("the key file {}: {error}", path.display()))?)
        }
        None => std::env::var(variable).ok(),
    };
    // What is wrong with a key is told without the key.
    match key.map(|key| key.trim().to_owned()).filter(|key| !key.is_empty()) {
        Some(key) if !key.bytes().all(|byte| byte.is_ascii_graphic()) => {
            Err(format!("{variable}: a key is made of visible ASCII characters, without spaces"))
        }
        key => Ok(key.map(SecretString::from)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_flags_there_is_nothing_to_ask() {
        let none: [&str; 0] = [];
        assert!(!ModelArgs::of(&none).expect("defaults").any());
        assert!(ModelArgs::of(&["--model-url", "http://127.0.0.1:1/v1"]).expect("an address").any());
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for flags in
            [["--model-temperature", "hot"], ["--model-daily-usd", "-1"], ["--model-input-usd", "NaN"]]
        {
            assert!(ModelArgs::of(&flags).is_err(), "{flags:?}");
        }
    }
}
