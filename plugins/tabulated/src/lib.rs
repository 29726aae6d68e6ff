//! tabulated: measured reflectance from files
//!
//! Reads the two public collections of measured materials: MERL (100 isotropic materials,
//! `.binary`) and RGL (isotropic and anisotropic materials, spectral and RGB, `.bsdf`).
//!
//! ```text
//! void brdfplugin brass
//! 3 tabulated merl brass.binary
//! 0
//! 0
//!
//! void brdfplugin foil
//! 3 tabulated rgl chm_orange_rgb.bsdf
//! 0
//! 1 .9
//! ```
//!
//! | model | arguments | unit | range |
//! |---|---|---|---|
//! | `merl` | word: file | | |
//! | | factor on all values | 1 | at least 0 (default 1) |
//! | `rgl` | word: file | | |
//! | | factor on all values | 1 | at least 0 (default 1) |
//!
//! `merl`: Matusik, Pfister, Brand and McMillan, "A Data-Driven Reflectance Model", SIGGRAPH 2003.
//! Its files have 90 × 90 × 180 values for each of red, green and blue over θ_h (by its square
//! root), θ_d and φ_d, after Rusinkiewicz, "A New Change of Variables for Efficient BRDF
//! Representation", EGWR 1998. Values are interpolated between the centres of cells. Measurements
//! end near 80°; negative (missing) values count as zero. The coordinates make the model
//! reciprocal.
//!
//! `rgl`: Dupuy and Jakob, "An Adaptive Parameterization for Efficient Material Acquisition and
//! Rendering", SIGGRAPH Asia 2018. A file with spectra is averaged over each band; one with RGB
//! serves three bands, and single bands by their wavelength. Measured values are not made
//! reciprocal.
//!
//! Measurements that reflect more than all light at grazing angles are used unchanged; the
//! self-check reports them.

mod merl;
mod rgl;
mod tensor_file;
mod warp;

use radsight_brdf_sdk::{CreateError, DVec3, Description, Lobes, Model, Parameter, Parameters, Sample};
use std::io::Read;

const FILE: Parameter = Parameter::file("file", "the measurement");
const FACTOR: Parameter = Parameter::number("factor", "1", "on all values").at_least(0.0).or(1.0);
/// The largest files of both collections have about 100 MB.
const MOST_BYTES: u64 = 1 << 30;

/// Reads the file that the parameter names.
fn read_file(parameters: &Parameters<'_>) -> Result<Vec<u8>, CreateError> {
    let path = parameters.word("file");
    let failure = |reason: String| CreateError::File { name: "file", message: format!("\"{path}\": {reason}") };
    let file = std::fs::File::open(path).map_err(|error| failure(error.to_string()))?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(|error| failure(error.to_string()))?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(failure("it is larger than 1 GiB".to_owned()));
    }
    Ok(bytes)
}

fn not_understood(parameters: &Parameters<'_>, reason: &str) -> CreateError {
    CreateError::File { name: "file", message: format!("\"{}\": {reason}", parameters.word("file")) }
}

struct Merl(merl::Measurement);

impl Model for Merl {
    const DESCRIPTION: Description = Description {
        citation: "Matusik et al., SIGGRAPH 2003",
        lobes: Lobes { glossy: true, diffuse: true, ..Lobes::NONE },
        reciprocal: true,
        parameters: &[FILE, FACTOR],
        ..Description::new("merl", "a measured material in MERL's format")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        let bytes = read_file(parameters)?;
        let measurement = merl::Measurement::read(&bytes, parameters.bands(), parameters.number("factor"));
        measurement.map(Merl).map_err(|reason| not_understood(parameters, &reason))
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        self.0.value(outgoing, incident, values);
    }

    fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        self.0.pdf(outgoing, incident)
    }

    fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        self.0.sample_direction(outgoing, u)
    }
}

struct Rgl(rgl::Measurement);

impl Model for Rgl {
    const DESCRIPTION: Description = Description {
        citation: "Dupuy and Jakob, SIGGRAPH Asia 2018",
        lobes: Lobes { glossy: true, diffuse: true, anisotropic: true, ..Lobes::NONE },
        parameters: &[FILE, FACTOR],
        ..Description::new("rgl", "a measured material in RGL's format")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        let bytes = read_file(parameters)?;
        let measurement = rgl::Measurement::read(&bytes, parameters.bands(), parameters.number("factor"));
        measurement.map(Rgl).map_err(|reason| not_understood(parameters, &reason))
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        self.0.eval_pdf(outgoing, incident, values);
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        self.0.eval_pdf(outgoing, incident, values)
    }

    fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        self.0.sample_direction(outgoing, u)
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
        let Some(incident) = self.0.sample_direction(outgoing, u) else { return Sample::Absorbed };
        let pdf = self.0.eval_pdf(outgoing, incident, weights);
        if pdf <= 0.0 || !pdf.is_finite() {
            return Sample::Absorbed;
        }
        weights.iter_mut().for_each(|weight| *weight *= incident.z / pdf);
        Sample::Continuous { incident, pdf }
    }
}

radsight_brdf_sdk::export!(manual = include_str!("lib.rs"); Merl, Rgl);
