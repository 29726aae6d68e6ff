//! Irradiance caching: interpolates indirect irradiance between a few points where it was computed.
//!
//! A [`Hemisphere`] gives the directions of gather rays. Their results make a [`Record`]: the
//! irradiance, its gradients, and the distance up to which it is valid. A [`Cache`] stores records
//! by position, makes a [`Fit`] of each one's neighbourhood and interpolates between these.
//!
//! Ward, Rubinstein, Clear: A Ray Tracing Solution for Diffuse Interreflection, SIGGRAPH 1988.
//! Ward, Heckbert: Irradiance Gradients, EGWR 1992. Křivánek, Bouatouch, Pattanaik, Žára: Making
//! Radiance and Irradiance Caching Practical, EGSR 2006.
//!
//! Guarantees: no state except the records, so equal records in equal order give equal results.
//! Knows neither scenes nor rays: lengths are in the caller's unit, irradiance in that of radiance
//! times steradian.
//!
//! ```
//! use glam::DVec3;
//! use radsight_irradiance_cache::{Cache, GatheredRadiance, Hemisphere, Limits, Record, Unobstructed};
//! // A point in the middle of a large white box.
//! let hemisphere = Hemisphere::with_divisions(256);
//! let seen = vec![GatheredRadiance { radiance: [2.0], distance: 5.0 }; hemisphere.len()];
//! let limits = Limits { accuracy: 0.1, min_reach: 0.1, max_reach: 100.0, explained: 1.0 };
//! let record = Record::new(DVec3::ZERO, DVec3::Z, &hemisphere, &seen, &limits);
//! let mut cache = Cache::new(limits);
//! cache.insert(record, 0);
//! let [irradiance] = cache.irradiance(DVec3::new(0.1, 0.0, 0.0), DVec3::Z, DVec3::Z, &Unobstructed).unwrap();
//! assert!((irradiance - 2.0 * std::f64::consts::PI).abs() < 1e-9);
//! assert!(cache.irradiance(DVec3::new(3.0, 0.0, 0.0), DVec3::Z, DVec3::Z, &Unobstructed).is_none());
//! ```
#![forbid(unsafe_code)]

mod bands;
mod cache;
mod emitter;
mod emitter_model;
mod fit;
mod gradient;
mod grid;
mod hemisphere;
mod obstacles;
mod record;
mod saved;
mod stored;

pub use cache::{Cache, STRATA};
pub use emitter::GatherHit;
pub use fit::Fit;
pub use hemisphere::{GatheredRadiance, Hemisphere};
pub use obstacles::{Occluders, Unobstructed};
pub use record::{Limits, Record};
pub use stored::{Stored, StoredBytes};
