//! Shadow rays and surfaces that are coincident with a light or with each other.

mod build;

use build::{Builder, mean};
use glam::DVec3;
use radsight_ir::{ModifierHandle, Ring, Sphere};
use radsight_render::RenderOptions;

/// A square centred on the z axis with this height and half width, facing down.
fn downwards(height: f64, half: f64) -> [DVec3; 4] {
    [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(half * x, half * y, height))
}

/// The same facing up.
fn upwards(height: f64, half: f64) -> [DVec3; 4] {
    let mut corners = downwards(height, half);
    corners.reverse();
    corners
}

/// Other surfaces next to the light, so that a shadow ray traverses a hierarchy and not only a
/// short list; or none.
#[derive(Clone, Copy, Debug)]
enum Company {
    None,
    Crowd,
}

/// Number of spheres in a crowd.
const CROWD: u32 = 40;

/// Radiance of a floor under a lamp at height 3, with further surfaces.
fn floor_under_lamp(company: Company, add: impl FnOnce(&mut Builder)) -> f64 {
    let mut scene = Builder::default();
    let floor = scene.plastic([0.5; 3], 0.0, 0.0);
    scene.polygon(floor, &upwards(0.0, 5.0));
    if let Company::Crowd = company {
        for ball in 0..CROWD {
            let center = DVec3::new(f64::from(ball % 8) - 4.0, 4.5, 0.2 + 0.3 * f64::from(ball / 8));
            scene.sphere(floor, Sphere { center, radius: 0.1, facing: Default::default() });
        }
    }
    add(&mut scene);
    mean(&scene, RenderOptions::default(), DVec3::new(0.2, 0.1, 1.0), -DVec3::Z, 64)
}

fn lamp(scene: &mut Builder) {
    let light = scene.light([10.0; 3]);
    scene.polygon(light, &downwards(3.0, 0.5));
}

fn close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 0.02 * expected.abs() + 1e-9, "{what}: {found} instead of {expected}");
}

const COMPANIES: [Company; 2] = [Company::None, Company::Crowd];

/// Within Radiance's 1e-6: on the light, in front of it, behind it.
const HEIGHTS: [f64; 4] = [3.0, 3.0 - 5e-7, 3.0 + 5e-7, 3.0 - 1e-9];

/// Where a modifier is defined: before the light's or after it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Order {
    Earlier,
    Later,
}

/// The lamp's light with a surface on it: its modifier and its polygon.
fn with_overlay(
    company: Company,
    order: Order,
    corners: [DVec3; 4],
    cover: impl Fn(&mut Builder) -> ModifierHandle,
) -> f64 {
    floor_under_lamp(company, |scene| {
        let early = (order == Order::Earlier).then(|| cover(scene));
        let light = scene.light([10.0; 3]);
        let cover = early.unwrap_or_else(|| cover(scene));
        // The order of the surfaces does not matter.
        scene.polygon(cover, &corners);
        scene.polygon(light, &downwards(3.0, 0.5));
    })
}

#[test]
fn what_is_opaque_and_defined_later_hides_the_light_that_it_lies_on() {
    for company in COMPANIES {
        for height in HEIGHTS {
            let plastic = |scene: &mut Builder| scene.plastic([0.1; 3], 0.0, 0.0);
            assert_eq!(
                with_overlay(company, Order::Later, downwards(height, 2.0), plastic),
                0.0,
                "{company:?} {height}"
            );
        }
    }
}

#[test]
fn what_is_defined_earlier_or_shows_its_back_or_is_transparent_does_not() {
    let plastic = |scene: &mut Builder| scene.plastic([0.1; 3], 0.0, 0.0);
    let glass = |scene: &mut Builder| scene.glass([0.5; 3], 1.52);
    for company in COMPANIES {
        let bare = floor_under_lamp(company, lamp);
        assert!(bare > 0.05);
        for height in HEIGHTS {
            let what = format!("{company:?} {height}");
            close(with_overlay(company, Order::Earlier, downwards(height, 2.0), plastic), bare, &what);
            close(with_overlay(company, Order::Later, upwards(height, 2.0), plastic), bare, &what);
            close(with_overlay(company, Order::Later, downwards(height, 2.0), glass), bare, &what);
        }
    }
}

#[test]
fn what_is_in_front_of_the_light_by_more_than_the_tolerance_hides_it() {
    let plastic = |scene: &mut Builder| scene.plastic([0.1; 3], 0.0, 0.0);
    for company in COMPANIES {
        for order in [Order::Earlier, Order::Later] {
            assert_eq!(with_overlay(company, order, downwards(3.0 - 1e-5, 2.0), plastic), 0.0);
            assert!(with_overlay(company, order, downwards(3.0 + 1e-5, 2.0), plastic) > 0.05);
        }
    }
}

#[test]
fn half_a_cover_hides_half_the_light() {
    let bare = floor_under_lamp(Company::None, lamp);
    let half = floor_under_lamp(Company::None, |scene| {
        lamp(scene);
        let plastic = scene.plastic([0.1; 3], 0.0, 0.0);
        let corners = downwards(3.0, 2.0).map(|corner| DVec3::new(corner.x.max(0.0), corner.y, corner.z));
        scene.polygon(plastic, &corners);
    });
    assert!((0.4..0.6).contains(&(half / bare)), "{half} of {bare}");
}

#[test]
fn a_ball_that_lies_on_a_ball_of_light_hides_it() {
    let ball = |radius| Sphere { center: DVec3::new(0.0, 0.0, 3.0), radius, facing: Default::default() };
    for (radius, is_hidden) in [(0.5, true), (0.5 - 1e-4, false), (0.5 + 1e-4, true)] {
        let lit = floor_under_lamp(Company::None, |scene| {
            let light = scene.light([10.0; 3]);
            let plastic = scene.plastic([0.1; 3], 0.0, 0.0);
            scene.sphere(light, ball(0.5));
            scene.sphere(plastic, ball(radius));
        });
        assert_eq!(lit == 0.0, is_hidden, "{radius}: {lit}");
    }
}

#[test]
fn panes_that_lie_on_each_other_dim_once() {
    for company in COMPANIES {
        let with_panes = |heights: &[f64]| {
            floor_under_lamp(company, |scene| {
                lamp(scene);
                for height in heights {
                    let glass = scene.glass([0.5; 3], 1.52);
                    scene.polygon(glass, &downwards(*height, 4.0));
                }
            })
        };
        let one = with_panes(&[2.0]);
        for second in [2.0, 2.0 + 5e-7, 2.0 - 5e-7] {
            close(with_panes(&[2.0, second]), one, &format!("{company:?} {second}"));
        }
        assert!(with_panes(&[2.0, 2.001]) < 0.6 * one);
    }
}

#[test]
fn the_wrong_side_of_two_that_lie_on_each_other_casts_no_shadow_on_the_right_one() {
    // The later one, slightly farther away, is hit; the other is then in front of it.
    let bare = floor_under_lamp(Company::None, lamp);
    for lift in [0.0, 5e-7] {
        let covered = floor_under_lamp(Company::None, |scene| {
            lamp(scene);
            let light = scene.plastic([0.5; 3], 0.0, 0.0);
            let floor = scene.plastic([0.5; 3], 0.0, 0.0);
            scene.polygon(light, &upwards(0.5 + lift, 4.0));
            let ring = Ring { center: DVec3::Z * 0.5, normal: DVec3::Z, inner_radius: 0.0, outer_radius: 4.0 };
            scene.ring(floor, ring);
        });
        assert!(covered > bare, "{lift}: {covered}");
    }
}
