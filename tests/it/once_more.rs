//! All suites once more, on PostgreSQL: this program runs itself, told to use the other store.

use std::process::Command;

use crate::stores;

/// What is not run once more, and why the other store has no need of it.
const NOT_AGAIN: [(&str, &str); 4] = [
    ("disk::", "a server looks after its own disk"),
    ("fleet::", "it runs there anyway"),
    (
        "recovery::a_database_is_served_by_one_process_only",
        "that is what a server is for",
    ),
    (
        "recovery::links_of_both_kinds",
        "there is no file to link to",
    ),
];

#[test]
fn every_suite_holds_on_postgres() {
    if stores::on_postgres() {
        return;
    }
    let _alone = stores::ALONE.blocking_lock();
    let mut tests = Command::new(std::env::current_exe().unwrap());
    tests.env(stores::STORE, "postgres");
    // One at a time: the suites of SQLite go on beside it.
    tests.args(["--test-threads", "1", "--skip", "once_more::"]);
    for (name, why) in NOT_AGAIN {
        println!("not once more on PostgreSQL: {name}, because {why}");
        tests.args(["--skip", name]);
    }
    assert!(tests.status().unwrap().success());
}
