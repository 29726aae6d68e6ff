//! The small scene, view and camera of the examples in the documentation.

use crate::{Capture, MemoryLoader, Scene, View};

/// A luminous ball of 1 W/(sr·m²) and a grey one, under a sky.
#[must_use]
pub fn scene() -> Scene {
    let text = "void glow white 0 0 4 1 1 1 0  white sphere ball 0 0 4 0 9 0 2
                void plastic grey 0 0 5 .5 .5 .5 0 0  grey sphere stone 0 0 4 2.7 9 0 .5
                void glow sky 0 0 4 .2 .2 .2 0  sky source dome 0 0 4 0 0 1 360";
    Scene::from_text(text).expect("the text is a scene")
}

/// Towards the ball, 40° wide.
#[must_use]
pub fn view() -> View {
    View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40").expect("the text is a view")
}

/// A camera file with a pinhole and 16 by 16 pixels that looks the same way.
pub const CAMERA: &[u8] = b"[camera]
position_m = [0.0, 0.0, 0.0]
direction = [0.0, 1.0, 0.0]
up = [0.0, 0.0, 1.0]
pixels = [16, 16]
pixel_pitch_um = [180.0, 180.0]
focal_distance_mm = 4.0
pinhole_diameter_mm = 0.1
exposure_ms = 10.0
[sensor]
response = \"power-law\"
k = 33844.0
gamma = 0.85
grey_background = 12
grey_max = 161
exposure_unit = \"uJ/cm2\"
bits = 8
";

/// Its capture, to an error of 5 %.
#[must_use]
pub fn capture() -> Capture {
    let capture = Capture::from_text("camera.toml", CAMERA, &MemoryLoader::default());
    capture.expect("the text is a camera file").error(0.05)
}
