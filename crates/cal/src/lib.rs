//! The `.cal` function language of Radiance: parse, compile, evaluate.
//!
//! [`Definitions`] hold the content of function files; [`Program::compile`] compiles expressions
//! and functions of them to fast code; [`Program::eval`] runs it with the channels of a [`Host`],
//! such as a ray.
//!
//! Guarantees: the values are those of Radiance, and so is the behaviour at mathematical faults; no
//! input makes loading, compiling or evaluating panic, hang, overflow the stack or exhaust the
//! memory; a [`Program`] is `Send + Sync`, and evaluation takes no lock and, after the first time,
//! allocates no memory. The crate knows nothing of scenes and rays, and reads no files.
//!
//! ```
//! use radsight_cal::{Bindings, Definitions, Program, Root, Scope, Scratch};
//! use radsight_diag::SourceMap;
//!
//! let mut sources = SourceMap::default();
//! let mut definitions = Definitions::with_initial_library();
//! let scope = Scope::of_file("led.cal");
//! if !definitions.is_loaded(&scope) {
//!     let text = b"off = Acos(-Dz)/DEGREE; { degrees off the axis }  led = if(off-A1, 0, A2*(1-sq(off/A1)));";
//!     let source = sources.add("led.cal", &text[..], None);
//!     definitions.load(source, text, &scope).unwrap();
//! }
//!
//! let scene = sources.add("scene.rad", &b"void brightfunc lamp 2 led led.cal 0 2 30 5"[..], None);
//! let root = Root::Expression { text: "led", span: sources.span(scene, 23, 26) };
//! let bindings = Bindings { real_arguments: &[30.0, 5.0], ..Bindings::of_ray() };
//! let program = Program::compile(&definitions, &scope, &[root], &bindings).unwrap();
//!
//! assert_eq!(program.channels_used(), [3]);
//! let mut scratch = Scratch::new(); // one a thread
//! let along_the_axis: [f64; 3] = [0.0, 0.0, -1.0]; // $1, $2, $3
//! assert_eq!(program.eval(0, &[], &along_the_axis[..], &mut scratch), Ok(5.0));
//! ```
#![forbid(unsafe_code)]

mod bindings;
mod builtin;
pub mod channel;
mod definitions;
#[cfg(test)]
mod differential;
mod emit;
mod environment;
mod family;
mod fast;
mod fault;
mod fault_log;
mod graph;
mod lexer;
pub mod library;
pub mod limits;
mod link;
mod lower;
mod machine;
mod names;
mod noise;
mod program;
mod schedule;
mod syntax;

pub use bindings::Bindings;
pub use builtin::random;
pub use definitions::Definitions;
pub use environment::{Environment, Handle, Slot};
pub use family::Family;
pub use fault::{Fault, FaultKind, Warning};
pub use fault_log::Faults;
pub use names::Scope;
pub use program::{Host, NoHost, Program, Root, Scratch};
