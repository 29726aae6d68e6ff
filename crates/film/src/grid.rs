//! Grids of sampled pixels, their cells, and the numbers of their rays.

/// Column and row of a pixel.
pub(crate) type Pixel = (usize, usize);

/// Every grid has its own random numbers along a Z-order curve, so that those of neighbouring
/// samples are stratified together.
const TILE_LOG2: u32 = 6;
pub(crate) const INDEX_LOG2: u32 = 16;

/// A square of pixels with a sampled pixel at each corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) left: usize,
    pub(crate) top: usize,
    pub(crate) right: usize,
    pub(crate) bottom: usize,
}

impl Cell {
    pub(crate) fn corners(&self) -> [(usize, usize); 4] {
        [(self.left, self.top), (self.right, self.top), (self.left, self.bottom), (self.right, self.bottom)]
    }

    /// The weights of the corners in bilinear interpolation at a pixel.
    pub(crate) fn shares(&self, (column, row): (usize, usize)) -> [f64; 4] {
        let [width, height] = [self.right - self.left, self.bottom - self.top].map(|size| size.max(1) as f64);
        let right = (column - self.left) as f64 / width;
        let down = (row - self.top) as f64 / height;
        [(1.0 - right) * (1.0 - down), right * (1.0 - down), (1.0 - right) * down, right * down]
    }

    pub(crate) fn is_divisible(&self) -> bool {
        self.right - self.left > 1 || self.bottom - self.top > 1
    }

    /// The columns and rows of its subdivision.
    pub(crate) fn parts(&self) -> [impl Iterator<Item = usize> + Clone + use<>; 2] {
        [[self.left, self.right], [self.top, self.bottom]].map(|[first, last]| {
            let center = center(first, last);
            [first, center, last].into_iter().skip(usize::from(center == first))
        })
    }

    pub(crate) fn divided(&self) -> impl Iterator<Item = Cell> + use<> {
        let halves = |first: usize, last: usize| {
            let center = center(first, last);
            [[first, center], [center, last]].into_iter().skip(usize::from(center == first))
        };
        let columns = halves(self.left, self.right);
        let rows = halves(self.top, self.bottom);
        rows.flat_map(move |[top, bottom]| columns.clone().map(move |[left, right]| Cell { left, top, right, bottom }))
    }
}

/// The middle of two columns or rows; the first if they are adjacent.
fn center(first: usize, last: usize) -> usize {
    first + (last - first) / 2
}

/// The pixels of the coarsest grid that a stride adds, by the columns and rows of the grid.
pub(crate) fn first_pixels(
    [columns, rows]: [&[usize]; 2],
    stride: usize,
    coarser: usize,
) -> Vec<(Pixel, Option<Cell>)> {
    let on_grid = |at: usize, count: usize, stride: usize| at.is_multiple_of(stride) || at + 1 == count;
    // The places of the grid of twice the stride around a place.
    let around = |at: usize, steps: &[usize]| {
        let first = at - at % (2 * stride);
        [steps[first], steps[(first + 2 * stride).min(steps.len() - 1)]]
    };
    let mut wanted = Vec::with_capacity(columns.len() * rows.len());
    for (down, row) in rows.iter().enumerate().filter(|(down, _)| on_grid(*down, rows.len(), stride)) {
        for (right, column) in columns.iter().enumerate().filter(|(right, _)| on_grid(*right, columns.len(), stride)) {
            let is_sampled =
                stride < coarser && on_grid(down, rows.len(), 2 * stride) && on_grid(right, columns.len(), 2 * stride);
            if is_sampled {
                continue;
            }
            let ([left, right], [top, bottom]) = (around(right, columns), around(down, rows));
            let cell = (stride < coarser).then_some(Cell { left, top, right, bottom });
            wanted.push(((*column, *row), cell));
        }
    }
    wanted
}

/// The number of a ray along a Z-order curve through the samples of a grid.
pub(crate) fn numbered([column, row]: [usize; 2], (spacing, stream): (usize, usize), rays: u32, ray: u32) -> u64 {
    let [x, y] = [column / spacing, row / spacing].map(|at| at as u64);
    let tile = (stream as u64) << 40 | (y >> TILE_LOG2) << 20 | (x >> TILE_LOG2);
    let within = 1 << TILE_LOG2;
    let along = morton(x % within) | morton(y % within) << 1;
    // Pixels between the lines of the grid, at the border of the picture, follow after all others.
    let off = u64::from(column % spacing != 0 || row % spacing != 0);
    ((tile | off << 45) << INDEX_LOG2) | (along * u64::from(rays) + u64::from(ray))
}

/// The bits of a number below 2⁸, interleaved with zeros.
fn morton(number: u64) -> u64 {
    (0..8).map(|bit| (number >> bit & 1) << (2 * bit)).sum()
}
