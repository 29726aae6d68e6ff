//! The paper's Fig. 14: a steel washer on retroreflective sheeting under a ring of LEDs, as grey
//! values of the camera.

use radsight::{Capture, Error, Scene};

pub(crate) fn main() -> Result<(), Error> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../radiance-scenes/gripps");
    let capture = Capture::load(format!("{folder}/fig14.toml"))?.samples(4);
    let parts = ["sheet-retro.rad", "washer.rad"].map(|name| format!("{folder}/{name}"));
    let scene = capture.with_ring(Scene::builder().files(parts)?).build()?;
    let image = capture.expose(&scene)?;
    let greys = image.greys(&capture)?;
    println!("{} × {} pixels, {:.3e} J/m² in the mean", image.columns, image.rows, image.mean_exposure());
    println!("the brightest grey value is {}", greys.iter().max().unwrap_or(&0));
    Ok(())
}
