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

/// A map.
pub struct MapPath(pub MapId);

/// A keyframe of a map.
pub struct KeyframePath {
    /// The map.
    pub map: MapId,
    /// The keyframe.
    pub keyframe: KeyframeId,
}

/// An anchor of a map.
pub struct AnchorPath {
    /// The map.
    pub map: MapId,
    /// The anchor.
    pub anchor: AnchorKey,
}

/// A prior anchor of a map, to be put.
pub struct PriorPath {
    /// The map.
    pub map: MapId,
    /// Its name.
    pub prior: PriorId,
}

/// A confirmed loop of a map.
pub struct LoopPath {
    /// The map.
    pub map: MapId,
    /// The loop.
    pub id: LoopId,
}

/// A session of a map.
pub struct SessionPath {
    /// The map.
    pub map: MapId,
    /// The session.
    pub session: SessionId,
}

/// A release of a map.
pub struct ReleasePath {
    /// The map.
    pub map: MapId,
    /// The release.
    pub release: ReleaseName,
}

/// An erasure of a map.
pub struct ErasurePath {
    /// The map.
    pub map: MapId,
    /// Its number.
    pub number: u64,
}

/// A job that re-evaluates a map's verdicts.
pub struct JudgementPath {
    /// The map.
    pub map: MapId,
    /// The job.
    pub id: JudgementId,
}

/// An API key.
pub struct KeyPath(pub KeyframeId);

/// A backup.
pub struct BackupPath(pub BackupId);

/// A stored loop query of a map.
pub struct QueryPath {
    /// The map.
    pub map: MapId,
    /// The query.
    pub query: String,
}

macro_rules! documented {
    ($($shape:ident { $($(#[$doc:meta])* $field:ident,)* })*) => {
        $(
            #[doc = "For the API document."]
            #[derive(IntoParams)]
            #[into_params(parameter_in = Path)]
            #[expect(dead_code, reason = "documents what the extractors read")]
            pub struct $shape {
                $($(#[$doc])*
                #[param(min_length = 1, max_length = 128, pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$")]
                $field: String,)*
            }
        )*
    };
}

documented! {
    MapPathParams {
        /// The map's id, chosen by its client.
        map,
    }
    KeyframePathParams {
        /// The map's id, chosen by its client.
        map,
        /// The keyframe's id, chosen by its client.
        keyframe,
    }
    AnchorPathParams {
        /// The map's id, chosen by its client.
        map,
        /// The anchor's id: `a-7`, assigned by the service, or the name of a prior anchor, chosen by its client.
        anchor,
    }
    LoopPathParams {
        /// The map's id, chosen by its client.
        map,
        /// The loop's id, chosen by its client.
        r#loop,
    }
    SessionPathParams {
        /// The map's id, chosen by its client.
        map,
        /// The session's id, chosen by its client.
        session,
    }
    ErasurePathParams {
        /// The map's id, chosen by its client.
        map,
        /// The erasure's id, such as `e-1`, assigned by the service.
        erasure,
    }
    ReleasePathParams {
        /// The map's id, chosen by its client.
        map,
        /// The release's name, chosen by who publishes it.
        release,
    }
    JudgementPathParams {
        /// The map's id, chosen by its client.
        map,
        /// The job's id, such as `j-7`, chosen by its client or assigned by the service.
        id,
    }
    KeyPathParams {
        /// The key's id, such as `key-7`, assigned by the service.
        id,
    }
    BackupPathParams {
        /// The backup's id, chosen by who asked for it or assigned by the service.
        id,
    }
    QueryPathParams {
        /// The map's id, chosen by its client.
        map,
        /// The query's id, as returned in its answer.
        query,
    }
}

/// The named parameters of a path.
struct Named(RawPathParams);

impl Named {
    async fn of<S: Send + Sync>(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let malformed = |_| Problem::new(Kind::BAD_REQUEST, "the path is not percent-encoded UTF-8");
        RawPathParams::from_request_parts(parts, state).await.map(Self).map_err(malformed)
    }

    fn id<T: FromStr<Err = IdError>>(&self, name: &str) -> Result<T, FieldError> {
        let text = self.0.iter().find(|&(given, _)| given == name).map_or("", |(_, text)| text);
        let fault = |error: IdError| FieldError::new(format!("{{{name}}}"), error.to_string());
        text.parse().map_err(|error| fault(error).got(text).limit(ID_FORM))
    }

    /// Returns two ids, or the faults of both.
    fn ids<A, B>(&self, first: &str, second: &str) -> Result<(A, B), Problem>
    where
        A: FromStr<Err = IdError>,
        B: FromStr<Err = IdError>,
    {
        match (self.id(first), self.id(second)) {
            (Ok(a), Ok(b)) => Ok((a, b)),
            (a, b) => Err(Problem::invalid([a.err(), b.err()].into_iter().flatten().collect())),
        }
    }
}

impl<S: Send + Sync> FromRequestParts<S> for MapPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let named = Named::of(parts, state).await?;
        named.id("map").map(Self).map_err(|fault| Problem::invalid(vec![fault]))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for KeyframePath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, keyframe) = Named::of(parts, state).await?.ids("map", "keyframe")?;
        Ok(Self { map, keyframe })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for AnchorPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, anchor) = Named::of(parts, state).await?.ids("map", "anchor")?;
        Ok(Self { map, anchor })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for PriorPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, prior) = Named::of(parts, state).await?.ids("map", "anchor")?;
        Ok(Self { map, prior })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for LoopPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, id) = Named::of(parts, state).await?.ids("map", "loop")?;
        Ok(Self { map, id })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for SessionPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, session) = Named::of(parts, state).await?.ids("map", "session")?;
        Ok(Self { map, session })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for ReleasePath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, release) = Named::of(parts, state).await?.ids("map", "release")?;
        Ok(Self { map, release })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for ErasurePath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, erasure): (MapId, KeyframeId) = Named::of(parts, state).await?.ids("map", "erasure")?;
        let number = erasure.as_str().strip_prefix("e-").and_then(|number| number.parse().ok());
        let missing = || ServiceError::NotFound(format!("there is no erasure {erasure} of map {map}"));
        Ok(Self { number: number.ok_or_else(missing)?, map })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for JudgementPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, id) = Named::of(parts, state).await?.ids("map", "id")?;
        Ok(Self { map, id })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for KeyPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let named = Named::of(parts, state).await?;
        named.id("id").map(Self).map_err(|fault| Problem::invalid(vec![fault]))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for BackupPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let named = Named::of(parts, state).await?;
        named.id("id").map(Self).map_err(|fault| Problem::invalid(vec![fault]))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for QueryPath {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let (map, query): (MapId, KeyframeId) = Named::of(parts, state).await?.ids("map", "query")?;
        Ok(Self { map, query: query.to_string() })
    }
}
