//! Reads and writes any format, selected by file name or content.

use crate::{
    FloatMatrix, ForeignFormat, Header, Image, MatrixFormat, Picture, PictureError, read_npy, read_pfm, read_png,
    write_npy, write_pfm, write_png_grey16, write_png_rgb16,
};

/// The formats of images.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FileFormat {
    /// A Radiance picture (`.hdr`, `.pic`, `.hsr`): eight bits a component with a common exponent.
    Picture,
    /// A Radiance float matrix (`.mtx`), lossless.
    Matrix,
    /// A portable float map (`.pfm`), lossless.
    Pfm,
    /// A NumPy array (`.npy`), lossless.
    Npy,
    /// PNG with 16 bits (`.png`): 1.0 is 65535; values outside 0 to 1 are clamped.
    Png,
    /// TIFF in single precision (`.tif`, `.tiff`), lossless.
    #[cfg(feature = "tiff")]
    Tiff,
    /// OpenEXR in single precision (`.exr`), lossless.
    #[cfg(feature = "exr")]
    Exr,
}

/// An image of any format.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadImage {
    /// The format.
    pub format: FileFormat,
    /// The values. Radiance's formats have EXPOSURE and COLORCORR undone (an XYZE picture keeps CIE
    /// values); integers are scaled to 0 to 1.
    pub image: Image<f32>,
    /// The Radiance header, if the file has one.
    pub header: Option<Header>,
}

impl FileFormat {
    /// The format of a file name, by its extension, ignoring case.
    ///
    /// ```
    /// use radsight_picture::FileFormat;
    /// assert_eq!(FileFormat::from_name("out/E.PFM"), Some(FileFormat::Pfm));
    /// assert_eq!(FileFormat::from_name("pfm"), None);
    /// ```
    #[must_use]
    pub fn from_name(name: &str) -> Option<FileFormat> {
        let (_, extension) = name.rsplit(['/', '\\']).next()?.rsplit_once('.')?;
        match extension.to_ascii_lowercase().as_str() {
            "hdr" | "pic" | "hsr" | "rgbe" => Some(FileFormat::Picture),
            "mtx" => Some(FileFormat::Matrix),
            "pfm" => Some(FileFormat::Pfm),
            "npy" => Some(FileFormat::Npy),
            "png" => Some(FileFormat::Png),
            #[cfg(feature = "tiff")]
            "tif" | "tiff" => Some(FileFormat::Tiff),
            #[cfg(feature = "exr")]
            "exr" => Some(FileFormat::Exr),
            _ => None,
        }
    }

    /// The format of a file's first bytes. A file with a Radiance header is a matrix if it has
    /// `NCOLS=` or a matrix FORMAT, otherwise a picture.
    #[must_use]
    pub fn from_content(bytes: &[u8]) -> Option<FileFormat> {
        match ForeignFormat::from_content(bytes) {
            Some(ForeignFormat::Pfm) => Some(FileFormat::Pfm),
            Some(ForeignFormat::Npy) => Some(FileFormat::Npy),
            Some(ForeignFormat::Png) => Some(FileFormat::Png),
            #[cfg(feature = "tiff")]
            Some(ForeignFormat::Tiff) => Some(FileFormat::Tiff),
            #[cfg(feature = "exr")]
            Some(ForeignFormat::Exr) => Some(FileFormat::Exr),
            _ => {
                let (header, _) = Header::read(bytes).ok()?;
                let is_matrix_format = matches!(header.format().as_deref(), Some("ascii" | "float" | "double"));
                let is_matrix = is_matrix_format || header.variable("NCOLS").is_some();
                Some(if is_matrix { FileFormat::Matrix } else { FileFormat::Picture })
            }
        }
    }

    /// Whether single-precision values are preserved exactly.
    #[must_use]
    pub fn is_lossless(self) -> bool {
        !matches!(self, FileFormat::Picture | FileFormat::Png)
    }
}

