//! Lists: selection, order, and the number of rows that they read.

use super::*;
use crate::{Filter, Span};

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
