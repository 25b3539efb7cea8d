//! Names: the model's named values as the API writes them, and as the API document explains them.

use std::borrow::Cow;

use revisit_core::domain::anchor::{AnchorState, IgnoredReason};
use revisit_core::domain::channel::Channel;
use revisit_core::domain::erasure::ErasureState;
use revisit_core::domain::event::EventKind;
use revisit_core::domain::global_descriptor::GlobalEncoding;
use revisit_core::domain::judgement::Asks;
use revisit_core::domain::key::Action;
use revisit_core::domain::location::{Assumption, LocationVerdict, PoseSource};
use revisit_core::domain::loop_warning::LoopWarningCode;
use revisit_core::domain::reason::ReasonCode;
use revisit_core::domain::request::Detail;
use revisit_core::domain::verdict::{CandidateDecision, Decision, EvidenceKind, GeometryStatus, Verify};
use revisit_core::named::Named;
use revisit_core::semantics::TextKind;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::openapi::extensions::ExtensionsBuilder;
use utoipa::openapi::schema::{ObjectBuilder, SchemaType, Type};
use utoipa::openapi::{RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

use super::decoding::read::{Decode, Node};

/// A value of the model, written as its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Name<T>(pub T);

impl<T: Named> Decode for Name<T> {
    fn decode(node: &Node<'_>) -> Option<Self> {
        node.choice(T::NAMES, T::of_name).map(Self)
    }
}

/// An id, made by the client.
#[derive(ToSchema)]
#[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
pub struct Id(#[expect(dead_code, reason = "a schema only")] String);

/// The place of an enum in the API document.
pub trait Documented: Named {
    /// The schema's name.
    const SCHEMA: &'static str;

    /// Returns the meaning of a value in the API document.
    fn explained(self) -> String {
        self.meaning().to_owned()
    }
}

/// Ties the names in a shape to an enum of the model and to a schema of the API document.
macro_rules! names {
    ($($alias:ident = $type:ident as $schema:literal;)+) => {
        $(
            #[doc = concat!("A name of the schema `", $schema, "`.")]
            pub type $alias = Name<$type>;

            impl Documented for $type {
                const SCHEMA: &'static str = $schema;
            }
        )+
    };
}

names! {
    ActionName = Action as "ActionName";
    AnchorStateName = AnchorState as "AnchorState";
    AsksName = Asks as "JudgementAsks";
    ErasureStateName = ErasureState as "ErasureState";
    AssumptionName = Assumption as "Assumption";
    CandidateVerdictName = CandidateDecision as "CandidateVerdict";
    ChannelName = Channel as "Channel";
    DetailName = Detail as "Detail";
    EventName = EventKind as "EventKind";
    GeometryStatusName = GeometryStatus as "GeometryStatus";
    GlobalEncodingName = GlobalEncoding as "GlobalEncoding";
    IgnoredReasonName = IgnoredReason as "IgnoredReason";
    LocationVerdictName = LocationVerdict as "LocationVerdict";
    LoopWarningCodeName = LoopWarningCode as "LoopWarningCode";
    PoseSourceName = PoseSource as "PoseSource";
    TextKindName = TextKind as "TextKind";
    EvidenceKindName = EvidenceKind as "EvidenceKind";
    VerdictName = Decision as "Verdict";
    VerifyName = Verify as "Verify";
}

/// A name of the schema `ReasonCode`.
pub type ReasonCodeName = Name<ReasonCode>;

impl Documented for ReasonCode {
    const SCHEMA: &'static str = "ReasonCode";

    fn explained(self) -> String {
        format!("{} ({}).", self.explanation().trim_end_matches('.'), self.words().class.as_str())
    }
}

impl<T> From<T> for Name<T> {
    fn from(value: T) -> Self {
        Self(value)
    }
}

impl<T: Documented> ToSchema for Name<T> {
    fn name() -> Cow<'static, str> {
        T::SCHEMA.into()
    }
}

impl<T: Documented> PartialSchema for Name<T> {
    fn schema() -> RefOr<Schema> {
        let meanings: Vec<String> = T::VALUES.iter().map(|value| value.explained()).collect();
        let listed = T::NAMES.iter().zip(&meanings).map(|(name, meaning)| format!("- `{name}`: {meaning}"));
        let listed: Vec<String> = listed.collect();
        let meanings = meanings.into_iter().map(Value::String).collect();
        // Generators put these beside the values; people read the list.
        let extensions = ExtensionsBuilder::new().add("x-enum-descriptions", Value::Array(meanings)).build();
        ObjectBuilder::new()
            .schema_type(SchemaType::Type(Type::String))
            .description(Some(format!("{}\n\n{}", T::ABOUT, listed.join("\n"))))
            .enum_values(Some(T::NAMES.iter().copied()))
            .extensions(Some(extensions))
            .into()
    }
}
