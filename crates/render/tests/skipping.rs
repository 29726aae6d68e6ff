//! Skipping work changes no bit of any value.

mod build;

use build::Builder;
use glam::DVec3;
use radsight_ir::{Facing, Ring, Sphere};
use radsight_render::{Ray, RenderOptions, Skip, Skipping};

/// A grey room with lights, some of which face away, and shapes that cast shadows.
fn room() -> Builder {
    let mut scene = Builder::default();
    let plastic = scene.plastic([0.5; 3], 0.1, 0.05);
    let metal = scene.metal([0.7; 3], 0.9, 0.1);
    let light = scene.light([9.0; 3]);
    let floor = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let wall = |y: f64, z: f64| DVec3::new(3.0, y, z);
    scene.polygon(plastic, &[floor(-5.0, -5.0), floor(5.0, -5.0), floor(5.0, 5.0), floor(-5.0, 5.0)]);
    scene.polygon(plastic, &[wall(-5.0, 0.0), wall(-5.0, 3.0), wall(5.0, 3.0), wall(5.0, 0.0)]);
    for k in 0..5 {
        let center = DVec3::new(f64::from(k) - 2.0, 0.3, 2.0);
        let normal = if k == 3 { DVec3::Z } else { -DVec3::Z };
        scene.ring(light, Ring { center, normal, inner_radius: 0.0, outer_radius: 0.2 });
    }
    scene.sphere(metal, Sphere { center: DVec3::new(0.5, 0.0, 1.0), radius: 0.4, facing: Facing::Outward });
    scene.sphere(plastic, Sphere { center: DVec3::new(-1.5, 0.4, 0.6), radius: 0.3, facing: Facing::Outward });
    scene
}

/// The bits of the values of rays from one side of the room, with two diffuse bounces.
fn bits(skipping: Skipping) -> Vec<u64> {
    let options = RenderOptions { skipping, ambient_bounces: 2, ..RenderOptions::default() };
    let rays: Vec<Ray> = (0..400)
        .filter_map(|k| {
            let (column, row) = (f64::from(k % 20), f64::from(k / 20));
            Ray::new(DVec3::new(-2.0, -3.5, 1.5), DVec3::new(0.1 * column - 0.4, 1.0, 0.06 * row - 0.9))
        })
        .collect();
    let traced = build::traced(&room(), options, &rays);
    traced.iter().map(|traced| traced.value[0].to_bits()).collect()
}

#[test]
fn every_skip_by_itself_and_all_together_keep_the_bits() {
    let all = bits(Skipping::ALLOWED);
    assert!(all.iter().filter(|bits| f64::from_bits(**bits) > 0.0).count() > 300, "the room is lit");
    for skip in Skip::ALL {
        let different = bits(Skipping::ALLOWED.without(skip)).iter().zip(&all).filter(|(a, b)| a != b).count();
        assert_eq!(different, 0, "{} of {} rays without the skip of {}", different, all.len(), skip.words());
    }
    assert!(bits(Skipping::FORBIDDEN) == all, "without any skip");
}

#[test]
fn the_room_is_one_where_every_skip_is_made() {
    let plan = build::plan(&room(), RenderOptions::default());
    for skip in Skip::ALL {
        assert!(plan.decisions().iter().any(|decision| decision.skip == Some(skip)), "{}", skip.words());
        let options = RenderOptions { skipping: Skipping::ALLOWED.without(skip), ..RenderOptions::default() };
        let decisions = build::plan(&room(), options);
        assert!(decisions.decisions().iter().all(|decision| decision.skip != Some(skip)), "{}", skip.words());
    }
}
