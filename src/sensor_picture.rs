//! The sensor's response to a stored exposure, as PNG files.

use crate::failure::Failure;
use radsight_picture::{
    Header, Image, PictureError, write_png_grey8, write_png_grey16, write_png_rgb8, write_png_rgb16,
};
use radsight_report::GreyPicture;
use radsight_sensor::{Bayer, BitDepth, Demosaic, Sensor};

/// Writes an image with integer components, with a header.
type Writer<T> = fn(&Image<T>, Option<&Header>) -> Result<Vec<u8>, PictureError>;

/// The values that a sensor reads out.
pub(crate) struct SensorPicture {
    width: usize,
    height: usize,
    bits: BitDepth,
    greys: Vec<u16>,
}

impl SensorPicture {
    /// Reads out an exposure in J/m²; `seed` selects the noise.
    pub(crate) fn new(sensor: &Sensor, exposure: &Image<f32>, seed: u64) -> SensorPicture {
        let exposures: Vec<f64> = exposure.data().iter().map(|value| f64::from(*value)).collect();
        // The non-uniformity of rows and columns is that of this picture's.
        let sensor = sensor.clone().with_columns(exposure.width() as u32);
        let greys = sensor.greys(&exposures, seed);
        SensorPicture { width: exposure.width(), height: exposure.height(), bits: sensor.bits(), greys }
    }

    /// The grey picture.
    pub(crate) fn grey_png(&self, header: &Header) -> Result<Vec<u8>, Failure> {
        self.png(self.greys.clone(), 1, (write_png_grey8, write_png_grey16), header)
    }

    /// The grey values, for a report page.
    pub(crate) fn into_greys(self) -> Result<GreyPicture, Failure> {
        let values = Image::new(self.width, self.height, 1, self.greys);
        let values = values.map_err(|error| Failure::fault(error.to_string()))?;
        Ok(GreyPicture { values, largest: self.bits.largest() })
    }

    /// The demosaiced colour picture.
    pub(crate) fn color_png(&self, mosaic: Bayer, header: &Header) -> Result<Vec<u8>, Failure> {
        let colors = mosaic.demosaic(&self.greys, self.width, Demosaic::GradientCorrected, self.bits.largest());
        self.png(colors, 3, (write_png_rgb8, write_png_rgb16), header)
    }

    /// Encodes the picture with eight bits per component if they suffice.
    fn png(
        &self,
        values: Vec<u16>,
        components: usize,
        (write8, write16): (Writer<u8>, Writer<u16>),
        header: &Header,
    ) -> Result<Vec<u8>, Failure> {
        let written = if self.bits.bits() <= 8 {
            let values = values.into_iter().map(|value| value.min(255) as u8).collect();
            Image::new(self.width, self.height, components, values).and_then(|image| write8(&image, Some(header)))
        } else {
            Image::new(self.width, self.height, components, values).and_then(|image| write16(&image, Some(header)))
        };
        written.map_err(|error| Failure::fault(error.to_string()))
    }
}
