//! `radsight calibrate`: sensor parameters from measured pairs.

use crate::args::Calibrate;
use crate::failure::{Failure, Outcome};
use crate::input::read_file;
use crate::output::{reserve_output, write_file, write_standard_output};
use crate::trust::{Existing, Trust};
use radsight_camera::read_measurements;
use radsight_diag::SourceMap;
use radsight_sensor::{CONFIDENCE, Estimate, ExposureUnit};

/// Runs the command.
pub(crate) fn run(arguments: &Calibrate, trust: &Trust) -> Outcome {
    if let Some(path) = &arguments.plot {
        reserve_output(&trust.output(path, Existing::Kept)?)?;
    }
    let unit = ExposureUnit::from_name(&arguments.unit).ok_or_else(|| {
        Failure::usage(format!("option \"--unit\" is \"{}\", expected uJ/cm2, J/m2, …", arguments.unit))
    })?;
    let bytes = read_file(&arguments.data, "table")?;
    let mut sources = SourceMap::default();
    let source = sources.add(&arguments.data, bytes, None);
    let pairs = read_measurements(source, &sources).map_err(|errors| Failure::diagnostics(&errors, &sources))?;
    let fit = radsight_sensor::calibrate::calibrate(&pairs, unit)
        .map_err(|error| Failure::input(format!("\"{}\": {error}", arguments.data)))?;
    let mut text = format!(
        "[sensor]\nresponse = \"power-law\"\nk = {}\ngamma = {}\ngrey_background = {}\n",
        fit.k, fit.gamma, fit.grey_background
    );
    match fit.grey_max {
        Some(grey_max) => text.push_str(&format!("grey_max = {grey_max}\n")),
        None => text.push_str("# grey_max: the data do not reach saturation\n"),
    }
    text.push_str(&format!(
        "exposure_unit = \"{}\"\n# {} pairs, {} of them saturated; rms residual {:.3} grey levels\n",
        unit.name(),
        pairs.len(),
        fit.saturated,
        fit.rms_residual
    ));
    let intervals = &fit.intervals;
    let rows = [
        ("k", Some(intervals.k)),
        ("gamma", Some(intervals.gamma)),
        ("grey_background", Some(intervals.grey_background)),
        ("grey_max", intervals.grey_max),
    ];
    for (name, interval) in rows {
        if let Some(Estimate { low, high, .. }) = interval {
            text.push_str(&format!(
                "# {name}: from {low} to {high} with a confidence of {:.0} %\n",
                100.0 * CONFIDENCE
            ));
        }
    }
    if let Some(path) = &arguments.plot {
        write_file(path, fit.plot(&pairs).svg().as_bytes())?;
    }
    write_standard_output(text.as_bytes())
}
