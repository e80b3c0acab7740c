//! Whose turn it is: clients share the service, the users of a client its part, and the lanes of a user theirs.
//!
//! A lane is a study, or the jobs of a user that stand alone. Jobs that a client submits without a user's name are of one user without a name. Each client,
//! user and lane has a time at which its next job is due, which moves on by the cost of its jobs; the least is served next (start-time fair queueing, Goyal et
//! al. 1996). A new one starts at the time of those being served: nobody saves up a claim, and nobody pays for having been alone. So while a client has work to
//! do, no other one gets more than its share, however many jobs or studies it brings.

use std::collections::BTreeSet;

use uuid::Uuid;

use super::rows::{Record, Row, lane_of_job};
use super::statement::{Connection, query, query_as};
use super::{Job, dialect};

/// Jobs that stand alone have so many times the part of a study: somebody waits for them, but a study is not to starve.
const WEIGHT_ALONE: i64 = 3;

/// First character of the name of a user's lane of jobs that stand alone; jobs of no user have the lane ''.
const ALONE: char = '!';

/// The lane of a job, in the order in which shares are locked.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct LaneOf {
    pub(super) client: String,
    /// The user of the client.
    pub(super) person: Option<String>,
    /// None for jobs that stand alone.
    pub(super) study: Option<Uuid>,
}

impl LaneOf {
    pub(super) fn of(job: &Job) -> Self {
        Self {
            client: job.client.clone(),
            person: job.submitted_by.clone(),
            study: job.study,
        }
    }

    /// As `lane_of_job` has it.
    fn name(&self) -> String {
        match (self.study, &self.person) {
            (Some(study), _) => study.to_string(),
            (None, Some(person)) => format!("{ALONE}{person}"),
            (None, None) => String::new(),
        }
    }
}

/// Keeps others from changing the shares of some clients until the end of the transaction.
pub(super) async fn lock(
    connection: &mut Connection,
    clients: BTreeSet<&String>,
) -> Result<(), sqlx::Error> {
    for client in clients {
        query(dialect::lock_shares())
            .bind(client)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}

/// Makes sure that lanes in which a job waits are looked at.
pub(super) async fn activate_all(
    connection: &mut Connection,
    lanes: &BTreeSet<LaneOf>,
) -> Result<(), sqlx::Error> {
    for lane in lanes {
        activate(connection, lane).await?;
    }
    Ok(())
}

/// Makes sure that a lane in which a job waits is looked at.
pub(super) async fn activate(
    connection: &mut Connection,
    lane: &LaneOf,
) -> Result<(), sqlx::Error> {
    // A program from before there were users would find no job in the lane of one.
    let active: i64 = if lane.person.is_some() { 2 } else { 1 };
    let activate = query(
        "insert into shares (client, lane, due, active, served, person)
           select $1, '*', (select due from served), 1, 0, ''
           union all
           select $1, '@' || $3, coalesce((select served from shares where client = $1 and lane = '*'), 0), 2,
                  coalesce((select served from shares where client = $1 and lane = '*'), 0), $3
           union all
           select $1, $2, coalesce((select served from shares where client = $1 and lane = '@' || $3),
                                   (select served from shares where client = $1 and lane = '*'), 0), $4, 0, $3
           where true
         on conflict (client, lane) do update
           set active = excluded.active, due = case shares.active when 0 then max(shares.due, excluded.due) else shares.due end",
    )
    .bind(&lane.client)
    .bind(lane.name())
    .bind(lane.person.as_deref().unwrap_or_default())
    .bind(active);
    connection.later(activate).await
}

/// A lane with work to do.
#[derive(Debug, Clone)]
pub(super) struct Lane {
    pub(super) client: String,
    /// The user of the client; empty for none.
    person: String,
    /// Its name: the id of a study, or that of jobs that stand alone.
    pub(super) lane: String,
    client_due: i64,
    person_due: i64,
    lane_due: i64,
}

/// The running jobs of a process, and whether a job waits that has to run alone.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Here {
    /// How many jobs run.
    pub(super) running: i64,
    /// How many of them are to run alone.
    pub(super) alone: i64,
    /// Number of waiting jobs that have to run alone, anywhere.
    pub(super) waiting: i64,
}

struct LaneHere {
    lane: Lane,
    here: Here,
}

impl Record for LaneHere {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self {
            lane: Lane {
                client: row.get("client")?,
                person: row.get("person")?,
                lane: row.get("lane")?,
                client_due: row.get("client_due")?,
                person_due: row.get("person_due")?,
                lane_due: row.get("lane_due")?,
            },
            here: Here {
                running: row.get("running")?,
                alone: row.get("alone")?,
                waiting: row.get("waiting")?,
            },
        })
    }
}

