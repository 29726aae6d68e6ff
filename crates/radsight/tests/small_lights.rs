//! Lights that cover a small part of a pixel, seen directly, in mirrors and in panes: a few samples
//! per pixel find them, interpolated pictures draw them, and the mean is that of the projection.

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

/// The mean over an interpolated picture of this size; `seed` changes its random numbers.
fn interpolated_mean(scene: &str, view: &str, [columns, rows]: [usize; 2], seed: u64) -> f64 {
    let (scene, view) = (Scene::from_text(scene).unwrap(), View::from_args(view).unwrap());
    let image = Renderer::new(&scene).unwrap().seed(seed).render(&view, columns, rows).unwrap();
    image.pixels().iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / image.pixels().len() as f64
}

/// A view whose pixels are squares, straight ahead, and its area: a solid angle, or an area in
/// parallel rays.
fn view_of(kind: &str, [columns, rows]: [usize; 2]) -> (String, f64) {
    let [width, height] = [columns, rows].map(|count| 0.02 * count as f64);
    let size = match kind {
        "l" => [width, height],
        "v" => [width, height].map(|tangents| 2.0 * (0.5 * tangents).atan().to_degrees()),
        "h" => [width, height].map(|sines| 2.0 * (0.5 * sines).asin().to_degrees()),
        _ => [width, height].map(f64::to_degrees),
    };
    (format!("-vt{kind} -vd 0 1 0 -vh {} -vv {}", size[0], size[1]), width * height)
}

#[test]
fn interpolated_pictures_show_the_same_light_of_a_small_ball_with_every_seed() {
    // Balls of a tenth of a pixel to a dozen pixels.
    for radius in [0.003, 0.02, 0.08, 0.3] {
        for size in [[23, 17], [24, 40]] {
            for kind in ["v", "l", "a", "h"] {
                let (view, area) = view_of(kind, size);
                let radius = if kind == "l" { 0.2 * radius } else { radius };
                let scene = format!("void light bright 0 0 3 1e4 1e4 1e4  bright sphere lamp 0 0 4 .03 5 .02 {radius}");
                let sine = radius / DVec3::new(0.03, 5.0, 0.02).length();
                let lit = if kind == "l" { PI * radius * radius } else { PI * sine * sine };
                for seed in 0..4 {
                    let found = interpolated_mean(&scene, &view, size, seed) / (1e4 * lit / area);
                    assert!((found - 1.0).abs() < 0.015, "{found} of {radius} in {view}, seed {seed}");
                }
            }
        }
    }
}

#[test]
fn lights_drawn_before_others_hide_what_they_cover() {
    let (view, area) = view_of("v", [24, 24]);
    let sky = "void glow white 0 0 4 7 7 7 0  white source all 0 0 4 0 1 0 180";
    for radius in [0.01_f64, 0.1] {
        let ball = format!("void glow bright 0 0 4 50 50 50 0  bright sphere lamp 0 0 4 0 5 0 {radius}");
        let dark = format!("void plastic black 0 0 5 0 0 0 0 0  black sphere ball 0 0 4 0 4 0 {}", 0.5 * radius);
        let [lit, hidden] = [radius / 5.0, 0.5 * radius / 4.0].map(|sine| PI * sine * sine / area);
        let before = 7.0 * (1.0 - lit) + 50.0 * (lit - hidden);
        for (scene, expected, allowed) in [
            (format!("{sky} {ball}"), 7.0 + (50.0 - 7.0) * lit, 1e-3),
            // Four rays a pixel say how much of the ball is hidden.
            (format!("{sky} {ball} {dark}"), before, 0.2 * 50.0 * lit / before),
        ] {
            let runs = (0..16).map(|seed| interpolated_mean(&scene, &view, [24, 24], seed));
            let found = runs.sum::<f64>() / 16.0;
            assert!((found / expected - 1.0).abs() < allowed, "{found} for {expected}: {scene}");
        }
    }
}

#[test]
fn a_light_behind_a_wall_is_not_drawn() {
    let (view, _) = view_of("v", [24, 24]);
    let wall = "void plastic black 0 0 5 0 0 0 0 0  black polygon wall 0 0 12 -9 4 -9 9 4 -9 9 4 9 -9 4 9";
    assert_eq!(interpolated_mean(&format!("{} {wall}", scene("", 5.0)), &view, [24, 24], 0), 0.0);
}

