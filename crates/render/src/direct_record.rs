//! Direct light that neighbouring camera rays received, by light.

use glam::DVec3;
use radsight_compile::{LightDivision, RenderPlan};
use std::sync::Arc;

/// Numbers of lights for which records pay: fewer are sampled faster, and more take too much memory.
const FEWEST_LIGHTS: usize = 8;
const MOST_LIGHTS: usize = 256;

/// Minimum cosine between the normals of a point and of a recorded one beside it.
const MIN_COSINE: f64 = 0.9;

/// Maximum distance of a recorded point from the tangent plane, relative to its distance.
const MAX_SLOPE: f64 = 0.3;

/// Maximum ratio between their diffuse reflectances, and of each band. Recorded light is scaled by it.
const MAX_RATIO: f32 = 8.0;

/// Light that a point probably receives, at least, relative to that without shadows.
const LEAST_LEVEL: f64 = 0.3;

/// Number of recorded points around a point that are needed to expect its light.
const LEAST_RECORDS: usize = 2;

/// The direct light at the points that a camera ray sees, directly and through specular surfaces,
/// by light.
#[derive(Clone, Debug, Default)]
pub struct DirectRecord {
    points: Vec<RecordedPoint>,
    /// Those of the first point, then those of the second, and so on.
    lights: Vec<RecordedLight>,
}

/// A record of a ray beside another one.
#[derive(Clone, Debug)]
pub struct NearRecord {
    /// The record.
    pub record: Arc<DirectRecord>,
    /// Its weight in interpolation between the records; above zero.
    pub weight: f32,
}

/// A point with recorded light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RecordedPoint {
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
    /// Diffuse reflectance of each band.
    pub(crate) diffuse: [f32; 3],
}

/// The radiance that a point scatters to the viewer from one light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RecordedLight {
    /// W/(sr·m²).
    pub(crate) given: [f32; 3],
    /// What it would be without shadows, summed over the bands.
    pub(crate) unshadowed: f32,
}

/// The radiance from one light that records around a point suggest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ExpectedLight {
    /// Interpolated between the records.
    pub(crate) mean: RecordedLight,
    /// The largest value without shadows, summed over the bands.
    pub(crate) strongest: f32,
    /// The smallest and the largest radiance, summed over the bands.
    range: [f32; 2],
}

/// A light that is not sampled at every point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeldomSampled {
    pub(crate) index: usize,
    /// Probability of selecting it.
    pub(crate) chance: f64,
    /// Sum of the probabilities of the lights before it, without the whole part.
    pub(crate) start: f64,
    pub(crate) is_selected: bool,
    /// What it gives beyond what was expected; zero until it is sampled.
    pub(crate) difference: [f64; 3],
}

impl SeldomSampled {
    /// Whether the difference exceeds a limit, summed over the bands.
    pub(crate) fn exceeds(&self, limit: f64) -> bool {
        self.difference.iter().map(|band| band.abs()).sum::<f64>() > limit
    }
}

/// Records the direct light of a ray, and finds what neighbouring rays recorded.
#[derive(Debug, Default)]
pub(crate) struct DirectRecorder {
    near: Vec<NearRecord>,
    /// Number of points of the current ray.
    points: usize,
    /// `None` if nobody wants the record of the ray.
    record: Option<DirectRecord>,
    /// One for each light; of the current point.
    pub(crate) expected: Vec<ExpectedLight>,
    /// Memory for the lights of a point that are not always sampled.
    pub(crate) seldom: Vec<SeldomSampled>,
}

/// Whether rays record direct light: interpolated pictures in which each ray samples many lights.
pub(crate) fn records_direct_light(plan: &RenderPlan) -> bool {
    let options = &plan.options;
    let is_shared = matches!(options.light_division, LightDivision::Shared(_));
    is_shared
        && plan.bands <= 3
        && plan.light_draws[0] == 0
        && (FEWEST_LIGHTS..=MOST_LIGHTS).contains(&plan.lights.len())
        && options.ray_tree.is_none()
        && options.tracked_modifiers.is_empty()
}

impl RecordedPoint {
    /// Whether irradiance changes smoothly to another point.
    fn continues(&self, other: &RecordedPoint) -> bool {
        let way = other.position - self.position;
        self.normal.dot(other.normal) >= MIN_COSINE
            && self.normal.dot(way).abs() <= MAX_SLOPE * way.length() + f64::EPSILON
    }
}

/// Ratio of the light that two points with the same irradiance reflect.
#[derive(Clone, Copy)]
struct ReflectanceRatio {
    bands: [f32; 3],
    /// That of the sum over the bands.
    sum: f32,
}

impl ReflectanceRatio {
    /// `None` if one point reflects far more than the other.
    fn new(point: &RecordedPoint, recorded: &RecordedPoint) -> Option<ReflectanceRatio> {
        if point.diffuse == recorded.diffuse {
            return Some(ReflectanceRatio { bands: [1.0; 3], sum: 1.0 });
        }
        let [here, there] = [point, recorded].map(|point| point.diffuse.iter().sum::<f32>());
        if here.max(there) > MAX_RATIO * here.min(there) {
            return None;
        }
        let bands = std::array::from_fn(|band| {
            // A band that the recorded point does not reflect has no recorded light.
            (point.diffuse[band] / recorded.diffuse[band]).min(MAX_RATIO)
        });
        Some(ReflectanceRatio { bands, sum: here / there })
    }
}

