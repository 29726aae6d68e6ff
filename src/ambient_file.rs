//! `-af`: an irradiance cache in a file, shared by runs and processes.
//!
//! The file is read before irradiance is gathered. New records are added to it before rays are
//! traced, so the next run with the same arguments has the same cache and gives the same bits.
//! Processes that share a file add to it in turn and load the records of others.

use crate::args::Reading;
use crate::failure::{Failure, Outcome, reason, say};
use crate::input::program_history;
use crate::output::reserve_output;
use radsight_output::SharedFile;
use radsight_picture::Header;
use radsight_render::{CacheError, Ray, RaySpacing, Renderer};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::PathBuf;

/// The `FORMAT=` of the file.
pub(crate) const FORMAT: &str = "radsight_irradiance_cache";

/// The `FORMAT=` of real Radiance's ambient files.
const RADIANCE_FORMAT: &str = "Radiance_ambval";

/// A batch of rays adds to the file when this many new records exist, or this share of all, since
/// the whole file is rewritten each time.
const FEWEST_NEW: usize = 64;
const SHARE_OF_ALL: usize = 4;

/// An irradiance cache with the file through which it is shared, if any.
pub(crate) struct AmbientFile(Option<Shared>);

struct Shared {
    /// Name of the program, for messages.
    program: String,
    name: String,
    path: PathBuf,
    scene: u64,
    header: Vec<u8>,
    /// The last known content of the file.
    known: Vec<u8>,
    /// Number of records since then.
    new: usize,
    /// Total number of records.
    all: usize,
    access: Access,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    Shared,
    /// The file is read but not written.
    Read,
}

impl AmbientFile {
    /// Reads the file named by the options. `command` is the program with its options;
    /// `fingerprint` is that of [`crate::input::Planned`].
    pub(crate) fn open(
        reading: &Reading,
        (command, scenes): (&[String], &[String]),
        fingerprint: Option<u64>,
        renderer: &mut Renderer,
    ) -> Result<AmbientFile, Failure> {
        let (Some(name), Some(scene)) = (reading.ambient_file.as_deref(), fingerprint) else {
            return Ok(AmbientFile(None));
        };
        let program = command.first().map_or("radsight", String::as_str).to_owned();
        if renderer.plan().options.gathering.accuracy <= 0.0 && !reading.no_warnings {
            say(&format!("{program}: warning - zero ambient accuracy so \"{name}\" not opened\n"));
        }
        let path = if renderer.caches_irradiance() { reserve_output(name)? } else { None };
        let Some(path) = path else { return Ok(AmbientFile(None)) };
        let mut header = program_history(scenes, command);
        header.push_variable("FORMAT", FORMAT);
        let mut shared = Shared {
            program,
            name: name.to_owned(),
            path,
            scene,
            header: header.to_bytes(),
            known: Vec::new(),
            new: 0,
            all: 0,
            access: Access::Shared,
        };
        match fs::read(&shared.path) {
            Ok(bytes) => shared.load(bytes, renderer)?,
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(Failure::read(&format!("ambient file \"{name}\""), &error)),
        }
        Ok(AmbientFile(Some(shared)))
    }

    /// Gathers the irradiance that rays need and the cache lacks.
    pub(crate) fn gather(&mut self, renderer: &mut Renderer, rays: &[Option<Ray>], spread: RaySpacing) -> Outcome {
        let found = renderer.gather_irradiance(rays, spread);
        let Some(shared) = &mut self.0 else { return Ok(()) };
        shared.new += found;
        if shared.new >= FEWEST_NEW.max(shared.all / SHARE_OF_ALL) { shared.exchange(renderer) } else { Ok(()) }
    }

    /// Adds the remaining new records. A picture does this before its rays are traced.
    pub(crate) fn settle(&mut self, renderer: &mut Renderer) -> Outcome {
        match &mut self.0 {
            Some(shared) if shared.new > 0 || shared.known.is_empty() => shared.exchange(renderer),
            _ => Ok(()),
        }
    }
}

impl Shared {
    /// Loads the records of the file.
    fn load(&mut self, bytes: Vec<u8>, renderer: &mut Renderer) -> Outcome {
        // Another process has just created it.
        if bytes.is_empty() {
            return Ok(());
        }
        let wrong =
            |what: String, hint: &str| Failure::input(format!("ambient file \"{}\": {what}\nhint: {hint}", self.name));
        let Ok((header, used)) = Header::read(&bytes) else {
            return Err(wrong(CacheError::Unknown.to_string(), "name another file with -af"));
        };
        match header.format().as_deref() {
            Some(FORMAT) => {}
            Some(RADIANCE_FORMAT) => {
                let what = "it holds ambient values of real Radiance, expected an irradiance cache of radsight";
                return Err(wrong(what.to_owned(), "name another file with -af; it is created if it does not exist"));
            }
            _ => return Err(wrong(CacheError::Unknown.to_string(), "name another file with -af")),
        }
        let loaded = renderer.load_irradiance_cache(&bytes[used..], self.scene);
        let hint = "remove it, or name another file with -af";
        self.all = loaded.map_err(|error| wrong(error.to_string(), hint))?;
        self.known = bytes;
        Ok(())
    }

    /// Loads the records that others have added, and adds the new ones.
    fn exchange(&mut self, renderer: &mut Renderer) -> Outcome {
        if self.access == Access::Read {
            return Ok(());
        }
        let failed = |name: &str, error: &io::Error| Failure::write(&format!("ambient file \"{name}\""), error);
        let mut file = match SharedFile::lock(&self.path) {
            Ok(file) => file,
            Err(error) if is_read_only(&error) && !self.known.is_empty() => {
                self.access = Access::Read;
                say(&format!(
                    "{}: note: ambient file \"{}\" is read only: {}\n",
                    self.program,
                    self.name,
                    reason(&error)
                ));
                return Ok(());
            }
            Err(error) => return Err(failed(&self.name, &error)),
        };
        let there = file.read().map_err(|error| failed(&self.name, &error))?;
        if there != self.known {
            self.load(there, renderer)?;
        }
        let Some(cache) = renderer.save_irradiance_cache(self.scene) else { return Ok(()) };
        let bytes = [self.header.as_slice(), &cache].concat();
        file.replace(&bytes).map_err(|error| failed(&self.name, &error))?;
        (self.all, self.new, self.known) = (self.all + self.new, 0, bytes);
        Ok(())
    }
}

fn is_read_only(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem)
}
