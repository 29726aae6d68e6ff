//! A safe Rust layer for authors of BRDF plugins: implement [`Model`], name it in [`export!`],
//! compile as a `cdylib`.
//!
//! Conventions (those of the C header, `radsight_brdf_abi::HEADER`): directions are unit vectors
//! that point away from the surface, in a frame with +z on the shading normal; `f` is in 1/sr
//! without the cosine; densities are per solid angle.
//!
//! Guarantees: a panic never crosses the interface, but becomes a status and a message; the
//! parameters passed to [`Model::create`] have the kinds and ranges of the model's table. The crate
//! knows neither the host nor scenes.
//!
//! ```
//! use radsight_brdf_sdk::{CreateError, DVec3, Description, Lobes, Model, Parameter, Parameters};
//! use std::f64::consts::FRAC_1_PI;
//!
//! struct Chalk { reflectance: Vec<f64> }
//!
//! impl Model for Chalk {
//!     const DESCRIPTION: Description = Description {
//!         lobes: Lobes { diffuse: true, ..Lobes::NONE },
//!         reciprocal: true,
//!         parameters: &[Parameter::spectrum("reflectance", "1", "share of light that is reflected").within(0.0, 1.0)],
//!         ..Description::new("chalk", "ideal diffuse reflection")
//!     };
//!     fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
//!         Ok(Chalk { reflectance: parameters.spectrum("reflectance").to_vec() })
//!     }
//!     fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
//!         let lit = outgoing.z > 0.0 && incident.z > 0.0;
//!         for (value, reflectance) in values.iter_mut().zip(&self.reflectance) {
//!             *value = if lit { reflectance * FRAC_1_PI } else { 0.0 };
//!         }
//!     }
//! }
//! radsight_brdf_sdk::export!(Chalk);
//! # assert_eq!(radsight_brdf_entry.0.abi_major, 1);
//! ```

mod angle;
mod describe;
mod ffi;
mod fresnel;
mod ggx;
mod model;
mod spectrum;

pub use angle::{angle_between, cosine_hemisphere, cosine_pdf, direction_near, frame, mirror};
pub use describe::{Description, Lobes, Parameter};
pub use fresnel::{fresnel_conductor, fresnel_dielectric};
pub use ggx::{Ggx, Reflection};
pub use glam::DVec3;
pub use model::{CreateError, EvalBatch, Model, Parameters, Sample};
pub use radsight_brdf_abi::Band;
pub use spectrum::{rgb_of_band, sample_band};

/// Implementation of the macro [`export!`]; not for authors.
#[doc(hidden)]
pub mod private {
    pub use crate::ffi::{EntryConstant, Table, count, create, describe, extension, model_functions};
    pub use radsight_brdf_abi as abi;
    pub use std::ffi::{c_char, c_void};
}

/// Exports models: `export!(OrenNayar, Lambert);`, or with a manual page
/// `export!(manual = TEXT; OrenNayar);`.
///
/// `TEXT` may be `include_str!("lib.rs")`: the page is then the file's leading `//!` lines.
#[macro_export]
macro_rules! export {
    (manual = $manual:expr; $($model:ty),+ $(,)?) => {
        static RADSIGHT_BRDF_TABLE: $crate::private::Table =
            $crate::private::Table::new(&[$($crate::private::model_functions::<$model>()),+], $manual);

        /// The exported constant, which the host loads.
        #[unsafe(no_mangle)]
        #[allow(non_upper_case_globals)]
        pub static radsight_brdf_entry: $crate::private::EntryConstant = {
            use $crate::private::{abi, c_char, c_void};
            extern "C" fn count() -> u32 {
                $crate::private::count(&RADSIGHT_BRDF_TABLE)
            }
            extern "C" fn describe(index: u32) -> *const abi::Model {
                $crate::private::describe(&RADSIGHT_BRDF_TABLE, index)
            }
            unsafe extern "C" fn create(index: u32, call: *const abi::Create, instance: *mut abi::Instance) -> abi::Status {
                // SAFETY: the host passes what the header promises.
                unsafe { $crate::private::create(&RADSIGHT_BRDF_TABLE, index, call, instance) }
            }
            unsafe extern "C" fn extension(name: *const c_char, revision: u32) -> *const c_void {
                // SAFETY: the host passes what the header promises.
                unsafe { $crate::private::extension(&RADSIGHT_BRDF_TABLE, name, revision) }
            }
            $crate::private::EntryConstant::new(count, describe, create, extension)
        };
    };
    ($($model:ty),+ $(,)?) => { $crate::export!(manual = ""; $($model),+); };
}
