//! The C interface of BRDF plugins, as Rust types.
//!
//! The meaning of every field, the threads that may call each function, and the owner and lifetime of every pointer stand in
//! `include/radsight_brdf.h`, which is all that an author in C needs; a test compares its sizes, offsets and constants with
//! the types here. Authors in Rust use the crate `radsight-brdf-sdk`.
//!
//! Guarantees: a minor version only appends. Knows nothing but `core`.
//!
//! ```
//! use radsight_brdf_abi::{ABI_MAJOR, Entry};
//! assert_eq!(ABI_MAJOR, 1);
//! assert_eq!(std::mem::offset_of!(Entry, magic), 0);
//! ```

use std::ffi::{c_char, c_void};

/// The C header, for tools that write it beside a new plugin.
pub const HEADER: &str = include_str!("../include/radsight_brdf.h");

/// First eight bytes of an [`Entry`]: "RADSBRDF" as a number.
pub const MAGIC: u64 = 0x5241_4453_4252_4446;
/// Equal on both sides.
pub const ABI_MAJOR: u32 = 1;
/// A higher one only appends.
pub const ABI_MINOR: u32 = 1;
/// The name of the exported constant, with its final zero byte.
pub const ENTRY_SYMBOL: &[u8] = b"radsight_brdf_entry\0";
/// Scratch begins at a multiple of this many bytes.
pub const SCRATCH_ALIGNMENT: usize = 64;

/// What a function of a plugin returns; see the constants in [`status`].
pub type Status = u32;

/// Values of [`Status`].
pub mod status {
    /// Done.
    pub const OK: u32 = 0;
    /// The host broke a rule.
    pub const BAD_ARGUMENT: u32 = 1;
    /// The parameters do not fit.
    pub const BAD_PARAMETER: u32 = 2;
    /// A file that a parameter names cannot be read or understood.
    pub const FILE_ERROR: u32 = 3;
    /// No memory.
    pub const OUT_OF_MEMORY: u32 = 4;
    /// Such as a number of bands that the model cannot do.
    pub const UNSUPPORTED: u32 = 5;
    /// A fault of the plugin that it noticed itself.
    pub const INTERNAL: u32 = 6;
    /// A panic or exception, stopped at the border.
    pub const PANIC: u32 = 7;
}

/// Flags of a model or an instance: lobes in the low byte, claims in the next.
pub mod flags {
    /// Smooth functions of direction.
    pub const DIFFUSE: u32 = 0x1;
    /// Peaks of finite width.
    pub const GLOSSY: u32 = 0x2;
    /// Perfectly specular directions.
    pub const DELTA: u32 = 0x4;
    /// Incident and outgoing may be on different sides.
    pub const TRANSMISSION: u32 = 0x8;
    /// Depends on the azimuth of the frame's x axis.
    pub const ANISOTROPIC: u32 = 0x10;
    /// Claims `f(outgoing, incident) = f(incident, outgoing)`.
    pub const RECIPROCAL: u32 = 0x100;
}

/// Kinds of parameters.
pub mod kind {
    /// One number.
    pub const NUMBER: u32 = 0;
    /// One number without a fraction.
    pub const INTEGER: u32 = 1;
    /// Three numbers in a scene; one for each band at `create`.
    pub const SPECTRUM: u32 = 2;
    /// One word.
    pub const WORD: u32 = 3;
    /// One word of a list.
    pub const CHOICE: u32 = 4;
    /// One word that names a file.
    pub const FILE: u32 = 5;
}

/// Flags of a parameter.
pub mod parameter_flags {
    /// May be left out with all later ones of its list.
    pub const OPTIONAL: u32 = 0x1;
    /// The minimum itself is not allowed.
    pub const ABOVE_MINIMUM: u32 = 0x2;
    /// The maximum itself is not allowed.
    pub const BELOW_MAXIMUM: u32 = 0x4;
}

