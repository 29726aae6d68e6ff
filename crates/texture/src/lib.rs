//! Patterns and textures at an intersection.
//!
//! A [`SurfaceInteraction`] is the intersection of a ray with a surface. A [`TextureChain`]
//! evaluates it to an [`Appearance`]: a factor of the material's colour and a perturbation of its
//! normal. Colours are arrays of as many bands as are traced ([`Bands`]).
//!
//! Guarantees: no panic on a [`radsight_ir::ValidScene`]; a function that fails changes nothing.
//! The crate knows no materials and no lights.
#![forbid(unsafe_code)]

mod appearance;
mod bands;
mod chain;
mod function;
mod function_view;
mod interaction;
mod lettering;
mod spectral_pattern;
mod step;

pub use appearance::{Appearance, TransmittedRays};
pub use bands::{BandLayout, BandValues, Bands, bands, gathered, luminance, not_negative, product, spread, strongest};
pub use chain::{Home, TextureChain};
pub use function::Function;
pub use function_view::FunctionView;
pub use interaction::{SurfaceInteraction, mirrored, reflect, shading_normal};
pub use lettering::Lettering;
pub use spectral_pattern::{SpectralData, SpectralFunction};
pub use step::{MixedSteps, Share, Step};
