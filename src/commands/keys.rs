//! `meshwright keys`: who may use the service.

use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Context, bail};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use jiff::Timestamp;

use crate::config::lasting;
use crate::jobs::{DatabaseAddress, KeyRecord, Migrate, Role, Store};
use crate::keys::{Key, is_client_name};
use crate::serve::open;

/// Make, list and revoke API keys.
#[derive(Debug, clap::Args)]
pub(crate) struct Keys {
    /// File or address of the database; the service may be running on it.
    #[arg(
        long,
        env = "MESHWRIGHT_DATABASE",
        default_value = "./meshwright.db",
        hide_env_values = true,
        value_name = "FILE or ADDRESS",
        global = true
    )]
    database: DatabaseAddress,
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// Make a key and print it. It cannot be printed again: only a hash of it is stored.
    Create(Create),
    /// List the keys, without their secrets.
    List,
    /// Revoke a key at once; the jobs of its client stay.
    Revoke {
        /// The public part of the key, between the underscores.
        id: String,
    },
}

#[derive(Debug, clap::Args)]
struct Create {
    /// Your name for the key.
    name: String,
    /// Client whose jobs the key may submit and read; several keys may share one. The client "anonymous" has the jobs from before there were keys
    /// [default: the name].
    #[arg(long, value_name = "NAME")]
    client: Option<String>,
    /// Rights of the bearer.
    #[arg(long, value_parser = role(), default_value = "client")]
    role: Role,
    /// Time after which the key expires, such as 90d or 12h [default: never].
    #[arg(long, value_parser = lasting, value_name = "TIME")]
    expires_in: Option<Duration>,
    /// Limit of requests a second; 0 for no limit [default: that of the service].
    #[arg(long, value_name = "NUMBER")]
    requests_per_second: Option<u32>,
    /// Limit of waiting jobs, not counting designs of studies [default: that of the service].
    #[arg(long, value_name = "NUMBER")]
    queue_limit: Option<u32>,
}

/// The roles by their words.
fn role() -> impl TypedValueParser<Value = Role> {
    let roles = [
        (
            Role::Client,
            "Submit, read, cancel and delete the jobs of its client",
        ),
        (
            Role::Reader,
            "Read the jobs of its client, and change nothing",
        ),
        (
            Role::Operator,
            "As client, and read the metrics of the service",
        ),
        (
            Role::Administrator,
            "As client, see who uses the service, and cancel and delete any job or study",
        ),
    ];
    let words = roles.map(|(role, help)| PossibleValue::new(role.word()).help(help));
    PossibleValuesParser::new(words).map(|word| Role::of_word(&word))
}

impl Keys {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If the database cannot be used, or there is no such key.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let runtime = crate::runtime::runtime()?;
        runtime.block_on(async {
            let store = open(&self.database, Migrate::Auto).await?;
            let done = self.act(&store).await;
            store.close().await;
            done
        })?;
        Ok(ExitCode::SUCCESS)
    }

    async fn act(&self, store: &Store) -> anyhow::Result<()> {
        match &self.what {
            What::Create(create) => create.run(store).await,
            What::List => list(store).await,
            What::Revoke { id } => {
                if !store.revoke_key(id, Timestamp::now()).await? {
                    bail!("there is no key {id}, or it is revoked already");
                }
                println!("{id} is revoked.");
                Ok(())
            }
        }
    }
}

impl Create {
    async fn run(&self, store: &Store) -> anyhow::Result<()> {
        let client = self.client.as_ref().unwrap_or(&self.name);
        for (what, text) in [("name", &self.name), ("client", client)] {
            if !is_client_name(text) {
                bail!(
                    "the {what} has to have 1 to 100 characters, none of them a control character"
                );
            }
        }
        let key = Key::random().context("the system gives no random numbers")?;
        let now = Timestamp::now();
        let expires_at = self.expires_in.map(|span| now.checked_add(span));
        let expires_at = expires_at
            .transpose()
            .context("the key would expire beyond the calendar")?;
        let record = KeyRecord {
            id: key.id().to_owned(),
            client: client.clone(),
            name: self.name.clone(),
            role: self.role,
            secret_hash: key.secret_hash(),
            requests_per_second: self.requests_per_second,
            queue_limit: self.queue_limit,
            created_at: now,
            expires_at,
            revoked_at: None,
        };
        store.add_key(&record).await?;
        // The key alone on standard output, for a script; the rest beside it.
        println!("{}", key.reveal());
        eprintln!(
            "Send it as `Authorization: Bearer {}...`. It cannot be shown again: only a hash of it is stored. From now on the service requires keys.",
            &key.reveal()[..20]
        );
        Ok(())
    }
}

async fn list(store: &Store) -> anyhow::Result<()> {
    println!(
        "{:<18}{:<10}{:<20}{:<20}{:<22}state",
        "id", "role", "client", "name", "created"
    );
    for key in store.list_keys().await? {
        let state = match (key.revoked_at, key.expires_at) {
            (Some(at), _) => format!("revoked {at:.0}"),
            (None, Some(at)) if at <= Timestamp::now() => format!("expired {at:.0}"),
            (None, Some(at)) => format!("valid until {at:.0}"),
            (None, None) => "valid".to_owned(),
        };
        println!(
            "{:<18}{:<10}{:<20}{:<20}{:<22}{state}",
            key.id,
            key.role.word(),
            key.client,
            key.name,
            format!("{:.0}", key.created_at)
        );
    }
    Ok(())
}
