//! What each fuzz target does with its bytes: reads them as a user's file would be read, and uses
//! what comes of it.
//!
//! `cargo fuzz run scene` runs a target on a nightly toolchain. On a stable one `RUSTFLAGS="$(cat
//! fuzz/instrumentation.flags)" cargo build --release --target TRIPLE` in this folder builds them
//! all; a target is then a libFuzzer program: `scene -timeout=1 -rss_limit_mb=2048 CORPUS_FOLDER`.
//! `fuzz/run` does all that: each target for a minute over its files in `fuzz/corpus`.
#![deny(unsafe_code)]

mod fixed_inputs;
mod real_radiance;
mod small_scene;

pub use real_radiance::against_real_radiance;
pub use small_scene::{Materials, SmallScene};

use glam::DVec3;
use radsight::{JobResult, MergedJob, RenderJob, Renderer, Scene, View as SceneView};
use radsight_camera::{CameraFile, read_measurements};
use radsight_diag::SourceMap;
use radsight_formats::{Font, Mesh, Octree};
use radsight_loader::MemoryLoader;
use radsight_matrix::{Matrix, Stored, Transform, Wanted, bsdf_matrix};
use radsight_measured::{MeasuredBsdf, Side};
use radsight_parse::{Input, ReadOptions, UnusedModifiers, bounds, cube, read_scene, write_scene, xform};
use radsight_picture::{FloatMatrix, Header, Image, Picture, View, ViewOptions, read_image};
use radsight_rad_project::{Cube, Date, How, Project, Site};
use radsight_report::{Page, ProgressLog, Quantity, RunRecord};
use radsight_scene_generators::WavefrontMesh;

/// A name that the bytes have in scenes that ask for them.
const NAME: &str = "fuzzed";

/// Reads a scene from its text, with the bytes as a file that it may ask for, and uses it.
fn read(text: &[u8], loader: &MemoryLoader) {
    let options = ReadOptions { unused: UnusedModifiers::Lower, most_surfaces: 20_000, ..ReadOptions::default() };
    let read = read_scene(&[Input::Text { name: "scene.rad".to_owned(), text: text.into() }], loader, &options);
    let _ = (read.render(20), bounds(&read.scene), cube(&read.scene));
    let mut written = String::new();
    let _ = write_scene(&read.scene, &mut written);
    let _ = read.scene.validate();
}

fn read_with(text: &str, bytes: &[u8]) {
    read(text.as_bytes(), &MemoryLoader::default().with(NAME, bytes));
}

/// Scene text, commands included, and the same text through `xform`.
pub fn scene(bytes: &[u8]) {
    let ball = "void plastic p 0 0 5 1 1 1 0 0\np sphere ball 0 0 4 0 0 0 1\n";
    let loader = MemoryLoader::default()
        .with("ball.rad", ball)
        .with("a.rad", "!xform -t 1 0 0 ball.rad\n")
        .with("table.dat", "1 0 1 3 1 2 3\n")
        .with("f.cal", "f(x) = x*A1;\n");
    read(bytes, &loader);
    let argv = ["xform", "-n", "name", "-rx", "30", "-s", "2", "-mx", "-"].map(str::to_owned);
    let _ = xform(&argv, &bytes, &loader);
}

/// A function file.
pub fn function(bytes: &[u8]) {
    let text = format!(
        "void brightfunc a 2 f(Px,1) {NAME} 0 3 1 2 3\na colorfunc b 4 red green blue {NAME} 0 0\n\
         b plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 1\n"
    );
    read_with(&text, bytes);
    let loader = MemoryLoader::default().with(NAME, bytes);
    let argv = ["rcalc", "-f", NAME, "-o", "${f(x,1)} ${red}\n"].map(str::to_owned);
    let _ = radsight_scene_generators::run(&argv, b"1 2\n3 4\n", &loader);
}

/// A data file.
pub fn data(bytes: &[u8]) {
    let text = format!(
        "void brightdata a 5 noop {NAME} . Px Py 0 0\nvoid brightdata b 4 noop {NAME} . Px 0 0\nvoid specfile c 1 {NAME} 0 0\n\
         a plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 1\n"
    );
    read_with(&text, bytes);
}

/// A picture, a float matrix or another image, and a pattern of it.
pub fn picture(bytes: &[u8]) {
    let text =
        format!("void colorpict a 7 red green blue {NAME} . Px Py 0 0\nvoid specpict b 5 noop {NAME} . Px Py 0 0\n");
    read_with(&text, bytes);
    let _ = (read_image(bytes), FloatMatrix::read_first(bytes), Picture::read_partial(bytes));
    if let Ok(picture) = Picture::read(bytes) {
        let again = Picture::read(&picture.to_bytes()).expect("what was written can be read");
        assert!(picture.width() > 0x7fff || again.pixels() == picture.pixels());
    }
}

/// A mesh.
pub fn mesh(bytes: &[u8]) {
    let _ = Mesh::read(bytes);
    read_with(&format!("void mesh m 3 {NAME} -rx 30 0 0\n"), bytes);
}

