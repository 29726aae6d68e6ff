//! One HTML page of a picture: its values, its error, how it was made.
//!
//! A [`Page`] takes a picture of radiances or exposures. Maps of the same size may be added: the standard error of each pixel,
//! the rays of each pixel, the sensor's grey values. A [`RunRecord`] says how the picture was made.
//!
//! Guarantees of the page:
//! - It is one file and loads nothing, from a disk as from a server; its content security policy forbids all connections, and
//!   every script and style but its own two.
//! - All text that comes from files is escaped.
//! - It holds the values themselves: to 2⁻¹¹ of each value, over 5·10⁸ to 1. At most [`MOST_PIXELS`] are kept; a larger picture is
//!   averaged over squares of pixels, and the page says so.
//! - Without scripts, and in print, it shows still pictures with their scales.
//! - It is well-formed XML as well, so that any parser takes it apart.
//!
//! Opens no file and reads no clock: whoever has them passes them in.
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
