//! Models: the language and vision models, their protocols and their budgets.
//!
//! Without any of these the built-in judge answers everything. Keys come from the environment or from a file. They are
//! never read from the command line, which every user of the machine can see.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use secrecy::SecretString;

use super::flags::{number, parsed};

/// The models and their parameters.
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
    /// Protocol of the model
    #[arg(long, env = "REVISIT_MODEL_KIND", value_enum, default_value_t = Kind::Openai)]
    pub model_kind: Kind,
    /// A file with the key, instead of REVISIT_MODEL_KEY
    #[arg(long, env = "REVISIT_MODEL_KEY_FILE", value_name = "FILE")]
    pub model_key_file: Option<PathBuf>,

    /// A separate model for images, such as a BLIP-2 server; by default the same model. Its key:
    /// REVISIT_MODEL_VISION_KEY, or --model-vision-key-file
    #[arg(long, env = "REVISIT_MODEL_VISION_URL", value_name = "URL")]
    pub model_vision_url: Option<String>,
    /// The vision model's name
    #[arg(long, env = "REVISIT_MODEL_VISION_NAME", value_name = "NAME")]
    pub model_vision_name: Option<String>,
    /// Protocol of the vision model
    #[arg(long, env = "REVISIT_MODEL_VISION_KIND", value_enum, default_value_t = Kind::Openai)]
    pub model_vision_kind: Kind,
    /// A file with the vision model's key
    #[arg(long, env = "REVISIT_MODEL_VISION_KEY_FILE", value_name = "FILE")]
    pub model_vision_key_file: Option<PathBuf>,

    /// An embeddings model beside the language model, such as Ollama's `nomic-embed-text`, which selects the pairs of
    /// texts for the language model. An OpenAI-compatible base; its key: REVISIT_MODEL_EMBEDDINGS_KEY, or
    /// --model-embeddings-key-file
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_URL", value_name = "URL")]
    pub model_embeddings_url: Option<String>,
    /// The embeddings model's name
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_NAME", value_name = "NAME")]
    pub model_embeddings_name: Option<String>,
    /// A file with the embeddings model's key
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_KEY_FILE", value_name = "FILE")]
    pub model_embeddings_key_file: Option<PathBuf>,

    /// A local text reader (OCR): hints for the vision model, and readings without one
    #[arg(long, env = "REVISIT_READER", value_enum, default_value_t = Reader::None)]
    pub reader: Reader,

    /// Parameter that limits the length of the answer
    #[arg(long, env = "REVISIT_MODEL_TOKEN_PARAMETER", value_enum, default_value_t = TokenParameter::MaxTokens)]
    pub model_token_parameter: TokenParameter,
    /// Maximum tokens of an answer; reasoning models need more
    #[arg(long, env = "REVISIT_MODEL_MAX_TOKENS", value_name = "N", default_value_t = 300,
        value_parser = clap::value_parser!(u32).range(16..=100_000))]
    pub model_max_tokens: u32,
    /// Temperature; `none` for models that do not accept one
    #[arg(long, env = "REVISIT_MODEL_TEMPERATURE", value_name = "T", default_value = "0", value_parser = temperature)]
    pub model_temperature: Temperature,
    /// Seed, for models that accept one
    #[arg(long, env = "REVISIT_MODEL_SEED", value_name = "N")]
    pub model_seed: Option<i64>,
    /// Form in which JSON output is requested
    #[arg(long, env = "REVISIT_MODEL_RESPONSE_FORMAT", value_enum, default_value_t = ResponseFormat::JsonSchema)]
    pub model_response_format: ResponseFormat,
    /// Place of the instructions
    #[arg(long, env = "REVISIT_MODEL_SYSTEM_ROLE", value_enum, default_value_t = SystemRole::System)]
    pub model_system_role: SystemRole,
    /// Encoding of an image
    #[arg(long, env = "REVISIT_MODEL_IMAGE_FORM", value_enum, default_value_t = ImageForm::DataUri)]
    pub model_image_form: ImageForm,

    /// Price of a million input tokens, in US dollars
    #[arg(long, env = "REVISIT_MODEL_INPUT_USD", value_name = "USD", default_value = "0", value_parser = money)]
    pub model_input_usd: f64,
    /// Price of a million output tokens, in US dollars
    #[arg(long, env = "REVISIT_MODEL_OUTPUT_USD", value_name = "USD", default_value = "0", value_parser = money)]
    pub model_output_usd: f64,
    /// Price of a million input tokens of questions about images, in US dollars; defaults to --model-input-usd
    #[arg(long, env = "REVISIT_MODEL_VISION_INPUT_USD", value_name = "USD", value_parser = money)]
    pub model_vision_input_usd: Option<f64>,
    /// Price of a million output tokens about images, in US dollars; defaults to --model-output-usd
    #[arg(long, env = "REVISIT_MODEL_VISION_OUTPUT_USD", value_name = "USD", value_parser = money)]
    pub model_vision_output_usd: Option<f64>,
    /// Price of a million tokens of embeddings, in US dollars
    #[arg(long, env = "REVISIT_MODEL_EMBEDDINGS_USD", value_name = "USD", default_value = "0", value_parser = money)]
    pub model_embeddings_usd: f64,
    /// Maximum cost per day (UTC), in US dollars; a hard limit
    #[arg(long, env = "REVISIT_MODEL_DAILY_USD", value_name = "USD", value_parser = money)]
    pub model_daily_usd: Option<f64>,
    /// Maximum calls per day (UTC); a hard limit
    #[arg(long, env = "REVISIT_MODEL_DAILY_CALLS", value_name = "N")]
    pub model_daily_calls: Option<u32>,

    /// Maximum concurrent calls
    #[arg(long, env = "REVISIT_MODEL_CALLS_AT_ONCE", value_name = "N", default_value_t = 4,
        value_parser = clap::value_parser!(u16).range(1..=256))]
    pub model_calls_at_once: u16,
    /// Connect timeout, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_CONNECT_TIMEOUT_MS", value_name = "MS", default_value_t = 5_000)]
    pub model_connect_timeout_ms: u64,
    /// Timeout of an answer about texts, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_TEXT_TIMEOUT_MS", value_name = "MS", default_value_t = 30_000)]
    pub model_text_timeout_ms: u64,
    /// Time after which the built-in judge answers a client's own question about texts instead of the model, in
    /// milliseconds; the call continues, and its answer is cached
    #[arg(long, env = "REVISIT_MODEL_CLIENT_TIMEOUT_MS", value_name = "MS", default_value_t = 5_000)]
    pub model_client_timeout_ms: u64,
    /// Timeout of an answer about an image, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_VISION_TIMEOUT_MS", value_name = "MS", default_value_t = 60_000)]
    pub model_vision_timeout_ms: u64,
    /// Maximum retries of a call after a transient failure
    #[arg(long, env = "REVISIT_MODEL_RETRIES", value_name = "N", default_value_t = 3,
        value_parser = clap::value_parser!(u8).range(0..=10))]
    pub model_retries: u8,
    /// Delay before the first retry, in milliseconds; it doubles each time, and `retry-after` overrides it
    #[arg(long, env = "REVISIT_MODEL_RETRY_DELAY_MS", value_name = "MS", default_value_t = 500)]
    pub model_retry_delay_ms: u64,
    /// Consecutive failures after which a model counts as unavailable
    #[arg(long, env = "REVISIT_MODEL_BREAKER_FAILURES", value_name = "N", default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..))]
    pub model_breaker_failures: u32,
    /// Time during which an unavailable model is not called, in milliseconds
    #[arg(long, env = "REVISIT_MODEL_BREAKER_PAUSE_MS", value_name = "MS", default_value_t = 30_000)]
    pub model_breaker_pause_ms: u64,
}

