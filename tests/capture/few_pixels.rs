//! Sensors and pictures of a few pixels reach the requested error: their noise is not mistaken for less
//! because two halves of a few samples agree.

use radsight::{Capture, MemoryLoader, Renderer, Scene, View};

const SEEDS: u64 = 32;

/// A ball above a floor, which are lit by a lamp from one side.
const SCENE: &str = "void plastic grey 0 0 5 .5 .4 .3 0 0
void plastic floor 0 0 5 .2 .2 .2 0 0
void light lamp 0 0 3 100 100 100
floor polygon f 0 0 12 -.5 -.5 0 .5 -.5 0 .5 .5 0 -.5 .5 0
grey sphere ball 0 0 4 .03 .01 .03 .025
lamp sphere l 0 0 4 .3 .2 .4 .05
";

/// Relative errors by seed: rms, and the largest.
fn errors(exposed: impl Fn(u64) -> Vec<f64>, truth: &[f64]) -> [f64; 2] {
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let squared = |seed: u64| {
        let values = exposed(seed);
        assert_eq!(values.len(), truth.len());
        values.iter().zip(truth).map(|(value, truth)| ((value - truth) / mean).powi(2)).sum::<f64>()
            / truth.len() as f64
    };
    let all: Vec<f64> = (0..SEEDS).map(squared).collect();
    [(all.iter().sum::<f64>() / SEEDS as f64).sqrt(), all.iter().fold(0.0, |a: f64, b| a.max(*b)).sqrt()]
}

fn camera([columns, rows]: [usize; 2]) -> Capture {
    let [x, y] = [500.0 / columns as f64, 500.0 / rows as f64];
    let text = format!(
        "[camera]\nposition_m = [0, 0, 0.5]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\npixels = [{columns}, {rows}]\n\
         pixel_pitch_um = [{x}, {y}]\nfocal_distance_mm = 6.0\npinhole_diameter_mm = 0.1\nexposure_ms = 10\n"
    );
    Capture::from_text("camera.toml", text.as_bytes(), &MemoryLoader::default()).expect("a camera")
}

#[test]
fn a_capture_of_a_few_pixels_has_the_requested_error() {
    let scene = Scene::from_text(SCENE).expect("a scene");
    for size in [[1, 1], [2, 1], [3, 2], [3, 5]] {
        let exposed = |capture: Capture| capture.expose(&scene).expect("an exposure").exposure_j_per_m2;
        // Its seeds agree within 2e-4, and 65,536 samples within 1e-3.
        let truth = exposed(camera(size).error(0.0005).seed(99));
        let [rms, largest] = errors(|seed| exposed(camera(size).error(0.01).seed(seed)), &truth);
        assert!(rms < 0.012 && largest < 0.03, "{size:?}: rms {rms}, largest {largest}");
    }
}

#[test]
fn a_picture_of_a_few_pixels_has_the_requested_error() {
    let scene = Scene::from_text(SCENE).expect("a scene");
    for [columns, rows] in [[1, 1], [2, 1], [3, 2]] {
        let view = View::from_args("-vp 0 0 .5 -vd 0 0 -1 -vu 0 1 0 -vh 8 -vv 8").expect("a view");
        let rendered = |renderer: Renderer, seed: u64| -> Vec<f64> {
            let mut renderer = renderer.pixel_jitter(1.0).seed(seed);
            let image = renderer.render(&view, columns, rows).expect("a picture");
            image.pixels().iter().map(|bands| f64::from(bands[1])).collect()
        };
        let new = || Renderer::new(&scene).expect("a scene to render").ambient_bounces(0);
        // Pictures to an error sample the lamp in the penumbra far better than a fixed number of rays.
        let truth = rendered(new().error(0.0005), 99);
        let [rms, largest] = errors(|seed| rendered(new().error(0.01), seed), &truth);
        assert!(rms < 0.012 && largest < 0.03, "{columns} x {rows}: rms {rms}, largest {largest}");
    }
}
