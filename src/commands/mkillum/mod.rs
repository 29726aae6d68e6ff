//! `mkillum`: converts windows to light sources.
//!
//! `mkillum [options of rtrace] OCTREE [< FILE…]`: each polygon, ring and sphere of the files (or
//! of standard input) becomes an `illum` with the radiance of rays through it. Comments `#@mkillum`
//! set options (`m=` its name, `f=` the data files, `c=` colours, `d=` directions, `s=` rays, `b=`
//! smallest brightness, `l+` a `light`, `i= e= a n` surfaces, `o=` output file).

mod lights;
mod options;
mod output;
mod parameters;

use crate::failure::{Failure, Outcome, say};
use crate::input::{Planner, conclude_all, expanded_scene_text, read_valid_scene, use_threads};
use crate::trust::{Refusal, Trust};
use lights::LightFinder;
use options::Options;
use output::{Output, Written, brightness, mean};
use parameters::{Becomes, Parameters};
use radsight_diag::{SourceMap, Span};
use radsight_film::average;
use radsight_flux::{FluxError, IllumDetail, IllumSurface, Shape};
use radsight_parse::syntax::{Item, Items, Primitive, SyntaxError};
use radsight_parse::{Kind, Role};
use radsight_render::{Lights, Ray, RayWorker, RenderOptions, Renderer};
use radsight_scene_generators::source_name;
use rayon::prelude::*;

/// Prefix of comments for this program.
const MARK: &str = "#@mkillum";

/// Smallest brightness that is not zero.
const TINY: f64 = 1e-6;

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let options = Options::parse(words, trust)?;
    use_threads(options.threads)?;
    let (scene, sources) = read_valid_scene(&options.scenes, &options.reading)?;
    let planner = Planner::new(&scene, &options.scenes, &options.reading, &sources)?;
    // Lights that are seen through a surface are sampled through it where it is an illum with an
    // alternate material, and by the light finder where it becomes a light.
    let plan = planner.plan(scene, RenderOptions { lights: Lights::Invisible, ..options.render.clone() })?;
    let mut work = Work {
        planner: &planner,
        renderer: Renderer::new(plan),
        light_finder: None,
        parameters: Parameters::default(),
        output: Output::new(&options.command, &options.reading.trust),
        next_ray: 0,
        options: &options,
    };
    options.inputs.iter().try_for_each(|input| work.read(input))?;
    work.output.finish()?;
    let finder = work.light_finder.iter().flat_map(LightFinder::renderers);
    conclude_all(finder.chain([&work.renderer]).map(Renderer::plan), planner.registry(), &sources, &options.reading)
}

struct Work<'a> {
    options: &'a Options,
    planner: &'a Planner<'a>,
    renderer: Renderer,
    /// Set when a surface becomes a `light`.
    light_finder: Option<LightFinder>,
    parameters: Parameters,
    output: Output<'a>,
    next_ray: u64,
}

