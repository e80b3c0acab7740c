//! Connections: how many there may be, how long one may say nothing, and how they end.
//!
//! A connection is busy from the head of a request to the last byte of its answer, and idle otherwise. Idle ones cost little,
//! but each holds a descriptor, of which a process has so many: an idle one gives way where a new one finds no room, and ends
//! by itself when its client sends no request for a while.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
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
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::JoinHandle;
use tokio::time::{Instant, sleep, timeout};
use tokio_io_timeout::TimeoutStream;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower::ServiceExt;
use tracing::{debug, warn};

/// A head is no larger than this, in bytes.
const LARGEST_HEAD: usize = 32 << 10;

/// A head has no more fields than this.
const MOST_FIELDS: usize = 64;

/// An idle connection that is asked to end gets so long.
const LAST_BREATH: Duration = Duration::from_millis(300);

/// How connections are bounded.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// So many at the same time.
    pub connections: usize,
    /// The head of a request is here so long after the connection began or the last answer ended.
    pub head: Duration,
    /// A client that takes nothing of its answer for so long is given up.
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
            let serve = serve_connection(
                stream,
                self.router.clone(),
                self.bounds,
                place,
                self.stop.clone(),
            );
            let kill = self.kill.clone();
            self.connections.spawn(async move {
                tokio::select! {
                    () = serve => {}
                    () = kill.cancelled() => {}
                }
            });
        }
    }

    /// The next connection, once there is room for it.
    async fn next(&self, listener: &TcpListener) -> (TcpStream, Place) {
        /// While the system gives no connections it is asked so often.
        const PAUSE: Duration = Duration::from_millis(50);
        loop {
            let place = self.guests.place().await;
            match listener.accept().await {
                Ok((stream, _)) => return (stream, place),
                Err(error) => {
                    // Out of descriptors, most likely: those who idle have some.
                    warn!(%error, "no connection can be taken");
                    self.guests.send_idle_away();
                    sleep(PAUSE).await;
                }
            }
        }
    }
}

/// The connections that there are.
struct Guests {
    room: Arc<Semaphore>,
    present: Mutex<Present>,
}

#[derive(Default)]
struct Present {
    last: u64,
    /// By their order of arrival.
    guests: BTreeMap<u64, Guest>,
}

#[derive(Clone)]
struct Guest {
    /// Requests that are being answered.
    busy: Arc<AtomicUsize>,
    leave: CancellationToken,
}

impl Guests {
    fn new(most: usize) -> Arc<Self> {
        Arc::new(Self {
            room: Arc::new(Semaphore::new(most.max(1))),
            present: Mutex::default(),
        })
    }

    /// A place, once there is one. Where there is none, the guest that has idled longest is asked to leave.
    async fn place(self: &Arc<Self>) -> Place {
        let mut permit = Arc::clone(&self.room).try_acquire_owned().ok();
        while permit.is_none() {
            self.send_idle_away();
            let next = Arc::clone(&self.room).acquire_owned();
            // Everybody may have been busy; then it is worth looking again.
            permit = timeout(LAST_BREATH, next).await.ok().and_then(Result::ok);
        }
        let guest = Guest {
            busy: Arc::default(),
            leave: CancellationToken::new(),
        };
        let mut present = self.present();
        present.last += 1;
        let number = present.last;
        present.guests.insert(number, guest.clone());
        drop(present);
        metrics::gauge!("meshwright_connections").increment(1.0);
        Place {
            guests: Arc::clone(self),
            number,
            guest,
            _permit: permit,
        }
    }

    /// Asks the oldest of the idle guests to leave.
    fn send_idle_away(&self) {
        let present = self.present();
        let idle = present
            .guests
            .values()
            .find(|guest| guest.busy.load(Ordering::Relaxed) == 0 && !guest.leave.is_cancelled());
        if let Some(guest) = idle {
            guest.leave.cancel();
            metrics::counter!("meshwright_connections_evicted_total").increment(1);
        }
    }

    fn present(&self) -> std::sync::MutexGuard<'_, Present> {
        self.present.lock().expect("nothing panics with this lock")
    }
}

/// The place of a connection, free when it is dropped.
struct Place {
    guests: Arc<Guests>,
    number: u64,
    guest: Guest,
    _permit: Option<OwnedSemaphorePermit>,
}

impl Drop for Place {
    fn drop(&mut self) {
        self.guests.present().guests.remove(&self.number);
        metrics::gauge!("meshwright_connections").decrement(1.0);
    }
}

/// Counts a request as long as it is being answered.
struct Busy(Arc<AtomicUsize>);

impl Busy {
    fn begin(count: &Arc<AtomicUsize>) -> Self {
        count.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(count))
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A body that keeps its connection busy until it has been sent.
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

async fn serve_connection(
    stream: TcpStream,
    router: Router,
    bounds: Bounds,
    place: Place,
    stop: CancellationToken,
) {
    // An answer is written whole; to wait for more of it would only make the client wait.
    let _ = stream.set_nodelay(true);
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(bounds.stall));
    let busy = Arc::clone(&place.guest.busy);
    let count = Arc::clone(&busy);
    let service = service_fn(move |request: Request<Incoming>| {
        let (router, busy) = (router.clone(), Busy::begin(&count));
        async move {
            let Ok(response) = router.oneshot(request.map(Body::new)).await;
            Ok::<_, Infallible>(kept_busy(response, busy))
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(bounds.head)
        .max_buf_size(LARGEST_HEAD)
        .max_headers(MOST_FIELDS)
        .serve_connection(TokioIo::new(Box::pin(stream)), service);
    let mut connection = pin!(connection);
    let ended = tokio::select! {
        ended = &mut connection => ended,
        () = stop.cancelled() => end(connection, &busy).await,
        () = place.guest.leave.cancelled() => end(connection, &busy).await,
    };
    if let Err(error) = ended {
        debug!(%error, "a connection broke");
    }
}

fn kept_busy(response: Response<Body>, busy: Busy) -> Response<BusyBody> {
    response.map(|inner| BusyBody { inner, _busy: busy })
}

/// Ends a connection: with the answer that is under way, or at once if there is none. One that has sent half a head is
/// as idle as one that has sent nothing.
async fn end<I, S>(
    mut connection: Pin<&mut http1::Connection<I, S>>,
    busy: &AtomicUsize,
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
            ended = poll_fn(|context| connection.as_mut().poll(context)) => return ended,
            () = wait => {}
        }
        if busy.load(Ordering::Relaxed) > 0 {
            idle_since = Instant::now();
        } else if idle_since.elapsed() >= LAST_BREATH {
            return Ok(());
        }
    }
}
