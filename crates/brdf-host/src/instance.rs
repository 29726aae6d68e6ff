//! A plugin's model with its parameters, as a [`Brdf`].

use crate::crash::{self, Breadcrumb};
use crate::faults::{FaultCounts, FaultReport, Faults};
use crate::library::c_strings;
use crate::scratch::with_scratch;
use crate::table::Arguments;
use crate::{Error, Library, ModelInfo, Token};
use glam::DVec3;
use radsight_brdf::{Brdf, BrdfSample, Density, Lobes};
use radsight_brdf_abi as abi;
use radsight_brdf_abi::{Band, flags, sample_kind, status};
use std::ffi::{c_char, c_void};
use std::sync::Arc;

/// Which material of which file an instance is for; only for messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// Name of the material.
    pub material: String,
    /// Such as `scene.rad:12:1`.
    pub place: String,
}

/// A plugin's model with its parameters.
///
/// What a plugin returns is checked at every call: a number that is not finite and ≥ 0 becomes 0 and is counted, see
/// [`PluginBrdf::faults`].
pub struct PluginBrdf {
    library: Arc<Library>,
    model: ModelInfo,
    label: Label,
    bands: usize,
    lobes: Lobes,
    data: *mut c_void,
    eval_pdf: abi::EvalFn,
    sample: abi::SampleFn,
    destroy: Option<abi::DestroyFn>,
    scratch_bytes: u64,
    scratch_bytes_per_direction: u64,
    in_eval: Breadcrumb,
    in_sample: Breadcrumb,
    in_destroy: Breadcrumb,
    faults: Faults,
}

