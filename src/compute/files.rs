//! Files that are computed anew from a job: made once for all who ask for them, and kept for a while.
//!
//! A request waits for its file, and is answered 202 where that takes longer than it may wait. From then on the file is made to its end and kept, whether
//! somebody waits or not. Its computation is cancelled when nobody waits for it and nobody was answered 202, when all jobs of which it was asked are removed,
//! and at a shutdown.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use bytes::Bytes;
use futures_util::future::BoxFuture;
use meshwright_connections::{Budget, Part, StopOnDrop, spawn};
use meshwright_engine::run::Run;
use meshwright_wire::Problem;
use tokio::sync::{oneshot, watch};
use tokio::time::sleep;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use super::rooms::{Rooms, failure};
use super::threads::NoThreads;

/// Files that are kept at the same time, at most.
const MOST_KEPT: usize = 32;

/// A file that is kept counts as so many bytes more, so that refusals are counted as well.
const BYTES_OF_A_NAME: u64 = 1 << 10;

/// Jobs of one file that are remembered; with the last of them the file ends.
const MOST_ASKERS: usize = 32;

/// Limits of files.
#[derive(Debug, Clone, Copy)]
pub struct FileRules {
    /// Files that are made, or wait for threads, at the same time. A client that has some gets at most as many as it leaves.
    pub at_once: usize,
    /// Time that a request waits for its file.
    pub wait: Duration,
    /// Time that a file is kept once its client was answered 202.
    pub keep: Duration,
    /// Time between two looks at the jobs of a file.
    pub look: Duration,
    /// Bytes of all files that are kept, at most; one that is larger is kept alone.
    pub bytes: u64,
}

/// A client that asks for a file of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Asker {
    /// The client.
    pub client: Arc<str>,
    /// The job.
    pub job: Uuid,
}

/// Whether the job of an asker is still there.
pub type IsThere = Arc<dyn Fn(Asker) -> BoxFuture<'static, bool> + Send + Sync>;

/// The computation of a file.
#[derive(Debug)]
pub struct Making<W> {
    /// Memory in MB.
    pub memory: u64,
    /// Time from when it has threads and memory, at most.
    pub time_limit: Duration,
    /// The computation, which gives the file.
    pub work: W,
}

/// Why there is no file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FileError {
    /// As many files are made as are allowed.
    #[error("{0} files are computed at once, which is the limit")]
    Full(usize),
    /// As many files of the client are made as one may have.
    #[error("{0} files of yours are computed at once, the most of one client now")]
    ClientFull(u64),
    /// The file passed its time limit.
    #[error("the file took longer than {0:?}")]
    TimeLimit(Duration),
    /// Its jobs were removed.
    #[error("the job was removed")]
    JobRemoved,
    /// The service is shutting down.
    #[error("the service is shutting down")]
    ShuttingDown,
    /// The engine has no answer.
    #[error(transparent)]
    Failed(Problem),
}

type Outcome = Result<Bytes, FileError>;

/// The files of this process; cloning shares them.
#[derive(Clone)]
pub struct Files(Arc<Desk>);

struct Desk {
    rules: FileRules,
    rooms: Rooms,
    admitted: Budget,
    is_there: IsThere,
    stop: CancellationToken,
    // A mutex of the standard library: it is never held across an await.
    shelf: Mutex<Shelf>,
}

/// The files that are made or kept, by their names.
#[derive(Default)]
struct Shelf {
    files: HashMap<String, File>,
    begun: u64,
}

/// A file that is made or kept.
struct File {
    /// The number of its making, which tells it from a later one of the same name.
    number: u64,
    client: Arc<str>,
    askers: Vec<Asker>,
    waiting: usize,
    /// Clients that were answered 202 and have not asked again.
    expected: HashSet<Arc<str>>,
    was_late: bool,
    outcome: watch::Sender<Option<Outcome>>,
    given_up: CancellationToken,
}

/// A request that waits for a file.
pub struct Asked {
    files: Files,
    name: String,
    number: u64,
    client: Arc<str>,
    outcome: watch::Receiver<Option<Outcome>>,
}

