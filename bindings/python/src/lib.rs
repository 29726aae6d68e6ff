//! Python bindings: the library's types with NumPy arrays in and out, errors as exceptions, and the interpreter lock released while
//! rays are traced.

#![deny(unsafe_code)]

mod array_argument;
mod array_view;
mod batcher;
mod camera;
mod capture;
mod derivatives;
mod errors;
mod image;
mod job;
mod material;
mod png;
mod renderer;
mod retro;
mod scene;
mod sensor;
mod series;
mod supervise;
mod traced;
mod whole_argument;

use pyo3::prelude::*;

#[pymodule]
fn _radsight(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("RadsightError", module.py().get_type::<errors::RadsightError>())?;
    module.add("SceneError", module.py().get_type::<errors::SceneError>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<scene::View>()?;
    module.add_class::<renderer::Renderer>()?;
    module.add_class::<traced::TracedRays>()?;
    module.add_class::<image::Image>()?;
    module.add_class::<capture::Capture>()?;
    module.add_class::<capture::CapturedImage>()?;
    module.add_class::<derivatives::CaptureDerivatives>()?;
    module.add_class::<derivatives::ExposureDerivatives>()?;
    module.add_class::<derivatives::FisherInformation>()?;
    module.add_class::<series::CaptureSeries>()?;
    module.add_class::<series::SeriesPicture>()?;
    module.add_function(wrap_pyfunction!(series::series_pictures, module)?)?;
    module.add_class::<sensor::Sensor>()?;
    module.add_class::<sensor::Calibration>()?;
    module.add_function(wrap_pyfunction!(sensor::calibrate, module)?)?;
    module.add_class::<job::RenderJob>()?;
    module.add_class::<job::JobResult>()?;
    module.add_class::<job::MergedJob>()?;
    module.add_function(wrap_pyfunction!(retro::models, module)?)?;
    module.add_function(wrap_pyfunction!(retro::coefficient, module)?)?;
    module.add_function(wrap_pyfunction!(retro::fit, module)?)
}
