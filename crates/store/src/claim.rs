//! Accepted -> running: the job whose turn it is, and small ones behind it.

use std::collections::BTreeSet;

use jiff::Timestamp;

use super::attempt::Lease;
use super::documents::{Damaged, checked};
use super::endings::tell_end;
use super::rows::{Record, Row, job_columns, lane_of_job};
use super::shares::{self, Here, Lane};
use super::statement::{Connection, list, query, query_as, query_scalar};
use super::submit::{Known, find_known};
use super::{Job, Kept, Store, StoreError, column, dialect, micros};

/// A job that a worker is to compute.
#[derive(Debug, Clone, PartialEq)]
pub struct Started {
    /// The job.
    pub job: Job,
    /// The submission with every default filled in, JSON.
    pub submission: Result<String, Damaged>,
}

impl Record for Started {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        let job: Job = Record::read(row)?;
        let found = (row.get("submission")?, row.get("checksum")?);
        Ok(Self {
            submission: checked(format_args!("of the job {}", job.id), found),
            job,
        })
    }
}

/// The work that a worker finds in the queue.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Claimed {
    /// The jobs to compute, one after the other: one, or several small ones of one lane.
    pub started: Vec<Started>,
    /// Jobs that were next, but have been given the results of an equal one.
    pub given: Vec<Job>,
    /// True if no job waits any more, not even for another job.
    pub drained: bool,
}

/// Limits of a worker.
#[derive(Debug, Clone, Copy)]
pub struct Reader<'a> {
    /// The version of its solver, whose results are given again.
    pub solver: &'a str,
    /// The latest version of documents that it reads.
    pub documents: i64,
    /// Limit of the cost of several jobs in one claim, in microseconds of a core.
    pub at_once: i64,
}

/// Maximum number of jobs that get known results in one commit.
const MOST_GIVEN: usize = 100;

/// Maximum number of jobs that begin in one commit.
const MOST_STARTED: usize = 64;

impl Store {
    /// Accepted -> running: the job whose turn it is, leased. Equal work is done once: a job whose equal
    /// is running is passed over, and one whose equal has become successful since it was submitted is given its results,
    /// accepted -> successful.
    ///
    /// A job that may have crashed a process runs alone in its process: the running jobs end before it, and none begins beside it.
    pub async fn claim(
        &self,
        now: Timestamp,
        lease: Lease,
        reader: Reader<'_>,
    ) -> Result<Claimed, StoreError> {
        // A claim that is lost with the power leaves a job that waits, and a worker whose claim holds no more.
        let mut write = self.begin_relaxed().await?;
        query(dialect::lock_turn()).execute(&mut *write).await?;
        let process = self.process.to_string();
        let mut claimed = Claimed::default();
        let mut turn = Turn::default();
        let begin = Begin {
            now,
            lease,
            process: &process,
        };
        let (lanes, here) = shares::lanes(&mut write, &process).await?;
        let suspects = suspects(&mut write, here, reader).await?;
        match &suspects {
            Suspects::None => {
                turn.lanes = lanes.len();
                take_turn(&mut write, lanes, begin, reader, &mut claimed, &mut turn).await?;
            }
            Suspects::Next(id) => {
                claimed.started = begin.start(&mut write, std::slice::from_ref(id)).await?;
            }
            Suspects::Wait => {}
        }
        let is_turn = matches!(suspects, Suspects::None);
        claimed.drained = turn.settle(&mut write).await? && is_turn;
        write.commit().await?;
        Ok(claimed)
    }
}

/// Whether a job has to run alone.
enum Suspects {
    /// None has.
    None,
    /// This one, now.
    Next(String),
    /// One runs alone, or is to and others still run.
    Wait,
}

