//! The interface layer: C calls enter, safe Rust is called, no panic leaves.

use crate::{CreateError, Description, EvalBatch, Model, Parameters, Sample};
use glam::DVec3;
use radsight_brdf_abi as abi;
use radsight_brdf_abi::{sample_kind, status};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicPtr, AtomicU32, Ordering};
use std::sync::{Once, OnceLock};

/// The exported constant.
#[repr(transparent)]
#[derive(Debug)]
pub struct EntryConstant(pub abi::Entry);

// SAFETY: an `Entry` is numbers and pointers to functions.
unsafe impl Sync for EntryConstant {}

impl EntryConstant {
    /// The entry for this version of the interface.
    #[must_use]
    pub const fn new(
        count: abi::CountFn,
        describe: abi::DescribeFn,
        create: abi::CreateFn,
        extension: abi::ExtensionFn,
    ) -> Self {
        EntryConstant(abi::Entry {
            magic: abi::MAGIC,
            abi_major: abi::ABI_MAJOR,
            abi_minor: abi::ABI_MINOR,
            struct_size: size_of::<abi::Entry>() as u32,
            reserved: 0,
            count: Some(count),
            describe: Some(describe),
            create: Some(create),
            extension: Some(extension),
        })
    }
}

/// The monomorphic functions of one model.
#[derive(Clone, Copy, Debug)]
pub struct ModelFunctions {
    description: Description,
    create: fn(&Parameters<'_>) -> Result<Made, CreateError>,
    eval_pdf: abi::EvalFn,
    sample: abi::SampleFn,
    destroy: abi::DestroyFn,
}

/// The functions of `M`.
#[must_use]
pub const fn model_functions<M: Model>() -> ModelFunctions {
    ModelFunctions {
        description: M::DESCRIPTION,
        create: make::<M>,
        eval_pdf: eval_pdf::<M>,
        sample: sample::<M>,
        destroy: destroy::<M>,
    }
}

/// All models of a library.
#[derive(Debug)]
pub struct Table {
    models: &'static [ModelFunctions],
    manual: &'static str,
    described: OnceLock<Described>,
}

#[derive(Debug)]
struct Described {
    models: Vec<abi::Model>,
    manual: CString,
}

// SAFETY: the pointers in the descriptors lead to leaked, immutable memory.
unsafe impl Send for Described {}
// SAFETY: as above.
unsafe impl Sync for Described {}

impl Table {
    /// A table of models and a manual page.
    #[must_use]
    pub const fn new(models: &'static [ModelFunctions], manual: &'static str) -> Self {
        Table { models, manual, described: OnceLock::new() }
    }

    fn described(&self) -> &Described {
        self.described.get_or_init(|| Described {
            models: self.models.iter().map(|model| describe_model(&model.description)).collect(),
            manual: c_string(&manual_page(self.manual)),
        })
    }
}

/// The leading `//!` lines of a Rust source file as plain text; other text unchanged.
fn manual_page(text: &str) -> String {
    if !text.starts_with("//!") {
        return text.to_owned();
    }
    let lines = text.lines().map_while(|line| line.strip_prefix("//!"));
    lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).fold(String::new(), |page, line| page + line + "\n")
}

/// Number of models.
pub fn count(table: &'static Table) -> u32 {
    table.models.len() as u32
}

/// Descriptor of a model, or null.
pub fn describe(table: &'static Table, index: u32) -> *const abi::Model {
    let describe = || table.described().models.get(index as usize).map_or(std::ptr::null(), std::ptr::from_ref);
    catch_unwind(describe).unwrap_or(std::ptr::null())
}

/// The manual page, or null.
///
/// # Safety
/// `name` is a C string.
pub unsafe fn extension(table: &'static Table, name: *const c_char, revision: u32) -> *const c_void {
    if name.is_null() || revision != 1 || table.manual.is_empty() {
        return std::ptr::null();
    }
    // SAFETY: the host passes a C string.
    let name = unsafe { CStr::from_ptr(name) };
    if name == c"radsight.manual" { table.described().manual.as_ptr().cast() } else { std::ptr::null() }
}

