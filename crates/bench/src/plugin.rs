//! `radsight-bench plugin`: the cost of a reflectance model in a plugin, compared with the built-in
//! one.

use crate::args::Plugin;
use crate::capture::print;
use crate::error::BenchError;
use crate::figure::{Disk, read};
use radsight_brdf::{Brdf, Lambert, WardIsotropic};
use radsight_brdf_host::{Band, Label, Registry, Request, SearchPath, SelfCheck};
use radsight_camera::CameraFile;
use radsight_capture::{Exposer, Silent};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_parse::{Input, ReadOptions, read_scene};
use radsight_pinhole::Rays;
use radsight_render::{ModelRequest, ModelSource, RenderOptions, RenderPlan, Renderer};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Built-in models and their versions in the plugin `builtin`, with arguments.
const MODELS: [(&str, &str); 2] = [("lambert", "3 .5 .5 .5"), ("ward", "4 .5 .5 .5 .1")];

/// The whole visible spectrum as one band.
const GREY_BAND: Band = Band { centre_m: 555e-9, low_m: 380e-9, high_m: 780e-9 };

/// Captures the paper's Fig. 14 with each model both ways, and prints the costs.
pub(crate) fn run(arguments: &Plugin) -> Result<(), BenchError> {
    let repository =
        arguments.repo.clone().unwrap_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")));
    let plugin = FromPlugin::find()?;
    print("model    in program  in plugin   ratio  same bits\n");
    for (model, numbers) in MODELS {
        let subject = Subject::read(&repository, model, numbers)?;
        let [mut inside, mut outside] = [Vec::new(), Vec::new()];
        let mut same = true;
        for _ in 0..arguments.repeat {
            let (seconds, values) = subject.capture(&InProgram, arguments.samples)?;
            inside.push(seconds);
            let (seconds, others) = subject.capture(&plugin, arguments.samples)?;
            outside.push(seconds);
            same &= values.iter().map(|value| value.to_bits()).eq(others.iter().map(|value| value.to_bits()));
        }
        let [inside, outside] = [inside, outside].map(least);
        let ratio = outside / inside;
        let same = if same { "yes" } else { "no" };
        print(&format!("{model:8} {inside:8.3} s {outside:8.3} s {ratio:8.4}  {same}\n"));
    }
    Ok(())
}

/// The smallest time, which is least disturbed by other processes.
fn least(seconds: Vec<f64>) -> f64 {
    seconds.into_iter().fold(f64::INFINITY, f64::min)
}

/// A camera and a scene.
struct Subject {
    camera: CameraFile,
    scene: Vec<Input>,
    name: String,
}

impl Subject {
    /// Fig. 14 with a sheet of one of the models.
    fn read(repository: &Path, model: &str, numbers: &str) -> Result<Subject, BenchError> {
        let folder = repository.join("radiance-scenes/gripps");
        let name = folder.join("fig14.toml").to_string_lossy().into_owned();
        let mut sources = SourceMap::default();
        let camera = CameraFile::read(&name, &read(Path::new(&name))?, &mut sources, &Disk);
        let camera = camera.map_err(|errors| wrong(&name, &errors, &sources))?;
        let sheet = format!(
            "void brdfplugin sheet 2 builtin {model} 0 {numbers}\n\
             sheet polygon background 0 0 12 -.3 -.3 0 .3 -.3 0 .3 .3 0 -.3 .3 0\n"
        );
        let rig = camera.rig.as_ref().map_or(String::new(), radsight_camera::Rig::scene_text);
        let washer = folder.join("washer.rad").to_string_lossy().into_owned();
        let text = |name: &str, text: String| Input::Text { name: name.to_owned(), text: text.into_bytes().into() };
        Ok(Subject { camera, scene: vec![text("sheet", sheet), Input::File(washer), text("rig", rig)], name })
    }

