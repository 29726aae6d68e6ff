//! Patterns with a factor for each wavelength.

use crate::bands::BandLayout;
use crate::function::Function;
use crate::function::MAX_COORDINATES;
use crate::interaction::SurfaceInteraction;
use radsight_cal::Scratch;
use radsight_ir::{Axis, DataGrid, Handle, Scene};
use radsight_spectrum::{Conversion, Sampling};
use std::sync::Arc;

/// Conversion from values at some wavelengths to the elements of a ray.
#[derive(Clone, Debug)]
struct Receiver {
    layout: Arc<BandLayout>,
    conversion: Conversion,
}

impl Receiver {
    /// Multiplies by the values, given in the order of the conversion; changes nothing if one of
    /// them is missing.
    fn multiply<const BANDS: usize>(&self, values: impl Iterator<Item = Option<f64>>, color: &mut [f64; BANDS]) {
        let mut complete = true;
        let values = values.map(|value| {
            complete &= value.is_some();
            value.unwrap_or(0.0)
        });
        let mut bands = [0.0; Sampling::MOST_BANDS];
        self.conversion.apply(values, &mut bands[..self.layout.sampling().bands()]);
        if complete {
            for (element, band) in color.iter_mut().zip(self.layout.band_of()) {
                *element *= bands[*band];
            }
        }
    }
}

/// `specfunc`.
#[derive(Clone, Debug)]
pub struct SpectralFunction {
    function: Function,
    receiver: Receiver,
    /// Nodes of each band in which the function is evaluated, nm; the bands ascend.
    wavelengths_nm: Vec<[f64; 3]>,
}

/// Gauss's rule of three nodes on an interval of the width 1 about 0, with its weights.
const NODES: [f64; 3] = [-0.387_298_334_620_741_7, 0.0, 0.387_298_334_620_741_7];
const WEIGHTS: [f64; 3] = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];

impl SpectralFunction {
    /// A function of the wavelength between two limits, nm. Radiance evaluates it at random
    /// wavelengths of up to 24 bands, no narrower than a quarter of the traced bands; this takes its
    /// mean over each band by Gauss's rule. `None` if no traced band is in the range.
    pub fn new(function: Function, range_nm: [f64; 2], layout: &Arc<BandLayout>) -> Option<SpectralFunction> {
        let [longest, .., shortest] = layout.sampling().splits_nm();
        let (first, last) = (range_nm[0].max(shortest), range_nm[1].min(longest));
        if first >= last {
            return None;
        }
        let finest = 0.25 * layout.sampling().step_nm();
        let step = ((last - first) / Sampling::MOST_BANDS as f64).max(finest);
        let count = (((last - first) / step + 0.1) as usize).max(1);
        let nodes = |center: f64| NODES.map(|node| center + node * step);
        let wavelengths_nm = (0..count).rev().map(|back| nodes(last - (back as f64 + 0.5) * step)).collect();
        let conversion = Conversion::new(layout.sampling(), count, [first, last]);
        Some(SpectralFunction { function, receiver: Receiver { layout: layout.clone(), conversion }, wavelengths_nm })
    }

    /// Multiplies a colour by the pattern at the intersection; a function that fails changes
    /// nothing.
    pub fn apply<const BANDS: usize>(
        &self,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
        color: &mut [f64; BANDS],
    ) {
        let view = self.function.view(interaction);
        let mean = |nodes: &[f64; 3]| {
            nodes.iter().zip(WEIGHTS).try_fold(0.0, |sum, (wavelength, weight)| {
                let value = self.function.program.eval(0, &[*wavelength], &view, scratch).ok()?;
                Some(sum + weight * value)
            })
        };
        self.receiver.multiply(self.wavelengths_nm.iter().map(mean), color);
    }
}

/// `specdata` and `specpict`.
#[derive(Clone, Debug)]
pub struct SpectralData {
    function: Function,
    grid: Handle<DataGrid>,
    receiver: Receiver,
    /// Wavelengths at which the grid's last axis is interpolated, nm.
    wavelengths_nm: Vec<f64>,
}

impl SpectralData {
    /// A pattern from a table whose last axis is the wavelength; `None` if it has no axis.
    pub fn new(function: Function, scene: &Scene, grid: Handle<DataGrid>, layout: &Arc<BandLayout>) -> Option<Self> {
        let axis = scene.grids[grid].axes.last()?;
        let (first, last) = match axis {
            Axis::Regular { first, last, .. } => (*first, *last),
            Axis::Irregular(points) => (*points.first()?, *points.last()?),
        };
        let count = axis.count();
        let step = (last - first) / (count as f64 - 1.0);
        let conversion = Conversion::new(layout.sampling(), count, [first - 0.5 * step, last + 0.5 * step]);
        let receiver = Receiver { layout: layout.clone(), conversion };
        let wavelengths_nm = (0..count).map(|point| first + step * point as f64).collect();
        Some(SpectralData { function, grid, receiver, wavelengths_nm })
    }

    /// Multiplies a colour by the pattern at the intersection; a function that fails changes
    /// nothing.
    pub fn apply<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
        color: &mut [f64; BANDS],
    ) {
        let view = self.function.view(interaction);
        let program = &self.function.program;
        let grid = &scene.grids[self.grid];
        let axes = grid.axes.len().min(MAX_COORDINATES);
        let mut coordinates = [0.0; MAX_COORDINATES];
        for (axis, coordinate) in coordinates[..axes - 1].iter_mut().enumerate() {
            match program.eval(1 + axis, &[], &view, scratch) {
                Ok(value) => *coordinate = value,
                Err(_) => return,
            }
        }
        let value = |wavelength: &f64| {
            coordinates[axes - 1] = *wavelength;
            program.eval(0, &[grid.value(&coordinates[..axes]), *wavelength], &view, scratch).ok()
        };
        self.receiver.multiply(self.wavelengths_nm.iter().map(value), color);
    }
}
