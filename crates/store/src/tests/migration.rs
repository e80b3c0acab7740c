//! A database of the version before this one is brought up to date, and loses nothing.

use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection};

use super::*;
use crate::Filter;
use crate::open::migrations;
use crate::statement::Dialect;

/// The database that the version before this one wrote.
const BEFORE: &str = r#"
insert into documents (hash, body) values
    ('2f2d5bd0e1f5e0c0b3ad3b1d4f8a4f0ad6f4dbe0b54ae7a5b4e0ad8d4b1c9d11', '{"of":"a"}');
insert into studies (id, client, document, body_hash, gear, total, expanded, submitted_at, idempotency_key) values
    ('00000000-0000-7000-8000-0000000000aa', 'portal', '{"base":{}}', 'h', 'driven', 3, 3, 900, 'word');
insert into jobs (id, client, method, tags, submission, input_hash, status, attempt, positions_done, positions_total,
                  submitted_at, started_at, finished_at, document, solver_version, lease_until, study, priority) values
    ('00000000-0000-7000-8000-000000000001', 'portal', 'flexible', '["x","x","y"]', '{"input":"a"}', 'a', 'successful', 1,
     200, 200, 1000, 2000, 5000, '2f2d5bd0e1f5e0c0b3ad3b1d4f8a4f0ad6f4dbe0b54ae7a5b4e0ad8d4b1c9d11', '1.0', null, null, 0),
    ('00000000-0000-7000-8000-000000000002', 'portal', 'flexible', '[]', '{"input":"b"}', 'b', 'accepted', 0,
     0, 200, 500, null, null, null, null, null, null, 0),
    ('00000000-0000-7000-8000-000000000003', 'portal', 'flexible', '[]', '{"input":"c"}', 'c', 'running', 1,
     20, 200, 900, 950, null, null, null, 9000, '00000000-0000-7000-8000-0000000000aa', 1);
insert into study_rows (study, position, label, changes, job, problem) values
    ('00000000-0000-7000-8000-0000000000aa', 0, 'runs', '{}', '00000000-0000-7000-8000-000000000003', null),
    ('00000000-0000-7000-8000-0000000000aa', 1, 'deleted', '{}', null, null),
    ('00000000-0000-7000-8000-0000000000aa', 2, 'impossible', '{}', null, '{"code":"undercut"}');
insert into idempotency_keys (client, key, body_hash, job, created_at) values
    ('portal', 'k', 'h', '00000000-0000-7000-8000-000000000002', 500);
"#;

#[tokio::test]
async fn jobs_results_studies_and_keys_survive_the_upgrade() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("jobs.db");
    let before = SqliteConnectOptions::new()
        .filename(&path)
        .create_if_missing(true);
    let mut connection = before.connect().await.unwrap();
    let mut migrator = migrations(Dialect::Sqlite);
    // As it was before the third one.
    migrator.migrations.to_mut().truncate(2);
    migrator
        .run_direct(None, &mut connection, false)
        .await
        .unwrap();
    sqlx::raw_sql(BEFORE)
        .execute(&mut connection)
        .await
        .unwrap();
    connection.close().await.unwrap();

    let store = Store::open(&DatabaseAddress::File(path.clone()))
        .await
        .unwrap();
    let jobs = store.list(CLIENT, &Filter::default(), 9).await.unwrap();
    let states: Vec<Status> = jobs.iter().map(|job| job.status).collect();
    assert_eq!(
        states,
        [Status::Successful, Status::Running, Status::Accepted],
        "by the time of their submission"
    );
    assert_eq!(jobs[0].elapsed.unwrap().as_micros(), 3000);
    assert_eq!(
        store
            .submission(jobs[2].id)
            .await
            .unwrap()
            .unwrap()
            .unwrap(),
        r#"{"input":"b"}"#
    );
    let hash = jobs[0].document.as_deref().unwrap();
    assert!(store.document(hash).await.unwrap().is_some());
    let tagged = Filter {
        tag: Some("x".to_owned()),
        ..Filter::default()
    };
    assert_eq!(store.list(CLIENT, &tagged, 9).await.unwrap().len(), 1);

    let study = "00000000-0000-7000-8000-0000000000aa".parse().unwrap();
    let study = store.find_study(CLIENT, study).await.unwrap().unwrap();
    assert_eq!(
        (study.running, study.dismissed, study.unbuildable),
        (1, 1, 1)
    );
    assert_eq!(study.status(), Status::Running);
    assert_eq!(
        store
            .study_text(study.id, 99)
            .await
            .unwrap()
            .unwrap()
            .unwrap(),
        r#"{"base":{}}"#
    );

    // Waiting jobs are claimed, running ones are recovered, and the study counts on.
    assert_eq!(claim(&store, 1).await.id, jobs[2].id);
    let recovered = store.recover(at(1), expired(1), 3, "{}").await.unwrap();
    assert_eq!(recovered, [jobs[1].id]);
    let held = claim(&store, 1).await;
    assert_eq!(held.id, jobs[1].id);
    assert!(store.ends(held, 2).await);
    let study = store.find_study(CLIENT, study.id).await.unwrap().unwrap();
    assert_eq!((study.running, study.successful, study.done()), (0, 1, 3));
    let rows: Vec<String> = sqlx::query_scalar("pragma integrity_check")
        .fetch_all(readers(&store))
        .await
        .unwrap();
    assert_eq!(rows, ["ok"]);
    // It can shrink from now on.
    let mode: i64 = sqlx::query_scalar("pragma auto_vacuum")
        .fetch_one(readers(&store))
        .await
        .unwrap();
    assert_eq!(mode, 2);
}
