//! Loads BRDF plugins, wraps them as [`Brdf`](radsight_brdf::Brdf), and checks them.
//!
//! A [`Registry`] finds libraries in a [`SearchPath`], loads each once, checks a scene's words and
//! numbers against the model's table, and makes instances. Errors name the token of the scene that
//! caused them ([`Error::token`]).
//!
//! Guarantees: values returned by a plugin are never NaN, negative or infinite when they reach the
//! picture, and each invalid value is counted. A crash inside a plugin is preceded by a message
//! with plugin, model, material and position. [`guard`] ends the program for any other fault of a
//! plugin, [`isolate`] runs plugins in processes of their own. Loading a plugin runs its code. The
//! crate knows neither the renderer nor scenes.
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
mod sample_kind_check;
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