#[test]
fn interpolated_pictures_show_small_lights_in_mirrors_and_behind_panes() {
    let (view, area) = view_of("v", [24, 24]);
    let mirror = format!("void mirror silver 0 0 3 .8 .8 .8 silver {SQUARE}");
    let pane = format!("void glass clear 0 0 3 .9 .9 .9 clear {SQUARE}");
    for (scene, distance) in [(scene(&pane, 8.0), 8.0), (scene(&mirror, -2.0), 12.0), (scene(&pane, -2.0), 12.0)] {
        let sine: f64 = 0.01 / distance;
        let expected = radiance_ahead(&scene) * PI * sine * sine / area;
        for seed in 0..4 {
            let found = interpolated_mean(&scene, &view, [24, 24], seed);
            assert!((found / expected - 1.0).abs() < 0.02, "{found} for {expected}");
        }
    }
}

/// The mean of a default picture over many seeds, and its standard error.
fn interpolated_statistics(scene: &str, view: &str, size: [usize; 2], seeds: u64) -> [f64; 2] {
    let means: Vec<f64> = (0..seeds).map(|seed| interpolated_mean(scene, view, size, seed)).collect();
    let mean = means.iter().sum::<f64>() / seeds as f64;
    let variance = means.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (seeds - 1) as f64;
    [mean, (variance / seeds as f64).sqrt()]
}

/// What rays to a light miss must not be drawn in full where they happen to meet it.
#[test]
fn a_light_behind_slats_is_as_bright_as_what_they_leave_of_it() {
    let (view, area) = view_of("v", [24, 24]);
    // Squares of half a pixel to two, with a fifth of their height free.
    for size in [0.05, 0.1, 0.19] {
        let slat = |index: i32| {
            let z = f64::from(index) * 0.1 - 0.51;
            format!("black polygon s{index} 0 0 12 -1 4 {z} 1 4 {z} 1 4 {0} -1 4 {0}\n", z + 0.08)
        };
        let slats: String = (0..11).map(slat).collect();
        let (low, high) = (0.09 - 0.5 * size, 0.09 + 0.5 * size);
        let lamp = format!("bright polygon lamp 0 0 12 {low} 5 {low} {high} 5 {low} {high} 5 {high} {low} 5 {high}");
        let scene = format!("void light bright 0 0 3 1e3 1e3 1e3  {lamp}\nvoid plastic black 0 0 5 0 0 0 0 0\n{slats}");
        // In tangents: the slats are at 4, the light at 5.
        let [low, high] = [low, high].map(|at| at / 5.0);
        let hidden: f64 = (0..11)
            .map(|index| [f64::from(index) * 0.025 - 0.1275, f64::from(index) * 0.025 - 0.1075])
            .map(|[from, to]| (to.min(high) - from.max(low)).max(0.0))
            .sum();
        let expected = 1e3 * (high - low - hidden) * (high - low) / area;
        let [found, error] = interpolated_statistics(&scene, &view, [24, 24], 200);
        assert!((found - expected).abs() < 3.0 * error, "{found} ± {error} for {expected}, {size}");
        assert!(error < 0.05 * expected, "{found} ± {error}");
    }
}

#[test]
fn a_ring_of_light_has_the_brightness_of_its_band() {
    let size = [48, 40];
    for kind in ["v", "l", "a"] {
        let (view, area) = view_of(kind, size);
        // A pixel is 0.02 of a tangent: bands from a third of one to six, around holes of up to thirty.
        for (inner, outer) in [(0.3, 0.307), (0.28, 0.3), (0.2, 0.32), (0.018, 0.03)] {
            let distance = if kind == "l" { 1.0 } else { 5.0 };
            let scene = format!(
                "void light bright 0 0 3 1e3 1e3 1e3  bright ring lamp 0 0 8 .03 5 .02 0 -1 0 {} {}",
                inner * distance,
                outer * distance
            );
            let band = PI * (outer * outer - inner * inner);
            let [found, error] = interpolated_statistics(&scene, &view, size, 12);
            // Equal angles are not equal tangents: up to 6 % at the edge of the ring.
            let allowed = 0.02 + if kind == "a" { 1.5 * outer * outer } else { 0.0 };
            let expected = 1e3 * band / area;
            assert!((found / expected - 1.0).abs() < allowed, "{found} ± {error} for {expected}: {inner} {view}");
        }
    }
}
