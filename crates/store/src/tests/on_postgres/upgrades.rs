//! Tables that another version has changed meanwhile.

use super::*;
use crate::{Filter, Migrate, OpenError, StudyFilter};

async fn say(store: &Store, words: &'static str) {
    let Pool::Postgres(pool, _) = &store.writer else {
        panic!("this is about servers")
    };
    sqlx::raw_sql(words).execute(pool).await.unwrap();
}

/// Has every connection prepare the statements that read and end jobs.
async fn warm(store: &Store) {
    for i in 0..20 {
        let job = ended(store, 1, &format!("warm {i}")).await;
        store.list(CLIENT, &Filter::default(), 9).await.unwrap();
        store
            .list_studies(CLIENT, &StudyFilter::default(), 9)
            .await
            .unwrap();
        store
            .cancel(CLIENT, job.id, By::Owner, at(4))
            .await
            .unwrap();
    }
}

#[tokio::test]
async fn columns_that_a_later_version_adds_disturb_nobody() {
    let (store, _place) = store().await;
    warm(&store).await;
    let waits = queued(&store, 1, "waits").await;
    let runs = queued(&store, 1, "runs").await;
    assert_eq!(claim(&store, 2).await.id, waits.id);
    let held = claim(&store, 2).await;
    say(
        &store,
        "alter table jobs add column x bigint; alter table studies add column x bigint; alter table keys add column x bigint;
         alter table webhooks add column x bigint; alter table messages add column x bigint; alter table shares add column x bigint;
         alter table documents add column x bigint",
    )
    .await;
    for i in 0..20 {
        assert_eq!(find(&store, waits.id).await.status, Status::Running);
        ended(&store, 3, &format!("after {i}")).await;
    }
    let jobs = store.list(CLIENT, &Filter::default(), 99).await.unwrap();
    assert_eq!(jobs.len(), 42);
    assert!(store.list_keys().await.unwrap().is_empty());
    let document = Packed::of("{}");
    assert!(
        store
            .succeed(held, end(3), &document, None, VERSION)
            .await
            .unwrap()
    );
    assert_eq!(find(&store, runs.id).await.status, Status::Successful);
}

#[tokio::test]
async fn a_column_of_another_kind_costs_new_connections_and_nothing_else() {
    let (store, _place) = store().await;
    warm(&store).await;
    let job = queued(&store, 1, "a").await;
    let held = claim(&store, 2).await;
    say(
        &store,
        "alter table jobs alter column method type varchar(300)",
    )
    .await;
    // Reads do not even show it.
    assert_eq!(find(&store, job.id).await.status, Status::Running);
    say(
        &store,
        "alter table jobs alter column method type varchar(400)",
    )
    .await;
    // A transaction is lost, and whoever has results tries it again.
    let document = Packed::of("{}");
    let mut lost = 0;
    while let Err(error) = store
        .succeed(held, end(3), &document, None, VERSION)
        .await
        .map(|held| assert!(held))
    {
        assert!(error.may_pass(), "{error:?}");
        lost += 1;
        assert!(lost <= 1, "the next connection is a new one");
    }
    assert_eq!(find(&store, job.id).await.status, Status::Successful);
}

#[tokio::test]
async fn a_later_version_that_this_one_can_work_beside_does_not_shut_it_out() {
    let (store, place) = store().await;
    query(
        "insert into _sqlx_migrations (version, description, success, checksum, execution_time)
         values (29990101000000, 'later', true, decode('00', 'hex'), 0)",
    )
    .execute(&store.writer)
    .await
    .unwrap();
    let beside = Store::open(&place).await.unwrap();
    queued(&beside, 1, "a").await;
    query("update compatibility set least_migration = 29990101000000")
        .execute(&store.writer)
        .await
        .unwrap();
    let refused = Store::open(&place).await.unwrap_err();
    assert!(
        matches!(refused, OpenError::Newer(29_990_101_000_000)),
        "{refused:?}"
    );
}

#[tokio::test]
async fn who_serves_needs_no_right_to_change_tables() {
    let address = server::database().await;
    let place = DatabaseAddress::Postgres(address.clone());
    let role = format!("serving_{}", std::process::id());
    let mut owner = server::connect(&address).await;
    let words = format!(
        "do $$ begin if not exists (select from pg_roles where rolname = '{role}') then create role {role} login; end if; end $$"
    );
    sqlx::raw_sql(sqlx::AssertSqlSafe(words))
        .execute(&mut owner)
        .await
        .unwrap();
    let serving =
        DatabaseAddress::Postgres(address.replacen("meshwright@", &format!("{role}@"), 1));
    let refused = Store::open_as(&serving, Migrate::Never).await.unwrap_err();
    assert!(matches!(refused, OpenError::Older), "{refused:?}");

    // As `meshwright migrate` does it, and as docs/operations.md says.
    Store::open(&place).await.unwrap();
    let words = format!(
        "grant select, insert, update, delete on all tables in schema public to {role};
         grant usage on all sequences in schema public to {role}"
    );
    sqlx::raw_sql(sqlx::AssertSqlSafe(words))
        .execute(&mut owner)
        .await
        .unwrap();
    let store = Store::open_as(&serving, Migrate::Never).await.unwrap();
    ended(&store, 1, "a").await;
    let created = query("create table x (y bigint)").execute(&store.writer);
    assert!(created.await.is_err(), "it may not");
}