impl Work<'_> {
    fn warn(&self, text: &str) {
        if !self.options.reading.no_warnings {
            say(&format!("mkillum: warning - {text}\n"));
        }
    }

    fn read(&mut self, path: &str) -> Outcome {
        let text = expanded_scene_text("mkillum", path, &self.options.reading.trust)?;
        let mistake = |error: SyntaxError| {
            let mut sources = SourceMap::default();
            let source = sources.add(source_name(path), text.clone(), None);
            Failure::diagnostics(&[error.diagnostic(source)], &sources)
        };
        let mut items = Items::new(&text).map_err(mistake)?;
        while let Some(item) = items.advance() {
            match item.map_err(mistake)? {
                Item::Comment(place) => {
                    let comment = String::from_utf8_lossy(&text[place.start as usize..place.end as usize]);
                    let named = self.comment(comment.trim_end(), path)?;
                    named.map_err(|refusal| {
                        let mut sources = SourceMap::default();
                        let source = sources.add(source_name(path), text.clone(), None);
                        let end = place.start + comment.trim_end().len() as u32;
                        let span = Span { source, start: place.start, end: end.min(place.end) };
                        Failure::diagnostics(&[refusal.at(span)], &sources)
                    })?;
                }
                Item::Alias(alias) => {
                    let [modifier, name, target] = [alias.modifier, alias.name, alias.target]
                        .map(|word| String::from_utf8_lossy(&alias.text(word)).into_owned());
                    self.output.alias([&modifier, &name, &target]);
                }
                Item::Primitive(primitive) => self.primitive(&primitive)?,
                // Commands were expanded before.
                Item::Command(_) => {}
            }
        }
        Ok(())
    }

    /// Applies a comment. A refusal concerns a file that it names.
    fn comment(&mut self, comment: &str, path: &str) -> Result<Result<(), Refusal>, Failure> {
        let ours = comment.strip_prefix(MARK).filter(|rest| rest.starts_with(char::is_whitespace));
        let Some(words) = ours else {
            self.output.line(comment);
            return Ok(Ok(()));
        };
        let result = self.parameters.read(words);
        let trust = &self.options.reading.trust;
        if self.parameters.density > 0
            && let Some(name) = &result.names_data
            && let Err(refusal) = output::check_data_files(trust, name)
        {
            return Ok(Err(refusal));
        }
        if let Some(file) = result.output {
            match output::scene_file(trust, &file) {
                Ok(file) => self.output.go_to(file)?,
                Err(refusal) => return Ok(Err(refusal)),
            }
        }
        if result.is_processed {
            self.warn(&format!("{} was processed before and is copied unchanged", source_name(path)));
            return Ok(Ok(()));
        }
        self.output.put_header();
        if !result.unknown.is_empty() {
            let unknown = result.unknown.join(" ");
            self.warn(&format!(
                "{path}: \"{unknown}\" after {MARK} is unknown, expected m= f= c= d= s= b= i= e= o= a n l+ or l-"
            ));
            self.output.line(&format!("# mkillum: the following option line has {} error(s):", result.unknown.len()));
        }
        self.output.line(&format!("# {}", &comment[2..]));
        Ok(Ok(()))
    }

    fn primitive(&mut self, primitive: &Primitive<'_>) -> Outcome {
        self.output.put_header();
        let text = |word| String::from_utf8_lossy(&primitive.text(word)).into_owned();
        let modifier = text(primitive.modifier);
        let written = Written {
            kind: primitive.kind.name(),
            is_surface: primitive.kind.role() == Role::Surface,
            name: text(primitive.name),
            strings: primitive.strings.iter().map(|word| text(*word)).collect(),
            integers: primitive.integers.to_vec(),
            reals: primitive.reals.to_vec(),
        };
        if !written.is_surface || !self.parameters.selected.has(&modifier) {
            self.output.primitive(&modifier, &written);
            return Ok(());
        }
        let Parameters { density, samples, .. } = self.parameters;
        let detail = IllumDetail { density, samples };
        let (name, numbers) = (written.name.as_str(), primitive.reals);
        let surface = match primitive.kind {
            Kind::Polygon => IllumSurface::flat(name, Shape::Polygon, numbers, detail),
            Kind::Ring => IllumSurface::flat(name, Shape::Ring, numbers, detail),
            Kind::Sphere => IllumSurface::ball(name, numbers, detail),
            _ => {
                self.warn(&format!(
                    "{} \"{name}\" cannot become a light source, expected a polygon, ring or sphere",
                    written.kind
                ));
                self.output.primitive(&modifier, &written);
                return Ok(());
            }
        };
        match surface {
            Ok(surface) => self.light(&modifier, &written, &surface.with_seed(self.options.render.seed)),
            Err(error @ FluxError::NoArea { .. }) => {
                self.warn(&format!("{error}; it does not become a light source"));
                self.output.primitive(&modifier, &written);
                Ok(())
            }
            Err(error) => Err(Failure::input(format!("mkillum: {error}"))),
        }
    }

    fn light(&mut self, modifier: &str, written: &Written, surface: &IllumSurface) -> Outcome {
        if self.parameters.density == 0 && surface.axes().is_none() {
            self.warn(&format!("sphere \"{}\" emits uniformly", written.name));
        }
        let mut means = self.means(surface)?;
        if let (Some(finder), Becomes::Light) = (&self.light_finder, self.parameters.becomes) {
            finder.add(surface, &mut means);
        }
        if brightness(mean(&means)) <= self.parameters.least_brightness + TINY {
            self.output.primitive(modifier, written);
            return Ok(());
        }
        self.output.light(&mut self.parameters, (modifier, written), surface, &means)
    }

    /// The mean radiance of each direction.
    fn means(&mut self, surface: &IllumSurface) -> Result<Vec<[f64; 3]>, Failure> {
        let rays = (0..surface.rays()).map(|number| {
            let [origin, direction] = surface.ray(number);
            Ray { origin, direction }
        });
        let rays: Vec<Ray> = rays.collect();
        if self.parameters.becomes == Becomes::Light && self.light_finder.is_none() {
            let scene = self.renderer.plan().scene();
            self.light_finder = Some(LightFinder::new(&self.options.render, scene, self.planner)?);
        }
        let (sampling_budget, first) = (self.options.sampling_budget(), self.next_ray);
        let trace = |worker: &mut RayWorker<'_>, (place, ray): (usize, &Ray)| {
            average(worker, first + place as u64, ray, sampling_budget).value
        };
        let values: Vec<[f64; 3]> = rays.par_iter().enumerate().map_init(|| self.renderer.worker(), trace).collect();
        self.next_ray += rays.len() as u64;
        let means = values.chunks(surface.samples()).map(|direction| {
            let sum = |band: usize| direction.iter().map(|value| value[band]).sum::<f64>();
            std::array::from_fn(|band| sum(band) / surface.samples() as f64)
        });
        Ok(means.collect())
    }
}
