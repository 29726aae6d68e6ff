//! Guarantees of the library: units, errors as data, and results that do not depend on the caller.

use glam::DVec3;
use radsight::options::Sampling;
use radsight::{
    CacheError, Capture, Error, ErrorBudget, FileLoader, Image, Progress, Ray, Renderer, SamplingBudget, Scene, View,
};
use std::f64::consts::PI;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

const TABLE: &str = "void light lamp 0 0 3 100 100 100  void plastic grey 0 0 5 .5 .4 .3 0 0
    lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .05  grey ring table 0 0 8 0 0 0 0 0 1 0 6";

#[test]
fn radiance_below_a_small_lamp_is_that_of_the_inverse_square_law() {
    let scene = Scene::from_text(TABLE).unwrap();
    let down = Ray::new(DVec3::new(0.0, 0.0, 1.0), -DVec3::Z).unwrap();
    let traced = Renderer::new(&scene).unwrap().trace(&[down]).unwrap();
    let irradiance = 100.0 * PI * 0.05 * 0.05 / 16.0;
    for (value, reflectance) in traced[0].value.iter().zip([0.5, 0.4, 0.3]) {
        let expected = reflectance * irradiance / PI;
        assert!((value / expected - 1.0).abs() < 1e-3, "{value} instead of {expected}");
    }
    assert_eq!(traced[0].first_hit.unwrap().distance, 1.0);
}

#[test]
fn contributions_add_up_to_the_radiance() {
    let text = format!("{TABLE} void light second 0 0 3 50 60 70 second sphere bulb2 0 0 4 2 0 3 .1");
    let scene = Scene::from_text(text).unwrap();
    let ray = Ray::new(DVec3::new(0.5, 0.0, 1.0), -DVec3::Z).unwrap();
    let mut renderer = Renderer::new(&scene).unwrap();
    let whole = renderer.trace(&[ray]).unwrap()[0].value;
    let parts = renderer.contributions(&[ray], &["lamp", "second"]).unwrap();
    for (band, whole) in whole.iter().enumerate() {
        let sum: f64 = parts[0].iter().map(|part| part.value[band]).sum();
        assert!((sum / whole - 1.0).abs() < 0.02, "band {band}: {sum} of {whole}");
    }
}

#[test]
fn spectral_contributions_add_up_to_the_colour_of_the_radiance() {
    let text = format!("{TABLE} void light second 0 0 3 50 60 70 second sphere bulb2 0 0 4 2 0 3 .1");
    let ray = Ray::new(DVec3::new(0.5, 0.0, 1.0), -DVec3::Z).unwrap();
    let mut renderer = Renderer::new(&Scene::from_text(text).unwrap()).unwrap();
    renderer.options_mut().sampling = Sampling::new(6, [730.0, 430.0]).unwrap();
    let whole = renderer.trace(&[ray]).unwrap()[0].value;
    let parts = renderer.contributions(&[ray], &["lamp", "second"]).unwrap();
    for (band, whole) in whole.iter().enumerate() {
        let sum: f64 = parts[0].iter().map(|part| part.value[band]).sum();
        assert!((sum / whole - 1.0).abs() < 0.02, "colour {band}: {sum} of {whole}");
    }
}

#[test]
fn all_mistakes_come_with_their_places() {
    let error = Scene::from_text(
        "chrome sphere ball 0 0 4 0 0 0 1\nvoid plastic p 0 0 4 1 1 1 0\np ring r 0 0 8 0 0 0 0 0 1 0 1\n",
    );
    let Err(Error::Scene(report)) = error else { panic!("two mistakes") };
    let lines: Vec<u32> =
        report.diagnostics.iter().filter_map(|d| report.position(d)).map(|(_, line, _)| line).collect();
    assert!(lines.contains(&1) && lines.contains(&2), "{report}");
}

#[test]
fn no_command_of_a_scene_is_run() {
    let marker = std::env::temp_dir().join("radsight-library-ran-a-command");
    let text = format!("!touch {}\nvoid glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 0 1\n", marker.display());
    let _ = Scene::from_text(text);
    assert!(!marker.exists());
}

#[test]
fn options_out_of_range_are_errors() {
    let scene = Scene::from_text(TABLE).unwrap();
    let view = View::from_args("-vp 0 0 2 -vd 0 0 -1 -vu 0 1 0").unwrap();
    let renderer = || Renderer::new(&scene).unwrap();
    assert!(matches!(renderer().error(-1.0).render(&view, 8, 8), Err(Error::Option { option: "error", .. })));
    assert!(matches!(renderer().error(f64::NAN).render(&view, 8, 8), Err(Error::Option { option: "error", .. })));
    assert!(matches!(renderer().samples(0).render(&view, 8, 8), Err(Error::Option { option: "samples", .. })));
    assert!(matches!(renderer().render(&view, 0, 8), Err(Error::Size { .. })));
    assert!(matches!(View::from_args("-vx 1"), Err(Error::View(_))));
    assert!(matches!(Scene::load(["no such file.rad"]), Err(Error::Load(_))));
    assert!(matches!(Capture::from_text("c.toml", b"[camera]\n", &FileLoader::default()), Err(Error::Camera(_))));
}

