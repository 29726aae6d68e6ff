//! Records the files of a scene, so that it can be read again elsewhere.

use radsight_loader::{FileKind, LoadError, Loaded, Loader, MemoryLoader};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Forwards to another loader and records its files, so that a scene can be sent with all files
/// that it names.
///
/// ```
/// use radsight::{FileKind, Loader, MemoryLoader, RecordingLoader, Scene};
/// let text = "void brightfunc dim 2 half half.cal 0 0 dim glow panel 0 0 4 2 2 2 0 panel sphere s 0 0 4 0 0 0 1";
/// let recorder = RecordingLoader::new(MemoryLoader::default().with("half.cal", "half = .5;"));
/// Scene::builder().loader(recorder.clone()).text("panel.rad", text).build()?;
/// let elsewhere = recorder.files();
/// assert_eq!(elsewhere.load("half.cal", FileKind::Function)?.bytes, b"half = .5;");
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct RecordingLoader<L> {
    loader: L,
    /// Shared by all clones.
    files: Arc<Mutex<BTreeMap<String, Vec<u8>>>>,
}

impl<L: Loader> RecordingLoader<L> {
    /// Forwards to a loader.
    #[must_use]
    pub fn new(loader: L) -> RecordingLoader<L> {
        RecordingLoader { loader, files: Arc::default() }
    }

    /// All recorded files, by the requested names.
    #[must_use]
    pub fn files(&self) -> MemoryLoader {
        let files = self.named_files().into_iter();
        files.fold(MemoryLoader::default(), |loader, (name, bytes)| loader.with(&name, bytes))
    }

    /// The same files as names and contents.
    ///
    /// ```
    /// use radsight::{FileKind, Loader, MemoryLoader, RecordingLoader};
    /// let recorder = RecordingLoader::new(MemoryLoader::default().with("a.cal", "a = 1;").with("b.cal", "b = 2;"));
    /// recorder.load("a.cal", FileKind::Function)?;
    /// assert_eq!(recorder.named_files(), [("a.cal".to_owned(), b"a = 1;".to_vec())]);
    /// # Ok::<(), radsight::LoadError>(())
    /// ```
    #[must_use]
    pub fn named_files(&self) -> Vec<(String, Vec<u8>)> {
        let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.iter().map(|(name, bytes)| (name.clone(), bytes.clone())).collect()
    }
}

impl<L: Loader> Loader for RecordingLoader<L> {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        let loaded = self.loader.load(name, kind)?;
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.insert(name.to_owned(), loaded.bytes.clone());
        Ok(loaded)
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        self.loader.names_like(pattern)
    }

    fn shuffle_seed(&self) -> u64 {
        self.loader.shuffle_seed()
    }

    fn run_command(&self, command: &str, standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        self.loader.run_command(command, standard_input)
    }
}
