//! The transitions of a job.

use uuid::Uuid;

use super::*;
use crate::statement::query;
use crate::{Cursor, Filter};

#[tokio::test]
async fn the_job_that_came_first_is_claimed_first_and_only_once() {
    let (store, _folder) = store().await;
    // Whatever the clock said.
    let first = queued(&store, 2, "a").await;
    let second = queued(&store, 1, "b").await;
    let claimed = next(&store, 10).await.unwrap();
    assert_eq!(
        (claimed.id, claimed.status, claimed.attempt),
        (first.id, Status::Running, 1)
    );
    assert_eq!(claimed.started_at, Some(at(10)));
    assert_eq!(claim(&store, 11).await.id, second.id);
    assert_eq!(next(&store, 12).await, None);
}

#[tokio::test]
async fn a_job_ends_with_the_very_text_of_its_results() {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    let claim = claim(&store, 2).await;
    assert!(
        store
            .report(
                claim,
                Progress {
                    done: 50,
                    total: 200
                },
                lease(30)
            )
            .await
            .unwrap()
    );
    assert_eq!(
        find(&store, job.id).await.progress,
        Progress {
            done: 50,
            total: 200
        }
    );
    assert!(
        store
            .succeed(
                claim,
                end(5),
                &Packed::of("{ \"x\": 1.0e0 }"),
                None,
                VERSION
            )
            .await
            .unwrap()
    );

    let job = find(&store, job.id).await;
    assert_eq!(
        (job.status, job.progress.percent()),
        (Status::Successful, 100)
    );
    assert_eq!(job.elapsed.unwrap().as_secs(), 3);
    let document = store.document(&job.document.unwrap()).await.unwrap();
    assert_eq!(document.unwrap().text().unwrap(), "{ \"x\": 1.0e0 }");
}

/// Changes one bit of a stored value.
async fn flip(store: &Store, words: &'static str) {
    let mut write = store.begin().await.unwrap();
    let changed = query(words).execute(&mut *write).await.unwrap();
    assert_eq!(changed, 1);
    write.commit().await.unwrap();
}

#[tokio::test]
async fn a_document_of_which_a_bit_was_flipped_is_told_as_damaged_and_one_without_a_checksum_is_not_looked_at()
 {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    let claim = claim(&store, 2).await;
    let packed = Packed::of("{ \"x\": 1.0e0 }");
    store
        .succeed(claim, end(5), &packed, None, VERSION)
        .await
        .unwrap();
    let hash = find(&store, job.id).await.document.unwrap();
    let document = async || store.document(&hash).await.unwrap().unwrap();
    let submission = async || store.submission(job.id).await.unwrap().unwrap();
    assert!(document().await.gzip().is_ok() && submission().await.is_ok());
    // The flags of the gzip file, which its own checksum does not see.
    let words = match store.is_shared() {
        true => "update documents set body = set_byte(body, 9, 7)",
        false => {
            "update documents set body = cast(substr(body, 1, 9) || x'07' || substr(body, 11) as blob)"
        }
    };
    flip(&store, words).await;
    assert!(document().await.gzip().is_err());
    flip(&store, "update documents set checksum = null").await;
    assert!(document().await.gzip().is_ok());
    flip(
        &store,
        "update submissions set body = '[' || substr(body, 2)",
    )
    .await;
    assert!(submission().await.is_err());
    flip(&store, "update submissions set checksum = null").await;
    assert!(submission().await.is_ok());
}

#[tokio::test]
async fn only_the_latest_attempt_may_report_or_finish() {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    let lost = claim(&store, 2).await;
    assert_eq!(
        store.recover(at(33), expired(33), 3, "{}").await.unwrap(),
        [job.id]
    );
    let held = claim(&store, 34).await;
    assert_eq!(held.attempt, 2);

    assert!(
        !store
            .report(lost, Progress::default(), lease(60))
            .await
            .unwrap()
    );
    assert!(!store.ends(lost, 35).await);
    assert!(!store.fail(lost, end(35), "{}").await.unwrap());
    assert!(!store.release(lost).await.unwrap());
    assert_eq!(find(&store, job.id).await.status, Status::Running);
    let documents: i64 = query_scalar("select count(*) from documents")
        .fetch_one(&store.writer)
        .await
        .unwrap();
    assert_eq!(
        documents, 0,
        "results that come too late leave nothing behind"
    );

    assert!(store.ends(held, 36).await);
}

