//! `radsight report`: one page about a picture, its error, and how it was made.

use crate::args::{ErrorMapKind, QuantityName, Report};
use crate::failure::{Failure, Outcome};
use crate::input::{read_camera, read_file};
use crate::output::{reserve_output, write_file};
use crate::trust::{Existing, Trust};
use radsight_camera::CameraFile;
use radsight_diag::{Diagnostic, SourceMap};
use radsight_picture::{
    Encoding, FileFormat, Header, Image, Picture, PictureError, ReadImage, Resolution, TiffPixels, Unfinished,
    ViewOptions, read_image, read_png, read_tiff_pixels,
};
use radsight_report::{ErrorMap, GreyPicture, Page, ProgressLog, Quantity, ReportError, RunRecord};

/// The header variable of an error map that gives the meaning of its values: `absolute` or
/// `relative`.
pub(crate) const ERROR_MAP: &str = "ERRORMAP";

/// Runs the command.
pub(crate) fn run(arguments: &Report, trust: &Trust) -> Outcome {
    if arguments.output != "-" {
        reserve_output(&trust.output(&arguments.output, Existing::Kept)?)?;
    }
    let shown = Shown::read(&arguments.picture)?;
    let quantity = quantity(arguments, &shown);
    let title = arguments.title.clone().unwrap_or_else(|| arguments.picture.clone());
    let named = |name: &str| {
        let name = name.to_owned();
        move |error: ReportError| Failure::input(format!("\"{name}\": {error}"))
    };
    let components = shown.image.components();
    let mut page = Page::new(title, shown.image.clone(), quantity).map_err(named(&arguments.picture))?;
    page = of_header(page, &shown).map_err(named(&arguments.picture))?;
    let camera = arguments.camera.as_deref().map(read_camera).transpose()?;
    if let (Some(path), Some(file)) = (&arguments.camera, &camera) {
        let text = read_file(path, "camera file")?;
        check_pixels(file, &shown.image, path)?;
        page = of_camera(page, file, path, &text).map_err(named(path))?;
    }
    if let Some(path) = &arguments.error_map {
        let map = error_map(read_map(path, "error map")?, arguments.error_map_kind, components);
        page = page.error_map(map).map_err(named(path))?;
    }
    if let Some(path) = &arguments.ray_map {
        page = page.ray_map(read_map(path, "ray map")?.image).map_err(named(path))?;
    }
    if let Some(path) = &arguments.grey {
        page = page.grey_picture(read_grey(path, camera.as_ref())?).map_err(named(path))?;
    }
    if let Some(path) = &arguments.log {
        page = page.log(ProgressLog::read(&String::from_utf8_lossy(&read_file(path, "log")?)));
    }
    let mut record = arguments.record.as_deref().map_or(Ok(RunRecord::default()), read_record)?;
    record.notes.extend(shown.note);
    write_file(&arguments.output, page.record(record).to_html().as_bytes())
}

/// A picture as the page shows it.
struct Shown {
    image: Image<f32>,
    header: Header,
    values: Values,
    /// A note about the picture.
    note: Option<String>,
}

/// The meaning of a file's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Values {
    /// A physical quantity.
    Measured,
    /// Integers from 0 to white.
    Displayed,
}

impl Shown {
    fn read(path: &str) -> Result<Shown, Failure> {
        let bytes = read_file(path, "picture")?;
        let wrong = |error: PictureError| Failure::input(format!("\"{path}\": {error}"));
        if FileFormat::from_content(&bytes) == Some(FileFormat::Picture) {
            return Shown::of_picture(&bytes).map_err(wrong);
        }
        let ReadImage { image, header, format } = read_image(&bytes).map_err(wrong)?;
        let header = header.unwrap_or_default();
        let note = header.variable("PARTIAL").map(|partial| format!("the picture is partial: {partial}"));
        let is_whole = match format {
            FileFormat::Png => true,
            FileFormat::Tiff => {
                read_tiff_pixels(&bytes).is_ok_and(|tiff| !matches!(tiff.pixels, TiffPixels::Floats(_)))
            }
            _ => false,
        };
        let values = if is_whole { Values::Displayed } else { Values::Measured };
        Ok(Shown { image: without_alpha(image, format), header, values, note })
    }

    /// A picture in one of Radiance's formats, converted to radiances in red, green and blue.
    fn of_picture(bytes: &[u8]) -> Result<Shown, PictureError> {
        let (picture, note) = match Picture::read(bytes) {
            Ok(picture) => (picture, None),
            Err(error) => partial_picture(bytes).ok_or(error)?,
        };
        let image = match picture.encoding() {
            Encoding::Rgbe => picture.radiance()?,
            _ => picture.rgb_radiance()?,
        };
        Ok(Shown { image, header: picture.header().clone(), values: Values::Measured, note })
    }
}

/// The picture of an interrupted program, as its header declares; missing pixels are black.
fn partial_picture(bytes: &[u8]) -> Option<(Picture, Option<String>)> {
    let unfinished = Unfinished::read(bytes).ok().filter(|found| found.header.variable("PARTIAL").is_some())?;
    let (scanlines, all) = (unfinished.scanlines, unfinished.resolution.scanlines());
    let length = unfinished.resolution.scanline_length();
    radsight::Image::check_size(length, all).ok()?;
    let (_, start) = Resolution::read(bytes, Header::read(bytes).ok()?.1).ok()?;
    let mut whole = bytes[..start + unfinished.pixels.len()].to_vec();
    whole.resize(whole.len() + 4 * length * (all - scanlines), 0);
    let picture = Picture::read(&whole).ok()?;
    let note = format!("the picture is partial: {scanlines} of {all} scanlines are complete, the others are black");
    Some((picture, Some(note)))
}

