//! Radiance scene text, primitive by primitive.

use glam::DVec3;
use std::fmt::Write as _;

/// Scene text being written; every primitive gets its own name.
#[derive(Clone, Debug, Default)]
pub(crate) struct SceneText {
    text: String,
    primitives: u32,
}

impl SceneText {
    /// The text so far.
    pub(crate) fn as_str(&self) -> &str {
        &self.text
    }

    /// A modifier: a material, pattern or light with this name.
    pub(crate) fn modifier(&mut self, under: &str, kind: &str, name: &str, numbers: &[f64]) {
        self.primitive(under, kind, name, numbers);
    }

    /// A surface under a modifier.
    pub(crate) fn surface(&mut self, modifier: &str, kind: &str, numbers: &[f64]) {
        let name = format!("{kind}{}", self.primitives);
        self.primitive(modifier, kind, &name, numbers);
    }

    /// A polygon that faces the side from which its corners are counter-clockwise.
    pub(crate) fn polygon(&mut self, modifier: &str, corners: &[DVec3]) {
        let numbers: Vec<f64> = corners.iter().flat_map(|corner| corner.to_array()).collect();
        self.surface(modifier, "polygon", &numbers);
    }

    /// A closed box between two corners, facing outwards, rotated by an angle (radians) about the
    /// vertical through its centre.
    pub(crate) fn block(&mut self, modifier: &str, low: DVec3, high: DVec3, rotation: f64) {
        let middle = 0.5 * (low + high);
        let (sin, cos) = rotation.sin_cos();
        let corner = |bits: usize| {
            let position = DVec3::new(
                if bits & 1 == 0 { low.x } else { high.x },
                if bits & 2 == 0 { low.y } else { high.y },
                if bits & 4 == 0 { low.z } else { high.z },
            );
            let [x, y] = [position.x - middle.x, position.y - middle.y];
            DVec3::new(middle.x + cos * x - sin * y, middle.y + sin * x + cos * y, position.z)
        };
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            self.polygon(modifier, &face.map(corner));
        }
    }

    fn primitive(&mut self, under: &str, kind: &str, name: &str, numbers: &[f64]) {
        self.primitives += 1;
        let _ = write!(self.text, "{under} {kind} {name}\n0\n0\n{}", numbers.len());
        for number in numbers {
            let _ = write!(self.text, " {number:.6}");
        }
        self.text.push_str("\n\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faces_of_a_block_are_turned_outwards() {
        let mut scene = SceneText::default();
        scene.block("m", DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), 0.4);
        let middle = DVec3::new(0.5, 1.0, 1.5);
        let lines: Vec<&str> = scene.as_str().lines().filter(|line| line.starts_with("12 ")).collect();
        assert_eq!(lines.len(), 6);
        for line in lines {
            let numbers: Vec<f64> = line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect();
            let corner = |at: usize| DVec3::from_slice(&numbers[3 * at..]);
            let normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
            assert!(normal.dot(corner(0) - middle) > 0.0, "{line}");
        }
    }
}
