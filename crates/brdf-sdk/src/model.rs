//! What an author implements.

use crate::{Description, Lobes, Parameter, angle};
use glam::DVec3;
use radsight_brdf_abi::{Band, kind};

/// A reflectance model with its parameters.
///
/// [`create`](Model::create) and [`value`](Model::value) suffice: such a model is sampled by the cosine. A narrow lobe also needs
/// [`pdf`](Model::pdf) and [`sample_direction`](Model::sample_direction), which must agree with each other; a fast model
/// overrides [`eval_pdf`](Model::eval_pdf) and [`sample`](Model::sample), a vectorised one [`eval_batch`](Model::eval_batch), and
/// a model with delta lobes needs its own [`sample`](Model::sample).
///
/// All functions but `create` are called from many threads at once.
pub trait Model: Sized + Send + Sync + 'static {
    /// Name, table of parameters, lobes, claims.
    const DESCRIPTION: Description;

    /// Makes an instance.
    ///
    /// # Errors
    /// When the parameters do not fit together, or a file that they name cannot be read.
    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError>;

    /// The lobes that this instance has.
    fn lobes(&self) -> Lobes {
        Self::DESCRIPTION.lobes
    }

    /// `f` in 1/sr, one value for each band, zero where the model does not reflect. Directions of either side and grazing ones occur.
    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]);

    /// The density of [`sample_direction`](Model::sample_direction), 1/sr.
    #[inline]
    fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        if outgoing.z > 0.0 { angle::cosine_pdf(incident) } else { 0.0 }
    }

    /// An incident direction for the point `u` of the unit cube: `u[0]` and `u[1]` place it, `u[2]` chooses a lobe.
    #[inline]
    fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        (outgoing.z > 0.0).then(|| angle::cosine_hemisphere(u[0], u[1]))
    }

    /// Fills `values` as [`value`](Model::value) does and returns the density.
    #[inline]
    fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        self.value(outgoing, incident, values);
        self.pdf(outgoing, incident)
    }

    /// Draws an incident direction and fills `weights` with `f·|cos θ_i|/pdf`, one for each band.
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
            // In one band the values of a direction stand side by side anyway.
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

/// What [`Model::sample`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    /// Nothing.
    Absorbed,
    /// A direction with a density.
    Continuous {
        /// Unit, local frame, away from the surface.
        incident: DVec3,
        /// 1/sr, over all lobes of finite width.
        pdf: f64,
    },
    /// A perfectly specular direction. Its weight is the reflectance divided by the probability of the choice.
    Delta {
        /// Unit, local frame, away from the surface.
        incident: DVec3,
    },
}

/// A batch of incident directions in structure-of-arrays form.
#[derive(Debug)]
pub struct EvalBatch<'a> {
    /// Unit, local frame, away from the surface.
    pub outgoing: DVec3,
    /// x of each incident direction.
    pub incident_x: &'a [f64],
    /// y of each.
    pub incident_y: &'a [f64],
    /// z of each.
    pub incident_z: &'a [f64],
    /// To be filled: `f` in 1/sr, element `[band · count + direction]`.
    pub values: &'a mut [f64],
    /// To be filled: 1/sr, one for each direction.
    pub pdfs: &'a mut [f64],
    /// One number for each band, for intermediate results.
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

/// Why an instance cannot be made. Messages: lower case, no full stop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CreateError {
    /// A parameter does not fit.
    Parameter {
        /// Its name in the table.
        name: &'static str,
        /// What is wrong with it.
        message: String,
    },
    /// A file cannot be read or understood.
    File {
        /// The name of the parameter that names it.
        name: &'static str,
        /// What is wrong with it.
        message: String,
    },
    /// Such as a number of bands that the model cannot do.
    Unsupported(String),
}

/// The parameters of an instance: complete, and checked against the model's table.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<'a> {
    pub(crate) table: &'static [Parameter],
    pub(crate) numbers: &'a [f64],
    pub(crate) words: &'a [&'a str],
    pub(crate) bands: &'a [Band],
}

impl<'a> Parameters<'a> {
    /// For tests of a model without a host: numbers with one for each band of a spectrum, and words, in the table's order.
    #[must_use]
    pub fn new<M: Model>(numbers: &'a [f64], words: &'a [&'a str], bands: &'a [Band]) -> Self {
        Parameters { table: M::DESCRIPTION.parameters, numbers, words, bands }
    }

    /// The bands to work in; at least one.
    #[must_use]
    pub fn bands(&self) -> &'a [Band] {
        self.bands
    }

    /// The number with this name in the table.
    ///
    /// # Panics
    /// When the table has no such number: a mistake of the plugin.
    #[must_use]
    pub fn number(&self, name: &str) -> f64 {
        self.find_numbers(name)[0]
    }

    /// The spectrum with this name in the table, one number for each band.
    ///
    /// # Panics
    /// When the table has no such spectrum: a mistake of the plugin.
    #[must_use]
    pub fn spectrum(&self, name: &str) -> &'a [f64] {
        self.find_numbers(name)
    }

    /// The word, choice or file with this name in the table.
    ///
    /// # Panics
    /// When the table has no such word: a mistake of the plugin.
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
