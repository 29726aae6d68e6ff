//! What `rad` makes of a `.rif` file: variables that say how good a picture should be, turned into the commands that make it.
//!
//! [`Rif::read`] takes the file, [`Rif::assign`] what the command line adds, and [`Rif::steps`] gives the commands in the words
//! in which Radiance's `rad` prints them, so that its figures for each quality are those of the users' old scripts.
//!
//! Guarantees: no input makes it panic. Reads no file and runs nothing: dates and sizes come from a [`Site`].
//!
//! ```
//! use radsight_rad_project::{Cube, Date, How, NamedBy, Rif, Site};
//! struct Empty;
//! impl Site for Empty {
//!     fn date(&self, name: &str) -> Date {
//!         if name == "room.rad" { 5 } else { 0 }
//!     }
//!     fn cube(&self, _scene: &[String]) -> Option<Cube> {
//!         Some(Cube { corner: [0.0; 3], size: 4.0 })
//!     }
//! }
//! let mut rif = Rif::read("room.rif", "scene= room.rad\nEXPOSURE= 2 # bright\nview= def -vp 1 2 3\n").unwrap();
//! rif.check().unwrap();
//! let steps = rif.steps(&How::default(), &Empty).unwrap();
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

pub use error::RifError;
pub use steps::{Cube, Date, How, OutputFile, OutputKind, Site, Step};
pub use variables::{NamedBy, Rif};
