//! Points on lights about which a model is asked at once.

use glam::DVec3;
use radsight_light::LightSample;

/// The memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct ModelBatch {
    pub(crate) places: Vec<Place>,
    /// In the model's frame.
    pub(crate) incident: Vec<DVec3>,
    pub(crate) values: Vec<f64>,
    pub(crate) pdfs: Vec<f64>,
}

/// A place that was drawn on a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) light: usize,
    pub(crate) sample: LightSample,
    /// How many were drawn on it.
    pub(crate) of: u32,
}
