//! Images in memory.

use crate::PictureError;

/// A rectangle of pixels with one or more values each.
///
/// Row 0 is the top, column 0 the left, and components are interleaved: component `c` of pixel (x,
/// y) is `data[(y * width + x) * components + c]`. Width, height and components are at least 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<T = f32> {
    width: usize,
    height: usize,
    components: usize,
    data: Vec<T>,
}

impl<T> Image<T> {
    /// Wraps values in the order above.
    ///
    /// # Errors
    /// [`PictureError::Shape`] if a size is zero or `data` does not have `width * height *
    /// components` values.
    pub fn new(width: usize, height: usize, components: usize, data: Vec<T>) -> Result<Self, PictureError> {
        let count = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(components));
        if count != Some(data.len()) || data.is_empty() {
            let expected = "at least one pixel and width * height * components values";
            return Err(PictureError::Shape { width, height, components, values: data.len(), expected });
        }
        Ok(Image { width, height, components, data })
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Values per pixel.
    #[must_use]
    pub fn components(&self) -> usize {
        self.components
    }

    /// All values.
    #[must_use]
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All values, mutable.
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// All values, by move.
    #[must_use]
    pub fn into_data(self) -> Vec<T> {
        self.data
    }

    /// The values of the pixel in column `x`, row `y` from the top.
    ///
    /// # Panics
    /// If the pixel is out of range.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> &[T] {
        let start = self.start(x, y);
        &self.data[start..start + self.components]
    }

    /// The values of a pixel, mutable.
    ///
    /// # Panics
    /// If the pixel is out of range.
    pub fn pixel_mut(&mut self, x: usize, y: usize) -> &mut [T] {
        let start = self.start(x, y);
        &mut self.data[start..start + self.components]
    }

    fn start(&self, x: usize, y: usize) -> usize {
        assert!(x < self.width, "column {x} of {}", self.width);
        (y * self.width + x) * self.components
    }

    /// All values of the row `y` from the top.
    ///
    /// # Panics
    /// If the row is out of range.
    #[must_use]
    pub fn row(&self, y: usize) -> &[T] {
        let length = self.width * self.components;
        &self.data[y * length..(y + 1) * length]
    }

    /// The rows, starting at the top.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, T> {
        self.data.chunks_exact(self.width * self.components)
    }

    /// The pixels, row by row from the top left.
    pub fn pixels(&self) -> std::slice::ChunksExact<'_, T> {
        self.data.chunks_exact(self.components)
    }

    /// An image of the same shape with every value mapped.
    #[must_use]
    pub fn map<U>(self, change: impl FnMut(T) -> U) -> Image<U> {
        let data = self.data.into_iter().map(change).collect();
        Image { width: self.width, height: self.height, components: self.components, data }
    }
}

impl<T: Copy> Image<T> {
    /// An image with the same value everywhere.
    ///
    /// # Errors
    /// [`PictureError::Shape`] if a size is zero or the product overflows.
    pub fn filled(width: usize, height: usize, components: usize, value: T) -> Result<Self, PictureError> {
        let count = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(components));
        Image::new(width, height, components, vec![value; count.unwrap_or(0)])
    }

    /// Mirrors the image vertically.
    pub fn flip_vertically(&mut self) {
        let length = self.width * self.components;
        for y in 0..self.height / 2 {
            let (above, below) = self.data.split_at_mut((self.height - 1 - y) * length);
            above[y * length..(y + 1) * length].swap_with_slice(&mut below[..length]);
        }
    }

    /// One component of every pixel.
    ///
    /// # Panics
    /// If the component is out of range.
    #[must_use]
    pub fn component(&self, component: usize) -> Image<T> {
        assert!(component < self.components, "component {component} of {}", self.components);
        let data = self.pixels().map(|pixel| pixel[component]).collect();
        Image { width: self.width, height: self.height, components: 1, data }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_that_overflows_is_refused() {
        assert!(Image::filled(usize::MAX, 2, 3, 0f32).is_err());
        assert!(Image::filled(0, 2, 3, 0f32).is_err());
        assert!(Image::new(2, 2, 1, vec![0u8; 3]).is_err());
    }

    #[test]
    fn flipping_swaps_top_and_bottom() {
        let mut image = Image::new(2, 3, 1, vec![1, 2, 3, 4, 5, 6]).unwrap();
        image.flip_vertically();
        assert_eq!(image.data(), [5, 6, 3, 4, 1, 2]);
        assert_eq!(image.pixel(1, 0), [6]);
    }
}
