//! Path: validated ids of a request's path.

use std::str::FromStr;

use axum::extract::{FromRequestParts, RawPathParams};
use axum::http::request::Parts;
use utoipa::IntoParams;

use crate::domain::ids::{
    BackupId, ID_FORM, IdError, JudgementId, KeyframeId, LoopId, MapId, PriorId, ReleaseName, SessionId,
};
use crate::domain::invalid::FieldError;
use crate::domain::prior::AnchorKey;
use crate::engine::ServiceError;
use crate::http::problem::{Kind, Problem};

/// Makes extractors of the ids that a path names, which are its parameters in the API document.
macro_rules! paths {
    ($($(#[doc = $about:literal])+ $path:ident { $($(#[doc = $doc:literal])+ $field:ident: $id:ty,)+ })+) => {
        $(
            $(#[doc = $about])+
            #[derive(IntoParams)]
            #[into_params(parameter_in = Path)]
            pub struct $path {
                $($(#[doc = $doc])+
                #[param(
                    value_type = String, min_length = 1, max_length = 128,
                    pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$"
                )]
                pub $field: $id,)+
            }

            impl<S: Send + Sync> FromRequestParts<S> for $path {
                type Rejection = Problem;

                async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
                    let mut named = Named::of(parts, state).await?;
                    let ($($field,)+) = ($(named.id(stringify!($field)),)+);
                    match ($($field,)+) {
                        ($(Some($field),)+) => Ok(Self { $($field,)+ }),
                        _ => Err(Problem::invalid(named.faults)),
                    }
                }
            }
        )+
    };
}

paths! {
    /// A map.
    MapPath {
        /// The map's id, chosen by its client.
        map: MapId,
    }
    /// A keyframe of a map.
    KeyframePath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The keyframe's id, chosen by its client.
        keyframe: KeyframeId,
    }
    /// An anchor of a map.
    AnchorPath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The anchor's id: `a-7`, assigned by the service, or the name of a prior anchor, chosen by its client.
        anchor: AnchorKey,
    }
    /// A prior anchor of a map, to be put.
    PriorPath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The name of a prior anchor, chosen by its client.
        anchor: PriorId,
    }
    /// A confirmed loop of a map.
    LoopPath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The loop's id, chosen by its client.
        r#loop: LoopId,
    }
    /// A session of a map.
    SessionPath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The session's id, chosen by its client.
        session: SessionId,
    }
    /// An erasure of a map.
    ErasurePath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The erasure's id, such as `e-1`, assigned by the service.
        erasure: KeyframeId,
    }
    /// A release of a map.
    ReleasePath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The release's name, chosen by who publishes it.
        release: ReleaseName,
    }
    /// A job that re-evaluates a map's verdicts.
    JudgementPath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The job's id, such as `j-7`, chosen by its client or assigned by the service.
        id: JudgementId,
    }
    /// An API key.
    KeyPath {
        /// The key's id, such as `key-7`, assigned by the service.
        id: KeyframeId,
    }
    /// A backup.
    BackupPath {
        /// The backup's id, chosen by who asked for it or assigned by the service.
        id: BackupId,
    }
    /// A stored loop query of a map.
    QueryPath {
        /// The map's id, chosen by its client.
        map: MapId,
        /// The query's id, as returned in its answer.
        query: KeyframeId,
    }
}

impl ErasurePath {
    /// Returns the erasure's number in its map.
    pub fn number(&self) -> Result<u64, ServiceError> {
        let number = self.erasure.as_str().strip_prefix("e-").and_then(|number| number.parse().ok());
        let missing = || format!("there is no erasure {} of map {}", self.erasure, self.map);
        number.ok_or_else(|| ServiceError::NotFound(missing()))
    }
}

/// The named parameters of a path, and the faults of those that were read.
struct Named {
    given: RawPathParams,
    faults: Vec<FieldError>,
}

impl Named {
    async fn of<S: Send + Sync>(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let malformed = |_| Problem::new(Kind::BAD_REQUEST, "the path is not percent-encoded UTF-8");
        let given = RawPathParams::from_request_parts(parts, state).await.map_err(malformed)?;
        Ok(Self { given, faults: Vec::new() })
    }

    /// Returns an id; `None` if a fault was noted.
    fn id<T: FromStr<Err = IdError>>(&mut self, field: &str) -> Option<T> {
        let name = field.trim_start_matches("r#");
        let text = self.given.iter().find(|&(given, _)| given == name).map_or("", |(_, text)| text);
        let fault = |error: IdError| FieldError::new(format!("{{{name}}}"), error.to_string());
        text.parse().map_err(|error| self.faults.push(fault(error).got(text).limit(ID_FORM))).ok()
    }
}
