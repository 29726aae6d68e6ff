//! What a plugin hands to its host: its tables, its answers to `create`, and what its functions
//! return.
//!
//! The bytes say what stands in the tables and what comes back; pointers are null or good, since
//! nobody can tell others.
#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use glam::DVec3;
use radsight_brdf::Brdf;
use radsight_brdf_abi as abi;
use radsight_brdf_host::{Band, Label, Library, Registry, Request, SearchPath, SelfCheck};
use std::cell::RefCell;
use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Arc;

/// Texts of a table; they stay.
const TEXTS: [*const c_char; 6] =
    [c"m".as_ptr(), c"rho".as_ptr(), c"".as_ptr(), c"a|b||a".as_ptr(), c"\xff\xfe bad".as_ptr(), null()];

#[derive(Debug, Arbitrary)]
struct Row {
    texts: [u8; 6],
    kind: u8,
    flags: u8,
    numbers: [f64; 3],
}

#[derive(Debug, Arbitrary)]
struct Plugin {
    versions: [u8; 2],
    entry_size: u16,
    functions: u8,
    models: u8,
    model_size: u8,
    stride: u8,
    row_count: u8,
    rows: [Row; 3],
    name: u8,
    status: u8,
    scratch: [u16; 2],
    /// Given back one after another.
    answers: Vec<u64>,
    kinds: u8,
    words: u8,
    numbers: Vec<f64>,
    bands: u8,
}

thread_local! {
    /// The plugin that the functions below speak for, and how many answers it gave.
    static CURRENT: RefCell<Option<(Plugin, abi::Model, usize)>> = const { RefCell::new(None) };
}

fn with<R: Default>(block: impl FnOnce(&Plugin, &abi::Model, &mut usize) -> R) -> R {
    CURRENT.with_borrow_mut(|current| current.as_mut().map(|(p, model, at)| block(p, model, at)).unwrap_or_default())
}

fn answer(plugin: &Plugin, at: &mut usize) -> f64 {
    *at += 1;
    plugin.answers.get(*at % plugin.answers.len().max(1)).map_or(0.25, |bits| f64::from_bits(*bits))
}

unsafe extern "C" fn count() -> u32 {
    with(|plugin, _, _| u32::from(plugin.models))
}

unsafe extern "C" fn describe(index: u32) -> *const abi::Model {
    let at =
        with(|plugin, model, _| if u32::from(plugin.models) > index { std::ptr::from_ref(model) as usize } else { 0 });
    at as *const abi::Model
}

unsafe extern "C" fn create(_: u32, call: *const abi::Create, instance: *mut abi::Instance) -> abi::Status {
    with(|plugin, _, _| {
        // SAFETY: the host's own structures.
        let (error, instance) = unsafe { ((*call).error, &mut *instance) };
        if plugin.status > 7 && !error.is_null() {
            // SAFETY: the host's, too; a message without its final zero byte.
            unsafe {
                ((*error).parameter, (*error).message) =
                    (i32::from(plugin.kinds) - 5, [b'x' as c_char; abi::MESSAGE_BYTES])
            };
        }
        instance.struct_size = size_of::<abi::Instance>() as u32;
        instance.flags = u32::from(plugin.words);
        instance.scratch_bytes = u64::from(plugin.scratch[0]);
        instance.scratch_bytes_per_direction = u64::from(plugin.scratch[1]);
        instance.data = null_mut();
        instance.eval_pdf = (plugin.functions & 8 == 0).then_some(eval as abi::EvalFn);
        instance.sample = (plugin.functions & 16 == 0).then_some(sample as abi::SampleFn);
        instance.destroy = None;
        u32::from(plugin.status / 2)
    })
}

unsafe extern "C" fn eval(_: *const c_void, call: *const abi::Eval) -> abi::Status {
    with(|plugin, _, at| {
        // SAFETY: the arrays have the sizes that the header says.
        let call = unsafe { &*call };
        for index in 0..call.count as usize {
            unsafe { *call.pdfs.add(index) = answer(plugin, at) };
            for band in 0..bands_of(plugin) {
                unsafe { *call.values.add(band * call.count as usize + index) = answer(plugin, at) };
            }
        }
        u32::from(plugin.status % 2)
    })
}

unsafe extern "C" fn sample(_: *const c_void, call: *const abi::Sample) -> abi::Status {
    with(|plugin, _, at| {
        // SAFETY: as above.
        let call = unsafe { &*call };
        for index in 0..call.count as usize {
            unsafe {
                *call.incident_x.add(index) = answer(plugin, at);
                *call.incident_y.add(index) = answer(plugin, at);
                *call.incident_z.add(index) = answer(plugin, at);
                *call.pdfs.add(index) = answer(plugin, at);
                *call.kinds.add(index) = plugin.kinds;
            }
            for band in 0..bands_of(plugin) {
                unsafe { *call.weights.add(band * call.count as usize + index) = answer(plugin, at) };
            }
        }
        u32::from(plugin.status % 2)
    })
}

