//! A plugin's model with its parameters, as a [`Brdf`].

use crate::faults::{FaultCounts, FaultReport, Faults};
use crate::functions::{Functions, RawSample};
use crate::guard::{self, Breadcrumb};
use crate::isolate::Question;
use crate::library::Home;
use crate::self_check::{SelfCheck, self_check};
use crate::table::Arguments;
use crate::{Error, Library, ModelInfo};
use glam::DVec3;
use radsight_brdf::{Brdf, BrdfSample, Density, Lobes};
use radsight_brdf_abi as abi;
use radsight_brdf_abi::{Band, flags, sample_kind, status};
use std::sync::Arc;

/// Material of an instance and its position, for messages.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Label {
    /// Name of the material.
    pub material: String,
    /// Such as `scene.rad:12:1`.
    pub place: String,
}

/// A plugin's model with its parameters.
///
/// Every value that a plugin returns is checked: a number that is not finite or is negative becomes
/// 0 and is counted, see [`PluginBrdf::faults`].
pub struct PluginBrdf {
    library: Arc<Library>,
    model: ModelInfo,
    label: Label,
    bands: usize,
    lobes: Lobes,
    home: Made,
    in_eval: Breadcrumb,
    in_sample: Breadcrumb,
    in_destroy: Breadcrumb,
    faults: Faults,
}

/// Result of `create`.
enum Made {
    /// An instance in this process.
    Here(Functions),
    /// Number of an instance in the library's process.
    There(u32),
}

impl std::fmt::Debug for PluginBrdf {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.debug_struct("PluginBrdf")
            .field("library", &self.library.name())
            .field("model", &self.model.name)
            .field("label", &self.label)
            .field("faults", &self.faults.counts())
            .finish_non_exhaustive()
    }
}

impl PluginBrdf {
    /// Makes an instance from arguments that were checked against the model's table.
    pub(crate) fn create(
        library: Arc<Library>,
        index: u32,
        arguments: &Arguments,
        bands: &[Band],
        label: Label,
    ) -> Result<PluginBrdf, Error> {
        let model = library.models()[index as usize].clone();
        Self::create_as(library, model, index, arguments, bands, label)
    }

    fn create_as(
        library: Arc<Library>,
        model: ModelInfo,
        index: u32,
        arguments: &Arguments,
        bands: &[Band],
        label: Label,
    ) -> Result<PluginBrdf, Error> {
        let breadcrumb =
            |activity| Breadcrumb::for_model(library.name(), &model.name, &label.material, &label.place, activity);
        let (home, flags) = match library.home() {
            Home::Here(loaded) => {
                let crumb = breadcrumb("create");
                let (functions, flags) = Functions::create(&library, loaded, &model, index, arguments, bands, crumb)?;
                (Made::Here(functions), flags)
            }
            Home::There(worker) => {
                let (id, flags) = worker.create(index, arguments, bands, &label, breadcrumb("create"))?;
                (Made::There(id), flags)
            }
        };
        let has = |flag| flags & flag != 0;
        Ok(PluginBrdf {
            lobes: Lobes {
                diffuse: has(flags::DIFFUSE),
                glossy: has(flags::GLOSSY),
                delta: has(flags::DELTA),
                transmission: has(flags::TRANSMISSION),
            },
            in_eval: breadcrumb("eval_pdf"),
            in_sample: breadcrumb("sample"),
            in_destroy: breadcrumb("destroy"),
            model,
            label,
            bands: bands.len(),
            home,
            faults: Faults::default(),
            library,
        })
    }

    /// As [`PluginBrdf::create`], for checks that pass invalid arguments: no index is looked up in
    /// the tables.
    pub(crate) fn create_unchecked(
        library: Arc<Library>,
        index: u32,
        arguments: &Arguments,
        bands: &[Band],
        label: Label,
    ) -> Result<PluginBrdf, Error> {
        let model = library.models().get(index as usize).cloned().unwrap_or_else(ModelInfo::unknown);
        Self::create_as(library, model, index, arguments, bands, label)
    }

    /// Library of the model.
    #[must_use]
    pub fn library(&self) -> &Arc<Library> {
        &self.library
    }

    /// Description of the model.
    #[must_use]
    pub fn model(&self) -> &ModelInfo {
        &self.model
    }

    /// Number of bands.
    #[must_use]
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// Lobes as flags of the interface.
    #[cfg(target_os = "linux")]
    pub(crate) fn lobe_flags(&self) -> u32 {
        let of = |has: bool, flag: u32| if has { flag } else { 0 };
        of(self.lobes.diffuse, flags::DIFFUSE)
            | of(self.lobes.glossy, flags::GLOSSY)
            | of(self.lobes.delta, flags::DELTA)
            | of(self.lobes.transmission, flags::TRANSMISSION)
    }

