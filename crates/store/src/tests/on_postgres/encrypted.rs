//! Data that cross the network to the server.

use super::*;
use crate::OpenError;
use crate::statement::Pool;

async fn open(address: &str, settings: &str) -> Result<Store, OpenError> {
    Store::open(&DatabaseAddress::Postgres(format!("{address}?{settings}"))).await
}

/// The server's view of all our connections.
async fn are_encrypted(store: &Store) -> bool {
    let Pool::Postgres(pool, _) = &store.readers else {
        panic!("a store on PostgreSQL");
    };
    sqlx::query_scalar(
        "select bool_and(ssl) from pg_stat_ssl natural join pg_stat_activity where application_name = 'meshwright'",
    )
    .fetch_one(pool)
    .await
    .unwrap()
}

#[tokio::test]
async fn connections_are_encrypted_where_the_server_can_and_its_certificate_is_looked_at_where_one_asks()
 {
    let (address, folder) =
        tokio::task::spawn_blocking(|| server::start_with(&[("PG_ENCRYPTED", "yes")]))
            .await
            .unwrap();
    let trusting = format!("sslmode=verify-full&sslrootcert={folder}/data/server.crt");
    for (settings, encrypted) in [(&*trusting, true), ("", true), ("sslmode=disable", false)] {
        let store = open(&address, settings).await.unwrap();
        assert_eq!(are_encrypted(&store).await, encrypted, "{settings}");
        store.close().await;
    }
    // Nobody vouches for this certificate, and it is for another name.
    let by_name = address.replace("127.0.0.1", "localhost");
    for (address, settings, why) in [
        (&address, "sslmode=verify-full", "UnknownIssuer"),
        (&by_name, &trusting, "not valid for name"),
    ] {
        let Err(OpenError::Connect(error)) = open(address, settings).await else {
            panic!("{settings} lets it through");
        };
        assert!(error.to_string().contains(why), "{settings}: {error}");
    }
}
