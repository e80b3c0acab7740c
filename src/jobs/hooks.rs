//! Webhooks as handlers see them: make, list, delete. Where they may lead is decided here and again at each delivery.

use std::net::IpAddr;
use std::str::FromStr;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use http::Uri;
use uuid::Uuid;

use super::addresses::is_public;
use super::error::JobError;
use super::queue::Jobs;
use super::store::{EventKind, NewWebhook, Webhook};

/// So many webhooks may a client have.
const MOST: i64 = 16;

/// So many bytes has the key of the signatures, as Standard Webhooks asks (24 to 64).
const SECRET_BYTES: usize = 32;

/// So many webhooks may a client have.
pub fn most_webhooks() -> i64 {
    MOST
}

/// Where messages may be sent.
#[derive(Clone)]
pub struct HookRules {
    /// The hosts; none: webhooks are off.
    pub allowed: Vec<HookTarget>,
    /// Whether an address may be connected to, after the name has been looked up. Only tests have another answer than
    /// [`is_public`].
    pub reachable: Arc<dyn Fn(IpAddr) -> bool + Send + Sync>,
}

impl HookRules {
    /// Messages to these hosts, at public addresses.
    pub fn to_public(allowed: Vec<HookTarget>) -> Self {
        Self {
            allowed,
            reachable: Arc::new(is_public),
        }
    }

    /// Whether messages may be sent to `url`.
    ///
    /// # Errors
    ///
    /// A sentence that says why not.
    pub(super) fn check(&self, url: &str) -> Result<(), String> {
        const LONGEST: usize = 2000;
        if self.allowed.is_empty() {
            return Err("Webhooks are off in this service.".to_owned());
        }
        let parsed = url
            .parse::<Uri>()
            .ok()
            .filter(|uri| url.len() <= LONGEST && uri.authority().is_some());
        let Some(uri) = parsed else {
            return Err(format!("{url:?} is not an address that can be sent to."));
        };
        if uri
            .authority()
            .is_some_and(|authority| authority.as_str().contains('@'))
        {
            return Err("The address of a webhook has no user or password in it.".to_owned());
        }
        let host = uri.host().unwrap_or_default().to_ascii_lowercase();
        let scheme = uri.scheme_str().unwrap_or_default();
        let usual = if scheme == "http" { 80 } else { 443 };
        let port = uri.port_u16().unwrap_or(usual);
        if !self
            .allowed
            .iter()
            .any(|target| target.takes(scheme, &host, port))
        {
            return Err(format!(
                "{scheme}://{host}:{port} is not among the hosts that this service sends to; ask its operator."
            ));
        }
        let literal = host.trim_start_matches('[').trim_end_matches(']');
        match literal.parse::<IpAddr>() {
            Ok(address) if !(self.reachable)(address) => {
                Err(format!("{address} is not a public address."))
            }
            _ => Ok(()),
        }
    }
}

/// A host that messages may be sent to: `hooks.example.com`, `*.example.com`, with a port if it is not 443, and with
/// `http://` before it if it has no encryption.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HookTarget {
    scheme: &'static str,
    host: String,
    any_below: bool,
    port: u16,
}

impl HookTarget {
    fn takes(&self, scheme: &str, host: &str, port: u16) -> bool {
        let host_fits = if self.any_below {
            host.strip_suffix(&self.host)
                .is_some_and(|below| below.len() > 1 && below.ends_with('.'))
        } else {
            host == self.host
        };
        scheme == self.scheme && port == self.port && host_fits
    }
}

impl FromStr for HookTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (scheme, rest) = match text.split_once("://") {
            Some(("http", rest)) => ("http", rest),
            Some(("https", rest)) => ("https", rest),
            Some((other, _)) => return Err(format!("{other} is neither http nor https")),
            None => ("https", text),
        };
        let (any_below, rest) = match rest.strip_prefix("*.") {
            Some(rest) => (true, rest),
            None => (false, rest),
        };
        let authority: http::uri::Authority = rest
            .parse()
            .map_err(|_| format!("{rest:?} is no host, or host and port"))?;
        if authority.as_str().contains(['@', '*']) || authority.host().is_empty() {
            return Err(format!("{rest:?} is no host, or host and port"));
        }
        let usual = if scheme == "http" { 80 } else { 443 };
        Ok(Self {
            scheme,
            host: authority.host().to_ascii_lowercase(),
            any_below,
            port: authority.port_u16().unwrap_or(usual),
        })
    }
}

