//! Checks how a plugin handles wrong arguments, and whether it frees its memory.

use super::CHECK_BANDS;
use super::example::Example;
use super::job::{Response, instantiate};
use crate::guard::{self, Breadcrumb};
use crate::table::Arguments;
use crate::{Band, Error, Label, Library, ParameterKind, PluginBrdf};
use glam::DVec3;
use radsight_brdf::Brdf;
use std::sync::Arc;

/// The origin of a model's arguments.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    User,
    Generator,
}

/// Wrong indices, counts and numbers; empty batches; other numbers of bands.
pub(super) fn arguments(library: &Arc<Library>, index: u32, examples: &[Example], origin: Origin) -> Response {
    let mut response = Response::default();
    let made: Vec<_> = examples.iter().map(|example| (example, instantiate(library, example, &CHECK_BANDS))).collect();
    for (example, result) in &made {
        if let Err(error) = result {
            // Generated numbers may be an invalid combination; those of the user must be valid.
            let list = match origin {
                Origin::User => &mut response.findings,
                Origin::Generator => &mut response.notes,
            };
            list.push(format!("{example}: {error}"));
        }
    }
    let Some((_, Ok(brdf))) = made.iter().find(|(_, result)| result.is_ok()) else {
        if origin == Origin::Generator {
            response.findings.append(&mut response.notes);
        }
        return Response { unusable: true, ..response };
    };
    use_once(brdf);
    brdf.eval_pdf(DVec3::Z, &[], &mut [], &mut []);
    wrong_index(library, &mut response);
    wrong_counts(library, index, &mut response);
    wrong_numbers(library, index, examples);
    missing_file(library, index, examples, &mut response);
    other_bands(library, &examples[0], &mut response);
    response
}

fn wrong_index(library: &Arc<Library>, response: &mut Response) {
    let count = library.models().len() as u32;
    for index in [count, count + 1000, u32::MAX] {
        if describes(library, index) {
            response.findings.push(format!("describe({index}) is not NULL, but there are {count} models"));
        }
        if raw_create(library, index, &Arguments { numbers: vec![], words: vec![] }).is_ok() {
            response.findings.push(format!("create accepts model index {index}, but there are {count} models"));
        }
    }
    if !library.extension(c"radsight.no-such-extension", 1).is_null()
        || !library.extension(c"radsight.manual", 999).is_null()
    {
        response.findings.push("extension returns a pointer for a name or revision that does not exist".to_owned());
    }
}

/// Whether the library describes a model with this index.
fn describes(library: &Library, index: u32) -> bool {
    let Some(loaded) = library.loaded() else { return false };
    let Some(describe) = loaded.entry().describe else { return false };
    let _one_thread = loaded.one_thread();
    let _trail = guard::enter(Breadcrumb::for_library(library.name(), "describe"));
    // SAFETY: the header allows any index.
    !unsafe { describe(index) }.is_null()
}

fn wrong_counts(library: &Arc<Library>, index: u32, response: &mut Response) {
    let table = &library.models()[index as usize].parameters;
    if !table.is_empty() && raw_create(library, index, &Arguments { numbers: vec![], words: vec![] }).is_ok() {
        response.notes.push("create accepts a call without parameters although its table has some".to_owned());
    }
}

/// Passes numbers that the host would reject: the plugin must not crash, but it may accept them.
fn wrong_numbers(library: &Arc<Library>, index: u32, examples: &[Example]) {
    let model = &library.models()[index as usize];
    let Ok(right) = model.arguments(&examples[0].words, &examples[0].numbers, &CHECK_BANDS, None) else { return };
    for number in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e300, -1e300, 5e-324] {
        let wrong = Arguments { numbers: vec![number; right.numbers.len()], words: right.words.clone() };
        if let Ok(brdf) = raw_create(library, index, &wrong) {
            use_once(&brdf);
        }
    }
}

/// Evaluates and samples once, to see that the calls return.
fn use_once(brdf: &PluginBrdf) {
    let mut values = vec![0.0; brdf.bands()];
    brdf.eval_pdf(DVec3::Z, &[DVec3::new(0.6, 0.0, 0.8)], &mut values, &mut [0.0]);
    brdf.sample(DVec3::Z, [0.3, 0.6, 0.9], &mut values);
}

