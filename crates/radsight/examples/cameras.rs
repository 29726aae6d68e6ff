//! One scene through several cameras: a thin lens and a fisheye as pictures, and both as exposures
//! of the same sensor.

use radsight::{Camera, Capture, Error, MemoryLoader, Renderer, Scene, View};
use std::sync::Arc;

const CAMERA: &[u8] = b"[camera]
position_m = [0.0, 0.0, 1.2]
direction = [0.0, 1.0, 0.0]
up = [0.0, 0.0, 1.0]
pixels = [24, 24]
pixel_pitch_um = [80.0, 80.0]
lens_focal_length_mm = 4.0
f_number = 2.0
exposure_ms = 10.0
";

pub(crate) fn main() -> Result<(), Error> {
    let scene = Scene::load([concat!(env!("CARGO_MANIFEST_DIR"), "/../../radiance-scenes/gallery/daylight.rad")])?;
    let lens = View::from_args("-vtv -vp 1 1 1.5 -vd 1 1 -.1 -vh 40 -vv 40")?.thin_lens(0.05);
    let fisheye = View::from_args("-vta -vp 1 1 1.5 -vd 1 1 -.1 -vh 160 -vv 160")?;
    let cameras: [(&str, Arc<dyn Camera + Send + Sync>); 2] =
        [("lens", Arc::new(lens)), ("fisheye", Arc::new(fisheye))];
    let mut renderer = Renderer::new(&scene)?.error(0.2);
    let capture = Capture::from_text("camera.toml", CAMERA, &MemoryLoader::default())?.error(0.1);
    for (name, camera) in cameras {
        let image = renderer.render_camera(camera.as_ref(), 24, 24)?;
        let exposed = capture.clone().with_camera(camera).expose(&scene)?;
        print!("{name}: {:.2e} J/m² in the mean; {}", exposed.mean_exposure(), image.report());
        image.save(std::env::temp_dir().join(format!("radsight-{name}.hdr")))?;
    }
    Ok(())
}
