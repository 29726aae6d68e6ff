//! Wrong options, cameras, integrators and materials are errors that name what is wrong.

use glam::DVec3;
use radsight::options::LightDivision;
use radsight::{
    BrdfSample, Camera, CameraRay, Capture, Density, Error, ErrorBudget, ErrorTarget, Integrator, Interpolation, Lobes,
    Material, Ray, RayQueries, Renderer, SamplingBudget, Scene, View, example,
};
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

fn renderer() -> Renderer {
    Renderer::new(&example::scene()).unwrap()
}

fn message_of(result: Result<impl Sized, Error>) -> String {
    match result {
        Ok(_) => panic!("it is wrong"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_modifier_that_is_named_twice_has_its_contribution_twice() {
    let text = "void glow white 0 0 4 1 2 3 0 white sphere ball 0 0 4 0 9 0 2";
    let mut renderer = Renderer::new(&Scene::from_text(text).unwrap()).unwrap();
    let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
    let found = renderer.contributions(&[ahead], &["white", "sky", "white"]).unwrap().remove(0);
    let found: Vec<_> = found.iter().map(|found| (found.modifier, found.value)).collect();
    assert_eq!(found, [(0, [1.0, 2.0, 3.0]), (1, [0.0; 3]), (2, [1.0, 2.0, 3.0])]);
}

#[test]
fn pixel_jitter_is_a_share_of_a_pixel() {
    for side in [f64::NAN, f64::INFINITY, -0.5, 1.5] {
        let found = message_of(renderer().samples(1).pixel_jitter(side).render(&example::view(), 8, 8));
        let number = if side.is_nan() { "NaN".to_owned() } else { side.to_string() };
        assert_eq!(found, format!("pixel_jitter is {number}, expected a share of a pixel from 0 to 1"));
    }
}

#[test]
fn an_aperture_is_finite_and_not_negative_for_every_kind_of_picture() {
    for aperture in [f64::NAN, f64::INFINITY, -1.0] {
        let view = example::view().thin_lens(aperture);
        let found = [
            message_of(renderer().samples(1).render(&view, 8, 8)),
            message_of(renderer().samples(1).render_camera(&view, 8, 8)),
            message_of(example::capture().samples(1).with_camera(Arc::new(view)).expose(&example::scene())),
        ];
        let expected = format!("thin_lens is {aperture}, expected the diameter of an aperture, 0 or more");
        assert!(found.iter().all(|found| *found == expected), "{found:?}");
    }
}

#[test]
fn numbers_of_the_irradiance_cache_are_checked_before_any_ray() {
    for accuracy in [f64::NAN, f64::INFINITY, -1.0] {
        let mut renderer = renderer().ambient_bounces(1).ambient_accuracy(accuracy);
        let found = [
            message_of(renderer.render(&example::view(), 8, 8)),
            message_of(renderer.trace(&[])),
            message_of(renderer.render_camera(&example::view(), 8, 8)),
        ];
        let expected = format!("ambient_accuracy is {accuracy}, expected 0 or more");
        assert!(found.iter().all(|found| *found == expected), "{found:?}");
    }
    let mut renderer = renderer().ambient_bounces(1).ambient_divisions(u32::MAX, u32::MAX);
    let found = message_of(renderer.render(&example::view(), 8, 8));
    assert_eq!(found, "ambient_divisions is 4294967295, expected 0 to 1048576");
}

#[test]
fn every_caller_of_the_library_checks_render_options() {
    let mut renderer = renderer();
    renderer.options_mut().light_division = LightDivision::BySize(f64::NAN);
    assert!(message_of(renderer.contributions(&[], &[])).starts_with("light_division is NaN"));
    let mut capture = example::capture().samples(1);
    capture.options_mut().least_weight = f64::NAN;
    assert_eq!(message_of(capture.expose(&example::scene())), "least_weight is NaN, expected 0 or more");
    let options = radsight::RenderOptions { source_sampling: -0.2, ..Renderer::picture_options() };
    let found = message_of(Renderer::with_options(&example::scene(), options));
    assert_eq!(found, "source_sampling is -0.2, expected 0 or more");
}

#[test]
fn a_preview_has_a_spacing_and_a_contrast() {
    let cases = [
        (f64::NAN, 0.05, "preview spacing is NaN, expected 1 pixel or more"),
        (0.0, 0.05, "preview spacing is 0, expected 1 pixel or more"),
        (f64::INFINITY, 0.05, "preview spacing is inf, expected 1 pixel or more"),
        (4.0, f64::NAN, "preview contrast is NaN, expected 0 or more"),
        (4.0, -1.0, "preview contrast is -1, expected 0 or more"),
    ];
    for (spacing, contrast, expected) in cases {
        let budget = ErrorBudget::preview(Interpolation { spacing, contrast });
        assert_eq!(message_of(renderer().budget(budget).render(&example::view(), 8, 8)), expected);
    }
}

#[test]
fn fewer_rays_than_an_error_is_estimated_from_are_refused() {
    let expected = "expected 4 to 65536: the error is estimated from 4 rays per pixel";
    for most in 0..4 {
        let budget = ErrorBudget::error(0.1).at_most(most);
        let target = ErrorBudget::of(SamplingBudget::Error(ErrorTarget { error: 0.1, most_samples: most }));
        for budget in [budget, target] {
            let picture = message_of(renderer().budget(budget).render(&example::view(), 8, 8));
            let capture = message_of(example::capture().budget(budget).expose(&example::scene()));
            assert_eq!([picture, capture], [0, 1].map(|_| format!("most_samples is {most}, {expected}")));
        }
    }
    let budget = ErrorBudget::error(0.05).at_most(4);
    let image = renderer().budget(budget).render(&example::view(), 8, 8).unwrap();
    assert_eq!(image.samples().unwrap().iter().max(), Some(&4));
}

/// Looks along +y from the origin, with a weight; `rays` leaves rays out.
struct Ahead {
    direction: DVec3,
    weight: f64,
    left_out: usize,
}

impl Ahead {
    const WELL: Ahead = Ahead { direction: DVec3::Y, weight: 1.0, left_out: 0 };
}

impl Camera for Ahead {
    fn ray(&self, _film: [f64; 2], _aperture: [f64; 2]) -> Option<CameraRay> {
        Some(CameraRay { origin: DVec3::ZERO, direction: self.direction, weight: self.weight })
    }

    fn rays(&self, film: &[[f64; 2]], _aperture: &[[f64; 2]]) -> Vec<Option<CameraRay>> {
        film.iter().skip(self.left_out).map(|point| self.ray(*point, [0.5; 2])).collect()
    }
}

/// Pictures to an error, with samples, and with cached irradiance.
fn pictures(camera: &Ahead) -> [String; 3] {
    [renderer().error(0.1), renderer().samples(4), renderer().ambient_bounces(1)]
        .map(|mut renderer| message_of(renderer.render_camera(camera, 8, 8)))
}

#[test]
fn a_weight_of_a_camera_that_is_no_number_is_an_error() {
    for weight in [f64::NAN, f64::INFINITY] {
        let camera = Ahead { weight, ..Ahead::WELL };
        for found in pictures(&camera) {
            assert!(found.starts_with("the custom camera is wrong: its ray for the film point ("), "{found}");
            assert!(found.contains(&format!("the weight {weight}, expected finite numbers")), "{found}");
        }
        let exposed = example::capture().samples(4).with_camera(Arc::new(camera)).expose(&example::scene());
        assert!(message_of(exposed).contains(&format!("the weight {weight}, expected finite numbers")));
    }
}

#[test]
fn a_camera_ray_without_a_direction_is_an_error() {
    for direction in [DVec3::ZERO, DVec3::NAN] {
        let camera = Ahead { direction, ..Ahead::WELL };
        assert!(pictures(&camera).iter().all(|found| found.contains("a direction with a length, or no ray")));
        let capture: Capture = example::capture().error(0.1).with_camera(Arc::new(camera));
        let of_file = message_of(renderer().samples(1).render_camera(&capture.camera(), 8, 8));
        assert_eq!(message_of(capture.expose(&example::scene())).split(" (").next(), of_file.split(" (").next());
    }
}

#[test]
fn a_camera_that_leaves_rays_out_is_an_error() {
    let camera = Ahead { left_out: 1, ..Ahead::WELL };
    for found in pictures(&camera) {
        assert!(found.starts_with("the custom camera is wrong: it returned "), "{found}");
    }
}

struct Infinite;

impl Integrator for Infinite {
    fn radiance(&self, _queries: &mut RayQueries<'_, '_>, _ray: &Ray) -> [f64; 3] {
        [1.0, f64::NAN, f64::INFINITY]
    }
}

#[test]
fn an_integrator_that_gives_no_number_is_an_error() {
    for mut renderer in [renderer().error(0.1), renderer().samples(4)] {
        let found = message_of(renderer.render_with(&Infinite, &Ahead::WELL, 8, 8));
        assert_eq!(
            found,
            "the integrator is wrong: it gave (1, NaN, inf) for the ray from [0, 0, 0] along [0, 1, 0], expected finite numbers"
        );
    }
}

/// Even reflection whose numbers are replaced.
#[derive(Debug)]
struct Wrong {
    value: f64,
    density: f64,
    /// Length of sampled directions.
    length: f64,
}

impl Wrong {
    const NOTHING: Wrong = Wrong { value: 0.5 * FRAC_1_PI, density: FRAC_1_PI, length: 1.0 };
}

impl Material for Wrong {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, ..Lobes::default() }
    }

    fn eval_pdf(&self, _outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        values.fill(self.value);
        incident.iter().zip(pdfs).for_each(|(incident, pdf)| *pdf = self.density * incident.z.max(0.0));
    }

    fn sample(&self, _outgoing: DVec3, _u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        weights.fill(0.5);
        let incident = self.length * DVec3::new(0.6, 0.0, 0.8);
        Some(BrdfSample { incident, density: Density::Continuous(0.8 * self.density) })
    }
}

/// A picture of a ball of this material under a lamp and a sky.
fn ball(material: Wrong) -> Result<radsight::Image, Error> {
    let text = "void light lamp 0 0 3 9 9 9  lamp sphere bulb 0 0 4 0 0 6 .5
        void glow sky 0 0 4 1 1 1 0  sky source dome 0 0 4 0 0 1 360
        void plastic stone 0 0 5 .5 .5 .5 0 0  stone sphere ball 0 0 4 0 5 0 2";
    let scene = Scene::builder().text("ball.rad", text).material("stone", Arc::new(material)).build()?;
    let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
    Renderer::new(&scene)?.ambient_bounces(1).ambient_accuracy(0.0).samples(4).render(&view, 8, 8)
}

#[test]
fn a_wrong_number_of_a_material_is_an_error_at_the_material() {
    let wrong = |value: f64| Wrong { value, ..Wrong::NOTHING };
    for (material, expected) in [
        (wrong(f64::NAN), "the value NaN, expected a finite number of 0 or more"),
        (wrong(f64::INFINITY), "the value inf, expected a finite number of 0 or more"),
        (wrong(-0.1), "the value -0.1, expected a finite number of 0 or more"),
        (Wrong { density: -1.0, ..Wrong::NOTHING }, "the density "),
        (Wrong { length: 2.0, ..Wrong::NOTHING }, "the sampled direction below, expected a unit vector"),
    ] {
        let found = message_of(ball(material));
        assert!(found.contains("ball.rad:3:9: error: material \"stone\" gave ") && found.contains(expected), "{found}");
    }
}

#[test]
fn a_rounding_error_of_a_material_below_zero_is_zero() {
    let image = ball(Wrong { value: -1e-17, ..Wrong::NOTHING }).unwrap();
    assert!(image.pixels().iter().flatten().all(|band| *band >= 0.0));
    assert!(ball(Wrong::NOTHING).is_ok());
}

#[test]
fn an_empty_scene_is_one_mistake() {
    let Err(Error::Scene(report)) = Scene::from_text("") else { panic!("it is empty") };
    assert_eq!(report.diagnostics.len(), 1, "{report}");
}

#[test]
fn a_cache_without_records_has_no_negative_noise() {
    let scene = Scene::from_text("void glow sky 0 0 4 1 1 1 0  sky source dome 0 0 4 0 0 1 360").unwrap();
    let image = Renderer::new(&scene).unwrap().ambient_bounces(1).render(&example::view(), 8, 8).unwrap();
    let report = image.report().to_string();
    assert!(report.contains("irradiance cache: 0.00 % noise"), "{report}");
}

#[test]
fn huge_arguments_do_not_overflow() {
    let rays = [Ray::new(DVec3::ZERO, DVec3::Y).unwrap(); 3];
    let value = |traced: radsight::Traced| traced.value;
    let traced = renderer().trace_part(u64::MAX, &rays, value, &radsight::Silent).unwrap().unwrap();
    assert_eq!(traced, [[1.0; 3]; 3]);
    let found = renderer().contributions_part(u64::MAX, &rays, &["white"], &radsight::Silent).unwrap().unwrap();
    assert!(found.iter().all(|found| found[0].value == [1.0; 3]));
    assert!(radsight::png_rgb8(usize::MAX, vec![0; 3]).is_none());
    for size in [[usize::MAX, usize::MAX], [usize::MAX, 1], [0, 8]] {
        assert!(matches!(renderer().render_camera(&example::view(), size[0], size[1]), Err(Error::Size { .. })));
    }
}
