//! Foveal samples: the picture reduced to pixels of one degree, the size of the fovea.

use crate::ToolError;
use crate::filter::{FilterOptions, Size, filter_one_pass};
use radsight_picture::{Header, PictureReader, Resolution, View, ViewKind, ViewOptions};
use std::f64::consts::PI;
use std::io::Read;

/// The diameter of the fovea, in radians.
const DIAMETER: f64 = PI / 180.0;
/// Largest number of foveal samples.
const MOST: usize = 1 << 22;

/// The picture in pixels of one degree, in file order.
#[derive(Debug)]
pub(super) struct Fovea {
    /// Size of the input.
    pub(super) picture: Resolution,
    /// Size of this picture.
    pub(super) resolution: Resolution,
    pub(super) colors: Vec<[f32; 3]>,
    view: View,
}

impl Fovea {
    pub(super) fn new<R: Read>(
        reader: PictureReader<R>,
        picture: Resolution,
        header: &Header,
    ) -> Result<Fovea, ToolError> {
        let view = view(header, &picture)?;
        let samples = |size: f64| (size / DIAMETER + 0.5).clamp(2.0, 1e9) as usize;
        let (across, up) = (samples(view.size().x), samples(view.size().y));
        if across.saturating_mul(up) > MOST {
            return Err(ToolError::ViewTooWide { degrees: across.saturating_mul(up), most: MOST });
        }
        let resolution = Resolution { width: across, height: up, orientation: picture.orientation };
        let options = FilterOptions {
            columns: Size::Pixels(resolution.scanline_length()),
            rows: Size::Pixels(resolution.scanlines()),
            ..FilterOptions::default()
        };
        let mut filtered = Vec::new();
        filter_one_pass(reader, &options, &["pfilt"], &mut filtered)?;
        let mut filtered = PictureReader::new(&filtered[..])?;
        let mut colors = vec![[0.0; 3]; across * up];
        for scanline in colors.chunks_exact_mut(resolution.scanline_length()) {
            filtered.read_three(scanline)?;
        }
        Ok(Fovea { picture, resolution, colors, view })
    }

    pub(super) fn columns(&self) -> usize {
        self.resolution.scanline_length()
    }

    pub(super) fn rows(&self) -> usize {
        self.resolution.scanlines()
    }

    /// Unit direction of each foveal sample; zero outside the view.
    pub(super) fn directions(&self) -> Vec<[f32; 3]> {
        let place = |i: usize| self.resolution.location(i % self.columns(), i / self.columns());
        let direction = |i: usize| self.view.ray(place(i)).map_or([0.0; 3], |ray| ray.direction.to_array());
        (0..self.colors.len()).map(|i| direction(i).map(|part| part as f32)).collect()
    }

    /// Input pixels per degree, the mean of both axes.
    pub(super) fn pixels_a_degree(&self) -> f64 {
        let size = self.view.size();
        (self.picture.width as f64 / size.x + self.picture.height as f64 / size.y) / 2.0 * DIAMETER
    }
}

/// The view of a picture. The default is 40 degrees, for headers without a usable view.
fn view(header: &Header, picture: &Resolution) -> Result<View, ToolError> {
    /// Narrower views, in degrees, are not used.
    const NARROWEST: f64 = 5.0;
    const USUAL: f64 = 40.0;
    let named = ViewOptions::from_header(header).map_err(ToolError::View)?;
    let stated = named
        .filter(|view| view.kind != ViewKind::Parallel && view.horizontal > NARROWEST && view.vertical > NARROWEST);
    let options = match stated {
        Some(view) => view,
        None => {
            let height = header.pixel_aspect()? * picture.height as f64 / picture.width as f64;
            let other = |part: f64| 2.0 * ((USUAL / 2.0).to_radians().tan() * part).atan().to_degrees();
            let (horizontal, vertical) =
                if height < 1.0 { (USUAL, other(height)) } else { (other(1.0 / height), USUAL) };
            ViewOptions { horizontal, vertical, ..ViewOptions::default() }
        }
    };
    View::new(options).map_err(ToolError::View)
}
