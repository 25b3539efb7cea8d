//! Dialogue that describes a crop (§IV-A.1, after ChatCaptioner): one model sees, the other asks.
//!
//! The first question is always for the exact text. The dialogue stops early when an identifier was read alike twice,
//! or when two successive answers are empty. A summary may contain only what was answered.

use std::sync::Arc;

use super::gateway::Gateway;
use super::judge::class_name;
use super::parse;
use super::picture::Picture;
use super::port::{Fault, Question, Round};
use super::tesseract::{self, Tesseract};
use crate::domain::judged::{CropReading, TranscriptStep};
use crate::semantics::{self, Text};
use crate::store::DayLimit;

/// Maximum rounds about a door, a sign or a shelf, which are short texts.
const ROUNDS_OF_PLATE: usize = 3;

/// Maximum rounds about a picture, whose motif takes more words.
const ROUNDS_OF_PICTURE: usize = 5;

/// Consecutive empty answers that end a dialogue.
const SILENT_ANSWERS_MAX: usize = 2;

/// A class with one of these in its name is a picture.
const PICTURES: [&str; 7] = ["paint", "picture", "poster", "mural", "artwork", "photo", "drawing"];

const AGAIN: &str =
    "Read the number, name or code on it once more, character by character. What is it exactly?";

/// The answer recorded for an unanswered question.
const UNKNOWN: &str = "unknown";

/// The replacement for an answer that addresses a model, in prompts to models.
const WITHHELD: &str = "(a text, noted)";

/// The questions without a language model.
const FIXED: [&str; 4] = [
    "What does it show?",
    "Which colours and shapes does it have?",
    "What is special about it?",
    "What is around it?",
];

/// The participants.
#[derive(Clone, Debug, Default)]
pub struct Describer {
    /// The vision model.
    pub eyes: Option<Gateway>,
    /// The language model that asks and summarises.
    pub tongue: Option<Gateway>,
    /// The text reader (OCR).
    pub reader: Option<Tesseract>,
}

/// The result for a crop: its reading, empty if it could not be read, and the dialogue.
pub type Described = (CropReading, Vec<TranscriptStep>);

impl Describer {
    /// Returns a copy whose calls are charged to this payer.
    pub fn paid_by(&self, payer: Option<DayLimit>) -> Self {
        let paid = |gateway: &Option<Gateway>| gateway.as_ref().map(|gateway| gateway.paid_by(payer));
        Self { eyes: paid(&self.eyes), tongue: paid(&self.tongue), reader: self.reader.clone() }
    }

    /// Returns the hash of all inputs of a description beside the crop; `None` without a describer.
    pub fn fingerprint(&self) -> Option<String> {
        let models = [&self.eyes, &self.tongue].map(|model| model.as_ref().map(Gateway::fingerprint));
        let reader = if self.reader.is_some() { tesseract::SOURCE } else { "" };
        let [eyes, tongue] = models.map(Option::unwrap_or_default);
        self.reads().then(|| format!("{eyes}.{tongue}.{reader}"))
    }

    /// Whether it can read crops.
    pub fn reads(&self) -> bool {
        self.eyes.is_some() || self.reader.is_some()
    }

    /// Describes an object of a class; `text` is the client's reading, if that is insufficient.
    pub async fn describe(
        &self,
        picture: Arc<Picture>,
        class: &str,
        text: Option<&str>,
    ) -> Result<Described, Fault> {
        let mut transcript = Vec::new();
        let read = self.read(&picture, &mut transcript).await;
        let Some(eyes) = &self.eyes else { return Ok(by_reader(read, false, transcript)) };
        let hint = read.clone().or_else(|| text.map(semantics::clean));
        let hint = hint.filter(|hint| !says_nothing(hint) && !semantics::addresses_a_model(hint));
        let mut dialogue =
            Dialogue { describer: self, eyes, picture, class: class_name(class), hint, transcript };
        match dialogue.hold().await {
            Ok((text, degraded)) => {
                let text = text.into();
                let reading = CropReading { text, source: eyes.source(), described: true, degraded };
                Ok((reading, dialogue.transcript))
            }
            // The reader substitutes, and the crop is described again once the model is available.
            Err(_) if read.is_some() => Ok(by_reader(read, true, dialogue.transcript)),
            Err(fault) => Err(fault),
        }
    }