impl Files {
    /// Files for jobs that `is_there` knows, computed within `memory` until `stop` comes.
    ///
    /// # Errors
    ///
    /// When the threads cannot be started.
    pub fn new(
        rules: FileRules,
        is_there: IsThere,
        memory: Budget,
        stop: CancellationToken,
    ) -> Result<Self, NoThreads> {
        let rooms = Rooms::new("file", rules.at_once, Budget::leaving_as_much, memory)?;
        Ok(Self(Arc::new(Desk {
            rules,
            rooms,
            admitted: Budget::leaving_as_much(rules.at_once as u64),
            is_there,
            stop,
            shelf: Mutex::default(),
        })))
    }

    /// The number that are made, or wait for threads.
    pub fn count(&self) -> usize {
        let shelf = self.0.shelf();
        let is_made = |file: &&File| !file.has_ended();
        shelf.files.values().filter(is_made).count()
    }

    /// The file `name`, if it is made or kept.
    pub fn find(&self, asker: &Asker, name: &str) -> Option<Asked> {
        self.join(&mut self.0.shelf(), asker, name)
    }

    /// The file `name`, which is made for `asker` if it is neither made nor kept.
    ///
    /// # Errors
    ///
    /// [`FileError::Full`], [`FileError::ClientFull`], [`FileError::ShuttingDown`].
    pub fn find_or_make<W>(
        &self,
        asker: &Asker,
        name: &str,
        making: Making<W>,
    ) -> Result<Asked, FileError>
    where
        W: FnOnce(&Run) -> Result<Bytes, Problem> + Send + 'static,
    {
        let desk = &self.0;
        if desk.stop.is_cancelled() {
            return Err(FileError::ShuttingDown);
        }
        let mut shelf = desk.shelf();
        if let Some(asked) = self.join(&mut shelf, asker, name) {
            return Ok(asked);
        }
        let admitted = desk.admitted.try_take(&asker.client, 1);
        let part = admitted.ok_or_else(|| match desk.admitted.free() {
            0 => FileError::Full(desk.rules.at_once),
            _ => FileError::ClientFull(desk.admitted.held(&asker.client)),
        })?;
        shelf.begun += 1;
        let file = File {
            number: shelf.begun,
            client: Arc::clone(&asker.client),
            askers: Vec::new(),
            waiting: 0,
            expected: HashSet::new(),
            was_late: false,
            outcome: watch::Sender::default(),
            given_up: CancellationToken::new(),
        };
        let (number, given_up) = (file.number, file.given_up.clone());
        shelf.files.insert(name.to_owned(), file);
        let asked = self.join(&mut shelf, asker, name);
        drop(shelf);
        let (files, client) = (self.clone(), Arc::clone(&asker.client));
        let place = (name.to_owned(), number);
        spawn(async move { files.make(place, client, part, given_up, making).await });
        Ok(asked.expect("it was put there under the same lock"))
    }

    /// Removes the oldest file that is kept for `client` and for which nobody waits. False if there is none.
    pub fn remove_oldest_of(&self, client: &str) -> bool {
        let mut shelf = self.0.shelf();
        let kept = shelf.kept().filter(|(_, file)| &*file.client == client);
        let oldest = kept.min_by_key(|(_, file)| file.number);
        let name = oldest.map(|(name, _)| name.clone());
        name.is_some_and(|name| shelf.remove(&name))
    }

    fn join(&self, shelf: &mut Shelf, asker: &Asker, name: &str) -> Option<Asked> {
        let file = shelf.files.get_mut(name)?;
        file.waiting += 1;
        if file.askers.len() < MOST_ASKERS && !file.askers.contains(asker) {
            file.askers.push(asker.clone());
        }
        Some(Asked {
            files: self.clone(),
            name: name.to_owned(),
            number: file.number,
            client: Arc::clone(&asker.client),
            outcome: file.outcome.subscribe(),
        })
    }

