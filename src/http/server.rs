//! Connections: how many there may be, how long one may say nothing, and how they end.
//!
//! A connection is busy from the head of a request to the last byte of its answer, and idle otherwise; one whose client gives
//! nothing of its request, or takes nothing of its answer, is as idle. Idle ones cost little, but each holds a descriptor, of which a process has so many: an
//! idle one gives way where a new one finds no room, and ends by itself when its client sends no request, or takes nothing, for
//! a while.

use std::convert::Infallible;
use std::future::poll_fn;
use std::net::SocketAddr;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::http::{Request, Response};
use http_body::{Body as HttpBody, Frame, SizeHint};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;
use tokio::time::{Instant, sleep, timeout};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower::ServiceExt;
use tracing::{debug, warn};

use super::giving::Awaited;
use super::guests::{Busy, Guest, Guests, Place};
use super::taking::Watched;

/// A head is no larger than this, in bytes.
const LARGEST_HEAD: usize = 32 << 10;

/// A head has no more fields than this.
const MOST_FIELDS: usize = 64;

/// At a shutdown, an idle connection gets so long for what may be on its way.
const LAST_BREATH: Duration = Duration::from_millis(300);

/// How connections are bounded.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// So many at the same time.
    pub connections: usize,
    /// The head of a request is here so long after the connection began or the last answer ended.
    pub head: Duration,
    /// A client that takes nothing of its answer for so long, or a trickle of it for long, is given up.
    pub stall: Duration,
}

/// A listener that is served.
pub struct Server {
    task: JoinHandle<()>,
    connections: TaskTracker,
    kill: CancellationToken,
}

impl Server {
    /// Serves `router` to all who come to `listener`, until `stop` comes.
    pub fn start(
        listener: TcpListener,
        router: Router,
        bounds: Bounds,
        stop: CancellationToken,
    ) -> Self {
        let connections = TaskTracker::new();
        let kill = CancellationToken::new();
        let hall = Hall {
            router,
            bounds,
            guests: Guests::new(bounds.connections),
            connections: connections.clone(),
            stop,
            kill: kill.clone(),
        };
        Self {
            task: tokio::spawn(hall.receive(listener)),
            connections,
            kill,
        }
    }

