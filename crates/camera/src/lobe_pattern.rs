//! An angular table as Radiance patterns.
//!
//! A flat emitter of area A has radiance I₀·g(θ)/(A·cosθ). The factor g(θ)/cosθ becomes a chain of
//! `brightfunc` patterns, whose product it is: each handles a range of angles and is 1 outside it,
//! and the last is 0 beyond the table. One pattern cannot take a long table, since Radiance cuts a
//! word at 511 characters. Inside a range a balanced tree of `if`s on cosθ finds the row, and only
//! then is the angle computed. The patterns stand in a frame whose +z points against the LED's
//! axis, so that cosθ is `Dz`: on a light, D runs from what is lit towards the light.

use crate::AngularTable;
use glam::DVec3;
use std::fmt::Write;

/// The longest word that every Radiance reads whole leaves some room.
const LONGEST_WORD: usize = 480;

/// Below this angle, in degrees, θ comes from its sine, where the arc cosine would lose digits.
const SMALL_ANGLE_DEG: f64 = 1.0;

/// Writes the patterns, named `{name}_1` and so on, each modified by the one before. Gives the name
/// of the last.
pub(crate) fn write(table: &AngularTable, axis: DVec3, name: &str, out: &mut String) -> String {
    let segments = segments(table);
    let turn = turn_to(-axis);
    let mut modifier = "void".to_owned();
    let (mut first, mut number) = (0, 1);
    while first < segments.len() {
        let mut end = first + 1;
        let mut pattern = Pattern::new(&segments, first, end);
        while end < segments.len() {
            let longer = Pattern::new(&segments, first, end + 1);
            if longer.expression.len() > LONGEST_WORD {
                break;
            }
            (pattern, end) = (longer, end + 1);
        }
        let id = format!("{name}_{number}");
        let words = 2 + turn.len();
        let _ = write!(out, "{modifier} brightfunc {id}\n{words} {} .", pattern.expression);
        turn.iter().for_each(|word| {
            let _ = write!(out, " {word}");
        });
        let _ = write!(out, "\n0\n{}", pattern.numbers.len());
        for (index, value) in pattern.numbers.iter().enumerate() {
            let _ = write!(out, "{}{value}", if index % 6 == 0 { "\n  " } else { " " });
        }
        out.push_str("\n\n");
        (modifier, first, number) = (id, end, number + 1);
    }
    modifier
}

/// A stretch of the table on which g is `base + slope·θ`, θ in radians.
#[derive(Clone, Copy, Debug)]
struct Segment {
    small: bool,
    end_cosine: f64,
    base: f64,
    slope: f64,
}

fn segments(table: &AngularTable) -> Vec<Segment> {
    let segment = |pair: &[(f64, f64)]| {
        let [(a0, g0), (a1, g1)] = [pair[0], pair[1]];
        let slope_per_degree = (g1 - g0) / (a1 - a0);
        Segment {
            small: a0 < SMALL_ANGLE_DEG,
            // The cosine of 90° in floating point is not 0, and may be below.
            end_cosine: if a1 >= 90.0 { 0.0 } else { a1.to_radians().cos() },
            base: g0 - slope_per_degree * a0,
            slope: slope_per_degree.to_degrees(),
        }
    };
    table.rows().windows(2).map(segment).collect()
}

/// One pattern: an expression without spaces, and the real arguments that it uses.
#[derive(Debug, Default)]
struct Pattern {
    expression: String,
    numbers: Vec<f64>,
}

impl Pattern {
    /// The pattern of segments `first..end`.
    fn new(segments: &[Segment], first: usize, end: usize) -> Self {
        let mut pattern = Pattern::default();
        // The same number ends one pattern and begins the next, so no direction falls between them.
        let begin = first.checked_sub(1).map(|before| pattern.argument(segments[before].end_cosine));
        let limit = pattern.argument(segments[end - 1].end_cosine);
        let tree = pattern.tree(&segments[first..end]);
        let beyond = if end == segments.len() { "0" } else { "1" };
        let inside = format!("if(Dz-{limit},({tree})/Dz,{beyond})");
        pattern.expression = begin.map_or(inside.clone(), |begin| format!("if(Dz-{begin},1,{inside})"));
        pattern
    }

    fn tree(&mut self, segments: &[Segment]) -> String {
        if let [segment] = segments {
            let angle = if segment.small { "asin(sqrt(Dx*Dx+Dy*Dy))" } else { "acos(Dz)" };
            let (base, slope) = (self.argument(segment.base), self.argument(segment.slope));
            return format!("{base}+{slope}*{angle}");
        }
        let (near, far) = segments.split_at(segments.len() / 2);
        let cosine = self.argument(near[near.len() - 1].end_cosine);
        let (near, far) = (self.tree(near), self.tree(far));
        format!("if(Dz-{cosine},{near},{far})")
    }

    /// The word for a number; the first ten arguments have short names.
    fn argument(&mut self, value: f64) -> String {
        let known = self.numbers.iter().position(|number| number.to_bits() == value.to_bits());
        let index = known.unwrap_or_else(|| {
            self.numbers.push(value);
            self.numbers.len() - 1
        }) + 1;
        if index <= 10 { format!("A{index}") } else { format!("arg({index})") }
    }
}

/// The transform that turns +z to `axis` (unit): about y, then about z.
fn turn_to(axis: DVec3) -> Vec<String> {
    let polar = axis.truncate().length().atan2(axis.z).to_degrees();
    let azimuth = axis.y.atan2(axis.x).to_degrees();
    let mut words = Vec::new();
    if polar != 0.0 {
        words.extend(["-ry".to_owned(), polar.to_string()]);
        // A lobe along the axis is symmetric about it, so this rotation has an effect only after the first.
        if azimuth != 0.0 {
            words.extend(["-rz".to_owned(), azimuth.to_string()]);
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angular_table::tests::{HLMP_8104, table};

    #[test]
    fn words_stay_short_enough_for_radiance() {
        let mut rows = String::new();
        for step in 0..=900 {
            let _ = writeln!(rows, "{},{}", f64::from(step) * 0.1, 1.0 / (1.0 + f64::from(step)));
        }
        for text in [HLMP_8104, &rows] {
            let mut out = String::new();
            write(&table(text).unwrap().0, DVec3::new(0.6, 0.0, -0.8), "radsight_led_lobe", &mut out);
            let longest = out.split_whitespace().map(str::len).max().unwrap();
            assert!((100..=LONGEST_WORD).contains(&longest), "{longest}");
        }
    }

    #[test]
    fn a_lobe_that_faces_down_needs_no_transform() {
        assert!(turn_to(DVec3::Z).is_empty());
        assert_eq!(turn_to(DVec3::X), ["-ry", "90"]);
    }
}
