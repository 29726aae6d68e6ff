//! Writes a picture row by row, so that finished rows survive an interruption.
//!
//! A file is written under a hidden name. At a signal the finished rows get the file's name, marked
//! as partial in the header. `-ro` finds the leftover of a killed program.

use crate::failure::{Failure, Outcome, say};
use crate::output::{Output, file_path};
use radsight_output::interrupt::{ActionGuard, at_signal};
use radsight_output::leftovers;
use radsight_picture::{Header, Resolution, Unfinished};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The header variable with the finished part of a picture.
const PARTIAL: &str = "PARTIAL";

/// The leftover of an interrupted run.
#[derive(Debug)]
pub(super) struct Recovered {
    pub(super) header: Header,
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Number of finished rows.
    pub(super) done: usize,
    /// The finished rows as stored.
    pixels: Vec<u8>,
}

impl Recovered {
    /// Reads the longest unfinished picture with this name or hidden beside it; `None`, with a
    /// message, if there is none.
    pub(super) fn read(path: &str) -> Result<Option<Recovered>, Failure> {
        let left = hidden(path).iter().filter_map(|left| Recovered::read_file(left).ok()).max_by_key(|left| left.done);
        let named = match Recovered::read_file(Path::new(path)) {
            Ok(named) => Some(named),
            Err(Unreadable::File(error)) if error.kind() == ErrorKind::NotFound => None,
            // A leftover is better than a file that is not a picture.
            Err(_) if left.is_some() => None,
            Err(Unreadable::File(error)) => {
                return Err(Failure::read(&format!("recover file \"{path}\""), &error));
            }
            Err(Unreadable::Content(what)) => {
                return Err(Failure::input(format!("bad recover file \"{path}\": {what}")));
            }
        };
        let found = left.into_iter().chain(named).max_by_key(|found| found.done);
        if found.is_none() {
            say(&format!("rpict: warning - no recover file \"{path}\": starting anew\n"));
        }
        Ok(found)
    }

    fn read_file(path: &Path) -> Result<Recovered, Unreadable> {
        // The file may be rewritten, so it is not recorded as an input.
        let bytes = std::fs::read(path).map_err(Unreadable::File)?;
        let unfinished = Unfinished::read(&bytes).map_err(|error| Unreadable::Content(error.to_string()))?;
        let Resolution { width, height, .. } = unfinished.resolution;
        if unfinished.resolution != Resolution::standard(width, height) {
            return Err(Unreadable::Content("its rows do not run from the top left".to_owned()));
        }
        Ok(Recovered {
            columns: width,
            rows: height,
            done: unfinished.scanlines,
            pixels: unfinished.pixels.to_vec(),
            header: unfinished.header,
        })
    }
}

enum Unreadable {
    File(io::Error),
    Content(String),
}

/// The hidden files that killed runs have left.
fn hidden(name: &str) -> Vec<PathBuf> {
    file_path(name).ok().flatten().map_or_else(Vec::new, |target| leftovers(&target))
}

/// A picture being written.
pub(super) struct PictureWriter {
    rows: Arc<Mutex<Rows>>,
    /// Saves the finished rows at a signal.
    _saving: Option<ActionGuard>,
}

/// The output, shared with the signal handler.
struct Rows {
    /// `None` after the file got its name.
    picture: Option<Output>,
    name: String,
    /// The header of the picture.
    header: Header,
    resolution: Resolution,
    /// Size of the header and the resolution, bytes.
    start: usize,
    done: usize,
    replaces: Replaces,
    depths: Option<Output>,
}

/// Whether the picture may replace a file of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Replaces {
    Nothing,
    /// The recovered one.
    Recovered,
}

/// The start of a picture.
pub(super) struct Start<'a> {
    pub(super) header: &'a Header,
    pub(super) resolution: Resolution,
    pub(super) recovered: Option<&'a Recovered>,
    pub(super) replaces: Replaces,
}

