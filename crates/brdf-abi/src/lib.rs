//! The C interface of BRDF plugins, as Rust types.
//!
//! The header `include/radsight_brdf.h` specifies the meaning of every field, the threads that may
//! call each function, and the owner and lifetime of every pointer; it is all that an author in C
//! needs. A test compares its sizes, offsets and constants with the types here. Authors in Rust use
//! the crate `radsight-brdf-sdk`.
//!
//! Guarantees: a minor version only appends. The crate depends on `core` only.
//!
//! ```
//! use radsight_brdf_abi::{ABI_MAJOR, Entry};
//! assert_eq!(ABI_MAJOR, 1);
//! assert_eq!(std::mem::offset_of!(Entry, magic), 0);
//! ```

use std::ffi::{c_char, c_void};

/// The C header, for tools that create a plugin project.
pub const HEADER: &str = include_str!("../include/radsight_brdf.h");

/// First eight bytes of an [`Entry`]: "RADSBRDF" as a number.
pub const MAGIC: u64 = 0x5241_4453_4252_4446;
/// Major version; must be equal on both sides.
pub const ABI_MAJOR: u32 = 1;
/// Minor version; a higher one only appends.
pub const ABI_MINOR: u32 = 1;
/// Name of the exported constant, with its terminating zero byte.
pub const ENTRY_SYMBOL: &[u8] = b"radsight_brdf_entry\0";
/// Alignment of scratch memory, bytes.
pub const SCRATCH_ALIGNMENT: usize = 64;

/// Return value of a plugin's function; see the constants in [`status`].
pub type Status = u32;

/// Values of [`Status`].
pub mod status {
    /// Success.
    pub const OK: u32 = 0;
    /// The host violated the interface.
    pub const BAD_ARGUMENT: u32 = 1;
    /// A parameter is invalid.
    pub const BAD_PARAMETER: u32 = 2;
    /// A file named by a parameter cannot be read or parsed.
    pub const FILE_ERROR: u32 = 3;
    /// Memory allocation failed.
    pub const OUT_OF_MEMORY: u32 = 4;
    /// Unsupported request, such as a number of bands.
    pub const UNSUPPORTED: u32 = 5;
    /// Internal error that the plugin detected itself.
    pub const INTERNAL: u32 = 6;
    /// A panic or exception, stopped at the interface.
    pub const PANIC: u32 = 7;
}

/// Flags of a model or an instance: lobes in the low byte, declared properties in the next.
pub mod flags {
    /// Smooth functions of direction.
    pub const DIFFUSE: u32 = 0x1;
    /// Lobes of finite width.
    pub const GLOSSY: u32 = 0x2;
    /// Perfectly specular directions.
    pub const DELTA: u32 = 0x4;
    /// Incident and outgoing directions may be on different sides.
    pub const TRANSMISSION: u32 = 0x8;
    /// The value depends on the azimuth of the frame's x axis.
    pub const ANISOTROPIC: u32 = 0x10;
    /// Declares `f(outgoing, incident) = f(incident, outgoing)`.
    pub const RECIPROCAL: u32 = 0x100;
}

/// Kinds of parameters.
pub mod kind {
    /// One number.
    pub const NUMBER: u32 = 0;
    /// One number without a fraction.
    pub const INTEGER: u32 = 1;
    /// Three numbers in a scene; one per band at `create`.
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
    /// May be omitted together with all later ones of its list.
    pub const OPTIONAL: u32 = 0x1;
    /// The minimum itself is excluded.
    pub const ABOVE_MINIMUM: u32 = 0x2;
    /// The maximum itself is excluded.
    pub const BELOW_MAXIMUM: u32 = 0x4;
}

/// Kinds of results of `sample`.
pub mod sample_kind {
    /// Absorption.
    pub const ABSORBED: u8 = 0;
    /// A direction with a density.
    pub const CONTINUOUS: u8 = 1;
    /// A perfectly specular direction.
    pub const DELTA: u8 = 2;
}

/// A row of a parameter table: `RadsightBrdfParameter`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name, for messages and tables.
    pub name: *const c_char,
    /// Unit, such as "rad" or "1".
    pub unit: *const c_char,
    /// Description in one sentence.
    pub doc: *const c_char,
    /// One of [`kind`].
    pub kind: u32,
    /// Combination of [`parameter_flags`].
    pub flags: u32,
    /// Default of an optional number.
    pub default_number: f64,
    /// Smallest allowed number.
    pub minimum: f64,
    /// Largest allowed number.
    pub maximum: f64,
    /// Default of an optional word.
    pub default_word: *const c_char,
    /// Words of a choice, separated by `|`.
    pub choices: *const c_char,
}

/// Description of a model: `RadsightBrdfModel`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Size of the structure in the plugin's version, bytes.
    pub struct_size: u32,
    /// Combination of [`flags`].
    pub flags: u32,
    /// Number of rows in `parameters`.
    pub parameter_count: u32,
    /// Stride of the rows, bytes.
    pub parameter_size: u32,
    /// Parameter table.
    pub parameters: *const Parameter,
    /// Name in a scene.
    pub name: *const c_char,
    /// Description in one line.
    pub summary: *const c_char,
    /// Source of the formulas; may be null.
    pub citation: *const c_char,
}

/// A spectral band: `RadsightBrdfBand`. Wavelengths in metres.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Representative wavelength.
    pub centre_m: f64,
    /// Lower limit.
    pub low_m: f64,
    /// Upper limit.
    pub high_m: f64,
}

