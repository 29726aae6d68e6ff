//! Scene text to pixels: `cargo run --release -p radsight --example minimal`.

use radsight::{Error, Renderer, Scene, View};

pub(crate) fn main() -> Result<(), Error> {
    let scene = Scene::load([concat!(env!("CARGO_MANIFEST_DIR"), "/../../radiance-scenes/gallery/materials.rad")])?;
    let view = View::from_args("-vp 0 -8 3.5 -vd 0 8 -2.6 -vh 40 -vv 30")?;
    let image = Renderer::new(&scene)?.ambient_bounces(1).error(0.05).render(&view, 160, 120)?;
    print!("{}", image.report());
    image.save(std::env::temp_dir().join("materials.exr"))
}
