//! Listen: an address of this machine that nobody else can reach.

use std::net::{SocketAddr, ToSocketAddrs};

/// Reads `--listen`: `ADDRESS:PORT` or `NAME:PORT`, loopback only. Port 0 takes a free one.
///
/// There are no API keys yet: whoever reaches the port may delete every map. Until there are, only this machine may.
pub fn loopback(text: &str) -> Result<SocketAddr, String> {
    let expected = "expected ADDRESS:PORT, such as 127.0.0.1:7878 or [::1]:7878";
    let mut found = text.to_socket_addrs().map_err(|error| format!("{expected} ({error})"))?;
    let addr = found.next().ok_or(expected)?;
    if !addr.ip().is_loopback() {
        return Err(format!(
            "{addr} can be reached by other machines, and this version has no API keys to keep them out; listen on \
             127.0.0.1 or [::1], and let a proxy that authenticates stand in front"
        ));
    }
    Ok(addr)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_this_machine_may_connect() {
        assert!(loopback("127.0.0.1:0").is_ok());
        assert!(loopback("[::1]:7878").is_ok());
        for refused in ["0.0.0.0:7878", "[::]:7878", "192.168.0.1:80"] {
            let error = loopback(refused).expect_err(refused);
            assert!(error.contains("API keys"), "{error}");
        }
        for malformed in ["127.0.0.1", ":", ""] {
            let error = loopback(malformed).expect_err(malformed);
            assert!(error.contains("expected ADDRESS:PORT"), "{error}");
        }
    }
}
