//! The program's side of isolation: a worker process and the channels to it.

use super::channel::{MOST_BANDS, SharedMemory};
use super::wire::{Answer, Ask, Description, WireBand};
use super::{Isolation, PROGRESS_INTERVAL, Question};
use crate::functions::RawSample;
use crate::guard::{self, Breadcrumb, Text};
use crate::library::{Message, User};
use crate::supervise::Ended;
use crate::table::Arguments;
use crate::{Error, Label};
use glam::DVec3;
use radsight_brdf_abi::{Band, Status};
use rustix::fd::{AsFd, OwnedFd};
use rustix::net::{
    RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer, SendAncillaryMessage, SendFlags,
};
use std::io::{self, BufRead, BufReader, IoSlice, IoSliceMut, Read, Write};
use std::mem::MaybeUninit;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// A process that runs one library.
pub(crate) struct Worker {
    shared: Arc<Shared>,
    socket: Mutex<BufReader<UnixStream>>,
    /// Channels that no thread uses.
    free: Mutex<Vec<usize>>,
    given_back: Condvar,
}

/// State shared with the thread that waits for the end of the process.
struct Shared {
    library: String,
    memory: SharedMemory,
    memory_limit: Option<u64>,
    /// Description of the call in each channel; the last is the socket's. Null if there is none.
    under_way: Vec<AtomicPtr<Text>>,
    closing: AtomicBool,
}

impl Worker {
    /// Starts a process and loads the library in it.
    pub(crate) fn start(
        isolation: &Isolation,
        path: &Path,
        library: &str,
        user: Option<User<'_>>,
        breadcrumb: Breadcrumb,
    ) -> Result<(Worker, Description), Error> {
        let failed = |error: io::Error| Error::CannotIsolate { library: library.to_owned(), reason: error.to_string() };
        let worker = Self::spawn(isolation, library).map_err(failed)?;
        let ask = Ask::Load {
            path: path.to_owned(),
            channels: worker.shared.under_way.len() - 1,
            memory: isolation.memory,
            user: user.map(|user| (user.model.to_owned(), user.label.clone())),
        };
        match worker.ask(&ask, breadcrumb) {
            Answer::Loaded(Ok(description)) => Ok((worker, description)),
            Answer::Loaded(Err(error)) => Err(error),
            _ => Err(failed(io::Error::other("its answer is for another question"))),
        }
    }

    fn spawn(isolation: &Isolation, library: &str) -> io::Result<Worker> {
        // More threads than processors would not be faster.
        let channels = std::thread::available_parallelism().map_or(1, usize::from) + 1;
        let (memory, file) = SharedMemory::make(channels)?;
        let (ours, theirs) = UnixStream::pair()?;
        let mut command = isolation.child.command();
        let process = command.stdin(Stdio::from(OwnedFd::from(theirs))).stdout(Stdio::piped()).spawn()?;
        drop(command);
        send_descriptor(&ours, &file)?;
        ours.set_read_timeout(Some(PROGRESS_INTERVAL))?;
        let shared = Arc::new(Shared {
            library: library.to_owned(),
            memory,
            memory_limit: isolation.memory,
            under_way: (0..=channels).map(|_| AtomicPtr::new(null_mut())).collect(),
            closing: AtomicBool::new(false),
        });
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name(format!("end of {library}"));
        thread.spawn(move || of_thread.wait_for_end(process))?;
        Ok(Worker {
            shared,
            socket: Mutex::new(BufReader::new(ours)),
            free: Mutex::new((0..channels).collect()),
            given_back: Condvar::new(),
        })
    }

    /// Number and flags of the new instance.
    pub(crate) fn create(
        &self,
        index: u32,
        arguments: &Arguments,
        bands: &[Band],
        label: &Label,
        breadcrumb: Breadcrumb,
    ) -> Result<(u32, u32), Error> {
        let broken =
            |what: &str| Error::CannotIsolate { library: self.shared.library.clone(), reason: what.to_owned() };
        if bands.len() > MOST_BANDS {
            return Err(broken(&format!("{} bands, at most {MOST_BANDS} are possible", bands.len())));
        }
        let bands = bands.iter().map(|band| WireBand(vec![band.centre_m, band.low_m, band.high_m])).collect();
        let ask = Ask::Create { index, arguments: arguments.clone(), bands, label: label.clone() };
        match self.ask(&ask, breadcrumb) {
            Answer::Created(made) => made,
            _ => Err(broken("its answer is for another question")),
        }
    }

