//! `pcompos`: composes pictures side by side and on top of each other.

use crate::ToolError;
use crate::brightness::WEIGHTS;
use radsight_picture::{Header, PictureError, PictureReader, PictureWriter, Resolution, mantissa_step};
use std::io::{Read, Write};

/// One of the pictures.
#[derive(Debug)]
pub struct Layer<R> {
    /// The picture.
    pub reader: PictureReader<R>,
    /// Its lower left corner in the output, pixels.
    pub corner: [i64; 2],
    /// Only pixels brighter than this are shown.
    pub above: Option<f64>,
    /// Only pixels darker than this are shown.
    pub below: Option<f64>,
}

impl<R> Layer<R> {
    /// Width and height.
    pub fn size(&self) -> [i64; 2] {
        let resolution = self.reader.resolution();
        [resolution.scanline_length() as i64, resolution.scanlines() as i64]
    }

    /// Upper right corner.
    pub fn far_corner(&self) -> [i64; 2] {
        std::array::from_fn(|i| self.corner[i] + self.size()[i])
    }

    fn shows(&self, pixel: [u8; 4]) -> bool {
        if self.above.is_none() && self.below.is_none() {
            return true;
        }
        let brightness = brightness(pixel);
        self.above.is_none_or(|level| brightness > level) && self.below.is_none_or(|level| brightness < level)
    }
}

/// The brightness of a pixel from its mantissas as integers, without the half step that decoding
/// adds.
fn brightness(pixel: [u8; 4]) -> f64 {
    let weighted = |i: usize| u32::from(pixel[i]) * (WEIGHTS[i] * 256.0 + 0.5) as u32;
    let whole = (weighted(0) + weighted(1) + weighted(2)) >> 8;
    f64::from(whole) * f64::from(mantissa_step(pixel[3]))
}

/// Composes layers, the last one on top.
///
/// # Errors
/// When a picture cannot be read (the error holds its index), or the output cannot be written.
pub fn compose<R: Read, W: Write>(
    layers: &mut [Layer<R>],
    [columns, rows]: [usize; 2],
    background: [u8; 4],
    header: &Header,
    target: W,
) -> Result<(), ToolError> {
    if let Some(index) = layers.iter().position(|layer| layer.reader.components() != 3) {
        let what = format!("{} components", layers[index].reader.components());
        let error = PictureError::Unsupported { format: "a spectral picture", what, expected: "RGBE or XYZE" };
        return Err(ToolError::Input { index, error });
    }
    let mut writer = PictureWriter::new(target, header, 3, Resolution::standard(columns, rows))?;
    let top = layers.iter().map(|layer| layer.far_corner()[1]).fold(rows as i64, i64::max);
    let mut scanline = vec![background; columns];
    for y in (0..top).rev() {
        scanline.fill(background);
        for (index, layer) in layers.iter_mut().enumerate() {
            if y < layer.corner[1] || y >= layer.far_corner()[1] {
                continue;
            }
            layer.reader.read_stored().map_err(|error| ToolError::Input { index, error })?;
            if y < rows as i64 {
                put(layer, &mut scanline);
            }
        }
        if y < rows as i64 {
            writer.write_stored(scanline.as_flattened())?;
        }
    }
    Ok(writer.finish()?)
}

fn put<R>(layer: &Layer<R>, scanline: &mut [[u8; 4]]) {
    let pixels = layer.reader.stored().as_chunks::<4>().0;
    for (offset, pixel) in pixels.iter().enumerate() {
        let target = usize::try_from(layer.corner[0] + offset as i64).ok().and_then(|x| scanline.get_mut(x));
        if let Some(target) = target.filter(|_| layer.shows(*pixel)) {
            *target = *pixel;
        }
    }
}
