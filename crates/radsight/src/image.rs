//! Images with their error estimates.

use crate::{Error, report_page};
use radsight_film::Estimate;
use radsight_picture::{FileFormat, Header, write_image};
use radsight_report::RunRecord;
use std::fmt;
use std::path::Path;

/// An image of radiances.
///
/// ```
/// use radsight::{Image, Renderer, Scene, View};
/// let scene = Scene::from_text("void glow white 0 0 4 1 2 3 0 white sphere ball 0 0 4 0 9 0 2")?;
/// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 20 -vv 20")?;
/// let image = Renderer::new(&scene)?.samples(4).render(&view, 8, 8)?;
/// assert_eq!((image.columns(), image.rows(), image.pixels().len()), (8, 8, 64));
/// assert_eq!(image.pixel(4, 4), [1.0, 2.0, 3.0]);
/// assert!(Image::check_size(Image::MOST_PIXELS, 2).is_err());
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Image {
    columns: usize,
    pixels: Vec<[f32; 3]>,
    header: Header,
    report: RenderReport,
    maps: Maps,
    record: RunRecord,
}

/// Per-pixel statistics.
#[derive(Clone, Debug, Default)]
pub(crate) struct Maps {
    pub(crate) relative_errors: Option<Vec<f32>>,
    pub(crate) samples: Option<Vec<u32>>,
}

impl Image {
    /// Largest number of pixels; they are held in memory until the image is finished.
    pub const MOST_PIXELS: usize = 1 << 27;

    /// Checks the size of an image.
    ///
    /// ```
    /// use radsight::Image;
    /// assert!(Image::check_size(640, 480).is_ok() && Image::check_size(0, 480).is_err());
    /// ```
    ///
    /// # Errors
    /// [`Error::Size`] for no pixels, and for more than [`Image::MOST_PIXELS`].
    pub fn check_size(columns: usize, rows: usize) -> Result<(), Error> {
        let pixels = columns.checked_mul(rows).filter(|pixels| (1..=Image::MOST_PIXELS).contains(pixels));
        pixels.map(drop).ok_or(Error::Size { columns, rows, most: Image::MOST_PIXELS })
    }

    pub(crate) fn new(columns: usize, pixels: Vec<[f32; 3]>, header: Header, report: RenderReport) -> Image {
        Image { columns, pixels, header, report, maps: Maps::default(), record: RunRecord::default() }
    }

    /// Adds per-pixel statistics and the record of the run.
    pub(crate) fn with_accounts(mut self, maps: Maps, mut record: RunRecord, asked: Option<f64>) -> Image {
        record.error = report_page::reached(self.report.error, self.report.uncertainty, asked);
        record.rays = maps.samples.as_ref().map(|samples| samples.iter().copied().map(u64::from).sum());
        (self.maps, self.record) = (maps, record);
        self
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.pixels.len() / self.columns.max(1)
    }

    /// Red, green and blue radiance of each pixel, W/(sr·m²), top row first.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(1).render(&view(), 8, 8)?;
    /// let brightest = image.pixels().iter().map(|pixel| pixel[1]).fold(0.0, f32::max);
    /// assert_eq!(brightest, 1.0);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The radiance of a pixel; row 0 is the top.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(1).render(&view(), 8, 8)?;
    /// assert_eq!(image.pixel(4, 4), [1.0; 3]);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Panics
    /// If the pixel is out of range.
    #[must_use]
    pub fn pixel(&self, column: usize, row: usize) -> [f32; 3] {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        self.pixels[row * self.columns + column]
    }

