//! HTTP clients of this program.

use std::error::Error;
use std::time::Duration;

use reqwest::redirect::Policy;
use reqwest::{Client, ClientBuilder};

/// User agent of the program's own requests.
pub(crate) const AGENT: &str = concat!("Meshwright/", env!("CARGO_PKG_VERSION"));

/// A client to be set up. Its encryption is ring's; somebody who embeds the service may have chosen another before.
pub fn client() -> ClientBuilder {
    install_encryption();
    Client::builder()
}

/// Lets ring do the encryption of all clients.
pub(crate) fn install_encryption() {
    let _ = rustls::crypto::ring::default_provider().install_default();
}

/// One for the service itself: each answer comes in so much time, from where it was asked for.
pub(crate) fn bounded(time: Duration) -> ClientBuilder {
    client()
        .timeout(time)
        .redirect(Policy::none())
        .no_proxy()
        .user_agent(AGENT)
}

/// An error with its causes, without the address, which may have a secret in it.
pub(crate) fn unreachable(error: &dyn Error) -> String {
    let mut causes = Vec::new();
    let mut cause = error.source();
    while let Some(error) = cause {
        causes.push(error.to_string());
        cause = error.source();
    }
    if causes.is_empty() {
        "it cannot be reached".to_owned()
    } else {
        format!("it cannot be reached: {}", causes.join(": "))
    }
}
