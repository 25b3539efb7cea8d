//! Loopback guard: without keys, admits only programs of this machine, and no web page from elsewhere.
//!
//! A browser is a program of this machine that does what pages tell it. A page from elsewhere can make its own name lead
//! here (DNS rebinding); then the browser still tells that name. And it can send to the address itself without being
//! allowed to see the answer, which is enough to write; then the browser tells where the page is from.

use std::net::IpAddr;

use axum::http::header::{HOST, ORIGIN};
use axum::http::request::Parts;
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName};

use crate::domain::invalid::FieldError;
use crate::http::problem::{Kind, Problem};

/// How far the page is away for which a browser asks.
const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Refuses what a web page from elsewhere could have made a browser of this machine send.
pub fn check(parts: &Parts) -> Result<(), Problem> {
    by_an_own_name(parts)?;
    // What changes nothing tells a page nothing: it does not get to see the answer.
    if parts.method.is_safe() { Ok(()) } else { for_no_page_from_elsewhere(parts) }
}

/// Returns the names by which the server was asked.
fn asked(parts: &Parts) -> impl Iterator<Item = Authority> {
    let headers = texts(&parts.headers, &HOST).filter_map(|host| host?.parse().ok());
    parts.uri.authority().cloned().into_iter().chain(headers)
}

/// Addresses and `localhost` cannot be made to lie.
fn by_an_own_name(parts: &Parts) -> Result<(), Problem> {
    let name = |asked: Authority| asked.host().trim_matches(['[', ']']).to_ascii_lowercase();
    let is_ours =
        |name: &String| name.parse::<IpAddr>().is_ok() || name == "localhost" || name.ends_with(".localhost");
    let Some(name) = asked(parts).map(name).find(|name| !is_ours(name)) else { return Ok(()) };
    let detail = format!(
        "a server without keys answers to addresses and to localhost, not to {name}: a web page could have made that name \
         lead here; `revisit keys create` makes a key"
    );
    Err(Problem::new(Kind::FORBIDDEN, detail))
}

/// Robots and curl send neither header, the viewer's own are of this server.
fn for_no_page_from_elsewhere(parts: &Parts) -> Result<(), Problem> {
    let host = asked(parts).next();
    let is_here = |origin: &str| {
        // An authority is equal to another whatever the case of its letters; `null` is no page of ours either.
        let page = origin.split_once("://").and_then(|(_, page)| page.parse::<Authority>().ok());
        page.is_some() && page == host
    };
    let foreign = |name: HeaderName, limit: &str, is_ours: &dyn Fn(&str) -> bool| {
        let value = texts(&parts.headers, &name).find(|value| !value.is_some_and(is_ours))?;
        let fault = FieldError::new(format!("{name}:"), "the request is of a web page from elsewhere");
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
    let detail = "a server without keys changes nothing for web pages from elsewhere; `revisit keys create` makes a key";
    Err(Problem::new(Kind::FORBIDDEN, detail).with(faults))
}

/// Every value of a header; `None` for one that is no text.
fn texts<'h>(headers: &'h HeaderMap, name: &HeaderName) -> impl Iterator<Item = Option<&'h str>> {
    headers.get_all(name).iter().map(|value| value.to_str().ok())
}
