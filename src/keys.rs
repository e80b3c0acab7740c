//! API keys: how they look, how they are made, and how one is recognized without keeping it.

use std::fmt;

use jiff::Timestamp;
use meshwright_wire::hash::sha256_hex;
use subtle::ConstantTimeEq;

use crate::jobs::{KeyRecord, Store, StoreError};

/// Prefix of every key, by which scanners for leaked secrets know it.
const PREFIX: &str = "mw";

/// True if a text has the prefix of a key.
pub fn has_prefix(text: &str) -> bool {
    text.strip_prefix(PREFIX)
        .is_some_and(|rest| rest.starts_with('_'))
}

const ID_BYTES: usize = 8;
const SECRET_BYTES: usize = 32;

/// A key in full: `mw_ID_SECRET`, both parts hexadecimal. It shows itself to nobody by accident.
pub struct Key {
    id: String,
    secret: String,
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Key({})", self.id)
    }
}

impl Key {
    /// A new key, from the system's source of chance.
    ///
    /// # Errors
    ///
    /// When the system has none.
    pub fn random() -> Result<Self, getrandom::Error> {
        let (mut id, mut secret) = ([0; ID_BYTES], [0; SECRET_BYTES]);
        getrandom::fill(&mut id)?;
        getrandom::fill(&mut secret)?;
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self {
            id: hex(&id),
            secret: hex(&secret),
        })
    }

    /// Reads a key; `None` if it has not the form of one.
    pub fn parse(text: &str) -> Option<Self> {
        let (id, secret) = text
            .strip_prefix(PREFIX)?
            .strip_prefix('_')?
            .split_once('_')?;
        let is_hex = |text: &str, bytes: usize| {
            text.len() == 2 * bytes
                && text
                    .bytes()
                    .all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
        };
        (is_hex(id, ID_BYTES) && is_hex(secret, SECRET_BYTES)).then(|| Self {
            id: id.to_owned(),
            secret: secret.to_owned(),
        })
    }

    /// Its public part.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The hash that is stored of the secret part. The secret has 256 random bits: nobody finds it from the hash by trying, and a slow hash would add nothing.
    pub fn secret_hash(&self) -> String {
        sha256_hex(&self.secret)
    }

    /// The whole key, to be shown once.
    pub fn reveal(&self) -> String {
        format!("{PREFIX}_{}_{}", self.id, self.secret)
    }

    /// The record of this key, if it is kept, was not revoked and has not expired at `now`.
    ///
    /// # Errors
    ///
    /// [`StoreError`].
    pub async fn find(
        &self,
        store: &Store,
        now: Timestamp,
    ) -> Result<Option<KeyRecord>, StoreError> {
        let record = store.find_key(&self.id, now).await?;
        // The time of the comparison reveals nothing of how much of the secret was right.
        Ok(record.filter(|record| {
            let same = record
                .secret_hash
                .as_bytes()
                .ct_eq(self.secret_hash().as_bytes());
            bool::from(same)
        }))
    }
}

/// True for a valid name of a client: 1 to 100 characters, none of them a control character.
pub fn is_client_name(text: &str) -> bool {
    (1..=100).contains(&text.chars().count()) && !text.chars().any(char::is_control)
}

/// True for a valid name of a user of a client: 1 to 128 visible ASCII characters.
pub fn is_user_name(text: &str) -> bool {
    (1..=128).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_graphic())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_reads_what_it_reveals_and_shows_no_secret() {
        let key = Key::random().unwrap();
        let text = key.reveal();
        let again = Key::parse(&text).unwrap();
        assert_eq!(
            (again.id(), again.secret_hash()),
            (key.id(), key.secret_hash())
        );
        assert!(!format!("{key:?}").contains(&key.secret));
        assert_ne!(Key::random().unwrap().reveal(), text);
        for other in [
            "",
            "mw",
            "mw__",
            &text[1..],
            &text[..text.len() - 1],
            &text.to_uppercase(),
            &format!("{text}0"),
        ] {
            assert!(Key::parse(other).is_none(), "{other}");
        }
    }
}