    pub(crate) fn destroy(&self, instance: u32, breadcrumb: Breadcrumb) {
        self.ask(&Ask::Destroy(instance), breadcrumb);
    }

    /// Findings of the self-check, which the worker runs.
    pub(crate) fn self_check(&self, instance: u32, breadcrumb: Breadcrumb) -> Vec<String> {
        match self.ask(&Ask::SelfCheck(instance), breadcrumb) {
            Answer::SelfChecked(findings) => findings,
            _ => Vec::new(),
        }
    }

    pub(crate) fn manual(&self) -> Option<String> {
        match self.ask(&Ask::Manual, Breadcrumb::for_library(&self.shared.library, "extension")) {
            Answer::Manual(text) => text,
            _ => None,
        }
    }

    pub(crate) fn take_messages(&self) -> Vec<Message> {
        match self.ask(&Ask::Messages, Breadcrumb::for_library(&self.shared.library, "log")) {
            Answer::Messages(messages) => messages,
            _ => Vec::new(),
        }
    }

    pub(crate) fn eval(
        &self,
        instance: u32,
        breadcrumb: Breadcrumb,
        question: Question<'_>,
        values: &mut [f64],
        pdfs: &mut [f64],
    ) -> Status {
        let borrowed = self.borrow_channel(breadcrumb);
        self.shared.memory.channel(borrowed.index).eval(instance, question, values, pdfs)
    }

    pub(crate) fn sample(
        &self,
        instance: u32,
        breadcrumb: Breadcrumb,
        outgoing: DVec3,
        u: [f64; 3],
        weights: &mut [f64],
    ) -> (Status, RawSample) {
        let borrowed = self.borrow_channel(breadcrumb);
        self.shared.memory.channel(borrowed.index).sample(instance, outgoing, u, weights)
    }

    fn borrow_channel(&self, breadcrumb: Breadcrumb) -> Borrowed<'_> {
        let mut free = lock(&self.free);
        let index = loop {
            match free.pop() {
                Some(index) => break index,
                None => free = self.given_back.wait(free).unwrap_or_else(PoisonError::into_inner),
            }
        };
        drop(free);
        self.shared.begin(index, breadcrumb);
        Borrowed { worker: self, index }
    }

    /// Sends a request through the socket. This thread must have no other request in progress.
    fn ask(&self, ask: &Ask, breadcrumb: Breadcrumb) -> Answer {
        let mut socket = lock(&self.socket);
        let mut trail = Some(guard::enter(breadcrumb));
        let last = self.shared.under_way.len() - 1;
        self.shared.begin(last, breadcrumb);
        let progress = self.shared.memory.progress();
        let mut before = progress.load(Ordering::Relaxed);
        let answer = exchange(&mut socket, ask, || {
            let now = progress.load(Ordering::Relaxed);
            if std::mem::replace(&mut before, now) != now {
                // The guard's watch counts this as another call.
                trail = None;
                trail = Some(guard::enter(breadcrumb));
            }
        });
        drop(trail);
        match answer {
            Ok(answer) => {
                self.shared.end(last);
                answer
            }
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                let text = &breadcrumb.text().0;
                guard::end_program(&format!("fault in {text}: its process sent a malformed answer: {error}"))
            }
            // The worker has ended; the waiting thread reports that.
            Err(_) => loop {
                std::thread::park();
            },
        }
    }
}

/// A channel in use by one thread, until dropped.
struct Borrowed<'w> {
    worker: &'w Worker,
    index: usize,
}

impl Drop for Borrowed<'_> {
    fn drop(&mut self) {
        self.worker.shared.end(self.index);
        lock(&self.worker.free).push(self.index);
        self.worker.given_back.notify_one();
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // Closing the socket makes the supervisor end the process.
        self.shared.closing.store(true, Ordering::Release);
    }
}