/// Reads an image in any format, recognised by its content.
///
/// # Errors
/// When the content is of no known format or malformed.
pub fn read_image(bytes: &[u8]) -> Result<ReadImage, PictureError> {
    let Some(format) = FileFormat::from_content(bytes) else {
        // The error of the header parser is the most specific.
        Header::read(bytes)?;
        return Err(PictureError::Truncated { offset: bytes.len(), expected: "an image".into() });
    };
    let (image, header) = match format {
        FileFormat::Picture => {
            let picture = Picture::read(bytes)?;
            (picture.radiance()?, Some(picture.header().clone()))
        }
        FileFormat::Matrix => {
            let matrix = FloatMatrix::read(bytes)?;
            let scale = matrix.header.radiance_scale()?;
            let header = matrix.header.clone();
            let mut image = matrix.into_f32();
            if scale != [1.0; 3] {
                let components = image.components();
                let scale_of = |i: usize| if i % components == 2 { scale[2] } else { scale[(i % components).min(1)] };
                image.data_mut().iter_mut().enumerate().for_each(|(i, value)| *value *= scale_of(i));
            }
            (image, Some(header))
        }
        FileFormat::Pfm => (read_pfm(bytes)?, None),
        FileFormat::Npy => (read_npy(bytes)?, None),
        FileFormat::Png => {
            let png = read_png(bytes)?;
            let largest = if png.bits == 16 { 65535.0 } else { 255.0 };
            (png.values.map(|value| f32::from(value) / largest), png.header)
        }
        #[cfg(feature = "tiff")]
        FileFormat::Tiff => crate::read_tiff(bytes)?,
        #[cfg(feature = "exr")]
        FileFormat::Exr => crate::read_exr(bytes)?,
    };
    Ok(ReadImage { format, image, header })
}

/// Writes an image. The header is stored if the format supports it.
///
/// # Errors
/// [`PictureError::Shape`] if the format does not support this number of components.
pub fn write_image(format: FileFormat, header: &Header, image: &Image<f32>) -> Result<Vec<u8>, PictureError> {
    match format {
        FileFormat::Picture if image.components() > 3 => {
            let splits = header.wavelength_splits()?.unwrap_or(crate::Encoding::USUAL_SPLITS);
            Ok(Picture::from_spectra(header.clone(), image, splits)?.to_bytes())
        }
        FileFormat::Picture => Ok(Picture::from_rgb(header.clone(), image)?.to_bytes()),
        FileFormat::Matrix => Ok(FloatMatrix::write_f32(header, image, MatrixFormat::Float)),
        FileFormat::Pfm => write_pfm(image),
        FileFormat::Npy => Ok(write_npy(image)),
        FileFormat::Png => {
            let quantised = image.clone().map(|value| (value * 65535.0).round() as u16);
            if image.components() == 3 {
                write_png_rgb16(&quantised, Some(header))
            } else {
                write_png_grey16(&quantised, Some(header))
            }
        }
        #[cfg(feature = "tiff")]
        FileFormat::Tiff => crate::write_tiff(image, Some(header)),
        #[cfg(feature = "exr")]
        FileFormat::Exr => crate::write_exr(image, Some(header)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_is_known_by_its_content_and_keeps_its_values() {
        let names = ["a.hdr", "a.mtx", "a.pfm", "a.npy", "a.png", "a.tif", "a.exr"];
        for (name, components) in names.iter().flat_map(|name| [(name, 1), (name, 3)]) {
            let Some(format) = FileFormat::from_name(name) else { continue };
            let data = (0..6 * components).map(|i| i as f32 / 64.0).collect();
            let image = Image::new(3, 2, components, data).unwrap();
            let read = read_image(&write_image(format, &Header::new("RADIANCE"), &image).unwrap()).unwrap();
            assert_eq!(read.format, format, "{name}");
            if format.is_lossless() {
                assert_eq!(read.image, image, "{name}");
            } else {
                let stride = read.image.components() / components;
                let pairs = read.image.data().iter().step_by(stride).zip(image.data());
                assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 0.004), "{name}: {read:?}");
            }
        }
    }

    #[test]
    fn the_exposure_of_a_matrix_is_undone() {
        let image = Image::new(1, 1, 4, vec![2.0; 4]).unwrap();
        let mut header = Header::new("RADIANCE");
        header.push_variable("EXPOSURE", "2");
        header.push_variable("COLORCORR", " 1 2 4");
        let read = read_image(&write_image(FileFormat::Matrix, &header, &image).unwrap()).unwrap();
        assert_eq!(read.image.data(), [1.0, 0.5, 0.25, 0.5]);
    }

    #[test]
    fn what_is_no_image_is_an_error() {
        for bytes in [&b""[..], b"\0\0", b"hello", b"#?RADIANCE\n\nno resolution\n"] {
            assert!(read_image(bytes).is_err());
        }
    }
}
