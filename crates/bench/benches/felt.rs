//! Operations that a user notices, one by one: `cargo bench -p radsight-bench`. `radsight-bench`
//! measures whole programs.

use divan::{Bencher, black_box};
use glam::DVec3;
use radsight_cal::{Bindings, Definitions, Program, Root, Scope, Scratch};
use radsight_camera::CameraFile;
use radsight_capture::{Exposer, Silent};
use radsight_diag::SourceMap;
use radsight_irradiance_cache::{Cache, GatheredRadiance, Hemisphere, Limits, Record, Unobstructed};
use radsight_loader::MemoryLoader;
use radsight_parse::{Input, Read, ReadOptions, read_scene};
use radsight_pinhole::Rays;
use radsight_render::{NoModels, Ray, RenderOptions, RenderPlan, Renderer};
use std::fmt::Write as _;

fn main() {
    divan::main();
}

/// Squares along each side of the terrain; each is two triangles.
const SQUARES: u32 = 200;

/// Hilly terrain of 80,000 triangles.
fn land() -> String {
    let height = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) / f64::from(SQUARES), f64::from(j) / f64::from(SQUARES));
        format!("{x} {y} {}", 0.05 * (13.0 * x).sin() * (17.0 * y).cos() + 0.01 * (97.0 * x + 31.0 * y).sin())
    };
    let mut text = "void plastic ground 0 0 5 .5 .5 .5 0 0\n".to_owned();
    for (i, j) in (0..SQUARES).flat_map(|i| (0..SQUARES).map(move |j| (i, j))) {
        let [a, b, c, d] = [height(i, j), height(i + 1, j), height(i + 1, j + 1), height(i, j + 1)];
        let _ = write!(text, "ground polygon a 0 0 9 {a} {b} {c}\nground polygon b 0 0 9 {a} {c} {d}\n");
    }
    text
}

fn read(texts: &[&str], loader: &MemoryLoader) -> Read {
    let input = |text: &&str| Input::Text { name: "scene".to_owned(), text: text.as_bytes().into() };
    read_scene(&texts.iter().map(input).collect::<Vec<_>>(), loader, &ReadOptions::default())
}

fn plan(texts: &[&str], loader: &MemoryLoader) -> RenderPlan {
    let scene = read(texts, loader).scene.validate().expect("the scene is right").scene;
    RenderPlan::new(scene, RenderOptions::default(), &NoModels).expect("the scene can be rendered")
}

/// The position of ray `index` on a unit square, incoherent (Roberts' sequence R2).
fn place(index: u64) -> [f64; 2] {
    [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| (0.5 + step * index as f64).fract())
}

/// Incoherent rays through the air above the terrain.
fn ray(index: u64) -> Ray {
    let ([x, y], [turn, height]) = (place(index), place(index * 7 + 3));
    let turn = std::f64::consts::TAU * turn;
    Ray::new(DVec3::new(x, y, 0.1), DVec3::new(turn.cos(), turn.sin(), height - 0.8))
        .expect("a direction with a length")
}

/// Calls `run` with 0, 1, 2, …
fn counted<T>(bencher: Bencher<'_, '_>, mut run: impl FnMut(u64) -> T) {
    let mut index = 0;
    bencher.bench_local(|| {
        index += 1;
        run(index)
    });
}

#[divan::bench]
fn closest_hit_in_80_000_triangles(bencher: Bencher<'_, '_>) {
    let plan = plan(&[&land()], &MemoryLoader::default());
    counted(bencher, |index| plan.distance(&ray(index)));
}

#[divan::bench]
fn shadow_ray_among_80_000_triangles(bencher: Bencher<'_, '_>) {
    let plan = plan(&[&land()], &MemoryLoader::default());
    counted(bencher, |index| plan.is_blocked(&ray(index), 0.5));
}

#[divan::bench]
fn expression_of_a_function_file(bencher: Bencher<'_, '_>) {
    let mut sources = SourceMap::default();
    let mut definitions = Definitions::with_initial_library();
    let scope = Scope::of_file("led.cal");
    let text = b"off = Acos(-Dz)/DEGREE; led = if(off-A1, 0, A2*(1-sq(off/A1)));";
    let source = sources.add("led.cal", &text[..], None);
    definitions.load(source, text, &scope).expect("the file is right");
    let root = Root::Expression { text: "led", span: sources.span(source, 0, 3) };
    let bindings = Bindings { real_arguments: &[30.0, 5.0], ..Bindings::of_ray() };
    let program = Program::compile(&definitions, &scope, &[root], &bindings).expect("the expression is right");
    let mut scratch = Scratch::new();
    counted(bencher, |index| {
        let tilt = 0.4 * place(index)[0];
        program.eval(0, &[], black_box(&[tilt.sin(), 0.0, -tilt.cos()][..]), &mut scratch)
    });
}