async fn suspects(
    connection: &mut Connection,
    here: Here,
    reader: Reader<'_>,
) -> Result<Suspects, sqlx::Error> {
    if here.alone > 0 {
        return Ok(Suspects::Wait);
    }
    if here.waiting == 0 {
        return Ok(Suspects::None);
    }
    let next: Option<String> = query_scalar(dialect::next_suspect())
        .bind(reader.documents)
        .fetch_optional(connection)
        .await?;
    Ok(match next {
        Some(id) if here.running == 0 => Suspects::Next(id),
        Some(_) => Suspects::Wait,
        None => Suspects::None,
    })
}

/// Effect of a claim on the shares. Written after the jobs, as in every transition (see `dialect::postgres`).
#[derive(Default)]
struct Turn {
    /// How many lanes had work to do, as it seemed.
    lanes: usize,
    /// Lanes without a waiting job.
    empty: Vec<Lane>,
    /// The lane of the jobs that begin, their cost, and true if it had no more.
    charged: Option<(Lane, i64, bool)>,
}

impl Turn {
    /// Writes it down. True if nothing waits any more.
    async fn settle(self, connection: &mut Connection) -> Result<bool, sqlx::Error> {
        let charged = self.charged.iter().map(|(lane, ..)| lane);
        let clients: BTreeSet<&String> = self
            .empty
            .iter()
            .chain(charged)
            .map(|lane| &lane.client)
            .collect();
        shares::lock(connection, clients).await?;
        let mut rests = 0;
        for lane in &self.empty {
            rests += usize::from(rest_if_empty(connection, lane).await?);
        }
        if let Some((lane, cost, is_empty)) = &self.charged {
            rests += usize::from(lane.charge(connection, *cost, *is_empty).await?);
        }
        Ok(rests == self.lanes)
    }
}

/// Begins the job whose turn it is, and small ones behind it in its lane, which is to be charged. Jobs before them that need no computing
/// are given their results.
///
/// All of it is in one lane: jobs of a study lock it, and studies are locked one at a time.
async fn take_turn(
    connection: &mut Connection,
    lanes: Vec<Lane>,
    begin: Begin<'_>,
    reader: Reader<'_>,
    claimed: &mut Claimed,
    turn: &mut Turn,
) -> Result<(), sqlx::Error> {
    for lane in lanes {
        let mut look = Look {
            lane: &lane,
            behind: i64::MIN,
            inputs: BTreeSet::new(),
        };
        let (mut chosen, mut charge) = (Vec::new(), 0);
        // One more shows whether there is one.
        let mut many = 2;
        let is_empty = 'lane: loop {
            let waiting = look.next(connection, many, reader).await?;
            let is_last = waiting.len() < many;
            for (next, known) in waiting {
                if let Some(known) = known {
                    let job = give(connection, &next.id, &known, begin.now, reader.solver).await?;
                    tell_end(connection, &job, begin.now).await?;
                    claimed.given.push(job);
                    // Where one was computed before, others are.
                    many = MOST_GIVEN - claimed.given.len();
                    if many == 0 {
                        break 'lane false;
                    }
                } else if !chosen.is_empty() && charge + next.cost > reader.at_once {
                    break 'lane false;
                } else if look.inputs.insert(next.input_hash) {
                    charge += next.cost;
                    chosen.push(next.id);
                    // As many more as there is room for if they are like this one.
                    let room = (reader.at_once - charge) / next.cost.max(1);
                    many = usize::try_from(room)
                        .unwrap_or_default()
                        .clamp(1, MOST_STARTED);
                }
            }
            if is_last {
                break true;
            }
            many = many.min(MOST_STARTED - chosen.len());
            if many == 0 || charge >= reader.at_once && !chosen.is_empty() {
                break false;
            }
        };
        if !chosen.is_empty() {
            claimed.started = begin.start(connection, &chosen).await?;
        }
        if !claimed.started.is_empty() {
            turn.charged = Some((lane, charge, is_empty));
        } else if is_empty {
            turn.empty.push(lane);
        }
        if !claimed.started.is_empty() || !claimed.given.is_empty() {
            break;
        }
    }
    Ok(())
}

