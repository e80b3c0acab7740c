//! Webhooks: where a client is told that its jobs and studies have ended.
//!
//! In reading order: where messages may go ([`addresses`](HookRules)); what is kept of [`Webhooks`] and their messages
//! (`store`); what handlers do with them (`hooks`); how one is sent (`send`); and the task that delivers them (`deliver`). The messages themselves are written with the change that
//! they tell, by the store of jobs.

mod addresses;
mod deliver;
mod hooks;
mod send;
mod store;

pub use addresses::{HookRules, HookTarget};
pub use deliver::Deliveries;
pub use hooks::{Made, WebhookError, most_webhooks};
pub use store::{Delivery, Webhook, Webhooks};
