//! Rules for tokens, from the operator's configuration.

use std::net::IpAddr;
use std::str::FromStr;

use jsonwebtoken::Algorithm;
use reqwest::Url;
use serde_json::{Map, Value};

use super::ring::is_known;

/// The claims of a token.
pub(super) type Claims = Map<String, Value>;

/// Rules for tokens, and the claims that are read.
#[derive(Debug, Clone)]
pub struct TokenRules {
    /// Who makes them.
    pub issuer: IssuerUrl,
    /// For whom they are made.
    pub audience: String,
    /// How they may be signed.
    pub algorithms: Vec<Algorithm>,
    /// The claim that names the client.
    pub client: Claim,
    /// The claim that names the user of the client; a token without it names none.
    pub user: Option<Claim>,
    /// The claim that makes an operator; without it no token does.
    pub operator: Option<ClaimValue>,
    /// The claim that makes an administrator; without it no token does. It wins over `operator`.
    pub administrator: Option<ClaimValue>,
}

/// The address of an identity provider, as its tokens have it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IssuerUrl {
    pub(super) text: String,
    url: Url,
}

impl IssuerUrl {
    /// Where its document of OpenID Connect Discovery is.
    pub(super) fn discovery(&self) -> String {
        let base = self.text.trim_end_matches('/');
        format!("{base}/.well-known/openid-configuration")
    }

    /// True if keys found at `url` are this issuer's: nobody on the way could have replaced them.
    pub(super) fn may_have_keys_at(&self, url: &Url) -> bool {
        url.scheme() == "https" || (self.url.scheme() == "http" && is_here(url))
    }
}

impl FromStr for IssuerUrl {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let url = Url::parse(text).map_err(|error| error.to_string())?;
        let is_plain = url.username().is_empty()
            && url.password().is_none()
            && url.query().is_none()
            && url.fragment().is_none();
        let is_safe = url.scheme() == "https" || (url.scheme() == "http" && is_here(&url));
        if !is_safe || !is_plain {
            return Err(
                "expected https:// (http:// on this machine alone), a host, and perhaps a path"
                    .to_owned(),
            );
        }
        let text = text.to_owned();
        Ok(Self { text, url })
    }
}

/// True if `url` is on this machine, so that its traffic needs no encryption.
fn is_here(url: &Url) -> bool {
    let host = url.host_str().unwrap_or_default();
    let literal = host.trim_start_matches('[').trim_end_matches(']');
    host == "localhost"
        || literal
            .parse()
            .is_ok_and(|address: IpAddr| address.is_loopback())
}

/// A claim: its name, or a JSON pointer into it, such as /realm_access/roles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim(String);

impl Claim {
    pub(super) fn of<'a>(&self, claims: &'a Claims) -> Option<&'a Value> {
        let Some(pointer) = self.0.strip_prefix('/') else {
            return claims.get(&self.0);
        };
        let (name, rest) = match pointer.split_once('/') {
            Some((name, _)) => (name, &pointer[name.len()..]),
            None => (pointer, ""),
        };
        let name = name.replace("~1", "/").replace("~0", "~");
        claims.get(&name)?.pointer(rest)
    }

    pub(super) fn name(&self) -> &str {
        &self.0
    }
}

impl FromStr for Claim {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.is_empty() {
            return Err("expected the name of a claim, or a JSON pointer".to_owned());
        }
        Ok(Self(text.to_owned()))
    }
}

/// A claim that is a word, or a list with it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClaimValue {
    claim: Claim,
    value: String,
}

impl ClaimValue {
    pub(super) fn is_in(&self, claims: &Claims) -> bool {
        let is_it = |value: &Value| value.as_str() == Some(&self.value);
        match self.claim.of(claims) {
            Some(Value::Array(values)) => values.iter().any(is_it),
            Some(value) => is_it(value),
            None => false,
        }
    }
}

impl FromStr for ClaimValue {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "expected CLAIM=VALUE, such as roles=meshwright-operator".to_owned();
        let (claim, value) = text.split_once('=').ok_or_else(wrong)?;
        if value.is_empty() {
            return Err(wrong());
        }
        Ok(Self {
            claim: claim.parse()?,
            value: value.to_owned(),
        })
    }
}

/// Reads an algorithm that tokens may be signed with.
///
/// # Errors
///
/// The algorithm of a name, or a sentence about the expected ones. Algorithms with a shared secret are refused: the service would have to keep the key that
/// makes tokens.
pub fn algorithm(text: &str) -> Result<Algorithm, String> {
    let algorithm = text.parse().ok().filter(|it| is_known(*it));
    algorithm.ok_or_else(|| {
        "expected RS256, RS384, RS512, PS256, PS384, PS512, ES256, ES384 or EdDSA".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_issuer_is_asked_by_https_and_on_this_machine_without() {
        for (text, keys, may) in [
            ("https://id.example", "https://keys.example/jwks", true),
            ("https://id.example", "http://id.example/jwks", false),
            ("https://id.example", "http://127.0.0.1/jwks", false),
            ("http://127.0.0.1:1/a/", "http://localhost/jwks", true),
            ("http://[::1]", "http://id.example/jwks", false),
        ] {
            let issuer: IssuerUrl = text.parse().unwrap();
            let keys = Url::parse(keys).unwrap();
            assert_eq!(issuer.may_have_keys_at(&keys), may, "{text} {keys}");
        }
        for text in [
            "",
            "id.example",
            "http://id.example",
            "http://10.0.0.1",
            "http://localhost.evil.example",
            "ftp://id.example",
            "https://user@id.example",
            "https://id.example?a",
            "https://id.example#a",
        ] {
            assert!(text.parse::<IssuerUrl>().is_err(), "{text}");
        }
        let slash: IssuerUrl = "https://id.example/a/".parse().unwrap();
        assert_eq!(
            slash.discovery(),
            "https://id.example/a/.well-known/openid-configuration"
        );
    }

    #[test]
    fn a_claim_is_found_by_its_name_or_by_a_pointer() {
        let claims = json!({
            "sub": "a", "https://x/roles": ["r"], "realm": { "roles": ["b", 7] }, "a/b": "c", "role": "operator at large",
        });
        let claims = claims.as_object().unwrap();
        let of = |text: &str| text.parse::<Claim>().unwrap().of(claims).cloned();
        assert_eq!(of("sub"), Some(json!("a")));
        assert_eq!(of("/sub"), Some(json!("a")));
        assert_eq!(of("https://x/roles"), Some(json!(["r"])));
        assert_eq!(of("/realm/roles/0"), Some(json!("b")));
        assert_eq!(of("/a~1b"), Some(json!("c")));
        assert_eq!(
            (of("realm/roles"), of("/none/x"), of("/")),
            (None, None, None)
        );
        let is_in = |text: &str| text.parse::<ClaimValue>().unwrap().is_in(claims);
        assert!(is_in("sub=a") && is_in("/realm/roles=b") && is_in("https://x/roles=r"));
        assert!(!is_in("role=operator") && !is_in("/realm/roles=7") && !is_in("none=a"));
        for text in ["", "sub", "sub=", "=a"] {
            assert!(text.parse::<ClaimValue>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_secret_that_both_sides_know_signs_no_token() {
        assert_eq!(algorithm("ES256"), Ok(Algorithm::ES256));
        for text in ["HS256", "HS512", "none", "", "es256"] {
            assert!(algorithm(text).is_err(), "{text}");
        }
    }
}