/// A job that waits.
struct Waiting {
    id: String,
    input_hash: String,
    cost: i64,
}

/// A look at the waiting jobs of a lane, from the front to the back.
struct Look<'a> {
    lane: &'a Lane,
    /// The place of the last one that was seen.
    behind: i64,
    /// The inputs of those that are to be begun: equal work is done once.
    inputs: BTreeSet<String>,
}

impl Look<'_> {
    /// The next jobs, up to a limit, and the known results of an equal job for each.
    async fn next(
        &mut self,
        connection: &mut Connection,
        many: usize,
        reader: Reader<'_>,
    ) -> Result<Vec<(Waiting, Option<Known>)>, sqlx::Error> {
        let client = &self.lane.client;
        let rows: Vec<(String, i64, String, i64, String, i64)> = query_as(dialect::next_waiting())
            .bind(client)
            .bind(&self.lane.lane)
            .bind(reader.documents)
            .bind(self.behind)
            .bind(column(many as u64))
            .bind(reader.solver)
            .fetch_all(&mut *connection)
            .await?;
        let mut waiting = Vec::with_capacity(rows.len());
        for (id, sequence, input_hash, cost, keep, computed) in rows {
            self.behind = sequence;
            // A word that is not known keeps everything.
            let keep = Kept::of_word(&keep).unwrap_or(Kept::Results);
            let known = if computed != 0 {
                find_known(connection, client, &input_hash, keep, reader.solver).await?
            } else {
                None
            };
            let next = Waiting {
                id,
                input_hash,
                cost,
            };
            waiting.push((next, known));
        }
        Ok(waiting)
    }
}

/// A lane whose jobs all wait for an equal one keeps its turn. True if it rests.
async fn rest_if_empty(connection: &mut Connection, lane: &Lane) -> Result<bool, sqlx::Error> {
    let waits = query(concat!(
        "select 1 from jobs where status = 'accepted' and client = $1 and ",
        lane_of_job!(),
        " = $2 limit 1"
    ))
    .bind(&lane.client)
    .bind(&lane.lane)
    .exists(&mut *connection)
    .await?;
    if !waits {
        lane.rest(connection).await?;
    }
    Ok(!waits)
}

/// Accepted -> successful, with the results of an equal job.
async fn give(
    connection: &mut Connection,
    id: &str,
    known: &Known,
    now: Timestamp,
    solver_version: &str,
) -> Result<Job, sqlx::Error> {
    query_as(
        concat!(
            "update jobs
         set status = 'successful', started_at = max($2, submitted_at), finished_at = max($2, submitted_at), elapsed = 0,
             document = $3, solver_version = $4, same_as = $5, positions_done = $6, positions_total = $6
         where id = $1 and status = 'accepted'
         returning ",
            job_columns!()
        ),
    )
    .bind(id)
    .bind(now.as_microsecond())
    .bind(&known.document)
    .bind(solver_version)
    .bind(&known.job)
    .bind(known.positions)
    .fetch_one(connection)
    .await
}

/// How a job is begun.
#[derive(Clone, Copy)]
struct Begin<'a> {
    now: Timestamp,
    lease: Lease,
    process: &'a str,
}

impl Begin<'_> {
    /// Accepted -> running, in their order.
    async fn start(
        self,
        connection: &mut Connection,
        ids: &[String],
    ) -> Result<Vec<Started>, sqlx::Error> {
        let mut started: Vec<Started> = query_as(dialect::start())
            .bind(list(ids))
            .bind(self.now.as_microsecond())
            .bind(self.lease.steady.as_microsecond())
            .bind(micros(self.lease.lasts))
            .bind(self.process)
            .fetch_all(connection)
            .await?;
        started.sort_by_key(|started| started.job.sequence);
        Ok(started)
    }
}
