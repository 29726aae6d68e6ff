//! A loaded plugin library: its entry, its models, its log.

use crate::guard::{self, Breadcrumb};
use crate::isolate::{Isolation, Worker};
use crate::{Error, Label, ModelInfo, ParameterInfo, ParameterKind, Range, object_file, search};
use radsight_brdf_abi as abi;
use radsight_brdf_abi::{kind, parameter_flags};
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A plugin library, loaded in this process or in one of its own. It stays loaded until that
/// process ends, because its code may have threads, hooks and destructors.
pub struct Library {
    name: String,
    path: PathBuf,
    abi_version: (u32, u32),
    models: Vec<ModelInfo>,
    home: Home,
}

/// Process of a library's code.
pub(crate) enum Home {
    /// In this process.
    Here(Loaded),
    /// In a process of its own.
    There(Worker),
}

/// A library in this process.
pub(crate) struct Loaded {
    entry: abi::Entry,
    host: Box<LibraryHost>,
    /// Held during functions that the interface marks as [one thread].
    one_thread: Mutex<()>,
}

// SAFETY: the entry holds pointers to functions and constants; functions marked [one thread] are
// called under the mutex only.
unsafe impl Send for Loaded {}
// SAFETY: as above.
unsafe impl Sync for Loaded {}

/// The model and material that need a library, for messages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct User<'a> {
    pub(crate) model: &'a str,
    pub(crate) label: &'a Label,
}

impl std::fmt::Debug for Library {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.debug_struct("Library").field("name", &self.name).field("path", &self.path).finish_non_exhaustive()
    }
}

/// Maximum number of messages of a library, so that a plugin that logs at every call does not fill
/// the memory.
const MESSAGES_KEPT: usize = 100;
/// A table with more models or parameters counts as broken.
const MOST_ROWS: u32 = 4096;
/// Maximum length of a text; longer ones are cut.
const LONGEST_TEXT: usize = 1 << 16;

/// A message that a plugin logged.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Message {
    /// 0 note, 1 warning, 2 error.
    pub level: u32,
    /// The text.
    pub text: String,
}

/// The host structure visible to a plugin, followed by private data.
#[repr(C)]
struct LibraryHost {
    visible: abi::Host,
    messages: Mutex<Vec<Message>>,
}

impl Library {
    /// Loads the library in the file `path`.
    ///
    /// This runs the library's code: load only libraries that the user trusts like a program.
    ///
    /// # Errors
    /// If the file is not a plugin for this program and machine, or its tables violate the
    /// interface.
    pub fn load(path: &Path) -> Result<Library, Error> {
        Self::load_for(path, None, None)
    }

    /// As [`Library::load`], in a process of its own if `isolation` is given.
    pub(crate) fn load_for(
        path: &Path,
        user: Option<User<'_>>,
        isolation: Option<&Isolation>,
    ) -> Result<Library, Error> {
        object_file::examine(path)?;
        let name = search::library_name(path)
            .unwrap_or_else(|| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default());
        let crumb = |activity| match user {
            Some(User { model, label }) => Breadcrumb::for_model(&name, model, &label.material, &label.place, activity),
            None => Breadcrumb::for_library(&name, activity),
        };
        if let Some(isolation) = isolation {
            let (worker, description) = Worker::start(isolation, path, &name, user, crumb("load"))?;
            let (abi_version, models) = (description.abi_version, description.models);
            return Ok(Library { name, path: path.to_owned(), abi_version, models, home: Home::There(worker) });
        }
        guard::note_library(&name);
        let entry = {
            let _trail = guard::enter(crumb("load"));
            load_entry(path)?
        };
        guard::after_load(crumb("load"));
        let describing = ["count", "describe"].map(crumb);
        Self::of_entry(name, path, entry, describing)
    }

    /// A library that is already part of this program, such as one of a test: no file is searched
    /// or opened.
    ///
    /// # Errors
    /// If its entry or tables violate the interface.
    ///
    /// # Safety
    /// `entry` points to an entry that lives as long as the process and follows the header
    /// `radsight_brdf.h`.
    pub unsafe fn in_program(name: &str, entry: *const abi::Entry) -> Result<Library, Error> {
        let path = Path::new(name);
        // SAFETY: the caller's promise.
        let entry = unsafe { read_entry(path, entry.cast()) }?;
        let describing = ["count", "describe"].map(|function| Breadcrumb::for_library(name, function));
        Self::of_entry(name.to_owned(), path, entry, describing)
    }

