//! The light of images and the rest add up to the radiance of a ray.

mod build;

use build::Builder;
use glam::DVec3;
use radsight_ir::{Facing, Ring, Sphere};
use radsight_render::{CountedLight, Ray, RenderOptions, Renderer};

/// A floor under a lamp and a mirrored ball.
fn scene() -> Builder {
    let mut scene = Builder::default();
    let (light, mirror, floor) = (scene.light([50.0; 3]), scene.mirror([0.8; 3]), scene.plastic([0.5; 3], 0.0, 0.0));
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    scene.polygon(floor, &[corner(-3.0, -3.0), corner(3.0, -3.0), corner(3.0, 3.0), corner(-3.0, 3.0)]);
    scene.sphere(mirror, Sphere { center: DVec3::new(0.0, 0.0, 0.5), radius: 0.5, facing: Facing::Outward });
    let normal = DVec3::new(0.0, 0.0, -1.0);
    scene.ring(light, Ring { center: DVec3::new(0.3, 0.0, 3.0), normal, inner_radius: 0.0, outer_radius: 0.9 });
    scene
}

#[test]
fn images_and_the_rest_add_up_to_the_radiance() {
    let renderer = Renderer::new(build::plan(&scene(), RenderOptions::default()));
    let mut worker = renderer.worker();
    let origin = DVec3::new(0.0, -1.0, 2.5);
    let (mut with_images, mut with_both) = (0, 0);
    for index in 0..4000_u32 {
        let at = DVec3::new(f64::from(index % 63) / 31.0 - 1.0, f64::from(index / 63) / 31.0 - 1.0, 0.5);
        let ray = Ray::new(origin, at - origin).expect("a direction");
        let [all, rest, images] =
            [CountedLight::All, CountedLight::WithoutImages, CountedLight::Images].map(|counted| {
                worker.count(counted);
                worker.trace(u64::from(index), &ray).value[0]
            });
        assert_eq!(all, rest + images, "ray {index}");
        with_images += u32::from(images > 0.0);
        with_both += u32::from(rest > 0.0);
    }
    assert!(with_images > 5 && with_both > 500, "{with_images} rays show the lamp, {with_both} others show light");
}

#[test]
fn a_light_that_is_seen_directly_is_no_image() {
    let renderer = Renderer::new(build::plan(&scene(), RenderOptions::default()));
    let mut worker = renderer.worker();
    let ray = Ray::new(DVec3::new(0.3, 0.0, 1.5), DVec3::Z).expect("a direction");
    worker.count(CountedLight::WithoutImages);
    assert_eq!(worker.trace(0, &ray).value, [50.0; 3]);
    worker.count(CountedLight::Images);
    assert_eq!(worker.trace(0, &ray).value, [0.0; 3]);
}
