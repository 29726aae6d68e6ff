//! One HTML page about a picture: its values, its error, how it was made.
//!
//! A [`Page`] takes a picture of radiances or exposures. Maps of the same size may be added: the
//! standard error of each pixel, the rays of each pixel, the sensor's grey values. A [`RunRecord`]
//! describes how the picture was made.
//!
//! Guarantees of the page:
//! - It is one file and loads nothing, neither from disk nor from a server. Its content security
//!   policy forbids all connections and all scripts and styles but its own two.
//! - Text from files is escaped.
//! - It holds the values themselves, with a relative precision of 2⁻¹¹ over a range of 5·10⁸ to 1.
//!   At most [`MOST_PIXELS`] are stored; a larger picture is averaged over squares of pixels, and
//!   the page notes it.
//! - Without scripts, and in print, it shows still pictures with their scales.
//! - It is also well-formed XML, so any parser can read it.
//!
//! The crate opens no file and reads no clock; the caller provides their contents.
//!
//! ```
//! use radsight_picture::Image;
//! use radsight_report::{Page, Quantity};
//! let ramp = Image::new(4, 2, 1, (0..8).map(|i| 1e-3 * i as f32).collect()).unwrap();
//! let page = Page::new("ramp.pfm", ramp, Quantity::Exposure).unwrap();
//! assert!(page.to_html().contains("J/m²"));
//! ```
#![forbid(unsafe_code)]

mod color_map;
mod error;
mod escape;
mod layer;
mod map;
mod number;
mod page;
mod progress_log;
mod record;
mod scale;
mod sections;
mod still;
mod stored_values;

pub use color_map::viridis;
pub use error::ReportError;
pub use map::{ErrorMap, GreyPicture, MOST_PIXELS, Quantity};
pub use page::Page;
pub use progress_log::{Progress, ProgressLog};
pub use record::{Decision, ErrorEstimate, RunRecord, Setting, Stage};