    /// Returns the OCR reading, if there is one.
    async fn read(&self, picture: &Arc<Picture>, transcript: &mut Vec<TranscriptStep>) -> Option<String> {
        let reader = self.reader.as_ref()?;
        let read = match reader.read(picture.clone()).await {
            Ok(read) => read,
            Err(error) => {
                tracing::warn!(%error, "the reader failed");
                return None;
            }
        };
        transcript.push(step(tesseract::SOURCE.into(), "(one line of characters)", &read));
        Some(read).filter(|read| !says_nothing(read))
    }
}

fn by_reader(read: Option<String>, degraded: bool, transcript: Vec<TranscriptStep>) -> Described {
    let (text, source) = (read.unwrap_or_default().into(), tesseract::SOURCE.into());
    (CropReading { text, source, described: false, degraded }, transcript)
}

fn step(speaker: Arc<str>, question: &str, answer: &str) -> TranscriptStep {
    TranscriptStep { speaker, question: question.to_owned(), answer: answer.to_owned() }
}

/// Returns the distinct contents of the answers.
pub(super) fn summary(history: &[Round]) -> String {
    let told = history.iter().map(|round| round.answer.as_str());
    let informative = told.filter(|answer| Text::parse(answer).information_level() > 1);
    informative
        .map(str::to_owned)
        .reduce(|all, answer| semantics::merge(&all, &answer))
        .unwrap_or_else(|| UNKNOWN.to_owned())
}

/// Returns the maximum rounds of a dialogue about an object of a class.
pub(super) fn rounds_of(class: &str) -> usize {
    if is_picture(class) { ROUNDS_OF_PICTURE } else { ROUNDS_OF_PLATE }
}

fn is_picture(class: &str) -> bool {
    let class = class.to_lowercase();
    PICTURES.iter().any(|picture| class.contains(picture))
}

struct Dialogue<'a> {
    describer: &'a Describer,
    eyes: &'a Gateway,
    picture: Arc<Picture>,
    class: String,
    hint: Option<String>,
    transcript: Vec<TranscriptStep>,
}

