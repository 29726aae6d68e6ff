//! Variables of functions, patterns, textures and their mixtures, against values calculated by
//! hand.

use glam::{DMat3, DVec3};
use radsight_accel::{InstanceData, Ray};
use radsight_cal::{Bindings, Definitions, Program, Root, Scope, Scratch};
use radsight_diag::SourceMap;
use radsight_ir::{FunctionCall, Rgb, Scene, Transform};
use radsight_texture::{
    Bands, Function, MixedSteps, Share, Step, SurfaceInteraction, TextureChain, luminance, shading_normal,
};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

fn function(expressions: &[&str], to_scene: Transform) -> Function {
    let mut sources = SourceMap::default();
    let roots: Vec<Root<'_>> = expressions
        .iter()
        .map(|text| {
            let source = sources.add("test", text.as_bytes().to_vec(), None);
            Root::Expression { text, span: sources.span(source, 0, text.len()) }
        })
        .collect();
    let definitions = Definitions::with_initial_library();
    let program = Program::compile(&definitions, &Scope::global(), &roots, &Bindings::of_ray()).expect("they compile");
    Function::new(&FunctionCall { program: Arc::new(program), to_scene, words: Vec::new(), numbers: Vec::new() })
}

/// A ray down a slope of 45° to a horizontal surface, of length 2 after 3 before.
fn interaction() -> SurfaceInteraction {
    let direction = DVec3::new(0.0, 1.0, -1.0).normalize();
    let ray = Ray { origin: DVec3::new(4.0, 0.0, 2.0_f64.sqrt()), direction };
    SurfaceInteraction::new(&ray, ray.at(2.0), DVec3::Z, 2.0, 5.0)
}

fn values(function: &Function, interaction: &SurfaceInteraction, count: usize) -> Vec<f64> {
    let mut values = vec![0.0; count];
    let view = function.view(interaction);
    function.program.eval_all(&[], &view, &mut Scratch::default(), &mut values).expect("they have values");
    values
}

fn agree(found: &[f64], expected: &[f64]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} and {expected:?}");
}

#[test]
fn a_functions_variables_are_those_of_radiance() {
    let seen = function(&["Dy", "Dz", "Nz", "Px", "Py", "T", "Ts", "Rdot", "S"], Transform::IDENTITY);
    let slope = 0.5_f64.sqrt();
    agree(&values(&seen, &interaction(), 9), &[slope, -slope, 1.0, 4.0, 2.0 * slope, 5.0, 2.0, slope, 1.0]);
}

#[test]
fn a_transformed_function_gets_the_ray_in_its_coordinates() {
    // Rotated by 90° about z and scaled by 2: the scene's y is the function's x, the scene's −x its
    // y.
    let to_scene =
        Transform { rotation: DMat3::from_rotation_z(FRAC_PI_2), scale: 2.0, translation: DVec3::new(1.0, 0.0, 0.0) };
    let seen = function(&["Dx", "Px", "Py", "Ts"], to_scene);
    let slope = 0.5_f64.sqrt();
    // The point (4, √2, 0) is 3 and √2 from the function's origin, in units of 2.
    agree(&values(&seen, &interaction(), 4), &[slope, slope, -1.5, 1.0]);
}

fn appearance(steps: Vec<Step>, interaction: &SurfaceInteraction) -> ([f64; 3], DVec3) {
    let chain = TextureChain { steps, ..TextureChain::default() };
    let appearance = chain.appearance::<3>(&Scene::default(), interaction, &mut Scratch::default());
    (appearance.color, appearance.perturbation)
}

#[test]
fn a_mixture_is_the_weighted_mean_of_its_parts() {
    let red = Step::Constant(Bands::Color(Rgb([1.0, 0.0, 0.5])));
    let dark = Step::Brightness(function(&["0.25"], Transform::IDENTITY));
    let bump = Step::Texture(function(&["0.1", "0", "0"], Transform::IDENTITY));
    let share = Share::Function(function(&["Px/16"], Transform::IDENTITY));
    let mixture = MixedSteps { share, foreground: vec![red, bump], background: vec![dark] };
    let (color, perturbation) = appearance(vec![Step::Mixture(Box::new(mixture))], &interaction());
    agree(&color, &[0.25 + 0.75 * 0.25, 0.75 * 0.25, 0.25 * 0.5 + 0.75 * 0.25]);
    agree(&perturbation.to_array(), &[0.025, 0.0, 0.0]);
}

#[test]
fn a_function_that_fails_changes_nothing() {
    let broken = Step::Brightness(function(&["log(Dx-1)"], Transform::IDENTITY));
    let (color, _) = appearance(vec![broken], &interaction());
    assert_eq!(color, [1.0; 3]);
}

#[test]
fn a_texture_turns_the_normal_but_never_away_from_the_viewer() {
    let interaction = interaction();
    for perturbation in [DVec3::new(0.0, 0.5, 0.0), DVec3::new(0.0, 5.0, 0.0), DVec3::new(3.0, 2.0, -0.5)] {
        let normal = shading_normal(&interaction, perturbation);
        assert!((normal.length() - 1.0).abs() < 1e-12);
        assert!(-normal.dot(interaction.direction) >= 0.0, "{normal}");
    }
    assert_eq!(shading_normal(&interaction, DVec3::ZERO), DVec3::Z);
}

#[test]
fn functions_get_the_coordinates_of_an_instance() {
    let mut interaction = interaction();
    let to_object = Transform { rotation: DMat3::IDENTITY, scale: 0.5, translation: DVec3::new(-2.0, 0.0, 0.0) };
    interaction.instance =
        Some(InstanceData { to_object: Some(to_object), uv: [0.25, 0.75], perturbation: DVec3::ZERO });
    let seen = function(&["Px", "Lu", "Lv"], Transform::IDENTITY);
    agree(&values(&seen, &interaction, 3), &[0.0, 0.25, 0.75]);
}

#[test]
fn white_has_the_luminance_one() {
    assert!((luminance(&[1.0; 3]) - 1.0).abs() < 1e-12);
    assert!((luminance(&[1.0; 36]) - 1.0).abs() < 1e-12);
}