    /// Makes a file, and keeps it for its time.
    async fn make<W>(
        self,
        (name, number): (String, u64),
        client: Arc<str>,
        part: Part,
        given_up: CancellationToken,
        making: Making<W>,
    ) where
        W: FnOnce(&Run) -> Result<Bytes, Problem> + Send + 'static,
    {
        let stop = &self.0.stop;
        let made = tokio::select! {
            biased;
            () = given_up.cancelled() => return,
            () = stop.cancelled() => Err(FileError::ShuttingDown),
            () = self.jobs_are_removed(&name, number) => Err(FileError::JobRemoved),
            made = self.compute(&client, making) => made,
        };
        drop(part);
        self.0.end(&name, number, made);
        tokio::select! {
            () = given_up.cancelled() => {}
            () = stop.cancelled() => {}
            () = self.jobs_are_removed(&name, number) => {}
            () = sleep(self.0.rules.keep) => {}
        }
        let mut shelf = self.0.shelf();
        if shelf.of_number(&name, number).is_some() {
            shelf.remove(&name);
        }
    }

    /// Computes a file for `client`. Dropping the future stops the engine.
    async fn compute<W>(&self, client: &str, making: Making<W>) -> Outcome
    where
        W: FnOnce(&Run) -> Result<Bytes, Problem> + Send + 'static,
    {
        let Making {
            memory,
            time_limit,
            work,
        } = making;
        let room = self.0.rooms.enter(client).await;
        let stop = StopOnDrop::default();
        let run = Run::new(Arc::clone(&stop.0), |_, _| {});
        let (begun, begins) = oneshot::channel();
        let work = move |run: &Run| {
            // Its time limit may have passed.
            let _ = begun.send(());
            work(run)
        };
        let made = room.launch(move || memory, work, run);
        let late = async {
            // Dropped only after a computation that has ended.
            let _ = begins.await;
            sleep(time_limit).await;
        };
        tokio::select! {
            biased;
            made = made => {
                // The sender is only ever dropped with a result in it.
                let made = made.map_or_else(|_| Err(failure()), |(made, _)| made);
                made.map_err(FileError::Failed)
            }
            () = late => Err(FileError::TimeLimit(time_limit)),
        }
    }

    /// Comes back when the jobs of a file are removed.
    async fn jobs_are_removed(&self, name: &str, number: u64) {
        loop {
            sleep(self.0.rules.look).await;
            let askers = self
                .0
                .shelf()
                .of_number(name, number)
                .map(|file| file.askers.clone());
            let mut is_there = false;
            for asker in askers.unwrap_or_default() {
                is_there = (self.0.is_there)(asker).await;
                if is_there {
                    break;
                }
            }
            if !is_there {
                return;
            }
        }
    }
}

impl Desk {
    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf
            .lock()
            .expect("nothing panics while it holds this lock")
    }

    /// Ends the making of a file.
    fn end(&self, name: &str, number: u64, made: Outcome) {
        let mut shelf = self.shelf();
        if let Some(file) = shelf.of_number(name, number) {
            file.outcome.send_replace(Some(made));
            shelf.settle(name, number, self.rules.bytes);
        }
    }
}

impl Shelf {
    /// The file of this name, if it is of that making.
    fn of_number(&mut self, name: &str, number: u64) -> Option<&mut File> {
        let file = self.files.get_mut(name)?;
        (file.number == number).then_some(file)
    }

    /// Removes a file that nobody wants any more, and those for which there is no room beside it.
    fn settle(&mut self, name: &str, number: u64, most_bytes: u64) {
        if self
            .of_number(name, number)
            .is_some_and(|file| !file.is_wanted())
        {
            self.remove(name);
        }
        while let Some(name) = self.beyond(number, most_bytes) {
            self.remove(&name);
        }
    }

    /// The file that gives way where more are kept than may be: the oldest of the client of whom most is kept, but never that of the making `newest`.
    fn beyond(&self, newest: u64, most_bytes: u64) -> Option<String> {
        let mut of_clients: HashMap<&str, u64> = HashMap::new();
        for (_, file) in self.kept() {
            *of_clients.entry(&file.client).or_default() += file.bytes();
        }
        let bytes: u64 = of_clients.values().sum();
        if bytes <= most_bytes && self.kept().count() <= MOST_KEPT {
            return None;
        }
        let others = self.kept().filter(|(_, file)| file.number != newest);
        let first = others.max_by_key(|(_, file)| {
            let of_client = of_clients.get(&*file.client).copied();
            (of_client, std::cmp::Reverse(file.number))
        });
        first.map(|(name, _)| name.clone())
    }

