//! The picture of a page, and maps of its size.

use crate::ReportError;
use radsight_picture::{Image, WHITE_EFFICACY};

/// Largest number of pixels stored in a page; enough for 4096 by 2304.
pub const MOST_PIXELS: usize = 10_000_000;

/// The physical quantity of a picture's values.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Quantity {
    /// Radiance, W/(sr·m²).
    Radiance,
    /// Irradiance, W/m².
    Irradiance,
    /// Exposure, J/m².
    Exposure,
    /// Another quantity.
    Other {
        /// Its name.
        name: String,
        /// Its unit; empty for none.
        unit: String,
    },
}

impl Quantity {
    pub(crate) fn name(&self) -> &str {
        match self {
            Quantity::Radiance => "radiance",
            Quantity::Irradiance => "irradiance",
            Quantity::Exposure => "exposure",
            Quantity::Other { name, .. } => name,
        }
    }

    pub(crate) fn unit(&self) -> &str {
        match self {
            Quantity::Radiance => "W/(sr·m²)",
            Quantity::Irradiance => "W/m²",
            Quantity::Exposure => "J/m²",
            Quantity::Other { unit, .. } => unit,
        }
    }

    /// Name, unit and factor of the weighted sum of red, green and blue.
    pub(crate) fn photometric(&self) -> (&str, &str, f64) {
        match self {
            Quantity::Radiance => ("luminance", "cd/m²", WHITE_EFFICACY),
            Quantity::Irradiance => ("illuminance", "lx", WHITE_EFFICACY),
            Quantity::Exposure => ("luminous exposure", "lx·s", WHITE_EFFICACY),
            Quantity::Other { name, unit } => (name, unit, 1.0),
        }
    }
}

/// The standard error of each pixel: one component.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ErrorMap {
    /// In the unit of the picture.
    Absolute(Image<f32>),
    /// Relative to the pixel's value; 0.01 is 1 %.
    Relative(Image<f32>),
}

impl ErrorMap {
    pub(crate) fn image(&self) -> &Image<f32> {
        match self {
            ErrorMap::Absolute(image) | ErrorMap::Relative(image) => image,
        }
    }
}

/// The sensor's output.
#[derive(Clone, Debug, PartialEq)]
pub struct GreyPicture {
    /// Grey values, one component.
    pub values: Image<u16>,
    /// The largest possible value, such as 255.
    pub largest: u16,
}

/// How the pixels of a square are reduced to one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pooling {
    /// Their mean.
    Mean,
    /// The standard error of their mean, assuming independent errors.
    StandardError,
}

/// The side in pixels of the squares over which pictures of this size are averaged; 1 for no
/// averaging.
pub(crate) fn square_side(columns: usize, rows: usize) -> usize {
    let fits = |side: &usize| columns.div_ceil(*side).saturating_mul(rows.div_ceil(*side)) <= MOST_PIXELS;
    (1..).find(fits).unwrap_or(usize::MAX)
}

/// An image reduced over squares; those at the right and lower edge may be smaller.
pub(crate) fn pooled(image: &Image<f32>, side: usize, pooling: Pooling) -> Image<f32> {
    if side <= 1 {
        return image.clone();
    }
    let (columns, rows, components) = (image.width().div_ceil(side), image.height().div_ceil(side), image.components());
    let mut data = Vec::with_capacity(columns * rows * components);
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let below = (row * side)..((row + 1) * side).min(image.height());
        let across = (column * side)..((column + 1) * side).min(image.width());
        let count = (below.len() * across.len()) as f64;
        for component in 0..components {
            let values = below.clone().flat_map(|y| across.clone().map(move |x| (x, y)));
            let values = values.map(|(x, y)| f64::from(image.pixel(x, y)[component]));
            data.push(match pooling {
                Pooling::Mean => values.sum::<f64>() / count,
                Pooling::StandardError => values.map(|value| value * value).sum::<f64>().sqrt() / count,
            } as f32);
        }
    }
    Image::new(columns, rows, components, data).expect("the data have this shape")
}

/// Checks that a map has the size of the picture.
pub(crate) fn check_size<T, U>(map: &'static str, image: &Image<T>, picture: &Image<U>) -> Result<(), ReportError> {
    let fits = (image.width(), image.height(), image.components()) == (picture.width(), picture.height(), 1);
    fits.then_some(()).ok_or(ReportError::Size {
        map,
        columns: image.width(),
        rows: image.height(),
        components: image.components(),
        expected_columns: picture.width(),
        expected_rows: picture.height(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_pictures_are_averaged_and_4k_is_not() {
        assert_eq!(square_side(4096, 2304), 1);
        let side = square_side(20_000, 5_000);
        assert!(20_000_usize.div_ceil(side) * 5_000_usize.div_ceil(side) <= MOST_PIXELS && side == 4, "{side}");
        let image = Image::new(3, 2, 1, vec![1.0, 3.0, 10.0, 5.0, 7.0, 20.0]).unwrap();
        assert_eq!(pooled(&image, 2, Pooling::Mean).data(), [4.0, 15.0]);
        let error = pooled(&image, 2, Pooling::StandardError);
        assert!((error.data()[0] - 84f32.sqrt() / 4.0).abs() < 1e-6, "{error:?}");
    }
}
