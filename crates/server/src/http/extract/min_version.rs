//! Minimum version: what a client has seen of a map, so that the answer is not older, whichever server gives it.

use axum::http::request::Parts;
use axum::http::uri::PathAndQuery;
use axum::http::{HeaderName, Method, Uri};

use crate::domain::invalid::FieldError;
use crate::http::problem::Problem;

/// The header that says it.
pub const MIN_VERSION: HeaderName = HeaderName::from_static("x-revisit-min-version");

/// The parameter that says it, where setting a header is a burden.
const PARAMETER: &str = "min_version";

/// Takes the minimum version from a request about a map, given as a parameter or as a header. Only requests that read have one.
pub fn take_min_version(parts: &mut Parts, route: &str) -> Result<Option<u64>, Problem> {
    let headers = parts.headers.get_all(MIN_VERSION).iter().count();
    let header = parts.headers.remove(MIN_VERSION);
    let parameter = take_parameter(&mut parts.uri)?;
    if headers + usize::from(parameter.is_some()) > 1 {
        return Err(Problem::invalid(vec![FieldError::new(format!("{MIN_VERSION}:"), "given twice")]));
    }
    let (place, text) = match (&parameter, &header) {
        (Some(text), _) => (format!("?{PARAMETER}"), text.as_str()),
        (None, Some(header)) => (format!("{MIN_VERSION}:"), header.to_str().unwrap_or_default().trim()),
        (None, None) => return Ok(None),
    };
    let fault = |detail: &str| Problem::invalid(vec![FieldError::new(place.clone(), detail).got(text)]);
    if !reads(&parts.method, route) {
        return Err(fault("only what reads a map has a minimum version"));
    }
    let version = text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok()).flatten();
    version.map(Some).ok_or_else(|| fault("is not a version: a whole number"))
}

/// Whether a request reads a map and changes nothing of it.
fn reads(method: &Method, route: &str) -> bool {
    matches!(*method, Method::GET | Method::HEAD)
        || *method == Method::POST && route.ends_with("/loop-queries")
}

/// Takes the parameter out of the query.
fn take_parameter(uri: &mut Uri) -> Result<Option<String>, Problem> {
    let Some(query) = uri.query().filter(|query| query.contains(PARAMETER)) else { return Ok(None) };
    let is_it = |pair: &&str| pair.split('=').next() == Some(PARAMETER);
    let (given, others): (Vec<&str>, Vec<&str>) = query.split('&').partition(is_it);
    let value = match given.as_slice() {
        [] => return Ok(None),
        [one] => one.split_once('=').map_or("", |(_, value)| value).to_owned(),
        _ => return Err(Problem::invalid(vec![FieldError::new(format!("?{PARAMETER}"), "given twice")])),
    };
    let left = if others.is_empty() {
        uri.path().to_owned()
    } else {
        format!("{}?{}", uri.path(), others.join("&"))
    };
    let mut parts = std::mem::take(uri).into_parts();
    parts.path_and_query = PathAndQuery::try_from(left).ok();
    *uri = Uri::from_parts(parts).unwrap_or_default();
    Ok(Some(value))
}

#[cfg(test)]
mod tests {
    use axum::extract::Request;

    use super::*;

    #[test]
    fn is_taken_from_what_reads_and_leaves_the_rest_of_the_query() {
        let route = "/v1/maps/{map}/anchors";
        let cases = [
            ("GET", "/v1/maps/m/anchors", None, Ok((None, "/v1/maps/m/anchors"))),
            ("GET", "/v1/maps/m/anchors?min_version=7", None, Ok((Some(7), "/v1/maps/m/anchors"))),
            (
                "GET",
                "/v1/maps/m/anchors?a=1&min_version=7&b=2",
                None,
                Ok((Some(7), "/v1/maps/m/anchors?a=1&b=2")),
            ),
            (
                "HEAD",
                "/v1/maps/m/anchors?a=min_version",
                Some("9"),
                Ok((Some(9), "/v1/maps/m/anchors?a=min_version")),
            ),
            ("GET", "/v1/maps/m/anchors?min_version=7", Some("9"), Err(())),
            ("GET", "/v1/maps/m/anchors?min_version=7&min_version=7", None, Err(())),
            ("GET", "/v1/maps/m/anchors?min_version=-1", None, Err(())),
            ("GET", "/v1/maps/m/anchors?min_version", None, Err(())),
            ("GET", "/v1/maps/m/anchors?min_version=18446744073709551616", None, Err(())),
            ("GET", "/v1/maps/m/anchors", Some("seven"), Err(())),
            ("PUT", "/v1/maps/m/anchors", Some("7"), Err(())),
        ];
        for (method, uri, header, expected) in cases {
            let mut request = Request::builder().method(method).uri(uri);
            if let Some(header) = header {
                request = request.header(MIN_VERSION, header);
            }
            let (mut parts, ()) = request.body(()).unwrap().into_parts();
            let taken = take_min_version(&mut parts, route).map(|version| (version, parts.uri.to_string()));
            let expected = expected.map(|(version, uri)| (version, uri.to_owned()));
            assert_eq!(taken.map_err(drop), expected, "{method} {uri} {header:?}");
        }
    }
}
