//! Whose turn it is: clients, studies and jobs alone, equal jobs, and jobs that may have brought a process down.

use super::*;
use crate::{NewRow, NewStudy, StudyOutcome};

fn of_client(client: &str, input: &str) -> NewJob {
    NewJob {
        client: client.to_owned(),
        ..new(1, input)
    }
}

/// A study of as many designs, and its id.
async fn study(store: &Store, client: &str, designs: u32) -> Uuid {
    let id = Uuid::now_v7();
    let inputs = (0..designs).map(|i| format!("{id} {i}")).collect();
    study_with(store, id, client, inputs).await
}

/// A study of designs with these inputs.
async fn study_of(store: &Store, inputs: &[&str]) -> Uuid {
    let inputs = inputs.iter().map(|&input| input.to_owned()).collect();
    study_with(store, Uuid::now_v7(), CLIENT, inputs).await
}

async fn study_with(store: &Store, id: Uuid, client: &str, inputs: Vec<String>) -> Uuid {
    study_by(store, id, client, None, inputs).await
}

/// The same, by a user of the client.
async fn study_by(
    store: &Store,
    id: Uuid,
    client: &str,
    user: Option<String>,
    inputs: Vec<String>,
) -> Uuid {
    let study = NewStudy {
        id,
        client: client.to_owned(),
        name: None,
        tags: Vec::new(),
        document: "{}".to_owned(),
        document_version: 1,
        body_hash: String::new(),
        gear: "driven".to_owned(),
        total: inputs.len() as u64,
        search: None,
        submitted_at: at(1),
        idempotency_key: None,
        client_limit: i64::MAX,
        submitted_by: user.clone(),
    };
    let row = |input: &String| NewRow {
        label: input.clone(),
        changes: "{}".to_owned(),
        job: Ok(NewJob {
            study: Some(id),
            submitted_by: user.clone(),
            ..of_client(client, input)
        }),
    };
    let rows: Vec<NewRow> = inputs.iter().map(row).collect();
    let outcome = store
        .begin_study(&study, &rows, bounds(1, 10))
        .await
        .unwrap();
    assert_eq!(outcome, StudyOutcome::Taken);
    id
}

/// Whose jobs are served, in this order, when one worker computes one after the other: client, and whether of a study.
async fn served(store: &Store, count: usize) -> Vec<(String, Option<Uuid>)> {
    let mut served = Vec::new();
    for i in 0..count {
        let job = next(store, 10).await.unwrap();
        let text = format!("{{\"number\":{i},\"id\":\"{}\"}}", job.id);
        let claim = of(&job);
        assert!(
            store
                .succeed(claim, end(11), &Packed::of(&text), None, VERSION)
                .await
                .unwrap()
        );
        served.push((job.client, job.study));
    }
    served
}

fn count<T: PartialEq>(items: &[T], of: &T) -> usize {
    items.iter().filter(|item| *item == of).count()
}

#[tokio::test]
async fn clients_take_turns_however_many_jobs_each_brings() {
    let (store, _folder) = store().await;
    for i in 0..40 {
        submit(&store, of_client("many", &format!("m{i}"))).await;
    }
    for i in 0..4 {
        submit(&store, of_client("few", &format!("f{i}"))).await;
    }
    let clients: Vec<String> = served(&store, 8)
        .await
        .into_iter()
        .map(|(client, _)| client)
        .collect();
    assert_eq!(
        (
            count(&clients, &"few".to_owned()),
            count(&clients, &"many".to_owned())
        ),
        (4, 4)
    );
}

fn of_user(client: &str, user: &str, input: &str) -> NewJob {
    NewJob {
        submitted_by: Some(user.to_owned()),
        ..of_client(client, input)
    }
}

/// Who submitted the jobs that are served, in this order.
async fn served_users(store: &Store, count: usize) -> Vec<Option<String>> {
    let mut users = Vec::new();
    for i in 0..count {
        let job = next(store, 10).await.unwrap();
        assert!(store.ends(of(&job), 11 + i as i64).await);
        users.push(job.submitted_by);
    }
    users
}