/// Size of [`Error::message`], bytes.
pub const MESSAGE_BYTES: usize = 240;

/// Why `create` failed: `RadsightBrdfError`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// Size of the structure in the host's version, bytes.
    pub struct_size: u32,
    /// Row of the parameter table, or −1.
    pub parameter: i32,
    /// Text, terminated by a zero byte.
    pub message: [c_char; MESSAGE_BYTES],
}

/// Services of the host: `RadsightBrdfHost`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Host {
    /// Size of the structure in the host's version, bytes.
    pub struct_size: u32,
    /// Major version of the host.
    pub abi_major: u32,
    /// Minor version of the host.
    pub abi_minor: u32,
    /// Zero.
    pub reserved: u32,
    /// \[any thread\] Logs a line of text: level 0 note, 1 warning, 2 error.
    pub log: Option<unsafe extern "C" fn(host: *const Host, level: u32, text: *const c_char)>,
    /// Since 1.1. \[any thread\] Returns an extension of the host, or null.
    pub extension: Option<unsafe extern "C" fn(host: *const Host, name: *const c_char, revision: u32) -> *const c_void>,
}

/// Arguments of `create`: `RadsightBrdfCreate`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Create {
    /// Size of the structure in the host's version, bytes.
    pub struct_size: u32,
    /// Number of bands, at least 1.
    pub band_count: u32,
    /// Bands, `band_count` of them.
    pub bands: *const Band,
    /// Numbers, `number_count` of them.
    pub numbers: *const f64,
    /// Words, `word_count` of them.
    pub words: *const *const c_char,
    /// Number of numbers that the table requires.
    pub number_count: u32,
    /// Number of words that the table requires.
    pub word_count: u32,
    /// The host; the plugin may keep the pointer.
    pub host: *const Host,
    /// Error to be filled in on failure.
    pub error: *mut Error,
}

/// A call of `eval_pdf`: `RadsightBrdfEval`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Eval {
    /// Size of the structure in the host's version, bytes.
    pub struct_size: u32,
    /// Number of incident directions.
    pub count: u32,
    /// Outgoing direction: unit, local frame, away from the surface.
    pub outgoing: [f64; 3],
    /// x of the incident directions, `count` elements.
    pub incident_x: *const f64,
    /// y of the incident directions, `count` elements.
    pub incident_y: *const f64,
    /// z of the incident directions, `count` elements.
    pub incident_z: *const f64,
    /// Output: `f` in 1/sr, element `[band · count + direction]`.
    pub values: *mut f64,
    /// Output: densities in 1/sr, `count` elements.
    pub pdfs: *mut f64,
    /// Scratch memory of the host, of the size that the instance requested.
    pub scratch: *mut c_void,
}

/// A call of `sample`: `RadsightBrdfSample`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Size of the structure in the host's version, bytes.
    pub struct_size: u32,
    /// Number of points.
    pub count: u32,
    /// Outgoing direction: unit, local frame, away from the surface.
    pub outgoing: [f64; 3],
    /// Random numbers in [0,1), `count` elements.
    pub u0: *const f64,
    /// Random numbers in [0,1), `count` elements.
    pub u1: *const f64,
    /// Random numbers in [0,1), `count` elements.
    pub u2: *const f64,
    /// Output: x of the incident directions, `count` elements.
    pub incident_x: *mut f64,
    /// Output: y of the incident directions, `count` elements.
    pub incident_y: *mut f64,
    /// Output: z of the incident directions, `count` elements.
    pub incident_z: *mut f64,
    /// Output: weights, element `[band · count + point]`.
    pub weights: *mut f64,
    /// Output: densities in 1/sr, `count` elements.
    pub pdfs: *mut f64,
    /// Output: values of [`sample_kind`], `count` elements.
    pub kinds: *mut u8,
    /// Scratch memory of the host, of the size that the instance requested.
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
    /// Size of the structure in the host's version, bytes.
    pub struct_size: u32,
    /// Flags of this instance's lobes.
    pub flags: u32,
    /// Scratch memory per call, bytes.
    pub scratch_bytes: u64,
    /// Additional scratch memory per element of a batch, bytes.
    pub scratch_bytes_per_direction: u64,
    /// Private data of the plugin.
    pub data: *mut c_void,
    /// \[any thread\] Evaluates values and densities.
    pub eval_pdf: Option<EvalFn>,
    /// \[any thread\] Samples incident directions.
    pub sample: Option<SampleFn>,
    /// \[one thread\] Destroys the instance.
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

/// The exported constant of a plugin: `RadsightBrdfEntry`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// [`MAGIC`].
    pub magic: u64,
    /// [`ABI_MAJOR`].
    pub abi_major: u32,
    /// [`ABI_MINOR`].
    pub abi_minor: u32,
    /// Size of the structure in the plugin's version, bytes.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// \[one thread\] Returns the number of models.
    pub count: Option<CountFn>,
    /// \[one thread\] Describes a model.
    pub describe: Option<DescribeFn>,
    /// \[one thread\] Makes an instance.
    pub create: Option<CreateFn>,
    /// Since 1.1. \[any thread\] Returns an extension of the plugin, or null.
    pub extension: Option<ExtensionFn>,
}

/// Size of an [`Entry`] of version 1.0, bytes: the smallest that a host accepts.
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
