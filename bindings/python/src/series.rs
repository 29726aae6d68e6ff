//! Series of captures of nearly one scene.

use crate::capture::{Capture, CapturedImage};
use crate::errors::{RadsightError, exception};
use crate::scene::{Scene, scene_builder};
use crate::supervise::{Watch, stopped, supervised};
use pyo3::prelude::*;
use radsight::{PartMove, Progress};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// One picture of a series: a camera, and where the parts of the scene are in it.
///
/// Parameters
/// ----------
/// capture : Capture
///     The camera.
/// moves : dict of str to str, optional
///     Moved parts: the name of their surfaces (a final ``*`` matches any ending), and the rotations and translations in the notation of ``xform``.
/// name : str
///     Name of the picture in tables.
///
/// Raises
/// ------
/// RadsightError
///     If a move is not a rotation or translation.
///
/// Examples
/// --------
/// >>> import radsight
/// >>> camera = radsight.Capture.from_text('''[camera]
/// ... position_m = [0, 0, 0.5]
/// ... direction = [0, 0, -1]
/// ... up = [0, 1, 0]
/// ... pixels = [24, 20]
/// ... pixel_pitch_um = [100, 100]
/// ... focal_distance_mm = 6.75
/// ... pinhole_diameter_mm = 0.1
/// ... exposure_ms = 10
/// ... ''', error=0.02)
/// >>> scene = radsight.Scene.from_text("void glow sky 0 0 4 1 1 1 0 sky source up 0 0 4 0 0 1 180 "
/// ...     "void mirror steel 0 0 3 .8 .8 .8 steel sphere ball 0 0 4 0 0 .01 .01")
/// >>> poses = [radsight.SeriesPicture(camera, {"ball": f"-t {x} 0 0"}) for x in (0, .03, .06)]
/// >>> images = radsight.CaptureSeries(scene).expose(poses)
/// >>> len(images), bool((images[0].exposure_j_per_m2 != images[2].exposure_j_per_m2).any())
/// (3, True)
#[pyclass(frozen, module = "radsight")]
pub(crate) struct SeriesPicture {
    /// Its name in tables.
    #[pyo3(get)]
    name: String,
    /// The camera.
    #[pyo3(get)]
    capture: Py<Capture>,
    /// Keys of the camera file that were replaced, with their values.
    #[pyo3(get)]
    keys: BTreeMap<String, String>,
    moves: Vec<PartMove>,
}

#[pymethods]
impl SeriesPicture {
    #[new]
    #[pyo3(signature = (capture, moves=BTreeMap::new(), name=String::new()))]
    fn new(capture: Py<Capture>, moves: BTreeMap<String, String>, name: String) -> PyResult<SeriesPicture> {
        let part = |(surfaces, words): (&String, &String)| {
            PartMove::new(surfaces, words)
                .map_err(|mistake| RadsightError::new_err(format!("the move \"{words}\" of {surfaces}: {mistake}")))
        };
        let moves = moves.iter().map(part).collect::<PyResult<_>>()?;
        Ok(SeriesPicture { name, capture, keys: BTreeMap::new(), moves })
    }

    fn __repr__(&self) -> String {
        format!("<radsight.SeriesPicture {:?}>", self.name)
    }
}

/// The pictures of a table's text.
///
/// Parameters
/// ----------
/// text : str
///     Comma-separated: the first line names columns, each other line is a picture. A column is ``name``, a key of the camera file such as
///     ``rig.ring_diameter_mm``, or ``move NAME`` with the transform of the surfaces of that name.
/// camera : Capture
///     Its keys are those that the table may replace.
/// name : str
///     For messages.
///
/// Returns
/// -------
/// list of SeriesPicture
///     In the order of the lines.
///
/// Raises
/// ------
/// SceneError
///     With line and caret of each mistake.
#[pyfunction]
#[pyo3(signature = (text, camera, *, name="<series>"))]
pub(crate) fn series_pictures(
    py: Python<'_>,
    text: &str,
    camera: Py<Capture>,
    name: &str,
) -> PyResult<Vec<SeriesPicture>> {
    let rows = radsight::read_series(name, text.as_bytes()).map_err(exception)?;
    let picture = |row: radsight::SeriesRow| {
        let keys: BTreeMap<String, String> = row.keys.into_iter().collect();
        let capture = match keys.is_empty() {
            true => camera.clone_ref(py),
            false => Py::new(py, camera.get().with_keys(keys.clone())?)?,
        };
        Ok(SeriesPicture { name: row.name, capture, keys, moves: row.moves })
    };
    rows.into_iter().map(picture).collect()
}

/// Captures of a scene that differ in camera, ring, exposure, sensor, or in where parts are. Work that pictures have in common is done once.
///
/// Parameters
/// ----------
/// scene : Scene
///     Without a light ring: each camera's own is added.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct CaptureSeries {
    scene: Py<Scene>,
}

#[pymethods]
impl CaptureSeries {
    #[new]
    fn new(scene: Py<Scene>) -> CaptureSeries {
        CaptureSeries { scene }
    }

    /// Expose all pictures, with the error, samples, options and threads of the first.
    ///
    /// Parameters
    /// ----------
    /// pictures : sequence of SeriesPicture
    ///     The pictures; they may differ in camera and moves.
    /// progress : callable, optional
    ///     Called with the finished fraction, 0 to 1.
    ///
    /// Returns
    /// -------
    /// list of CapturedImage
    ///     In the order of the pictures.
    #[pyo3(signature = (pictures, progress=None))]
    fn expose(
        &self,
        py: Python<'_>,
        pictures: Vec<Bound<'_, SeriesPicture>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Vec<CapturedImage>> {
        let scene = self.scene.get();
        let threads = scene.threads(pictures.first().and_then(|picture| picture.get().capture.get().threads));
        let pictures: Vec<radsight::SeriesPicture> = pictures.iter().map(|picture| of_library(picture.get())).collect();
        let (models, files) = (scene.models(py)?, scene.loader());
        let exposed = supervised(py, threads, progress, &scene.raised, |watch: &Watch| {
            let series = radsight::CaptureSeries::new(scene_builder(&scene.texts, files, models));
            let mut images: Vec<Option<CapturedImage>> = pictures.iter().map(|_| None).collect();
            let whole = WholeSeries { watch, done: AtomicUsize::new(0), pictures: pictures.len() };
            let mut begun = Instant::now();
            series.expose_with_progress(&pictures, &whole, |place, image| {
                let seconds = std::mem::replace(&mut begun, Instant::now()).elapsed().as_secs_f64();
                images[place] = Some(CapturedImage::new(image, pictures[place].capture.clone(), seconds));
                whole.done.fetch_add(1, Ordering::Relaxed);
            })?;
            Ok(images.into_iter().collect::<Option<Vec<_>>>())
        })?;
        exposed.map_err(exception)?.ok_or_else(stopped)
    }
}

fn of_library(picture: &SeriesPicture) -> radsight::SeriesPicture {
    radsight::SeriesPicture { capture: picture.capture.get().capture.clone(), moves: picture.moves.clone() }
}

/// How far all pictures are.
struct WholeSeries<'w> {
    watch: &'w Watch,
    done: AtomicUsize,
    pictures: usize,
}

impl Progress for WholeSeries<'_> {
    fn report(&self, done: u64, total: u64) {
        let of_picture = done as f64 / total.max(1) as f64;
        self.watch.set_done((self.done.load(Ordering::Relaxed) as f64 + of_picture) / self.pictures.max(1) as f64);
    }

    fn stops(&self) -> bool {
        self.watch.stops()
    }
}
