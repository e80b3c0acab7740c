//! How little SQLite reads for an answer.

use super::*;
use crate::dialect::sqlite::NEXT_WAITING;
use crate::statement::Dialect;
use crate::submit::WAITING_ALONE;
use crate::{Filter, Membership, Span};

/// The steps by which SQLite would find the jobs of a filter.
async fn plan(store: &Store, filter: &Filter, status: Option<Status>) -> Vec<String> {
    let query = filter.query(Dialect::Sqlite, CLIENT, status, 50);
    let sql = sqlx::AssertSqlSafe(format!("explain query plan {}", query.text()));
    let steps: Vec<(i64, i64, i64, String)> =
        sqlx::query_as(sql).fetch_all(readers(store)).await.unwrap();
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
    let user = || Some("u".to_owned());
    #[rustfmt::skip]
    let cases = [
        (Filter::default(), None, "jobs_of_client"),
        (Filter { span, ..Filter::default() }, None, "jobs_of_client"),
        (Filter::default(), Some(Status::Failed), "jobs_by_status"),
        (Filter { study, ..Filter::default() }, None, "jobs_of_study"),
        (Filter { study, ..Filter::default() }, Some(Status::Failed), "jobs_of_study_by_status"),
        (Filter { study: alone, ..Filter::default() }, None, "jobs_alone"),
        (Filter { study: alone, ..Filter::default() }, Some(Status::Failed), "jobs_alone_by_status"),
        (Filter { tag: tag(), ..Filter::default() }, None, "job_tags"),
        (Filter { submitted_by: user(), ..Filter::default() }, None, "jobs_of_user"),
        (Filter { submitted_by: user(), ..Filter::default() }, Some(Status::Failed), "jobs_of_user_by_status"),
    ];
    for (filter, status, index) in cases {
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
async fn a_claim_looks_at_no_job_that_has_ended() {
    let (store, _folder) = store().await;
    let words = NEXT_WAITING.unwrap();
    let plan = sqlx::AssertSqlSafe(format!("explain query plan {words}"));
    let steps: Vec<(i64, i64, i64, String)> = sqlx::query_as(plan)
        .bind(CLIENT)
        .bind("")
        .fetch_all(readers(&store))
        .await
        .unwrap();
    // Both indexes leave out ended jobs, and the first one has the order of the lane: nothing is sorted.
    let uses = |index: &str| steps.iter().filter(|step| step.3.contains(index)).count();
    assert_eq!(
        (
            uses("jobs_of_lane"),
            uses("jobs_running"),
            uses("TEMP B-TREE")
        ),
        (1, 1, 0),
        "{steps:?}"
    );
}

#[tokio::test]
async fn a_submission_counts_no_designs_of_studies() {
    let (store, _folder) = store().await;
    let plan = sqlx::AssertSqlSafe(format!("explain query plan {WAITING_ALONE}"));
    let steps: Vec<(i64, i64, i64, String)> = sqlx::query_as(plan)
        .fetch_all(readers(&store))
        .await
        .unwrap();
    let lane = "jobs_waiting (client=? AND <expr>=?)";
    assert!(
        steps.iter().any(|step| step.3.contains(lane))
            && !steps.iter().any(|step| step.3.contains("SCAN")),
        "{steps:?}"
    );
}
