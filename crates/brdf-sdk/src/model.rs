//! The trait of reflectance models.

use crate::{Description, Lobes, Parameter, angle};
use glam::DVec3;
use radsight_brdf_abi::{Band, kind};

/// A reflectance model with its parameters.
///
/// [`create`](Model::create) and [`value`](Model::value) suffice: such a model is sampled by the
/// cosine. A narrow lobe also needs [`pdf`](Model::pdf) and
/// [`sample_direction`](Model::sample_direction), which must agree. A fast model overrides
/// [`eval_pdf`](Model::eval_pdf) and [`sample`](Model::sample), a vectorised one
/// [`eval_batch`](Model::eval_batch). A model with delta lobes needs its own
/// [`sample`](Model::sample).
///
/// All functions except `create` are called from many threads at once.
pub trait Model: Sized + Send + Sync + 'static {
    /// Name, parameter table, lobes and declared properties.
    const DESCRIPTION: Description;

    /// Makes an instance.
    ///
    /// # Errors
    /// If the parameters contradict each other, or a file cannot be read.
    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError>;

    /// Lobes of this instance.
    fn lobes(&self) -> Lobes {
        Self::DESCRIPTION.lobes
    }

    /// `f` in 1/sr, one value per band, zero where the model does not reflect. Directions may be on
    /// either side and at grazing angles.
    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]);

    /// Density of [`sample_direction`](Model::sample_direction), 1/sr.
    #[inline]
    fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        if outgoing.z > 0.0 { angle::cosine_pdf(incident) } else { 0.0 }
    }

    /// Samples an incident direction by the point `u` of the unit cube: `u[0]` and `u[1]` choose
    /// the direction, `u[2]` the lobe.
    #[inline]
    fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        (outgoing.z > 0.0).then(|| angle::cosine_hemisphere(u[0], u[1]))
    }

    /// Fills `values` like [`value`](Model::value), and returns the density.
    #[inline]
    fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        self.value(outgoing, incident, values);
        self.pdf(outgoing, incident)
    }

    /// Samples an incident direction, and fills `weights` with `f·|cos θ_i|/pdf`, one per band.
    #[inline]
    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
        let Some(incident) = self.sample_direction(outgoing, u) else { return Sample::Absorbed };
        let pdf = self.eval_pdf(outgoing, incident, weights);
        if pdf <= 0.0 {
            return Sample::Absorbed;
        }
        let factor = incident.z.abs() / pdf;
        weights.iter_mut().for_each(|weight| *weight *= factor);
        Sample::Continuous { incident, pdf }
    }

    /// Evaluates a batch of incident directions for one outgoing direction.
    #[inline]
    fn eval_batch(&self, batch: &mut EvalBatch<'_>) {
        let count = batch.pdfs.len();
        if count == 1 {
            batch.pdfs[0] = self.eval_pdf(batch.outgoing, batch.incident(0), batch.values);
            return;
        }
        if batch.scratch.len() == 1 {
            // With one band the layouts are equal.
            for index in 0..count {
                let (incident, value) = (batch.incident(index), &mut batch.values[index..=index]);
                batch.pdfs[index] = self.eval_pdf(batch.outgoing, incident, value);
            }
            return;
        }
        for index in 0..count {
            batch.pdfs[index] = self.eval_pdf(batch.outgoing, batch.incident(index), batch.scratch);
            for (band, value) in batch.scratch.iter().enumerate() {
                batch.values[band * count + index] = *value;
            }
        }
    }
}

/// Result of [`Model::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    /// Absorption.
    Absorbed,
    /// A direction with a density.
    Continuous {
        /// Incident direction: unit, local frame, away from the surface.
        incident: DVec3,
        /// Density in 1/sr, over all lobes of finite width.
        pdf: f64,
    },
    /// A perfectly specular direction. Its weight is the reflectance over the probability of
    /// choosing it.
    Delta {
        /// Incident direction: unit, local frame, away from the surface.
        incident: DVec3,
    },
}

/// A batch of incident directions in structure-of-arrays form.
#[derive(Debug)]
pub struct EvalBatch<'a> {
    /// Outgoing direction: unit, local frame, away from the surface.
    pub outgoing: DVec3,
    /// x of each incident direction.
    pub incident_x: &'a [f64],
    /// y of each.
    pub incident_y: &'a [f64],
    /// z of each.
    pub incident_z: &'a [f64],
    /// Output: `f` in 1/sr, element `[band · count + direction]`.
    pub values: &'a mut [f64],
    /// Output: densities in 1/sr, one per direction.
    pub pdfs: &'a mut [f64],
    /// One number per band, for intermediate results.
    pub scratch: &'a mut [f64],
}

impl EvalBatch<'_> {
    /// One incident direction.
    #[inline]
    #[must_use]
    pub fn incident(&self, index: usize) -> DVec3 {
        DVec3::new(self.incident_x[index], self.incident_y[index], self.incident_z[index])
    }
}

/// Why an instance cannot be made. Messages are in lower case, without a full stop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CreateError {
    /// A parameter is invalid.
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// What is wrong with it.
        message: String,
    },
    /// A file cannot be read or parsed.
    File {
        /// Name of the parameter.
        name: &'static str,
        /// What is wrong with it.
        message: String,
    },
    /// Unsupported request, such as a number of bands.
    Unsupported(String),
}

/// Parameters of an instance: complete, and checked against the model's table.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<'a> {
    pub(crate) table: &'static [Parameter],
    pub(crate) numbers: &'a [f64],
    pub(crate) words: &'a [&'a str],
    pub(crate) bands: &'a [Band],
}

impl<'a> Parameters<'a> {
    /// Parameters for tests without a host: numbers with one per band of a spectrum, and words, in
    /// the table's order.
    #[must_use]
    pub fn new<M: Model>(numbers: &'a [f64], words: &'a [&'a str], bands: &'a [Band]) -> Self {
        Parameters { table: M::DESCRIPTION.parameters, numbers, words, bands }
    }

    /// Bands of the rendering, at least one.
    #[must_use]
    pub fn bands(&self) -> &'a [Band] {
        self.bands
    }

    /// The number of this name.
    ///
    /// # Panics
    /// If the table has no such number, which is an error of the plugin.
    #[must_use]
    pub fn number(&self, name: &str) -> f64 {
        self.find_numbers(name)[0]
    }

    /// The spectrum of this name, one number per band.
    ///
    /// # Panics
    /// If the table has no such spectrum, which is an error of the plugin.
    #[must_use]
    pub fn spectrum(&self, name: &str) -> &'a [f64] {
        self.find_numbers(name)
    }

    /// The word, choice or file of this name.
    ///
    /// # Panics
    /// If the table has no such word, which is an error of the plugin.
    #[must_use]
    pub fn word(&self, name: &str) -> &'a str {
        let mut words = self.words.iter();
        for row in self.table.iter().filter(|row| row.kind >= kind::WORD) {
            let word = words.next();
            if row.name == name {
                return word.expect("the host passes as many words as the table has");
            }
        }
        panic!("the table has no word named {name}");
    }

    fn find_numbers(&self, name: &str) -> &'a [f64] {
        let mut first = 0;
        for row in self.table.iter().filter(|row| row.kind <= kind::SPECTRUM) {
            let count = if row.kind == kind::SPECTRUM { self.bands.len() } else { 1 };
            if row.name == name {
                return &self.numbers[first..first + count];
            }
            first += count;
        }
        panic!("the table has no number named {name}");
    }
}
