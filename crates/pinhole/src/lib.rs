//! A camera with a pinhole, a thin lens or a telecentric one: rays over pixel × pinhole, and the exposure of each
//! pixel from their radiances.
//!
//! The exposure of a pixel is the exact four-dimensional integral behind Eqs. 3, 4 and 8 of
//! Rushmeier, Parker and Lee, 1991 ("the paper"), without the approximation of its Eq. 7:
//!
//! `E_pixel = τ/(A_pixel f²) ∫_pixel ∫_pinhole L(h, h−p) cos⁴θ dA_h dA_p`
//!
//! with sensor point p, pinhole point h, focal distance f, exposure time τ, radiance L and θ the
//! angle of h−p to the axis. [`Rays`] samples both areas uniformly, [`PixelAverage`] converts
//! radiances to J/m², [`stream`] reads and writes both as streams, and [`shift`] is the paper's own
//! approximation, for comparison.
//!
//! Guarantees: a [`PinholeCamera`] holds only finite, positive quantities and an orthonormal frame;
//! rays and averages are functions of (seed, ray number) only. May not know the renderer or the
//! sensor; does no input or output.
//!
//! ```
//! use radsight_pinhole::{BandWeights, CameraDescription, PinholeCamera, PinholeModel, PixelAverage, Rays};
//! let camera = PinholeCamera::new(&CameraDescription {
//!     position_m: [0.0, 0.0, 0.48],
//!     direction: [0.0, 0.0, -1.0],
//!     up: [0.0, 1.0, 0.0],
//!     pixels: [192, 165],
//!     pixel_pitch_m: [13.75e-6, 16e-6],
//!     focal_distance_m: 6.75e-3,
//!     pinhole_diameter_m: 0.1e-3,
//!     pinhole_model: PinholeModel::Finite,
//!     exposure_s: 0.01,
//!     wavelength_m: Some(650e-9),
//!     scene_unit_m: 1.0,
//! })?;
//! let rays = Rays::new(&camera, 16, 0);
//! let weights = BandWeights::equal(1);
//! let pixel = 82 * 192 + 96;
//! let mut average = PixelAverage::default();
//! for sample in 0..16 {
//!     let ray = rays.of_sample(pixel, sample);
//!     average.add(ray.cos4, weights.combine(&[1.0])); // a scene of radiance 1 W/(sr·m²) everywhere
//! }
//! let on_axis = 0.01 * std::f64::consts::PI * (0.1e-3f64).powi(2) / 4.0 / (6.75e-3f64).powi(2);
//! assert!((average.exposure(&camera) / on_axis - 1.0).abs() < 1e-3);
//! # Ok::<(), radsight_pinhole::CameraError>(())
//! ```
#![forbid(unsafe_code)]

mod average;
mod camera;
mod camera_optics;
mod camera_ray;
mod diffraction;
mod distortion;
mod film_plane;
mod fresnel_pattern;
mod lens;
mod own_rays;
mod rays;
pub mod shift;
mod statistics;
pub mod stream;
mod surround;
mod telecentric;
mod view;
mod wings;

pub use average::{BandWeights, BandWeightsError, FilterMosaic, PixelAverage};
pub use camera::{CameraDescription, CameraError, PinholeCamera, PinholeModel};
pub use camera_ray::CameraRay;
pub use diffraction::fresnel_number;
pub use distortion::{CameraMatrix, Distortion};
pub use film_plane::FilmPlane;
pub use fresnel_pattern::fresnel_irradiance;
pub use lens::{FrontStop, ThinLens};
pub use own_rays::{FilmRay, FilmRays};
pub use rays::{Hole, Rays};
pub use statistics::PixelStatistics;
pub use telecentric::TelecentricLens;
pub use view::View;
