//! HTTP clients of this program.

/// A client to be set up. Its encryption is ring's; somebody who embeds the service may have chosen another before.
pub fn client() -> reqwest::ClientBuilder {
    let _ = rustls::crypto::ring::default_provider().install_default();
    reqwest::Client::builder()
}
