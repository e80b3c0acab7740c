//! HTTP clients of this program.

use std::time::Duration;

use reqwest::redirect::Policy;
use reqwest::{Client, ClientBuilder};

/// A client to be set up. Its encryption is ring's; somebody who embeds the service may have chosen another before.
pub fn client() -> ClientBuilder {
    let _ = rustls::crypto::ring::default_provider().install_default();
    Client::builder()
}

/// One for the service itself: each answer comes in so much time, from where it was asked for.
pub(crate) fn bounded(time: Duration) -> ClientBuilder {
    client()
        .timeout(time)
        .redirect(Policy::none())
        .no_proxy()
        .user_agent(concat!("Meshwright/", env!("CARGO_PKG_VERSION")))
}

/// An error with its causes, without the address, which may have a secret in it.
pub(crate) fn told(error: &reqwest::Error, time: Duration) -> String {
    let mut causes = Vec::new();
    let mut cause = std::error::Error::source(error);
    while let Some(error) = cause {
        causes.push(error.to_string());
        cause = error.source();
    }
    if error.is_timeout() {
        format!("no answer within {} s", time.as_secs())
    } else if causes.is_empty() {
        "it cannot be reached".to_owned()
    } else {
        format!("it cannot be reached: {}", causes.join(": "))
    }
}