/// Makes an instance.
///
/// # Safety
/// The pointers are null or as the header says.
pub unsafe fn create(
    table: &'static Table,
    index: u32,
    call: *const abi::Create,
    instance: *mut abi::Instance,
) -> abi::Status {
    let Some(model) = table.models.get(index as usize) else { return status::BAD_ARGUMENT };
    // SAFETY: the host passes null or a valid structure, which no other thread touches during the
    // call.
    let (Some(call), Some(instance)) = (unsafe { call.as_ref() }, unsafe { instance.as_mut() }) else {
        return status::BAD_ARGUMENT;
    };
    keep_panic_messages(call.host);
    // SAFETY: the host's arrays have the lengths that it states, and live until this function
    // returns.
    let outcome = catch_unwind(AssertUnwindSafe(|| unsafe { create_checked(model, call) }));
    match outcome {
        Ok(Ok(made)) => {
            instance.flags = made.flags;
            instance.scratch_bytes = made.bands as u64 * size_of::<f64>() as u64;
            instance.scratch_bytes_per_direction = 0;
            instance.data = made.data;
            instance.eval_pdf = Some(model.eval_pdf);
            instance.sample = Some(model.sample);
            instance.destroy = Some(model.destroy);
            status::OK
        }
        Ok(Err(failure)) => {
            let row =
                |name| model.description.parameters.iter().position(|p| p.name == name).map_or(-1, |at| at as i32);
            let (code, row, message) = match failure {
                Refusal::Argument => return status::BAD_ARGUMENT,
                Refusal::Model(CreateError::Parameter { name, message }) => (status::BAD_PARAMETER, row(name), message),
                Refusal::Model(CreateError::File { name, message }) => (status::FILE_ERROR, row(name), message),
                Refusal::Model(CreateError::Unsupported(message)) => (status::UNSUPPORTED, -1, message),
            };
            // SAFETY: the host's error structure is valid until this function returns.
            unsafe { write_error(call.error, row, &message) };
            code
        }
        Err(_) => {
            // SAFETY: as above.
            unsafe { write_error(call.error, -1, &take_panic_message()) };
            status::PANIC
        }
    }
}

enum Refusal {
    Argument,
    Model(CreateError),
}

struct Made {
    data: *mut c_void,
    flags: u32,
    bands: usize,
}

/// An instance, with the data that the interface layer needs.
struct Boxed<M> {
    model: M,
    bands: usize,
}

fn make<M: Model>(parameters: &Parameters<'_>) -> Result<Made, CreateError> {
    let model = M::create(parameters)?;
    let (flags, bands) = (model.lobes().flags(), parameters.bands.len());
    Ok(Made { data: Box::into_raw(Box::new(Boxed { model, bands })).cast(), flags, bands })
}

/// # Safety
/// The arrays of `call` have the lengths that it states.
unsafe fn create_checked(model: &ModelFunctions, call: &abi::Create) -> Result<Made, Refusal> {
    // SAFETY: passed on.
    let (bands, numbers, words) = unsafe {
        (slice(call.bands, call.band_count), slice(call.numbers, call.number_count), slice(call.words, call.word_count))
    };
    let table = model.description.parameters;
    let asked_words = table.iter().filter(|row| row.kind >= abi::kind::WORD).count();
    let asked_numbers: usize = table
        .iter()
        .filter(|row| row.kind <= abi::kind::SPECTRUM)
        .map(|row| if row.kind == abi::kind::SPECTRUM { bands.len() } else { 1 })
        .sum();
    if bands.is_empty() || numbers.len() != asked_numbers || words.len() != asked_words {
        return Err(Refusal::Argument);
    }
    let mut texts = Vec::with_capacity(words.len());
    for word in words {
        if word.is_null() {
            return Err(Refusal::Argument);
        }
        // SAFETY: the host passes C strings that live until this function returns.
        texts.push(unsafe { CStr::from_ptr(*word) }.to_str().map_err(|_| Refusal::Argument)?);
    }
    (model.create)(&Parameters { table, numbers, words: &texts, bands }).map_err(Refusal::Model)
}

