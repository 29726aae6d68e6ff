//! The photon transfer method of EMVA Standard 1288, release 4.0 (linear), which characterises a
//! sensor by its pictures alone.
//!
//! [`measure`] takes the standard's series from a [`Device`]: pairs of pictures in the dark and in
//! steps of uniform illumination up to and beyond saturation, dark pictures of increasing exposure
//! times, and stacks of pictures in the dark and at half of saturation. [`evaluate`] estimates the
//! standard's quantities from their statistics, each with a 99 % confidence interval. Of the device
//! it uses only the pictures, the photons per pixel and the exposure time.
//!
//! Two estimators differ from the standard's, with the same expectation and less noise. Lines are
//! fitted with weights by the known variance of each point instead of equal weights. PRNU is the
//! spread of the difference of the two stacks, where the standard subtracts their variances.
//!
//! ```
//! use radsight_sensor::characterise::{Series, evaluate, measure};
//! use radsight_sensor::{BitDepth, Emva1288, Emva1288Description, EvenLight};
//! let sensor = Emva1288::new(&Emva1288Description {
//!     quantum_efficiency: 0.6,
//!     gain_dn_per_e: 0.25,
//!     dark_offset_dn: 60.0,
//!     dark_current_e_per_s: 500.0,
//!     read_noise_e: 12.0,
//!     full_well_e: 12000.0,
//!     bits: BitDepth::new(12)?,
//!     pixel_area_m2: 30e-12,
//!     wavelength_m: 550e-9,
//!     exposure_s: 0.01,
//! })?;
//! let series = measure(&EvenLight::new(sensor, [48, 32]), &Series { steps: 20, stack: 8 }, 7)?;
//! let found = evaluate(&series)?;
//! assert!(found.gain_dn_per_e.contains(0.25));
//! assert!(found.quantum_efficiency.contains(0.6));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod estimate;
mod line;
mod measure;
mod report;
mod spatial;

pub use error::CharacterisationError;
pub use estimate::{Characterisation, SpatialEstimate, evaluate};
pub use measure::{DarkStep, Device, LightStep, PhotonTransfer, Series, Stack, measure};
pub use report::{html, table};
