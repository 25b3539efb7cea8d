//! TLS: the one implementation of its cryptography, chosen before the first client is made.

/// Installs *ring* for this process, unless something is installed already. Without it every HTTP client panics
/// when it is made; twice does no harm.
pub fn install() {
    // Fails if a provider is installed, which is what is wanted.
    let _ = rustls::crypto::ring::default_provider().install_default();
}
