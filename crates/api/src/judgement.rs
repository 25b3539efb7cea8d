//! Judgement: a job that asks a changed model again about what it judged before.

use revisit_core::domain::ids::JudgementId;
use revisit_core::domain::judgement::{JobState, Replaced};
use revisit_core::domain::report::JudgementReport;
use revisit_core::domain::request::NewJudgement;
use revisit_shapes::{answer, body};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::names::AsksName;

/// Microdollars in a dollar.
const MICROUSD: f64 = 1e6;

/// A job to be started, or to be counted first.
#[body(NewJudgement)]
#[derive(Default)]
pub struct JudgementBody {
    /// Its id; the server finds one if it is left out.
    #[id]
    pub id: Option<JudgementId>,
    /// The verdicts to ask for again.
    pub asks: Option<AsksName>,
    /// Only counts the questions and what they may cost, and starts nothing.
    #[schema(default = false)]
    pub preview: Option<bool>,
}

/// `preview`: only counted. `running`. `waiting`: running, while no model can be asked (none is configured, it is away,
/// or the day's budget is spent). `done`. `stopped`: by DELETE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = JudgementState)]
#[expect(missing_docs, reason = "said above")]
pub enum StateName {
    Preview,
    Running,
    Waiting,
    Done,
    Stopped,
}

/// A job that asks again, as it stands.
#[answer(of = JudgementReport)]
#[schema(as = Judgement)]
pub struct JudgementView {
    /// Its id; left out of a preview.
    #[from(&of.id)]
    pub id: Option<String>,
    /// The map's version.
    pub map_version: u64,
    /// Its state.
    #[is(state(&of))]
    pub state: StateName,
    /// The verdicts that it asks for again.
    pub asks: AsksName,
    /// Questions that other models or prompts answered than those configured now, as counted when the job began.
    pub questions: u64,
    /// The most calls of models that they may take; answers that are kept take none.
    #[from(of.estimate.calls)]
    pub calls_max: u64,
    /// The most that these calls may cost, in US dollars.
    #[is(of.estimate.microusd as f64 / MICROUSD)]
    pub cost_max_usd: f64,
    /// Questions answered otherwise than before.
    #[from(of.tally.changed)]
    pub changed: u64,
    /// Questions answered as before.
    #[from(of.tally.unchanged)]
    pub unchanged: u64,
    /// Questions about something that the map no longer holds.
    #[from(of.tally.gone)]
    pub gone: u64,
    /// Questions that the model did not answer, though it answered others; their verdicts stand.
    #[from(of.tally.failed)]
    pub failed: u64,
    /// Questions that are left.
    #[is(left(&of))]
    pub left: u64,
    /// Verdicts that were replaced by others since the job began, the newest first, at most 100 of them.
    pub replaced: Vec<ReplacedView>,
}

/// A verdict that was replaced, beside the one that stands now.
#[answer(of = Replaced)]
#[schema(as = ReplacedVerdict)]
pub struct ReplacedView {
    /// The version of the map that replaced it: earlier answers rest on the verdict before.
    pub map_version: u64,
    /// The question: `similarity`, `information`, `merge` or `describe`.
    pub operation: String,
    /// The class of the objects.
    pub class: String,
    /// The texts that were judged, in normal form; none of a crop.
    pub texts: Vec<String>,
    /// The keyframe of a crop.
    #[from(of.crop.as_ref().map(|(keyframe, _)| keyframe))]
    pub keyframe: Option<String>,
    /// The detection of a crop.
    #[is(of.crop.map(|(_, detection)| detection))]
    pub detection: Option<u16>,
    /// The level or the text that was replaced.
    #[from(of.before.0)]
    pub before: String,
    /// Its source.
    #[from(of.before.1)]
    pub source_before: String,
    /// The level or the text that stands now.
    #[from(of.after.0)]
    pub after: String,
    /// Its source.
    #[from(of.after.1)]
    pub source_after: String,
}

impl From<JudgementBody> for NewJudgement {
    fn from(JudgementBody { id, asks, preview }: JudgementBody) -> Self {
        Self { id, asks: asks.unwrap_or_default().0, preview: preview.unwrap_or(false) }
    }
}

fn state(report: &JudgementReport) -> StateName {
    match report.state {
        None => StateName::Preview,
        Some(JobState::Running) if report.waits => StateName::Waiting,
        Some(JobState::Running) => StateName::Running,
        Some(JobState::Done) => StateName::Done,
        Some(JobState::Stopped) => StateName::Stopped,
    }
}

fn left(report: &JudgementReport) -> u64 {
    let is_done = report.state == Some(JobState::Done);
    if is_done { 0 } else { report.questions.saturating_sub(report.tally.settled()) }
}
