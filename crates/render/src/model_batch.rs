//! A batch of light samples for one evaluation of a reflectance model.

use glam::DVec3;
use radsight_light::LightSample;

/// The memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct ModelBatch {
    pub(crate) samples: Vec<BatchSample>,
    /// In the model's frame.
    pub(crate) incident: Vec<DVec3>,
    pub(crate) values: Vec<f64>,
    pub(crate) pdfs: Vec<f64>,
}

/// A sampled point of a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BatchSample {
    pub(crate) light: usize,
    pub(crate) sample: LightSample,
    /// Number of samples of this light.
    pub(crate) of: u32,
}
