//! Patterns and textures where a ray meets a surface.
//!
//! A [`SurfaceInteraction`] is a ray at the surface that it meets; a [`TextureChain`] makes of it an [`Appearance`]: by what the
//! material's colour is multiplied, and what is added to its normal. Colours stand in arrays of as many bands as are traced ([`Bands`]).
//!
//! Guarantees: no panic on a [`radsight_ir::ValidScene`]; a function that fails changes nothing. Knows no materials and no lights.
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

pub use appearance::Appearance;
pub use bands::{BandLayout, BandValues, Bands, bands, gathered, luminance, product, spread, strongest};
pub use chain::{Home, TextureChain};
pub use function::Function;
pub use function_view::FunctionView;
pub use interaction::{SurfaceInteraction, mirrored, reflect, shading_normal};
pub use lettering::Lettering;
pub use spectral_pattern::{SpectralData, SpectralFunction};
pub use step::{MixedSteps, Share, Step};