/// A webhook that was made. The secret is told this once.
#[derive(Debug, Clone, PartialEq)]
pub struct NewHook {
    /// The webhook.
    pub webhook: Webhook,
    /// What its messages are signed with: `whsec_` and base64.
    pub secret: String,
}

impl Jobs {
    /// Makes a webhook.
    ///
    /// # Errors
    ///
    /// [`JobError::HookRefused`], [`JobError::TooManyHooks`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn add_webhook(
        &self,
        client: &str,
        rules: &HookRules,
        url: String,
        events: Vec<EventKind>,
    ) -> Result<NewHook, JobError> {
        self.refuse_if_failing()?;
        rules.check(&url).map_err(JobError::HookRefused)?;
        let mut secret = [0; SECRET_BYTES];
        getrandom::fill(&mut secret).map_err(|error| JobError::HookRefused(error.to_string()))?;
        let secret = BASE64.encode(secret);
        let webhook = Webhook {
            id: Uuid::now_v7(),
            url,
            events,
            created_at: self.clock.now(),
            disabled_at: None,
            problem: None,
        };
        let new = NewWebhook {
            webhook,
            client: client.to_owned(),
            secret,
            most: MOST,
        };
        if !self.store.add_webhook(&new).await? {
            return Err(JobError::TooManyHooks(MOST));
        }
        Ok(NewHook {
            secret: format!("whsec_{}", new.secret),
            webhook: new.webhook,
        })
    }

    /// The webhooks of a client, the oldest first.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn list_webhooks(&self, client: &str) -> Result<Vec<Webhook>, JobError> {
        Ok(self.store.list_webhooks(client).await?)
    }

    /// Removes a webhook and the messages that wait for it.
    ///
    /// # Errors
    ///
    /// [`JobError::HookNotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn delete_webhook(&self, client: &str, id: Uuid) -> Result<(), JobError> {
        if self.store.delete_webhook(client, id).await? {
            Ok(())
        } else {
            Err(JobError::HookNotFound(id))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_go_to_allowed_hosts_at_public_addresses_only() {
        let targets = [
            "hooks.example.com",
            "*.portal.example:8443",
            "http://plain.example",
            "10.0.0.1",
            "[::1]",
        ];
        let rules = HookRules::to_public(targets.map(|target| target.parse().unwrap()).to_vec());
        for url in [
            "https://hooks.example.com/a?b",
            "https://HOOKS.example.com:443/",
            "https://a.portal.example:8443/",
            "https://a.b.portal.example:8443/",
            "http://plain.example/",
        ] {
            assert_eq!(rules.check(url), Ok(()), "{url}");
        }
        for url in [
            "http://hooks.example.com/",
            "https://hooks.example.com:444/",
            "https://evil.example/",
            "https://hooks.example.com.evil.example/",
            "https://hooks.example.com@evil.example/",
            "https://user@hooks.example.com/",
            "https://portal.example:8443/",
            "https://evilportal.example:8443/",
            "https://plain.example/",
            "https://10.0.0.1/",
            "https://[::1]/",
            "ftp://hooks.example.com/",
            "hooks.example.com",
            "/path",
            "",
        ] {
            assert!(rules.check(url).is_err(), "{url}");
        }
        let off = HookRules::to_public(Vec::new());
        assert!(
            off.check("https://hooks.example.com/")
                .unwrap_err()
                .contains("off")
        );
        for target in ["", "ftp://x", "a b", "*", "user@host"] {
            assert!(target.parse::<HookTarget>().is_err(), "{target}");
        }
    }
}
