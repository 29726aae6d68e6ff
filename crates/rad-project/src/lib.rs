//! Radiance's `rad`: translates the variables of a `.rif` file into the commands that render its
//! pictures.
//!
//! [`Project::read`] parses the file, [`Project::assign`] adds variables from the command line, and
//! [`Project::steps`] returns the commands in the form in which Radiance's `rad` prints them. The
//! parameters of each quality are therefore those of existing scripts.
//!
//! Guarantees: no input causes a panic. The crate reads no file and runs nothing: dates and sizes
//! come from a [`Site`].
//!
//! ```
//! use radsight_rad_project::{Cube, Date, How, NamedBy, Project, Site};
//! struct Empty;
//! impl Site for Empty {
//!     fn date(&self, name: &str) -> Date {
//!         if name == "room.rad" { 5 } else { 0 }
//!     }
//!     fn cube(&self, _scene: &[String]) -> Option<Cube> {
//!         Some(Cube { corner: [0.0; 3], size: 4.0 })
//!     }
//! }
//! let mut project = Project::read("room.rif", "scene= room.rad\nEXPOSURE= 2 # bright\nview= def -vp 1 2 3\n").unwrap();
//! project.check().unwrap();
//! let steps = project.steps(&How::default(), &Empty).unwrap();
//! assert_eq!(steps[0].command_line(), "oconv room.rad > room.oct");
//! assert_eq!(steps[2].command_line(), "pfilt -1 -e 2 room_def.unf > room_def.hdr");
//! assert_eq!(steps[0].outputs()[0].named_by, NamedBy::CommandLine);
//! ```
#![forbid(unsafe_code)]

mod error;
mod quality;
mod steps;
mod variables;
mod views;

pub use error::ProjectError;
pub use steps::{Cube, Date, How, OutputFile, OutputKind, Site, Step};
pub use variables::{NamedBy, Project};