    /// Findings of the self-check.
    pub(crate) fn quick_check(&self, mode: SelfCheck) -> Vec<String> {
        match (&self.home, self.library.home()) {
            // Its many calls are faster in the plugin's process.
            (Made::There(id), Home::There(worker)) if mode != SelfCheck::Off => {
                worker.self_check(*id, self.in_self_check())
            }
            _ => self_check(self, mode),
        }
    }

    /// Description of the calls of a self-check.
    pub(crate) fn in_self_check(&self) -> Breadcrumb {
        let Label { material, place } = &self.label;
        Breadcrumb::for_model(self.library.name(), &self.model.name, material, place, "eval_pdf or sample")
    }

    /// Counts of invalid results so far.
    #[must_use]
    pub fn faults(&self) -> FaultCounts {
        self.faults.counts()
    }

    /// Faults with material and position, if there are any.
    #[must_use]
    pub fn fault_report(&self) -> Option<FaultReport> {
        let counts = self.faults();
        (counts.total() > 0).then(|| FaultReport {
            material: self.label.material.clone(),
            place: self.label.place.clone(),
            library: self.library.name().to_owned(),
            model: self.model.name.clone(),
            counts,
            first: self.faults.first(),
        })
    }

    /// The numbers exactly as the plugin returns them, neither counted nor replaced; those of a
    /// failed call are NaN.
    #[must_use]
    pub fn unfiltered(&self) -> Unfiltered<'_> {
        Unfiltered(self)
    }

    /// Calls the plugin's `eval_pdf` on arrays in the plugin's layout.
    #[inline]
    pub(crate) fn call_eval(
        &self,
        outgoing: DVec3,
        incident: [&[f64]; 3],
        values: &mut [f64],
        pdfs: &mut [f64],
    ) -> abi::Status {
        debug_assert!(incident.iter().all(|axis| axis.len() == pdfs.len()) && values.len() == pdfs.len() * self.bands);
        let _trail = guard::enter_at(self.in_eval, outgoing.to_array());
        match (&self.home, self.library.home()) {
            (Made::Here(functions), _) => functions.eval(outgoing, incident, values, pdfs),
            (Made::There(id), Home::There(worker)) => {
                worker.eval(*id, self.in_eval, Question { outgoing, incident }, values, pdfs)
            }
            // An instance is always in the process of its library.
            _ => status::INTERNAL,
        }
    }

    #[inline]
    pub(crate) fn call_sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> (abi::Status, RawSample) {
        let _trail = guard::enter_at(self.in_sample, outgoing.to_array());
        match (&self.home, self.library.home()) {
            (Made::Here(functions), _) => functions.sample(outgoing, u, weights),
            (Made::There(id), Home::There(worker)) => worker.sample(*id, self.in_sample, outgoing, u, weights),
            _ => (status::INTERNAL, RawSample::NOTHING),
        }
    }

    /// Evaluates in the plugin's layout and returns the unchecked numbers in radsight's layout.
    #[inline]
    fn eval_raw(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) -> abi::Status {
        // Values that a plugin does not write are detected as NaN.
        values.fill(f64::NAN);
        pdfs.fill(f64::NAN);
        if let [single] = incident {
            let axes = [&single.x, &single.y, &single.z].map(std::slice::from_ref);
            return self.call_eval(outgoing, axes, values, pdfs);
        }
        if incident.is_empty() {
            return self.call_eval(outgoing, [&[]; 3], values, pdfs);
        }
        let mut status = status::OK;
        let batches = incident.chunks(LARGEST_BATCH).zip(values.chunks_mut(LARGEST_BATCH * self.bands));
        for ((incident, values), pdfs) in batches.zip(pdfs.chunks_mut(LARGEST_BATCH)) {
            let found = if incident.len() <= SMALL_BATCH {
                self.eval_batch::<SMALL_BATCH>(outgoing, incident, values, pdfs)
            } else {
                self.eval_batch::<LARGEST_BATCH>(outgoing, incident, values, pdfs)
            };
            if found != status::OK {
                status = found;
            }
        }
        status
    }

    /// Evaluates at most `MOST` directions: clearing the arrays of a large batch would cost as much
    /// as evaluating a small one.
    fn eval_batch<const MOST: usize>(
        &self,
        outgoing: DVec3,
        incident: &[DVec3],
        values: &mut [f64],
        pdfs: &mut [f64],
    ) -> abi::Status {
        let mut axes = [[0.0; MOST]; 3];
        let [x, y, z] = &mut axes;
        for (index, direction) in incident.iter().enumerate() {
            (x[index], y[index], z[index]) = (direction.x, direction.y, direction.z);
        }
        let count = incident.len();
        let axes = [&x[..count], &y[..count], &z[..count]];
        if self.bands == 1 {
            return self.call_eval(outgoing, axes, values, pdfs);
        }
        let mut few = [[f64::NAN; MOST]; FEW_BANDS];
        let mut many = Vec::new();
        let by_band = match few.as_flattened_mut().get_mut(..count * self.bands) {
            Some(by_band) => by_band,
            None => {
                many.resize(count * self.bands, f64::NAN);
                &mut many[..]
            }
        };
        let status = self.call_eval(outgoing, axes, by_band, pdfs);
        for (index, value) in values.iter_mut().enumerate() {
            *value = by_band[(index % self.bands) * count + index / self.bands];
        }
        status
    }
}

