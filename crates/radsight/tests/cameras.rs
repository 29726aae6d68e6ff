//! One set of cameras: each of them renders pictures and exposes captures.

use glam::DVec3;
use radsight::{Camera, CameraRay, Capture, ErrorBudget, MemoryLoader, Renderer, Scene, View};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Inside of a uniform emitter of 2 W/(sr·m²).
const UNIFORM: &str = "void glow white 0 0 4 2 2 2 0  white bubble room 0 0 4 0 0 0 50";

/// A camera at the origin that looks along +y, with these keys besides.
fn capture(keys: &str) -> Capture {
    let text = format!(
        "[camera]
position_m = [0.0, 0.0, 0.0]
direction = [0.0, 1.0, 0.0]
up = [0.0, 0.0, 1.0]
pixels = [40, 30]
pixel_pitch_um = [100.0, 100.0]
exposure_ms = 10.0
{keys}"
    );
    Capture::from_text("camera.toml", text.as_bytes(), &MemoryLoader::default()).unwrap()
}

const PINHOLE: &str = "focal_distance_mm = 4.0\npinhole_diameter_mm = 0.01";
const TELECENTRIC: &str = "projection = \"parallel\"\nfield_width_mm = 400.0\nf_number = 4.0\nfocus_distance_m = 3.0";

/// A custom camera: it looks in all directions and has no aperture.
struct Panorama;

impl Camera for Panorama {
    fn ray(&self, [x, y]: [f64; 2], _aperture: [f64; 2]) -> Option<CameraRay> {
        let (sin, cos) = (TAU * x).sin_cos();
        Some(CameraRay { origin: DVec3::ZERO, direction: DVec3::new(sin, cos, 0.5 - y), weight: 1.0 })
    }
}

fn view(arguments: &str) -> View {
    View::from_args(&format!("-vp 0 0 0 -vd 0 3 0 {arguments}")).unwrap()
}

#[test]
fn every_camera_renders_and_exposes() {
    let views = ["-vtv", "-vta", "-vth", "-vts", "-vtc", "-vtl"].map(|kind| view(&format!("{kind} -vh 60 -vv 45")));
    let mut cameras: Vec<Arc<dyn Camera + Send + Sync>> = vec![Arc::new(Panorama)];
    cameras.extend(views.iter().map(|view| Arc::new(*view) as _));
    cameras.push(Arc::new(view("-vtv -vh 60 -vv 45").thin_lens(0.2)));
    cameras.push(Arc::new(capture(TELECENTRIC).camera()));
    let scene = Scene::from_text(UNIFORM).unwrap();
    let mut renderer = Renderer::new(&scene).unwrap().samples(4);
    for (index, camera) in cameras.into_iter().enumerate() {
        let image = renderer.render_camera(camera.as_ref(), 8, 6).unwrap();
        assert!(image.pixels().iter().flatten().all(|band| (band - 2.0).abs() < 1e-6), "camera {index}");
        let exposed = capture(PINHOLE).with_camera(camera).samples(4).expose(&scene).unwrap();
        let expected = 0.01 * 2.0 * PI * (0.5 * 0.01_f64 / 4.0).powi(2);
        let is_exact = |value: &f64| (value / expected - 1.0).abs() < 1e-9;
        assert!(exposed.exposure_j_per_m2.iter().all(is_exact), "camera {index}");
    }
    // cos⁴ of the file's pinhole.
    let image = renderer.render_camera(&capture(PINHOLE).camera(), 40, 30).unwrap();
    let corner = 1.0 + (19.5_f64.powi(2) + 14.5_f64.powi(2)) / 40.0_f64.powi(2);
    assert!((f64::from(image.pixel(0, 0)[0]) - 2.0 / corner.powi(2)).abs() < 1e-2, "{:?}", image.pixel(0, 0));
}

#[test]
fn every_projection_of_a_camera_file_sees_as_radiances_view_does() {
    // Sizes of the sensor in focal distances.
    let (w, h) = (1.0_f64, 0.75_f64);
    let twice = |angle: fn(f64) -> f64| [2.0 * angle(0.5 * w), 2.0 * angle(0.5 * h)];
    let cases = [
        ("perspective", "-vtv", twice(f64::atan)),
        ("equidistant", "-vta", [w, h]),
        ("orthographic", "-vth", twice(f64::asin)),
        ("stereographic", "-vts", [4.0 * (0.25 * w).atan(), 4.0 * (0.25 * h).atan()]),
        ("cylindrical", "-vtc", [w, 2.0 * (0.5 * h).atan()]),
    ];
    for (projection, kind, angles) in cases {
        let camera = capture(&format!("{PINHOLE}\nprojection = \"{projection}\"")).camera();
        let [horizontal, vertical] = angles.map(f64::to_degrees);
        let view = view(&format!("{kind} -vh {horizontal} -vv {vertical}"));
        for film in [[0.5, 0.5], [0.1, 0.4], [0.9, 0.2], [0.3, 0.95]] {
            let [own, radiances] = [&camera as &dyn Camera, &view].map(|camera| camera.ray(film, [0.5; 2]).unwrap());
            let apart = own.direction.normalize().distance(radiances.direction.normalize());
            assert!(apart < 1e-6, "{projection} at {film:?}: {apart}");
        }
    }
    let camera = capture(TELECENTRIC).camera();
    let view = view("-vtl -vh 0.4 -vv 0.3");
    for film in [[0.5, 0.5], [0.1, 0.4], [0.9, 0.2]] {
        let [own, radiances] = [&camera as &dyn Camera, &view].map(|camera| camera.ray(film, [0.5; 2]).unwrap());
        assert!(own.origin.distance(radiances.origin) < 1e-9 && own.direction.distance(DVec3::Y) < 1e-9, "{film:?}");
    }
}