unsafe extern "C" fn eval_pdf<M: Model>(data: *const c_void, call: *const abi::Eval) -> abi::Status {
    guarded(|| {
        // SAFETY: `data` is what `make::<M>` gave to the host, not yet destroyed; the host passes a
        // valid call.
        let (boxed, call) = unsafe { (&*data.cast::<Boxed<M>>(), &*call) };
        let count = call.count as usize;
        if count == 0 {
            return;
        }
        // SAFETY: the host's arrays have the lengths of the header, do not overlap, and live until
        // this function returns; scratch is aligned and as long as `create` asked for.
        let mut batch = unsafe {
            EvalBatch {
                outgoing: DVec3::from_array(call.outgoing),
                incident_x: slice(call.incident_x, call.count),
                incident_y: slice(call.incident_y, call.count),
                incident_z: slice(call.incident_z, call.count),
                values: std::slice::from_raw_parts_mut(call.values, boxed.bands * count),
                pdfs: std::slice::from_raw_parts_mut(call.pdfs, count),
                scratch: scratch(call.scratch, boxed.bands),
            }
        };
        boxed.model.eval_batch(&mut batch);
    })
}

unsafe extern "C" fn sample<M: Model>(data: *const c_void, call: *const abi::Sample) -> abi::Status {
    guarded(|| {
        // SAFETY: as in `eval_pdf`.
        let (boxed, call) = unsafe { (&*data.cast::<Boxed<M>>(), &*call) };
        // SAFETY: as in `eval_pdf`.
        let weights = unsafe { scratch(call.scratch, boxed.bands) };
        let count = call.count as usize;
        for index in 0..count {
            // SAFETY: index is below count, the length of each array.
            let u = unsafe { [*call.u0.add(index), *call.u1.add(index), *call.u2.add(index)] };
            let found = boxed.model.sample(DVec3::from_array(call.outgoing), u, weights);
            let (kind, incident, pdf) = match found {
                Sample::Absorbed => (sample_kind::ABSORBED, DVec3::ZERO, 0.0),
                Sample::Continuous { incident, pdf } => (sample_kind::CONTINUOUS, incident, pdf),
                Sample::Delta { incident } => (sample_kind::DELTA, incident, 0.0),
            };
            // SAFETY: index is below count, and band below the number of bands.
            unsafe {
                *call.kinds.add(index) = kind;
                *call.incident_x.add(index) = incident.x;
                *call.incident_y.add(index) = incident.y;
                *call.incident_z.add(index) = incident.z;
                *call.pdfs.add(index) = pdf;
                for (band, weight) in weights.iter().enumerate() {
                    *call.weights.add(band * count + index) = *weight;
                }
            }
        }
    })
}

unsafe extern "C" fn destroy<M: Model>(data: *mut c_void) {
    // SAFETY: `data` came from `make::<M>`, and the host destroys it once.
    let boxed = unsafe { Box::from_raw(data.cast::<Boxed<M>>()) };
    let _ = catch_unwind(AssertUnwindSafe(|| drop(boxed)));
}

/// Runs an evaluation call; a panic becomes a status.
#[inline]
fn guarded(call: impl FnOnce()) -> abi::Status {
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(()) => status::OK,
        Err(payload) => {
            // Dropping the payload might panic again.
            std::mem::forget(payload);
            report_panic();
            status::PANIC
        }
    }
}

/// # Safety
/// `pointer` points to `count` elements, or `count` is zero.
unsafe fn slice<'a, T>(pointer: *const T, count: u32) -> &'a [T] {
    if count == 0 || pointer.is_null() {
        return &[];
    }
    // SAFETY: the caller's promise.
    unsafe { std::slice::from_raw_parts(pointer, count as usize) }
}

