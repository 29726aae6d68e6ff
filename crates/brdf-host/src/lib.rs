//! Loads BRDF plugins, wraps them as [`Brdf`](radsight_brdf::Brdf), and checks them.
//!
//! A [`Registry`] finds libraries by a [`SearchPath`], loads each once, checks a scene's words and numbers against the
//! model's own table, and makes instances. Errors say which token of the scene is to blame ([`Error::token`]).
//!
//! Guarantees: what a plugin returns is never NaN, negative or infinite on its way to the picture,
//! and each such result is counted; a crash inside a plugin is preceded by a message with plugin,
//! model, material and place. [`guard`] ends the program for whatever else a plugin does to it,
//! [`isolate`] runs plugins in processes of their own. Loading a plugin runs its code. Knows
//! neither the renderer nor scenes.
//!
//! ```
//! use radsight_brdf_host::{Registry, SearchPath, SelfCheck};
//! let registry = Registry::new(SearchPath::default(), SelfCheck::Warn);
//! let error = registry.library("retrosheet").unwrap_err();
//! assert_eq!(error.to_string(), "cannot find plugin library \"retrosheet\": no folder is searched");
//! ```

pub mod check;
mod child_command;
mod describe;
mod error;
mod faults;
mod functions;
pub mod guard;
mod instance;
pub mod isolate;
mod library;
mod object_file;
pub mod plot;
mod registry;
mod scratch;
mod search;
mod self_check;
#[cfg(target_os = "linux")]
mod supervise;
mod table;
pub mod template;

pub use child_command::ChildCommand;
pub use error::Error;
pub use faults::{FaultCounts, FaultReport};
pub use guard::{Limits, install_crash_messages};
pub use instance::{Label, PluginBrdf, Unfiltered};
pub use library::{Library, Message};
pub use radsight_brdf_abi::Band;
pub use registry::{Instantiated, Registry, Request};
pub use search::{SearchPath, library_name};
pub use self_check::SelfCheck;
pub use table::{ModelInfo, ParameterInfo, ParameterKind, Range, Token};
