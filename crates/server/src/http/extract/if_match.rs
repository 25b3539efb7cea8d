//! If-Match: the version of an anchor that a client has seen, so that two operators do not overwrite each other.

use axum::extract::FromRequestParts;
use axum::http::header::IF_MATCH;
use axum::http::request::Parts;

use crate::domain::invalid::FieldError;
use crate::http::problem::{Kind, Problem};

/// A version that no anchor ever has: an unknown tag matches nothing, and the service returns 404 or 412.
const NO_VERSION: u64 = u64::MAX;

/// The value of `if-match`, if present.
pub struct IfMatch(Option<Seen>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Seen {
    /// `*`: any version.
    Any,
    /// This version.
    Version(u64),
}

impl IfMatch {
    /// Returns the version (`None` for any), or the problem that the header is missing.
    pub fn required(self) -> Result<Option<u64>, Problem> {
        let detail = "send `if-match` with the anchor's `etag`, or `*` for any version";
        self.0.map(Seen::version).ok_or_else(|| Problem::new(Kind::PRECONDITION_REQUIRED, detail))
    }

    /// Returns the version; none without the header, which means any.
    pub fn optional(self) -> Option<u64> {
        self.0.and_then(Seen::version)
    }
}

impl Seen {
    fn version(self) -> Option<u64> {
        match self {
            Self::Any => None,
            Self::Version(version) => Some(version),
        }
    }
}

/// Returns a version as an entity tag.
pub fn etag(version: u64) -> String {
    format!("\"{version}\"")
}

impl<S: Send + Sync> FromRequestParts<S> for IfMatch {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let Some(header) = parts.headers.get(IF_MATCH) else { return Ok(Self(None)) };
        let text = header.to_str().unwrap_or_default().trim();
        read(text).map(|seen| Self(Some(seen))).ok_or_else(|| {
            let fault =
                FieldError::new("if-match:", "not an entity tag").got(text).limit("\"<version>\" or *");
            Problem::new(Kind::BAD_REQUEST, "`if-match` is malformed").with(vec![fault])
        })
    }
}

fn read(text: &str) -> Option<Seen> {
    if text == "*" {
        return Some(Seen::Any);
    }
    // A weak tag is well-formed and never matches (RFC 9110 §13.1.1).
    let (weak, tag) = text.strip_prefix("W/").map_or((false, text), |tag| (true, tag));
    let tag = tag.strip_prefix('"')?.strip_suffix('"')?;
    if tag.contains('"') {
        return None;
    }
    let version = tag.parse().ok().filter(|version: &u64| !weak && version.to_string() == tag);
    Some(Seen::Version(version.unwrap_or(NO_VERSION)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tag_is_a_version_or_matches_nothing_or_is_malformed() {
        assert_eq!(read("*"), Some(Seen::Any));
        assert_eq!(read("\"4\""), Some(Seen::Version(4)));
        for other in ["\"x\"", "W/\"4\"", "\"04\"", "\"\""] {
            assert_eq!(read(other), Some(Seen::Version(NO_VERSION)), "{other}");
        }
        for malformed in ["4", "\"4", "", "\"4\", \"5\""] {
            assert_eq!(read(malformed), None, "{malformed}");
        }
    }
}