#[test]
fn a_smaller_error_takes_more_rays() {
    let scene = Scene::from_text(TABLE).unwrap();
    let view = View::from_args("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 60").unwrap();
    let rays = |error| {
        let image = Renderer::new(&scene).unwrap().error(error).render(&view, 48, 48).unwrap();
        assert!(image.report().error.unwrap() <= error, "{}", image.report());
        image.report().rays_per_pixel.unwrap()
    };
    assert!(rays(0.005) > 1.5 * rays(0.1));
}

/// A box that a small lamp lights by way of a patch of the wall, with a row of balls.
fn box_with_balls() -> Scene {
    let mut text = "void plastic wall 0 0 5 .6 .5 .4 0 0  void plastic dark 0 0 5 .1 .1 .1 0 0
        void spotlight beam 0 0 7 4e4 4e4 4e4 40 -1 0 .2
        beam ring lamp 0 0 8 2 2 2.5 -1 0 .2 0 .02
        wall bubble room 0 0 4 2 1.5 1.5 3 "
        .to_owned();
    for ball in 0..6 {
        text += &format!("dark sphere b{ball} 0 0 4 {} {} .6 .3 ", 0.5 + 0.55 * f64::from(ball), 1 + ball % 2);
    }
    Scene::from_text(text).unwrap()
}

/// Mean squared error of a picture relative to two independent ones, as [`ErrorBudget::error`]
/// defines it.
fn relative_squared_error(image: &Image, references: &[Image; 2]) -> f64 {
    let mean = |pixel: usize, band: usize| {
        0.5 * references.iter().map(|image| f64::from(image.pixels()[pixel][band])).sum::<f64>()
    };
    let count = image.pixels().len();
    let typical = |band| (0..count).map(|pixel| mean(pixel, band)).sum::<f64>() / count as f64;
    let of_band = |band: usize| {
        let floor = 0.01 * typical(band);
        let of_pixel = |pixel: usize| {
            let [a, b] = [0, 1].map(|half: usize| {
                f64::from(image.pixels()[pixel][band]) - f64::from(references[half].pixels()[pixel][band])
            });
            a * b / (mean(pixel, band).powi(2) + floor * floor)
        };
        (0..count).map(of_pixel).sum::<f64>() / count as f64
    };
    (0..3).map(of_band).sum::<f64>() / 3.0
}

/// Pixels that agree by chance get no further rays, so a plain estimate is too low by a quarter.
#[test]
fn the_reported_error_of_independent_paths_is_the_error() {
    let scene = box_with_balls();
    let view = View::from_args("-vp 2 -1 1.5 -vd 0 1 -.2 -vh 70 -vv 60").unwrap();
    let renderer = |seed| Renderer::new(&scene).unwrap().ambient_bounces(2).ambient_accuracy(0.0).seed(seed);
    let references = [1000, 1001].map(|seed| renderer(seed).samples(4096).render(&view, 16, 12).unwrap());
    let (mut squared, mut reported) = (0.0, 0.0);
    for seed in 0..12 {
        let image = renderer(seed).error(0.1).render(&view, 16, 12).unwrap();
        squared += relative_squared_error(&image, &references) / 12.0;
        reported += image.report().error.unwrap().powi(2) / 12.0;
    }
    println!("{} of the picture, {} reported", squared.sqrt(), reported.sqrt());
    assert!(squared.sqrt() < 0.1, "{}", squared.sqrt());
    assert!((0.8..1.2).contains(&(squared / reported)), "{} of {}", squared.sqrt(), reported.sqrt());
}

/// Stops at once.
struct Stopped;

impl Progress for Stopped {
    fn report(&self, _done: u64, _total: u64) {}

    fn stops(&self) -> bool {
        true
    }
}

#[test]
fn rendering_can_be_stopped() {
    let scene = Scene::from_text(TABLE).unwrap();
    let view = View::from_args("-vp 0 -4 3 -vd 0 4 -3").unwrap();
    let mut renderer = Renderer::new(&scene).unwrap();
    let stopped = renderer.render_with_progress(&view, 16, 300, &Stopped).unwrap();
    assert!(stopped.is_none());
}

