//! Webhooks: messages to a client that its jobs and studies have ended.
//!
//! In reading order: allowed addresses ([`addresses`](HookRules)); the [`Webhooks`] that handlers use (`hooks`); sending of one message (`send`); and the task
//! that delivers them (`deliver`). The store keeps webhooks and messages; a message is written with the change that it reports.

mod addresses;
mod deliver;
mod hooks;
mod send;

pub use addresses::{HookRules, HookTarget};
pub use deliver::Deliveries;
pub use hooks::{Made, WebhookError, Webhooks, most_webhooks};
