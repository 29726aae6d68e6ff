//! `rpict`: renders the picture of a view.

mod accounts;
mod defaults;
mod options;
mod output;
mod report;
mod sequence;

use crate::ambient_file::AmbientFile;
use crate::clock::push_date;
use crate::failure::{Failure, Outcome, say, say_in};
use crate::input::{Planned, conclude, plan, program_history, use_threads};
use crate::output::reserve_output;
use crate::output_color::OutputColor;
use crate::output_format::OutputFormat;
use crate::run_record::Stopwatch;
use crate::trust::{OutputName, PROJECT, Trust};
use crate::view_args::{self, ViewOrigin};
use options::Options;
use output::{PictureWriter, Recovered, Replaces, Start};
use radsight::Image;
use radsight_film::{Estimate, Film, MAX_SAMPLES, SamplingBudget, Stop, ViewCamera};
use radsight_picture::{Encoding, Header, Resolution, RgbPrimaries, View, ViewOptions, write_rgbe_scanline};
use radsight_render::Renderer;
use report::Report;
use sequence::Sequence;

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let mut stopwatch = Stopwatch::start();
    let options = Options::parse(words, trust)?;
    if let Some(path) = &options.error_file {
        say_in(path, words)?;
    }
    use_threads(options.threads)?;
    if options.first_frame <= 0 {
        let picture = Picture::prepare(&options, options.view, None)?;
        let Planned { plan, registry, sources, fingerprint } =
            plan(&options.scenes, None, &options.reading, options.render.clone())?;
        stopwatch.lap("scene read, checked and compiled");
        let mut renderer = Renderer::new(plan);
        let mut ambient = ambient_file(&options, fingerprint, &mut renderer)?;
        picture.gather_irradiance(&options, &mut renderer, &mut ambient)?;
        stopwatch.lap("irradiance cache, pre-pass");
        picture.render(&options, &renderer, &mut stopwatch)?;
        return conclude(renderer.plan(), registry.as_ref(), &sources, &options.reading);
    }
    let mut sequence = Sequence::new(&options)?;
    let planned = plan(&options.scenes, None, &options.reading, options.render.clone())?;
    let Planned { plan, registry, sources, fingerprint } = planned;
    let mut renderer = Renderer::new(plan);
    let mut ambient = ambient_file(&options, fingerprint, &mut renderer)?;
    while let Some((view, number)) = sequence.next()? {
        let before = sequence.view_before();
        let picture = Picture::prepare(&options, view, Some((number, before)))?;
        picture.gather_irradiance(&options, &mut renderer, &mut ambient)?;
        picture.render(&options, &renderer, &mut stopwatch)?;
        conclude(renderer.plan(), registry.as_ref(), &sources, &options.reading)?;
    }
    Ok(())
}

/// The file of `-af`.
fn ambient_file(options: &Options, fingerprint: Option<u64>, renderer: &mut Renderer) -> Result<AmbientFile, Failure> {
    AmbientFile::open(&options.reading, (&options.command, &options.scenes), fingerprint, renderer)
}

/// A picture to be rendered.
struct Picture {
    lens: ViewCamera,
    header: Header,
    output: Option<OutputName>,
    depths: Option<OutputName>,
    recovered: Option<Recovered>,
    replaces: Replaces,
}

impl Picture {
    /// Checks what can be checked before the scene is read.
    fn prepare(
        options: &Options,
        mut view: ViewOptions,
        frame: Option<(i64, Option<View>)>,
    ) -> Result<Picture, Failure> {
        let number = frame.as_ref().map_or(0, |(number, _)| *number);
        let named =
            |name: &Option<OutputName>| name.as_ref().map(|name| name.numbered(|n| sequence::numbered(n, number)));
        let (output, depths) = (named(&options.output), named(&options.depths));
        [&output, &depths].into_iter().flatten().try_for_each(|name| reserve_output(name).map(drop))?;
        let recover = match options.recovered_frame().filter(|_| frame.is_some()) {
            // A number gives the frame to continue, with its recovered rows.
            Some(recovered) => output.as_deref().filter(|_| recovered == number).map(str::to_owned),
            None => options.recover.as_ref().map(|name| sequence::numbered(name, number)),
        };
        let recovered = recover.as_deref().map(Recovered::read).transpose()?.flatten();
        let goes_over = recovered.is_some() && recover.as_deref() == output.as_deref();
        let replaces = if goes_over { Replaces::Recovered } else { Replaces::Nothing };
        let ([columns, rows], aspect);
        let mut origin = match &frame {
            Some(_) => ViewOrigin::input("standard input".to_owned()),
            None => options.view_origin.clone(),
        };
        if let Some(recovered) = &recovered {
            if let Ok(Some(seen)) = ViewOptions::from_header(&recovered.header) {
                view = seen;
                let name = recover.as_deref().unwrap_or_default();
                origin = ViewOrigin::input(format!("picture \"{name}\""));
            }
            ([columns, rows], aspect) = ([recovered.columns, recovered.rows], 0.0);
        } else {
            ([columns, rows], aspect) = (options.size, options.pixel_aspect);
        }
        let view = view_args::checked(view, &origin)?;
        let (columns, rows) = view.fit(columns, rows, aspect);
        Image::check_size(columns, rows).map_err(|error| Failure::usage(format!("rpict: {error}")))?;
        let mut lens = ViewCamera::new(view, columns, rows);
        lens.jitter = options.jitter();
        lens.aperture = options.aperture;
        if options.motion > 0.0 {
            lens.motion = frame.and_then(|(_, before)| before).map(|before| (before, options.motion));
        }
        let header = header(options, &lens, number);
        Ok(Picture { lens, header, output, depths, recovered, replaces })
    }