#[tokio::test]
async fn users_of_a_client_take_turns_and_have_no_more_of_the_service_than_their_client() {
    let (store, _folder) = store().await;
    for i in 0..12 {
        submit(&store, of_user("a", "many", &format!("m{i}"))).await;
    }
    served_users(&store, 2).await;
    for i in 0..3 {
        submit(&store, of_user("a", "few", &format!("f{i}"))).await;
    }
    // The one who comes later waits for no more than the running jobs.
    let few = Some("few".to_owned());
    let users = served_users(&store, 6).await;
    assert_eq!((count(&users, &few), &users[0]), (3, &few));
    // Another client has half of the service, however many users the first one names.
    for i in 0..4 {
        submit(&store, of_user("a", &format!("user {i}"), &format!("u{i}"))).await;
        submit(&store, of_client("b", &format!("b{i}"))).await;
    }
    let served = served(&store, 8).await;
    let of_b = served.iter().filter(|(client, _)| client == "b").count();
    assert_eq!(of_b, 4, "{served:?}");
}

#[tokio::test]
async fn who_names_no_user_takes_turns_with_those_who_do() {
    let (store, _folder) = store().await;
    for i in 0..4 {
        submit(&store, of_client("a", &format!("n{i}"))).await;
        submit(&store, of_user("a", "ada", &format!("a{i}"))).await;
        submit(&store, of_user("a", "bob", &format!("b{i}"))).await;
    }
    let users = served_users(&store, 6).await;
    for user in [None, Some("ada".to_owned()), Some("bob".to_owned())] {
        assert_eq!(count(&users, &user), 2, "{users:?}");
    }
    // Nothing is left over where the last of a client's jobs was served.
    served_users(&store, 6).await;
    assert_eq!(next(&store, 30).await, None);
    let left: i64 = query_scalar("select count(*) from shares where person <> ''")
        .fetch_one(&store.readers)
        .await
        .unwrap();
    assert_eq!(left, 0, "users that are idle are forgotten");
}

#[tokio::test]
async fn the_studies_of_a_user_have_no_more_than_the_study_of_another() {
    let (store, _folder) = store().await;
    let by = async |user: &str| {
        let id = Uuid::now_v7();
        let inputs = (0..30).map(|i| format!("{id} {i}")).collect();
        study_by(&store, id, CLIENT, Some(user.to_owned()), inputs).await
    };
    let mut many = Vec::new();
    for _ in 0..5 {
        many.push(by("many").await);
    }
    let one = by("one").await;
    let served = served(&store, 20).await;
    let of_one = served.iter().filter(|(_, id)| *id == Some(one)).count();
    assert_eq!(of_one, 10, "{served:?}");
    let least = many
        .iter()
        .map(|id| served.iter().filter(|(_, it)| it == &Some(*id)).count());
    assert_eq!(
        least.min(),
        Some(2),
        "the studies of one user advance together"
    );
}

#[tokio::test]
async fn a_user_has_its_part_of_the_queue_and_its_client_no_more_than_before() {
    let (store, _folder) = store().await;
    let bounded = async |user: &str, input: &str| {
        let job = NewJob {
            user_limit: 2,
            client_limit: 3,
            ..of_user("a", user, input)
        };
        submit(&store, job).await
    };
    for input in ["1", "2"] {
        assert!(matches!(bounded("ada", input).await, Outcome::Queued(_)));
    }
    let third = bounded("ada", "3").await;
    assert_eq!(third, Outcome::UserQueueFull { waiting: 2 });
    assert!(matches!(bounded("bob", "3").await, Outcome::Queued(_)));
    let fourth = bounded("bob", "4").await;
    assert_eq!(fourth, Outcome::ClientQueueFull { waiting: 3 });
}

#[tokio::test]
async fn lists_can_be_of_what_one_user_submitted() {
    let (store, _folder) = store().await;
    submit(&store, of_user(CLIENT, "ada", "1")).await;
    submit(&store, of_client(CLIENT, "2")).await;
    submit(&store, of_user("other", "ada", "3")).await;
    let filter = crate::Filter {
        submitted_by: Some("ada".to_owned()),
        ..crate::Filter::default()
    };
    let listed = store.list(CLIENT, &filter, 9).await.unwrap();
    let inputs: Vec<&str> = listed.iter().map(|job| job.tags[0].as_str()).collect();
    assert_eq!(inputs, ["1"]);
}