#[test]
fn filling_an_irradiance_cache_can_be_stopped_and_leaves_no_half_of_it() {
    let scene = Scene::from_text(format!("{TABLE} grey ring ceiling 0 0 8 0 0 5 0 0 -1 0 6")).unwrap();
    let rays: Vec<Ray> =
        (0..40).map(|x| Ray::new(DVec3::new(0.1 * f64::from(x) - 2.0, 0.3, 1.0), -DVec3::Z).unwrap()).collect();
    // With this accuracy the spacing of records does not depend on their number of rays.
    let renderer = || Renderer::new(&scene).unwrap().ambient_bounces(1).ambient_accuracy(0.1).ambient_divisions(64, 0);
    let values = |traced: Vec<radsight::Traced>| traced.into_iter().map(|traced| traced.value).collect::<Vec<_>>();
    // It is stopped while it is filled, since rays come after that.
    for asked in [1, 3, 20] {
        let mut stopped = renderer();
        let later = StopsLater(AtomicU32::new(asked));
        assert!(stopped.irradiance_cache_of(&rays, &later).unwrap().is_none());
        assert_eq!(values(stopped.trace(&rays).unwrap()), values(renderer().trace(&rays).unwrap()), "{asked}");
    }
}

/// Stops after this number of calls.
struct StopsLater(AtomicU32);

impl Progress for StopsLater {
    fn report(&self, _done: u64, _total: u64) {}

    fn stops(&self) -> bool {
        self.0.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).is_err()
    }
}

#[test]
fn a_preview_is_interpolated_and_an_error_is_not() {
    let mut options = radsight::RenderOptions::default();
    assert!(matches!(ErrorBudget::default().apply(&mut options), SamplingBudget::Interpolated(_)));
    assert!(matches!(ErrorBudget::samples(4).apply(&mut options), SamplingBudget::Samples(4)));
}

#[test]
fn a_saved_irradiance_cache_gives_the_same_picture() {
    let text = format!("{TABLE} grey ring ceiling 0 0 8 0 0 5 0 0 -1 0 6");
    let scene = Scene::from_text(text.clone()).unwrap();
    let view = View::from_args("-vp 0 0 1 -vd .3 0 1 -vu 0 1 0 -vh 60 -vv 60").unwrap();
    // With this accuracy the spacing of records does not depend on their number of rays.
    let renderer = || Renderer::new(&scene).unwrap().ambient_bounces(1).ambient_accuracy(0.1).ambient_divisions(64, 0);
    let mut first = renderer();
    assert!(first.save_irradiance_cache().is_none(), "nothing is cached yet");
    let image = first.render(&view, 24, 24).unwrap();
    let cache = first.save_irradiance_cache().unwrap();
    let mut second = renderer().ambient_divisions(300, 0);
    assert!(second.load_irradiance_cache(cache.clone()).unwrap() > 0);
    let pixels = |image: &radsight::Image| (0..24 * 24).map(|at| image.pixel(at % 24, at / 24)).collect::<Vec<_>>();
    assert_eq!(pixels(&second.render(&view, 24, 24).unwrap()), pixels(&image));
    let alone = renderer().ambient_divisions(300, 0).render(&view, 24, 24).unwrap();
    assert_ne!(pixels(&alone), pixels(&image), "more rays make another picture");
    let more = Scene::from_text(format!("{text} grey sphere ball 0 0 4 0 0 1 .5")).unwrap();
    let other_scene = Renderer::new(&more).unwrap().ambient_bounces(1).load_irradiance_cache(cache.clone());
    assert!(matches!(other_scene, Err(Error::Cache(CacheError::OtherScene))), "{other_scene:?}");
    let other_options = renderer().ambient_bounces(2).load_irradiance_cache(cache);
    assert!(matches!(other_options, Err(Error::Cache(CacheError::OtherOptions { .. }))), "{other_options:?}");
}

#[test]
fn a_built_in_model_reflects_its_analytic_albedo() {
    // A dome of 1 W/(sr·m²): the radiance at an angle θ is the albedo, ρ cos^(k−1) θ.
    let text = "void glow sky 0 0 4 1 1 1 0  sky source dome 0 0 4 0 0 1 360
        void brdfplugin velvet 2 native minnaert 0 4 .5 .4 .3 3  velvet ring disk 0 0 8 0 0 0 0 0 1 0 1";
    let scene = Scene::from_text(text).unwrap();
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let ray = Ray::new(-2.0 * direction, direction).unwrap();
    let mut renderer = Renderer::new(&scene).unwrap().ambient_bounces(1).ambient_accuracy(0.0).samples(4096);
    let value = renderer.trace(&[ray]).unwrap()[0].value;
    for (value, reflectance) in value.iter().zip([0.5, 0.4, 0.3]) {
        let expected = reflectance * 0.64;
        assert!((value / expected - 1.0).abs() < 0.01, "{value} instead of {expected}");
    }
}

#[test]
fn a_wrong_number_of_a_built_in_model_is_reported_at_its_position() {
    let message =
        Scene::from_text("void brdfplugin velvet 2 native minaert 0 4 .5 .4 .3 3\nvelvet sphere s 0 0 4 0 0 0 1")
            .and_then(|scene| Renderer::new(&scene).map(|_| ()))
            .unwrap_err()
            .to_string();
    assert!(message.contains("1:33") && message.contains("did you mean \"minnaert\"?"), "{message}");
}
