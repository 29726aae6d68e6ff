//! `radsight job merge`.

use super::{Merge, failure};
use crate::commands::report::ERROR_MAP;
use crate::failure::{Failure, Outcome, say};
use crate::input::{history, read_file};
use crate::output::{reserve_output, write_image_file};
use crate::trust::{Existing, Trust};
use radsight::{JobResult, JobTarget, MergedJob, Tile};
use radsight_picture::Image;

/// Runs the command.
pub(super) fn run(arguments: &Merge, trust: &Trust) -> Outcome {
    for path in [Some(&arguments.output), arguments.error_map.as_ref()].into_iter().flatten() {
        reserve_output(&trust.output(path, Existing::Kept)?)?;
    }
    let mut parts = Vec::new();
    for path in &arguments.parts {
        parts.push(JobResult::from_bytes(path, &read_file(path, "part")?).map_err(failure)?);
    }
    let merged = MergedJob::of(&parts).map_err(|error| named(error, &arguments.parts))?;
    let missing = missing_parts(&merged);
    match &missing {
        Some(missing) if !arguments.partial => {
            Err(Failure::input(format!("{missing} are in no part\nhint: --partial writes what is there")))
        }
        _ => write(arguments, &merged, missing.as_deref()),
    }
}

/// What is missing, in words; `None` if nothing is.
fn missing_parts(merged: &MergedJob) -> Option<String> {
    let missing = merged.missing();
    let [columns, rows] = merged.size;
    let range = |range: &std::ops::Range<usize>| format!("{} to {}", range.start, range.end - 1);
    let each = |of: &dyn Fn(&Tile) -> String| missing.iter().map(of).collect::<Vec<_>>().join(", ");
    let is_trace = matches!(merged.job.target, JobTarget::Trace { .. });
    match () {
        () if missing.is_empty() => None,
        () if is_trace => Some(format!("rays {} of {columns}", each(&|tile| range(&tile.columns)))),
        () if missing.iter().all(|tile| tile.columns.len() == columns) => {
            Some(format!("rows {} of {rows}", each(&|tile| range(&tile.rows))))
        }
        () => {
            let tile = |tile: &Tile| format!("rows {} of columns {}", range(&tile.rows), range(&tile.columns));
            Some(format!("{}, of {columns} columns and {rows} rows,", each(&tile)))
        }
    }
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

fn write(arguments: &Merge, merged: &MergedJob, missing: Option<&str>) -> Outcome {
    let mut header = history();
    header.push_variable("SOFTWARE", concat!(" radsight ", env!("CARGO_PKG_VERSION")));
    if let JobTarget::Picture { view, .. } = &merged.job.target {
        header.push_variable("VIEW", &format!(" {view}"));
    }
    let error = merged.relative_error();
    if let Some(error) = error {
        say(&format!("radsight: estimated error {:.3} %, {} rays a pixel\n", 100.0 * error, merged.job.samples));
    }
    if let Some(missing) = missing {
        header.push_variable("PARTIAL", &format!(" {missing} are missing"));
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
