//! Scanlines as three values per pixel, with spectra as tristimulus values.

use radsight_picture::{Encoding, PictureError, PictureReader};
use radsight_spectrum::xyz_of_whole_bands;
use std::io::Read;

/// Red, green and blue of RGBE pixels, and X, Y and Z of XYZE pixels and of spectra. Those of
/// spectra have the unit of radiance.
pub(super) struct ThreeValues<R> {
    reader: PictureReader<R>,
    /// X, Y and Z of each band of a spectrum.
    of_bands: Option<Vec<[f64; 3]>>,
}

impl<R: Read> ThreeValues<R> {
    pub(super) fn new(reader: PictureReader<R>) -> ThreeValues<R> {
        let of_bands = match reader.encoding() {
            Encoding::Spectral { splits } if reader.components() > 3 => {
                let range = [splits[0], splits[3]].map(f64::from);
                Some(xyz_of_whole_bands(reader.components(), range).collect())
            }
            _ => None,
        };
        ThreeValues { reader, of_bands }
    }

    /// The picture that is read.
    pub(super) fn reader(&self) -> &PictureReader<R> {
        &self.reader
    }

    /// Whether the values are tristimulus values.
    pub(super) fn are_xyz(&self) -> bool {
        self.reader.encoding() == Encoding::Xyze || self.of_bands.is_some()
    }

    /// The next scanline.
    pub(super) fn read(&mut self, values: &mut [[f32; 3]]) -> Result<(), PictureError> {
        let Some(of_bands) = &self.of_bands else { return self.reader.read_three(values) };
        let mut spectra = vec![0.0f32; values.len() * of_bands.len()];
        self.reader.read_values(&mut spectra)?;
        for (value, spectrum) in values.iter_mut().zip(spectra.chunks_exact(of_bands.len())) {
            *value = xyz_of_spectrum(spectrum, of_bands);
        }
        Ok(())
    }
}

fn xyz_of_spectrum(spectrum: &[f32], of_bands: &[[f64; 3]]) -> [f32; 3] {
    let part = |i: usize| spectrum.iter().zip(of_bands).map(|(value, xyz)| f64::from(*value) * xyz[i]).sum::<f64>();
    [0, 1, 2].map(|i| part(i) as f32)
}
