//! `pinterp`: synthesises views from pictures of other views and their distances.
//!
//! `pinterp [view options] [-x N] [-y N] [-pa A] [-t eps] [-z distances] [-e E] [-a|-q] [-B] [-n]
//! [-f0|-ff|-fb|-fa] [-fs N] [-fc R G B] [-fz Z] [-fr RTRACE] picture distances …`: distances are a
//! file of `rpict -z`, or one number for all pixels. `-a` averages pixels of the same surface, the
//! default for several pictures; `-q` does not. `-f` selects the gaps to fill: between pixels of
//! one surface (`f`), behind edges (`b`, within `-fs` pixels), both (`a`), or none. The remaining
//! pixels get `-fc` and `-fz`, or rays traced with the `rtrace` options and scene after `-fr`. `-n`
//! measures distances along the view direction. `-B` averages over all views (`VIEW=` lines) of
//! standard input.

use super::files::{History, dated_header, failed};
use crate::commands::rtrace::RayAnswers;
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use crate::input::{read_file, read_standard_input};
use crate::output::{write_file, write_standard_output};
use crate::trust::OutputName;
use crate::view_args::{self, ViewOrigin};
use radsight_picture::{Header, Image, Picture, Resolution, View, ViewOptions, leading_number};
use radsight_picture_ops::interpolate::{Distances, Filling, InterpolateOptions, Interpolation};
use radsight_render::Ray;

/// Largest number of pixels.
const MOST_PIXELS: usize = 1 << 28;

/// The parsed options.
struct Request {
    view: ViewOptions,
    view_origin: ViewOrigin,
    size: [usize; 2],
    pixel_aspect: f64,
    interpolate: InterpolateOptions,
    /// `-a`, `-q`; by default depends on the number of pictures.
    averages: Option<bool>,
    /// Whether all views of standard input are averaged.
    blurs: bool,
    depths: Option<OutputName>,
    exposure: f64,
    /// The `rtrace` command line for the remaining pixels, program name first.
    rays: Option<Vec<String>>,
}

/// An input picture.
struct Source {
    name: String,
    header: Header,
    resolution: Resolution,
    view: View,
    pixels: Vec<[f32; 3]>,
    depths: Vec<f32>,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let request = Request::read(&mut words)?;
    let (pairs, left) = words.rest().as_chunks::<2>();
    if pairs.is_empty() || !left.is_empty() {
        return Err(Failure::usage("pinterp: expected pairs of a picture and its distances"));
    }
    let sources: Vec<Source> =
        pairs.iter().map(|[picture, depths]| Source::read(picture, depths)).collect::<Result<_, _>>()?;
    let views = request.views()?;
    let (columns, rows) = views[0].fit(request.size[0], request.size[1], request.pixel_aspect);
    if columns == 0 || rows == 0 || columns.checked_mul(rows).is_none_or(|pixels| pixels > MOST_PIXELS) {
        return Err(Failure::usage(format!(
            "pinterp: a picture of {columns} by {rows} pixels, expected 1 to {MOST_PIXELS} pixels"
        )));
    }
    let averages = request.averages.unwrap_or(sources.len() > 1);
    let options = InterpolateOptions { averages, ..request.interpolate };
    let mut sums = vec![0.0f64; 3 * columns * rows];
    let mut last = None;
    let mut rays = request.rays.as_ref().map(|rtrace| RayAnswers::new(rtrace, words.trust())).transpose()?;
    if rays.is_some() && sources[0].is_xyz() {
        return Err(Failure::usage("pinterp: rays (-fr) bring red, green and blue, expected pictures in RGBE"));
    }
    for view in &views {
        let mut made = Interpolation::new(*view, [columns, rows], options);
        for source in &sources {
            made.add(&source.pixels, &source.depths, &source.view, &source.resolution);
        }
        match &mut rays {
            Some(rays) => finish_with_rays(&mut made, view, rays, sources[0].exposure()),
            None => made.finish(),
        }
        let pixels = made.pixels();
        sums.iter_mut().zip(pixels.as_flattened()).for_each(|(sum, value)| *sum += f64::from(*value));
        last = Some(made);
    }
    let scale = request.exposure / views.len() as f64;
    let values: Vec<f32> = sums.into_iter().map(|sum| (sum * scale) as f32).collect();
    let wrong = |error| failed("pinterp", radsight_picture_ops::ToolError::Picture(error));
    let image = Image::new(columns, rows, 3, values).map_err(wrong)?;
    let header = header(&words, &request, &sources, (&views[0], columns as f64 / rows as f64));
    let bytes = match sources[0].is_xyz() {
        true => Picture::from_xyz(header, &image),
        false => Picture::from_rgb(header, &image),
    };
    if let Some(rays) = &rays {
        rays.conclude()?;
    }
    if let (Some(path), Some(made)) = (&request.depths, last) {
        let depths: Vec<u8> = made.depths().iter().flat_map(|depth| depth.to_ne_bytes()).collect();
        write_file(path, &depths)?;
    }
    write_standard_output(&bytes.map_err(wrong)?.to_bytes())
}