/// An octree, as a scene and placed.
pub fn octree(bytes: &[u8]) {
    let _ = Octree::read(bytes);
    read(bytes, &MemoryLoader::default().with("scene.rad", "void sphere s 0 0 4 0 0 0 1\n"));
    read_with(&format!("void instance i 3 {NAME} -rx 30 0 0\n"), bytes);
}

/// Wavefront text, as `obj2mesh` compiles it.
pub fn wavefront(bytes: &[u8]) {
    let Ok(mesh) = WavefrontMesh::read(&String::from_utf8_lossy(bytes)) else { return };
    let materials = mesh.materials.len();
    assert!(mesh.triangles.iter().all(|triangle| triangle.material.is_none_or(|material| material < materials)));
}

/// A matrix of light, and what `rmtxop` makes of it; a BSDF file as one.
pub fn matrix(bytes: &[u8]) {
    let _ = bsdf_matrix(bytes, Wanted::Transmission);
    let Ok(matrix) = Matrix::read(bytes) else { return };
    let turned = matrix.transposed();
    let _ = matrix.transformed(&Transform::Letters("XYZ".to_owned()), &[2.0]);
    // The programs refuse larger products than their limit of memory.
    if matrix.rows() <= 1000 {
        let _ = matrix.times(&turned);
    }
    assert_eq!(turned.transposed().values().len(), matrix.values().len());
    if let Ok(written) = matrix.write(&matrix.header, Stored::Float) {
        assert_eq!(Matrix::read(&written).expect("what was written can be read").size(), matrix.size());
    }
}

/// A font.
pub fn font(bytes: &[u8]) {
    let _ = Font::read(bytes);
    let frame = "0 0 0 1 0 0 0 -1 0";
    read_with(
        &format!(
            "void brighttext t 4 {NAME} . a line 0 12 {frame} 1 0 -.1\nvoid brighttext u 2 {NAME} {NAME} 0 11 {frame} 1 0\n"
        ),
        bytes,
    );
}

/// A BSDF file: values, draws and their densities, and a material of it.
pub fn bsdf(bytes: &[u8]) {
    read_with(&format!("void BSDF b 6 0 {NAME} 0 1 0 . 0 0\nb sphere s 0 0 4 0 0 0 1\n"), bytes);
    let Ok(reading) = MeasuredBsdf::read(bytes) else { return };
    let bsdf = reading.bsdf;
    for given in [DVec3::Z, DVec3::NEG_Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, -0.6, -0.8)] {
        let side = Side::of(given);
        for scattering in [bsdf.reflection(side), bsdf.transmission(side)].into_iter().flatten() {
            for draw in [[0.0, 0.0], [0.3, 0.7], [0.999, 0.5]] {
                let Some(sample) = scattering.sample(given, draw) else { continue };
                let other = sample.direction;
                let values = bsdf.value(given, other);
                assert!(values.iter().all(|value| value.is_finite() && *value >= 0.0), "{values:?}");
                assert!(scattering.density(given, other).is_finite());
            }
        }
    }
}

/// An IES luminaire.
pub fn luminaire(bytes: &[u8]) {
    let loader = MemoryLoader::default().with(NAME, bytes);
    let argv = ["ies2rad", "-o", "lamp", "-t", "default", NAME].map(str::to_owned);
    if let Ok(output) = radsight_scene_generators::run(&argv, b"", &loader) {
        let loader = output.files.iter().fold(loader, |loader, (name, content)| loader.with(name, content));
        read(&output.standard_output, &loader);
        for (name, content) in &output.files {
            if name.ends_with(".rad") {
                read(content, &loader);
            }
        }
    }
}

/// A view file.
pub fn view(bytes: &[u8]) {
    let mut options = ViewOptions::default();
    if options.apply_file(bytes).is_err() {
        return;
    }
    let _ = (options.to_full_string(), options.to_minimal_string(), Header::read_text(bytes).exposure());
    let Ok(view) = View::new(options) else { return };
    for place in [[0.5, 0.5], [0.0, 1.0], [0.3, 0.2], [1e9, -1e9]] {
        if let Some(ray) = view.ray(place) {
            let _ = view.locate(ray.origin + ray.direction);
        }
    }
    let _ = (view.crop([0.1, 0.1], [0.7, 0.9]), view.fit(512, 512, 1.0));
}

/// A run record, a progress log, and text of a page; a page has no more scripts and data than its
/// own.
///
/// # Panics
/// If text became a script.
pub fn report(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let image = Image::filled(2, 2, 1, 1.0).expect("an image");
    let page = Page::new(text.clone(), image, Quantity::Exposure).expect("one component");
    let record = RunRecord::from_json(bytes).unwrap_or_default();
    let html = page.record(record).log(ProgressLog::read(&text)).text(text.clone(), text).to_html();
    assert_eq!(html.matches("<script").count(), 3);
}