#[tokio::test]
async fn a_job_that_loses_three_workers_fails() {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    for attempt in 1..=3 {
        assert_eq!(claim(&store, 2).await.attempt, attempt);
        assert_eq!(
            store
                .recover(at(3), Lost::Process, 3, r#"{"code":"lost"}"#)
                .await
                .unwrap(),
            [job.id]
        );
    }
    let job = find(&store, job.id).await;
    assert_eq!((job.status, job.finished_at), (Status::Failed, Some(at(3))));
    assert_eq!(job.problem.unwrap()["code"], "lost");
}

#[tokio::test]
async fn a_lease_that_is_not_over_is_left_alone() {
    let (store, _folder) = store().await;
    queued(&store, 1, "a").await;
    claim(&store, 2).await;
    assert!(
        store
            .recover(at(31), expired(31), 3, "{}")
            .await
            .unwrap()
            .is_empty()
    );
}

#[tokio::test]
async fn a_shutdown_does_not_count_as_an_attempt_but_still_fences() {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    let given_back = claim(&store, 2).await;
    assert!(store.release(given_back).await.unwrap());
    let waiting = find(&store, job.id).await;
    assert_eq!(
        (waiting.status, waiting.attempts_counted, waiting.started_at),
        (Status::Accepted, 0, None)
    );

    let held = claim(&store, 3).await;
    assert_eq!(find(&store, job.id).await.attempts_counted, 1);
    assert!(!store.ends(given_back, 4).await);
    assert!(store.ends(held, 4).await);
}

#[tokio::test]
async fn a_waiting_and_a_running_job_can_be_cancelled_and_an_ended_one_cannot() {
    let (store, _folder) = store().await;
    let running = queued(&store, 1, "a").await;
    let waiting = queued(&store, 2, "b").await;
    let claim = claim(&store, 3).await;
    for id in [running.id, waiting.id] {
        assert_eq!(
            store
                .cancel(CLIENT, id, By::Owner, at(4))
                .await
                .unwrap()
                .unwrap()
                .status,
            Status::Dismissed
        );
        assert_eq!(
            store.cancel(CLIENT, id, By::Owner, at(5)).await.unwrap(),
            None
        );
    }
    assert!(
        !store
            .report(claim, Progress::default(), lease(20))
            .await
            .unwrap()
    );
    assert_eq!(next(&store, 6).await, None);
}

#[tokio::test]
async fn equal_input_gets_the_results_at_once_even_after_the_first_job_is_deleted() {
    let (store, _folder) = store().await;
    let first = queued(&store, 1, "a").await;
    assert!(store.ends(claim(&store, 2).await, 3).await);

    let Outcome::Known(second) = submit(&store, new(4, "a")).await else {
        panic!("computed twice")
    };
    assert_eq!(
        (second.status, second.same_as),
        (Status::Successful, Some(first.id))
    );
    let Outcome::Known(third) = submit(&store, new(5, "a")).await else {
        panic!("computed twice")
    };
    assert_eq!(third.same_as, Some(first.id));

    assert!(
        store
            .delete(CLIENT, first.id, By::Owner, at(9))
            .await
            .unwrap()
    );
    let second = find(&store, second.id).await;
    assert_eq!(second.same_as, None);
    let hash = second.document.unwrap();
    assert!(store.document(&hash).await.unwrap().is_some());
    assert!(
        store
            .delete(CLIENT, second.id, By::Owner, at(9))
            .await
            .unwrap()
    );
    assert!(
        store
            .delete(CLIENT, third.id, By::Owner, at(9))
            .await
            .unwrap()
    );
    assert_eq!(
        store.document(&hash).await.unwrap(),
        None,
        "the last job takes the document with it"
    );
}

#[tokio::test]
async fn another_client_or_another_version_computes_afresh() {
    let (store, _folder) = store().await;
    queued(&store, 1, "a").await;
    assert!(store.ends(claim(&store, 2).await, 3).await);
    let mut foreign = new(4, "a");
    foreign.client = "other".to_owned();
    assert!(matches!(submit(&store, foreign).await, Outcome::Queued(_)));
    let upgraded = store
        .submit(
            &[new(5, "a")],
            QueueBounds {
                solver_version: "2.0",
                ..bounds(5, 10)
            },
        )
        .await
        .unwrap();
    assert!(matches!(upgraded[..], [Outcome::Queued(_)]));
}

#[tokio::test]
async fn a_key_answers_with_the_same_job_for_a_day() {
    let (store, _folder) = store().await;
    let keyed = |second, input| NewJob {
        idempotency_key: Some("k".to_owned()),
        ..new(second, input)
    };
    let Outcome::Queued(job) = submit(&store, keyed(1, "a")).await else {
        panic!("not queued")
    };
    assert_eq!(
        submit(&store, keyed(2, "a")).await,
        Outcome::Repeated(job.clone())
    );
    assert_eq!(submit(&store, keyed(3, "b")).await, Outcome::KeyConflict);

    let day = 24 * 60 * 60;
    let next = store
        .submit(
            &[keyed(day + 2, "b")],
            QueueBounds {
                forget_keys_before: at(2),
                ..bounds(day + 2, 10)
            },
        )
        .await
        .unwrap();
    assert!(
        matches!(next[..], [Outcome::Queued(_)]),
        "the key of second 1 is forgotten: {next:?}"
    );
}

#[tokio::test]
async fn a_key_sees_the_submission_before_it_in_the_same_commit() {
    let (store, _folder) = store().await;
    let keyed = |input| NewJob {
        idempotency_key: Some("k".to_owned()),
        ..new(1, input)
    };
    let outcomes = store
        .submit(&[keyed("a"), keyed("a"), keyed("b")], bounds(1, 10))
        .await
        .unwrap();
    assert!(matches!(
        outcomes[..],
        [
            Outcome::Queued(_),
            Outcome::Repeated(_),
            Outcome::KeyConflict
        ]
    ));
}

#[tokio::test]
async fn a_full_queue_takes_no_more_but_still_knows_what_it_has_done() {
    let (store, _folder) = store().await;
    queued(&store, 1, "done").await;
    assert!(store.ends(claim(&store, 2).await, 3).await);
    let batch = [new(4, "a"), new(4, "b"), new(4, "c"), new(4, "done")];
    let outcomes = store.submit(&batch, bounds(4, 2)).await.unwrap();
    assert!(matches!(
        outcomes[..],
        [
            Outcome::Queued(_),
            Outcome::Queued(_),
            Outcome::QueueFull { waiting: 2 },
            Outcome::Known(_)
        ]
    ));
}

#[tokio::test]
async fn a_running_job_is_not_deleted() {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    claim(&store, 2).await;
    assert!(
        !store
            .delete(CLIENT, job.id, By::Owner, at(9))
            .await
            .unwrap()
    );
    assert!(
        store
            .cancel(CLIENT, job.id, By::Owner, at(3))
            .await
            .unwrap()
            .is_some()
    );
    assert!(
        !store
            .delete("other", job.id, By::Owner, at(9))
            .await
            .unwrap()
    );
    assert!(
        store
            .delete(CLIENT, job.id, By::Owner, at(9))
            .await
            .unwrap()
    );
    assert_eq!(store.find(CLIENT, job.id).await.unwrap(), None);
}

#[tokio::test]
async fn the_list_turns_its_pages_newest_first_and_selects() {
    let (store, _folder) = store().await;
    let mut jobs = Vec::new();
    for second in [1, 1, 2, 3] {
        jobs.push(queued(&store, second, &format!("input {}", jobs.len())).await);
    }
    let list = async |filter: Filter, limit| {
        let jobs = store.list(CLIENT, &filter, limit).await.unwrap();
        jobs.iter().map(|job| job.id).collect::<Vec<_>>()
    };
    assert_eq!(list(Filter::default(), 2).await, [jobs[3].id, jobs[2].id]);
    let behind = Filter {
        after: Some(Cursor(jobs[2].sequence)),
        ..Filter::default()
    };
    assert_eq!(list(behind, 9).await, [jobs[1].id, jobs[0].id]);
    let tagged = Filter {
        tag: Some("input 1".to_owned()),
        ..Filter::default()
    };
    assert_eq!(list(tagged, 9).await, [jobs[1].id]);
    let these = Filter {
        ids: Some(vec![jobs[0].id, Uuid::nil(), jobs[3].id]),
        ..Filter::default()
    };
    assert_eq!(list(these, 9).await, [jobs[3].id, jobs[0].id]);
    claim(&store, 4).await;
    let running = Filter {
        statuses: Some(vec![Status::Running, Status::Failed]),
        ..Filter::default()
    };
    assert_eq!(list(running, 9).await, [jobs[0].id]);
    assert!(
        list(
            Filter {
                statuses: Some(vec![]),
                ..Filter::default()
            },
            9
        )
        .await
        .is_empty()
    );
    let depth = store.depth().await.unwrap();
    assert_eq!((depth.alone, depth.in_studies, depth.running), (3, 0, 1));
    assert_eq!(depth.oldest, Some(at(1)));
}