impl Shared {
    fn begin(&self, index: usize, breadcrumb: Breadcrumb) {
        self.under_way[index].store(std::ptr::from_ref(breadcrumb.text()).cast_mut(), Ordering::Release);
    }

    fn end(&self, index: usize) {
        self.under_way[index].store(null_mut(), Ordering::Release);
    }

    /// Waits for the end of the process, and ends the program too unless the end was requested.
    fn wait_for_end(&self, mut process: Child) {
        let mut said = String::new();
        if let Some(mut output) = process.stdout.take() {
            let _ = output.read_to_string(&mut said);
        }
        let status = process.wait();
        if self.closing.load(Ordering::Acquire) {
            return;
        }
        let ended = said.lines().find_map(|line| serde_json::from_str::<Ended>(line).ok());
        let memory = ended.and_then(|ended| ended.memory(self.memory_limit));
        if self.memory.spoken().load(Ordering::Acquire) > 0 {
            // The worker's own message names the call.
            match memory {
                None => guard::end_silently(),
                Some(memory) => guard::end_program(&format!(
                    "plugin \"{}\": its process {memory} (--plugin-memory-limit)",
                    self.library
                )),
            }
        }
        let how = match (&ended, status) {
            (Some(ended), _) => ended.to_string().replace("the process", "its process"),
            (None, Ok(status)) => format!("the supervisor of its process ended, {status}"),
            (None, Err(error)) => format!("the supervisor of its process is lost: {error}"),
        };
        let memory = memory.map(|memory| format!("; it {memory} (--plugin-memory-limit)")).unwrap_or_default();
        guard::end_program(&format!("fault in {}: {how}{memory}", self.calls_under_way()))
    }

    fn calls_under_way(&self) -> String {
        // SAFETY: only pointers to texts that are kept for ever are stored, and null.
        let texts = self.under_way.iter().filter_map(|text| unsafe { text.load(Ordering::Acquire).as_ref() });
        let mut texts: Vec<&str> = texts.map(|text| &*text.0).collect();
        texts.sort_unstable();
        texts.dedup();
        match &texts[..] {
            [] => format!("plugin \"{}\", between its calls", self.library),
            texts => texts.join(" or "),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Maximum length of an answer.
const MOST_ANSWER_BYTES: u64 = 64 << 20;

/// Sends a request and waits for the answer; `waiting` is called from time to time.
fn exchange(socket: &mut BufReader<UnixStream>, ask: &Ask, mut waiting: impl FnMut()) -> io::Result<Answer> {
    // A path that is not text cannot be sent.
    let line = serde_json::to_string(ask).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
    socket.get_mut().write_all((line + "\n").as_bytes())?;
    let mut answer = Vec::new();
    let mut limited = socket.by_ref().take(MOST_ANSWER_BYTES);
    loop {
        match limited.read_until(b'\n', &mut answer) {
            Ok(_) if answer.is_empty() => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(_) => break,
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => waiting(),
            Err(error) => return Err(error),
        }
    }
    serde_json::from_slice(&answer).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

fn send_descriptor(socket: &UnixStream, file: &OwnedFd) -> io::Result<()> {
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
    let mut ancillary = SendAncillaryBuffer::new(&mut space);
    let files = [file.as_fd()];
    ancillary.push(SendAncillaryMessage::ScmRights(&files));
    rustix::net::sendmsg(socket, &[IoSlice::new(b"\n")], &mut ancillary, SendFlags::empty())?;
    Ok(())
}

/// The receiving side of [`send_descriptor`].
pub(super) fn receive_descriptor(socket: &UnixStream) -> io::Result<OwnedFd> {
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
    let mut ancillary = RecvAncillaryBuffer::new(&mut space);
    let mut byte = [0];
    rustix::net::recvmsg(socket, &mut [IoSliceMut::new(&mut byte)], &mut ancillary, RecvFlags::CMSG_CLOEXEC)?;
    let files = ancillary.drain().find_map(|message| match message {
        RecvAncillaryMessage::ScmRights(mut files) => files.next(),
        _ => None,
    });
    files.ok_or_else(|| io::Error::other("no shared memory came with the first message"))
}
