//! Lists: what they select, in what order, and how little they read for it.

use super::*;
use crate::jobs::store::{Filter, Membership, Span};
use crate::wire::Status;

/// The steps by which SQLite would find the jobs of a filter.
async fn plan(store: &Store, filter: &Filter, status: Option<Status>) -> Vec<String> {
    let query = filter.query(CLIENT, status, 50);
    let sql = sqlx::AssertSqlSafe(format!("explain query plan {}", query.sql().as_str()));
    let steps: Vec<(i64, i64, i64, String)> =
        sqlx::query_as(sql).fetch_all(&store.readers).await.unwrap();
    steps.into_iter().map(|step| step.3).collect()
}

#[tokio::test]
async fn no_list_walks_the_history_or_sorts_it() {
    let (store, _folder) = store().await;
    let study = Some(Membership::Of(Uuid::now_v7()));
    let alone = Some(Membership::Alone);
    let span = Span {
        from: Some(at(1)),
        until: Some(at(2)),
    };
    let tag = || Some("a".to_owned());
    for (filter, status, index) in [
        (Filter::default(), None, "jobs_of_client"),
        (
            Filter {
                span,
                ..Filter::default()
            },
            None,
            "jobs_of_client",
        ),
        (Filter::default(), Some(Status::Failed), "jobs_by_status"),
        (
            Filter {
                study,
                ..Filter::default()
            },
            None,
            "jobs_of_study",
        ),
        (
            Filter {
                study,
                ..Filter::default()
            },
            Some(Status::Failed),
            "jobs_of_study_by_status",
        ),
        (
            Filter {
                study: alone,
                ..Filter::default()
            },
            None,
            "jobs_alone",
        ),
        (
            Filter {
                study: alone,
                ..Filter::default()
            },
            Some(Status::Failed),
            "jobs_alone_by_status",
        ),
        (
            Filter {
                tag: tag(),
                ..Filter::default()
            },
            None,
            "job_tags",
        ),
    ] {
        let steps = plan(&store, &filter, status).await;
        let told = format!("{filter:?} {status:?}: {steps:#?}");
        assert!(steps.iter().any(|step| step.contains(index)), "{told}");
        assert!(
            !steps
                .iter()
                .any(|step| step.contains("SCAN") || step.contains("TEMP B-TREE")),
            "{told}"
        );
    }
    // A few named jobs may be sorted; they are found one by one.
    let named = Filter {
        ids: Some(vec![Uuid::nil()]),
        ..Filter::default()
    };
    let steps = plan(&store, &named, None).await;
    assert!(
        steps.iter().any(|step| step.contains("(id=?)")),
        "{steps:#?}"
    );
}

#[tokio::test]
async fn a_span_of_time_is_a_stretch_of_the_list() {
    let (store, _folder) = store().await;
    let mut jobs = Vec::new();
    for second in [10, 20, 30, 40] {
        jobs.push(queued(&store, second, &second.to_string()).await.id);
    }
    let list = async |from: Option<i64>, until: Option<i64>| {
        let span = Span {
            from: from.map(at),
            until: until.map(at),
        };
        let filter = Filter {
            span,
            ..Filter::default()
        };
        let found = store.list(CLIENT, &filter, 9).await.unwrap();
        found.into_iter().map(|job| job.id).collect::<Vec<_>>()
    };
    assert_eq!(list(Some(20), None).await, [jobs[3], jobs[2], jobs[1]]);
    assert_eq!(list(None, Some(30)).await, [jobs[1], jobs[0]]);
    assert_eq!(list(Some(15), Some(40)).await, [jobs[2], jobs[1]]);
    assert!(list(Some(41), None).await.is_empty());
    assert_eq!(list(None, Some(41)).await.len(), 4);
    assert!(list(None, Some(10)).await.is_empty());
}

#[tokio::test]
async fn several_states_are_merged_in_order() {
    let (store, _folder) = store().await;
    let first = ended(&store, 1, "a").await;
    let second = queued(&store, 2, "b").await;
    let third = ended(&store, 3, "b-not").await;
    let filter = Filter {
        statuses: Some(vec![Status::Accepted, Status::Running, Status::Successful]),
        ..Filter::default()
    };
    let found = store.list(CLIENT, &filter, 2).await.unwrap();
    let ids: Vec<_> = found.iter().map(|job| job.id).collect();
    assert_eq!(ids.len(), 2);
    assert!(
        ids.contains(&third.id) || ids.contains(&second.id),
        "{ids:?} {}",
        first.id
    );
    assert!(found.is_sorted_by(|a, b| a.sequence > b.sequence));
}
