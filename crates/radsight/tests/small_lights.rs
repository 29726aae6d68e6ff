//! Lights that cover a small part of a pixel, seen directly, in mirrors and in panes: a few samples
//! per pixel find them, and the mean is that of the projection.

use glam::DVec3;
use radsight::{Image, Ray, Renderer, Scene, View};
use std::f64::consts::PI;

const RUNS: u64 = 16;

/// The outline of a ball is larger than the ball by this fraction. So few rays usually miss none of
/// it, and then do not vary at all.
const OUTLINE: f64 = 0.006;

/// Mean over a picture of 9 × 9 pixels.
fn mean(image: &Image) -> f64 {
    image.pixels().iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / 81.0
}

/// Means of pictures with four samples per pixel: their mean, its standard error and their relative
/// standard deviation.
fn statistics(scene: &str, view: &str) -> [f64; 3] {
    let (scene, view) = (Scene::from_text(scene).unwrap(), View::from_args(view).unwrap());
    let run = |seed| {
        let mut renderer = Renderer::new(&scene).unwrap().samples(4).pixel_jitter(1.0).seed(seed);
        mean(&renderer.render(&view, 9, 9).unwrap())
    };
    let means: Vec<f64> = (0..RUNS).map(run).collect();
    let count = RUNS as f64;
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
    [mean, (variance / count).sqrt(), variance.sqrt() / mean]
}

/// Radiance straight ahead.
fn radiance_ahead(scene: &str) -> f64 {
    let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
    Renderer::new(&Scene::from_text(scene).unwrap()).unwrap().trace(&[ahead]).unwrap()[0].value[1]
}

/// A ball before a dark wall, in front of the camera or, where a mirror shows it, behind it.
fn scene(mirror: &str, at: f64) -> String {
    format!("void light bright 0 0 3 1e4 1e4 1e4  bright sphere lamp 0 0 4 0 {at} 0 .01 {mirror}")
}

const SQUARE: &str = "polygon flat 0 0 12 -1 5 -1 1 5 -1 1 5 1 -1 5 1";

#[test]
fn a_light_of_a_tenth_of_a_pixel_has_the_radiance_of_its_projection() {
    let views = [
        ("-vtv -vd 0 1 0 -vh 15 -vv 15", (2.0 * 7.5_f64.to_radians().tan()).powi(2)),
        ("-vta -vd 0 1 0 -vh 15 -vv 15", 15.0_f64.to_radians().powi(2)),
        ("-vth -vd 0 1 0 -vh 15 -vv 15", (2.0 * 7.5_f64.to_radians().sin()).powi(2)),
        // A corner of four pixels.
        ("-vtv -vd 0 1 0 -vh 15 -vv 15 -vs .0556 -vl .0556", (2.0 * 7.5_f64.to_radians().tan()).powi(2)),
    ];
    let mirror = format!("void mirror silver 0 0 3 .8 .8 .8 silver {SQUARE}");
    let pane = format!("void glass clear 0 0 3 .9 .9 .9 clear {SQUARE}");
    let metal = format!("void metal chrome 0 0 5 .7 .7 .7 1 0 chrome {SQUARE}");
    // Behind the pane, and on the camera's side of it.
    for (scene, distance) in [
        (scene("", 5.0), 5.0),
        (scene(&pane, 8.0), 8.0),
        (scene(&mirror, -2.0), 12.0),
        (scene(&pane, -2.0), 12.0),
        (scene(&metal, -2.0), 12.0),
    ] {
        let sine: f64 = 0.01 / distance;
        for (view, size) in views {
            // At this size its area is the same in all projections.
            let expected = radiance_ahead(&scene) * PI * sine * sine / size;
            let [found, error, deviation] = statistics(&scene, view);
            assert!(
                (found - expected).abs() < 3.0 * error + OUTLINE * expected,
                "{view}: {found} ± {error} for {expected}"
            );
            assert!(deviation < 0.15, "{view}: {found} ± {deviation} of it at {distance}");
        }
    }
}

#[test]
fn a_light_in_parallel_rays_has_the_radiance_of_its_projection() {
    let scene = scene("", 5.0);
    let [found, error, deviation] = statistics(&scene, "-vtl -vd 0 1 0 -vh 1 -vv 1");
    let expected = 1e4 * PI * 0.01 * 0.01;
    assert!((found - expected).abs() < 3.0 * error + OUTLINE * expected, "{found} ± {error} for {expected}");
    assert!(deviation < 0.15, "{deviation}");
}

/// The sun through two mirrors, which show it together with a part of a frame before it.
#[test]
fn lights_in_two_mirrors_and_behind_obstacles_have_the_mean_of_many_samples() {
    let scene = "void light bright 0 0 3 1e4 1e4 1e4  bright source sun 0 0 4 .1 1 .2 .6
        void mirror silver 0 0 3 .8 .8 .8
        silver polygon one 0 0 12 2 3 -3 2 9 -3 2 9 3 2 3 3
        silver polygon two 0 0 12 -2 9 -3 -2 3 -3 -2 3 3 -2 9 3
        void plastic grey 0 0 5 .2 .2 .2 0 0
        grey cylinder bar 0 0 7 -3 4 .83 3 4 .83 .01
        bright cylinder tube 0 0 7 -.5 7 -.6 .6 6 -.4 .004";
    let view = "-vtv -vd 0 1 0 -vh 70 -vv 70";
    let [found, error, deviation] = statistics(scene, view);
    let (parsed, view) = (Scene::from_text(scene).unwrap(), View::from_args(view).unwrap());
    let dense = |seed| {
        let mut renderer = Renderer::new(&parsed).unwrap().samples(1).pixel_jitter(1.0).seed(seed);
        let image = renderer.render(&view, 1200, 1200).unwrap();
        image.pixels().iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / image.pixels().len() as f64
    };
    let expected = (0..2).map(dense).sum::<f64>() / 2.0;
    assert!((found / expected - 1.0).abs() < 3.0 * error / expected + 0.02, "{found} ± {error} for {expected}");
    assert!(deviation < 0.15, "{deviation}");
}