/// What `sample` found.
pub mod sample_kind {
    /// Nothing.
    pub const ABSORBED: u8 = 0;
    /// A direction with a density.
    pub const CONTINUOUS: u8 = 1;
    /// A perfectly specular direction.
    pub const DELTA: u8 = 2;
}

/// One row of a parameter table: `RadsightBrdfParameter`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// For messages and tables.
    pub name: *const c_char,
    /// Such as "rad" or "1".
    pub unit: *const c_char,
    /// One sentence.
    pub doc: *const c_char,
    /// One of [`kind`].
    pub kind: u32,
    /// Of [`parameter_flags`].
    pub flags: u32,
    /// Of an optional number.
    pub default_number: f64,
    /// Smallest allowed number.
    pub minimum: f64,
    /// Largest allowed number.
    pub maximum: f64,
    /// Of an optional word.
    pub default_word: *const c_char,
    /// Of a choice, separated by `|`.
    pub choices: *const c_char,
}

/// What a model is: `RadsightBrdfModel`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// In the eyes of the plugin.
    pub struct_size: u32,
    /// Of [`flags`].
    pub flags: u32,
    /// Rows of `parameters`.
    pub parameter_count: u32,
    /// Bytes from one row to the next.
    pub parameter_size: u32,
    /// The table.
    pub parameters: *const Parameter,
    /// As a scene writes it.
    pub name: *const c_char,
    /// One line.
    pub summary: *const c_char,
    /// Where the formulas are from; may be null.
    pub citation: *const c_char,
}

/// A spectral band: `RadsightBrdfBand`. Wavelengths in metres.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// The wavelength that stands for it.
    pub centre_m: f64,
    /// Where it begins.
    pub low_m: f64,
    /// Where it ends.
    pub high_m: f64,
}

/// Bytes of [`Error::message`].
pub const MESSAGE_BYTES: usize = 240;

/// Why `create` failed: `RadsightBrdfError`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// In the eyes of the host.
    pub struct_size: u32,
    /// Row of the parameter table, or −1.
    pub parameter: i32,
    /// Ends with a zero byte.
    pub message: [c_char; MESSAGE_BYTES],
}

/// What the host offers: `RadsightBrdfHost`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Host {
    /// In the eyes of the host.
    pub struct_size: u32,
    /// Of the host.
    pub abi_major: u32,
    /// Of the host.
    pub abi_minor: u32,
    /// Zero.
    pub reserved: u32,
    /// \[any thread\] Hands a line of text to the user: 0 note, 1 warning, 2 error.
    pub log: Option<unsafe extern "C" fn(host: *const Host, level: u32, text: *const c_char)>,
    /// Since 1.1. \[any thread\]
    pub extension: Option<unsafe extern "C" fn(host: *const Host, name: *const c_char, revision: u32) -> *const c_void>,
}

/// What `create` is given: `RadsightBrdfCreate`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Create {
    /// In the eyes of the host.
    pub struct_size: u32,
    /// At least 1.
    pub band_count: u32,
    /// `band_count`.
    pub bands: *const Band,
    /// `number_count`.
    pub numbers: *const f64,
    /// `word_count`.
    pub words: *const *const c_char,
    /// What the table asks for.
    pub number_count: u32,
    /// What the table asks for.
    pub word_count: u32,
    /// May be kept.
    pub host: *const Host,
    /// To be filled in on failure.
    pub error: *mut Error,
}

/// A call of `eval_pdf`: `RadsightBrdfEval`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Eval {
    /// In the eyes of the host.
    pub struct_size: u32,
    /// Of incident directions.
    pub count: u32,
    /// Unit, local frame, away from the surface.
    pub outgoing: [f64; 3],
    /// `count`.
    pub incident_x: *const f64,
    /// `count`.
    pub incident_y: *const f64,
    /// `count`.
    pub incident_z: *const f64,
    /// `f` in 1/sr, element `[band · count + direction]`.
    pub values: *mut f64,
    /// 1/sr, `count`.
    pub pdfs: *mut f64,
    /// The host's, of the size that the instance asked for.
    pub scratch: *mut c_void,
}

