//! Transactions without an end, and documents that differ from their checksums.

use super::*;

#[tokio::test]
async fn a_transaction_that_is_dropped_half_way_leaves_nothing_and_blocks_nobody() {
    let (store, _folder) = store().await;
    let mut write = store.begin().await.unwrap();
    query("delete from served")
        .execute(&mut *write)
        .await
        .unwrap();
    drop(write);
    queued(&store, 1, "a").await;
    let rows: i64 = query_scalar("select count(*) from served")
        .fetch_one(&store.readers)
        .await
        .unwrap();
    assert_eq!(rows, 1);
}

#[tokio::test]
async fn a_document_that_is_damaged_is_not_given_out() {
    let (store, _folder) = store().await;
    let job = ended(&store, 1, "a").await;
    let hash = job.document.unwrap();
    query("update documents set body = $1")
        .bind(Packed::of("{\"of\":\"b\"}").for_tests())
        .execute(&store.writer)
        .await
        .unwrap();
    let document = store.document(&hash).await.unwrap().unwrap();
    assert!(document.text().is_err());
}
