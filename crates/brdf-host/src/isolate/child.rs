//! The worker: the process that runs a library.

use super::channel::{Call, SharedMemory};
use super::wire::{Answer, Ask, Description, WireBand};
use crate::guard;
use crate::library::User;
use crate::self_check::{SelfCheck, self_check};
use crate::table::Arguments;
use crate::{Error, Label, Library, PluginBrdf, supervise};
use radsight_brdf_abi::{Band, status};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::process::Stdio;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError, RwLock};

/// Entry point of the hidden command: the supervisor, or the worker.
///
/// # Errors
/// If the other side violates the protocol.
pub fn child_main() -> io::Result<()> {
    if supervise::is_worker() { work() } else { supervise_worker() }
}

/// Reports on standard output how the worker ended.
fn supervise_worker() -> io::Result<()> {
    supervise::adopt_orphans()?;
    let stderr = io::stderr().as_fd().try_clone_to_owned()?;
    let worker = supervise::worker_command()?.stdin(Stdio::inherit()).stdout(Stdio::from(stderr)).spawn()?;
    let ended = supervise::watch(worker)?;
    writeln!(io::stdout(), "{}", serde_json::to_string(&ended)?)
}

fn work() -> io::Result<()> {
    supervise::begin_work();
    let socket = take_socket()?;
    let memory = super::parent::receive_descriptor(&socket)?;
    let mut lines = BufReader::new(socket.try_clone()?).lines();
    let mut next = || -> io::Result<Option<Ask>> {
        let Some(line) = lines.next() else { return Ok(None) };
        Ok(Some(serde_json::from_str(&line?)?))
    };
    let Some(Ask::Load { path, channels, memory: limit, user }) = next()? else { return Ok(()) };
    let shared = SharedMemory::map(&memory, channels)?;
    drop(memory);
    guard::announce_reports_in(shared.spoken());
    guard::install_in_child()?;
    let instances: Instances = Arc::default();
    for channel in 0..channels {
        let (channel, instances) = (shared.channel(channel), Arc::clone(&instances));
        std::thread::Builder::new().spawn(move || serve(&channel, &instances))?;
    }
    show_progress(shared)?;
    supervise::limit_memory(limit, channels)?;
    let user = user.as_ref().map(|(model, label)| User { model, label });
    let loaded = Library::load_for(&path, user, None).map(Arc::new);
    let describe =
        |library: &Arc<Library>| Description { abi_version: library.abi_version(), models: library.models().to_vec() };
    say(&socket, &Answer::Loaded(loaded.as_ref().map(describe).map_err(Clone::clone)))?;
    let Ok(library) = loaded else {
        // The program has its answer and ends this process when it likes.
        while next()?.is_some() {}
        return Ok(());
    };
    while let Some(ask) = next()? {
        say(&socket, &answer(&library, &instances, ask))?;
    }
    Ok(())
}

/// Instances by number.
type Instances = Arc<RwLock<Vec<Option<Arc<PluginBrdf>>>>>;

fn answer(library: &Arc<Library>, instances: &Instances, ask: Ask) -> Answer {
    match ask {
        Ask::Create { index, arguments, bands, label } => {
            Answer::Created(create(library, instances, index, &arguments, &bands, label))
        }
        Ask::Destroy(id) => {
            let mut instances = instances.write().unwrap_or_else(PoisonError::into_inner);
            let gone = instances.get_mut(id as usize).and_then(Option::take);
            drop(instances);
            drop(gone);
            Answer::Destroyed
        }
        Ask::SelfCheck(id) => {
            let brdf = instances.read().unwrap_or_else(PoisonError::into_inner).get(id as usize).cloned().flatten();
            Answer::SelfChecked(brdf.map_or_else(Vec::new, |brdf| self_check(&brdf, SelfCheck::Warn)))
        }
        Ask::Manual => Answer::Manual(library.manual()),
        // A library is loaded only once.
        Ask::Messages | Ask::Load { .. } => Answer::Messages(library.take_messages()),
    }
}

fn create(
    library: &Arc<Library>,
    instances: &Instances,
    index: u32,
    arguments: &Arguments,
    bands: &[WireBand],
    label: Label,
) -> Result<(u32, u32), Error> {
    let bands: Vec<Band> = bands
        .iter()
        .filter_map(|band| <[f64; 3]>::try_from(&band.0[..]).ok())
        .map(|[centre_m, low_m, high_m]| Band { centre_m, low_m, high_m })
        .collect();
    let brdf = PluginBrdf::create_unchecked(Arc::clone(library), index, arguments, &bands, label)?;
    let flags = brdf.lobe_flags();
    let mut instances = instances.write().unwrap_or_else(PoisonError::into_inner);
    instances.push(Some(Arc::new(brdf)));
    Ok((instances.len() as u32 - 1, flags))
}

/// Answers the questions of one channel.
fn serve(channel: &super::channel::Channel, instances: &Instances) {
    let mut processor = None;
    loop {
        let (instance, call) = channel.next_question(&mut processor);
        let brdf = {
            let instances = instances.read().unwrap_or_else(PoisonError::into_inner);
            instances.get(instance as usize).cloned().flatten()
        };
        let (found, sampled) = match (&brdf, call) {
            (None, _) => (status::BAD_ARGUMENT, None),
            (Some(brdf), Call::Eval { outgoing, incident, values, pdfs }) => {
                (brdf.call_eval(outgoing, incident, values, pdfs), None)
            }
            (Some(brdf), Call::Sample { outgoing, u, weights }) => {
                let (found, sampled) = brdf.call_sample(outgoing, u, weights);
                (found, Some(sampled))
            }
        };
        // After the answer the program may destroy the instance.
        drop(brdf);
        channel.answer(found, sampled);
    }
}

/// Shows the program that this thread is making progress, although it has not answered for long.
fn show_progress(shared: SharedMemory) -> io::Result<()> {
    let calls = guard::count_calls();
    let show = move || loop {
        std::thread::sleep(super::PROGRESS_INTERVAL / 2);
        shared.progress().store(calls() as u32, Ordering::Relaxed);
    };
    std::thread::Builder::new().stack_size(64 << 10).spawn(show).map(drop)
}

/// Takes the socket from standard input, which is empty for plugins.
fn take_socket() -> io::Result<UnixStream> {
    let socket: OwnedFd = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdin(), LEAST_PRIVATE_DESCRIPTOR)?;
    rustix::stdio::dup2_stdin(File::open("/dev/null")?)?;
    Ok(UnixStream::from(socket))
}

/// Smallest private descriptor, above those that programs commonly use.
const LEAST_PRIVATE_DESCRIPTOR: i32 = 20;

fn say(mut socket: &UnixStream, answer: &Answer) -> io::Result<()> {
    socket.write_all((serde_json::to_string(answer)? + "\n").as_bytes())
}
