//! TLS: the one cryptography provider, installed before the first client is created.

/// Returns a builder of HTTP clients for one address. The machine's certificates are read only for HTTPS, because a
/// small container has none and uses plain HTTP.
pub fn client_for(address: &str) -> reqwest::ClientBuilder {
    install();
    let builder = reqwest::Client::builder();
    if is_plain(address) { builder.tls_backend_preconfigured(trusting_nobody()) } else { builder }
}

/// Returns a builder of blocking HTTP clients for one address.
#[cfg(feature = "blocking")]
pub fn blocking_client_for(address: &str) -> reqwest::blocking::ClientBuilder {
    install();
    let builder = reqwest::blocking::Client::builder();
    if is_plain(address) { builder.tls_backend_preconfigured(trusting_nobody()) } else { builder }
}

/// Returns the cause of "error sending request" or "builder error", such as a refused connection or missing
/// certificates.
pub fn cause_of(error: &reqwest::Error) -> String {
    let mut cause: &dyn std::error::Error = error;
    while let Some(beneath) = cause.source() {
        cause = beneath;
    }
    cause.to_string()
}

fn is_plain(address: &str) -> bool {
    address.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("http:"))
}

fn trusting_nobody() -> rustls::ClientConfig {
    rustls::ClientConfig::builder()
        .with_root_certificates(rustls::RootCertStore::empty())
        .with_no_client_auth()
}

/// Installs *ring* for this process, unless a provider is installed already. Without one, creating an HTTP client
/// panics.
pub fn install() {
    // Fails if a provider is already installed, which is fine.
    let _ = rustls::crypto::ring::default_provider().install_default();
}
