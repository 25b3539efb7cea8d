//! Address: ids and queries become URLs, with every byte that needs it percent-encoded.

use std::fmt::Write as _;

use reqwest::Url;

use super::error::ClientError;

/// Returns the server's address in the form that paths are appended to.
pub(super) fn base_url(given: &str) -> Result<String, ClientError> {
    let refuse = |why: String| ClientError::Address { given: given.to_owned(), why };
    let url = Url::parse(given.trim()).map_err(|error| refuse(error.to_string()))?;
    match url.scheme() {
        "http" => {}
        "https" => {
            return Err(refuse("this build speaks plain http only; put a proxy in front for TLS".to_owned()));
        }
        other => return Err(refuse(format!("expected http://, got {other}://"))),
    }
    if url.query().is_some() || url.fragment().is_some() {
        return Err(refuse("an address has no query and no fragment".to_owned()));
    }
    Ok(url.as_str().trim_end_matches('/').to_owned())
}

/// `base/segment/segment?name=value`.
pub(super) fn url(base: &str, path: &[&str], query: &[(&str, String)]) -> Result<String, ClientError> {
    let mut url = base.to_owned();
    for segment in path {
        // URL parsers resolve these two, percent-encoded or not: such an id cannot be addressed.
        if matches!(*segment, "" | "." | "..") {
            return Err(ClientError::Id((*segment).to_owned()));
        }
        url.push('/');
        encode(segment, &mut url);
    }
    for (position, (name, value)) in query.iter().enumerate() {
        url.push(if position == 0 { '?' } else { '&' });
        encode(name, &mut url);
        url.push('=');
        encode(value, &mut url);
    }
    Ok(url)
}

/// Appends `text`, keeping RFC 3986's unreserved characters and the colon, which ids use.
fn encode(text: &str, url: &mut String) {
    for byte in text.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b':' => {
                url.push(char::from(byte));
            }
            _ => {
                let _ = write!(url, "%{byte:02X}");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_of_the_api_stays_readable_and_any_other_is_encoded() {
        let check = |id: &str, expected: &str| {
            let url = url("http://h:1", &["v1", "maps", id], &[]).expect("an address");
            assert_eq!(url, format!("http://h:1/v1/maps/{expected}"));
        };
        check("f03-001", "f03-001");
        check("a.b_c:d-E", "a.b_c:d-E");
        check("a/b?c#d", "a%2Fb%3Fc%23d");
        check("50% é", "50%25%20%C3%A9");
    }

    #[test]
    fn a_query_is_encoded_too() {
        let url = url("http://h", &["x"], &[("text", "a&b=c".to_owned()), ("limit", "2".to_owned())]);
        assert_eq!(url.expect("an address"), "http://h/x?text=a%26b%3Dc&limit=2");
    }

    #[test]
    fn a_dot_is_no_addressable_id() {
        for id in ["", ".", ".."] {
            assert!(matches!(url("http://h", &["v1", id], &[]), Err(ClientError::Id(_))));
        }
    }

    #[test]
    fn an_address_is_plain_http() {
        let check = |given: &str, expected: &str| {
            let base = base_url(given).map_err(|error| error.to_string());
            assert_eq!(base.as_deref(), Ok(expected));
        };
        check("http://127.0.0.1:7878", "http://127.0.0.1:7878");
        check("http://127.0.0.1:7878/", "http://127.0.0.1:7878");
        check("http://proxy/robots/", "http://proxy/robots");
        for refused in ["https://h", "127.0.0.1:7878", "localhost:7878", "http://h/?x=1", ""] {
            assert!(base_url(refused).is_err(), "{refused:?} was taken");
        }
    }
}