impl Dialogue<'_> {
    /// Asks until enough is known; returns the description, and whether the model was unavailable for a part of it.
    async fn hold(&mut self) -> Result<(String, bool), Fault> {
        // All questions, with "unknown" for those without an answer; and the useful answers.
        let (mut asked, mut rounds): (Vec<Round>, Vec<Round>) = (Vec::new(), Vec::new());
        let (mut silent, mut settled, mut flagged) = (0, false, false);
        for number in 0..rounds_of(&self.class) {
            let question = self.question(number, &asked).await;
            let answer = self.look(&question, number, &asked).await?;
            let told = useful(&question, &answer, &rounds);
            let is_flagged = told.as_deref().is_some_and(semantics::addresses_a_model);
            if is_flagged {
                tracing::warn!(
                    class = self.class,
                    text = told,
                    "a sign addresses a model: kept, not sent on"
                );
                flagged = true;
            }
            let shown = if is_flagged { Some(WITHHELD) } else { told.as_deref() };
            let shown = shown.unwrap_or(UNKNOWN).to_owned();
            asked.push(Round { question: question.clone(), answer: shown });
            silent = if told.is_some() { 0 } else { silent + 1 };
            rounds.extend(told.map(|answer| Round { question, answer }));
            settled = read_twice_alike(&rounds);
            if settled || silent == SILENT_ANSWERS_MAX {
                break;
            }
        }
        if rounds.is_empty() {
            return Ok((String::new(), false));
        }
        let own = summary(&rounds);
        // Without the flagged answer a model's summary would omit the sign.
        let Some(tongue) = self.describer.tongue.as_ref().filter(|_| !settled && !flagged) else {
            return Ok((own, false));
        };
        Ok(match self.sum_up(tongue, &rounds).await {
            Ok(summary) if is_backed(&summary, &rounds) => (summary, false),
            told => (own, told.is_err()),
        })
    }

    async fn question(&mut self, number: usize, rounds: &[Round]) -> String {
        if number == 0 {
            let class = self.class.replace('_', " ");
            return format!(
                "Which text, number, name or code is written on this {class}? Answer with the exact characters, or: unknown."
            );
        }
        if number == 1 && !is_picture(&self.class) {
            return AGAIN.to_owned();
        }
        let fixed = FIXED[(number - 1) % FIXED.len()].to_owned();
        let Some(tongue) = &self.describer.tongue else { return fixed };
        let question = Question::NextQuestion { class: self.class.clone(), history: rounds.to_vec() };
        let asked = tongue.ask(question).await.and_then(|asked| parse::next_question(&asked.content));
        match asked {
            Ok(asked) if rounds.iter().all(|round| round.question != asked) => asked,
            _ => fixed,
        }
    }

    async fn look(&mut self, question: &str, number: usize, rounds: &[Round]) -> Result<String, Fault> {
        // A second reading is independent only without the first.
        let history = if question == AGAIN { Vec::new() } else { rounds.to_vec() };
        let hint = self.hint.clone().filter(|_| number == 0);
        let look =
            Question::Look { picture: self.picture.clone(), question: question.to_owned(), history, hint };
        let answer = parse::look(&self.eyes.ask(look).await?.content)?;
        self.transcript.push(step(self.eyes.source(), question, &answer));
        Ok(answer)
    }

    async fn sum_up(&mut self, tongue: &Gateway, rounds: &[Round]) -> Result<String, Fault> {
        let question = Question::Summary { class: self.class.clone(), history: rounds.to_vec() };
        let summary = parse::text(&tongue.ask(question).await?.content)?;
        self.transcript.push(step(tongue.source(), "(summary)", &summary));
        Ok(summary)
    }
}

/// Returns an answer, unless it is empty or repeats an earlier one. A text that addresses a model is kept: "Level 5"
/// and "Shop assistant wanted" hang in buildings, and the built-in judge follows no instructions.
fn useful(question: &str, answer: &str, rounds: &[Round]) -> Option<String> {
    let text = Text::parse(answer);
    let echoes = text == Text::parse(question)
        || (!text.has_name() && rounds.iter().any(|round| Text::parse(&round.answer) == text));
    (!says_nothing(answer) && !echoes).then(|| answer.to_owned())
}

/// Whether an answer is empty, unsure, or a mere "no".
fn says_nothing(answer: &str) -> bool {
    let text = Text::parse(answer);
    let words = text.normalised();
    let denies = ["no text", "no number", "no name", "no code", "there is no", "none", "nothing", "no "];
    text.information_level() == 1
        || words == "no"
        || (!text.has_name() && denies.iter().any(|denial| words.starts_with(denial)))
}

/// Whether two answers have the same identifier.
fn read_twice_alike(rounds: &[Round]) -> bool {
    let values = |round: &Round| -> Vec<String> {
        Text::parse(&round.answer).names().map(|name| name.key().to_owned()).collect()
    };
    let Some((last, earlier)) = rounds.split_last() else { return false };
    let last = values(last);
    !last.is_empty() && earlier.iter().any(|round| values(round) == last)
}

/// Whether a summary is non-empty and contains only what was answered.
fn is_backed(summary: &str, rounds: &[Round]) -> bool {
    let answers: Vec<&str> = rounds.iter().map(|round| round.answer.as_str()).collect();
    let known: Vec<Text> = answers.iter().map(|answer| Text::parse(answer)).collect();
    let text = Text::parse(summary);
    let backs = |answer: &Text| answer.has_name() && !semantics::is_conflict(answer, &text);
    let backed = !text.has_name() || known.iter().any(backs);
    !says_nothing(summary)
        && backed
        && semantics::has_no_new_digits(summary, &answers)
        && !semantics::addresses_a_model(summary)
}