/// Maximum number of directions per call.
const LARGEST_BATCH: usize = 64;
/// Number of lights of a common ring.
const SMALL_BATCH: usize = 16;
/// Up to this number of bands a batch needs no heap memory.
const FEW_BANDS: usize = 4;

impl Drop for PluginBrdf {
    fn drop(&mut self) {
        match (&self.home, self.library.home()) {
            (Made::Here(functions), Home::Here(loaded)) => {
                let _one_thread = loaded.one_thread();
                guard::check_files();
                {
                    let _trail = guard::enter(self.in_destroy);
                    functions.destroy();
                }
                guard::after_call(self.in_destroy);
            }
            (Made::There(id), Home::There(worker)) => worker.destroy(*id, self.in_destroy),
            _ => {}
        }
    }
}

impl Brdf for PluginBrdf {
    fn lobes(&self) -> Lobes {
        self.lobes
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        let status = self.eval_raw(outgoing, incident, values, pdfs);
        if status != status::OK {
            self.faults.failed_call("eval_pdf", status, outgoing);
            values.fill(0.0);
            pdfs.fill(0.0);
            return;
        }
        let bands = self.bands;
        for (index, value) in values.iter_mut().enumerate() {
            if !is_sound(*value) {
                self.faults.bad_number("value", *value, outgoing, incident[index / bands]);
                *value = 0.0;
            }
        }
        for (pdf, incident) in pdfs.iter_mut().zip(incident) {
            if !is_sound(*pdf) {
                self.faults.bad_number("pdf", *pdf, outgoing, *incident);
                *pdf = 0.0;
            }
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let (status, sampled) = self.call_sample(outgoing, u, weights);
        if status != status::OK {
            self.faults.failed_call("sample", status, outgoing);
            return None;
        }
        let incident = DVec3::from_array(sampled.incident);
        let density = match sampled.kind {
            sample_kind::ABSORBED => return None,
            sample_kind::DELTA => Density::Delta,
            sample_kind::CONTINUOUS if sampled.pdf > 0.0 && sampled.pdf <= f64::MAX => Density::Continuous(sampled.pdf),
            kind if kind > sample_kind::DELTA => {
                self.faults.bad_sample(&format!("sample of the unknown kind {kind}"), outgoing, incident);
                return None;
            }
            _ => {
                self.faults.bad_sample("sampled direction with a density that is not above zero", outgoing, incident);
                return None;
            }
        };
        let is_unit = (incident.length_squared() - 1.0).abs() < UNIT_TOLERANCE;
        if !is_unit {
            self.faults.bad_sample("sampled direction that is not a unit vector", outgoing, incident);
            return None;
        }
        for weight in weights {
            if !is_sound(*weight) {
                self.faults.bad_number("weight", *weight, outgoing, incident);
                *weight = 0.0;
            }
        }
        Some(BrdfSample { incident, density })
    }
}

/// Tolerance of the squared length of a sampled direction.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Whether a number is finite and not negative.
#[inline]
fn is_sound(number: f64) -> bool {
    (0.0..=f64::MAX).contains(&number)
}

/// A plugin's model without filtering, for checks.
#[derive(Clone, Copy, Debug)]
pub struct Unfiltered<'a>(&'a PluginBrdf);

impl Brdf for Unfiltered<'_> {
    fn lobes(&self) -> Lobes {
        self.0.lobes
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        if self.0.eval_raw(outgoing, incident, values, pdfs) != status::OK {
            values.fill(f64::NAN);
            pdfs.fill(f64::NAN);
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        weights.fill(f64::NAN);
        let (status, sampled) = self.0.call_sample(outgoing, u, weights);
        let failed = status != status::OK || sampled.kind > sample_kind::DELTA;
        if sampled.kind == sample_kind::ABSORBED && !failed {
            return None;
        }
        let density = match sampled.kind {
            sample_kind::DELTA if !failed => Density::Delta,
            _ => Density::Continuous(if failed { f64::NAN } else { sampled.pdf }),
        };
        Some(BrdfSample { incident: DVec3::from_array(sampled.incident), density })
    }
}
