//! Webhooks: where a client is told that its jobs and studies have ended.
//!
//! In reading order: where messages may go ([`addresses`](HookRules)); the [`Webhooks`] that handlers speak to; what of them and
//! their messages is kept (`store`); and the task that sends (`deliver`). The messages themselves are written with the change that
//! they tell, by the store of jobs.

mod addresses;
mod deliver;
mod hooks;
mod store;

pub use addresses::{HookRules, HookTarget, is_public};
pub use deliver::Deliveries;
pub use hooks::{Made, WebhookError, Webhooks, most_webhooks};
pub use store::{Delivery, Webhook};
