//! `radsight pinhole rays | average | shift`.

use crate::args::{Average, CameraRays, Pinhole, Shift};
use crate::commands::capture::exposure_image;
use crate::failure::{Failure, Outcome, reason};
use crate::input::{band_weights, history, read_camera, read_file};
use crate::output::{standard_output, write_standard_output};
use radsight_camera::CameraFile;
use radsight_picture::{FloatMatrix, MatrixFormat, read_image};
use radsight_pinhole::shift::{RadiancePicture, ShiftAverage, ShiftPattern};
use radsight_pinhole::stream::{ExposureStream, NumberFormat, RayStream};
use radsight_pinhole::{BandWeights, Rays};
use std::io::{self, BufWriter, Read, Write};

/// Number of rays encoded at a time.
const RAYS_AT_A_TIME: u64 = 4096;

/// Number of bytes read at a time.
const BYTES_AT_A_TIME: usize = 1 << 16;

/// Runs the command.
pub(crate) fn run(arguments: &Pinhole) -> Outcome {
    match arguments {
        Pinhole::Rays(arguments) => rays(arguments),
        Pinhole::Average(arguments) => average(arguments),
        Pinhole::Shift(arguments) => shift(arguments),
    }
}

fn rays(arguments: &CameraRays) -> Outcome {
    let (_, rays, format) = set_up(arguments)?;
    let mut stream = RayStream::new(&rays, format);
    let mut out = BufWriter::new(standard_output());
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        if stream.fill(RAYS_AT_A_TIME, &mut bytes) == 0 {
            break;
        }
        out.write_all(&bytes).map_err(|error| Failure::write("standard output", &error))?;
    }
    out.flush().map_err(|error| Failure::write("standard output", &error))
}

fn average(arguments: &Average) -> Outcome {
    let (file, rays, format) = set_up(&arguments.rays)?;
    let weights = band_weights(&arguments.rays.camera, &file, arguments.bands)?;
    let wrong = |error: &dyn std::fmt::Display| Failure::input(format!("standard input: {error}"));
    let mut stream = ExposureStream::new(&rays, &weights, format, arguments.bands).map_err(|error| wrong(&error))?;
    let mut exposures = Vec::with_capacity(rays.cells() as usize);
    let mut input = io::stdin().lock();
    let mut piece = vec![0; BYTES_AT_A_TIME];
    loop {
        let read = input
            .read(&mut piece)
            .map_err(|error| Failure::input(format!("cannot read standard input: {}", reason(&error))))?;
        if read == 0 {
            break;
        }
        stream.feed(&piece[..read], &mut exposures).map_err(|error| wrong(&error))?;
    }
    stream.finish(&mut exposures).map_err(|error| wrong(&error))?;
    write_exposure(&file, &rays.picture(exposures, &weights))
}

fn shift(arguments: &Shift) -> Outcome {
    let file = read_camera(&arguments.camera)?;
    check_steady(&file, &arguments.camera)?;
    if !file.camera.is_plain_pinhole() {
        return Err(Failure::input(format!(
            "\"{}\": whole-pixel shifts need a pinhole parallel to the sensor, without diffraction, lens or distortion",
            arguments.camera
        )));
    }
    let pattern = ShiftPattern::new(&file.camera, arguments.step).map_err(|error| Failure::input(error.to_string()))?;
    if arguments.views {
        let mut text = String::new();
        for sample in pattern.samples() {
            let view = pattern.view(&file.camera, sample);
            text.push_str(&format!("{view} -x {} -y {} -pa 0\n", view.pixels[0], view.pixels[1]));
        }
        return write_standard_output(text.as_bytes());
    }
    let mut sum: Option<ShiftAverage<'_>> = None;
    for path in &arguments.pictures {
        let wrong = |error: &dyn std::fmt::Display| Failure::input(format!("\"{path}\": {error}"));
        let image = read_image(&read_file(path, "picture")?).map_err(|error| wrong(&error))?.image;
        let bands = image.components();
        let average = match &mut sum {
            Some(average) => average,
            None => {
                sum.insert(ShiftAverage::new(&file.camera, &pattern, &band_weights(&arguments.camera, &file, bands)?))
            }
        };
        let picture =
            RadiancePicture { columns: image.width() as u32, rows: image.height() as u32, bands, values: image.data() };
        average.add(&picture).map_err(|error| wrong(&error))?;
    }
    let sum = match sum {
        Some(sum) => sum,
        None => ShiftAverage::new(&file.camera, &pattern, &BandWeights::equal(1)),
    };
    let exposures = sum.finish().map_err(|error| Failure::input(error.to_string()))?;
    write_exposure(&file, &exposures)
}

fn set_up(arguments: &CameraRays) -> Result<(CameraFile, Rays, NumberFormat), Failure> {
    let mut letters = arguments.format.chars();
    let format = letters.next().and_then(NumberFormat::from_letter).filter(|_| letters.next().is_none());
    let format =
        format.ok_or_else(|| Failure::usage(format!("option \"-f{}\": expected -fa, -ff or -fd", arguments.format)))?;
    if arguments.samples == 0 {
        return Err(Failure::usage("option \"--samples\" is 0, expected at least 1"));
    }
    let file = read_camera(&arguments.camera)?;
    check_steady(&file, &arguments.camera)?;
    let rays = Rays::new(&file.camera, arguments.samples, arguments.seed);
    Ok((file, rays, format))
}

/// Radiances from other programs have no information about flicker.
fn check_steady(file: &CameraFile, path: &str) -> Outcome {
    match file.flickering.is_empty() {
        true => Ok(()),
        false => Err(Failure::input(format!("\"{path}\" has [flicker], which only capture supports"))),
    }
}

fn write_exposure(file: &CameraFile, exposures: &[f64]) -> Outcome {
    let image = exposure_image(&file.camera, exposures)?;
    write_standard_output(&FloatMatrix::write_f32(&history(), &image, MatrixFormat::Float))
}
