//! Several processes on one database.

use std::collections::BTreeSet;
use std::sync::Arc;

use tokio::sync::Barrier;

use super::*;
use crate::StudyRecord;
use crate::{NewRow, NewStudy, Notice, StudyOutcome};

/// Another process on the same database.
async fn another(place: &DatabaseAddress) -> Store {
    Store::open(place).await.unwrap()
}

/// Several processes on one database.
async fn several<const N: usize>() -> [Store; N] {
    let (first, place) = store().await;
    let mut stores = vec![first];
    while stores.len() < N {
        stores.push(another(&place).await);
    }
    stores.try_into().unwrap()
}

/// Results when all do the same at the same time.
async fn at_once<T: Send + 'static, F: Future<Output = T> + Send + 'static>(
    stores: &[Store],
    each: impl Fn(usize, Store) -> F + Clone + Send + 'static,
) -> Vec<T> {
    let barrier = Arc::new(Barrier::new(stores.len()));
    let tasks: Vec<_> = stores
        .iter()
        .cloned()
        .enumerate()
        .map(|(index, store)| {
            let (barrier, each) = (Arc::clone(&barrier), each.clone());
            tokio::spawn(async move {
                barrier.wait().await;
                each(index, store).await
            })
        })
        .collect();
    let mut done = Vec::new();
    for task in tasks {
        done.push(task.await.unwrap());
    }
    done
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn each_job_is_claimed_by_one_process() {
    let stores = several::<4>().await;
    for i in 0..60 {
        queued(&stores[0], 1, &i.to_string()).await;
    }
    let claimed = at_once(&stores, async |_, store: Store| {
        let mut claimed = Vec::new();
        while let Some(job) = next(&store, 2).await {
            claimed.push((job.id, job.attempt));
        }
        claimed
    })
    .await;
    let all: Vec<_> = claimed.concat();
    let different: BTreeSet<_> = all.iter().collect();
    assert_eq!((all.len(), different.len()), (60, 60));
    assert!(all.iter().all(|(_, attempt)| *attempt == 1));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_bound_of_the_queue_holds_however_many_submit_at_once() {
    let stores = several::<4>().await;
    let outcomes = at_once(&stores, async |index, store: Store| {
        let mut taken = 0;
        for i in 0..10 {
            let job = new(1, &format!("{index} {i}"));
            let outcome = store.submit(&[job], bounds(1, 17)).await.unwrap();
            taken += usize::from(matches!(outcome[..], [Outcome::Queued(_)]));
        }
        taken
    })
    .await;
    assert_eq!(outcomes.iter().sum::<usize>(), 17);
    let depth = stores[0].depth().await.unwrap();
    assert_eq!(depth.alone, 17);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_key_makes_one_job_whoever_is_asked() {
    let stores = several::<4>().await;
    let outcomes = at_once(&stores, async |_, store: Store| {
        let job = NewJob {
            idempotency_key: Some("k".to_owned()),
            ..new(1, "a")
        };
        submit(&store, job).await
    })
    .await;
    let made = outcomes
        .iter()
        .filter(|outcome| matches!(outcome, Outcome::Queued(_)));
    assert_eq!(made.count(), 1);
    let ids: BTreeSet<Uuid> = outcomes
        .into_iter()
        .map(|outcome| match outcome {
            Outcome::Queued(job) | Outcome::Repeated(job) => job.id,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(ids.len(), 1);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn equal_work_is_done_once_whoever_takes_it() {
    let stores = several::<4>().await;
    for store in &stores {
        queued(store, 1, "same").await;
    }
    let claimed = at_once(&stores, async |_, store: Store| next(&store, 2).await).await;
    let claimed: Vec<Job> = claimed.into_iter().flatten().collect();
    assert_eq!(claimed.len(), 1, "the others wait for its results");
    assert!(stores[3].ends(of(&claimed[0]), 3).await);
    let given = at_once(&stores, async |_, store: Store| {
        let claimed = store.claim(at(4), lease(4), READER).await.unwrap();
        assert_eq!(claimed.started, []);
        claimed.given.len()
    })
    .await;
    assert_eq!(given.iter().sum::<usize>(), 3);
}

#[tokio::test]
async fn a_process_takes_nothing_from_another_one_that_reports() {
    let [first, second] = several().await;
    let a = queued(&first, 1, "a").await;
    let b = queued(&first, 1, "b").await;
    let of_first = claim(&first, 2).await;
    let of_second = claim(&second, 2).await;
    assert_eq!((of_first.id, of_second.id), (a.id, b.id));
    // Half a minute later only the second one has reported.
    assert!(
        second
            .report(of_second, Default::default(), lease(30))
            .await
            .unwrap()
    );
    let recovered = second.recover(at(33), expired(33), 3, "{}").await.unwrap();
    assert_eq!(recovered, [a.id]);
    // The first one wakes up, and is told that it is too late.
    assert!(
        !first
            .report(of_first, Default::default(), lease(34))
            .await
            .unwrap()
    );
    assert!(!first.ends(of_first, 34).await);
    let again = find(&first, a.id).await;
    assert_eq!(
        (again.status, again.attempts_counted),
        (Status::Accepted, 1)
    );
}

#[tokio::test]
async fn what_ran_together_in_a_process_that_died_is_run_alone_in_one() {
    let [dead, living, third] = several().await;
    let poison = queued(&dead, 1, "poison").await;
    let innocent = queued(&dead, 1, "innocent").await;
    let other = queued(&dead, 1, "other").await;
    claim(&dead, 2).await;
    claim(&dead, 3).await;
    let held = claim(&living, 20).await;
    assert_eq!(held.id, other.id);
    // One lease of the dead process is over: it may be a late report.
    let recover = async |second| {
        let mut ids = living
            .recover(at(second), expired(second), 3, "{}")
            .await
            .unwrap();
        ids.sort();
        ids
    };
    assert!(recover(33).await.is_empty());
    assert_eq!(recover(34).await, [poison.id, innocent.id]);
    assert_eq!(next(&living, 35).await, None, "it computes something else");
    assert_eq!(claim(&third, 35).await.id, poison.id);
    assert_eq!(next(&third, 35).await, None, "nothing begins beside it");
    assert!(living.ends(held, 36).await);
    assert_eq!(claim(&living, 37).await.id, innocent.id);
    assert_eq!(find(&living, innocent.id).await.attempts_counted, 1);
}

#[tokio::test]
async fn a_worker_that_is_gone_is_found_though_its_process_reports_of_others() {
    let [first, second] = several().await;
    let lost = queued(&first, 1, "lost").await;
    queued(&first, 1, "reported").await;
    claim(&first, 2).await;
    let reported = claim(&first, 2).await;
    for second_now in [20, 40, 60] {
        assert!(
            first
                .report(reported, Default::default(), lease(second_now))
                .await
                .unwrap()
        );
    }
    assert!(
        second
            .recover(at(62), expired(62), 3, "{}")
            .await
            .unwrap()
            .is_empty()
    );
    assert_eq!(
        second.recover(at(63), expired(63), 3, "{}").await.unwrap(),
        [lost.id]
    );
}

#[tokio::test]
async fn leases_run_by_the_clock_of_the_database() {
    let address = server::database().await;
    let place = DatabaseAddress::Postgres(address);
    let (early, late) = (another(&place).await, another(&place).await);
    queued(&early, 1, "a").await;
    // The clock of one process says 1970, that of the other one a century later; neither is asked.
    claim(&early, 1).await;
    let century = 100 * 366 * 24 * 3600;
    let recovered = late.recover(at(century), expired(century), 3, "{}").await;
    assert!(recovered.unwrap().is_empty());
}

fn study(total: u64) -> NewStudy {
    NewStudy {
        id: Uuid::now_v7(),
        client: CLIENT.to_owned(),
        name: None,
        tags: Vec::new(),
        document: "{}".to_owned(),
        document_version: 1,
        body_hash: "h".to_owned(),
        gear: "driven".to_owned(),
        total,
        search: None,
        submitted_at: at(1),
        idempotency_key: Some("k".to_owned()),
        client_limit: 100,
        submitted_by: None,
    }
}

fn rows(study: Uuid, range: std::ops::Range<u64>) -> Vec<NewRow> {
    let row = |i: u64| NewRow {
        label: i.to_string(),
        changes: "{}".to_owned(),
        job: Ok(NewJob {
            study: Some(study),
            ..new(1, &format!("{study} {i}"))
        }),
    };
    range.map(row).collect()
}

async fn found(store: &Store, id: Uuid) -> StudyRecord {
    store.find_study(CLIENT, id).await.unwrap().unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_study_is_taken_once_and_its_designs_stand_once_whoever_expands_it() {
    let stores = several::<4>().await;
    let outcomes = at_once(&stores, async |_, store: Store| {
        let study = study(20);
        let rows = rows(study.id, 0..5);
        let outcome = store
            .begin_study(&study, &rows, bounds(1, 10))
            .await
            .unwrap();
        (study.id, outcome)
    })
    .await;
    let taken: Vec<Uuid> = outcomes
        .iter()
        .filter(|(_, outcome)| *outcome == StudyOutcome::Taken)
        .map(|(id, _)| *id)
        .collect();
    let [id] = taken[..] else {
        panic!("{outcomes:?}")
    };
    assert!(
        outcomes
            .iter()
            .all(|(own, outcome)| *own == id || *outcome == StudyOutcome::Repeated(id))
    );

    // All go on where it stands; one of them does.
    let went_on = at_once(&stores, move |_, store: Store| async move {
        let rows = rows(id, 5..20);
        store
            .continue_study(id, 5, &rows, None, at(2), bounds(2, 10))
            .await
            .unwrap()
    })
    .await;
    assert_eq!(went_on.iter().filter(|did| **did).count(), 1);
    let study = found(&stores[0], id).await;
    assert_eq!((study.expanded, study.accepted), (20, 20));
    let rows = stores[0].study_rows(id, -1, 99).await.unwrap();
    assert_eq!(rows.len(), 20);
}

#[tokio::test]
async fn a_study_that_a_process_left_is_expanded_by_one_other() {
    let [first, second, third] = several().await;
    let study = study(20);
    let rows = rows(study.id, 0..5);
    first
        .begin_study(&study, &rows, bounds(1, 10))
        .await
        .unwrap();
    assert!(
        second
            .unfinished_expansions(at(20), 1)
            .await
            .unwrap()
            .is_empty()
    );
    let of_earlier = second.unfinished_expansions(at(22), 0).await.unwrap();
    assert!(of_earlier.is_empty(), "it does not read the document");
    let left = second.unfinished_expansions(at(22), 1).await.unwrap();
    assert_eq!(left, [(study.id, CLIENT.to_owned())]);
    assert!(
        third
            .unfinished_expansions(at(22), 1)
            .await
            .unwrap()
            .is_empty()
    );
}

/// Cancels a study, to the last of its jobs.
async fn cancel(store: &Store, id: Uuid) -> Result<(), crate::StoreError> {
    store.cancel_study(CLIENT, id, By::Owner, at(4)).await?;
    while store.dismiss_designs(id, at(4)).await?.1 {}
    Ok(())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn ends_cancels_and_claims_of_one_study_at_once_count_every_design_once() {
    let stores = several::<4>().await;
    let study = study(80);
    let id = study.id;
    stores[0]
        .begin_study(&study, &rows(id, 0..80), bounds(1, 10))
        .await
        .unwrap();
    let done = at_once(&stores, move |index, store: Store| async move {
        let mut done = 0_u64;
        while let Some(job) = next(&store, 2).await {
            let text = format!("{{\"job\":\"{}\"}}", job.id);
            let end = end(3);
            done += u64::from(
                store
                    .succeed(of(&job), end, &Packed::of(&text), None, VERSION)
                    .await
                    .unwrap(),
            );
            if index == 0 && done == 8 {
                // It is cancelled while the others claim and finish; a transaction that had to give way is tried again.
                while let Err(error) = cancel(&store, id).await {
                    assert!(error.may_pass(), "{error:?}");
                }
            }
        }
        done
    })
    .await;
    let study = found(&stores[1], id).await;
    assert_eq!(study.successful, done.iter().sum::<u64>());
    assert_eq!(
        (
            study.successful + study.dismissed,
            study.accepted,
            study.running
        ),
        (80, 0, 0)
    );
    assert_eq!(study.status(), Status::Dismissed);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_document_that_jobs_come_to_need_is_not_removed_under_them() {
    let stores = several::<4>().await;
    // All compute the same text from different input, and delete their jobs: the last one removes it, and the next makes it.
    at_once(&stores, async |index, store: Store| {
        for round in 0..15 {
            let job = NewJob {
                client: format!("client {index}"),
                ..new(1, &format!("{index} {round}"))
            };
            let id = job.id;
            assert!(matches!(submit(&store, job).await, Outcome::Queued(_)));
            let client = format!("client {index}");
            let claimed = loop {
                // Whichever is next; somebody takes mine.
                match next(&store, 2).await {
                    Some(job) => break job,
                    None => tokio::task::yield_now().await,
                }
            };
            assert!(store.ends(of(&claimed), 3).await);
            while !store
                .find(&client, id)
                .await
                .unwrap()
                .unwrap()
                .status
                .has_ended()
            {
                tokio::task::yield_now().await;
            }
            assert!(store.delete(&client, id, By::Owner, at(9)).await.unwrap());
        }
    })
    .await;
    let left: i64 = query_scalar("select count(*) from documents")
        .fetch_one(&stores[0].readers)
        .await
        .unwrap();
    assert_eq!(left, 0);
}

#[tokio::test]
async fn what_one_process_does_another_one_hears() {
    let [speaker, hearer] = several().await;
    let mut listener = hearer.listen().await.unwrap().unwrap();
    let mut heard = async || listener.next().await.unwrap();
    let job = queued(&speaker, 1, "a").await;
    assert_eq!(heard().await, Notice::Work);
    let claim = claim(&speaker, 2).await;
    assert_eq!(heard().await, Notice::Jobs(Status::Running, vec![job.id]));
    speaker
        .cancel(CLIENT, job.id, By::Owner, at(3))
        .await
        .unwrap()
        .unwrap();
    assert_eq!(heard().await, Notice::Jobs(Status::Dismissed, vec![job.id]));
    assert!(!speaker.holds(claim).await.unwrap());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn processes_that_start_together_make_the_tables_once() {
    let place = DatabaseAddress::Postgres(server::database().await);
    let opened = (0..4).map(|_| {
        let place = place.clone();
        tokio::spawn(async move { Store::open(&place).await.unwrap() })
    });
    let mut stores = Vec::new();
    for store in opened.collect::<Vec<_>>() {
        stores.push(store.await.unwrap());
    }
    queued(&stores[0], 1, "a").await;
    assert!(next(&stores[3], 2).await.is_some());
}

#[tokio::test]
async fn a_server_that_goes_and_comes_is_a_fault_that_passes() {
    let (store, _place) = store().await;
    queued(&store, 1, "a").await;
    // As a restart does to every connection.
    let ended = query("select pg_terminate_backend(pid) from pg_stat_activity where datname = current_database() and pid <> pg_backend_pid()")
        .execute(&store.writer)
        .await;
    ended.unwrap();
    let mut refusals = 0;
    while let Err(error) = store.submit(&[new(2, "b")], bounds(2, 10)).await {
        assert!(error.may_pass(), "{error:?}");
        refusals += 1;
        assert!(refusals <= 10, "as many as there were connections");
    }
    store.writable().await;
    assert_eq!(store.depth().await.unwrap().alone, 2);
}

#[tokio::test]
async fn a_password_stands_in_no_error() {
    for address in [
        "postgres://me:secret@127.0.0.1:1/gears",
        "postgres://me:secret@127.0.0.1:none/gears",
        "postgres://me:secret@nowhere.invalid/gears",
    ] {
        let error = Store::open(&DatabaseAddress::Postgres(address.to_owned()))
            .await
            .unwrap_err();
        let debugged = format!("{error:?}");
        let told = format!("{:#} {debugged}", anyhow::Error::from(error));
        assert!(!told.contains("secret"), "{told}");
    }
}
