//! A file is served by one process, whatever name leads to it.

use meshwright::jobs::Place;

use crate::bench::Bench;

#[tokio::test]
async fn a_database_is_served_by_one_process_only() {
    let mut bench = Bench::quick().await;
    let refusal = bench.another().await.err().unwrap();
    assert!(refusal.to_string().contains("another process"), "{refusal}");
    bench.shut_down().await;
    bench.another().await.unwrap().shut_down().await;
}

#[cfg(unix)]
#[tokio::test]
async fn links_of_both_kinds_lead_to_the_same_lock() {
    let bench = Bench::quick().await;
    let database = bench.config.database.file().unwrap();
    let folder = tempfile::tempdir_in(database.parent().unwrap()).unwrap();
    let symbolic = folder.path().join("symbolic.db");
    let hard = folder.path().join("hard.db");
    std::os::unix::fs::symlink(database, &symbolic).unwrap();
    std::fs::hard_link(database, &hard).unwrap();
    for path in [symbolic, hard] {
        let refusal = bench.another_on(Place::File(path)).await.err().unwrap();
        assert!(refusal.to_string().contains("another process"), "{refusal}");
    }
}
