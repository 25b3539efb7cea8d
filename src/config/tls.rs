//! TLS: the one implementation of its cryptography, chosen before the first client is made.

/// Returns a builder of HTTP clients for one address. The certificates of the machine are read only where they are
/// needed: a small container has none, and talks to its neighbours in plain HTTP.
pub fn client_for(address: &str) -> reqwest::ClientBuilder {
    install();
    let builder = reqwest::Client::builder();
    if is_plain(address) { builder.tls_backend_preconfigured(trusting_nobody()) } else { builder }
}

/// Returns the same for a thread of its own.
#[cfg(feature = "otel")]
pub fn blocking_client_for(address: &str) -> reqwest::blocking::ClientBuilder {
    install();
    let builder = reqwest::blocking::Client::builder();
    if is_plain(address) { builder.tls_backend_preconfigured(trusting_nobody()) } else { builder }
}

/// Returns what lies beneath "error sending request" or "builder error": that nobody listens, or that the machine has
/// no certificates.
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

/// Installs *ring* for this process, unless something is installed already. Without it every HTTP client panics
/// when it is made; twice does no harm.
pub fn install() {
    // Fails if a provider is installed, which is what is wanted.
    let _ = rustls::crypto::ring::default_provider().install_default();
}
