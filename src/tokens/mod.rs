//! Tokens of an identity provider, beside the service's own keys: JSON Web Tokens that say who a request is from, signed by one whom
//! the operator trusts (OpenID Connect).
//!
//! Configuration fixes the issuer, the audience and the algorithm of a token. Nothing in the token decides how it is checked, except the name of the key, which
//! is one of the issuer's.

mod provider;
mod ring;
mod rules;

use std::sync::Arc;
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use jsonwebtoken::errors::ErrorKind;
use jsonwebtoken::{Algorithm, DecodingKey, Header, Validation, decode, decode_header};

use self::provider::{Found, Provider};
use self::rules::Claims;
use crate::jobs::{Clock, Role};
use crate::keys::{is_client_name, is_user_name};

pub use self::rules::{Claim, ClaimValue, IssuerUrl, TokenRules, algorithm};

/// The clocks of the provider and of this machine may differ by so much.
const LEEWAY: SignedDuration = SignedDuration::from_secs(30);

/// The longest token that is looked at, in bytes.
const LONGEST: usize = 16 << 10;

/// Maximum number of characters of a token's claim in the log.
const LONGEST_LOGGED: usize = 200;

/// Issuers of tokens, and the rules for these.
#[derive(Clone)]
pub struct Tokens {
    rules: Arc<TokenRules>,
    provider: Arc<Provider>,
    clock: Clock,
}

/// Who a token says that its bearer is.
#[derive(Debug, Clone, PartialEq)]
pub struct Bearer {
    /// Whose jobs he reads and makes.
    pub client: String,
    /// Which user of the client he is.
    pub user: Option<String>,
    /// The role of the bearer.
    pub role: Role,
    /// From when on the token opens nothing.
    pub until: Timestamp,
    /// The provider's name for the bearer, for the log.
    pub subject: Option<String>,
    /// The provider's name for the token, for the log.
    pub id: Option<String>,
}

/// Why a token opens nothing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TokenError {
    /// The token is not trusted.
    #[error("{0}")]
    Refused(String),
    /// The token cannot be checked now.
    #[error("The identity provider gives no keys now, so that tokens cannot be checked.")]
    Unreachable,
}

fn refused(why: impl Into<String>) -> TokenError {
    TokenError::Refused(why.into())
}

/// True if a text has the form of a token: three parts in the alphabet of base64url.
pub fn has_form(text: &str) -> bool {
    let in_alphabet = |part: &str| {
        part.bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_')
    };
    text.split('.').count() == 3 && text.split('.').all(in_alphabet) && !text.starts_with('.')
}

impl Tokens {
    /// Tokens by these rules. The provider is asked for its keys meanwhile; a service without them still serves who has a key of its
    /// own. Each document of the provider has `provider_time` to come.
    ///
    /// # Errors
    ///
    /// When there is no encryption to be had.
    pub fn start(
        rules: TokenRules,
        clock: Clock,
        provider_time: Duration,
    ) -> Result<Self, reqwest::Error> {
        ring::install();
        let provider = Arc::new(Provider::new(
            rules.issuer.clone(),
            clock.clone(),
            provider_time,
        )?);
        provider.fetch_first();
        Ok(Self {
            rules: Arc::new(rules),
            provider,
            clock,
        })
    }

    /// The issuer of the tokens.
    pub fn issuer(&self) -> &str {
        &self.rules.issuer.text
    }

    /// True if the provider gave its keys at the last request.
    pub fn has_provider(&self) -> bool {
        self.provider.answers()
    }

    /// Who the bearer of a token is.
    ///
    /// # Errors
    ///
    /// [`TokenError`].
    pub async fn recognize(&self, token: &str) -> Result<Bearer, TokenError> {
        let header = self.rules.header(token)?;
        let id = header.kid.as_deref().unwrap_or_default();
        let key = match self.provider.key(id, header.alg).await {
            Found::Key(key) => key,
            Found::Unknown => {
                return Err(refused(
                    "The token names a key that its issuer does not have.",
                ));
            }
            Found::Unreachable => return Err(TokenError::Unreachable),
        };
        self.rules.read(token, header.alg, &key, self.clock.now())
    }
}