/// The lanes with work to do, in the order in which they are due, and the running jobs of `process`, which are left out where no job waits.
pub(super) async fn lanes(
    connection: &mut Connection,
    process: &str,
) -> Result<(Vec<Lane>, Here), sqlx::Error> {
    let rows: Vec<LaneHere> = query_as(dialect::lanes())
        .bind(process)
        .fetch_all(connection)
        .await?;
    let here = rows.first().map(|row| row.here).unwrap_or_default();
    Ok((rows.into_iter().map(|row| row.lane).collect(), here))
}

impl Lane {
    /// Charges it with jobs that are begun, and takes it out of the turn if they were `all` of its jobs. True if it rests.
    pub(super) async fn charge(
        &self,
        connection: &mut Connection,
        cost: i64,
        all: bool,
    ) -> Result<bool, sqlx::Error> {
        let cost = cost.max(1);
        let stands_alone = self.lane.is_empty() || self.lane.starts_with(ALONE);
        let of_lane = if stands_alone {
            (cost / WEIGHT_ALONE).max(1)
        } else {
            cost
        };
        let serve = query("update served set due = max(due, $1)").bind(self.client_due);
        connection.later(serve).await?;
        // One that only waits for an equal one keeps the lane its turn.
        let rows: Vec<(String, i64)> = query_as(concat!(
            "update shares
             set due = due + case lane when $2 then $4 else $3 end,
                 served = case lane when '*' then max(served, $5) when '@' || $8 then max(served, $6) else served end,
                 active = case
                   when $7 = 0 then active
                   when exists (select 1 from jobs where status = 'accepted' and jobs.client = $1 and ",
            lane_of_job!(),
            " = $2) then active
                   when lane <> $2 and exists (select 1 from shares as others
                                               where others.client = $1 and others.active > 0 and others.lane not in ('*', $2)
                                                 and others.lane not like '@%' and (shares.lane = '*' or others.person = $8)) then active
                   else 0 end
             where client = $1 and lane in ('*', '@' || $8, $2)
             returning lane, active"
        ))
        .bind(&self.client)
        .bind(&self.lane)
        .bind(cost)
        .bind(of_lane)
        .bind(self.person_due)
        .bind(self.lane_due)
        .bind(i64::from(all))
        .bind(&self.person)
        .fetch_all(&mut *connection)
        .await?;
        let rests = rows.contains(&(self.lane.clone(), 0));
        if rests && !self.lane.is_empty() {
            forget(connection, &self.client).await?;
        }
        Ok(rests)
    }

    /// Takes it out of the turn, because nothing waits in it.
    pub(super) async fn rest(&self, connection: &mut Connection) -> Result<(), sqlx::Error> {
        rest(connection, &self.client, &self.lane).await
    }
}

/// Takes a lane out of the turn. Its consumption is remembered while it can matter.
pub(super) async fn rest(
    connection: &mut Connection,
    client: &str,
    lane: &str,
) -> Result<(), sqlx::Error> {
    query("update shares set active = 0 where client = $1 and lane = $2")
        .bind(client)
        .bind(lane)
        .execute(&mut *connection)
        .await?;
    query(
        "update shares set active = 0 where client = $1 and active > 0 and (lane = '*' or lane like '@%')
           and not exists (select 1 from shares as others where others.client = $1 and others.active > 0
                             and others.lane <> '*' and others.lane not like '@%'
                             and (shares.lane = '*' or others.person = shares.person))",
    )
    .bind(client)
    .execute(&mut *connection)
    .await?;
    forget(connection, client).await
}

/// A lane or a user that others have caught up with begins anew where they are, remembered or not; and where nothing of a client waits,
/// all of them do.
async fn forget(connection: &mut Connection, client: &str) -> Result<(), sqlx::Error> {
    query(
        "delete from shares where client = $1 and active = 0 and lane not in ('*', '', '@')
           and (not exists (select 1 from shares as others where others.client = $1 and others.active > 0)
                or lane not like '@%' and due <= (select level.served from shares as level
                                                  where level.client = $1 and level.lane = '@' || shares.person))",
    )
    .bind(client)
    .execute(&mut *connection)
    .await?;
    // A user goes behind the last of its lanes, which have their time from it.
    query(
        "delete from shares where client = $1 and active = 0 and lane like '@_%'
           and due <= (select whole.served from shares as whole where whole.client = $1 and whole.lane = '*')
           and not exists (select 1 from shares as own where own.client = $1 and own.person = shares.person and own.lane not like '@%')",
    )
    .bind(client)
    .execute(connection)
    .await?;
    Ok(())
}