    /// Comes back when every connection has ended, after the stop: idle ones at once, busy ones with their answer, none
    /// later than `grace`. False if some had to be cut off.
    pub async fn ended(self, grace: Duration) -> bool {
        let all = async {
            // It neither panics nor is aborted.
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

/// Where connections come in.
struct Hall {
    router: Router,
    bounds: Bounds,
    guests: Arc<Guests>,
    connections: TaskTracker,
    stop: CancellationToken,
    kill: CancellationToken,
}

impl Hall {
    async fn receive(self, listener: TcpListener) {
        loop {
            let accepted = tokio::select! {
                accepted = self.next(&listener) => accepted,
                () = self.stop.cancelled() => return,
                () = self.kill.cancelled() => return,
            };
            let (stream, place) = accepted;
            // An answer is written whole; to wait for more of it would only make the client wait.
            let _ = stream.set_nodelay(true);
            let (router, bounds, stop) = (self.router.clone(), self.bounds, self.stop.clone());
            let kill = self.kill.clone();
            self.connections.spawn(async move {
                let serve = serve_connection(stream, router, bounds, &place.guest, &stop);
                tokio::select! {
                    () = serve => {}
                    () = kill.cancelled() => {}
                }
            });
        }
    }

    /// The next connection, once there is room for it. It is taken before there is: by where it comes from others are chosen to
    /// give way.
    async fn next(&self, listener: &TcpListener) -> (TcpStream, Place) {
        let (stream, address) = self.accept(listener).await;
        let place = self.guests.place(Guest::from(address.ip().into())).await;
        (stream, place)
    }

    async fn accept(&self, listener: &TcpListener) -> (TcpStream, SocketAddr) {
        /// While the system gives no connections it is asked so often.
        const PAUSE: Duration = Duration::from_millis(50);
        loop {
            match listener.accept().await {
                Ok(accepted) => return accepted,
                Err(error) => {
                    // Out of descriptors, most likely: those who idle have some.
                    warn!(%error, "no connection can be taken");
                    self.guests.send_one_away();
                    sleep(PAUSE).await;
                }
            }
        }
    }
}

/// A body that keeps its connection busy until all of it was handed over to be sent.
struct BusyBody {
    inner: Body,
    _busy: Busy,
}

impl HttpBody for BusyBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.inner).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

async fn serve_connection<S>(
    stream: S,
    router: Router,
    bounds: Bounds,
    guest: &Arc<Guest>,
    stop: &CancellationToken,
) where
    S: AsyncRead + AsyncWrite + Unpin,
{
    let stream = Watched::new(stream, Arc::clone(&guest.taking), bounds.stall);
    let service = service_fn(|mut request: Request<Incoming>| {
        let (router, guest) = (router.clone(), Arc::clone(guest));
        let busy = Busy::begin(&guest);
        async move {
            guest.taking.emptied().await;
            let giving = Arc::clone(&guest.giving);
            request.extensions_mut().insert(guest);
            let request = request.map(|body| Body::new(Awaited::new(body, giving)));
            let Ok(response) = router.oneshot(request).await;
            Ok::<_, Infallible>(kept_busy(response, busy))
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(bounds.head)
        .max_buf_size(LARGEST_HEAD)
        .max_headers(MOST_FIELDS)
        // Every answer of ours has its own, by the clock of the service.
        .auto_date_header(false)
        .serve_connection(TokioIo::new(stream), service);
    let mut connection = pin!(connection);
    let ended = tokio::select! {
        ended = &mut connection => ended,
        () = stop.cancelled() => end(connection, guest, LAST_BREATH).await,
        () = guest.leave.cancelled() => end(connection, guest, Duration::ZERO).await,
    };
    if let Err(error) = ended {
        debug!(%error, "a connection broke");
    }
}

fn kept_busy(response: Response<Body>, busy: Busy) -> Response<BusyBody> {
    response.map(|inner| BusyBody { inner, _busy: busy })
}

/// Ends a connection: with the answer that is under way, or when it has been idle for `patience`. One that has sent half a
/// head is as idle as one that has sent nothing, and so is one that gives no body, or takes nothing of its answer.
async fn end<I, S>(
    mut connection: Pin<&mut http1::Connection<I, S>>,
    guest: &Guest,
    patience: Duration,
) -> hyper::Result<()>
where
    I: hyper::rt::Read + hyper::rt::Write + Unpin,
    S: hyper::service::HttpService<Incoming, ResBody = BusyBody>,
    S::Error: Into<Box<dyn std::error::Error + Send + Sync>>,
{
    connection.as_mut().graceful_shutdown();
    let mut idle_since = Instant::now();
    loop {
        let wait = sleep(LAST_BREATH / 4);
        tokio::select! {
            // What has arrived by now is answered.
            biased;
            ended = poll_fn(|context| connection.as_mut().poll(context)) => return ended,
            () = std::future::ready(()), if patience.is_zero() && guest.is_idle(Instant::now()) => return Ok(()),
            () = wait => {}
        }
        if !guest.is_idle(Instant::now()) {
            idle_since = Instant::now();
        } else if idle_since.elapsed() >= patience {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::IpAddr;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use axum::routing::get;
    use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex};
    use tokio::task::yield_now;

    use super::*;

    const PATIENCE: Duration = Duration::from_secs(20);

    /// A connection that is served, its client's end, and how many answers were made. What is on its way holds `room` bytes.
    fn connect(
        room: usize,
        answer: usize,
        stall: Duration,
    ) -> (JoinHandle<()>, DuplexStream, Arc<AtomicUsize>) {
        let made = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&made);
        let handler = async move || {
            count.fetch_add(1, Ordering::Relaxed);
            "a".repeat(answer)
        };
        let router = Router::new().route("/", get(handler));
        let bounds = Bounds {
            connections: 1,
            head: PATIENCE,
            stall,
        };
        let (ours, theirs) = duplex(room);
        let guest = Arc::new(Guest::from(IpAddr::from([127, 0, 0, 1]).into()));
        let serve = async move {
            serve_connection(ours, router, bounds, &guest, &CancellationToken::new()).await;
        };
        (tokio::spawn(serve), theirs, made)
    }

    const REQUEST: &str = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";

    #[tokio::test]
    async fn of_many_requests_at_once_one_answer_lies_here_at_a_time() {
        // The answers are larger than what may be on its way, and much smaller than what is buffered for one.
        let (_, mut client, made) = connect(1 << 10, 2 << 10, PATIENCE);
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
    async fn who_takes_nothing_is_given_up_whatever_is_buffered() {
        for answer in [1 << 10, 30 << 10, 1 << 20] {
            let (served, mut client, _) = connect(512, answer, Duration::from_millis(20));
            client.write_all(REQUEST.as_bytes()).await.unwrap();
            timeout(PATIENCE, served).await.unwrap().unwrap();
        }
    }

    #[tokio::test]
    async fn who_takes_a_trickle_to_last_for_ever_is_given_up() {
        let (served, mut client, _) = connect(16, 1 << 20, Duration::from_millis(20));
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