    fn of_entry(name: String, path: &Path, entry: abi::Entry, describing: [Breadcrumb; 2]) -> Result<Library, Error> {
        let models = read_models(&name, &entry, describing)?;
        let host = Box::new(LibraryHost {
            visible: abi::Host {
                struct_size: size_of::<abi::Host>() as u32,
                abi_major: abi::ABI_MAJOR,
                abi_minor: abi::ABI_MINOR,
                reserved: 0,
                log: Some(host_log),
                extension: Some(host_extension),
            },
            messages: Mutex::default(),
        });
        let abi_version = (entry.abi_major, entry.abi_minor);
        let home = Home::Here(Loaded { entry, host, one_thread: Mutex::default() });
        Ok(Library { name, path: path.to_owned(), abi_version, models, home })
    }

    /// Name of the library.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// File of the library.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Major and minor version of the interface for which it was built.
    #[must_use]
    pub fn abi_version(&self) -> (u32, u32) {
        self.abi_version
    }

    /// Models in the order of their indices.
    #[must_use]
    pub fn models(&self) -> &[ModelInfo] {
        &self.models
    }

    /// Index and description of the model with this name.
    ///
    /// # Errors
    /// If there is no such model.
    pub fn model(&self, name: &str) -> Result<(u32, &ModelInfo), Error> {
        let names = || self.models.iter().map(|model| model.name.as_str());
        match self.models.iter().position(|model| model.name == name) {
            Some(index) => Ok((index as u32, &self.models[index])),
            None => Err(Error::UnknownModel {
                library: self.name.clone(),
                model: name.to_owned(),
                known: names().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", "),
                similar: radsight_diag::nearest(name, names()).map(str::to_owned),
            }),
        }
    }

    /// The library's extension of this name and revision; null if there is none, or if the library
    /// is in another process. The memory belongs to the plugin and lives as long as the process.
    #[must_use]
    pub fn extension(&self, name: &CStr, revision: u32) -> *const c_void {
        let Some(extension) = self.loaded().and_then(|loaded| loaded.entry.extension) else { return std::ptr::null() };
        let _trail = guard::enter(Breadcrumb::for_library(&self.name, "extension"));
        // SAFETY: any thread may call it, with a C string.
        unsafe { extension(name.as_ptr(), revision) }
    }

    /// Manual page of the library, if it has one.
    #[must_use]
    pub fn manual(&self) -> Option<String> {
        if let Home::There(worker) = &self.home {
            return worker.manual();
        }
        let text = self.extension(c"radsight.manual", 1).cast::<c_char>();
        // SAFETY: the header says that this extension is null or a C string that lives as long as
        // the library.
        let text = unsafe { text_at(text) };
        (!text.is_empty()).then_some(text)
    }

    /// Messages logged since the last call.
    #[must_use]
    pub fn take_messages(&self) -> Vec<Message> {
        match &self.home {
            Home::Here(loaded) => {
                std::mem::take(&mut *loaded.host.messages.lock().unwrap_or_else(PoisonError::into_inner))
            }
            Home::There(worker) => worker.take_messages(),
        }
    }

    pub(crate) fn home(&self) -> &Home {
        &self.home
    }

    /// The library, if it is in this process.
    pub(crate) fn loaded(&self) -> Option<&Loaded> {
        match &self.home {
            Home::Here(loaded) => Some(loaded),
            Home::There(_) => None,
        }
    }
}

impl Loaded {
    pub(crate) fn entry(&self) -> &abi::Entry {
        &self.entry
    }

    pub(crate) fn host(&self) -> *const abi::Host {
        // Pointer to the whole structure, so that `host_log` can access the private part.
        std::ptr::from_ref(&*self.host).cast()
    }