impl DirectRecorder {
    /// Begins a ray beside those of some records; its own record is added to `record`.
    pub(crate) fn begin(&mut self, near: &[NearRecord], record: Option<DirectRecord>) {
        self.near.clear();
        self.near.extend_from_slice(near);
        self.points = 0;
        self.record = record;
    }

    /// The record of the ray.
    pub(crate) fn finish(&mut self) -> Option<DirectRecord> {
        self.record.take()
    }

    /// Finds what the records suggest for the next point of the ray, and returns whether they are
    /// enough.
    pub(crate) fn expect(&mut self, point: &RecordedPoint, lights: usize) -> bool {
        let order = self.points;
        let (mut records, mut weights) = (0, 0.0);
        for NearRecord { record, weight } in &self.near {
            let Some(recorded) = record.points.get(order).filter(|recorded| point.continues(recorded)) else {
                continue;
            };
            let Some(ratio) = ReflectanceRatio::new(point, recorded) else { continue };
            let recorded = &record.lights[order * lights..][..lights];
            if records == 0 {
                self.expected.clear();
                self.expected
                    .extend(recorded.iter().map(|recorded| ExpectedLight::of(&recorded.scaled(&ratio), *weight)));
            } else {
                let pairs = self.expected.iter_mut().zip(recorded);
                pairs.for_each(|(expected, recorded)| expected.add(&recorded.scaled(&ratio), *weight));
            }
            (records, weights) = (records + 1, weights + weight);
        }
        let is_known = records >= LEAST_RECORDS;
        if is_known {
            self.expected.iter_mut().for_each(|expected| expected.divide(weights));
        } else {
            self.expected.clear();
            self.expected.resize(lights, ExpectedLight::default());
        }
        is_known
    }

    /// The light that the current point probably receives, summed over lights and bands; at least a
    /// fraction of what it would receive without shadows, from lights that reach a record if there
    /// are any: a hidden sun tells nothing of how much the lamps matter.
    pub(crate) fn level(&self) -> f64 {
        let (mut received, mut reaching, mut all) = (0.0, 0.0, 0.0);
        for expected in &self.expected {
            let unshadowed = f64::from(expected.mean.unshadowed);
            received += f64::from(expected.mean.sum());
            all += unshadowed;
            if expected.range[1] > 0.0 {
                reaching += unshadowed;
            }
        }
        f64::max(received, LEAST_LEVEL * if reaching > 0.0 { reaching } else { all })
    }

    /// Whether the points of the ray are recorded.
    pub(crate) fn records(&self) -> bool {
        self.record.is_some()
    }

    /// Goes on to the next point of a ray that is not recorded.
    pub(crate) fn pass_point(&mut self) {
        self.points += 1;
    }

    /// Records the current point, for whose lights [`DirectRecorder::expected`] holds what is now
    /// known of them.
    pub(crate) fn finish_point(&mut self, point: RecordedPoint) {
        self.points += 1;
        if let Some(record) = &mut self.record {
            record.points.push(point);
            record.lights.extend(self.expected.iter().map(|expected| expected.mean));
        }
    }
}

impl RecordedLight {
    /// What another point with the same irradiance scatters.
    #[inline]
    fn scaled(&self, ratio: &ReflectanceRatio) -> RecordedLight {
        let given = std::array::from_fn(|band| ratio.bands[band] * self.given[band]);
        RecordedLight { given, unshadowed: ratio.sum * self.unshadowed }
    }

    /// The sum over the bands.
    fn sum(&self) -> f32 {
        self.given[0] + self.given[1] + self.given[2]
    }
}

impl ExpectedLight {
    /// What a single record suggests. `mean` holds the weighted sum until
    /// [`ExpectedLight::divide`].
    fn of(recorded: &RecordedLight, weight: f32) -> ExpectedLight {
        let sum = recorded.sum();
        let mean =
            RecordedLight { given: recorded.given.map(|band| weight * band), unshadowed: weight * recorded.unshadowed };
        ExpectedLight { mean, strongest: recorded.unshadowed, range: [sum, sum] }
    }

    #[inline]
    fn add(&mut self, recorded: &RecordedLight, weight: f32) {
        let sum = recorded.sum();
        for (mean, band) in self.mean.given.iter_mut().zip(recorded.given) {
            *mean += weight * band;
        }
        self.mean.unshadowed += weight * recorded.unshadowed;
        // No value is NaN, for which `f32::max` takes several instructions.
        let larger = |a: f32, b: f32| if b > a { b } else { a };
        let smaller = |a: f32, b: f32| if b < a { b } else { a };
        self.strongest = larger(self.strongest, recorded.unshadowed);
        self.range = [smaller(self.range[0], sum), larger(self.range[1], sum)];
    }

    fn divide(&mut self, weights: f32) {
        let share = weights.recip();
        self.mean.given = self.mean.given.map(|band| share * band);
        self.mean.unshadowed *= share;
    }

    /// Difference between the largest and the smallest radiance, summed over the bands.
    pub(crate) fn spread(&self) -> f32 {
        self.range[1] - self.range[0]
    }
}
