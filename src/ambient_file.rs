//! `-af`: an irradiance cache in a file, which runs and processes share.
//!
//! The file is read before irradiance is gathered. What was gathered is added to it before rays are answered, so that the next run with the same arguments
//! has the same cache and gives the same bits. Processes that share a file add to it in turn, and take over what others have added.

use crate::args::Reading;
use crate::failure::{Failure, Outcome, reason, say};
use crate::input::program_history;
use crate::output::file_path;
use radsight_output::SharedFile;
use radsight_picture::Header;
use radsight_render::{CacheError, Ray, RaySpacing, Renderer};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::PathBuf;

/// The `FORMAT=` of the file.
pub(crate) const FORMAT: &str = "radsight_irradiance_cache";

/// That of real Radiance's.
const RADIANCE_FORMAT: &str = "Radiance_ambval";

/// A batch of rays adds to the file when it and those before have found so many points, or this share of all: the file is written whole each time.
const FEWEST_NEW: usize = 64;
const SHARE_OF_ALL: usize = 4;

/// An irradiance cache, and the file that it is shared through, if there is one.
pub(crate) struct AmbientFile(Option<Shared>);

struct Shared {
    /// Of the program, for messages.
    program: String,
    name: String,
    path: PathBuf,
    scene: u64,
    header: Vec<u8>,
    /// The file as it is known here.
    known: Vec<u8>,
    /// Points that were found since.
    new: usize,
    /// Points in all.
    all: usize,
    access: Access,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    Shared,
    /// Values are taken from it, and none added.
    Read,
}

impl AmbientFile {
    /// Reads the file that the options name. `command` is the program with its options; `fingerprint` is that of [`crate::input::Planned`].
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
        let path = if renderer.caches_irradiance() { file_path(name)? } else { None };
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

    /// Gathers for rays what the cache does not have yet.
    pub(crate) fn gather(&mut self, renderer: &mut Renderer, rays: &[Option<Ray>], spread: RaySpacing) -> Outcome {
        let found = renderer.gather_irradiance(rays, spread);
        let Some(shared) = &mut self.0 else { return Ok(()) };
        shared.new += found;
        if shared.new >= FEWEST_NEW.max(shared.all / SHARE_OF_ALL) { shared.exchange(renderer) } else { Ok(()) }
    }

    /// Adds the rest of what was found. A picture does that before its rays are answered.
    pub(crate) fn settle(&mut self, renderer: &mut Renderer) -> Outcome {
        match &mut self.0 {
            Some(shared) if shared.new > 0 || shared.known.is_empty() => shared.exchange(renderer),
            _ => Ok(()),
        }
    }
}

impl Shared {
    /// Takes over the file's values.
    fn load(&mut self, bytes: Vec<u8>, renderer: &mut Renderer) -> Outcome {
        // Another process has just begun it.
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
                let what = "it holds ambient values of real Radiance, which are no records of an irradiance cache here";
                return Err(wrong(what.to_owned(), "name another file with -af; it is made where there is none"));
            }
            _ => return Err(wrong(CacheError::Unknown.to_string(), "name another file with -af")),
        }
        let loaded = renderer.load_irradiance_cache(&bytes[used..], self.scene);
        let hint = "remove it, or name another file with -af";
        self.all = loaded.map_err(|error| wrong(error.to_string(), hint))?;
        self.known = bytes;
        Ok(())
    }

    /// Takes over what others have added, and adds what was found here.
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
