//! Webhooks: messages to a client that its jobs and studies have ended.
//!
//! In reading order: where messages may go ([`addresses`](HookRules)); what handlers do with
//! [`Webhooks`] (`hooks`); how one is sent (`send`); and the task that delivers them (`deliver`). What is kept of them, and the messages, which are written
//! with the change that they report, are the store's.

mod addresses;
mod deliver;
mod hooks;
mod send;

pub use addresses::{HookRules, HookTarget};
pub use deliver::Deliveries;
pub use hooks::{Made, WebhookError, Webhooks, most_webhooks};