impl TokenRules {
    /// The head of a token that may be one of ours. Nobody has vouched for it yet.
    fn header(&self, token: &str) -> Result<Header, TokenError> {
        if token.len() > LONGEST {
            return Err(refused(format!(
                "The token has {} bytes; {LONGEST} are the most.",
                token.len()
            )));
        }
        let header = decode_header(token).map_err(|_| {
            refused("The token has no head that can be read, or no algorithm that there is.")
        })?;
        if !self.algorithms.contains(&header.alg) {
            return Err(refused(format!(
                "The token is signed by {:?}, which is not taken here.",
                header.alg
            )));
        }
        if header.crit.is_some() {
            return Err(refused(
                "The token asks for extensions (crit); none is known here.",
            ));
        }
        // Tokens that a provider signs for other purposes, for instance to log a user out, have a type of their own.
        let kind = header.typ.as_deref().unwrap_or("JWT").to_ascii_lowercase();
        let kind = kind.strip_prefix("application/").unwrap_or(&kind);
        if !matches!(kind, "jwt" | "at+jwt") {
            return Err(refused("The token is not of the type JWT or at+jwt."));
        }
        if header.kid.as_deref().is_none_or(str::is_empty) {
            return Err(refused(
                "The token does not say by which key it is signed (kid).",
            ));
        }
        Ok(header)
    }

    /// The claims of a token, checked by the key that it names.
    fn read(
        &self,
        token: &str,
        algorithm: Algorithm,
        key: &DecodingKey,
        now: Timestamp,
    ) -> Result<Bearer, TokenError> {
        let mut validation = Validation::new(algorithm);
        validation.set_required_spec_claims(&["exp", "iss", "aud"]);
        validation.set_issuer(&[&self.issuer.text]);
        validation.set_audience(&[&self.audience]);
        // By the clock that is given.
        validation.validate_exp = false;
        let claims: Claims = match decode(token, key, &validation) {
            Ok(token) => token.claims,
            Err(error) => return Err(refused(why(error.kind()))),
        };
        if claims.get("iss").and_then(|it| it.as_str()) != Some(&self.issuer.text) {
            return Err(refused(why(&ErrorKind::InvalidIssuer)));
        }
        let time = |name: &str| match claims.get(name) {
            None => Ok(None),
            Some(time) => {
                // A number beyond all calendars stands for their end.
                let seconds = time.as_f64().map(|seconds| seconds as i64);
                let seconds =
                    seconds.ok_or_else(|| refused(format!("{name} of the token is no time.")))?;
                let end = if seconds < 0 {
                    Timestamp::MIN
                } else {
                    Timestamp::MAX
                };
                Ok(Some(Timestamp::from_second(seconds).unwrap_or(end)))
            }
        };
        let until = time("exp")?.ok_or_else(|| refused("The token has no end (exp)."))?;
        let until = until.saturating_add(LEEWAY).unwrap_or(Timestamp::MAX);
        if until <= now {
            return Err(refused("The token has expired."));
        }
        let early = now.saturating_add(LEEWAY).unwrap_or(Timestamp::MAX);
        if time("nbf")?.is_some_and(|begin| early < begin) {
            return Err(refused("The token is not valid yet (nbf)."));
        }
        let client = self.client.of(&claims).and_then(|client| client.as_str());
        let client = client.filter(|client| is_client_name(client)).ok_or_else(|| {
            refused(format!(
                "The claim {:?} of the token has to name the client in 1 to 100 characters, none of them a control character.",
                self.client.name()
            ))
        })?;
        let user = self.user.as_ref().and_then(|claim| {
            let user = claim.of(&claims)?;
            Some((claim.name(), user.as_str().unwrap_or_default()))
        });
        if let Some((name, _)) = user.filter(|(_, user)| !is_user_name(user)) {
            return Err(refused(format!(
                "The claim {name:?} of the token has to name the user in 1 to 128 visible ASCII characters."
            )));
        }
        let is_in = |role: &Option<ClaimValue>| role.as_ref().is_some_and(|it| it.is_in(&claims));
        let role = if is_in(&self.administrator) {
            Role::Administrator
        } else if is_in(&self.operator) {
            Role::Operator
        } else {
            Role::Client
        };
        let logged = |name: &str| {
            let text = claims.get(name)?.as_str()?;
            Some(text.chars().take(LONGEST_LOGGED).collect())
        };
        Ok(Bearer {
            client: client.to_owned(),
            user: user.map(|(_, user)| user.to_owned()),
            role,
            until,
            subject: logged("sub"),
            id: logged("jti"),
        })
    }
}

