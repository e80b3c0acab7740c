//! Who uses the service, for its administrator.

use axum::Json;
use meshwright_wire::declare::document;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use uuid::Uuid;

use super::blocking::turn_to_read;
use super::client::Administrator;
use super::page::{self, USUAL_LIMIT};
use super::parameters::{Parameters, whole};
use super::problem::Refusal;
use crate::jobs::{ClientUsage, UserUsage};

/// Filter of a list.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct UsageParameters {
    /// Maximum number of clients.
    #[param(minimum = 1, maximum = 200, default = 50, example = 20)]
    #[serde(default, deserialize_with = "whole")]
    limit: Option<u32>,
    /// Where to go on: `next` of the list before.
    #[param(pattern = "^[^\\x00]*$")]
    cursor: Option<String>,
}

/// Who uses the service.
#[derive(Serialize, ToSchema)]
#[schema(title = "Usage")]
pub(super) struct Usage {
    /// The clients that have jobs or projects, by their names.
    clients: Vec<ClientUsageView>,
    /// The value of `cursor` that gives the next clients; null at the end of the list.
    next: Option<String>,
}

document! {
    /// The use of the service by a client.
    pub(super) struct ClientUsageView as ClientUsage, "ClientUsage" view of (usage: ClientUsage) {
        /// The client.
        client: String = usage.client,
        /// Its users, those with most jobs that wait first; 1000 at most.
        users: Vec<UserUsageView> = usage.users.into_iter().map(UserUsageView::of).collect(),
    }
}

document! {
    /// The use of the service by a user of a client. It has ids, and neither submissions nor results.
    pub(super) struct UserUsageView as UserUsage, "UserUsage" view of (usage: UserUsage) {
        /// The user (`Meshwright-User`); null for submissions without one.
        user: Option<String> = usage.user,
        /// Jobs that wait, designs of studies among them.
        waiting: i64 = usage.waiting,
        /// Jobs that run, designs of studies among them.
        running: i64 = usage.running,
        /// Jobs that succeeded or failed within the last hour.
        done_last_hour: i64 = usage.done_last_hour,
        /// Jobs that succeeded or failed within the last day.
        done_last_day: i64 = usage.done_last_day,
        /// Bytes of the results that are kept, packed, and of the documents of projects.
        bytes_kept: i64 = usage.bytes_kept,
        /// The ids of jobs that stand alone and wait or run, the oldest first; 1000 of a client at most.
        jobs: Vec<Uuid> = usage.jobs,
        /// The ids of studies that have not ended, the oldest first; 1000 of a client at most.
        studies: Vec<Uuid> = usage.studies,
    }
}

/// See who uses the service
///
/// For keys with the role `administrator`, which may also cancel and delete any job or study by its id. Without keys nobody may.
#[utoipa::path(
    get, path = "/v1/usage", tag = "Operation", operation_id = "get_usage",
    params(UsageParameters),
    responses(
        (status = 200, description = "The clients.", body = Usage),
        (status = 403, description = "The key is none of an administrator, or the service asks for no keys."),
    ),
)]
pub(super) async fn usage(
    administrator: Administrator,
    Parameters(parameters): Parameters<UsageParameters>,
) -> Result<Json<Usage>, Refusal> {
    let limit = page::limit(parameters.limit, USUAL_LIMIT)?;
    let after = parameters.cursor.unwrap_or_default();
    let _turn = turn_to_read(&administrator.name).await;
    let mut found = administrator.app.jobs.usage(&after, limit + 1).await?;
    let goes_on = found.len() > limit as usize;
    found.truncate(limit as usize);
    let last = found.last().filter(|_| goes_on);
    let next = last.map(|last| last.client.clone());
    let clients = found.into_iter().map(ClientUsageView::of).collect();
    Ok(Json(Usage { clients, next }))
}