// SAFETY: the header lets any thread call `eval_pdf` and `sample`; `destroy` is called once, under the library's mutex.
unsafe impl Send for PluginBrdf {}
// SAFETY: as above.
unsafe impl Sync for PluginBrdf {}

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
    /// Makes an instance from arguments that have been checked against the model's table.
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
        let made = call_create(&library, &model, index, arguments, bands, &breadcrumb("create"))?;
        let broken = |what: &str| Error::BrokenRule {
            library: library.name().to_owned(),
            what: format!("create of \"{}\" {what}", model.name),
        };
        let (Some(eval_pdf), Some(sample)) = (made.eval_pdf, made.sample) else {
            return Err(broken("gives no eval_pdf or no sample"));
        };
        if made.scratch_bytes.saturating_add(made.scratch_bytes_per_direction) > MOST_SCRATCH_BYTES {
            return Err(broken("asks for more than 1 GiB of scratch"));
        }
        let has = |flag| made.flags & flag != 0;
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
            data: made.data,
            eval_pdf,
            sample,
            destroy: made.destroy,
            scratch_bytes: made.scratch_bytes,
            scratch_bytes_per_direction: made.scratch_bytes_per_direction,
            faults: Faults::default(),
            library,
        })
    }

    /// As [`PluginBrdf::create`], for checks that pass what no host would: no index is looked up in the tables.
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

    /// The library that it is from.
    #[must_use]
    pub fn library(&self) -> &Arc<Library> {
        &self.library
    }

    /// Its model.
    #[must_use]
    pub fn model(&self) -> &ModelInfo {
        &self.model
    }

    /// How many bands it works in.
    #[must_use]
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// What it returned that a model must not, so far.
    #[must_use]
    pub fn faults(&self) -> FaultCounts {
        self.faults.counts()
    }

    /// Its faults with material and place, if there are any.
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

    /// The numbers exactly as the plugin returns them, neither counted nor replaced; those of a failed call are NaN.
    #[must_use]
    pub fn unfiltered(&self) -> Unfiltered<'_> {
        Unfiltered(self)
    }

    /// Calls `eval_pdf` of the plugin for arrays in its own form.
    #[inline]
    fn call_eval(&self, outgoing: DVec3, incident: [&[f64]; 3], values: &mut [f64], pdfs: &mut [f64]) -> abi::Status {
        let count = pdfs.len();
        debug_assert!(incident.iter().all(|axis| axis.len() == count) && values.len() == count * self.bands);
        let _trail = crash::enter(&self.in_eval);
        with_scratch(self.scratch_bytes, self.scratch_bytes_per_direction, count, |scratch| {
            let call = abi::Eval {
                struct_size: size_of::<abi::Eval>() as u32,
                count: count as u32,
                outgoing: outgoing.to_array(),
                incident_x: incident[0].as_ptr(),
                incident_y: incident[1].as_ptr(),
                incident_z: incident[2].as_ptr(),
                values: values.as_mut_ptr(),
                pdfs: pdfs.as_mut_ptr(),
                scratch,
            };
            // SAFETY: `data` is alive; the arrays have the lengths of the header and live until the call returns; scratch is as
            // large and as aligned as asked.
            unsafe { (self.eval_pdf)(self.data, &raw const call) }
        })
    }

    #[inline]
    fn call_sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> (abi::Status, Drawn) {
        let mut drawn = Drawn { incident: [f64::NAN; 3], pdf: f64::NAN, kind: sample_kind::ABSORBED };
        let [incident_x, incident_y, incident_z] = drawn.incident.each_mut().map(std::ptr::from_mut);
        let _trail = crash::enter(&self.in_sample);
        let status = with_scratch(self.scratch_bytes, self.scratch_bytes_per_direction, 1, |scratch| {
            let call = abi::Sample {
                struct_size: size_of::<abi::Sample>() as u32,
                count: 1,
                outgoing: outgoing.to_array(),
                u0: &raw const u[0],
                u1: &raw const u[1],
                u2: &raw const u[2],
                incident_x,
                incident_y,
                incident_z,
                weights: weights.as_mut_ptr(),
                pdfs: &raw mut drawn.pdf,
                kinds: &raw mut drawn.kind,
                scratch,
            };
            // SAFETY: as in `call_eval`, with arrays of length one.
            unsafe { (self.sample)(self.data, &raw const call) }
        });
        (status, drawn)
    }

    /// Evaluates in the plugin's form and gives the numbers back in ours, unchecked.
    #[inline]
    fn eval_raw(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) -> abi::Status {
        // What a plugin forgets to write is caught as NaN.
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

    /// At most `MOST` directions; clearing the arrays of a large batch would cost as much as evaluating a small one.
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

/// Directions that are handed over at once.
const LARGEST_BATCH: usize = 64;
/// As many as the lights of a usual ring.
const SMALL_BATCH: usize = 16;
/// Up to this many bands a batch takes no memory from the heap.
const FEW_BANDS: usize = 4;
/// No model needs more.
const MOST_SCRATCH_BYTES: u64 = 1 << 30;

/// What `sample` wrote.
#[derive(Clone, Copy)]
struct Drawn {
    incident: [f64; 3],
    pdf: f64,
    kind: u8,
}

impl Drop for PluginBrdf {
    fn drop(&mut self) {
        let Some(destroy) = self.destroy else { return };
        let _one_thread = self.library.one_thread();
        let _trail = crash::enter(&self.in_destroy);
        // SAFETY: made by `create`, destroyed once, and no call is under way since we are the last owner.
        unsafe { destroy(self.data) };
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
        let (status, drawn) = self.call_sample(outgoing, u, weights);
        if status != status::OK {
            self.faults.failed_call("sample", status, outgoing);
            return None;
        }
        let incident = DVec3::from_array(drawn.incident);
        let density = match drawn.kind {
            sample_kind::ABSORBED => return None,
            sample_kind::DELTA => Density::Delta,
            sample_kind::CONTINUOUS if drawn.pdf > 0.0 && drawn.pdf <= f64::MAX => Density::Continuous(drawn.pdf),
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

/// Of the squared length of a sampled direction.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Finite and not negative.
#[inline]
fn is_sound(number: f64) -> bool {
    (0.0..=f64::MAX).contains(&number)
}

/// A plugin's model without the safety net, for checks.
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
        let (status, drawn) = self.0.call_sample(outgoing, u, weights);
        let failed = status != status::OK || drawn.kind > sample_kind::DELTA;
        if drawn.kind == sample_kind::ABSORBED && !failed {
            return None;
        }
        let density = match drawn.kind {
            sample_kind::DELTA if !failed => Density::Delta,
            _ => Density::Continuous(if failed { f64::NAN } else { drawn.pdf }),
        };
        Some(BrdfSample { incident: DVec3::from_array(drawn.incident), density })
    }
}

fn call_create(
    library: &Library,
    model: &ModelInfo,
    index: u32,
    arguments: &Arguments,
    bands: &[Band],
    breadcrumb: &Breadcrumb,
) -> Result<abi::Instance, Error> {
    let words = c_strings(&arguments.words);
    let word_pointers: Vec<*const c_char> = words.iter().map(|word| word.as_ptr()).collect();
    let mut error =
        abi::Error { struct_size: size_of::<abi::Error>() as u32, parameter: -1, message: [0; abi::MESSAGE_BYTES] };
    let mut made = abi::Instance {
        struct_size: size_of::<abi::Instance>() as u32,
        flags: model.flags & 0xff,
        scratch_bytes: 0,
        scratch_bytes_per_direction: 0,
        data: std::ptr::null_mut(),
        eval_pdf: None,
        sample: None,
        destroy: None,
    };
    let call = abi::Create {
        struct_size: size_of::<abi::Create>() as u32,
        band_count: bands.len() as u32,
        bands: bands.as_ptr(),
        numbers: arguments.numbers.as_ptr(),
        words: word_pointers.as_ptr(),
        number_count: arguments.numbers.len() as u32,
        word_count: word_pointers.len() as u32,
        host: library.host(),
        error: &raw mut error,
    };
    let create = library.entry().create.ok_or_else(|| Error::BrokenRule {
        library: library.name().to_owned(),
        what: "the entry lacks create".to_owned(),
    })?;
    let status = {
        let _one_thread = library.one_thread();
        let _trail = crash::enter(breadcrumb);
        // SAFETY: all pointers lead to structures and arrays of the lengths stated, and live until the call returns.
        unsafe { create(index, &raw const call, &raw mut made) }
    };
    if status == status::OK { Ok(made) } else { Err(refusal(library, model, status, &error)) }
}

/// Puts what the plugin said about a parameter on that parameter's token.
fn refusal(library: &Library, model: &ModelInfo, status: abi::Status, error: &abi::Error) -> Error {
    let bytes: Vec<u8> = error.message.iter().map(|&c| c as u8).take_while(|&byte| byte != 0).collect();
    let said = String::from_utf8_lossy(&bytes);
    let row = usize::try_from(error.parameter).ok().filter(|&row| row < model.parameters.len());
    let token = row.map_or(Token::Model, |row| token_of_row(model, row));
    let parameter = row.map(|row| format!("{}: ", model.parameters[row].name)).unwrap_or_default();
    let message = match said.as_ref() {
        "" => format!("{parameter}{}", abi::status_name(status)),
        said => format!("{parameter}{said}"),
    };
    Error::Refused { library: library.name().to_owned(), model: model.name.clone(), token, message }
}

fn token_of_row(model: &ModelInfo, row: usize) -> Token {
    let before = &model.parameters[..row];
    if model.parameters[row].scene_numbers() == 0 {
        Token::Word(before.iter().filter(|other| other.scene_numbers() == 0).count())
    } else {
        Token::Number(before.iter().map(crate::ParameterInfo::scene_numbers).sum())
    }
}