/// Traces rays for the remaining pixels.
fn finish_with_rays(made: &mut Interpolation, view: &View, rays: &mut RayAnswers, exposure: f64) {
    /// The distance of the background.
    const FAR: f64 = 1e10;
    let ray_at = |place| view.ray(place).map(|ray| Ray { origin: ray.origin, direction: ray.direction });
    rays.prepare(&made.holes().into_iter().map(ray_at).collect::<Vec<_>>());
    made.finish_with(|place| match ray_at(place).map(|ray| rays.trace(ray)) {
        Some(found) => Filling {
            color: found.value.map(|value| (value * exposure) as f32),
            depth: found.effective_distance.min(FAR),
        },
        None => Filling { color: [0.0; 3], depth: 0.0 },
    });
}

impl Request {
    fn read(words: &mut Words<'_>) -> Result<Request, Failure> {
        let mut request = Request {
            view: ViewOptions::default(),
            view_origin: ViewOrigin::default(),
            size: [512, 512],
            pixel_aspect: 1.0,
            interpolate: InterpolateOptions::default(),
            averages: None,
            blurs: false,
            depths: None,
            exposure: 1.0,
            rays: None,
        };
        let mut reach = 0;
        while let Some(option) = words.option()? {
            if option.starts_with("-v") {
                let all: Vec<String> =
                    std::iter::once(option).chain(words.rest().iter().map(String::as_str)).map(str::to_owned).collect();
                let used = view_args::take_one(&all, &mut request.view, &mut request.view_origin)?;
                for _ in 1..used {
                    words.value(option, "a number")?;
                }
                continue;
            }
            let options = &mut request.interpolate;
            match option {
                "-x" => request.size[0] = words.integer(option)?.max(0) as usize,
                "-y" => request.size[1] = words.integer(option)?.max(0) as usize,
                "-pa" => request.pixel_aspect = words.number(option)?,
                "-t" => options.tolerance = words.number(option)?.max(0.0),
                "-z" => request.depths = Some(words.output_value(option, "a file for distances")?),
                "-e" => {
                    let word = words.value(option, "an exposure")?;
                    let number = words.number_in(word, option)?;
                    request.exposure = if word.starts_with(['+', '-']) { 2f64.powf(number) } else { number };
                }
                "-a" | "-q" => request.averages = Some(option == "-a"),
                "-B" => request.blurs = true,
                "-n" => options.distances = Distances::ViewDirection,
                "-f0" => (options.fills_surfaces, options.fills_holes) = (false, None),
                "-ff" => (options.fills_surfaces, options.fills_holes) = (true, None),
                "-fb" => (options.fills_surfaces, options.fills_holes) = (false, Some(0)),
                "-fa" => (options.fills_surfaces, options.fills_holes) = (true, Some(0)),
                "-fs" => reach = words.integer(option)?.max(0) as usize,
                "-fc" => {
                    request.rays = None;
                    for band in &mut options.background.0 {
                        *band = words.number(option)? as f32;
                    }
                }
                "-fz" => {
                    request.rays = None;
                    options.background.1 = words.number(option)? as f32;
                }
                "-fr" => {
                    let options = words.value(option, "options and the scene of rtrace")?;
                    let all = ["rtrace"].into_iter().chain(options.split_whitespace());
                    request.rays = Some(all.map(str::to_owned).collect());
                }
                _ => return Err(words.unknown(option)),
            }
        }
        let holes = &mut request.interpolate.fills_holes;
        *holes = holes.filter(|_| reach != 1).map(|_| reach);
        Ok(request)
    }

