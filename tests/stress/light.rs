//! Light with a thousand bounces, and sums of many samples.

use crate::table::row;
use glam::DVec3;
use radsight::{Ray, RenderOptions, Renderer, Scene};
use radsight_render::PathLimit;
use radsight_sampling::{DimensionSet, RaySampler};

/// Mean of the first band over single paths from one start, and the number of NaN or negative
/// values.
pub(crate) fn mean(
    scene: &str,
    mut options: RenderOptions,
    origin: DVec3,
    direction: DVec3,
    rays: usize,
) -> (f64, usize) {
    let scene = Scene::from_text(scene).expect("the scene is right");
    let ray = Ray::new(origin, direction).expect("a direction");
    options.gathering.divisions = 1;
    let mut renderer = Renderer::with_options(&scene, options).expect("it can be rendered");
    let traced = renderer.trace(&vec![ray; rays]).expect("its materials can be used");
    let values: Vec<f64> = traced.iter().flat_map(|traced| traced.value).collect();
    let wrong = values.iter().filter(|value| !(value.is_finite() && **value >= 0.0)).count();
    (values.iter().step_by(3).sum::<f64>() / rays as f64, wrong)
}

/// The share of glow in the walls of the tests below; the rest reflects.
const GLOWING: f64 = 0.001;

/// Options under which only the number of reflections ends a path.
fn so_deep(depth: u32) -> RenderOptions {
    RenderOptions {
        ambient_bounces: depth,
        path_limit: PathLimit::Cut(depth),
        least_weight: 0.0,
        mirror_sources: 0,
        ..RenderOptions::default()
    }
}

/// Between a mirror and a wall that glows a little and mirrors the rest: a series truncated at the
/// depth.
#[test]
fn mirrors_that_face_each_other() {
    for (reflectance, depth) in [(1.0_f64, 10), (1.0, 1_000), (0.999, 1_000)] {
        let scene = format!(
            "void metal m 0 0 5 {reflectance} {reflectance} {reflectance} 1 0\nm polygon a 0 0 12 -9 0 -9 9 0 -9 9 0 9 -9 0 9\n\
             void glow g 0 0 4 1 1 1 0\nvoid mixfunc both 4 g m {GLOWING} . 0 0\n\
             both polygon b 0 0 12 -9 1 -9 9 1 -9 9 1 9 -9 1 9\n"
        );
        let (found, wrong) = mean(&scene, so_deep(depth), DVec3::new(0.1, 0.5, 0.1), DVec3::Y, 1);
        // Each round trip is two reflections.
        let turn = (1.0 - GLOWING) * reflectance * reflectance;
        let expected: f64 = (0..=depth / 2).map(|turns| GLOWING * turn.powi(turns as i32)).sum();
        assert_eq!(wrong, 0);
        let case = format!("facing mirrors of {reflectance}, {depth} reflections");
        row(&case, "radiance, against the series", 0.005, (found / expected - 1.0).abs());
    }
}

/// A sphere whose inside glows a little and reflects the rest: its radiance is a geometric series
/// of the emission.
#[test]
fn a_white_furnace_a_thousand_bounces_deep() {
    for (albedo, glowing) in [(0.9_f64, 0.1), (0.999, 0.01), (1.0, 0.01)] {
        let scene = format!(
            "void plastic white 0 0 5 {albedo} {albedo} {albedo} 0 0\nvoid glow g 0 0 4 1 1 1 0\n\
             void mixfunc both 4 g white {glowing} . 0 0\nboth bubble room 0 0 4 0 0 0 1\n"
        );
        let (found, wrong) =
            mean(&scene, so_deep(1_000), DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, 0.8, -0.5), 20_000);
        let kept = (1.0 - glowing) * albedo;
        let expected: f64 = (0..=1_000).map(|bounces| glowing * kept.powi(bounces)).sum();
        assert_eq!(wrong, 0);
        let case = format!("furnace of albedo {albedo}, 1000 bounces");
        row(&case, "radiance, against the series", 0.01, (found / expected - 1.0).abs());
    }
    // Albedo 1: no light is lost in a thousand bounces.
    let scene = "void plastic white 0 0 5 1 1 1 0 0\nwhite bubble room 0 0 4 0 0 0 1\nvoid glow g 0 0 4 1 1 1 0\ng sphere lamp 0 0 4 0 0 0 .5\n";
    let (found, wrong) = mean(scene, so_deep(1_000), DVec3::new(0.7, 0.0, 0.0), DVec3::new(0.3, 0.8, -0.1), 2_000);
    assert_eq!(wrong, 0);
    row("furnace of albedo 1, depth 1000", "radiance around a lamp of 1, against 1", 0.01, (found - 1.0).abs());
}

/// Sums as in the film, in double precision in sequence, over the sample sequence after 10⁹
/// samples: the mean is unchanged.
#[test]
fn sums_of_many_samples() {
    let whole: u64 = 1 << 30;
    for first in [0, whole, 1 << 40, 1 << 60] {
        let mut sums = [0.0; 4];
        for index in 0..1 << 16 {
            let taken = RaySampler::new(3, first + index).take(DimensionSet::render(2));
            sums = std::array::from_fn(|dimension| sums[dimension] + taken[dimension]);
        }
        let worst = sums.map(|sum| (sum / f64::from(1 << 16) - 0.5).abs()).into_iter().fold(0.0, f64::max);
        row(&format!("samples from number {first:.1e} on"), "mean of 65,536 samples, against one half", 2e-5, worst);
    }
    // 10⁹ equal terms added to a sum of the same size: the rounding error of each is at most half a
    // unit in the last place.
    let (mut sum, step) = (0.0_f64, 0.1_f64);
    for _ in 0..1 << 24 {
        sum += step;
    }
    let blocks = (0..64).fold(0.0, |whole: f64, _| whole + sum);
    row(
        "sum of 2^30 shares in blocks of 2^24",
        "against the product",
        1e-9,
        (blocks / (64.0 * 1.677_721_6e6) - 1.0).abs(),
    );
}