#[tokio::test]
async fn two_studies_of_two_clients_advance_together() {
    let (store, _folder) = store().await;
    let first = study(&store, "a", 50).await;
    let second = study(&store, "b", 50).await;
    let studies: Vec<_> = served(&store, 20)
        .await
        .into_iter()
        .map(|(_, study)| study.unwrap())
        .collect();
    assert_eq!(
        (count(&studies, &first), count(&studies, &second)),
        (10, 10)
    );
}

#[tokio::test]
async fn neither_a_study_nor_jobs_alone_starve_when_both_always_wait() {
    let (store, _folder) = store().await;
    let id = study(&store, CLIENT, 100).await;
    let mut order = Vec::new();
    for i in 0..40 {
        // Six submitters, who send another job as soon as one is taken.
        while store.depth().await.unwrap().alone < 6 {
            let n = order.len() * 10 + usize::try_from(store.depth().await.unwrap().alone).unwrap();
            submit(&store, of_client(CLIENT, &format!("alone {i} {n}"))).await;
        }
        order.extend(served(&store, 1).await);
    }
    let of_study = order.iter().filter(|(_, study)| *study == Some(id)).count();
    // Jobs alone have three times the part of a study: somebody waits for each.
    assert_eq!((of_study, order.len() - of_study), (10, 30));
}

#[tokio::test]
async fn a_client_that_sends_one_job_after_the_other_gets_no_more_than_its_share() {
    let (store, _folder) = store().await;
    for i in 0..20 {
        submit(&store, of_client("patient", &format!("p{i}"))).await;
    }
    let mut order = Vec::new();
    for i in 0..10 {
        // Never two at once, but always one.
        submit(&store, of_client("quick", &format!("q{i}"))).await;
        order.extend(
            served(&store, 2)
                .await
                .into_iter()
                .map(|(client, _)| client),
        );
    }
    assert_eq!(count(&order, &"patient".to_owned()), 10);
}

#[tokio::test]
async fn who_was_alone_for_long_does_not_pay_for_it_and_who_was_away_has_saved_nothing() {
    let (store, _folder) = store().await;
    for i in 0..30 {
        submit(&store, of_client("early", &format!("e{i}"))).await;
    }
    served(&store, 20).await;
    for i in 0..10 {
        submit(&store, of_client("late", &format!("l{i}"))).await;
    }
    let clients: Vec<String> = served(&store, 10)
        .await
        .into_iter()
        .map(|(client, _)| client)
        .collect();
    assert_eq!(count(&clients, &"early".to_owned()), 5);
}

#[tokio::test]
async fn long_jobs_are_charged_with_their_length() {
    let (store, _folder) = store().await;
    for i in 0..20 {
        submit(
            &store,
            NewJob {
                cost: 9000,
                ..of_client("long", &format!("l{i}"))
            },
        )
        .await;
        submit(&store, of_client("short", &format!("s{i}"))).await;
    }
    let clients: Vec<String> = served(&store, 20)
        .await
        .into_iter()
        .map(|(client, _)| client)
        .collect();
    let long = count(&clients, &"long".to_owned());
    assert!((2..=3).contains(&long), "one for nine short ones: {long}");
}

#[tokio::test]
async fn equal_jobs_are_computed_once_and_block_nobody() {
    let (store, _folder) = store().await;
    queued(&store, 1, "same").await;
    queued(&store, 2, "same").await;
    let other = queued(&store, 3, "other").await;
    let first = claim(&store, 4).await;
    assert_eq!(
        next(&store, 5).await.unwrap().id,
        other.id,
        "the equal one is passed over"
    );
    assert!(store.ends(first, 6).await);
    let claimed = store.claim(at(7), lease(7), READER).await.unwrap();
    assert!(claimed.started.is_empty());
    assert_eq!(
        (claimed.given.len(), claimed.given[0].same_as),
        (1, Some(first.id))
    );
}

#[tokio::test]
async fn a_job_whose_document_is_not_read_is_left_to_who_reads_it() {
    let (store, _folder) = store().await;
    let later = NewJob {
        document_version: 2,
        ..new(1, "later")
    };
    let later_id = later.id;
    submit(&store, later).await;
    let earlier = queued(&store, 2, "earlier").await;
    assert_eq!(claim(&store, 3).await.id, earlier.id);
    assert_eq!(next(&store, 3).await, None);
    // Nor when it has taken a process with it.
    let reads_both = Reader {
        documents: 2,
        ..READER
    };
    let claimed = store.claim(at(4), lease(4), reads_both).await.unwrap();
    assert_eq!(claimed.started[0].job.id, later_id);
    store.recover(at(5), Lost::Process, 3, "{}").await.unwrap();
    assert_eq!(claim(&store, 6).await.id, earlier.id);
    assert_eq!(next(&store, 6).await, None);
}

