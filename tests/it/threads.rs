//! What tasks take of the threads that answer: while one computes there, nobody else is answered.

use std::time::Duration;

use meshwright_connections::{Gauge, measure_polls};
use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};

use crate::bench::{Asked, Bench};

/// More than a task takes at a time, of a program that is hardly optimized; an estimate of a pair with spokes takes several times as much.
const MOST: Duration = Duration::from_millis(250);

/// Has every task of every service fail that takes more of its thread at a time than it may.
pub(crate) fn watch() {
    measure_polls(Gauge {
        time: || {
            let time = clock_gettime(ClockId::ThreadCPUTime);
            Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
        },
        polled: |taken| {
            assert!(
                taken <= MOST,
                "a task took {taken:?} of a thread that answers requests"
            );
        },
    });
}

/// A pair whose driven gear has spokes, each of which is divided into elements to know what it takes; `torque` tells it from others.
fn spoked(torque: u32) -> Value {
    let spokes = json!({ "count": 12, "width_mm": 4.0, "fillet_radius_mm": 2.0, "inner_radius_mm": 60.0, "outer_radius_mm": 284.0 });
    let gear = |teeth, blank| json!({ "tooth_count": teeth, "module_mm": 2.0, "face_width_mm": 20.0, "blank": blank });
    json!({
        "method": "flexible",
        "pair": {
            "center_distance_mm": 350.3,
            "driving": gear(50, json!({ "bore_radius_mm": 15.0 })),
            "driven": gear(300, json!({ "bore_radius_mm": 40.0, "spokes": spokes })),
        },
        "output_torques_n_m": [torque],
        "resolution": { "positions_per_mesh_period": 8, "span_mesh_periods": 1 },
    })
}

/// Sends a request, which is taken or refused for its size; a task that takes too long ends its connection.
async fn send(bench: &Bench, path: &str, document: &Value) {
    // Several submissions are estimated one after the other, each in a second of a quiet machine.
    let request = bench.post(path, document).timeout(Duration::from_secs(600));
    let status = request.answer().await.status();
    assert!(
        [200, 202, 422].contains(&status.as_u16()),
        "{path}: {status}"
    );
}

#[tokio::test]
async fn what_a_batch_asks_is_not_computed_on_the_threads_that_answer() {
    let bench = Bench::quick().await;
    let batch = json!({ "submissions": [spoked(1)] });
    send(&bench, "/v1/jobs/batch", &batch).await;
}

#[tokio::test]
#[ignore = "./test all"]
async fn what_a_request_asks_is_not_computed_on_the_threads_that_answer() {
    let bench = Bench::quick().await;
    let study = json!({ "base": spoked(5), "axes": [{ "path": "/output_torques_n_m/0", "values": [6, 7] }] });
    for (path, document) in [
        ("/v1/jobs", spoked(3)),
        ("/v1/preview", spoked(4)),
        ("/v1/studies", study),
    ] {
        send(&bench, path, &document).await;
    }
}
