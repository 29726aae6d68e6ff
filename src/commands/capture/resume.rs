//! The checkpoint of a capture: a file beside its picture, from which `--resume` continues.

use crate::args::Capture;
use crate::failure::{Failure, Outcome, say};
use crate::input::Planned;
use crate::output::{file_path, write_file};
use crate::progress::Bar;
use crate::read_once;
use radsight_camera::CameraFile;
use radsight_capture::{Checkpoint, CheckpointError, Progress};
use radsight_output::{inputs, interrupt};
use radsight_pinhole::{BandWeights, Rays};
use radsight_render::RenderOptions;
use sha2::{Digest, Sha256};
use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Where the checkpoint of a capture is, and what it belongs to.
pub(super) struct CheckpointFile {
    /// `None` where the capture writes no file beside which it could be.
    path: Option<String>,
    key: [u8; 32],
    every: Duration,
    /// When the next one is due; `None` once one could not be saved.
    next: Mutex<Option<Instant>>,
}

impl CheckpointFile {
    /// For a capture of a scene.
    pub(super) fn new(
        arguments: &Capture,
        camera: &CameraFile,
        planned: &Planned,
        options: &RenderOptions,
    ) -> Result<CheckpointFile, Failure> {
        let path = path(arguments)?;
        let key = match &path {
            Some(_) => key(arguments, camera, planned, options)?,
            None => [0; 32],
        };
        let every = Duration::try_from_secs_f64(arguments.checkpoint_interval);
        let every = every.map_err(|_| {
            let seconds = arguments.checkpoint_interval;
            Failure::usage(format!("option \"--checkpoint-interval\" is {seconds}, expected seconds"))
        })?;
        if arguments.resume && path.is_none() {
            return Err(Failure::usage("option \"--resume\" needs a file to be written (-o or --exposure)"));
        }
        Ok(CheckpointFile { path, key, every, next: Mutex::new(Some(Instant::now() + every)) })
    }

    /// The checkpoint of an interrupted capture that is to be resumed.
    pub(super) fn read(
        &self,
        arguments: &Capture,
        rays: &Rays,
        weights: &BandWeights,
    ) -> Result<Option<Checkpoint>, Failure> {
        let Some(path) = &self.path else { return Ok(None) };
        match (read_once::owned(Path::new(path)), arguments.resume) {
            (Err(error), true) if error.kind() == io::ErrorKind::NotFound => {
                say(&format!("radsight: note: no checkpoint \"{path}\": starting anew\n"));
                Ok(None)
            }
            (Err(error), true) => Err(Failure::read(&format!("checkpoint \"{path}\""), &error)),
            (Ok(_), false) => {
                say(&format!("radsight: note: starting anew; --resume would go on from \"{path}\"\n"));
                Ok(None)
            }
            (Err(_), false) => Ok(None),
            (Ok(bytes), true) => {
                let read = Checkpoint::from_bytes(&bytes, &self.key, rays, weights);
                read.map(Some).map_err(|error: CheckpointError| {
                    Failure::input(format!(
                        "bad checkpoint \"{path}\": {error}\nhint: delete the file, or leave out --resume: the capture then starts anew"
                    ))
                })
            }
        }
    }

    /// Saves what is done, as far as there is a name for it; says whether.
    pub(super) fn save(&self, checkpoint: &Checkpoint) -> Result<bool, Failure> {
        let Some(path) = &self.path else { return Ok(false) };
        inputs::forget(Path::new(path));
        write_file(path, &checkpoint.to_bytes(&self.key)).map(|()| true)
    }

    /// Takes the checkpoint away: what it was for is there.
    pub(super) fn remove(&self) -> Outcome {
        let Some(path) = &self.path else { return Ok(()) };
        radsight_output::remove(Path::new(path))
            .map_err(|error| Failure::write(&format!("checkpoint \"{path}\""), &error))
    }

    fn is_due(&self) -> bool {
        self.path.is_some() && self.next().is_some_and(|next| Instant::now() >= next)
    }

    fn next(&self) -> std::sync::MutexGuard<'_, Option<Instant>> {
        self.next.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A name of its own beside the first file that the capture writes.
fn path(arguments: &Capture) -> Result<Option<String>, Failure> {
    for output in [&arguments.output, &arguments.exposure].into_iter().flatten() {
        if output != "-" && file_path(output)?.is_some() {
            let path = format!("{output}.checkpoint");
            arguments.reading.trust.check_link(&path)?;
            return Ok(Some(path));
        }
    }
    Ok(None)
}

/// All that decides what a ray gives: what was read, the camera, the options, this version.
fn key(
    arguments: &Capture,
    camera: &CameraFile,
    planned: &Planned,
    options: &RenderOptions,
) -> Result<[u8; 32], Failure> {
    let mut key = Sha256::new();
    key.update(env!("CARGO_PKG_VERSION"));
    key.update(format!("{:?} {options:?} {:?}", arguments.samples, camera.camera));
    key.update(format!("{:?} {:?}", camera.rig, camera.band_weights_for(planned.plan.bands())));
    if !camera.flickering.is_empty() {
        key.update(format!("{:?} {:?}", camera.shutter, camera.flickering));
    }
    key.update(format!("{:?}", arguments.reading.trust.replacements()));
    for text in planned.sources.texts() {
        key.update(Sha256::digest(text));
    }
    // The contents of the files, independent of their names and order.
    let mut files: Vec<[u8; 32]> = Vec::new();
    for name in inputs::names() {
        let bytes = read_once::owned(Path::new(&name));
        let bytes = bytes.map_err(|error| Failure::read(&format!("\"{name}\" again"), &error))?;
        files.push(Sha256::digest(bytes).into());
    }
    files.sort_unstable();
    files.iter().for_each(|file| key.update(file));
    Ok(key.finalize().into())
}

/// Shows how far the capture is, and saves it from time to time.
pub(super) struct Saving<'a> {
    pub(super) bar: &'a Bar,
    pub(super) file: &'a CheckpointFile,
}

impl Progress for Saving<'_> {
    fn report(&self, done: u64, total: u64) {
        self.bar.report(done, total);
    }

    fn stops(&self) -> bool {
        interrupt::is_asked()
    }

    fn wants_checkpoint(&self) -> bool {
        self.file.is_due()
    }

    fn save(&self, checkpoint: Checkpoint) {
        let saved = self.file.save(&checkpoint);
        // The capture does not end because its checkpoint cannot be saved.
        *self.file.next() = match saved {
            Ok(_) => Some(Instant::now() + self.file.every),
            Err(failure) => {
                say(&format!("radsight: note: no more checkpoints: {}\n", failure.message()));
                None
            }
        };
    }
}
