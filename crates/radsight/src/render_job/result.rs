//! The result of a job.

use super::{RenderJob, Tile};
use crate::error::Error;
use radsight_picture::{FileFormat, Header, Image as Values, read_image, write_image};

/// The line of a header that holds a job as JSON.
const JOB: &str = "RENDERJOB";

/// The line of a header with the size of the whole picture.
const SIZE: &str = "WHOLESIZE";

/// The pixels of a rectangle, or the values of a range of rays, with their errors.
///
/// ```
/// use radsight::{JobResult, JobTarget, RenderJob, Renderer, Scene, View};
/// let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")?;
/// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
/// let result = Renderer::new(&scene)?.run_job(&RenderJob::new(JobTarget::picture(&view, 8, 8), 2))?;
/// assert_eq!((result.values.len(), result.tile()?.pixels()), (3 * 64, 64));
/// assert_eq!(JobResult::from_bytes("part.mtx", &result.to_bytes()?)?, result);
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct JobResult {
    /// The job, with its part.
    pub job: RenderJob,
    /// Columns and rows of the whole picture; rays are one row.
    pub size: [usize; 2],
    /// 3 for radiances in red, green and blue, W/(sr·m²); 1 for exposures, J/m².
    pub components: usize,
    /// The components of each pixel, top row first.
    pub values: Vec<f32>,
    /// Estimated standard errors of the values, in their unit; NaN with one sample.
    pub standard_errors: Vec<f32>,
}

impl JobResult {
    pub(super) fn new(job: &RenderJob, size: [usize; 2], tile: &Tile, components: usize) -> JobResult {
        let numbers = tile.pixels() * components;
        let (values, standard_errors) = (Vec::with_capacity(numbers), Vec::with_capacity(numbers));
        JobResult { job: job.for_tile(tile, size), size, components, values, standard_errors }
    }

    pub(super) fn push(&mut self, values: &[f64], half_differences: &[f64]) {
        self.values.extend(values.iter().map(|value| *value as f32));
        self.standard_errors.extend(half_differences.iter().map(|half| half.abs() as f32));
    }

    /// The existing pixels.
    ///
    /// # Errors
    /// [`Error::Option`] where the fields contradict each other.
    pub fn tile(&self) -> Result<Tile, Error> {
        self.job.tile_of(self.size)
    }

    /// The bytes of a file: a Radiance float matrix, each pixel its values and then its standard
    /// errors, with the job in its header.
    ///
    /// # Errors
    /// [`Error::Part`] and [`Error::Option`] where the fields contradict each other.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        let bad = |reason: String| Error::Part { name: "<result>".to_owned(), reason };
        let pixels = self.values.chunks(self.components).zip(self.standard_errors.chunks(self.components));
        let data = pixels.flat_map(|(values, errors)| values.iter().chain(errors).copied()).collect();
        let tile = self.tile()?;
        let image = Values::new(tile.columns.len(), tile.rows.len(), 2 * self.components, data);
        let mut header = Header::new("RADIANCE");
        header.push_variable("SOFTWARE", concat!(" radsight ", env!("CARGO_PKG_VERSION")));
        header.push_variable(JOB, &format!(" {}", serde_json::to_string(&self.job).expect("text and numbers")));
        header.push_variable(SIZE, &format!(" {} {}", self.size[0], self.size[1]));
        let image = image.map_err(|error| bad(error.to_string()))?;
        write_image(FileFormat::Matrix, &header, &image).map_err(|error| bad(error.to_string()))
    }

    /// Reads the bytes of [`JobResult::to_bytes`]; `name` is their name in messages.
    ///
    /// # Errors
    /// [`Error::Part`] for other bytes.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<JobResult, Error> {
        let bad = |reason: String| Error::Part { name: name.to_owned(), reason };
        let read = read_image(bytes).map_err(|error| bad(error.to_string()))?;
        let header = read.header.unwrap_or_default();
        let json = header.variable(JOB).ok_or_else(|| bad(format!("its header has no line {JOB}=")))?;
        let job = RenderJob::from_json(name, json.trim().as_bytes())?;
        let size: Option<Vec<usize>> = header
            .variable(SIZE)
            .and_then(|size| size.split_whitespace().map(|number| number.parse().ok()).collect::<Option<_>>());
        let size = size.and_then(|size| <[usize; 2]>::try_from(size).ok());
        let size = size.ok_or_else(|| bad(format!("its header has no line {SIZE}= with columns and rows")))?;
        crate::Image::check_size(size[0], size[1])?;
        let tile = job.tile_of(size)?;
        let image = read.image;
        let expected = [tile.columns.len(), tile.rows.len()];
        if [image.width(), image.height()] != expected || ![2, 6].contains(&image.components()) {
            let found = format!("{} by {} pixels of {}", image.width(), image.height(), image.components());
            return Err(bad(format!("{found} numbers, expected {} by {} of 2 or 6", expected[0], expected[1])));
        }
        let components = image.components() / 2;
        let mut result = JobResult::new(&job, size, &tile, components);
        for pixel in image.pixels() {
            result.values.extend(&pixel[..components]);
            result.standard_errors.extend(&pixel[components..]);
        }
        Ok(result)
    }
}
