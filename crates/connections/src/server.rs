//! The server: it accepts connections, serves them, and ends them.
//!
//! A connection is busy from the head of a request to the last byte of its answer, and idle otherwise; one whose client sends
//! nothing of its request, or reads nothing of its answer, counts as idle. An idle connection costs little, but holds one of the
//! descriptors that the process may have. It is evicted where a new one finds no place, and ends by itself when its client sends no
//! request, or reads nothing, for a while.

use std::convert::Infallible;
use std::future::poll_fn;
use std::net::SocketAddr;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use bytes::Bytes;
use http_body::{Body, Frame, SizeHint};
use hyper::body::Incoming;
use hyper::header::{CONNECTION, EXPECT, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Request, Response};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;
use tokio::time::{Instant, sleep, timeout};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower::{BoxError, Service, ServiceExt};
use tracing::{debug, warn};

use super::active_request::ActiveRequest;
use super::connection::Connection;
use super::limit::{Admitted, Connections};
use super::stalled_reads::WatchedBody;
use super::stalled_writes::WatchedStream;
use super::tasks::spawn;

/// A head is no larger than this, in bytes.
const LARGEST_HEAD: usize = 32 << 10;

/// A head has no more fields than this.
const MOST_FIELDS: usize = 64;

/// Time that an idle connection gets at a shutdown for a request that may be on its way.
const LAST_BREATH: Duration = Duration::from_millis(300);

/// How connections are bounded.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Maximum number at the same time.
    pub connections: usize,
    /// The head of a request is here so long after the connection began or the last answer ended.
    pub head: Duration,
    /// A client that reads nothing of its answer for so long, or a trickle of it for long, is given up.
    pub stall: Duration,
}

/// The body of an answer.
pub trait AnswerBody: Body<Data = Bytes, Error: Into<BoxError>> + Send + Unpin + 'static {}

impl<B: Body<Data = Bytes, Error: Into<BoxError>> + Send + Unpin + 'static> AnswerBody for B {}

/// A handler of every request, such as a router.
pub trait Answer<B>:
    Service<Request<WatchedBody>, Response = Response<B>, Error = Infallible, Future: Send>
    + Clone
    + Send
    + 'static
{
}

impl<B, S> Answer<B> for S where
    S: Service<Request<WatchedBody>, Response = Response<B>, Error = Infallible, Future: Send>
        + Clone
        + Send
        + 'static
{
}

/// A listener that is served.
pub struct Server {
    task: JoinHandle<()>,
    connections: TaskTracker,
    kill: CancellationToken,
}

impl Server {
    /// Answers the requests of all connections to `listener` by `service`, until `stop` comes. A request has its [`Connection`] and its
    /// [`ActiveRequest`] as extensions, each in an `Arc`.
    pub fn start<S, B>(
        listener: TcpListener,
        service: S,
        bounds: Bounds,
        stop: CancellationToken,
    ) -> Self
    where
        S: Answer<B>,
        B: AnswerBody,
    {
        let connections = TaskTracker::new();
        let kill = CancellationToken::new();
        let accepting = Accepting {
            service,
            bounds,
            limit: Connections::new(bounds.connections),
            connections: connections.clone(),
            stop,
            kill: kill.clone(),
        };
        Self {
            task: spawn(accepting.receive::<B>(listener)),
            connections,
            kill,
        }
    }

    /// Comes back when every connection has ended, after the stop: idle ones at once, busy ones with their answer, none
    /// later than `grace`. False if some had to be cut off.
    pub async fn ended(self, grace: Duration) -> bool {
        let all = async {
            // The task neither panics nor is aborted.
            let _ = self.task.await;
            self.connections.close();
            self.connections.wait().await;
        };
        let in_time = timeout(grace, all).await.is_ok();
        self.kill.cancel();
        in_time
    }

    /// Cuts every connection off.
    pub fn kill(self) {
        self.task.abort();
        self.kill.cancel();
    }
}

/// Acceptor of connections.
struct Accepting<S> {
    service: S,
    bounds: Bounds,
    limit: Arc<Connections>,
    connections: TaskTracker,
    stop: CancellationToken,
    kill: CancellationToken,
}

impl<S> Accepting<S> {
    async fn receive<B: AnswerBody>(self, listener: TcpListener)
    where
        S: Answer<B>,
    {
        loop {
            let accepted = tokio::select! {
                accepted = next(&self.limit, &listener) => accepted,
                () = self.stop.cancelled() => return,
                () = self.kill.cancelled() => return,
            };
            let (stream, admitted) = accepted;
            // An answer is written whole; to wait for more of it would only make the client wait.
            let _ = stream.set_nodelay(true);
            let (service, bounds, stop) = (self.service.clone(), self.bounds, self.stop.clone());
            let kill = self.kill.clone();
            let tracked = self.connections.track_future(async move {
                let serve = serve_connection::<_, S, B>(
                    stream,
                    service,
                    bounds,
                    (&admitted.connection, &admitted.limit),
                    &stop,
                );
                tokio::select! {
                    () = serve => {}
                    () = kill.cancelled() => {}
                }
            });
            spawn(tracked);
        }
    }
}

