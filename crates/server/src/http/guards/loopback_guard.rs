//! Loopback guard: without keys, admits only programs of this machine, and no web page of another origin.
//!
//! A browser is a program of this machine that web pages control. A page can resolve its own name to this address (DNS
//! rebinding); the browser then sends that name as the host. A page can also send requests without reading the
//! response, which is enough to write; the browser then sends the page's origin.

use std::net::IpAddr;

use axum::http::header::{HOST, ORIGIN};
use axum::http::request::Parts;
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName};

use crate::domain::invalid::FieldError;
use crate::http::problem::{Kind, Problem};

/// The header with a browser's relation of page and server.
const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Rejects requests that a web page of another origin could have made a local browser send.
pub fn check(parts: &Parts) -> Result<(), Problem> {
    by_an_own_name(parts)?;
    // A safe method changes nothing, and the page cannot read the response.
    if parts.method.is_safe() { Ok(()) } else { for_no_page_from_elsewhere(parts) }
}

/// Returns the host names of the request.
fn asked(parts: &Parts) -> impl Iterator<Item = Authority> {
    let headers = texts(&parts.headers, &HOST).filter_map(|host| host?.parse().ok());
    parts.uri.authority().cloned().into_iter().chain(headers)
}

/// Accepts IP addresses and `localhost`, which cannot be rebound.
fn by_an_own_name(parts: &Parts) -> Result<(), Problem> {
    let name = |asked: Authority| asked.host().trim_matches(['[', ']']).to_ascii_lowercase();
    let is_ours =
        |name: &String| name.parse::<IpAddr>().is_ok() || name == "localhost" || name.ends_with(".localhost");
    let Some(name) = asked(parts).map(name).find(|name| !is_ours(name)) else { return Ok(()) };
    let detail = format!(
        "a server without keys accepts IP addresses and localhost as its host, not {name}, which a web page could have resolved \
         to this address; `revisit keys create` creates a key"
    );
    Err(Problem::new(Kind::FORBIDDEN, detail))
}

/// Accepts requests without these headers (robots, curl) and those of the viewer.
fn for_no_page_from_elsewhere(parts: &Parts) -> Result<(), Problem> {
    let host = asked(parts).next();
    let is_here = |origin: &str| {
        // Authorities compare case-insensitively; `null` is another origin, too.
        let page = origin.split_once("://").and_then(|(_, page)| page.parse::<Authority>().ok());
        page.is_some() && page == host
    };
    let foreign = |name: HeaderName, limit: &str, is_ours: &dyn Fn(&str) -> bool| {
        let value = texts(&parts.headers, &name).find(|value| !value.is_some_and(is_ours))?;
        let fault = FieldError::new(format!("{name}:"), "the request is from a web page of another origin");
        Some(fault.got(value.unwrap_or("no text")).limit(limit))
    };
    let faults: Vec<FieldError> = [
        foreign(ORIGIN, "the server's own", &is_here),
        foreign(SEC_FETCH_SITE, "same-origin or none", &|site| ["same-origin", "none"].contains(&site)),
    ]
    .into_iter()
    .flatten()
    .collect();
    if faults.is_empty() {
        return Ok(());
    }
    let detail = "a server without keys rejects changes by web pages of another origin; `revisit keys create` creates a key";
    Err(Problem::new(Kind::FORBIDDEN, detail).with(faults))
}

/// Returns every value of a header; `None` for one that is not text.
fn texts<'h>(headers: &'h HeaderMap, name: &HeaderName) -> impl Iterator<Item = Option<&'h str>> {
    headers.get_all(name).iter().map(|value| value.to_str().ok())
}
