//! Values on a grid of s and t, read from a file of numbers and interpolated linearly.

use crate::scene_words::SceneWords;

/// The numbers of the file: all s for each t, one or three numbers per point.
pub(crate) struct GridData {
    /// Number of values along s and t.
    counts: [usize; 2],
    components: usize,
    numbers: Vec<f64>,
    /// Whether the first and last values lie on the border rather than half a step inside.
    with_border: bool,
}

impl GridData {
    /// Reads the values of a surface of `steps` in s and t: (m+1)(n+1) grid points, or m·n cell
    /// centres.
    pub(crate) fn read(bytes: &[u8], steps: [usize; 2], components: usize) -> Result<GridData, String> {
        let [m, n] = steps;
        let (at_corners, in_middles) = ((m + 1) * (n + 1) * components, m * n * components);
        let mut words = SceneWords::new(bytes);
        let mut numbers = Vec::new();
        while let Some(word) = words.word() {
            match crate::number_text::whole_number(&word).filter(|value| value.is_finite()) {
                Some(number) if numbers.len() < at_corners => numbers.push(number),
                Some(_) => return Err(format!("more than {at_corners} values for a surface of {m} by {n} steps")),
                None => return Err(format!("value {} is \"{word}\", expected a finite number", numbers.len() + 1)),
            }
        }
        let with_border = numbers.len() == at_corners;
        let counts = if with_border { [m + 1, n + 1] } else { [m, n] };
        if !with_border && numbers.len() != in_middles || counts[0] < 2 || counts[1] < 2 {
            let found = numbers.len();
            return Err(format!("{found} values, expected {at_corners} (with border) or {in_middles} (without)"));
        }
        Ok(GridData { counts, components, numbers, with_border })
    }

    /// The value at s and t; extrapolated linearly outside the grid.
    pub(crate) fn value(&self, parameters: [f64; 2], component: usize) -> f64 {
        let mut cell = [0usize; 2];
        let mut fraction = [0.0; 2];
        for axis in 0..2 {
            let count = self.counts[axis];
            let place = match self.with_border {
                true => parameters[axis] * (count - 1) as f64,
                false => parameters[axis] * count as f64 - 0.5,
            };
            cell[axis] = (place.max(0.0) as usize).min(count - 2);
            fraction[axis] = place - cell[axis] as f64;
        }
        let at = |ds: usize, dt: usize| {
            let index = (cell[1] + dt) * self.counts[0] + cell[0] + ds;
            self.numbers[index * self.components + component]
        };
        let [fs, ft] = fraction;
        (1.0 - ft) * ((1.0 - fs) * at(0, 0) + fs * at(1, 0)) + ft * ((1.0 - fs) * at(0, 1) + fs * at(1, 1))
    }
}