    /// The relative standard error of each pixel, rms over its bands, top row first. `None` without
    /// a requested error.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.error(0.1).render(&view(), 8, 8)?;
    /// let worst = image.relative_errors().unwrap().iter().copied().fold(0.0, f32::max);
    /// assert!(worst < 1.0);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn relative_errors(&self) -> Option<&[f32]> {
        self.maps.relative_errors.as_deref()
    }

    /// Number of rays of each pixel, top row first; `None` if pixels are interpolated.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(4).render(&view(), 8, 8)?;
    /// assert_eq!(image.samples().unwrap(), [4; 64]);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn samples(&self) -> Option<&[u32]> {
        self.maps.samples.as_deref()
    }

    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    pub(crate) fn record(&self) -> &RunRecord {
        &self.record
    }

    /// The error estimate.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.error(0.1).render(&view(), 8, 8)?;
    /// assert!(image.report().error.unwrap() <= 0.1);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn report(&self) -> &RenderReport {
        &self.report
    }

    /// Writes a file in the format of its extension: `.hdr .pic .exr .tif .tiff .pfm .npy .mtx
    /// .png`. A PNG is linear, with 16 bits: white is 1 W/(sr·m²), and brighter values are clamped.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(1).render(&view(), 8, 8)?;
    /// image.save(std::env::temp_dir().join("radsight-example.hdr"))?;
    /// assert!(image.save("picture.doc").is_err());
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Save`] for another extension, or a file that cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let failed = |reason: String| Error::Save { path: path.display().to_string(), reason };
        let Some(format) = FileFormat::from_name(&path.display().to_string()) else {
            return Err(failed("expected a name that ends with .hdr, .exr, .tif, .pfm, .npy, .mtx or .png".to_owned()));
        };
        let values = self.pixels.iter().flatten().copied().collect();
        let image = radsight_picture::Image::new(self.columns, self.rows(), 3, values);
        let bytes = image.and_then(|image| write_image(format, &self.header, &image));
        let bytes = bytes.map_err(|error| failed(error.to_string()))?;
        std::fs::write(path, bytes).map_err(|error| failed(error.to_string()))
    }
}

/// The error estimate of an image.
///
/// ```
/// use radsight::{Renderer, Scene, View};
/// let scene = Scene::from_text("void glow white 0 0 4 1 2 3 0 white sphere ball 0 0 4 0 9 0 2")?;
/// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 20 -vv 20")?;
/// let image = Renderer::new(&scene)?.error(0.1).render(&view, 16, 16)?;
/// let report = image.report();
/// assert!(report.error.is_some_and(|error| error <= 0.1) && !report.is_stopped);
/// println!("{report}");
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RenderReport {
    /// Estimated relative error of the pixels, rms over their bands. It includes pixel noise, and
    /// noise and interpolation bias of cached irradiance. `None` if it was not estimated.
    pub error: Option<f64>,
    /// Half-width of the 95 % confidence interval of the error.
    pub uncertainty: Option<f64>,
    /// Mean number of rays per pixel, if counted.
    pub rays_per_pixel: Option<f64>,
    /// Whether the limit of rays per pixel stopped the work before the requested error was reached.
    pub is_stopped: bool,
    /// Relative noise of cached irradiance as estimated by the cache, rms over the cache points,
    /// before pixels are corrected. `None` without a cache.
    pub cache_noise: Option<f64>,
    /// The work that the plan skipped, with reasons.
    pub skipped: Vec<String>,
}

impl RenderReport {
    pub(crate) fn new(estimate: Option<Estimate>, cache_noise: Option<f64>, skipped: Vec<String>) -> RenderReport {
        RenderReport {
            error: estimate.map(|estimate| estimate.error),
            uncertainty: estimate.map(|estimate| estimate.uncertainty),
            rays_per_pixel: estimate.map(|estimate| estimate.rays),
            is_stopped: estimate.is_some_and(|estimate| estimate.stopped.is_some()),
            cache_noise,
            skipped,
        }
    }
}

impl fmt::Display for RenderReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.error, self.uncertainty) {
            (Some(error), Some(uncertainty)) => writeln!(
                formatter,
                "pixels: {:.2} % ± {:.2} % error (95 %), {:.1} rays each",
                100.0 * error,
                100.0 * uncertainty,
                self.rays_per_pixel.unwrap_or(0.0)
            )?,
            _ => writeln!(formatter, "pixels: error not estimated")?,
        }
        if self.is_stopped {
            writeln!(formatter, "stopped by the limit of rays per pixel")?;
        }
        if let Some(noise) = self.cache_noise {
            let corrected =
                if self.error.is_some() { "pixels are corrected" } else { "interpolation bias is not estimated" };
            writeln!(formatter, "irradiance cache: {:.2} % noise; {corrected}", 100.0 * noise)?;
        }
        self.skipped.iter().try_for_each(|skipped| writeln!(formatter, "skipped: {skipped}"))
    }
}

/// Encodes a PNG file with 8 bits per component: red, green and blue of each pixel, top row first.
/// `None` if their number does not match the columns. For images already mapped to a display.
///
/// ```
/// let png = radsight::png_rgb8(2, vec![0; 2 * 3]).unwrap(); // one row of two black pixels
/// assert_eq!(&png[1..4], b"PNG");
/// assert!(radsight::png_rgb8(2, vec![0; 7]).is_none());
/// ```
#[must_use]
pub fn png_rgb8(columns: usize, values: Vec<u8>) -> Option<Vec<u8>> {
    let rows = values.len().checked_div(columns.checked_mul(3)?)?;
    let image = radsight_picture::Image::new(columns, rows, 3, values).ok()?;
    radsight_picture::write_png_rgb8(&image, None).ok()
}