/// A call of `sample`: `RadsightBrdfSample`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// In the eyes of the host.
    pub struct_size: u32,
    /// Of points.
    pub count: u32,
    /// Unit, local frame, away from the surface.
    pub outgoing: [f64; 3],
    /// `count`, in [0,1).
    pub u0: *const f64,
    /// `count`, in [0,1).
    pub u1: *const f64,
    /// `count`, in [0,1).
    pub u2: *const f64,
    /// `count`.
    pub incident_x: *mut f64,
    /// `count`.
    pub incident_y: *mut f64,
    /// `count`.
    pub incident_z: *mut f64,
    /// Element `[band · count + point]`.
    pub weights: *mut f64,
    /// 1/sr, `count`.
    pub pdfs: *mut f64,
    /// Of [`sample_kind`], `count`.
    pub kinds: *mut u8,
    /// The host's, of the size that the instance asked for.
    pub scratch: *mut c_void,
}

/// Type of `eval_pdf`.
pub type EvalFn = unsafe extern "C" fn(data: *const c_void, call: *const Eval) -> Status;
/// Type of `sample`.
pub type SampleFn = unsafe extern "C" fn(data: *const c_void, call: *const Sample) -> Status;
/// Type of `destroy`.
pub type DestroyFn = unsafe extern "C" fn(data: *mut c_void);

/// A model with its parameters: `RadsightBrdfInstance`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// In the eyes of the host.
    pub struct_size: u32,
    /// The lobes that this instance has.
    pub flags: u32,
    /// Scratch of a call …
    pub scratch_bytes: u64,
    /// … and for each element of its batch.
    pub scratch_bytes_per_direction: u64,
    /// The plugin's own.
    pub data: *mut c_void,
    /// \[any thread\]
    pub eval_pdf: Option<EvalFn>,
    /// \[any thread\]
    pub sample: Option<SampleFn>,
    /// \[one thread\]
    pub destroy: Option<DestroyFn>,
}

/// Type of `count`.
pub type CountFn = unsafe extern "C" fn() -> u32;
/// Type of `describe`.
pub type DescribeFn = unsafe extern "C" fn(index: u32) -> *const Model;
/// Type of `create`.
pub type CreateFn = unsafe extern "C" fn(index: u32, call: *const Create, instance: *mut Instance) -> Status;
/// Type of `extension`.
pub type ExtensionFn = unsafe extern "C" fn(name: *const c_char, revision: u32) -> *const c_void;

/// What a plugin exports: `RadsightBrdfEntry`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// [`MAGIC`].
    pub magic: u64,
    /// [`ABI_MAJOR`].
    pub abi_major: u32,
    /// [`ABI_MINOR`].
    pub abi_minor: u32,
    /// In the eyes of the plugin.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// \[one thread\]
    pub count: Option<CountFn>,
    /// \[one thread\]
    pub describe: Option<DescribeFn>,
    /// \[one thread\]
    pub create: Option<CreateFn>,
    /// Since 1.1. \[any thread\]
    pub extension: Option<ExtensionFn>,
}

/// Bytes of an [`Entry`] of ABI 1.0: the least that a host accepts.
pub const ENTRY_BYTES_1_0: usize = std::mem::offset_of!(Entry, extension);

/// The name of a status, for messages.
#[must_use]
pub fn status_name(status: Status) -> &'static str {
    match status {
        status::OK => "ok",
        status::BAD_ARGUMENT => "bad argument",
        status::BAD_PARAMETER => "bad parameter",
        status::FILE_ERROR => "file error",
        status::OUT_OF_MEMORY => "out of memory",
        status::UNSUPPORTED => "unsupported",
        status::INTERNAL => "internal fault",
        status::PANIC => "panic",
        _ => "unknown status",
    }
}