/// # Safety
/// `pointer` points to `count` numbers that nothing else uses.
unsafe fn scratch<'a>(pointer: *mut c_void, count: usize) -> &'a mut [f64] {
    // SAFETY: the caller's promise; the host aligns scratch to 64 bytes and every bit pattern is a
    // number. The content is undefined to the plugin but initialised by the host.
    unsafe { std::slice::from_raw_parts_mut(pointer.cast(), count) }
}

/// # Safety
/// `error` is null or valid.
unsafe fn write_error(error: *mut abi::Error, row: i32, message: &str) {
    // SAFETY: the caller's promise.
    let Some(error) = (unsafe { error.as_mut() }) else { return };
    error.parameter = row;
    let mut end = message.len().min(abi::MESSAGE_BYTES - 1);
    while !message.is_char_boundary(end) {
        end -= 1;
    }
    for (to, from) in error.message.iter_mut().zip(message.as_bytes()[..end].iter().chain(std::iter::once(&0))) {
        *to = *from as c_char;
    }
}

fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// A C string that is never freed: descriptors are made once per library.
fn leaked(text: &str) -> *const c_char {
    c_string(text).into_raw()
}

fn describe_model(description: &Description) -> abi::Model {
    let optional = |text: &str| if text.is_empty() { std::ptr::null() } else { leaked(text) };
    let rows: Vec<abi::Parameter> = description
        .parameters
        .iter()
        .map(|row| abi::Parameter {
            name: leaked(row.name),
            unit: leaked(row.unit),
            doc: leaked(row.doc),
            kind: row.kind,
            flags: row.flags,
            default_number: row.default_number,
            minimum: row.minimum,
            maximum: row.maximum,
            default_word: optional(row.default_word),
            choices: optional(row.choices),
        })
        .collect();
    abi::Model {
        struct_size: size_of::<abi::Model>() as u32,
        flags: description.flags(),
        parameter_count: rows.len() as u32,
        parameter_size: size_of::<abi::Parameter>() as u32,
        parameters: rows.leak().as_ptr(),
        name: leaked(description.name),
        summary: leaked(description.summary),
        citation: optional(description.citation),
    }
}

/// Maximum number of reported panics of evaluation calls; there may be millions.
const MAX_REPORTED_PANICS: u32 = 3;

static HOST: AtomicPtr<abi::Host> = AtomicPtr::new(std::ptr::null_mut());
static PANICS: AtomicU32 = AtomicU32::new(0);

thread_local! {
    static LAST_PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// From now on a panic in this library is stored as text instead of being printed. The library has
/// its own copy of the standard library, so the host's hook is unaffected.
fn keep_panic_messages(host: *const abi::Host) {
    static HOOK: Once = Once::new();
    HOST.store(host.cast_mut(), Ordering::Release);
    HOOK.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            let payload = info.payload();
            let text = payload
                .downcast_ref::<&str>()
                .map(|text| (*text).to_owned())
                .or_else(|| payload.downcast_ref::<String>().cloned())
                .unwrap_or_default();
            let place = info.location().map(|at| format!(" at {}:{}", at.file(), at.line())).unwrap_or_default();
            LAST_PANIC.with_borrow_mut(|last| *last = Some(format!("panicked: {text}{place}")));
        }));
    });
}

fn take_panic_message() -> String {
    LAST_PANIC.with_borrow_mut(Option::take).unwrap_or_else(|| "panicked".to_owned())
}

#[cold]
fn report_panic() {
    let message = take_panic_message();
    if PANICS.fetch_add(1, Ordering::Relaxed) >= MAX_REPORTED_PANICS {
        return;
    }
    let host = HOST.load(Ordering::Acquire);
    // SAFETY: the host's structure is valid as long as the library is loaded.
    let Some(log) = (unsafe { host.as_ref() }).and_then(|host| host.log) else { return };
    let text = c_string(&message);
    // SAFETY: any thread may call `log`, which copies the text.
    unsafe { log(host, 2, text.as_ptr()) };
}
