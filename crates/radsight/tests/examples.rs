//! Each example runs to its end.

#[path = "../examples/cameras.rs"]
mod cameras;
#[path = "../examples/capture_fig14.rs"]
mod capture_fig14;
#[path = "../examples/error_budget.rs"]
mod error_budget;
#[path = "../examples/minimal.rs"]
mod minimal;
#[path = "../examples/own_camera.rs"]
mod own_camera;
#[path = "../examples/own_integrator.rs"]
mod own_integrator;
#[path = "../examples/own_loader.rs"]
mod own_loader;
#[path = "../examples/own_material.rs"]
mod own_material;
#[path = "../examples/rays.rs"]
mod rays;

#[test]
fn minimal_renders_a_picture() {
    minimal::main().unwrap();
}

#[test]
fn capture_fig14_gives_grey_values() {
    capture_fig14::main().unwrap();
}

#[test]
fn rays_bring_radiance() {
    rays::main().unwrap();
}

#[test]
fn own_material_is_rendered() {
    own_material::main().unwrap();
}

#[test]
fn own_camera_sees() {
    own_camera::main().unwrap();
}

#[test]
fn own_integrator_sees_the_open_share_of_the_sky() {
    own_integrator::main().unwrap();
}

#[test]
fn error_budget_is_kept() {
    error_budget::main().unwrap();
}

#[test]
fn cameras_render_and_expose() {
    cameras::main().unwrap();
}

#[test]
fn own_loader_makes_files() {
    own_loader::main().unwrap();
}