    pub(crate) fn one_thread(&self) -> MutexGuard<'_, ()> {
        self.one_thread.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

unsafe extern "C" fn host_log(host: *const abi::Host, level: u32, text: *const c_char) {
    // SAFETY: plugins pass the pointer that they got, which leads to a `LibraryHost`, and a C
    // string.
    let (host, text) = unsafe { (host.cast::<LibraryHost>().as_ref(), text_at(text)) };
    let Some(host) = host else { return };
    let mut messages = host.messages.lock().unwrap_or_else(PoisonError::into_inner);
    if messages.len() < MESSAGES_KEPT {
        messages.push(Message { level, text });
    }
}

unsafe extern "C" fn host_extension(_: *const abi::Host, _name: *const c_char, _revision: u32) -> *const c_void {
    std::ptr::null()
}

/// Opens the file and copies the part of its entry that both sides know.
fn load_entry(path: &Path) -> Result<abi::Entry, Error> {
    // SAFETY: runs the library's initialisers, which the user asked for by naming it.
    let library = unsafe { libloading::Library::new(path) }.map_err(|error| {
        use std::error::Error as _;
        let reason = error.source().map_or_else(|| error.to_string(), ToString::to_string);
        Error::CannotLoad { path: path.to_owned(), reason }
    })?;
    // The library is never unloaded.
    let library = std::mem::ManuallyDrop::new(library);
    // SAFETY: the symbol is a constant; its type is only relied on as far as its magic and sizes
    // have been checked.
    let symbol = unsafe { library.get::<*const u8>(abi::ENTRY_SYMBOL) }
        .map_err(|_| Error::MissingEntry { path: path.to_owned() })?;
    // SAFETY: what the file exports under this name is an entry, and the library stays.
    unsafe { read_entry(path, *symbol) }
}

/// Copies the part of an entry that both sides know.
///
/// # Safety
/// `entry` points to an entry of any version.
unsafe fn read_entry(path: &Path, entry: *const u8) -> Result<abi::Entry, Error> {
    // SAFETY: it leads to at least its first eight bytes in a mapped page; reads are unaligned.
    let magic = unsafe { entry.cast::<u64>().read_unaligned() };
    if magic != abi::MAGIC {
        return Err(Error::WrongMagic { path: path.to_owned(), found: magic, expected: abi::MAGIC });
    }
    // SAFETY: behind the magic stand the versions and the size in every version of the interface.
    let field = |offset: usize| unsafe { entry.add(offset).cast::<u32>().read_unaligned() };
    let major = field(std::mem::offset_of!(abi::Entry, abi_major));
    let minor = field(std::mem::offset_of!(abi::Entry, abi_minor));
    if major != abi::ABI_MAJOR {
        let (expected, host_minor) = (abi::ABI_MAJOR, abi::ABI_MINOR);
        return Err(Error::WrongMajor { path: path.to_owned(), found: major, minor, expected, host_minor });
    }
    let size = field(std::mem::offset_of!(abi::Entry, struct_size)) as usize;
    let broken = |what: String| Err(Error::BrokenRule { library: path.display().to_string(), what });
    if size < abi::ENTRY_BYTES_1_0 {
        return broken(format!("struct_size of the entry is {size}, expected at least {}", abi::ENTRY_BYTES_1_0));
    }
    // SAFETY: the plugin's entry has `size` bytes; what it lacks stays zero, which is `None`.
    let entry = unsafe { copy_known::<abi::Entry>(entry, size) };
    if entry.count.is_none() || entry.describe.is_none() || entry.create.is_none() {
        return broken("the entry lacks count, describe or create".to_owned());
    }
    Ok(entry)
}

/// Calls the library's `count` and `describe`, with their breadcrumbs.
fn read_models(
    library: &str,
    entry: &abi::Entry,
    [counting, describing]: [Breadcrumb; 2],
) -> Result<Vec<ModelInfo>, Error> {
    let broken = |what: String| Error::BrokenRule { library: library.to_owned(), what };
    let (Some(count), Some(describe)) = (entry.count, entry.describe) else {
        return Err(broken("the entry lacks count or describe".to_owned()));
    };
    let count = {
        let _trail = guard::enter(counting);
        // SAFETY: nothing else of this library runs yet.
        unsafe { count() }
    };
    guard::after_call(counting);
    if count == 0 || count > MOST_ROWS {
        return Err(broken(format!("it has {count} models, expected 1 to {MOST_ROWS}")));
    }
    let mut models: Vec<ModelInfo> = Vec::new();
    for index in 0..count {
        let trail = guard::enter(describing);
        // SAFETY: as above.
        let descriptor = unsafe { describe(index) };
        if descriptor.is_null() {
            return Err(broken(format!("describe({index}) returns NULL, but count() is {count}")));
        }
        // SAFETY: the plugin's descriptor lives as long as the library.
        let model = unsafe { read_model(descriptor) }.map_err(|what| broken(format!("model {index}: {what}")))?;
        drop(trail);
        if models.iter().any(|other| other.name == model.name) {
            return Err(broken(format!("two models have the name \"{}\"", model.name)));
        }
        models.push(model);
    }
    guard::after_call(describing);
    Ok(models)
}

/// # Safety
/// `descriptor` leads to a model's descriptor of any minor version.
unsafe fn read_model(descriptor: *const abi::Model) -> Result<ModelInfo, String> {
    // SAFETY: each version begins with the size.
    let size = unsafe { descriptor.cast::<u32>().read() } as usize;
    if size < size_of::<abi::Model>() {
        return Err(format!("struct_size is {size}, expected at least {}", size_of::<abi::Model>()));
    }
    // SAFETY: the descriptor has `size` bytes, and its strings are C strings or null.
    let (model, name, summary, citation) = unsafe {
        let model = copy_known::<abi::Model>(descriptor.cast(), size);
        (model, text_at(model.name), text_at(model.summary), text_at(model.citation))
    };
    if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-') {
        return Err(format!("its name is \"{name}\", expected letters, digits, \"_\" and \"-\""));
    }
    if model.parameter_count > MOST_ROWS || (model.parameter_count > 0 && model.parameters.is_null()) {
        return Err(format!("its table of {} parameters is broken", model.parameter_count));
    }
    let stride = model.parameter_size as usize;
    if model.parameter_count > 0 && (stride < size_of::<abi::Parameter>() || !stride.is_multiple_of(8)) {
        return Err(format!("parameter_size is {stride}, expected at least {}", size_of::<abi::Parameter>()));
    }
    let mut parameters = Vec::new();
    for index in 0..model.parameter_count as usize {
        // SAFETY: the table has `parameter_count` rows of `stride` bytes, whose strings are C
        // strings or null.
        let row = unsafe {
            let at = model.parameters.cast::<u8>().add(index * stride);
            read_parameter(&copy_known::<abi::Parameter>(at, stride))
        };
        parameters.push(row.map_err(|what| format!("parameter {index}: {what}"))?);
    }
    let after_optional = |word: bool| {
        let mut rows = parameters.iter().filter(|row| (row.scene_numbers() == 0) == word);
        rows.by_ref().find(|row| row.optional);
        rows.find(|row| !row.optional)
    };
    if let Some(row) = after_optional(true).or(after_optional(false)) {
        return Err(format!("parameter \"{}\" is required but follows one that may be left out", row.name));
    }
    Ok(ModelInfo { name, summary, citation, flags: model.flags, parameters })
}