    /// Seconds of processor time for the exposure alone, and the exposure.
    fn capture(&self, models: &dyn ModelSource, samples: u32) -> Result<(f64, Vec<f64>), BenchError> {
        let read = read_scene(&self.scene, &Disk, &ReadOptions::default());
        let failed = |errors: &[Diagnostic]| wrong(&self.name, errors, &read.sources);
        let valid = read.scene.clone().validate().map_err(|errors| failed(&errors))?;
        let plan = RenderPlan::new(valid.scene, RenderOptions::default(), models).map_err(|errors| failed(&errors))?;
        let weights = self
            .camera
            .band_weights_for(plan.bands())
            .map_err(|error| BenchError::Read { path: PathBuf::from(&self.name), reason: error.to_string() })?;
        let renderer = Renderer::new(plan);
        let rays = Rays::new(&self.camera.camera, samples, 0);
        let start = Clock::now();
        let exposure =
            Exposer { renderer: &renderer, rays: &rays, weights: &weights, by_row: &[] }.with_samples(None, &Silent);
        Ok((start.seconds(), exposure.values))
    }
}

fn wrong(path: &str, errors: &[Diagnostic], sources: &SourceMap) -> BenchError {
    let reason = errors.iter().map(|error| error.render(sources)).collect();
    BenchError::Read { path: PathBuf::from(path), reason }
}

/// The built-in models, called through the same interface.
struct InProgram;

impl ModelSource for InProgram {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        if request.bands == 1 { own_model::<1>(request) } else { own_model::<3>(request) }
    }
}

/// A built-in model with this many bands.
fn own_model<const BANDS: usize>(request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
    match (request.model, request.numbers) {
        ("lambert", [red, green, blue]) => {
            let color = [*red, *green, *blue];
            Ok(Arc::new(Lambert { reflectance: std::array::from_fn::<_, BANDS, _>(|band| color[band]) }))
        }
        ("ward", [red, green, blue, roughness]) => {
            let color = [*red, *green, *blue];
            let specularity = std::array::from_fn::<_, BANDS, _>(|band| color[band]);
            Ok(Arc::new(WardIsotropic { specularity, roughness: *roughness }))
        }
        (model, _) => Err(Diagnostic::error(format!("unknown model \"{model}\""))),
    }
}

/// The plugin `builtin` beside this program.
struct FromPlugin(Registry);

impl FromPlugin {
    fn find() -> Result<FromPlugin, BenchError> {
        let program = std::env::current_exe().map_err(|reason| BenchError::Start {
            program: "radsight-bench".to_owned(),
            reason,
            hint: "",
        })?;
        let mut search = SearchPath::default();
        search.push(program.parent().unwrap_or(Path::new(".")));
        search
            .find("builtin")
            .map_err(|error| BenchError::Read { path: "builtin".into(), reason: format!("{error}{PLUGIN_HINT}") })?;
        Ok(FromPlugin(Registry::new(search, SelfCheck::Off)))
    }
}

const PLUGIN_HINT: &str = "; build it with `cargo build --release -p radsight-plugin-builtin`";

impl ModelSource for FromPlugin {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        let bands = [GREY_BAND; 3];
        let made = self.0.instantiate(&Request {
            library: request.library,
            model: request.model,
            words: request.words,
            numbers: request.numbers,
            bands: &bands[..request.bands],
            label: &Label::default(),
            folder: None,
        });
        match made {
            Ok(made) => Ok(made.brdf),
            Err(error) => Err(Diagnostic::error(error.to_string())),
        }
    }
}

/// Processor time of this process; wall time if the system does not report it.
struct Clock {
    wall: Instant,
    processor: f64,
}

impl Clock {
    fn now() -> Clock {
        Clock { wall: Instant::now(), processor: crate::cost::processor_time() }
    }

    fn seconds(&self) -> f64 {
        let processor = crate::cost::processor_time() - self.processor;
        if processor.is_nan() { self.wall.elapsed().as_secs_f64() } else { processor }
    }
}
