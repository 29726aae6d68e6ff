//! The types of the fields of [`RenderOptions`](crate::RenderOptions), such as the spectral bands.
//!
//! ```
//! use radsight::options::{BackFaces, Sampling};
//! use radsight::{Ray, Renderer, Scene, glam::DVec3};
//! let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")?;
//! let mut renderer = Renderer::new(&scene)?;
//! renderer.options_mut().back_faces = BackFaces::Invisible;
//! // Five equal bands, from the longest wavelength to the shortest.
//! renderer.options_mut().sampling = Sampling::new(5, [780.0, 380.0]).expect("a range of at least 50 nm");
//! let ahead = Ray::new(DVec3::ZERO, DVec3::Y).expect("a direction");
//! let spectrum = renderer.trace(&[ahead])?[0].spectrum.expect("more than three bands");
//! assert!(spectrum.as_slice().len() == 5 && (spectrum.as_slice()[2] - 1.0).abs() < 0.05); // W/(sr·m²)
//! # Ok::<(), radsight::Error>(())
//! ```

pub use radsight_render::{
    AmbientSurfaces, BackFaces, BandValues, BareSurfaces, Caustics, DirectThreshold, Gathering, GlobalMedium,
    LightDivision, Lights, PathLimit, Quantity, RayTreeOutput, Sampling, Skip, Skipping, TrackedValue, Uncached,
};
