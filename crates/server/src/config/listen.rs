//! Listen address: parsing, and whether other machines can reach it.

use std::net::{SocketAddr, ToSocketAddrs};

/// Parses `--listen`: `ADDRESS:PORT` or `NAME:PORT`. Port 0 picks a free one.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    let expected = "expected ADDRESS:PORT, such as 127.0.0.1:7878 or [::1]:7878";
    let mut found = text.to_socket_addrs().map_err(|error| format!("{expected} ({error})"))?;
    found.next().ok_or_else(|| expected.to_owned())
}

/// Parses `--advertise`: `http://HOST:PORT` or `https://HOST`, without a path.
pub fn peer(text: &str) -> Result<String, String> {
    let expected = "expected an address such as http://10.0.0.7:7878";
    let address = text.trim_end_matches('/');
    let host =
        address.strip_prefix("http://").or_else(|| address.strip_prefix("https://")).ok_or(expected)?;
    let is_host = !host.is_empty() && !host.contains(['/', '?', '#', '@', ' ']);
    if is_host { Ok(address.to_owned()) } else { Err(expected.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_servers_are_given_an_address_without_a_path() {
        assert_eq!(peer("http://10.0.0.7:7878/").expect("an address"), "http://10.0.0.7:7878");
        assert!(peer("https://revisit-0.revisit").is_ok());
        for malformed in ["10.0.0.7:7878", "http://", "http://host/path", "ftp://host", "http://a@b"] {
            assert!(peer(malformed).is_err(), "{malformed}");
        }
    }

    #[test]
    fn an_address_has_a_port() {
        for good in ["127.0.0.1:0", "[::1]:7878", "0.0.0.0:7878"] {
            assert!(address(good).is_ok(), "{good}");
        }
        for malformed in ["127.0.0.1", ":", ""] {
            let error = address(malformed).expect_err(malformed);
            assert!(error.contains("expected ADDRESS:PORT"), "{error}");
        }
    }
}
