//! Retroreflector models: surfaces that send light back to where it comes from.
//!
//! δ is always the angle between the outgoing and the incident direction (the *observation angle* of retroreflectometry), taken
//! from the chord, never from the cosine: a lobe is a fraction of a degree wide.
//!
//! Knows neither scenes nor renderers.
//!
//! ```
//! use radsight_retro::Paper1991;
//! use glam::DVec3;
//! let sheet = Paper1991 { reflectance: [0.086], spread: 0.00612 };
//! let peak = sheet.reflected_density(0.0);
//! // More than 300 times a white Lambertian surface, as the paper says of the sheeting.
//! assert!(0.086 * peak > 50.0 / std::f64::consts::PI);
//! # let _ = DVec3::Z;
//! ```
#![forbid(unsafe_code)]

mod gaussian;

pub use gaussian::{Paper1991, ReciprocalGaussian, observation_angle};