/// # Safety
/// The strings of `row` are C strings or null.
unsafe fn read_parameter(row: &abi::Parameter) -> Result<ParameterInfo, String> {
    // SAFETY: the caller's promise.
    let (name, unit, doc, default_word, choices) = unsafe {
        (text_at(row.name), text_at(row.unit), text_at(row.doc), text_at(row.default_word), text_at(row.choices))
    };
    let kind = match row.kind {
        kind::NUMBER => ParameterKind::Number,
        kind::INTEGER => ParameterKind::Integer,
        kind::SPECTRUM => ParameterKind::Spectrum,
        kind::WORD => ParameterKind::Word,
        kind::CHOICE => ParameterKind::Choice(choices.split('|').map(str::to_owned).collect()),
        kind::FILE => ParameterKind::File,
        other => return Err(format!("its kind is {other}, which this program does not know")),
    };
    if name.is_empty() {
        return Err("it has no name".to_owned());
    }
    if row.minimum.is_nan() || row.maximum.is_nan() || row.minimum > row.maximum {
        return Err(format!("the range of \"{name}\" is {} to {}", row.minimum, row.maximum));
    }
    let range = Range { minimum: row.minimum, maximum: row.maximum, flags: row.flags };
    let optional = row.flags & parameter_flags::OPTIONAL != 0;
    Ok(ParameterInfo { name, unit, doc, kind, optional, default_number: row.default_number, default_word, range })
}

/// Copies the part of a structure that both sides know; the rest is zero.
///
/// # Safety
/// `source` points to `size` bytes of a `T` of any minor version, and all-zero is a valid `T`.
unsafe fn copy_known<T: Copy>(source: *const u8, size: usize) -> T {
    let mut copy = std::mem::MaybeUninit::<T>::zeroed();
    // SAFETY: at most the size of either side is copied.
    unsafe {
        std::ptr::copy_nonoverlapping(source, copy.as_mut_ptr().cast::<u8>(), size.min(size_of::<T>()));
        copy.assume_init()
    }
}

/// The text at a pointer; empty if it is null.
///
/// # Safety
/// `pointer` is null or points to a C string.
pub(crate) unsafe fn text_at(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    let bytes = unsafe { CStr::from_ptr(pointer) }.to_bytes();
    String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST_TEXT)]).into_owned()
}

/// C strings for `create`.
pub(crate) fn c_strings(words: &[String]) -> Vec<CString> {
    words.iter().map(|word| CString::new(word.as_str()).unwrap_or_default()).collect()
}
