//! `rfluxmtx`: the flux matrix from senders to receivers, by their directions; computed by
//! `rcontrib`.
//!
//! `rfluxmtx [-v] [-bj RANGE] [options of rcontrib] {SENDER|-} RECEIVER [-i SYSTEM.oct] [SYSTEM…]`:
//! with `-` rays come from standard input, and each gives a row of the matrix; otherwise `-c`
//! (default 10000) rays are sent per direction of the sender.

mod options;
mod surfaces;

use super::rcontrib;
use crate::expand::CommandWords;
use crate::failure::{Failure, Outcome, say};
use crate::trust::{Origin, Trust};
use options::Options;
use radsight_flux::{FluxError, Group, ReceiverWords, Sender};
use std::io::{self, Read};

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let mut options = Options::parse(words, trust)?;
    if !options.receiver.starts_with(['-', '!']) {
        options.trust.allow_outputs_beside(&options.receiver);
    }
    let receivers = surfaces::receivers(&options)?;
    if receivers.is_empty() {
        return Err(wrong(&options.receiver, &FluxError::Nothing));
    }
    let Some(path) = &options.sender else {
        let words = contribution_words(&options, &receivers, options.pass_through_words())?;
        return rcontrib::run_on(words, &options.trust, options.existing, io::stdin().lock());
    };
    let group = surfaces::sender(&options, path)?;
    let sender = Sender::new(&group, options.samples).map_err(|error| wrong(path, &error))?.with_seed(options.seed);
    if group.parameters.output.is_some() {
        options.warn("the output file of the sender is ignored");
    }
    let words = contribution_words(&options, &receivers, options.sampling_words(sender.bins()))?;
    if options.is_verbose {
        say(&format!("rfluxmtx: sampling {} directions\n", sender.bins()));
    }
    // A direction that no surface faces is found before any output.
    (0..sender.bins())
        .try_for_each(|bin| sender.ray(bin * options.samples).map(drop))
        .map_err(|error| wrong(path, &error))?;
    let rays = RayBytes { sender, number: 0, bytes: Vec::new(), read: 0 };
    rcontrib::run_on(words, &options.trust, options.existing, rays)
}

/// The command line of `rcontrib`. Outputs named by the user are overwritten as in Radiance, those
/// named by receivers are not.
fn contribution_words(options: &Options, receivers: &[Group], own: Vec<String>) -> Result<CommandWords, Failure> {
    let mut words = CommandWords::default();
    words.extend(["rcontrib", "-fo+"].map(str::to_owned), Origin::CommandLine);
    words.append(options.passed.clone());
    words.extend(own, Origin::CommandLine);
    let mut receiver_words = ReceiverWords::with_jitter(options.jitter.clone());
    for receiver in receivers {
        let output = receiver_words.of(receiver).map_err(|error| wrong(&options.receiver, &error))?;
        words.extend(output, Origin::File);
    }
    words.extend(options.system.iter().chain([&options.receiver]).cloned(), Origin::CommandLine);
    if options.is_verbose {
        say(&format!("rfluxmtx: running: {}\n", words.words().join(" ")));
    }
    Ok(words)
}

fn wrong(path: &str, error: &FluxError) -> Failure {
    Failure::input(format!("rfluxmtx: \"{path}\": {error}"))
}

/// The rays of a sender in the format that `rcontrib` reads: six doubles.
struct RayBytes {
    sender: Sender,
    /// The next ray.
    number: u64,
    bytes: Vec<u8>,
    /// Number of bytes read.
    read: usize,
}

/// Number of rays generated at a time.
const RAYS_AT_A_TIME: u64 = 1 << 10;

impl RayBytes {
    fn refill(&mut self) -> io::Result<()> {
        self.bytes.clear();
        self.read = 0;
        let end = self.sender.rays().min(self.number + RAYS_AT_A_TIME);
        for number in self.number..end {
            let (origin, direction) = self.sender.ray(number).map_err(io::Error::other)?;
            self.bytes.extend(origin.iter().chain(&direction).flat_map(|value| value.to_ne_bytes()));
        }
        self.number = end;
        Ok(())
    }
}

impl Read for RayBytes {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.read == self.bytes.len() {
            self.refill()?;
        }
        let count = into.len().min(self.bytes.len() - self.read);
        into[..count].copy_from_slice(&self.bytes[self.read..self.read + count]);
        self.read += count;
        Ok(count)
    }
}
