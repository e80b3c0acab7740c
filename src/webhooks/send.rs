//! Sending a message: one request to an address that may be connected to, of whose answer the status alone is read.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::task::{Context, Poll};
use std::time::Duration;

use hyper::header::USER_AGENT;
use hyper::{Request, StatusCode, header::HeaderValue};
use hyper_rustls::{HttpsConnector, HttpsConnectorBuilder};
use hyper_util::client::legacy::Client;
use hyper_util::client::legacy::connect::HttpConnector;
use hyper_util::client::legacy::connect::dns::Name;
use hyper_util::rt::TokioExecutor;
use reqwest::Body;
use rustls::ClientConfig;
use rustls_platform_verifier::ConfigVerifierExt;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tower::Service;

use super::addresses::Reachable;
use crate::client::{AGENT, install_encryption, unreachable};

/// A receiver may send so many informational answers (1xx) before its answer.
const MOST_INFORMATIONAL: usize = 8;

/// The client that sends messages. It follows no redirect and uses no proxy.
pub(super) struct Sender {
    client: Client<HttpsConnector<HttpConnector<ReachableOnly>>, Body>,
    /// Time for one attempt.
    time: Duration,
}

impl Sender {
    /// A client that connects to these hosts at these addresses, and gives each attempt `time`.
    ///
    /// # Errors
    ///
    /// When there is no encryption to be had.
    pub(super) fn to(reachable: &Reachable, time: Duration) -> Result<Self, rustls::Error> {
        install_encryption();
        let mut tcp = HttpConnector::new_with_resolver(ReachableOnly(Arc::clone(reachable)));
        tcp.enforce_http(false);
        let connector = HttpsConnectorBuilder::new()
            .with_tls_config(ClientConfig::with_platform_verifier()?)
            .https_or_http()
            .enable_http1()
            .wrap_connector(tcp);
        Ok(Self {
            client: Client::builder(TokioExecutor::new()).build(connector),
            time,
        })
    }

    /// Sends a request.
    ///
    /// # Errors
    ///
    /// Why there is no answer.
    pub(super) async fn send(&self, mut request: Request<Body>) -> Result<StatusCode, String> {
        let (enough, count) = (CancellationToken::new(), AtomicUsize::new(0));
        let stop = enough.clone();
        hyper::ext::on_informational(&mut request, move |_| {
            if count.fetch_add(1, Ordering::Relaxed) >= MOST_INFORMATIONAL {
                stop.cancel();
            }
        });
        let agent = HeaderValue::from_static(AGENT);
        request.headers_mut().insert(USER_AGENT, agent);
        let answer = async {
            tokio::select! {
                () = enough.cancelled() => Err(format!("it sent more than {MOST_INFORMATIONAL} informational answers")),
                answer = self.client.request(request) => match answer {
                    Ok(answer) => Ok(answer.status()),
                    Err(error) => Err(unreachable(&error)),
                },
            }
        };
        let answer = timeout(self.time, answer).await;
        answer.unwrap_or_else(|_| Err(format!("no answer within {} s", self.time.as_secs_f64())))
    }
}

/// Looks names up, and keeps the addresses that may be connected to. The connection is made to one of these: nobody looks
/// the name up again.
#[derive(Clone)]
struct ReachableOnly(Reachable);

impl Service<Name> for ReachableOnly {
    type Response = std::vec::IntoIter<SocketAddr>;
    type Error = io::Error;
    type Future = Pin<Box<dyn Future<Output = io::Result<Self::Response>> + Send>>;

    fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }

    fn call(&mut self, name: Name) -> Self::Future {
        let reachable = Arc::clone(&self.0);
        Box::pin(async move {
            let found = tokio::net::lookup_host((name.as_str(), 0)).await?;
            let reached = found.filter(|address| reachable(name.as_str(), address.ip()));
            let reached: Vec<_> = reached.collect();
            if reached.is_empty() {
                let error = format!("{} has no address that may be sent to", name.as_str());
                return Err(io::Error::other(error));
            }
            Ok(reached.into_iter())
        })
    }
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    use tokio::net::TcpListener;

    use super::*;

    /// The outcome for a receiver that answers `first` once and `again` from then on.
    async fn outcome_of(first: &'static str, again: &'static str) -> Result<StatusCode, String> {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        tokio::spawn(async move {
            let (mut stream, _) = listener.accept().await.unwrap();
            let _ = stream.read(&mut [0; 1024]).await;
            let _ = stream.write_all(first.as_bytes()).await;
            while stream.write_all(again.as_bytes()).await.is_ok() {
                tokio::task::yield_now().await;
            }
        });
        let reachable: Reachable = Arc::new(|_, _| true);
        let sender = Sender::to(&reachable, Duration::from_secs(600)).unwrap();
        let request = Request::post(format!("http://{address}/hook"));
        sender.send(request.body(Body::from("{}")).unwrap()).await
    }

    #[tokio::test]
    async fn a_receiver_that_sends_informational_answers_for_ever_is_given_up_at_once() {
        const EARLY: &str = "HTTP/1.1 103 Early Hints\r\nLink: </a>\r\n\r\n";
        // The attempt itself may take ten minutes.
        let error = outcome_of("", EARLY).await.unwrap_err();
        assert!(error.contains("informational"), "{error}");
        let answer = "HTTP/1.1 103 Early Hints\r\n\r\nHTTP/1.1 204 No Content\r\n\r\n";
        assert_eq!(outcome_of(answer, "").await, Ok(StatusCode::NO_CONTENT));
    }
}
