//! Python bindings: the library's types with NumPy arrays in and out, errors as exceptions, and the interpreter lock released while
//! rays are traced.

mod capture;
mod errors;
mod png;
mod renderer;
mod scene;

use pyo3::prelude::*;

#[pymodule]
fn _radsight(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("RadsightError", module.py().get_type::<errors::RadsightError>())?;
    module.add("SceneError", module.py().get_type::<errors::SceneError>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<scene::View>()?;
    module.add_class::<renderer::Renderer>()?;
    module.add_class::<renderer::TracedRays>()?;
    module.add_class::<renderer::Image>()?;
    module.add_class::<capture::Capture>()?;
    module.add_class::<capture::CapturedImage>()
}

/// Runs work without the interpreter lock, on so many threads where that is said.
fn run<T: Send>(py: Python<'_>, threads: Option<usize>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    match threads {
        None => Ok(py.detach(work)),
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.map_err(|error| errors::RadsightError::new_err(error.to_string()))?;
            Ok(py.detach(|| pool.install(work)))
        }
    }
}
