//! The stream of a job's events.

use crate::bench::{Asked, Bench, Events, WAIT, submission};

impl Events {
    async fn status(&mut self) -> String {
        let (name, data) = self.next().await.unwrap();
        assert_eq!(name, "status", "{data}");
        data["status"].as_str().unwrap().to_owned()
    }

    /// The number of positions that the next report of progress tells.
    async fn positions(&mut self) -> u64 {
        let (name, data) = self.next().await.unwrap();
        assert_eq!(
            (name.as_str(), data["positions_total"].as_u64()),
            ("progress", Some(200)),
            "{data}"
        );
        assert_eq!(
            data["progress_percent"].as_u64().unwrap(),
            data["positions_done"].as_u64().unwrap() / 2
        );
        data["positions_done"].as_u64().unwrap()
    }
}

#[tokio::test]
async fn a_stream_shows_each_state_and_progress_that_moves_and_ends_with_the_job() {
    let (bench, mut engine) = Bench::steered().await;
    let other = bench.submit(&submission(1.0)).await;
    let other_work = engine.next().await;
    let path = bench.submit(&submission(115.0)).await;
    let mut events = Events::of(&bench, &path).await;
    assert_eq!(events.status().await, "accepted");
    other_work.finish();
    let work = engine.next().await;
    assert_eq!(events.status().await, "running");
    assert_eq!(events.positions().await, 0);
    for done in [50, 100, 150] {
        work.reach(50);
        assert_eq!(events.positions().await, done);
        assert_eq!(bench.job(&path).await["positions_done"], done);
    }
    work.finish();
    assert_eq!(events.status().await, "successful");
    assert!(
        events.next().await.is_none(),
        "the stream ends with the job"
    );

    let mut late = Events::of(&bench, &other).await;
    assert_eq!(late.status().await, "successful");
    assert!(late.next().await.is_none());
}

#[tokio::test]
async fn a_stream_tells_of_a_cancel() {
    let (bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&submission(115.0)).await;
    let work = engine.next().await;
    let mut events = Events::of(&bench, &path).await;
    assert_eq!(events.status().await, "running");
    bench.cancel(&path).answer().await;
    loop {
        let (name, data) = events.next().await.unwrap();
        if name == "status" {
            assert_eq!(data["status"], "dismissed");
            break;
        }
    }
    assert!(events.next().await.is_none());
    work.stopped().await;
}

#[tokio::test]
async fn a_shutdown_ends_the_stream_and_who_waits_is_answered() {
    let (mut bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&submission(115.0)).await;
    let work = engine.next().await;
    let mut events = Events::of(&bench, &path).await;
    assert_eq!(events.status().await, "running");
    let waiting = tokio::spawn(bench.get(&path).header("prefer", WAIT).send());
    // The wait has begun when the service has answered a request that came after it.
    bench.job(&path).await;
    bench.shut_down().await;
    while events.next().await.is_some() {}
    let answer = waiting.await.unwrap().unwrap().document().await;
    assert!(["running", "accepted"].contains(&answer["status"].as_str().unwrap()));
    work.stopped().await;
}
