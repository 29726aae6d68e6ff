//! `radsight job merge`.

use super::{Merge, failure};
use crate::commands::report::ERROR_MAP;
use crate::failure::{Failure, Outcome, say};
use crate::input::{history, read_file};
use crate::output::{check_writable, write_image_file};
use crate::trust::{Existing, Trust};
use radsight::{JobResult, JobTarget, MergedJob};
use radsight_picture::Image;

/// Runs the command.
pub(super) fn run(arguments: &Merge, trust: &Trust) -> Outcome {
    for path in [Some(&arguments.output), arguments.error_map.as_ref()].into_iter().flatten() {
        check_writable(&trust.output(path, Existing::Kept)?)?;
    }
    let mut parts = Vec::new();
    for path in &arguments.parts {
        parts.push(JobResult::from_bytes(path, &read_file(path, "part")?).map_err(failure)?);
    }
    let merged = MergedJob::of(&parts).map_err(|error| named(error, &arguments.parts))?;
    let missing: Vec<String> =
        merged.missing_rows().iter().map(|rows| format!("{} to {}", rows.start, rows.end - 1)).collect();
    if !missing.is_empty() && !arguments.partial {
        return Err(Failure::input(format!(
            "rows {} of {} are in no part\nhint: --partial writes what is there",
            missing.join(", "),
            merged.size[1]
        )));
    }
    write(arguments, &merged, &missing)
}

/// A part by its file.
fn named(error: radsight::Error, files: &[String]) -> Failure {
    match error {
        radsight::Error::Part { name, reason } => {
            let file = name.strip_prefix("part ").and_then(|number| files.get(number.parse::<usize>().ok()?));
            failure(radsight::Error::Part { name: file.cloned().unwrap_or(name), reason })
        }
        other => failure(other),
    }
}

fn write(arguments: &Merge, merged: &MergedJob, missing: &[String]) -> Outcome {
    let mut header = history();
    header.push_variable("SOFTWARE", concat!(" radsight ", env!("CARGO_PKG_VERSION")));
    if let JobTarget::Picture { view, .. } = &merged.job.target {
        header.push_variable("VIEW", &format!(" {view}"));
    }
    let error = merged.relative_error();
    if let Some(error) = error {
        say(&format!("radsight: estimated error {:.3} %, {} rays a pixel\n", 100.0 * error, merged.job.samples));
    }
    if !missing.is_empty() {
        header.push_variable("PARTIAL", &format!(" rows {} of {} are missing", missing.join(", "), merged.size[1]));
    }
    let image = |values: &[f32]| {
        let image = Image::new(merged.size[0], merged.size[1], merged.components, values.to_vec());
        image.map_err(|error| Failure::fault(error.to_string()))
    };
    write_image_file(&arguments.output, &header, &image(&merged.values)?)?;
    if let Some(path) = &arguments.error_map {
        header.push_variable(ERROR_MAP, " absolute");
        write_image_file(path, &header, &image(&merged.standard_errors)?)?;
    }
    Ok(())
}