    /// The requested views, at least one.
    fn views(&self) -> Result<Vec<View>, Failure> {
        if !self.blurs {
            return Ok(vec![view_args::checked(self.view, &self.view_origin)?]);
        }
        let text = read_standard_input()?;
        let (mut view, mut views) = (self.view, Vec::new());
        for line in String::from_utf8_lossy(&text).lines() {
            let Some(words) = line.trim_start().strip_prefix("VIEW=") else { continue };
            let applied = view.apply_line(&format!("VIEW={words}"));
            applied.map_err(|error| Failure::input(format!("pinterp: standard input: {error}")))?;
            views.push(View::new(view).map_err(|error| Failure::input(format!("pinterp: standard input: {error}")))?);
        }
        if views.is_empty() {
            return Err(Failure::input("pinterp: standard input has no view, expected lines with VIEW="));
        }
        Ok(views)
    }
}

impl Source {
    fn read(name: &str, depths: &str) -> Result<Source, Failure> {
        let wrong = |error| failed(name, radsight_picture_ops::ToolError::Picture(error));
        let picture = Picture::read(&read_file(name, "picture")?).map_err(wrong)?;
        if picture.components() != 3 {
            return Err(Failure::input(format!("{name}: a spectral picture, expected RGBE or XYZE")));
        }
        let no_view = |what: &str| Failure::input(format!("{name}: the view in its header: {what}"));
        let view = ViewOptions::from_header(picture.header()).map_err(|error| no_view(&error.to_string()))?;
        let view = view.ok_or_else(|| no_view("there is none"))?;
        let view = View::new(view).map_err(|error| no_view(&error.to_string()))?;
        // Scanlines from the top, whatever the order in the file; distances are in file order.
        let values = picture.values();
        let resolution = Resolution::standard(values.width(), values.height());
        let pixels: Vec<[f32; 3]> = values.pixels().map(|value| [value[0], value[1], value[2]]).collect();
        if picture.resolution() != resolution {
            return Err(Failure::input(format!(
                "{name}: its rows do not run from the top left, expected pflip or protate"
            )));
        }
        let depths = read_depths(depths, pixels.len())?;
        Ok(Source { name: name.to_owned(), header: picture.header().clone(), resolution, view, pixels, depths })
    }

    fn exposure(&self) -> f64 {
        self.header.exposure().unwrap_or(1.0)
    }

    fn is_xyz(&self) -> bool {
        self.header.format().is_some_and(|format| format == "32-bit_rle_xyze")
    }
}

/// Distances: a file of floats, or one number for all.
fn read_depths(source: &str, count: usize) -> Result<Vec<f32>, Failure> {
    let (number, used) = leading_number(source.as_bytes());
    if used == source.len() {
        if number.is_nan() || number <= 0.0 {
            return Err(Failure::usage(format!("pinterp: the distance {source} is not above 0")));
        }
        return Ok(vec![number as f32; count]);
    }
    let bytes = read_file(source, "distances")?;
    if bytes.len() != count * size_of::<f32>() {
        return Err(Failure::input(format!(
            "{source}: {} bytes, expected {} for the distances of {count} pixels",
            bytes.len(),
            count * size_of::<f32>()
        )));
    }
    Ok(bytes.as_chunks().0.iter().map(|value| f32::from_ne_bytes(*value)).collect())
}

fn header(words: &Words<'_>, request: &Request, sources: &[Source], (view, shape): (&View, f64)) -> Header {
    let mut header = dated_header();
    for source in sources {
        let mut nested = source.header.clone();
        nested.remove("FORMAT");
        History::Copied.push(&mut header, &source.name, &nested);
    }
    header.push_command(words.all());
    // As in Radiance, the view is recorded if the command does not contain all of it.
    if request.blurs || words.all().contains(&"-vf") {
        header.push_variable("VIEW", &view.options().to_full_string());
    }
    // The size was rounded for the requested one.
    let aspect = if request.pixel_aspect > 0.0 { request.pixel_aspect } else { view.aspect() * shape };
    if !(0.995..=1.005).contains(&aspect) {
        header.push_variable("PIXASPECT", &format!("{aspect:.6}"));
    }
    let exposure = request.exposure * sources[0].exposure();
    if !(0.995..=1.005).contains(&exposure) {
        header.push_exposure(exposure);
    }
    header
}
