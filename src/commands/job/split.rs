//! `radsight job split`.

use super::inputs::Inputs;
use super::{Split, failure};
use crate::failure::{Failure, Outcome};
use crate::file_pattern;
use crate::output::{reserve_output, write_file};
use crate::trust::{Existing, Trust};
use radsight::RenderJob;

/// Runs the command.
pub(super) fn run(arguments: &Split, trust: &Trust) -> Outcome {
    if !file_pattern::holds_number(&arguments.output) {
        let pattern = &arguments.output;
        return Err(Failure::usage(format!("output \"{pattern}\" has no %d, expected one for the part's number")));
    }
    let Inputs { job, size, .. } = Inputs::read(&arguments.job)?;
    for (number, part) in parts(arguments, &job, size)?.iter().enumerate() {
        let (name, ..) = file_pattern::named("job", &arguments.output, "", number)?;
        let name = trust.output(&name, Existing::Kept)?;
        reserve_output(&name)?;
        write_file(&name, part.to_json().as_bytes())?;
    }
    Ok(())
}

fn parts(arguments: &Split, job: &RenderJob, size: [usize; 2]) -> Result<Vec<RenderJob>, Failure> {
    let parts = match (&arguments.tiles, arguments.rays) {
        (Some(tile), _) => job.split_tiles(tile_size(tile)?, size),
        (None, Some(rays)) => job.split_rays(rays, size[0]),
        (None, None) => job.split(arguments.parts.unwrap_or(1), size),
    };
    parts.map_err(failure)
}

/// Columns and rows of `WxH`.
fn tile_size(text: &str) -> Result<[usize; 2], Failure> {
    let numbers = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    numbers.ok_or_else(|| {
        Failure::usage(format!("option \"--tiles\" is \"{text}\", expected columns and rows such as 64x64"))
    })
}