    /// Files that have been made, and for which nobody waits now.
    fn kept(&self) -> impl Iterator<Item = (&String, &File)> {
        let is_kept = |(_, file): &(&String, &File)| file.has_ended() && file.waiting == 0;
        self.files.iter().filter(is_kept)
    }

    /// Removes a file and stops its making. False if there is none.
    fn remove(&mut self, name: &str) -> bool {
        let removed = self.files.remove(name);
        removed.is_some_and(|file| {
            file.given_up.cancel();
            true
        })
    }
}

impl File {
    fn has_ended(&self) -> bool {
        self.outcome.borrow().is_some()
    }

    /// True as long as somebody waits for it or may come back for it.
    fn is_wanted(&self) -> bool {
        self.waiting > 0
            || match &*self.outcome.borrow() {
                None | Some(Ok(_)) => self.was_late,
                // Whoever was answered 202 gets the reason why there is none, once.
                Some(Err(_)) => !self.expected.is_empty(),
            }
    }

    fn bytes(&self) -> u64 {
        let made = match &*self.outcome.borrow() {
            Some(Ok(file)) => file.len() as u64,
            _ => 0,
        };
        BYTES_OF_A_NAME + made
    }
}

impl Asked {
    /// The file; `None` if it is not made in time, so that the answer is 202.
    ///
    /// # Errors
    ///
    /// A [`FileError`].
    pub async fn file(mut self) -> Result<Option<Bytes>, FileError> {
        let wait = self.files.0.rules.wait;
        let made = tokio::select! {
            biased;
            made = self.outcome.wait_for(Option::is_some) => made.ok().and_then(|made| made.clone()),
            () = sleep(wait) => None,
        };
        if let Some(file) = self.files.0.shelf().of_number(&self.name, self.number) {
            if made.is_some() {
                file.expected.remove(&self.client);
            } else {
                file.was_late = true;
                file.expected.insert(Arc::clone(&self.client));
            }
        }
        made.transpose()
    }
}

