//! A disk that is full, a database that is locked, damaged, or no database at all.

use std::fs;

use super::*;
use crate::{OpenError, StoreError};

/// Leaves the connection that writes no more pages than there are.
async fn fill_disk(store: &Store) {
    let pages: i64 = sqlx::query_scalar("pragma page_count")
        .fetch_one(writer(store))
        .await
        .unwrap();
    let statement = sqlx::AssertSqlSafe(format!("pragma max_page_count = {pages}"));
    sqlx::raw_sql(statement)
        .execute(writer(store))
        .await
        .unwrap();
}

/// A document that needs pages of its own: digits that do not pack.
fn large() -> Packed {
    let mut seed = 1_u64;
    let digits = (0..40_000).map(|_| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        char::from(b'0' + ((seed >> 33) % 10) as u8)
    });
    Packed::of(&digits.collect::<String>())
}

#[tokio::test]
async fn a_full_disk_costs_one_answer_and_wedges_nothing() {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    let claim = claim(&store, 2).await;
    for _ in 0..3 {
        fill_disk(&store).await;
        let refused = store
            .succeed(claim, end(3), &large(), None, VERSION)
            .await
            .unwrap_err();
        assert!(matches!(refused, StoreError::Unavailable(_)), "{refused:?}");
        assert_eq!(
            find(&store, job.id).await.status,
            Status::Running,
            "nothing of it is kept"
        );
        // There is room again: the next transaction has a connection that knows of no earlier one.
        store.writable().await;
        queued(&store, 4, &Uuid::now_v7().to_string()).await;
    }
    assert!(
        store
            .succeed(claim, end(5), &large(), None, VERSION)
            .await
            .unwrap()
    );
    assert_eq!(find(&store, job.id).await.status, Status::Successful);
    assert_eq!(store.fault(), None);
}

#[tokio::test]
async fn a_locked_database_is_told_as_such_and_found_to_be_free_again() {
    let (store, folder) = store().await;
    let other = open(&folder).await;
    let mut held = other.begin().await.unwrap();
    query("select 1").execute(&mut *held).await.unwrap();
    sqlx::raw_sql("pragma busy_timeout = 20")
        .execute(writer(&store))
        .await
        .unwrap();
    let refused = store
        .submit(&[new(1, "a")], bounds(1, 10))
        .await
        .unwrap_err();
    assert!(matches!(refused, StoreError::Unavailable(_)), "{refused:?}");
    assert!(store.fault().is_some_and(|cause| cause.contains("locked")));
    held.rollback().await.unwrap();
    tokio::time::timeout(std::time::Duration::from_secs(60), store.writable())
        .await
        .unwrap();
    queued(&store, 2, "a").await;
}

#[tokio::test]
async fn what_is_no_database_is_refused_and_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("jobs.db");
    for content in [
        &b"garbage, and long enough to be a header of something"[..],
        b"short",
    ] {
        fs::write(&path, content).unwrap();
        let refused = Store::open(&DatabaseAddress::File(path.clone()))
            .await
            .unwrap_err();
        assert!(matches!(refused, OpenError::NotADatabase), "{refused:?}");
        assert_eq!(fs::read(&path).unwrap(), content);
    }
    // Many programs begin with an empty file.
    fs::write(&path, b"").unwrap();
    assert!(
        Store::open(&DatabaseAddress::File(path.clone()))
            .await
            .is_ok()
    );
}

#[tokio::test]
async fn a_database_that_was_cut_off_is_refused() {
    let (store, folder) = store().await;
    for i in 0..200 {
        queued(&store, i, &i.to_string()).await;
    }
    store.close().await;
    let path = folder.path().join("jobs.db");
    let whole = fs::read(&path).unwrap();
    for kept in [whole.len() / 2, 5000, 200] {
        fs::write(&path, &whole[..kept]).unwrap();
        let refused = Store::open(&DatabaseAddress::File(path.clone()))
            .await
            .unwrap_err();
        assert!(
            matches!(refused, OpenError::Damaged(_) | OpenError::NotADatabase),
            "{kept}: {refused:?}"
        );
        assert_eq!(
            fs::read(&path).unwrap().len(),
            kept,
            "nothing was cut off it"
        );
        // The recovered journal is written into it before it is read.
        let told = refused.to_string();
        assert!(
            kept < 5000 || !told.contains("nothing was changed"),
            "{told}"
        );
    }
    fs::write(&path, &whole).unwrap();
    assert!(
        Store::open(&DatabaseAddress::File(path.clone()))
            .await
            .is_ok()
    );
}

#[tokio::test]
async fn pages_of_garbage_are_found_at_the_start() {
    let (store, folder) = store().await;
    for i in 0..300 {
        queued(&store, i, &i.to_string()).await;
    }
    store.close().await;
    let path = folder.path().join("jobs.db");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle..middle + 16_384].fill(0x5a);
    fs::write(&path, &bytes).unwrap();
    let refused = Store::open(&DatabaseAddress::File(path.clone()))
        .await
        .unwrap_err();
    assert!(matches!(refused, OpenError::Damaged(_)), "{refused:?}");
}

#[tokio::test]
async fn a_database_of_a_later_version_is_used_or_left_alone_as_it_says() {
    let (store, folder) = store().await;
    sqlx::raw_sql(
        "insert into _sqlx_migrations (version, description, success, checksum, execution_time)
         values (29990101000000, 'later', true, x'00', 0)",
    )
    .execute(writer(&store))
    .await
    .unwrap();
    // It says that this version can work on it, and then that it cannot.
    let beside = open(&folder).await;
    queued(&beside, 1, "a").await;
    beside.close().await;
    query("update compatibility set least_migration = 29990101000000")
        .execute(&store.writer)
        .await
        .unwrap();
    store.close().await;
    let refused = Store::open(&place(&folder)).await.unwrap_err();
    assert!(
        matches!(refused, OpenError::Newer(29_990_101_000_000)),
        "{refused:?}"
    );
}
