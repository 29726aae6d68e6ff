//! Cells of the sensor's plane around the picture, for light that is diffracted into it from
//! outside.
//!
//! The picture is the centre of a square of twice its size, and so on outwards, each square twice
//! as large as the last. The first ring is divided into cells of an eighth of the picture, each
//! further ring into cells of a quarter of the square within.

use crate::PinholeCamera;

/// Cells along a side of the picture, and along the inner side of each outer ring.
const NEAR_DIVISIONS: usize = 8;
const FAR_DIVISIONS: usize = 4;

/// Tangent of the angle to the axis beyond which cos⁴ is negligible.
const MAX_TANGENT: f64 = 30.0;

/// Maximum number of rings.
const MAX_RINGS: usize = 32;

/// A rectangle of the sensor's plane, in pixels from the picture's top left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) low: [f64; 2],
    pub(crate) size: [f64; 2],
}

impl Cell {
    pub(crate) fn area(&self) -> f64 {
        self.size[0] * self.size[1]
    }

    /// The centres of `divisions` equal parts in each direction.
    pub(crate) fn parts(&self, divisions: u32) -> impl Iterator<Item = [f64; 2]> {
        let Cell { low, size } = *self;
        let at = move |step: u32, axis: usize| low[axis] + size[axis] * (f64::from(step) + 0.5) / f64::from(divisions);
        (0..divisions * divisions).map(move |part| [at(part % divisions, 0), at(part / divisions, 1)])
    }
}

/// All the cells, from the inside out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Surround {
    cells: Vec<Cell>,
    /// The cell at each point of the first ring's grid.
    near: Vec<Option<usize>>,
    near_count: usize,
    picture: [f64; 2],
}

impl Surround {
    pub(crate) fn new(camera: &PinholeCamera) -> Surround {
        let picture = [f64::from(camera.columns()), f64::from(camera.rows())];
        let mut cells = Vec::new();
        let near = ring(picture, 1.0, NEAR_DIVISIONS, &mut cells);
        let near_count = cells.len();
        let half_m = 0.5 * (picture[0] * camera.pixel_pitch_m()[0]).min(picture[1] * camera.pixel_pitch_m()[1]);
        let widest = MAX_TANGENT * camera.focal_distance_m() / half_m;
        let scales = (1..MAX_RINGS).map(|power| 2f64.powi(power as i32)).take_while(|scale| *scale < widest);
        scales.for_each(|scale| {
            ring(picture, scale, FAR_DIVISIONS, &mut cells);
        });
        Surround { cells, near, near_count, picture }
    }

    pub(crate) fn count(&self) -> usize {
        self.cells.len()
    }

    pub(crate) fn cell(&self, index: usize) -> &Cell {
        &self.cells[index]
    }

    /// The mean over the first ring, whose cells have equal size.
    pub(crate) fn near_mean(&self, values: &[f64]) -> f64 {
        values.iter().take(self.near_count).sum::<f64>() / self.near_count as f64
    }

    /// The cell of the first ring that contains a point.
    pub(crate) fn cell_at(&self, place: [f64; 2]) -> Option<usize> {
        let across = 2 * NEAR_DIVISIONS;
        let step = |axis: usize| ((place[axis] / self.picture[axis] + 0.5) * NEAR_DIVISIONS as f64).floor();
        let inside = |step: f64| (0.0..across as f64).contains(&step);
        let (column, row) = (step(0), step(1));
        if inside(column) && inside(row) { self.near[row as usize * across + column as usize] } else { None }
    }

    /// The cells beyond the first ring, with their indices.
    pub(crate) fn far_cells(&self) -> impl Iterator<Item = (usize, &Cell)> {
        self.cells.iter().enumerate().skip(self.near_count)
    }
}

/// Appends the cells between a rectangle `scale` times as large as the picture and one twice as
/// large again; `divisions` along the inner side.
fn ring(picture: [f64; 2], scale: f64, divisions: usize, cells: &mut Vec<Cell>) -> Vec<Option<usize>> {
    let across = 2 * divisions;
    let size = picture.map(|side| side * scale / divisions as f64);
    let low = picture.map(|side| side * (0.5 - scale));
    let inner = divisions / 2..across - divisions / 2;
    let place = |index: usize| {
        let (column, row) = (index % across, index / across);
        if inner.contains(&column) && inner.contains(&row) {
            return None;
        }
        cells.push(Cell { low: [low[0] + column as f64 * size[0], low[1] + row as f64 * size[1]], size });
        Some(cells.len() - 1)
    };
    (0..across * across).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::tests::paper_camera;

    #[test]
    fn the_cells_tile_the_plane_around_the_picture() {
        let surround = Surround::new(&paper_camera());
        let area: f64 = (0..surround.count()).map(|index| surround.cell(index).area()).sum();
        let picture = 192.0 * 165.0;
        let far = surround.far_cells().count() / 48;
        let whole = picture * 4f64.powi(far as i32 + 1);
        assert!((area / (whole - picture) - 1.0).abs() < 1e-12, "{area} against {whole}");
        let found = surround.cell_at([-3.0, 20.0]).map(|index| *surround.cell(index)).unwrap();
        assert!(found.low[0] <= -3.0 && found.low[0] + found.size[0] > -3.0);
        assert!(found.low[1] <= 20.0 && found.low[1] + found.size[1] > 20.0);
        assert_eq!((surround.cell_at([5.0, 5.0]), surround.cell_at([-97.0, 5.0])), (None, None));
    }
}