/// Removes the alpha component that PNG and EXR may have.
fn without_alpha(image: Image<f32>, format: FileFormat) -> Image<f32> {
    let components = match (format, image.components()) {
        (FileFormat::Matrix | FileFormat::Npy, _) => return image,
        (_, 2) => 1,
        (_, 4) => 3,
        _ => return image,
    };
    let data = image.pixels().flat_map(|pixel| pixel[..components].iter().copied()).collect();
    Image::new(image.width(), image.height(), components, data).expect("some components of every pixel")
}

/// The quantity of the values: from the command line, or else from the format and the number of
/// components.
fn quantity(arguments: &Report, shown: &Shown) -> Quantity {
    match arguments.quantity {
        Some(QuantityName::Radiance) => Quantity::Radiance,
        Some(QuantityName::Irradiance) => Quantity::Irradiance,
        Some(QuantityName::Exposure) => Quantity::Exposure,
        Some(QuantityName::Other) => Quantity::Other { name: "value".to_owned(), unit: String::new() },
        None if shown.values == Values::Displayed => Quantity::Other { name: "value".to_owned(), unit: String::new() },
        None if shown.image.components() == 1 => Quantity::Exposure,
        None => Quantity::Radiance,
    }
}

/// Adds the data of the picture's header.
fn of_header(mut page: Page, shown: &Shown) -> Result<Page, ReportError> {
    let header = &shown.header;
    if let Ok(Some(view)) = ViewOptions::from_header(header) {
        page = page.fact("view", view.to_full_string());
    }
    // Radiances of XYZE pictures and spectra were converted to the standard primaries.
    let is_xyz = header.format().is_some_and(|format| format.contains("xyze"));
    if let (Ok(Some(primaries)), false) = (header.primaries(), is_xyz) {
        page = page.primaries(&primaries);
    }
    match header.exposure() {
        Ok(exposure) if exposure != 1.0 => {
            page = page.fact("exposure in the file", format!("{exposure}, undone here"));
        }
        _ => {}
    }
    if let Ok(aspect) = header.pixel_aspect()
        && aspect != 1.0
    {
        // Radiance's PIXASPECT is the height divided by the width of a pixel.
        page = page.pixel_aspect(aspect)?;
    }
    for (variable, name) in [("CAPDATE", "date in the header"), ("SOFTWARE", "software"), ("OWNER", "owner")] {
        if let Some(value) = header.variable(variable) {
            page = page.fact(name, value);
        }
    }
    Ok(if header.is_empty() { page } else { page.text("Header", header.to_text()) })
}

fn check_pixels(file: &CameraFile, image: &Image<f32>, path: &str) -> Outcome {
    let (columns, rows) = (file.camera.columns() as usize, file.camera.rows() as usize);
    if (columns, rows) == (image.width(), image.height()) {
        return Ok(());
    }
    let found = format!("{} by {}", image.width(), image.height());
    Err(Failure::input(format!(
        "the camera of \"{path}\" has {columns} by {rows} pixels, expected the picture's {found}"
    )))
}

/// Adds the data of the camera file.
pub(crate) fn of_camera(page: Page, file: &CameraFile, path: &str, text: &[u8]) -> Result<Page, ReportError> {
    let [across, along] = file.camera.pixel_pitch_m();
    let page = page.fact("camera", file.summary()).pixel_aspect((along / across).clamp(1e-3, 1e3))?;
    Ok(page.text(format!("Camera file {path}"), String::from_utf8_lossy(text)))
}

fn read_map(path: &str, what: &str) -> Result<ReadImage, Failure> {
    read_image(&read_file(path, what)?).map_err(|error| Failure::input(format!("{what} \"{path}\": {error}")))
}

/// Absolute or relative: from the command line, or else the map's header, or else the default of
/// our programs for such a picture.
fn error_map(read: ReadImage, asked: Option<ErrorMapKind>, components: usize) -> ErrorMap {
    let is_relative =
        read.header.as_ref().and_then(|header| header.variable(ERROR_MAP)).map(|kind| kind.trim() == "relative");
    let is_relative = match asked {
        Some(kind) => matches!(kind, ErrorMapKind::Relative),
        None => is_relative.unwrap_or(components == 3),
    };
    if is_relative { ErrorMap::Relative(read.image) } else { ErrorMap::Absolute(read.image) }
}

/// Reads a grey PNG; the largest value is that of the camera's sensor, if given.
fn read_grey(path: &str, camera: Option<&CameraFile>) -> Result<GreyPicture, Failure> {
    let png = read_png(&read_file(path, "grey picture")?);
    let png = png.map_err(|error| Failure::input(format!("grey picture \"{path}\": {error}")))?;
    let sensor = camera.and_then(|file| file.sensor.as_ref());
    let largest = sensor.map_or(u16::MAX >> (16 - png.bits), |sensor| sensor.bits().largest());
    Ok(GreyPicture { values: png.values, largest })
}

/// Reads a run record; a mistake is reported with its position.
fn read_record(path: &str) -> Result<RunRecord, Failure> {
    let bytes = read_file(path, "run record")?;
    RunRecord::from_json(&bytes).map_err(|error| match error {
        ReportError::Record { line, column, reason } => {
            let mut sources = SourceMap::default();
            let before: usize =
                bytes.split_inclusive(|byte| *byte == b'\n').take(line.max(1) - 1).map(<[u8]>::len).sum();
            let place = (before + column.max(1) - 1).min(bytes.len());
            let source = sources.add(path, bytes, None);
            let at = sources.span(source, place, place + 1);
            Failure::diagnostics(&[Diagnostic::error(format!("bad run record: {reason}")).at(at)], &sources)
        }
        other => Failure::input(format!("\"{path}\": {other}")),
    })
}
