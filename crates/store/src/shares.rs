//! Whose turn it is: clients share the service, and the lanes of a client share its part.
//!
//! A lane is a study, or the jobs that stand alone. Each client and each lane has a time at which its next job is due, which
//! moves on by what its jobs cost; the least is served next (start-time fair queueing, Goyal et al. 1996). Who begins to
//! wait starts where those are that are being served: nobody saves up a claim, and nobody pays for having been alone. So
//! while a client has work to do, no other one gets more than its share, however many jobs or studies it brings.

use std::collections::BTreeSet;

use uuid::Uuid;

use super::dialect;
use super::rows::{Record, Row};
use super::statement::{Connection, query, query_as};

/// Jobs that stand alone have so many times the part of a study: somebody waits for them, but a study is not to starve.
const WEIGHT_ALONE: i64 = 3;

/// The lane of jobs that stand alone.
const ALONE: &str = "";

/// A client and its study, or its jobs that stand alone, in the order in which shares are locked.
pub(super) type LaneOf = (String, Option<Uuid>);

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
    for (client, study) in lanes {
        activate(connection, client, *study).await?;
    }
    Ok(())
}

/// Makes sure that a lane in which a job waits is looked at.
pub(super) async fn activate(
    connection: &mut Connection,
    client: &str,
    study: Option<Uuid>,
) -> Result<(), sqlx::Error> {
    let activate = query(
        "insert into shares (client, lane, due, active)
           select $1, '*', (select due from served), 1
           union all select $1, $2, coalesce((select served from shares where client = $1 and lane = '*'), 0), 1
           where true
         on conflict (client, lane) do update
           set active = 1, due = case shares.active when 1 then shares.due else max(shares.due, excluded.due) end",
    )
    .bind(client)
    .bind(study.map_or_else(|| ALONE.to_owned(), |study| study.to_string()));
    connection.later(activate).await
}

/// A lane with work to do.
#[derive(Debug, Clone)]
pub(super) struct Lane {
    pub(super) client: String,
    /// The id of the study; empty for jobs that stand alone.
    pub(super) lane: String,
    client_due: i64,
    lane_due: i64,
}

/// What runs in a process, and whether a job waits that is to run alone.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Here {
    /// How many jobs run.
    pub(super) running: i64,
    /// How many of them are to run alone.
    pub(super) alone: i64,
    /// Whether one that is to run alone waits, wherever it will.
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
                lane: row.get("lane")?,
                client_due: row.get("client_due")?,
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

/// The lanes with work to do, in the order in which they are due, and what runs in `process`, which is left out where nothing waits.
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
        let of_lane = if self.lane == ALONE {
            (cost / WEIGHT_ALONE).max(1)
        } else {
            cost
        };
        let serve = query("update served set due = max(due, $1)").bind(self.client_due);
        connection.later(serve).await?;
        // One that only waits for an equal one keeps the lane its turn.
        let rows: Vec<(String, i64)> = query_as(
            "update shares
             set due = due + case lane when '*' then $3 else $4 end,
                 served = case lane when '*' then max(served, $5) else served end,
                 active = case
                   when $6 = 0 then active
                   when exists (select 1 from jobs where status = 'accepted' and jobs.client = $1 and coalesce(study, '') = $2) then active
                   when lane = '*' and exists (select 1 from shares as others where others.client = $1
                                                 and others.lane not in ('*', $2) and others.active = 1) then active
                   else 0 end
             where client = $1 and lane in ('*', $2)
             returning lane, active",
        )
        .bind(&self.client)
        .bind(&self.lane)
        .bind(cost)
        .bind(of_lane)
        .bind(self.lane_due)
        .bind(i64::from(all))
        .fetch_all(&mut *connection)
        .await?;
        let rests = rows.contains(&(self.lane.clone(), 0));
        if rests && self.lane != ALONE {
            forget(connection, &self.client).await?;
        }
        Ok(rests)
    }

    /// Takes it out of the turn, because nothing waits in it.
    pub(super) async fn rest(&self, connection: &mut Connection) -> Result<(), sqlx::Error> {
        rest(connection, &self.client, &self.lane).await
    }
}

/// Takes a lane out of the turn. What it has had is remembered while that can matter.
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
        "update shares set active = 0 where client = $1 and lane = '*'
           and not exists (select 1 from shares where client = $1 and lane <> '*' and active = 1)",
    )
    .bind(client)
    .execute(&mut *connection)
    .await?;
    forget(connection, client).await
}

/// A lane that others have caught up with begins anew where they are, remembered or not.
async fn forget(connection: &mut Connection, client: &str) -> Result<(), sqlx::Error> {
    query(
        "delete from shares where client = $1 and lane not in ('*', '') and active = 0
           and due <= (select served from shares where client = $1 and lane = '*')",
    )
    .bind(client)
    .execute(connection)
    .await?;
    Ok(())
}