fn why(kind: &ErrorKind) -> String {
    match kind {
        ErrorKind::InvalidSignature => "The signature of the token is not that of its issuer.",
        ErrorKind::InvalidIssuer => "The token is of another issuer.",
        ErrorKind::InvalidAudience => "The token is for another audience.",
        ErrorKind::MissingRequiredClaim(claim) => {
            return format!("The token has no {claim} that can be read.");
        }
        _ => "The token cannot be read.",
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use jsonwebtoken::jwk::Jwk;
    use serde_json::Value;

    use super::*;

    /// A token of each algorithm and the key that checks it, signed by OpenSSL.
    const SIGNED: &str = include_str!("signed.json");

    fn rules() -> TokenRules {
        TokenRules {
            issuer: "https://id.example".parse().unwrap(),
            audience: "gears".to_owned(),
            algorithms: Vec::new(),
            client: "sub".parse().unwrap(),
            user: None,
            operator: None,
            administrator: None,
        }
    }

    /// The algorithm, the key and the token of each.
    fn signed() -> Vec<(Algorithm, DecodingKey, String)> {
        let all: Vec<Value> = serde_json::from_str(SIGNED).unwrap();
        // The key of RSA stands once.
        let rsa = all[0]["jwk"].clone();
        let read = |one: &Value| {
            let jwk = one.get("jwk").unwrap_or(&rsa).clone();
            let jwk: Jwk = serde_json::from_value(jwk).unwrap();
            let text = |name: &str| one[name].as_str().unwrap().to_owned();
            let key = DecodingKey::from_jwk(&jwk).unwrap();
            (algorithm(&text("alg")).unwrap(), key, text("token"))
        };
        all.iter().map(read).collect()
    }

    #[test]
    fn what_another_library_signs_is_taken_by_its_algorithm_and_its_key_alone() {
        ring::install();
        let rules = rules();
        let at = |second| Timestamp::from_second(second).unwrap();
        let now = at(1_800_000_000);
        let all = signed();
        assert_eq!(all.len(), 9);
        for (algorithm, key, token) in &all {
            let bearer = rules.read(token, *algorithm, key, now).unwrap();
            let end = at(4_102_444_800 + 30);
            assert_eq!((bearer.client.as_str(), bearer.until), ("ada", end));
            let late = rules.read(token, *algorithm, key, end);
            assert_eq!(
                late,
                Err(refused("The token has expired.")),
                "{algorithm:?}"
            );
            // One letter of the claims, and one of the signature.
            let (head, rest) = token.split_once('.').unwrap();
            let (claims, signature) = rest.split_once('.').unwrap();
            let other = |text: &str| match text.strip_prefix('A') {
                Some(rest) => format!("B{rest}"),
                None => format!("A{}", &text[1..]),
            };
            let changed = [
                format!("{head}.{}.{signature}", other(claims)),
                format!("{head}.{claims}.{}", other(signature)),
                format!("{head}.{claims}."),
            ];
            for changed in changed {
                assert!(rules.read(&changed, *algorithm, key, now).is_err());
            }
            for (other, other_key, _) in all.iter().filter(|(other, ..)| other != algorithm) {
                assert!(rules.read(token, *other, key, now).is_err());
                let same_kind = key.family() == other_key.family();
                assert_eq!(
                    rules.read(token, *algorithm, other_key, now).is_ok(),
                    same_kind
                        && matches!(
                            key.kind(),
                            jsonwebtoken::DecodingKeyKind::RsaModulusExponent { .. }
                        ),
                    "{algorithm:?} by the key of {other:?}"
                );
            }
        }
    }

    #[test]
    fn a_number_that_is_written_with_zeros_is_the_same_key() {
        ring::install();
        let (algorithm, key, token) = signed().remove(0);
        let jsonwebtoken::DecodingKeyKind::RsaModulusExponent { n, e } = key.kind() else {
            unreachable!("the first is of RSA")
        };
        let padded = |number: &[u8]| [&[0], number].concat();
        let key = DecodingKey::from_rsa_raw_components(&padded(n), &padded(e));
        let now = Timestamp::from_second(1_800_000_000).unwrap();
        assert!(rules().read(&token, algorithm, &key, now).is_ok());
    }

    #[test]
    fn a_token_has_three_parts() {
        assert!(has_form("eyJh.e30.c2ln") && has_form("a.b."));
        for text in [
            "", "a", "a.b", "a.b.c.d", ".b.c", "a.b c.d", "a.b=.c", "é.b.c",
        ] {
            assert!(!has_form(text), "{text}");
        }
    }
}
