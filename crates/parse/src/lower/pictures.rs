//! Pictures as patterns.

use super::modifiers::RawWord;
use super::reader::Reader;
use radsight_diag::Diagnostic;
use radsight_ir::{Axis, DataGrid, Handle, PictureData};
use radsight_loader::{FileKind, Loader};
use radsight_picture::{Encoding, Image, Picture};

impl Reader<'_> {
    /// A picture in red, green and blue, loaded at its first use. `None` after a mistake, which was
    /// reported.
    pub(super) fn picture(&mut self, file: &RawWord) -> Option<Handle<PictureData>> {
        if let Some(known) = self.pictures.get(&file.text) {
            return *known;
        }
        let picture = self.load_picture(file).and_then(|picture| match picture.encoding() {
            Encoding::Rgbe => {
                let pixels = picture.triples().expect("RGBE has three components");
                let (width, height) = (picture.width(), picture.height());
                let extent = extent(&picture)?;
                let data = PictureData { file: file.text.clone(), width, height, extent, pixels };
                Ok(self.scene.pictures.add(data))
            }
            other => Err(format!("\"{}\" is a picture in {}, expected red, green and blue", file.text, other.name())),
        });
        let handle = self.report_error(picture, file);
        self.pictures.insert(file.text.clone(), handle);
        handle
    }

    /// A hyperspectral picture as a table of v, u and wavelength, loaded at its first use.
    pub(super) fn spectral_picture(&mut self, file: &RawWord) -> Option<Handle<DataGrid>> {
        if let Some(known) = self.grids.get(&file.text) {
            return *known;
        }
        let grid = self.load_picture(file).and_then(|picture| match picture.encoding() {
            Encoding::Spectral { splits: [longest, .., shortest] } => {
                let bands = picture.components();
                let half_band = 0.5 * f64::from(shortest - longest) / bands as f64;
                let [u, v] = extent(&picture)?;
                let axis = |first, last, count| Axis::Regular { first, last, count };
                let axes = vec![
                    axis(0.0, v, picture.height()),
                    axis(0.0, u, picture.width()),
                    axis(f64::from(longest) + half_band, f64::from(shortest) - half_band, bands),
                ];
                let values = from_the_bottom(&picture.values());
                Ok(self.scene.grids.add(DataGrid { file: file.text.clone(), axes, values }))
            }
            other => Err(format!("\"{}\" is a picture in {}, expected spectra", file.text, other.name())),
        });
        let handle = self.report_error(grid, file);
        self.grids.insert(file.text.clone(), handle);
        handle
    }

    fn load_picture(&self, file: &RawWord) -> Result<Picture, String> {
        let loaded = self.loader.load(&file.text, FileKind::Picture).map_err(|error| error.to_string())?;
        Picture::read(&loaded.bytes).map_err(|error| format!("\"{}\": {error}", loaded.path))
    }

    fn report_error<T>(&mut self, result: Result<T, String>, file: &RawWord) -> Option<T> {
        result.map_err(|message| self.log.push(Diagnostic::error(message).at(file.span))).ok()
    }
}

/// The coordinates u and v of the last column and the top row. The shorter side, measured with the
/// pixel aspect, is 1.
fn extent(picture: &Picture) -> Result<[f64; 2], String> {
    let aspect = picture.header().pixel_aspect().map_err(|error| error.to_string())?;
    if !(aspect.is_finite() && aspect > 0.0) {
        return Err(format!("the pixel aspect is {aspect}, expected a number above zero"));
    }
    let (width, height) = (picture.width() as f64, picture.height() as f64);
    Ok(if width <= height * aspect { [1.0, aspect * height / width] } else { [width / height / aspect, 1.0] })
}

fn from_the_bottom(image: &Image<f32>) -> Vec<f32> {
    image.rows().rev().flatten().copied().collect()
}