#[tokio::test]
async fn small_jobs_of_one_lane_are_claimed_together_and_charged_together() {
    let (store, _folder) = store().await;
    let first = study(&store, "a", 8).await;
    let second = study(&store, "b", 8).await;
    // Each costs 1000.
    let several = Reader {
        at_once: 3500,
        ..READER
    };
    let mut lanes = Vec::new();
    for _ in 0..4 {
        let claimed = store.claim(at(4), lease(4), several).await.unwrap();
        let studies: Vec<_> = claimed.started.iter().map(|it| it.job.study).collect();
        assert_eq!(studies, [studies[0]; 3], "as many as cost no more together");
        lanes.push(studies[0].unwrap());
    }
    assert_eq!((count(&lanes, &first), count(&lanes, &second)), (2, 2));
    assert_ne!(lanes[0], lanes[1], "each pays for all that it was given");
    let rest = store.claim(at(5), lease(5), several).await.unwrap();
    assert_eq!(rest.started.len(), 2);
}

#[tokio::test]
async fn what_is_written_together_stands_or_falls_each_by_its_own_claim() {
    let (store, _folder) = store().await;
    let inputs = ["a", "b", "c", "d", "e"];
    let id = study_of(&store, &inputs).await;
    let several = Reader {
        at_once: 9000,
        ..READER
    };
    let claimed = store.claim(at(2), lease(2), several).await.unwrap();
    let mut claims: Vec<Claim> = claimed.started.iter().map(|it| of(&it.job)).collect();
    assert_eq!(claims.len(), 5);
    // One is cancelled; one has lost its lease and is run again; one could not be computed.
    let cancelled = store
        .cancel(CLIENT, claims[1].id, By::Owner, at(3))
        .await
        .unwrap();
    assert!(cancelled.is_some());
    assert!(store.release(claims[2]).await.unwrap());
    let again = claim(&store, 3).await;
    assert_eq!(again.id, claims[2].id);
    let documents = inputs.map(Packed::of);
    let mut ends: Vec<Ended<'_>> = claims
        .iter()
        .zip(&documents)
        .map(|(claim, document)| Ended {
            claim: *claim,
            end: end(4),
            came: Came::Results {
                document,
                summary: Some("{}"),
            },
        })
        .collect();
    ends[3].came = Came::Problem(r#"{"code":"time_limit"}"#);
    let ended = store.end_all(&ends, VERSION).await.unwrap();
    let ended: Vec<_> = ended.iter().map(Option::is_some).collect();
    assert_eq!(ended, [true, false, false, true, true]);
    let study = store.find_study(CLIENT, id).await.unwrap().unwrap();
    assert_eq!(
        (
            study.running,
            study.successful,
            study.failed,
            study.dismissed
        ),
        (1, 2, 1, 1)
    );
    for (i, kept) in [true, false, false, false, true].into_iter().enumerate() {
        let document = store.document(documents[i].hash()).await.unwrap();
        assert_eq!(document.is_some(), kept, "{}", inputs[i]);
    }
    let failed = find(&store, claims[3].id).await;
    assert_eq!(failed.problem.unwrap()["code"], "time_limit");
    assert_eq!((failed.document, failed.solver_version), (None, None));

    // Said twice it changes nothing; the last one has its own end, and the study with it.
    let ended = store.end_all(&ends, VERSION).await.unwrap();
    assert_eq!(ended, [const { None }; 5]);
    assert!(store.document(documents[0].hash()).await.unwrap().is_some());
    claims[2] = again;
    assert_eq!(
        store.hold(&claims).await.unwrap(),
        [false, false, true, false, false]
    );
    let last = store.succeed(again, end(5), &documents[2], None, VERSION);
    assert!(last.await.unwrap());
    let study = store.find_study(CLIENT, id).await.unwrap().unwrap();
    assert_eq!((study.running, study.successful), (0, 3));
    assert_eq!(study.finished_at(), Some(at(5)));
}

#[tokio::test]
async fn of_equal_designs_and_computed_ones_in_one_lane_only_new_work_is_begun() {
    let (store, _folder) = store().await;
    // Two that look at a known input must not be answered at their submission, but at their claim.
    let known = queued(&store, 1, "known").await;
    let held = claim(&store, 1).await;
    let id = study_of(&store, &["new", "known", "new", "other", "known", "last"]).await;
    assert!(store.ends(held, 2).await);
    let several = Reader {
        at_once: 2500,
        ..READER
    };
    let claimed = store.claim(at(3), lease(3), several).await.unwrap();
    let started: Vec<&str> = claimed
        .started
        .iter()
        .map(|it| it.job.tags[0].as_str())
        .collect();
    assert_eq!(started, ["new", "other"], "in their order, equal ones once");
    let given: Vec<_> = claimed.given.iter().map(|job| job.same_as).collect();
    assert_eq!(given, [Some(known.id); 2]);
    let next = store.claim(at(4), lease(4), several).await.unwrap();
    let started: Vec<&str> = next
        .started
        .iter()
        .map(|it| it.job.tags[0].as_str())
        .collect();
    assert_eq!(started, ["last"], "the equal one waits");
    let study = store.find_study(CLIENT, id).await.unwrap().unwrap();
    assert_eq!((study.accepted, study.running, study.successful), (1, 3, 2));
    for it in claimed.started.iter().chain(&next.started) {
        let text = Packed::of(&it.job.tags[0]);
        let ended = store.succeed(of(&it.job), end(5), &text, None, VERSION);
        assert!(ended.await.unwrap());
    }
    let last = store.claim(at(6), lease(6), several).await.unwrap();
    assert_eq!((last.started.len(), last.given.len()), (0, 1));
    assert_eq!(last.given[0].same_as, Some(claimed.started[0].job.id));
}

#[tokio::test]
async fn what_costs_much_is_claimed_by_itself_also_behind_small_jobs() {
    let (store, _folder) = store().await;
    for (input, cost) in [("a", 100), ("b", 100), ("long", 90_000), ("c", 100)] {
        let job = NewJob {
            cost,
            ..new(1, input)
        };
        submit(&store, job).await;
    }
    let several = Reader {
        at_once: 20_000,
        ..READER
    };
    let mut turns = Vec::new();
    for _ in 0..3 {
        let claimed = store.claim(at(2), lease(2), several).await.unwrap();
        let tags = claimed.started.iter().map(|it| it.job.tags[0].clone());
        turns.push(tags.collect::<Vec<_>>().join(" "));
    }
    assert_eq!(turns, ["a b", "long", "c"]);
}

#[tokio::test]
async fn what_is_given_at_once_is_of_one_study() {
    // Jobs of a study lock it; two claims that gave in two studies each, in another order, would wait for each other.
    let (store, _folder) = store().await;
    for input in ["b", "c"] {
        queued(&store, 1, input).await;
    }
    let held = [claim(&store, 2).await, claim(&store, 2).await];
    let studies = [
        study_of(&store, &["b"]).await,
        study_of(&store, &["c"]).await,
    ];
    assert_eq!(next(&store, 3).await, None, "their equals run");
    for (i, held) in held.into_iter().enumerate() {
        let document = Packed::of(&i.to_string());
        let ended = store.succeed(held, end(3), &document, None, VERSION);
        assert!(ended.await.unwrap());
    }
    let mut given = Vec::new();
    for _ in studies {
        let claimed = store.claim(at(4), lease(4), READER).await.unwrap();
        assert_eq!((claimed.started.len(), claimed.given.len()), (0, 1));
        given.push(claimed.given[0].study.unwrap());
    }
    assert_ne!(given[0], given[1]);
    assert!(given.iter().all(|study| studies.contains(study)));
}

#[tokio::test]
async fn a_job_that_kills_its_process_is_found_and_those_beside_it_lose_no_attempt() {
    let (store, _folder) = store().await;
    let poison = queued(&store, 1, "poison").await;
    let innocent = queued(&store, 2, "innocent").await;
    let waiting = queued(&store, 3, "waiting").await;
    assert_eq!(claim(&store, 4).await.id, poison.id);
    assert_eq!(claim(&store, 4).await.id, innocent.id);
    let die = async || {
        store
            .recover(at(5), Lost::Process, 3, r#"{"code":"lost"}"#)
            .await
            .unwrap()
    };

    assert_eq!(die().await.len(), 2, "nobody knows which of the two it was");
    for death in 1..=3 {
        assert_eq!(claim(&store, 6).await.id, poison.id, "alone: death {death}");
        assert_eq!(next(&store, 6).await, None, "nothing begins beside it");
        assert_eq!(die().await, [poison.id]);
    }
    let poison = find(&store, poison.id).await;
    assert_eq!(
        (poison.status, poison.attempt),
        (Status::Failed, 4),
        "once with others, three times alone"
    );

    let held = claim(&store, 7).await;
    assert_eq!(held.id, innocent.id, "it is run alone, too");
    assert_eq!(find(&store, innocent.id).await.attempts_counted, 1);
    assert_eq!(next(&store, 7).await, None);
    assert!(store.ends(held, 8).await);
    assert_eq!(next(&store, 9).await.unwrap().id, waiting.id);
    assert_eq!(find(&store, waiting.id).await.attempts_counted, 1);
}

#[tokio::test]
async fn what_runs_comes_to_its_end_before_a_job_is_run_alone() {
    let (store, _folder) = store().await;
    queued(&store, 1, "a").await;
    queued(&store, 2, "b").await;
    claim(&store, 3).await;
    claim(&store, 3).await;
    store.recover(at(4), Lost::Process, 3, "{}").await.unwrap();
    let first = claim(&store, 5).await;
    assert_eq!(next(&store, 5).await, None);
    assert!(
        store.release(first).await.unwrap(),
        "a shutdown is no death"
    );
    let again = claim(&store, 6).await;
    assert_eq!(again.id, first.id);
    assert_eq!(find(&store, again.id).await.attempts_counted, 1);
}

#[tokio::test]
async fn a_process_that_ended_in_order_charges_nobody() {
    let (store, _folder) = store().await;
    let job = queued(&store, 1, "a").await;
    for _ in 0..5 {
        claim(&store, 2).await;
        store.recover(at(3), Lost::InOrder, 3, "{}").await.unwrap();
    }
    let job = find(&store, job.id).await;
    assert_eq!((job.status, job.attempts_counted), (Status::Accepted, 0));
}

#[tokio::test]
async fn a_full_lane_of_one_client_leaves_room_for_the_others() {
    let (store, _folder) = store().await;
    let limited = |client: &str, input: &str| NewJob {
        client_limit: 2,
        ..of_client(client, input)
    };
    assert!(matches!(
        submit(&store, limited("a", "1")).await,
        Outcome::Queued(_)
    ));
    assert!(matches!(
        submit(&store, limited("a", "2")).await,
        Outcome::Queued(_)
    ));
    let third = submit(&store, limited("a", "3")).await;
    assert_eq!(third, Outcome::ClientQueueFull { waiting: 2 });
    assert!(matches!(
        submit(&store, limited("b", "1")).await,
        Outcome::Queued(_)
    ));
}

#[tokio::test]
async fn a_study_that_is_cancelled_ends_with_the_last_of_its_jobs() {
    let (store, _folder) = store().await;
    let id = study(&store, CLIENT, 1200).await;
    let running = claim(&store, 2).await;
    assert!(
        store
            .cancel_study(CLIENT, id, By::Owner, at(3))
            .await
            .unwrap()
    );
    assert_eq!(next(&store, 3).await, None, "no further one is begun");
    // A job that ends meanwhile keeps its results, and does not end the study; another process finds it.
    assert!(store.ends(running, 4).await);
    assert_eq!(store.unfinished_cancellations().await.unwrap(), [id]);
    let mut dismissed = Vec::new();
    loop {
        let (jobs, more) = store.dismiss_designs(id, at(5)).await.unwrap();
        assert!(jobs.len() <= 500, "one commit does not grow with the study");
        dismissed.extend(jobs);
        if !more {
            break;
        }
    }
    assert_eq!(dismissed.len(), 1199);
    let left = store.unfinished_cancellations().await.unwrap();
    assert!(left.is_empty());
    let study = store.find_study(CLIENT, id).await.unwrap().unwrap();
    assert_eq!(
        (study.successful, study.dismissed, study.accepted),
        (1, 1199, 0)
    );
    assert_eq!(study.finished_at(), Some(at(3)));
    assert!(
        !store
            .cancel_study(CLIENT, id, By::Owner, at(6))
            .await
            .unwrap()
    );
}
