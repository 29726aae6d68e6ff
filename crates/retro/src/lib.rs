//! Retroreflector models: surfaces that send light back to where it comes from.
//!
//! δ is always the angle between the outgoing and the incident direction (the *observation angle*
//! of retroreflectometry). It is computed from the chord, never from the cosine, since lobes are a
//! fraction of a degree wide.
//!
//! Guarantees: every model samples directions with exactly the density that it returns; models that
//! [`MODELS`] lists as reciprocal are reciprocal. The crate knows neither scenes nor renderers, and
//! reads no files.
//!
//! ```
//! use radsight_retro::{Geometry, model};
//! // White sheeting with a flat-topped lobe, by the words and numbers of a scene.
//! let sheet = model("sharp", &[], &[0.086, 0.0102, 6.0]).unwrap();
//! let at = Geometry::from_degrees(0.2, -4.0, 0.0);
//! let (observer, light) = at.directions();
//! let coefficient = at.coefficient(sheet.value_and_pdf(observer, light).0);
//! assert!(coefficient > 200.0, "{coefficient} cd/(lx m²)");
//! ```
#![forbid(unsafe_code)]

mod coefficient;
mod fit;
mod fresnel;
mod gaussian;
mod ggx;
mod glass_bead;
mod minimum;
mod mrm;
mod native;
mod prism;
mod radial;
mod sharp;
mod sheeting;
mod table;

pub use coefficient::Geometry;
pub use fit::{Fit, FitError, Fitted, Weights, fit};
pub use fresnel::fresnel_dielectric;
pub use gaussian::{Paper1991, ReciprocalGaussian, observation_angle};
pub use glass_bead::{Binder, entrance_factor, observation_factor};
pub use minimum::{MINIMUM_TABLES, MinimumRow, MinimumTable, minimum_table};
pub use native::{LIBRARY, MODELS, ModelInfo, model, model_info};
pub use prism::{CubeCornerSheeting, Faces};
pub use radsight_brdf::native::{ModelError, Parameter};
pub use sheeting::{Sheeting, Surroundings};
pub use table::{RetroTable, Row, TableError};