fn bands_of(plugin: &Plugin) -> usize {
    1 + usize::from(plugin.bands % 4)
}

fn text(index: u8) -> *const c_char {
    TEXTS[usize::from(index) % TEXTS.len()]
}

fn row(row: &Row) -> abi::Parameter {
    let [name, unit, doc, default_word, choices, _] = row.texts.map(text);
    let [default_number, minimum, maximum] = row.numbers;
    let (kind, flags) = (u32::from(row.kind % 8), u32::from(row.flags));
    abi::Parameter { name, unit, doc, kind, flags, default_number, minimum, maximum, default_word, choices }
}

/// Models as a plugin has them: all the rows that it promises are there.
fn model(plugin: &Plugin, rows: &[abi::Parameter]) -> abi::Model {
    abi::Model {
        struct_size: if plugin.model_size < 8 { u32::from(plugin.model_size) } else { size_of::<abi::Model>() as u32 },
        flags: u32::from(plugin.words),
        parameter_count: u32::from(plugin.row_count) % (rows.len() as u32 + 1),
        parameter_size: if plugin.stride < 8 { u32::from(plugin.stride) } else { size_of::<abi::Parameter>() as u32 },
        parameters: if plugin.stride == 255 { null() } else { rows.as_ptr() },
        name: text(plugin.name),
        summary: text(plugin.name.wrapping_add(3)),
        citation: null(),
    }
}

fn entry(plugin: &Plugin) -> abi::Entry {
    let size = size_of::<abi::Entry>() as u32;
    abi::Entry {
        magic: abi::MAGIC,
        abi_major: if plugin.versions[0] < 9 { u32::from(plugin.versions[0]) } else { abi::ABI_MAJOR },
        abi_minor: u32::from(plugin.versions[1]),
        struct_size: u32::from(plugin.entry_size).min(size).max(if plugin.functions & 32 == 0 { size } else { 0 }),
        reserved: 0,
        count: (plugin.functions & 1 == 0).then_some(count),
        describe: (plugin.functions & 2 == 0).then_some(describe),
        create: (plugin.functions & 4 == 0).then_some(create),
        extension: None,
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(plugin) = Plugin::arbitrary(&mut Unstructured::new(bytes)) else { return };
    let rows: Vec<abi::Parameter> = plugin.rows.iter().map(row).collect();
    let (model, entry) = (model(&plugin, &rows), entry(&plugin));
    let numbers = plugin.numbers.clone();
    let words = vec!["a".to_owned(); usize::from(plugin.words % 3)];
    let bands = vec![Band { centre_m: 550e-9, low_m: 500e-9, high_m: 600e-9 }; bands_of(&plugin)];
    CURRENT.set(Some((plugin, model, 0)));
    // SAFETY: the entry's functions keep to the sizes that the header says; only the numbers are
    // anything.
    let Ok(library) = (unsafe { Library::in_program("fuzzed", &entry) }) else { return };
    let library = Arc::new(library);
    let registry = Registry::new(SearchPath::default(), SelfCheck::Off);
    let names: Vec<String> = library.models().iter().map(|model| model.name.clone()).collect();
    let _ = (library.describe(), library.manual(), CString::new("x"));
    for name in names {
        let label = Label::default();
        let request = Request {
            library: "fuzzed",
            model: &name,
            words: &words,
            numbers: &numbers,
            bands: &bands,
            folder: None,
            label: &label,
        };
        let Ok(made) = registry.instantiate_from(Arc::clone(&library), &request) else { continue };
        use_brdf(&*made.brdf, bands.len());
    }
});

/// Whatever comes back, the picture gets numbers that are finite and not below zero.
fn use_brdf(brdf: &dyn Brdf, bands: usize) {
    let incident = [DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 1.0, 0.0), DVec3::NEG_Z];
    let (mut values, mut pdfs) = (vec![0.0; bands * incident.len()], [0.0; 4]);
    brdf.eval_pdf(DVec3::Z, &incident, &mut values, &mut pdfs);
    assert!(values.iter().chain(&pdfs).all(|value| value.is_finite() && *value >= 0.0), "{values:?} {pdfs:?}");
    let mut weights = vec![0.0; bands];
    for u in [[0.0; 3], [0.5, 0.25, 0.999]] {
        let Some(sample) = brdf.sample(DVec3::Z, u, &mut weights) else { continue };
        assert!((sample.incident.length() - 1.0).abs() < 1e-6, "{sample:?}");
        assert!(weights.iter().all(|weight| weight.is_finite() && *weight >= 0.0), "{weights:?}");
    }
}