fn missing_file(library: &Arc<Library>, index: u32, examples: &[Example], response: &mut Response) {
    let model = &library.models()[index as usize];
    let Ok(right) = model.arguments(&examples[0].words, &examples[0].numbers, &CHECK_BANDS, None) else { return };
    let rows = model.parameters.iter().filter(|row| row.scene_numbers() == 0);
    for (word, row) in rows.enumerate().filter(|(_, row)| row.kind == ParameterKind::File) {
        for name in ["/nonexistent/file", "", "/", "\u{fffd}"] {
            let mut wrong = right.clone();
            wrong.words[word] = name.to_owned();
            if raw_create(library, index, &wrong).is_ok() {
                response.findings.push(format!("create accepts the file name {name:?} for \"{}\"", row.name));
            }
        }
    }
}

fn other_bands(library: &Arc<Library>, example: &Example, response: &mut Response) {
    let band = |k: u32| {
        let low_m = (380.0 + 20.0 * f64::from(k)) * 1e-9;
        Band { centre_m: low_m + 10e-9, low_m, high_m: low_m + 20e-9 }
    };
    for count in [1, 2, 20] {
        let bands: Vec<Band> = (0..count).map(band).collect();
        match instantiate(library, example, &bands) {
            Ok(brdf) => {
                let mut values = vec![0.0; 2 * bands.len()];
                let incident = [DVec3::Z, DVec3::new(0.0, 0.6, 0.8)];
                brdf.eval_pdf(DVec3::new(0.6, 0.0, 0.8), &incident, &mut values, &mut [0.0; 2]);
                if let Some(report) = brdf.fault_report() {
                    response.findings.push(format!("in {count} bands: {}", report.first));
                }
            }
            Err(error) => response.notes.push(format!("in {count} bands: {error}")),
        }
    }
}

/// Calls `create` without the host's checks.
fn raw_create(library: &Arc<Library>, index: u32, arguments: &Arguments) -> Result<PluginBrdf, Error> {
    let label = Label { material: "wrong arguments".to_owned(), place: "plugin check".to_owned() };
    PluginBrdf::create_unchecked(Arc::clone(library), index, arguments, &CHECK_BANDS, label)
}

/// Creates and destroys repeatedly; afterwards the memory in use must not have grown.
pub(super) fn lifecycle(library: &Arc<Library>, examples: &[Example]) -> Response {
    const ROUNDS: usize = 1000;
    let mut response = Response::default();
    let Some(example) = examples.iter().find(|example| instantiate(library, example, &CHECK_BANDS).is_ok()) else {
        return response;
    };
    let round = || instantiate(library, example, &CHECK_BANDS).map(drop);
    // The first rounds may fill caches.
    for _ in 0..20 {
        let _ = round();
    }
    // A large file is read again in each round, so fewer rounds have to suffice.
    let started = std::time::Instant::now();
    let _ = round();
    let rounds = if started.elapsed().as_millis() > 10 { ROUNDS / 50 } else { ROUNDS };
    // The allocator keeps some freed blocks in use: only memory lost in every repetition is a leak.
    let mut lost = Vec::new();
    for _ in 0..REPETITIONS {
        let before = bytes_in_use();
        for number in 0..rounds {
            if let Err(error) = round() {
                response.findings.push(format!("create fails the {}th time: {error}", number + 1));
                return response;
            }
        }
        lost.extend(before.zip(bytes_in_use()).map(|(before, after)| after.saturating_sub(before)));
        if lost.last().is_none_or(|&lost| lost < SMALLEST_LEAK_BYTES) {
            break;
        }
    }
    match lost.iter().min() {
        Some(&lost) if lost >= SMALLEST_LEAK_BYTES => {
            let each = lost / rounds as u64;
            response.findings.push(format!("{each} bytes are lost by each create and destroy ({rounds} rounds)"));
        }
        Some(_) => {}
        None => response.notes.push("memory in use is unknown on this system: leaks were not checked".to_owned()),
    }
    response
}

/// Number of repetitions while memory seems lost.
const REPETITIONS: usize = 3;

/// Smaller losses are noise of the allocator; 1,000 rounds lose at least 32 bytes each.
const SMALLEST_LEAK_BYTES: u64 = 16 << 10;

/// Bytes that the C library's allocator has handed out.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn bytes_in_use() -> Option<u64> {
    // SAFETY: no arguments, any thread.
    let info = unsafe { libc::mallinfo2() };
    Some((info.uordblks + info.hblkhd) as u64)
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn bytes_in_use() -> Option<u64> {
    None
}
