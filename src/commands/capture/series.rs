//! `radsight capture --variants`: a table of pictures of nearly one scene.

use super::exposure_image;
use super::notes::{self, Note, SeriesNotes};
use crate::args::{Capture, Reading};
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, say};
use crate::input::{Planner, conclude, history, read_file, scene_inputs, use_threads, valid_scene};
use crate::output::{reserve_output, write_file, write_image_file};
use crate::progress::Bar;
use crate::sensor_picture::SensorPicture;
use crate::trust::Existing;
use radsight::{SeriesExposure, SeriesPicture, SeriesRow, SeriesScenes, check_moved_parts, expose_series, read_series};
use radsight_camera::CameraFile;
use radsight_capture::Progress;
use radsight_diag::{Diagnostic, SourceMap};
use radsight_ir::ValidScene;
use radsight_output::interrupt;
use radsight_parse::Input;
use radsight_picture::Header;
use radsight_pinhole::PinholeCamera;
use radsight_render::{RenderOptions, RenderPlan};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

/// Placeholder for a picture's name in file names.
const NAME: &str = "{}";

/// Exposes all pictures of a table.
pub(super) fn run(arguments: &Capture, table: &str, render: RenderOptions) -> Outcome {
    check_arguments(arguments)?;
    use_threads(arguments.threads)?;
    let text = read_file(table, "series")?;
    let rows = read_series(table, &text)?;
    for row in &rows {
        for output in outputs(arguments) {
            reserve_output(&arguments.reading.trust.output(&output.replace(NAME, &row.name), Existing::Kept)?)?;
        }
    }
    let options = RenderOptions { seed: arguments.seed, ..render };
    let pictures = pictures(arguments, (table, &text), &rows, &options)?;
    let inputs = scene_inputs(&arguments.scenes, None, &arguments.reading.trust)?;
    // Plugins and messages are those of the scene as the first picture has it.
    let Some(first) = pictures.first() else { return Ok(()) };
    let (scene, sources) =
        valid_scene(with_ring(&inputs, first.capture.camera_file()), &arguments.reading, |_| Ok(()))?;
    check_moved_parts(table, &text, &rows, &scene)?;
    let planner = Planner::new(&scene, &arguments.scenes, &arguments.reading, &sources)?;
    let scenes = FileScenes::new(inputs, &arguments.reading, planner, &sources);
    let bar = Bar::new("capturing");
    let postponed = interrupt::postpone();
    let progress = Pictures { bar: &bar, done: AtomicU64::new(0), of: pictures.len() as u64 };
    let mut told = SeriesNotes::default();
    let exposed = expose_series(&scenes, &pictures, &progress, &mut |exposed| {
        let (row, picture) = (&rows[exposed.picture], &pictures[exposed.picture]);
        write(arguments, row, picture, &exposed)?;
        told.add(&row.name, notes_of(arguments, picture, &exposed));
        progress.next();
        Ok(())
    });
    bar.finish();
    notes::say_all(told.lines());
    postponed.end();
    let done = progress.done();
    if done < progress.of {
        say(&format!("radsight: stopped: {done} of {} pictures are done\n", progress.of));
    }
    exposed
}

/// What is said of a picture.
fn notes_of(arguments: &Capture, picture: &SeriesPicture, exposed: &SeriesExposure<'_>) -> Vec<Note> {
    let mut found = notes::of_camera(exposed.renderer.plan(), &picture.capture.camera_file().camera);
    found.extend(notes::missed(&exposed.exposure, arguments.error.unwrap_or(super::DEFAULT_ERROR)));
    found
}

fn outputs(arguments: &Capture) -> impl Iterator<Item = &String> {
    [&arguments.output, &arguments.exposure].into_iter().flatten()
}

fn check_arguments(arguments: &Capture) -> Outcome {
    super::check_budget(arguments)?;
    if arguments.resume {
        let message = "a series cannot be resumed: option \"--resume\" goes with a single capture\n\
                       hint: leave out of the table what is done";
        return Err(Failure::usage(message));
    }
    let accounts = arguments.accounts.paths().into_iter().flatten().next();
    if arguments.color.is_some() || arguments.specimen.is_some() || accounts.is_some() {
        let message = "option \"--variants\" writes pictures and exposures only: it goes with -o and --exposure";
        return Err(Failure::usage(message));
    }
    if outputs(arguments).next().is_none() {
        return Err(Failure::usage("option \"--variants\" writes nothing alone: it goes with -o and --exposure"));
    }
    match outputs(arguments).find(|output| !output.contains(NAME)) {
        Some(output) => Err(Failure::usage(format!(
            "\"{output}\" names one file for all pictures of the series, expected {NAME} in it for the name of each\n\
             hint: for example \"picture-{NAME}.png\""
        ))),
        None => Ok(()),
    }
}

