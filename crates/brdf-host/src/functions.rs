//! Functions of an instance, returned by `create`, and calls of them.

use crate::guard::{self, Breadcrumb};
use crate::library::{Loaded, c_strings};
use crate::scratch::with_scratch;
use crate::table::Arguments;
use crate::{Error, Library, ModelInfo, Token};
use glam::DVec3;
use radsight_brdf_abi as abi;
use radsight_brdf_abi::{Band, sample_kind, status};
use std::ffi::{c_char, c_void};

/// An instance made by the plugin.
pub(crate) struct Functions {
    data: *mut c_void,
    eval_pdf: abi::EvalFn,
    sample: abi::SampleFn,
    destroy: Option<abi::DestroyFn>,
    scratch_bytes: u64,
    scratch_bytes_per_direction: u64,
}

// SAFETY: the header lets any thread call `eval_pdf` and `sample`; `destroy` is called once, under
// the library's mutex.
unsafe impl Send for Functions {}
// SAFETY: as above.
unsafe impl Sync for Functions {}

/// Output of `sample`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RawSample {
    pub(crate) incident: [f64; 3],
    pub(crate) pdf: f64,
    pub(crate) kind: u8,
}

impl RawSample {
    /// Initial content, before the plugin writes.
    pub(crate) const NOTHING: RawSample =
        RawSample { incident: [f64::NAN; 3], pdf: f64::NAN, kind: sample_kind::ABSORBED };
}

/// Maximum scratch memory of a model.
const MOST_SCRATCH_BYTES: u64 = 1 << 30;

impl Functions {
    /// Calls `create`; also returns the flags of the lobes.
    pub(crate) fn create(
        library: &Library,
        loaded: &Loaded,
        model: &ModelInfo,
        index: u32,
        arguments: &Arguments,
        bands: &[Band],
        breadcrumb: Breadcrumb,
    ) -> Result<(Functions, u32), Error> {
        let made = call_create(library, loaded, model, index, arguments, bands, breadcrumb)?;
        let broken = |what: &str| Error::BrokenRule {
            library: library.name().to_owned(),
            what: format!("create of \"{}\" {what}", model.name),
        };
        let (Some(eval_pdf), Some(sample)) = (made.eval_pdf, made.sample) else {
            return Err(broken("gives no eval_pdf or no sample"));
        };
        let abi::Instance { flags, data, destroy, scratch_bytes, scratch_bytes_per_direction, .. } = made;
        if scratch_bytes.saturating_add(scratch_bytes_per_direction) > MOST_SCRATCH_BYTES {
            return Err(broken("asks for more than 1 GiB of scratch"));
        }
        Ok((Functions { data, eval_pdf, sample, destroy, scratch_bytes, scratch_bytes_per_direction }, flags))
    }

    /// Calls `eval_pdf` on arrays in the plugin's layout.
    #[inline]
    pub(crate) fn eval(
        &self,
        outgoing: DVec3,
        incident: [&[f64]; 3],
        values: &mut [f64],
        pdfs: &mut [f64],
    ) -> abi::Status {
        let count = pdfs.len();
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
            // SAFETY: `data` is alive; the arrays have the lengths of the header and live until the
            // call returns; scratch is as large and as aligned as asked.
            unsafe { (self.eval_pdf)(self.data, &raw const call) }
        })
    }

    /// Calls `sample` for one point.
    #[inline]
    pub(crate) fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> (abi::Status, RawSample) {
        let mut sampled = RawSample::NOTHING;
        let [incident_x, incident_y, incident_z] = sampled.incident.each_mut().map(std::ptr::from_mut);
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
                pdfs: &raw mut sampled.pdf,
                kinds: &raw mut sampled.kind,
                scratch,
            };
            // SAFETY: as in `eval`, with arrays of length one.
            unsafe { (self.sample)(self.data, &raw const call) }
        });
        (status, sampled)
    }

    /// Calls `destroy` under the library's mutex. No other function may be called afterwards.
    pub(crate) fn destroy(&self) {
        if let Some(destroy) = self.destroy {
            // SAFETY: made by `create`, destroyed once by the owner, and no call is under way since
            // that is the last one.
            unsafe { destroy(self.data) };
        }
    }
}

fn call_create(
    library: &Library,
    loaded: &Loaded,
    model: &ModelInfo,
    index: u32,
    arguments: &Arguments,
    bands: &[Band],
    breadcrumb: Breadcrumb,
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
        host: loaded.host(),
        error: &raw mut error,
    };
    let create = loaded.entry().create.ok_or_else(|| Error::BrokenRule {
        library: library.name().to_owned(),
        what: "the entry lacks create".to_owned(),
    })?;
    let status = {
        let _one_thread = loaded.one_thread();
        let _trail = guard::enter(breadcrumb);
        // SAFETY: all pointers lead to structures and arrays of the lengths stated, and live until
        // the call returns.
        unsafe { create(index, &raw const call, &raw mut made) }
    };
    guard::after_call(breadcrumb);
    if status == status::OK { Ok(made) } else { Err(refusal(library, model, status, &error)) }
}

/// Assigns a plugin's error about a parameter to that parameter's token.
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
