//! `mksource [-d nsamps] [-t thresh] [-a maxang] [octree]`: distant sources for the bright parts of
//! an environment.
//!
//! The sphere of directions is subdivided into triangles, starting from a tetrahedron, each with
//! one sample (`-d`, default 262144). Starting at the brightest sample, round sources grow over
//! neighbours above the threshold (`-t`, in W/(sr·m²); by default exceeded by 2 % of the samples)
//! to a diameter of at most `-a` degrees. Each becomes an `illum` source with the mean radiance of
//! its area.
//!
//! Samples need a renderer, which this crate may not know: the caller opens the octree and returns
//! the radiance of a direction. A fixed sequence replaces the real program's random numbers, so
//! that the same scene gives the same sources.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::arguments::Arguments;
use crate::facets::{cross, dot, normalize, subtract};
use crate::text::Text;
use crate::{Error, Output};

/// Subdivisions of the tetrahedron's faces; 4 · 4^10 samples.
const DEEPEST: u32 = 10;
/// Number of failed attempts to find a source before the search ends.
const MOST_ATTEMPTS: usize = 100;

/// The radiance, W/(sr·m²), red, green and blue, from a direction (a unit vector pointing away from
/// the scene).
pub type EnvironmentRadiance<'a> = dyn Fn([f64; 3]) -> [f64; 3] + 'a;

/// Opens the named octree, or the one on standard input.
pub type OpenEnvironment<'o, 'a> = dyn Fn(Option<&str>) -> Result<Box<EnvironmentRadiance<'a>>, Error> + 'o;