impl Drop for Asked {
    fn drop(&mut self) {
        let desk = &self.files.0;
        let mut shelf = desk.shelf();
        if let Some(file) = shelf.of_number(&self.name, self.number) {
            file.waiting -= 1;
            shelf.settle(&self.name, self.number, desk.rules.bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::sync::mpsc as blocking;

    use meshwright_wire::Code;

    use super::*;

    /// Files whose requests wait for nothing, of jobs that are there as long as `removed` does not say otherwise.
    struct Bench {
        files: Files,
        removed: Arc<AtomicBool>,
        stop: CancellationToken,
        begun: Arc<AtomicUsize>,
    }

    /// The end of a computation that waits for it.
    struct Gate(blocking::Sender<Result<Vec<u8>, Problem>>);

    /// The stop that a computation saw.
    type Stopped = oneshot::Receiver<()>;

    impl Bench {
        fn of(adjust: impl FnOnce(&mut FileRules)) -> Self {
            let mut rules = FileRules {
                at_once: 4,
                wait: Duration::ZERO,
                keep: Duration::from_secs(3600),
                look: Duration::from_millis(1),
                bytes: 1 << 20,
            };
            adjust(&mut rules);
            let removed = Arc::<AtomicBool>::default();
            let stop = CancellationToken::new();
            let was_removed = Arc::clone(&removed);
            let is_there: IsThere = Arc::new(move |_| {
                let removed = was_removed.load(Ordering::Relaxed);
                Box::pin(async move { !removed })
            });
            let memory = Budget::of(100);
            let files = Files::new(rules, is_there, memory, stop.clone()).unwrap();
            Self {
                files,
                removed,
                stop,
                begun: Arc::default(),
            }
        }

        /// Asks for a file, which comes once the gate is opened.
        fn ask(&self, client: &str, name: &str) -> (Result<Asked, FileError>, Gate, Stopped) {
            let (open, opened) = blocking::channel::<Result<Vec<u8>, Problem>>();
            let (stopped, stop) = oneshot::channel();
            let begun = Arc::clone(&self.begun);
            let work = move |run: &Run| {
                begun.fetch_add(1, Ordering::Relaxed);
                loop {
                    match opened.recv_timeout(Duration::from_millis(1)) {
                        Ok(made) => return made.map(Bytes::from),
                        Err(_) if run.check().is_ok() => {}
                        Err(_) => break,
                    }
                }
                let _ = stopped.send(());
                Err(Problem::new(Code::Stopped, "stopped"))
            };
            let making = Making {
                memory: 1,
                time_limit: Duration::from_secs(3600),
                work,
            };
            let asked = self.files.find_or_make(&asker(client), name, making);
            (asked, Gate(open), stop)
        }
    }

    fn asker(client: &str) -> Asker {
        Asker {
            client: client.into(),
            job: Uuid::nil(),
        }
    }

    /// Waits for the end of a file without an answer 202.
    async fn ended(asked: &Asked) -> Outcome {
        let mut outcome = asked.outcome.clone();
        let made = outcome.wait_for(Option::is_some).await.unwrap();
        made.clone().unwrap()
    }

    impl Files {
        /// The file of this name, which is made or kept, once it has ended.
        async fn eventually(&self, client: &str, name: &str) -> Outcome {
            let asked = self.find(&asker(client), name).unwrap();
            // An error is a file that has ended, too.
            let _ = ended(&asked).await;
            asked.file().await.transpose().unwrap()
        }
    }

    #[tokio::test]
    async fn a_file_that_comes_late_is_made_once_for_all_who_ask_and_kept() {
        let bench = Bench::of(|_| {});
        let (first, gate, _) = bench.ask("a", "x");
        assert_eq!(first.unwrap().file().await, Ok(None));
        let (second, _, _) = bench.ask("b", "x");
        assert_eq!(second.unwrap().file().await, Ok(None));
        gate.0.send(Ok(vec![7])).unwrap();
        for client in ["a", "b", "a"] {
            let file = bench.files.eventually(client, "x").await;
            assert_eq!(file, Ok(Bytes::from_static(&[7])), "{client}");
        }
        assert_eq!(bench.begun.load(Ordering::Relaxed), 1);
        assert_eq!(bench.files.count(), 0);
    }

    #[tokio::test]
    async fn a_file_that_comes_in_time_is_not_kept() {
        let bench = Bench::of(|rules| rules.wait = Duration::from_secs(3600));
        let (asked, gate, _) = bench.ask("a", "x");
        gate.0.send(Ok(vec![7])).unwrap();
        let file = asked.unwrap().file().await;
        assert_eq!(file, Ok(Some(Bytes::from_static(&[7]))));
        assert!(bench.files.find(&asker("a"), "x").is_none());
    }

    #[tokio::test]
    async fn a_request_that_goes_away_untold_stops_its_file_and_one_that_was_told_to_come_back_does_not()
     {
        let bench = Bench::of(|rules| rules.wait = Duration::from_secs(3600));
        let (gone, _gate, stopped) = bench.ask("a", "x");
        drop(gone);
        assert!(bench.files.find(&asker("a"), "x").is_none());
        // A computation that was stopped before it began says nothing.
        let _ = stopped.await;

        let bench = Bench::of(|_| {});
        let (told, gate, _) = bench.ask("a", "x");
        assert_eq!(told.unwrap().file().await, Ok(None));
        assert_eq!(bench.files.count(), 1);
        gate.0.send(Ok(vec![7])).unwrap();
        assert!(bench.files.eventually("a", "x").await.is_ok());
    }

    #[tokio::test]
    async fn a_removed_job_and_a_shutdown_stop_its_file() {
        for shuts_down in [false, true] {
            let bench = Bench::of(|_| {});
            let (asked, _gate, stopped) = bench.ask("a", "x");
            let asked = asked.unwrap();
            if shuts_down {
                bench.stop.cancel();
            } else {
                bench.removed.store(true, Ordering::Relaxed);
            }
            let error = match shuts_down {
                true => FileError::ShuttingDown,
                false => FileError::JobRemoved,
            };
            assert_eq!(ended(&asked).await, Err(error));
            let _ = stopped.await;
            assert_eq!(bench.files.count(), 0);
        }
    }

    #[tokio::test]
    async fn a_file_that_fails_says_why_once_to_whoever_comes_back_and_is_then_made_anew() {
        let bench = Bench::of(|_| {});
        let (told, gate, _) = bench.ask("a", "x");
        assert_eq!(told.unwrap().file().await, Ok(None));
        let problem = Problem::new(Code::TooLarge, "as the test wants");
        gate.0.send(Err(problem.clone())).unwrap();
        let found = bench.files.eventually("a", "x").await;
        assert_eq!(found, Err(FileError::Failed(problem)));
        let (again, gate, _) = bench.ask("a", "x");
        assert_eq!(again.unwrap().file().await, Ok(None));
        gate.0.send(Ok(vec![7])).unwrap();
        assert!(bench.files.eventually("a", "x").await.is_ok());
        assert_eq!(bench.begun.load(Ordering::Relaxed), 2);
    }

    #[tokio::test]
    async fn a_file_that_takes_too_long_is_stopped() {
        let bench = Bench::of(|_| {});
        let (stopped, stop) = oneshot::channel();
        let work = move |run: &Run| {
            while run.check().is_ok() {
                std::thread::sleep(Duration::from_millis(1));
            }
            let _ = stopped.send(());
            Ok(Bytes::new())
        };
        let making = Making {
            memory: 1,
            time_limit: Duration::ZERO,
            work,
        };
        let asked = bench.files.find_or_make(&asker("a"), "x", making).unwrap();
        let limit = FileError::TimeLimit(Duration::ZERO);
        assert_eq!(ended(&asked).await, Err(limit));
        stop.await.unwrap();
    }

    #[tokio::test]
    async fn one_client_has_half_of_the_files_that_are_made_and_all_together_have_a_limit() {
        let bench = Bench::of(|_| {});
        let asked: Vec<_> = [
            ("a", "1"),
            ("a", "2"),
            ("a", "3"),
            ("b", "4"),
            ("c", "5"),
            ("d", "6"),
        ]
        .into_iter()
        .map(|(client, name)| bench.ask(client, name))
        .collect();
        let refused: Vec<_> = asked
            .iter()
            .map(|(asked, ..)| asked.as_ref().err().cloned())
            .collect();
        let expected = [
            None,
            None,
            Some(FileError::ClientFull(2)),
            None,
            None,
            Some(FileError::Full(4)),
        ];
        assert_eq!(refused, expected);
    }

    #[tokio::test]
    async fn files_that_are_kept_have_a_limit_and_the_client_of_whom_most_is_kept_gives_way() {
        let bench = Bench::of(|rules| rules.bytes = 3 * (BYTES_OF_A_NAME + 1000));
        for (client, name, bytes) in [
            ("a", "1", 1000),
            ("b", "2", 1000),
            ("b", "3", 1000),
            ("b", "4", 1000),
            // One that is larger than all may be is kept alone.
            ("c", "5", 1 << 20),
        ] {
            let (told, gate, _) = bench.ask(client, name);
            assert_eq!(told.unwrap().file().await, Ok(None));
            gate.0.send(Ok(vec![0; bytes])).unwrap();
            assert!(bench.files.eventually(client, name).await.is_ok());
            if name == "4" {
                let kept = ["1", "2", "3", "4"].map(|name| bench.is_kept(name));
                assert_eq!(kept, [true, false, true, true]);
            }
        }
        let kept = ["1", "3", "4", "5"].map(|name| bench.is_kept(name));
        assert_eq!(kept, [false, false, false, true]);
        assert!(bench.files.remove_oldest_of("c") && !bench.files.remove_oldest_of("c"));
    }

    impl Bench {
        fn is_kept(&self, name: &str) -> bool {
            self.files.0.shelf().files.contains_key(name)
        }
    }
}