impl PictureWriter {
    /// Writes header, resolution and recovered rows. An existing file is only replaced if it is the
    /// recovered one.
    pub(super) fn begin(output: Option<&str>, depths: Option<&str>, start: &Start<'_>) -> Result<Self, Failure> {
        let name = output.unwrap_or("-");
        let target = file_path(name)?;
        if start.replaces == Replaces::Nothing && target.as_ref().is_some_and(|target| target.exists()) {
            return Err(Failure::input(format!(
                "cannot open output file \"{name}\": it exists (-ro continues an unfinished picture)"
            )));
        }
        if start.recovered.is_none() && target.is_some_and(|target| !leftovers(&target).is_empty()) {
            say(&format!(
                "rpict: warning - the unfinished picture of a killed run of \"{name}\" is not used (-ro would continue it)\n"
            ));
        }
        let mut bytes = head(start.header, start.resolution);
        let header_bytes = bytes.len();
        let mut picture = Output::create(name)?;
        let done = start.recovered.map_or(0, |recovered| recovered.done);
        bytes.extend(start.recovered.iter().flat_map(|recovered| &recovered.pixels));
        picture.put(&bytes)?;
        let columns = start.resolution.scanline_length();
        let depths = depths.map(|name| begin_depths(name, columns * done)).transpose()?;
        let rows = Arc::new(Mutex::new(Rows {
            picture: Some(picture),
            name: name.to_owned(),
            header: start.header.clone(),
            resolution: start.resolution,
            start: header_bytes,
            done,
            replaces: start.replaces,
            depths,
        }));
        // Output to a pipe cannot be saved.
        let saved = Arc::clone(&rows);
        let saving = (name != "-").then(|| at_signal(move || lock(&saved).save()));
        Ok(PictureWriter { rows, _saving: saving })
    }

    /// Whether distances are requested.
    pub(super) fn wants_depths(&self) -> bool {
        lock(&self.rows).depths.is_some()
    }

    /// Appends rows of the picture and, if requested, of distances, and flushes them.
    pub(super) fn write(&mut self, rows: usize, bytes: &[u8], depths: &[f32]) -> Outcome {
        let mut to = lock(&self.rows);
        let Some(picture) = &mut to.picture else { return Ok(()) };
        let written = picture.put(bytes);
        let written = written.and_then(|()| to.depths.as_mut().map_or(Ok(()), |to| to.put(&stored(depths))));
        match written {
            Ok(()) => to.done += rows,
            // A full disk must not destroy finished rows.
            Err(_) => [to.picture.take(), to.depths.take()].into_iter().flatten().for_each(Output::keep),
        }
        written
    }

    /// Gives the files their names.
    pub(super) fn finish(self) -> Outcome {
        let mut rows = lock(&self.rows);
        let replaces = rows.replaces;
        if let Some(depths) = rows.depths.take() {
            depths.commit()?;
        }
        match (rows.picture.take(), replaces) {
            (None, _) => Ok(()),
            (Some(picture), Replaces::Recovered) => picture.commit(),
            (Some(picture), Replaces::Nothing) => picture.commit_new(),
        }
    }
}

fn lock(rows: &Mutex<Rows>) -> MutexGuard<'_, Rows> {
    rows.lock().unwrap_or_else(PoisonError::into_inner)
}

fn head(header: &Header, resolution: Resolution) -> Vec<u8> {
    let mut bytes = header.to_bytes();
    bytes.extend_from_slice(format!("{resolution}\n").as_bytes());
    bytes
}

fn stored(depths: &[f32]) -> Vec<u8> {
    depths.iter().flat_map(|depth| depth.to_ne_bytes()).collect()
}

impl Rows {
    /// Gives the finished rows their name, marked as partial. Nothing is saved if no row is
    /// finished or a file of the name exists.
    fn save(&mut self) {
        let Some(picture) = self.picture.take() else { return };
        let Some(path) = picture.hidden_path() else { return };
        let total = self.resolution.scanlines();
        if self.done == 0 {
            return;
        }
        let mut header = self.header.clone();
        header.push_variable(PARTIAL, &format!(" {} of {total} rows", self.done));
        let mut bytes = head(&header, self.resolution);
        let saved = std::fs::read(path).map_err(|error| Failure::read("what is done", &error)).and_then(|done| {
            bytes.extend_from_slice(done.get(self.start..).unwrap_or_default());
            let mut output = Output::create(&self.name)?;
            output.put(&bytes)?;
            match self.replaces {
                Replaces::Nothing => output.commit_new(),
                Replaces::Recovered => output.commit(),
            }
        });
        let saved = saved.and_then(|()| self.depths.take().map_or(Ok(()), Output::commit));
        match saved {
            Ok(()) => say(&format!(
                "rpict: interrupted: \"{}\" has {} of {total} rows (-ro continues it)\n",
                self.name, self.done
            )),
            Err(failure) => say(&format!("{}\n", failure.message())),
        }
    }
}

/// Opens the file for distances and keeps those of finished pixels.
fn begin_depths(name: &str, pixels_done: usize) -> Result<Output, Failure> {
    let mut output = Output::create(name)?;
    if pixels_done > 0 {
        let places = hidden(name).into_iter().chain([PathBuf::from(name)]);
        let mut kept = places.filter_map(|path| std::fs::read(path).ok()).max_by_key(Vec::len).unwrap_or_default();
        kept.resize(pixels_done * size_of::<f32>(), 0);
        output.put(&kept)?;
    }
    Ok(output)
}
