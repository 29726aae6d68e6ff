//! How the subpixels of a film are blurred to the picture.

use crate::cubic::cubic_weights;
use crate::disk_overlap::Parallelogram;
use glam::{DMat2, DVec2};

/// Subpixels along each side of a pixel. With four the error of a film is 16 times that of eight.
pub(crate) const SIDE: usize = 8;
pub(crate) const COUNT: usize = SIDE * SIDE;

/// Squared error of a film with subpixels, relative to that of one without: 1/1100 beside straight edges.
pub(crate) const SUBPIXEL_ERROR: f64 = 1.0 / 400.0;

/// Weights of the subpixels of a film.
#[derive(Debug)]
pub(crate) struct SubpixelKernels {
    /// By subpixel: offsets of pixels of the picture from the pixel of the film, and their weights.
    of_parts: Vec<Vec<([isize; 2], f64)>>,
    /// Of the pixels around a pixel of the picture, as they are interpolated.
    pub(crate) interpolated: Vec<f64>,
}

impl SubpixelKernels {
    /// For a shift by radius, in a kernel that reaches `margin` pixels to each side.
    pub(crate) fn new(shift: DVec2, margin: [usize; 2]) -> SubpixelKernels {
        let inverse = DMat2::from_diagonal(shift.recip());
        let on_pinhole = Parallelogram::new(inverse);
        let [reach_x, reach_y] = margin.map(|margin| margin as isize);
        let of_part = |part: usize| {
            let corner = DVec2::new((part % SIDE) as f64, (part / SIDE) as f64) / SIDE as f64 - 0.5;
            let offsets = (-reach_y..=reach_y).flat_map(|y| (-reach_x..=reach_x).map(move |x| [x, y]));
            let weighted = |[x, y]: [isize; 2]| {
                // The mean over the subpixel by four points.
                let points = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
                let area = points.map(|point| {
                    let at = corner + DVec2::from(point) / SIDE as f64;
                    on_pinhole.overlap(inverse * (DVec2::new(x as f64, y as f64) - at)).area
                });
                ([x, y], 0.25 * area.iter().sum::<f64>())
            };
            offsets.map(weighted).filter(|(_, weight)| *weight > 0.0).collect()
        };
        let of_parts: Vec<Vec<_>> = (0..COUNT).map(of_part).collect();
        let interpolated = SubpixelKernels::interpolated(&of_parts, margin);
        SubpixelKernels { of_parts, interpolated }
    }

    fn interpolated(of_parts: &[Vec<([isize; 2], f64)>], margin: [usize; 2]) -> Vec<f64> {
        let [width, height] = margin.map(|margin| 2 * margin + 1);
        let mut kernel = vec![0.0; width * height];
        for (part, weights) in of_parts.iter().enumerate() {
            let offset = [part % SIDE, part / SIDE].map(|at| (at as f64 + 0.5) / SIDE as f64 - 0.5);
            let [columns, rows] = offset.map(cubic_weights);
            let first = offset.map(|at| at.floor() as isize - 1);
            for ([x, y], weight) in weights {
                for (down, by_row) in rows.into_iter().enumerate() {
                    for (right, by_column) in columns.into_iter().enumerate() {
                        // The pixel of the film as seen from that of the picture.
                        let at = [first[0] + right as isize - x, first[1] + down as isize - y];
                        let [x, y] = [0, 1].map(|axis| (at[axis] + margin[axis] as isize) as usize);
                        kernel[y * width + x] += by_row * by_column * weight / COUNT as f64;
                    }
                }
            }
        }
        kernel
    }

    /// Adds the light of the subpixels of a pixel, as fractions of a pixel.
    /// The picture is in the frame of the film, which has so many columns.
    pub(crate) fn add_blurred(&self, columns: usize, pixel: usize, light: &[f64; COUNT], picture: &mut [f64]) {
        let columns = columns as isize;
        for (light, weights) in light.iter().zip(&self.of_parts).filter(|(light, _)| **light != 0.0) {
            for ([x, y], weight) in weights {
                let index = pixel as isize + y * columns + x;
                if let Some(value) = usize::try_from(index).ok().and_then(|index| picture.get_mut(index)) {
                    *value += light * weight;
                }
            }
        }
    }
}