/// The captures of a table's lines; a camera file is read once for each set of replaced keys.
fn pictures(
    arguments: &Capture,
    table: (&str, &[u8]),
    rows: &[SeriesRow],
    options: &RenderOptions,
) -> Result<Vec<SeriesPicture>, Failure> {
    let loader = DiskLoader::new(Commands::Refused);
    let text = read_file(&arguments.camera, "camera file")?;
    let mut read: Vec<(&[(String, String)], radsight::Capture)> = Vec::new();
    let mut pictures = Vec::new();
    for row in rows {
        let capture = match read.iter().find(|(keys, _)| *keys == row.keys) {
            Some((_, capture)) => capture.clone(),
            None => {
                let capture = row.capture((&arguments.camera, &text), table, &loader)?;
                let capture = configured(arguments, capture, options);
                super::check_sensor(arguments, capture.camera_file())?;
                read.push((&row.keys, capture.clone()));
                capture
            }
        };
        pictures.push(SeriesPicture { capture, moves: row.moves.clone() });
    }
    Ok(pictures)
}

pub(super) fn configured(
    arguments: &Capture,
    capture: radsight::Capture,
    options: &RenderOptions,
) -> radsight::Capture {
    let mut capture = match arguments.samples {
        Some(samples) => capture.samples(samples),
        None => capture.error(arguments.error.unwrap_or(super::DEFAULT_ERROR)),
    };
    *capture.options_mut() = options.clone();
    capture
}

pub(super) fn with_ring(inputs: &[Input], camera: &CameraFile) -> Vec<Input> {
    inputs.iter().cloned().chain(crate::input::ring_input(camera)).collect()
}

/// Scenes of the command line, read from memory.
pub(super) struct FileScenes<'s> {
    inputs: Vec<Input>,
    reading: &'s Reading,
    /// Warnings are said once.
    quiet: Reading,
    planner: Planner<'s>,
    sources: &'s SourceMap,
    /// Whether it was said what the options leave out.
    is_said: Cell<bool>,
    /// A camera, to say what matters for it once there is a plan.
    camera: Cell<Option<PinholeCamera>>,
}

impl<'s> FileScenes<'s> {
    pub(super) fn new(
        inputs: Vec<Input>,
        reading: &'s Reading,
        planner: Planner<'s>,
        sources: &'s SourceMap,
    ) -> FileScenes<'s> {
        // Warnings were said before.
        let mut quiet = reading.clone();
        quiet.no_warnings = true;
        let (is_said, camera) = (Cell::new(false), Cell::new(None));
        FileScenes { inputs, reading, quiet, planner, sources, is_said, camera }
    }

    /// Also says what matters for this camera in the first scene that is compiled.
    pub(super) fn with_notes_on(self, camera: &PinholeCamera) -> FileScenes<'s> {
        self.camera.set(Some(camera.clone()));
        self
    }

    fn say_notes(&self, plan: &RenderPlan) {
        if let Some(note) = notes::left_out(plan).filter(|_| !self.is_said.replace(true)) {
            notes::say_each([note]);
        }
        if let Some(camera) = self.camera.take() {
            notes::say_each(notes::of_camera(plan, &camera));
        }
    }
}

impl SeriesScenes for FileScenes<'_> {
    type Failure = Failure;

    fn read(&self, camera: &CameraFile) -> Result<ValidScene, Failure> {
        let (scene, _) = valid_scene(with_ring(&self.inputs, camera), &self.quiet, |_| Ok(()))?;
        Ok(scene)
    }

    fn plan(&self, scene: ValidScene, options: RenderOptions) -> Result<RenderPlan, Failure> {
        let plan = self.planner.plan(scene, options)?;
        match plan.has_emitters() {
            true => {
                self.say_notes(&plan);
                Ok(plan)
            }
            false => {
                Err(Failure::input("the scene has no light: nothing in it emits, and the camera file has no [rig]"))
            }
        }
    }

    fn check(&self, plan: &RenderPlan) -> Outcome {
        conclude(plan, self.planner.registry(), self.sources, self.reading)
    }

    fn invalid(&self, errors: Vec<Diagnostic>) -> Failure {
        Failure::diagnostics(&errors, self.sources)
    }
}

/// Shows how many pictures are done; a signal stops the work.
struct Pictures<'b> {
    bar: &'b Bar,
    done: AtomicU64,
    of: u64,
}

impl Pictures<'_> {
    fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    fn next(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.report(done, self.of);
    }
}

impl Progress for Pictures<'_> {
    fn report(&self, _done: u64, _total: u64) {}

    fn stops(&self) -> bool {
        interrupt::is_asked()
    }
}

fn write(arguments: &Capture, row: &SeriesRow, picture: &SeriesPicture, exposed: &SeriesExposure<'_>) -> Outcome {
    let header = header(row);
    let file = picture.capture.camera_file();
    let image = exposure_image(&file.camera, &exposed.exposure.values)?;
    if let Some(path) = &arguments.exposure {
        write_image_file(&path.replace(NAME, &row.name), &header, &image)?;
    }
    match (&arguments.output, &file.sensor) {
        (Some(path), Some(sensor)) => {
            let picture = SensorPicture::new(sensor, &image, arguments.seed);
            write_file(&path.replace(NAME, &row.name), &picture.grey_png(&header)?)
        }
        _ => Ok(()),
    }
}

/// How a picture came to be: the command, and which of its pictures it is.
fn header(row: &SeriesRow) -> Header {
    let mut header = history();
    header.push_variable("VARIANT", &format!(" {}, line {}", row.name, row.line));
    header
}