    /// Fills the irradiance cache for the picture's rays.
    fn gather_irradiance(&self, options: &Options, renderer: &mut Renderer, ambient: &mut AmbientFile) -> Outcome {
        let side = options.prepass_spacing();
        let (rays, spread) = (self.lens.prepass_rays(side), self.lens.spread(side));
        if let SamplingBudget::Error(_) = options.pixels {
            renderer.guide_paths(&rays, spread);
        }
        ambient.gather(renderer, &rays, spread)?;
        ambient.settle(renderer)
    }

    /// Renders from the first missing row, row by row.
    fn render(&self, options: &Options, renderer: &Renderer, stopwatch: &mut Stopwatch) -> Outcome {
        let done = self.recovered.as_ref().map_or(0, |recovered| recovered.done);
        let (columns, rows) = (self.lens.columns(), self.lens.rows());
        let resolution = Resolution::standard(columns, rows);
        let recovered = self.recovered.as_ref();
        let start = Start { header: &self.header, resolution, recovered, replaces: self.replaces };
        let mut writer = PictureWriter::begin(self.output.as_deref(), self.depths.as_deref(), &start)?;
        if done == rows {
            return writer.finish();
        }
        let mut report = Report::new(options.report);
        let mut frame = Film::new(renderer, self.lens, options.pixels);
        if let Some(limit) = options.time_limit {
            let spent = stopwatch.processor_clock();
            frame = frame.while_time_is_left(Box::new(move |share| spent() < share * limit));
        }
        let mut row = done;
        while row < rows {
            let block = frame.block_of(row);
            let mut pixels = frame.finish_block(block.clone());
            if let OutputColor::Xyz(_) = options.color {
                pixels
                    .iter_mut()
                    .for_each(|pixel| *pixel = options.color.of(pixel.map(f64::from)).map(|part| part as f32));
            }
            let plan = renderer.plan();
            let is_refused = options.reading.strict && (plan.has_function_faults() || plan.has_unbounded_radiance());
            if is_refused || renderer.plan().fatal_fault().is_some() {
                return Ok(());
            }
            let mut bytes = Vec::new();
            for line in pixels[(row - block.start) * columns..].chunks(columns) {
                match options.format {
                    OutputFormat::Pixels => write_rgbe_scanline(line, &mut bytes),
                    numbers => line.iter().for_each(|pixel| numbers.put(&pixel.map(f64::from), &mut bytes)),
                }
            }
            let depths = if writer.wants_depths() { frame.depths(row..block.end) } else { Vec::new() };
            writer.write(block.end - row, &bytes, &depths)?;
            row = block.end;
            report.update(row as f64 / rows as f64, rays_through(row * columns, &frame, options));
        }
        writer.finish()?;
        options.accounts.write(options, &self.header, renderer, &frame, stopwatch)?;
        if options.sampling_budget.is_some() && !options.reading.no_warnings {
            frame.estimate().iter().for_each(|estimate| say(&achieved(estimate, options)));
        }
        Ok(())
    }
}

/// Number of rays of the finished pixels.
fn rays_through(pixels: usize, frame: &Film<'_>, options: &Options) -> f64 {
    let of_each = match options.pixels {
        SamplingBudget::Samples(samples) => f64::from(samples),
        SamplingBudget::Interpolated(_) => 1.0,
        SamplingBudget::Error(_) => frame.estimate().map_or(0.0, |estimate| estimate.rays),
    };
    of_each * pixels as f64
}

/// The message about the error that was reached.
fn achieved(estimate: &Estimate, options: &Options) -> String {
    let Estimate { error, uncertainty, rays, noise, cache, stopped } = *estimate;
    let parts = cache.map_or(String::new(), |cache| {
        format!(" (noise of pixels {:.2} %, irradiance cache {:.2} %)", 100.0 * noise, 100.0 * cache)
    });
    let stopped = match (stopped, options.time_limit) {
        (None, _) => String::new(),
        (Some(Stop::Time), Some(limit)) => format!("; stopped by --time-limit {limit}"),
        (Some(_), _) => format!("; stopped by the limit of {MAX_SAMPLES} rays per pixel"),
    };
    format!(
        "rpict: note: the error is {:.2} % ± {:.2} % (95 %){parts} with {rays:.1} rays per pixel{stopped}\n",
        100.0 * error,
        100.0 * uncertainty
    )
}

/// The header of the picture.
fn header(options: &Options, lens: &ViewCamera, frame: i64) -> Header {
    let mut header = program_history(&options.scenes, &options.command);
    if let Some(project) = options.reading.trust.project() {
        header.push_variable(PROJECT, &format!(" {project}"));
    }
    if frame > 0 {
        header.push_variable("FRAME", &frame.to_string());
    }
    header.push_variable("VIEW", &lens.view().options().to_full_string());
    let aspect = lens.view().aspect() * lens.columns() as f64 / lens.rows() as f64;
    let aspect = if options.pixel_aspect > 0.0 && options.recover.is_none() { options.pixel_aspect } else { aspect };
    if !(0.995..=1.005).contains(&aspect) {
        header.push_variable("PIXASPECT", &format!("{aspect:.6}"));
    }
    push_date(&mut header);
    if options.format != OutputFormat::Pixels {
        header.push_variable("NCOMP", "3");
    }
    let pixels = if let OutputColor::Xyz(_) = options.color {
        Encoding::Xyze
    } else {
        let primaries = options.color.primaries().unwrap_or(RgbPrimaries::STANDARD);
        header.push_variable("PRIMARIES", &primaries.to_header_value());
        Encoding::Rgbe
    };
    options.format.end_header(&mut header, pixels.name());
    header
}