#[test]
fn the_files_own_camera_exposes_as_the_file_does() {
    let scene = Scene::from_text("void glow white 0 0 4 2 1 2 0  white sphere ball 0 0 4 0.1 4 0 1").unwrap();
    let capture = capture("lens_focal_length_mm = 4.0\nf_number = 2.0\nfocus_distance_m = 3.0").samples(16);
    let expected = capture.expose(&scene).unwrap();
    let found = capture.clone().with_camera(Arc::new(capture.camera())).expose(&scene).unwrap();
    let largest = expected.exposure_j_per_m2.iter().copied().fold(0.0, f64::max);
    for (found, expected) in found.exposure_j_per_m2.iter().zip(&expected.exposure_j_per_m2) {
        assert!((found - expected).abs() < 1e-6 * largest, "{found} for {expected}");
    }
}

#[test]
fn a_custom_camera_reaches_the_requested_error() {
    let text =
        "void glow white 0 0 4 1 1 1 0  white sphere ball 0 0 4 0 5 0 .7  white ring moon 0 0 8 3 9 1 0 -1 0 0 1.3";
    let scene = Scene::from_text(text).unwrap();
    let camera = view("-vtv -vh 50 -vv 40").thin_lens(0.2);
    let image = Renderer::new(&scene).unwrap().error(0.05).render_camera(&camera, 40, 32).unwrap();
    let truth = Renderer::new(&scene).unwrap().samples(8192).render_camera(&camera, 40, 32).unwrap();
    let report = image.report();
    assert!(report.error.unwrap() <= 0.05 && !report.is_stopped, "{report}");
    let typical = truth.pixels().iter().map(|pixel| f64::from(pixel[0])).filter(|value| *value > 0.0);
    let floor = 0.01 * typical.clone().sum::<f64>() / typical.count() as f64;
    let squared = |(found, truth): (&[f32; 3], &[f32; 3])| {
        let [found, truth] = [found[0], truth[0]].map(f64::from);
        (found - truth).powi(2) / (truth * truth + floor * floor)
    };
    let errors = image.pixels().iter().zip(truth.pixels()).map(squared);
    let found = (errors.sum::<f64>() / 1280.0).sqrt();
    assert!(found < 0.08 && found > 0.005, "{found}");
    let rays: Vec<u32> = image.samples().unwrap().to_vec();
    assert!(rays.iter().min() == Some(&4) && rays.iter().max() > Some(&64), "sampled where it is noisy");
}

#[test]
fn one_budget_is_that_of_pictures_and_captures() {
    let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0  white sphere ball 0 0 4 0.3 5 0 .7").unwrap();
    let budget = ErrorBudget::error(1e-3).at_most(32);
    let exposed = capture(PINHOLE).budget(budget).expose(&scene).unwrap();
    let statistics = exposed.pixels.as_ref().unwrap();
    assert!(exposed.is_stopped && statistics.samples.iter().max() == Some(&32));
    let image =
        Renderer::new(&scene).unwrap().budget(budget).render_camera(&capture(PINHOLE).camera(), 40, 30).unwrap();
    assert!(image.samples().unwrap().iter().max() > Some(&32), "a lower error than 0.02 raises a picture's limit");
    let preview = capture(PINHOLE).budget(ErrorBudget::default()).expose(&scene);
    assert!(preview.unwrap_err().to_string().contains("an error or a number of samples"));
}

#[test]
fn a_telecentric_capture_is_the_closed_form_and_keeps_the_size() {
    let uniform = capture(TELECENTRIC).samples(4).expose(&Scene::from_text(UNIFORM).unwrap()).unwrap();
    let expected = 0.01 * PI * 2.0 / (4.0 * 4.0 * 4.0);
    assert!(uniform.exposure_j_per_m2.iter().all(|value| (value / expected - 1.0).abs() < 1e-9));
    // The mean of a disk of radius 0.1 over a field of 0.4 by 0.3, at different distances.
    for distance in [2.0, 3.0, 5.0] {
        let text = format!("void glow white 0 0 4 2 2 2 0  white ring disk 0 0 8 0 {distance} 0 0 -1 0 0 .1");
        let image = capture(TELECENTRIC).samples(64).expose(&Scene::from_text(text.as_str()).unwrap()).unwrap();
        let share = image.mean_exposure() / expected;
        assert!((share - PI * 0.01 / 0.12).abs() < 2e-3, "{distance}: {share}");
    }
}
