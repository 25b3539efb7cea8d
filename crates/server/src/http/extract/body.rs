//! Body: decodes a request's bytes within limits, and large ones off the async threads.

use axum::RequestExt as _;
use axum::extract::{FromRequest, Request};
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, EXPECT};
use bytes::Bytes;
use http_body_util::BodyExt as _;

use super::arriving_body::{Arriving, announced};
use super::body_errors::{broken, too_dense, too_large, too_many, unreadable};
use super::decompression::Encoding;
use super::path::{KeyframePath, MapPath};
use crate::api::decoding::document::Document;
use crate::api::decoding::read::{self, Decode};
use crate::api::decoding::syntax::{self, Unreadable};
use crate::api::keyframe::{self, Faulty, SentKeyframe};
use crate::api::limits;
use crate::config::logging::in_span;
use crate::domain::ids::MapId;
use crate::domain::keyframe::NewKeyframe;
use crate::domain::request::{Digest, LoopQuery};
use crate::http::App;
use crate::http::guards::body_memory::{BodyMemory, HeldMemory, becomes_at_most, decoded_bytes};
use crate::http::problem::{Kind, Problem};

/// Bodies up to this size are decoded in place, in less than a millisecond, where a thread would cost more. Larger ones would
/// delay other requests there, above all those that are only to be rejected, and they count their memory.
const SMALL_BODY_BYTES: usize = 96 << 10;

/// A JSON body, decoded into the model.
pub struct Body<T>(pub T);

impl<T: Decode + Send + 'static> FromRequest<App> for Body<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, app: &App) -> Result<Self, Problem> {
        let text = json_text(request, app).await?;
        decoded(text, app, |document| read::decode(document)).await?.map(Self).map_err(Problem::invalid)
    }
}

/// A keyframe in the body, named by the path.
pub struct KeyframeInPath {
    /// The path.
    pub place: KeyframePath,
    /// The keyframe.
    pub keyframe: NewKeyframe,
    /// The digest that tells a retry from another keyframe.
    pub digest: Digest,
}

impl FromRequest<App> for KeyframeInPath {
    type Rejection = Problem;

    async fn from_request(mut request: Request, app: &App) -> Result<Self, Problem> {
        let place: KeyframePath = request.extract_parts().await?;
        let id = place.keyframe.clone();
        let read = move |document: &Document<'_>| {
            let body = document.root();
            keyframe::named(body, &id).map_err(|faults| Faulty::of(faults, Some(body)))
        };
        let SentKeyframe { keyframe, digest } = checked_by_map(request, app, &place.map, "", read).await?;
        Ok(Self { place, keyframe, digest })
    }
}

/// A loop query in the body, about a map named by the path.
pub struct QueryOfMap {
    /// The map.
    pub map: MapId,
    /// The query.
    pub query: LoopQuery,
}

impl FromRequest<App> for QueryOfMap {
    type Rejection = Problem;

    async fn from_request(mut request: Request, app: &App) -> Result<Self, Problem> {
        let MapPath { map } = request.extract_parts().await?;
        let read = |document: &Document<'_>| {
            read::decode(document).map_err(|faults| Faulty::of(faults, document.root().get("inline")))
        };
        let query = checked_by_map(request, app, &map, "/inline", read).await?;
        Ok(Self { map, query })
    }
}

/// Reads a body with a keyframe at `place`, and tells all of its faults.
async fn checked_by_map<T: Send + 'static>(
    request: Request,
    app: &App,
    map: &MapId,
    place: &str,
    read: impl FnOnce(&Document<'_>) -> Result<T, Faulty> + Send + 'static,
) -> Result<T, Problem> {
    let text = json_text(request, app).await?;
    match decoded(text, app, read).await? {
        Ok(read) => Ok(read),
        Err(faulty) => Err(all_faults(app, map, place, faulty).await),
    }
}

/// Rejects a body with all of its faults, including those that only the map can reveal about the keyframe at `place`.
pub async fn all_faults(app: &App, map: &MapId, place: &str, mut faulty: Faulty) -> Problem {
    let declared = std::mem::take(&mut faulty.declared);
    // A failing map is not the subject of this error.
    let mut unknown = if declared.is_empty() {
        Vec::new()
    } else {
        app.service.unknown_covisible(map, declared).await.unwrap_or_default()
    };
    for fault in &mut unknown {
        fault.pointer.insert_str(0, place);
    }
    Problem::invalid(faulty.with(unknown))
}

/// A JSON text as received, not yet decoded.
#[derive(Debug)]
pub struct Text {
    bytes: Bytes,
    encoding: Encoding,
    /// Maximum size in memory if it was compressed.
    becomes_at_most: Option<usize>,
    held: HeldMemory,
}

impl Text {
    /// Returns a line of a body, with its maximum size in memory if the body was compressed.
    pub fn line(bytes: Bytes, becomes_at_most: Option<usize>) -> Self {
        Self { bytes, encoding: Encoding::Identity, becomes_at_most, held: HeldMemory::default() }
    }

