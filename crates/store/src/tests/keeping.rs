//! Removal of old jobs, and the size of the stored ones.

use super::*;

#[tokio::test]
async fn what_ended_long_ago_is_removed_with_its_results_and_nothing_else_is() {
    let (store, _folder) = store().await;
    let old = ended(&store, 10, "old").await;
    let young = ended(&store, 100, "young").await;
    let waiting = queued(&store, 1, "waiting").await;
    assert_eq!(store.remove_old(at(50)).await.unwrap().jobs, 1);
    assert!(store.remove_old(at(50)).await.unwrap().is_nothing());
    assert_eq!(store.find(CLIENT, old.id).await.unwrap(), None);
    assert_eq!(store.document(&old.document.unwrap()).await.unwrap(), None);
    assert!(store.find(CLIENT, young.id).await.unwrap().is_some());
    assert!(store.find(CLIENT, waiting.id).await.unwrap().is_some());
}

#[tokio::test]
async fn a_document_takes_less_than_its_text() {
    let (store, _folder) = store().await;
    let text: String = (0..5000)
        .map(|i| format!("{:.6},", (f64::from(i) / 7.0).sin()))
        .collect();
    queued(&store, 1, "a").await;
    let claim = claim(&store, 2).await;
    assert!(
        store
            .succeed(claim, end(3), &Packed::of(&text), None, VERSION)
            .await
            .unwrap()
    );
    let (size, kept): (i64, i64) =
        query_as("select size, cast(length(body) as bigint) from documents")
            .fetch_one(&store.readers)
            .await
            .unwrap();
    assert_eq!(usize::try_from(size).unwrap(), text.len());
    assert!(kept * 2 < size, "{kept} of {size}");
}

#[tokio::test]
async fn who_wants_results_is_not_answered_by_a_job_that_kept_statistics() {
    let (store, _folder) = store().await;
    let frugal = |second, input| NewJob {
        keep: Kept::Statistics,
        ..new(second, input)
    };
    let (name, whole) = (Packed::name_of("{}"), Packed::of("{}"));
    let Outcome::Queued(first) = submit(&store, frugal(1, "a")).await else {
        panic!("nothing is known")
    };
    let wants = queued(&store, 1, "a").await;
    let held = claim(&store, 2).await;
    assert_eq!(held.id, first.id);
    let kept = store.succeed(held, end(3), &name, Some("{}"), VERSION);
    assert!(kept.await.unwrap());
    let hash = find(&store, first.id).await.document.unwrap();
    assert_eq!(store.document(&hash).await.unwrap(), None);
    assert!(matches!(
        submit(&store, frugal(4, "a")).await,
        Outcome::Known(_)
    ));

    let held = claim(&store, 5).await;
    assert_eq!(held.id, wants.id, "computed, not given what there is not");
    let kept = store.succeed(held, end(6), &whole, Some("{}"), VERSION);
    assert!(kept.await.unwrap());
    assert!(store.document(&hash).await.unwrap().is_some());
    assert!(matches!(
        submit(&store, new(7, "a")).await,
        Outcome::Known(_)
    ));

    // Who keeps less takes nothing from those who keep more.
    submit(&store, frugal(8, "b")).await;
    let held = claim(&store, 8).await;
    let kept = store.succeed(held, end(9), &name, Some("{}"), VERSION);
    assert!(kept.await.unwrap());
    assert!(store.document(&hash).await.unwrap().is_some());
}
