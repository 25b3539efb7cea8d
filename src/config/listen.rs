//! Listen address: parsing, and whether other machines can reach it.

use std::net::{SocketAddr, ToSocketAddrs};

/// Parses `--listen`: `ADDRESS:PORT` or `NAME:PORT`. Port 0 picks a free one.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    let expected = "expected ADDRESS:PORT, such as 127.0.0.1:7878 or [::1]:7878";
    let mut found = text.to_socket_addrs().map_err(|error| format!("{expected} ({error})"))?;
    found.next().ok_or_else(|| expected.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

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