    fn is_at_most(&self, bytes: usize) -> bool {
        self.encoding == Encoding::Identity && self.bytes.len() <= bytes
    }

    /// Inflates and decodes it, unless that exceeds the memory.
    fn decode<T>(
        &mut self,
        memory: &BodyMemory,
        read: impl FnOnce(&Document<'_>) -> T,
    ) -> Result<T, Problem> {
        if self.encoding != Encoding::Identity {
            self.inflate(memory)?;
        }
        let mut held = HeldMemory::default();
        memory.take(&mut held, decoded_bytes(&self.bytes))?;
        self.read(read)
    }

    /// Decodes it.
    fn read<T>(&self, read: impl FnOnce(&Document<'_>) -> T) -> Result<T, Problem> {
        if self.becomes_at_most.is_some_and(|most| decoded_bytes(&self.bytes) > most) {
            // What is no JSON is told so: how much of it there is does not matter.
            return syntax::check(&self.bytes).map_err(of_syntax).and(Err(too_dense()));
        }
        syntax::parse(&self.bytes).map(|document| read(&document)).map_err(of_syntax)
    }

    fn inflate(&mut self, memory: &BodyMemory) -> Result<(), Problem> {
        let most = becomes_at_most(self.bytes.len());
        let broken = |_: std::io::Error| broken();
        let length = self.encoding.length(&self.bytes, most.min(limits::BODY_BYTES)).map_err(broken)?;
        let length =
            length.ok_or_else(|| if most < limits::BODY_BYTES { too_dense() } else { too_large() })?;
        memory.take(&mut self.held, length)?;
        self.bytes = self.encoding.text(&self.bytes, length).map_err(broken)?.into();
        self.encoding = Encoding::Identity;
        self.becomes_at_most = Some(most);
        Ok(())
    }
}

/// Parses a text and reads its document, long ones on a blocking thread.
pub async fn decoded<T: Send + 'static>(
    mut text: Text,
    app: &App,
    read: impl FnOnce(&Document<'_>) -> T + Send + 'static,
) -> Result<T, Problem> {
    if text.is_at_most(SMALL_BODY_BYTES) {
        return text.read(read);
    }
    let memory = app.memory.clone();
    let turn = memory.turn().await;
    let decode = move || {
        let _turn = turn;
        text.decode(&memory, read)
    };
    let decoded = tokio::task::spawn_blocking(in_span(decode)).await;
    let decoded = decoded.unwrap_or_else(|error| Err(Problem::internal(error.to_string())));
    decoded.inspect_err(|problem| count(app, problem))
}

/// Counts a body shed for lack of memory.
fn count(app: &App, problem: &Problem) {
    if problem.is_overload() {
        app.metrics.shed("body");
    }
}

fn of_syntax(error: Unreadable) -> Problem {
    match error {
        Unreadable::Syntax(fault) => Problem::new(Kind::SYNTAX, fault.detail.clone()).with(vec![fault]),
        Unreadable::TooMany(what) => too_many(what),
    }
}

/// Rejects a body of any other type; a body without a type is accepted.
pub fn expect_type(
    headers: &HeaderMap,
    accepted: impl Fn(&str) -> bool,
    wanted: &str,
) -> Result<(), Problem> {
    let Some(given) = headers.get(CONTENT_TYPE) else { return Ok(()) };
    let given = given.to_str().unwrap_or_default();
    let essence = given.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    if accepted(&essence) {
        return Ok(());
    }
    // curl's default. Accepting it as JSON would let any web page write here, because browsers send it without CORS.
    let hint = if essence == "application/x-www-form-urlencoded" {
        format!("; with curl, add -H 'content-type: {wanted}'")
    } else {
        String::new()
    };
    Err(Problem::new(
        Kind::UNSUPPORTED_MEDIA_TYPE,
        format!("the content-type is {essence:?}, not {wanted}{hint}"),
    ))
}

async fn json_text(request: Request, app: &App) -> Result<Text, Problem> {
    let is_json = |essence: &str| essence == "application/json" || essence.ends_with("+json");
    expect_type(request.headers(), is_json, "application/json")?;
    let encoding = Encoding::of(request.headers())?;
    let announced = announced(request.headers());
    // A client that sends `expect` receives the error before it sends the body.
    if request.headers().contains_key(EXPECT) && announced > limits::BODY_BYTES {
        return Err(too_large());
    }
    let mut body = request.into_body();
    let mut arriving = Arriving::new(announced);
    while let Some(frame) = body.frame().await {
        let Ok(data) = frame.map_err(|error| unreadable(&error))?.into_data() else { continue };
        if !arriving.take(&data, &app.memory) {
            break;
        }
    }
    let (bytes, held) = arriving.whole().inspect_err(|problem| count(app, problem))?;
    Ok(Text { bytes, encoding, becomes_at_most: None, held })
}
