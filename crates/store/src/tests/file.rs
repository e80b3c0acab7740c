//! Properties of a file only: its space is returned, a copy of it is whole, and it belongs to its owner.

use super::*;
use crate::BackupError;

/// A large document, another one for each name.
fn large(name: &str) -> Packed {
    let line = |i: usize| crate::hash::sha256_hex(&format!("{name} {i}"));
    Packed::of(&(0..2000).map(line).collect::<String>())
}

async fn ended_with_much(store: &Store, second: i64, input: &str) -> Job {
    let job = queued(store, second, input).await;
    let claim = claim(store, second).await;
    assert!(
        store
            .succeed(claim, end(second), &large(input), None, VERSION)
            .await
            .unwrap()
    );
    find(store, job.id).await
}

#[tokio::test]
async fn the_space_of_what_is_removed_is_given_back() {
    let (store, _folder) = store().await;
    let before = store.space().await.unwrap();
    for i in 0..40 {
        ended_with_much(&store, i, &i.to_string()).await;
    }
    let full = store.space().await.unwrap();
    assert!(full.file > before.file + 1_000_000, "{full:?}");
    while !store.remove_old(at(1000)).await.unwrap().is_nothing() {}
    while store.shrink().await.unwrap() {}
    let after = store.space().await.unwrap();
    assert!(after.file < before.file + 100_000, "{after:?}");
    assert_eq!(after.free, 0);
    store.empty_journal().await.unwrap();
    assert_eq!(store.journal_bytes(), 0);
}

#[tokio::test]
async fn a_backup_is_whole_while_others_write_and_takes_no_place() {
    let (store, folder) = store().await;
    let job = ended(&store, 1, "a").await;
    // Somebody writes meanwhile, and is not seen.
    let mut write = store.begin().await.unwrap();
    let delete = query("delete from submissions");
    assert_eq!(delete.execute(&mut *write).await.unwrap(), 1);
    let (database, target) = (place(&folder), folder.path().join("copy.db"));
    Store::backup(&database, &target).await.unwrap();
    write.rollback().await.unwrap();

    let copy = Store::open(&DatabaseAddress::File(target.clone()))
        .await
        .unwrap();
    assert!(copy.submission(job.id).await.unwrap().is_some());
    let found = copy.find(CLIENT, job.id).await.unwrap().unwrap();
    let text = copy
        .document(&found.document.unwrap())
        .await
        .unwrap()
        .unwrap()
        .text()
        .unwrap();
    assert_eq!(text, "{\"of\":\"a\"}");
    let again = Store::backup(&database, &target).await.unwrap_err();
    assert!(matches!(again, BackupError::Exists(_)));
    assert!(!folder.path().join("copy.db.partial").exists());
}

#[cfg(unix)]
#[tokio::test]
async fn nobody_but_its_owner_reads_a_database_or_its_copy() {
    use std::os::unix::fs::PermissionsExt;

    let (store, folder) = store().await;
    ended(&store, 1, "a").await;
    let (database, target) = (place(&folder), folder.path().join("copy.db"));
    Store::backup(&database, &target).await.unwrap();
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let entry = entry.unwrap();
        let mode = entry.metadata().unwrap().permissions().mode();
        assert_eq!(mode & 0o077, 0, "{:?}", entry.file_name());
    }
    assert!(target.exists() && folder.path().join("jobs.db-wal").exists());
}

#[tokio::test]
async fn a_commit_waits_for_the_disk_whatever_was_committed_before() {
    const NORMAL: i64 = 1;
    const FULL: i64 = 2;
    async fn waits(write: &mut super::super::write::Write) -> i64 {
        let mode = query_scalar("select synchronous from pragma_synchronous");
        mode.fetch_one(&mut **write).await.unwrap()
    }
    let (store, _folder) = store().await;
    for _ in 0..3 {
        let mut write = store.begin_relaxed().await.unwrap();
        query(super::super::dialect::probe())
            .execute(&mut *write)
            .await
            .unwrap();
        assert_eq!(waits(&mut write).await, NORMAL);
        write.commit().await.unwrap();
        let mut write = store.begin().await.unwrap();
        query(super::super::dialect::probe())
            .execute(&mut *write)
            .await
            .unwrap();
        assert_eq!(waits(&mut write).await, FULL);
        write.commit().await.unwrap();
    }
}