/// The next connection to `listener`, once there is a place for it.
async fn next(limit: &Arc<Connections>, listener: &TcpListener) -> (TcpStream, Admitted) {
    let (stream, address) = accept(limit, listener).await;
    let admitted = limit.admit(address.ip().into()).await;
    (stream, admitted)
}

async fn accept(limit: &Connections, listener: &TcpListener) -> (TcpStream, SocketAddr) {
    /// While the system gives no connections it is asked so often.
    const PAUSE: Duration = Duration::from_millis(50);
    loop {
        match listener.accept().await {
            Ok(accepted) => return accepted,
            Err(error) => {
                // Out of descriptors, most likely: idle connections have some.
                warn!(%error, "no connection can be taken");
                limit.evict_one();
                sleep(PAUSE).await;
            }
        }
    }
}

/// A body whose request is active until all of it was handed over to be written.
struct ActiveBody<B> {
    inner: B,
    _active: Arc<ActiveRequest>,
}

impl<B: AnswerBody> Body for ActiveBody<B> {
    type Data = Bytes;
    type Error = B::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, B::Error>>> {
        Pin::new(&mut self.inner).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

async fn serve_connection<T, S, B>(
    stream: T,
    service: S,
    bounds: Bounds,
    (connection, limit): (&Arc<Connection>, &Arc<Connections>),
    stop: &CancellationToken,
) where
    T: AsyncRead + AsyncWrite + Unpin,
    S: Answer<B>,
    B: AnswerBody,
{
    let stream = WatchedStream::new(stream, Arc::clone(&connection.writes), bounds.stall);
    let answer = service_fn(move |mut request: Request<Incoming>| {
        let (service, connection) = (service.clone(), Arc::clone(connection));
        let active = Arc::new(ActiveRequest::begin(&connection, limit));
        async move {
            connection.writes.flushed().await;
            let reads = Arc::clone(&connection.reads);
            request.extensions_mut().insert(connection);
            request.extensions_mut().insert(Arc::clone(&active));
            // To read the body of a client that waits with it would ask for it.
            let waits = request.headers().contains_key(EXPECT);
            let request = request.map(|body| WatchedBody::new(body, Arc::clone(&reads)));
            let rest = request.body().rest();
            let Ok(mut response) = service.oneshot(request).await;
            if !rest.discard(reads, waits).await {
                let close = HeaderValue::from_static("close");
                response.headers_mut().insert(CONNECTION, close);
            }
            Ok::<_, Infallible>(response.map(|inner| ActiveBody {
                inner,
                _active: active,
            }))
        }
    });
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(bounds.head)
        .max_buf_size(LARGEST_HEAD)
        .max_headers(MOST_FIELDS)
        // Every answer of ours has its own, by the clock of the service.
        .auto_date_header(false)
        .serve_connection(TokioIo::new(stream), answer);
    let mut served = pin!(served);
    let ended = tokio::select! {
        ended = &mut served => ended,
        () = stop.cancelled() => end(served, connection, LAST_BREATH).await,
        () = connection.evict.cancelled() => end(served, connection, Duration::ZERO).await,
    };
    if let Err(error) = ended {
        debug!(%error, "a connection broke");
    }
}

/// Ends a connection: with the answer that is under way, or when it has been idle for `patience`. One that has sent half a
/// head counts as idle, and so does one that sends no body, or reads nothing of its answer.
async fn end<I, S, B>(
    mut served: Pin<&mut http1::Connection<I, S>>,
    connection: &Connection,
    patience: Duration,
) -> hyper::Result<()>
where
    I: hyper::rt::Read + hyper::rt::Write + Unpin,
    S: hyper::service::HttpService<Incoming, ResBody = ActiveBody<B>>,
    S::Error: Into<BoxError>,
    B: AnswerBody,
{
    served.as_mut().graceful_shutdown();
    let mut idle_since = Instant::now();
    loop {
        let wait = sleep(LAST_BREATH / 4);
        tokio::select! {
            // A request that has arrived by now is answered.
            biased;
            ended = poll_fn(|context| served.as_mut().poll(context)) => return ended,
            () = std::future::ready(()), if patience.is_zero() && connection.is_idle(Instant::now()) => return Ok(()),
            () = wait => {}
        }
        if !connection.is_idle(Instant::now()) {
            idle_since = Instant::now();
        } else if idle_since.elapsed() >= patience {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::future::ready;
    use std::net::IpAddr;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex};
    use tokio::task::yield_now;

    use super::*;

    const PATIENCE: Duration = Duration::from_secs(60);

    /// A connection that is served until `stop`, its client's end, and the number of answers. The network holds `room` bytes.
    fn connect(
        room: usize,
        answer: usize,
        stall: Duration,
        stop: &CancellationToken,
    ) -> (JoinHandle<()>, DuplexStream, Arc<AtomicUsize>) {
        let made = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&made);
        let service = tower::service_fn(move |_| {
            count.fetch_add(1, Ordering::Relaxed);
            ready(Ok(Response::new("a".repeat(answer))))
        });
        let bounds = Bounds {
            connections: 1,
            head: PATIENCE,
            stall,
        };
        let (ours, theirs) = duplex(room);
        let stop = stop.clone();
        let serve = async move {
            let address = IpAddr::from([127, 0, 0, 1]).into();
            let (connection, limit) = (Arc::new(Connection::new(address)), Connections::new(1));
            serve_connection(ours, service, bounds, (&connection, &limit), &stop).await;
        };
        (tokio::spawn(serve), theirs, made)
    }

    const REQUEST: &str = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";

    #[tokio::test]
    async fn of_many_pipelined_requests_one_answer_is_in_memory_at_a_time() {
        // The answers are larger than the buffer of the network, and much smaller than the buffer of an answer.
        let (_, mut client, made) = connect(1 << 10, 2 << 10, PATIENCE, &CancellationToken::new());
        let requests = REQUEST.repeat(20);
        client.write_all(requests.as_bytes()).await.unwrap();
        // There is one thread, and nothing waits for anything but the client.
        for _ in 0..1000 {
            yield_now().await;
        }
        assert_eq!(made.load(Ordering::Relaxed), 1);
        // Who takes them gets them all.
        let mut taken = Vec::new();
        while taken.windows(5).filter(|at| at == b"HTTP/").count() < 20 {
            assert!(client.read_buf(&mut taken).await.unwrap() > 0);
        }
        assert_eq!(made.load(Ordering::Relaxed), 20);
    }

    #[tokio::test]
    async fn a_request_is_answered_on_the_connection_of_one_whose_body_was_not_read() {
        let (_, mut client, made) = connect(4 << 10, 1, PATIENCE, &CancellationToken::new());
        let head = "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 6\r\n\r\n";
        client.write_all(head.as_bytes()).await.unwrap();
        while made.load(Ordering::Relaxed) == 0 {
            yield_now().await;
        }
        let rest = format!("abcdef{REQUEST}");
        client.write_all(rest.as_bytes()).await.unwrap();
        let mut taken = Vec::new();
        while taken.windows(5).filter(|at| at == b"HTTP/").count() < 2 {
            assert!(client.read_buf(&mut taken).await.unwrap() > 0);
        }
        assert!(!String::from_utf8_lossy(&taken).contains("connection: close"));
    }

    #[tokio::test]
    async fn an_answer_says_that_its_connection_ends_where_a_body_is_not_read() {
        for left in [
            "Content-Length: 1048577",
            "Content-Length: 6\r\nExpect: 100-continue",
        ] {
            let (served, mut client, _) = connect(4 << 10, 1, PATIENCE, &CancellationToken::new());
            let head = format!("POST / HTTP/1.1\r\nHost: localhost\r\n{left}\r\n\r\n");
            client.write_all(head.as_bytes()).await.unwrap();
            let mut taken = String::new();
            client.read_to_string(&mut taken).await.unwrap();
            assert!(taken.starts_with("HTTP/1.1 200 OK\r\n"), "{taken}");
            assert!(taken.contains("\r\nconnection: close\r\n"), "{taken}");
            timeout(PATIENCE, served).await.unwrap().unwrap();
        }
    }

    #[tokio::test]
    async fn a_client_that_reads_nothing_is_given_up_whatever_is_buffered() {
        for answer in [1 << 10, 30 << 10, 1 << 20] {
            let (served, mut client, _) = connect(
                512,
                answer,
                Duration::from_millis(20),
                &CancellationToken::new(),
            );
            client.write_all(REQUEST.as_bytes()).await.unwrap();
            timeout(PATIENCE, served).await.unwrap().unwrap();
        }
    }

    #[tokio::test]
    async fn a_client_that_reads_nothing_does_not_hold_the_end_up() {
        let (stop, patient) = (CancellationToken::new(), Duration::from_secs(3600));
        let (served, mut client, made) = connect(512, 1 << 20, patient, &stop);
        client.write_all(REQUEST.as_bytes()).await.unwrap();
        while made.load(Ordering::Relaxed) == 0 {
            yield_now().await;
        }
        stop.cancel();
        timeout(PATIENCE, served).await.unwrap().unwrap();
    }

    #[tokio::test]
    async fn a_client_that_reads_a_trickle_is_given_up() {
        let (served, mut client, _) = connect(
            16,
            1 << 20,
            Duration::from_millis(20),
            &CancellationToken::new(),
        );
        client.write_all(REQUEST.as_bytes()).await.unwrap();
        let trickle = async {
            let mut byte = [0];
            while client.read(&mut byte).await.is_ok_and(|read| read > 0) {
                sleep(Duration::from_millis(5)).await;
            }
        };
        // A byte every 5 ms would last for hours.
        timeout(PATIENCE, trickle).await.unwrap();
        timeout(PATIENCE, served).await.unwrap().unwrap();
    }
}