/// A camera file, its tables, and the light ring as a scene.
pub fn camera(bytes: &[u8]) {
    let mut sources = SourceMap::default();
    let loader = MemoryLoader::default().with("led.csv", "0 1\n10 .5\n90 0\n");
    if let Ok(file) = CameraFile::read("camera.toml", bytes, &mut sources, &loader) {
        let _ = (file.summary(), file.band_weights_for(3), file.band_weights_for(20));
        for lamp in file.flickering.iter().take(4) {
            let shares = file.brightness_by_row(&lamp.flicker);
            assert!(shares.iter().all(|share| share.is_finite() && *share >= 0.0), "{shares:?}");
        }
        if let Some(rig) = &file.rig {
            read(rig.scene_text().as_bytes(), &loader);
        }
    }
    let table = "[rig]\nleds = 1\nring_diameter_mm = 1\nled_diameter_mm = 1\nled_intensity_w_per_sr = 1\nled_table = \"fuzzed\"\n";
    let loader = MemoryLoader::default().with(NAME, bytes);
    let _ = CameraFile::read("camera.toml", table.as_bytes(), &mut SourceMap::default(), &loader);
    let source = sources.add("measured.txt", bytes, None);
    let _ = read_measurements(source, &sources);
}

/// A place where some files are older than others.
struct SomeFiles;

impl Site for SomeFiles {
    fn date(&self, name: &str) -> Date {
        (name.len() % 5) as Date
    }

    fn cube(&self, scene: &[String]) -> Option<Cube> {
        (!scene.is_empty()).then_some(Cube { corner: [0.0, -1.0, 2.0], size: 4.0 })
    }
}

/// A project (`.rif`): all its steps, and its values as they are printed and read again.
pub fn project(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let Ok(mut project) = Project::read("room.rif", &text) else { return };
    if project.check().is_err() {
        return;
    }
    for view in [None, Some("1"), Some("def"), Some("-vp 1 2 3")] {
        let how = How { view: view.map(str::to_owned), show_views: true, ..How::default() };
        let Ok(steps) = project.clone().steps(&how, &SomeFiles) else { continue };
        for step in steps {
            let _ = (step.outputs().len(), step.command_line());
        }
    }
    if let Ok(mut again) = Project::read("room.rif", &project.explained()) {
        let _ = again.check();
    }
}

/// Weather: what `epw2wea` reads, what it makes of it, and skies of both.
pub fn weather(bytes: &[u8]) {
    let loader = MemoryLoader::default().with(NAME, bytes);
    let run = |words: &[&str], loader: &MemoryLoader| {
        let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        radsight_scene_generators::run(&words, b"", loader)
    };
    let _ = run(&["gendaymtx", "-m", "1", "-h", NAME], &loader);
    let Ok(written) = run(&["epw2wea", NAME], &loader) else { return };
    let loader = MemoryLoader::default().with(NAME, written.standard_output);
    if let Ok(sky) = run(&["gendaymtx", "-m", "1", "-h", "-oa", NAME], &loader) {
        let text = String::from_utf8_lossy(&sky.standard_output).to_lowercase();
        assert!(!text.contains("nan") && !text.contains("inf"), "{text}");
    }
}

/// Renders a whole small scene: every pixel is a finite number, and not below zero.
///
/// # Panics
/// If one is not.
pub fn render(scene: &SmallScene) {
    fixed_inputs::on_requested_threads();
    let Ok(read) = Scene::builder().loader(MemoryLoader::default()).text("small.rad", scene.text.as_bytes()).build()
    else {
        return;
    };
    let Ok(view) = SceneView::from_args(&scene.view) else { return };
    let Ok(renderer) = Renderer::new(&read) else { return };
    let mut renderer = renderer.ambient_bounces(scene.bounces).ambient_divisions(8, 0).samples(1);
    let Ok(image) = renderer.render(&view, 4, 4) else { return };
    for pixel in image.pixels() {
        assert!(pixel.iter().all(|band| band.is_finite() && *band >= 0.0), "{pixel:?}\n{scene:?}");
    }
}

/// Pictures with more numbers are not put together: that says nothing of reading, and takes long.
const MOST_NUMBERS: usize = 1 << 20;

/// Render jobs, and the parts of pictures that they give.
///
/// # Panics
/// If a job that was read comes back from its text as another.
pub fn job(bytes: &[u8]) {
    if let Ok(job) = RenderJob::from_json("job.json", bytes) {
        let again = RenderJob::from_json("again.json", job.to_json().as_bytes());
        assert_eq!(again.expect("what was read is a job"), job);
        let _ = job.picture_size();
        let _ = (job.split(3, [5, 7]), job.split_tiles([2, 3], [5, 7]), job.split_rays(3, 7));
    }
    if let Ok(part) = JobResult::from_bytes("part.mtx", bytes)
        && part.size[0] * part.size[1] * part.components <= MOST_NUMBERS
        && let Ok(merged) = MergedJob::of(&[part])
    {
        let _ = (merged.missing(), merged.relative_error());
    }
}
