//! The content of a camera file, as [`Capture::camera_file`](crate::Capture::camera_file) returns it.
//!
//! ```
//! use radsight::camera_file::{CameraFile, PinholeModel, Sensor};
//! let capture = radsight::example::capture();
//! let file: &CameraFile = capture.camera_file();
//! assert_eq!(file.camera.exposure_s(), 0.01);
//! assert!(matches!(&file.sensor, Some(Sensor::PowerLaw(_))));
//! # let _ = PinholeModel::Finite;
//! ```

pub use radsight_camera::{
    Alignment, CameraFile, Flicker, FlickeringLamp, LedAlignment, LedEmission, Rig, Shutter, Waveform,
};
pub use radsight_pinhole::{BandWeights, PinholeCamera, PinholeModel, TelecentricLens, ThinLens};
pub use radsight_sensor::{Bayer, BitDepth, Emva1288, PowerLaw, Sensor};
