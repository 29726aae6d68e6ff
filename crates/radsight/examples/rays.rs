//! Traces rays, and splits their radiance into the contributions of lights.

use glam::DVec3;
use radsight::{Error, Ray, Renderer, Scene};

pub(crate) fn main() -> Result<(), Error> {
    let scene = Scene::from_text(
        "void light left 0 0 3 10 10 10  void light right 0 0 3 30 30 30
         void plastic grey 0 0 5 .5 .5 .5 0 0
         left ring one 0 0 8 -2 0 3 0 0 -1 0 .3  right ring two 0 0 8 2 0 3 0 0 -1 0 .3
         grey ring table 0 0 8 0 0 0 0 0 1 0 5",
    )?;
    let rays: Vec<Ray> = (-2..=2).filter_map(|x| Ray::new(DVec3::new(f64::from(x), 0.0, 1.0), -DVec3::Z)).collect();
    let mut renderer = Renderer::new(&scene)?;
    let traced = renderer.trace(&rays)?;
    let contributions = renderer.contributions(&rays, &["left", "right"])?;
    for ((ray, traced), by_lamp) in rays.iter().zip(&traced).zip(&contributions) {
        let distance = traced.first_hit.map_or(f64::INFINITY, |hit| hit.distance);
        let [left, right] = [by_lamp[0].value[1], by_lamp[1].value[1]];
        println!(
            "x = {:+.0}: {:.4} W/(sr·m²) at distance {distance}, {left:.4} of it from the left and {right:.4} from the right",
            ray.origin.x, traced.value[1]
        );
    }
    Ok(())
}