/// Runs the command. `open` receives the octree's name, if any, and returns its environment.
///
/// # Errors
/// When the arguments are wrong, or the octree cannot be opened.
pub fn mksource(argv: &[String], open: &OpenEnvironment<'_, '_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(argv);
    let (mut samples, mut threshold, mut largest) = (262_144i64, 0.0, 15.0f64);
    while let Some(option) = arguments.option()? {
        match option.name {
            "-d" => {
                let position = arguments.position();
                samples = arguments.integer("samples (-d)")?;
                if samples < 4 {
                    return Err(arguments.mistake(position, format!("samples (-d) is {samples}, expected at least 4")));
                }
            }
            "-t" => threshold = arguments.number("threshold (-t)")?,
            "-a" => largest = arguments.positive("largest angle (-a)")?.min(180.0),
            _ => return Err(arguments.unknown()),
        }
    }
    let octree = arguments.word();
    if arguments.word().is_some() {
        return Err(arguments.unknown());
    }
    let environment = open(octree)?;
    let mut map = SampleMap::new(samples, &*environment);
    let threshold = if threshold > 1e-6 { threshold } else { map.threshold() };
    let mut text = Text::default();
    text.command_comment(argv)?;
    map.write_sources(threshold, largest.to_radians(), &mut text)?;
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

/// One triangle of the sphere.
struct Sample {
    direction: [f64; 3],
    /// Steradians.
    solid_angle: f64,
    radiance: [f64; 3],
    /// Binary exponent of the largest component; `None` for black and for claimed samples.
    level: Option<i32>,
}

struct SampleMap {
    samples: Vec<Sample>,
}

/// A growing round source.
struct Spot {
    centre: [f64; 3],
    /// Radians.
    radius: f64,
    /// Sum of radiance times solid angle.
    light: [f64; 3],
}

impl Spot {
    fn solid_angle(&self) -> f64 {
        2.0 * PI * (1.0 - self.radius.cos())
    }
}

impl SampleMap {
    fn new(wanted: i64, environment: &EnvironmentRadiance<'_>) -> SampleMap {
        let mut depth = 0;
        let mut rest = (wanted - 4) * 3 / 4;
        while rest > 1 && depth < DEEPEST {
            rest >>= 2;
            depth += 1;
        }
        let (sine, cosine) = (2.0 * (2.0f64 / 3.0).sqrt().asin()).sin_cos();
        let corner = |turn: f64| [-sine * (turn * 2.0 * PI / 3.0).sin(), sine * (turn * 2.0 * PI / 3.0).cos(), cosine];
        let corners = [[0.0, 0.0, 1.0], corner(0.0), corner(1.0), corner(2.0)];
        let mut map = SampleMap { samples: Vec::with_capacity(4 << (2 * depth)) };
        for face in 0..4 {
            let triangle = std::array::from_fn(|index| corners[(face + index) % 4]);
            map.divide(triangle, depth, environment);
        }
        map
    }

    fn divide(&mut self, triangle: [[f64; 3]; 3], depth: u32, environment: &EnvironmentRadiance<'_>) {
        let [a, b, c] = triangle;
        if depth == 0 {
            return self.sample(triangle, environment);
        }
        let middle = |p: [f64; 3], q: [f64; 3]| normalize(std::array::from_fn(|axis| p[axis] + q[axis])).unwrap_or(p);
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            self.divide(part, depth - 1, environment);
        }
    }

    fn sample(&mut self, [a, b, c]: [[f64; 3]; 3], environment: &EnvironmentRadiance<'_>) {
        // The R₂ sequence, a two-dimensional analogue of the golden ratio, distributes points
        // uniformly (M. Roberts, 2018).
        let index = self.samples.len() as f64;
        let (u, v) = ((0.5 + index * 0.754_877_666_246_693).fract(), (0.5 + index * 0.569_840_290_998_053).fract());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let point = std::array::from_fn(|axis| (1.0 - u - v) * a[axis] + u * b[axis] + v * c[axis]);
        let direction = normalize(point).unwrap_or(a);
        let area = cross(subtract(b, a), subtract(c, b));
        let radiance = environment(direction).map(|value| if value.is_finite() { value.max(0.0) } else { 0.0 });
        let solid_angle = 0.5 * dot(area, area).sqrt();
        self.samples.push(Sample { direction, solid_angle, radiance, level: level(radiance) });
    }

    /// The level that 2 % of the samples exceed.
    fn threshold(&self) -> f64 {
        let mut levels: Vec<i32> = self.samples.iter().filter_map(|sample| sample.level).collect();
        levels.sort_unstable_by(|a, b| b.cmp(a));
        match levels.get(self.samples.len() / 50).or(levels.last()) {
            Some(level) => 0.75 * f64::from(level - 1).exp2(),
            None => 0.0,
        }
    }

    fn write_sources(&mut self, threshold: f64, largest: f64, text: &mut Text) -> Result<(), Error> {
        if threshold <= 1e-6 {
            return Ok(());
        }
        let lowest_level = threshold.log2().round() as i32;
        let largest_solid_angle = 2.0 * PI * (1.0 - (largest / 2.0).cos());
        let least_light = 0.05 * threshold * largest_solid_angle;
        let (mut attempts, mut count) = (MOST_ATTEMPTS, 0);
        let mut lost: Vec<Spot> = Vec::new();
        while attempts > 0 {
            attempts -= 1;
            let brightest = (0..self.samples.len())
                .filter(|index| self.samples[*index].level.is_some_and(|level| level > lowest_level))
                .max_by_key(|index| (self.samples[*index].level, std::cmp::Reverse(*index)));
            let Some(start) = brightest else { break };
            let mut spot = self.grow(start, threshold, largest_solid_angle);
            if brightness(spot.light) < least_light {
                lost.push(spot);
                continue;
            }
            // Samples too dim for a source of their own are added to the source that covers them.
            let reach = (spot.solid_angle() / PI).sqrt();
            lost.retain(|dim| {
                let is_covered = angle(dim.centre, spot.centre) <= reach;
                if is_covered {
                    (0..3).for_each(|band| spot.light[band] += dim.light[band]);
                }
                !is_covered
            });
            count += 1;
            let [r, g, b] = spot.light.map(|value| value / spot.solid_angle());
            write!(text, "\nvoid illum IBLout\n0\n0\n3 {r:.6} {g:.6} {b:.6}\n")?;
            let ([x, y, z], degrees) = (spot.centre, 2.0 * spot.radius.to_degrees());
            write!(text, "\nIBLout source IBLsrc{count}\n0\n0\n4 {x:.6} {y:.6} {z:.6} {degrees:.6}\n")?;
            attempts = MOST_ATTEMPTS;
        }
        Ok(())
    }

    /// Grows a source from a sample over bright neighbours, and claims the samples that it covers.
    fn grow(&mut self, start: usize, threshold: f64, largest_solid_angle: f64) -> Spot {
        let first = &mut self.samples[start];
        first.level = None;
        let light = first.radiance.map(|value| value * first.solid_angle);
        let threshold = threshold.max(0.15 * brightness(first.radiance));
        let lowest_level = threshold.log2().round() as i32;
        let mut spot = Spot { centre: first.direction, radius: (first.solid_angle / PI).sqrt(), light };
        let step = 3.0 * spot.radius;
        while let Some(centre) = self.weighted_direction(&spot, step, lowest_level) {
            let way = angle(centre, spot.centre);
            let part = if way > step { step / way } else { 1.0 };
            let moved = std::array::from_fn(|axis| spot.centre[axis] + part * (centre[axis] - spot.centre[axis]));
            spot.centre = normalize(moved).unwrap_or(spot.centre);
            spot.radius = (spot.radius + step).min(PI);
            self.claim(&mut spot);
            if spot.solid_angle() >= largest_solid_angle || brightness(spot.light) / spot.solid_angle() <= threshold {
                break;
            }
        }
        spot
    }

    /// The centre of the bright samples within a step of the source; `None` if there are none.
    fn weighted_direction(&self, spot: &Spot, step: f64, lowest_level: i32) -> Option<[f64; 3]> {
        let reach = (spot.radius + step).min(PI).cos();
        let mut sum = [0.0; 3];
        for sample in &self.samples {
            if sample.level.is_some_and(|level| level >= lowest_level) && dot(sample.direction, spot.centre) >= reach {
                let weight = sample.radiance[1] * sample.solid_angle;
                (0..3).for_each(|axis| sum[axis] += weight * sample.direction[axis]);
            }
        }
        normalize(sum)
    }

    fn claim(&mut self, spot: &mut Spot) {
        let reach = spot.radius.cos();
        for sample in &mut self.samples {
            if sample.level.is_some() && dot(sample.direction, spot.centre) >= reach {
                sample.level = None;
                (0..3).for_each(|band| spot.light[band] += sample.radiance[band] * sample.solid_angle);
            }
        }
    }
}

fn level(radiance: [f64; 3]) -> Option<i32> {
    let largest = radiance.into_iter().fold(0.0, f64::max);
    (largest > 1e-32).then(|| largest.log2().floor() as i32 + 1)
}

fn brightness(rgb: [f64; 3]) -> f64 {
    crate::cie::brightness(rgb)
}

/// The angle between unit vectors, in radians.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let chord = subtract(a, b);
    2.0 * (0.5 * dot(chord, chord).sqrt()).min(1.0).asin()
}