/// Protocol of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Chat completions: OpenAI, vLLM, Ollama, LM Studio, llama.cpp's server
    Openai,
    /// A POST of `{image, question, history}` that returns `{answer}`: BLIP-2, LAVIS
    Vqa,
    /// No model, but the same protocol: counts calls and tokens without cost
    Scripted,
}

/// A text reader (OCR).
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Reader {
    /// None
    None,
    /// Tesseract's command line, which must be installed
    Tesseract,
}

/// The parameter that limits the length of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TokenParameter {
    /// `max_tokens`, which most servers accept
    #[value(name = "max_tokens")]
    MaxTokens,
    /// `max_completion_tokens`, which OpenAI's newer models require
    #[value(name = "max_completion_tokens")]
    MaxCompletionTokens,
    /// Neither
    #[value(name = "none")]
    None,
}

/// Form in which JSON output is requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ResponseFormat {
    /// By a schema that the server enforces
    #[value(name = "json_schema")]
    JsonSchema,
    /// By JSON mode
    #[value(name = "json_object")]
    JsonObject,
    /// In the instructions only
    #[value(name = "none")]
    None,
}

/// Place of the instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SystemRole {
    /// In a message of the role `system`
    System,
    /// In a message of the role `developer`
    Developer,
    /// At the start of the user's message, for models without such a role
    Inline,
}

/// Encoding of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ImageForm {
    /// `{"type":"image_url","image_url":{"url":"data:..."}}`, as OpenAI does
    #[value(name = "data_uri")]
    DataUri,
    /// `{"type":"image_url","image_url":"data:..."}`, as some servers require
    #[value(name = "plain_uri")]
    PlainUri,
    /// None: the model accepts only text
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
    number(text, 0.0..=2.0, "a number in [0, 2], or none").map(|value| Temperature(Some(value)))
}

fn money(text: &str) -> Result<f64, String> {
    number(text, 0.0..=1e6, "an amount of US dollars in [0, 1000000]")
}

impl ModelArgs {
    /// Parses these flags, as a command line would give them; for tests and benchmarks.
    pub fn of<T: AsRef<str>>(flags: &[T]) -> Result<Self, clap::Error> {
        parsed(flags)
    }

    /// Whether any model is configured.
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
    // The error about a key does not contain the key.
    match key.map(|key| key.trim().to_owned()).filter(|key| !key.is_empty()) {
        Some(key) if !key.bytes().all(|byte| byte.is_ascii_graphic()) => {
            Err(format!("{variable}: a key consists of visible ASCII characters, without spaces"))
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
    fn rejects_flags_that_make_no_sense() {
        for flags in
            [["--model-temperature", "hot"], ["--model-daily-usd", "-1"], ["--model-input-usd", "NaN"]]
        {
            assert!(ModelArgs::of(&flags).is_err(), "{flags:?}");
        }
    }
}