/// Traces rays straight down to the unit square from a little above it.
fn look_down(bencher: Bencher<'_, '_>, plan: RenderPlan) {
    let renderer = Renderer::new(plan);
    let mut worker = renderer.worker();
    counted(bencher, |index| {
        let [x, y] = place(index);
        let ray = Ray { origin: DVec3::new(x, y, 0.05), direction: DVec3::NEG_Z };
        worker.trace(index, &ray).value[0]
    });
}

#[divan::bench]
fn ray_to_a_picture(bencher: Bencher<'_, '_>) {
    let mut picture = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 256 +X 4\n".to_vec();
    picture.extend((0..4 * 256_u32).flat_map(|pixel| [(pixel % 251) as u8, 128, (pixel % 127) as u8, 128]));
    let loader = MemoryLoader::default().with("slide.hdr", picture);
    let text = "void colorpict slide 7 red green blue slide.hdr picture.cal pic_u pic_v 0 0\n\
                slide glow shining 0 0 4 1 1 1 0\nshining polygon screen 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n";
    look_down(bencher, plan(&[text], &loader));
}

#[divan::bench]
fn ray_to_a_floor_under_10_000_lights(bencher: Bencher<'_, '_>) {
    let mut text = "void plastic floor 0 0 5 .5 .5 .5 0 0\nfloor polygon square 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n\
                    void light lamp 0 0 3 100 100 100\n"
        .to_owned();
    for (i, j) in (0..100).flat_map(|i| (0..100).map(move |j| (i, j))) {
        let [x, y] = [i, j].map(|place| 0.01 * (f64::from(place) + 0.5));
        let _ = writeln!(text, "lamp sphere lamp 0 0 4 {x} {y} .3 .001");
    }
    look_down(bencher, plan(&[&text], &MemoryLoader::default()));
}

#[divan::bench]
fn shared_irradiance_among_1000_records(bencher: Bencher<'_, '_>) {
    let hemisphere = Hemisphere::with_divisions(64);
    let seen = vec![GatheredRadiance { radiance: [2.0, 1.0, 0.5], distance: 0.5 }; hemisphere.len()];
    let limits = Limits { accuracy: 0.1, min_reach: 0.01, max_reach: 1.0, explained: 1.0 };
    let mut cache = Cache::new(limits);
    for index in 0..1000 {
        let [x, y] = place(index);
        cache.insert(Record::new(DVec3::new(x, y, 0.0), DVec3::Z, &hemisphere, &seen, &limits), 0);
    }
    counted(bencher, |index| {
        let [x, y] = place(index * 3 + 1);
        cache.irradiance(DVec3::new(x, y, 0.0), DVec3::Z, DVec3::Z, &Unobstructed)
    });
}

/// The whole small sheet, since a pixel of 32 × 32 alone would not be representative.
#[divan::bench(sample_count = 20)]
fn capture_of_a_small_sheet(bencher: Bencher<'_, '_>) {
    const CAMERA: &str = include_str!("../../../radiance-scenes/gripps/fig11.toml");
    const SHEET: &str = include_str!("../../../radiance-scenes/gripps/sheet-retro.rad");
    let loader =
        MemoryLoader::default().with("hlmp-8104.csv", include_str!("../../../radiance-scenes/gripps/hlmp-8104.csv"));
    let small = CAMERA.replace("pixels = [192, 165]", "pixels = [32, 32]");
    let camera = CameraFile::read("fig11.toml", small.as_bytes(), &mut SourceMap::default(), &loader);
    let camera = camera.expect("the camera file is right");
    let rig = camera.rig.as_ref().map_or(String::new(), radsight_camera::Rig::scene_text);
    let plan = plan(&[SHEET, &rig], &loader);
    let weights = camera.band_weights_for(plan.bands()).expect("the bands are the scene's");
    let renderer = Renderer::new(plan);
    let rays = Rays::new(&camera.camera, 4, 0);
    bencher.bench_local(|| {
        Exposer { renderer: &renderer, rays: &rays, weights: &weights, by_row: &[] }.with_samples(None, &Silent)
    });
}

#[divan::bench(sample_count = 10)]
fn text_of_80_000_triangles(bencher: Bencher<'_, '_>) {
    let text = land();
    bencher.bench_local(|| read(&[&text], &MemoryLoader::default()).scene.surfaces.len());
}

#[divan::bench(sample_count = 10)]
fn hierarchy_of_80_000_triangles(bencher: Bencher<'_, '_>) {
    let scene = read(&[&land()], &MemoryLoader::default()).scene.validate().expect("the scene is right").scene;
    bencher
        .with_inputs(|| scene.clone())
        .bench_local_values(|scene| RenderPlan::new(scene, RenderOptions::default(), &NoModels).is_ok());
}
