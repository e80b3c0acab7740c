//! Who uses the service, and for how much: clients and their users. Ids and counts, no document.

use std::collections::BTreeMap;

use jiff::{SignedDuration, Timestamp};
use uuid::Uuid;

use super::statement::query_as;
use super::{Store, StoreError, column};

/// Maximum number of users of a client in the answer: those with most work under way.
const MOST_USERS: u64 = 1000;

/// Maximum number of ids of jobs, and of studies, of a client in the answer: the oldest.
const MOST_IDS: u64 = 1000;

/// The use of the service by a client.
#[derive(Debug, Clone, PartialEq)]
pub struct ClientUsage {
    /// The client.
    pub client: String,
    /// Its users; one without a name for submissions without one.
    pub users: Vec<UserUsage>,
}

/// The use of the service by a user of a client.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UserUsage {
    /// The user; `None` for submissions without one.
    pub user: Option<String>,
    /// Jobs that wait, designs of studies among them.
    pub waiting: i64,
    /// Jobs that run.
    pub running: i64,
    /// Jobs that succeeded or failed within the last hour.
    pub done_last_hour: i64,
    /// The same within the last day.
    pub done_last_day: i64,
    /// Bytes of the results that are kept, packed.
    pub bytes_kept: i64,
    /// Jobs that stand alone and wait or run, the oldest first.
    pub jobs: Vec<Uuid>,
    /// Studies that have not ended, the oldest first.
    pub studies: Vec<Uuid>,
}

impl Store {
    /// The use of the service by at most `limit` clients behind the one named `after`, in the order of their names.
    pub async fn usage(
        &self,
        after: &str,
        limit: u32,
        now: Timestamp,
    ) -> Result<Vec<ClientUsage>, StoreError> {
        // One step in the index a client, whatever the number of its jobs.
        let clients: Vec<(String,)> = query_as(
            "with recursive names(client) as (
               select min(client) from jobs where client > $1
               union all
               select (select min(client) from jobs where client > names.client) from names where names.client is not null)
             select client from names where client is not null limit $2",
        )
        .bind(after)
        .bind(limit)
        .fetch_all(&self.readers)
        .await?;
        let mut usage = Vec::with_capacity(clients.len());
        for (client,) in clients {
            let users = self.usage_of(&client, now).await?;
            usage.push(ClientUsage { client, users });
        }
        Ok(usage)
    }

    async fn usage_of(&self, client: &str, now: Timestamp) -> Result<Vec<UserUsage>, StoreError> {
        let before = |hours| {
            let span = SignedDuration::from_hours(hours);
            let begin = now.saturating_sub(span).unwrap_or(Timestamp::MIN);
            begin.as_microsecond()
        };
        let counts: Vec<(String, i64, i64, i64, i64)> = query_as(
            "select coalesce(submitted_by, ''),
                    cast(sum(case status when 'accepted' then 1 else 0 end) as bigint) as waiting,
                    cast(sum(case status when 'running' then 1 else 0 end) as bigint) as running,
                    cast(sum(case when status in ('successful', 'failed') and finished_at >= $2 then 1 else 0 end) as bigint),
                    cast(sum(case when status in ('successful', 'failed') and finished_at >= $3 then 1 else 0 end) as bigint)
             from jobs where client = $1 group by submitted_by order by waiting desc, running desc, 1 limit $4",
        )
        .bind(client)
        .bind(before(1))
        .bind(before(24))
        .bind(column(MOST_USERS))
        .fetch_all(&self.readers)
        .await?;
        let kept: Vec<(String, i64)> = query_as(
            "select own.person, cast(sum(octet_length(documents.body)) as bigint)
             from (select distinct coalesce(submitted_by, '') as person, document from jobs
                   where client = $1 and document is not null) as own
             join documents on documents.hash = own.document group by own.person",
        )
        .bind(client)
        .fetch_all(&self.readers)
        .await?;
        let ids = async |words: &'static str| -> Result<Vec<(String, String)>, StoreError> {
            let ids = query_as(words).bind(client).bind(column(MOST_IDS));
            Ok(ids.fetch_all(&self.readers).await?)
        };
        let jobs = ids(
            "select coalesce(submitted_by, ''), id from jobs
             where client = $1 and status in ('accepted', 'running') and study is null order by sequence limit $2",
        );
        let studies = ids(
            "select coalesce(submitted_by, ''), id from studies where client = $1 and ended_at is null order by sequence limit $2",
        );
        let (jobs, studies) = (jobs.await?, studies.await?);

        let mut users: Vec<UserUsage> = Vec::with_capacity(counts.len());
        let mut places = BTreeMap::new();
        for (user, waiting, running, done_last_hour, done_last_day) in counts {
            places.insert(user.clone(), users.len());
            users.push(UserUsage {
                user: Some(user).filter(|user| !user.is_empty()),
                waiting,
                running,
                done_last_hour,
                done_last_day,
                ..UserUsage::default()
            });
        }
        for (user, bytes) in kept {
            if let Some(place) = places.get(&user) {
                users[*place].bytes_kept = bytes;
            }
        }
        for (user, id) in jobs {
            if let (Some(place), Ok(id)) = (places.get(&user), id.parse()) {
                users[*place].jobs.push(id);
            }
        }
        for (user, id) in studies {
            if let (Some(place), Ok(id)) = (places.get(&user), id.parse()) {
                users[*place].studies.push(id);
            }
        }
        Ok(users)
    }
}
