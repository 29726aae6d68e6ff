//! Calibration targets for cameras as scene text: a chessboard and a grid of dots.
//!
//! A target lies in the plane z = 0, centred at the origin, and faces +z; seen from there, x points
//! right and y up. Its names begin with `target`. `xform` moves it.

use std::fmt::Write;

/// Reflectances of paper and ink.
const WHITE: f64 = 0.85;
const BLACK: f64 = 0.05;
/// Height of the dots above the board, relative to their spacing, so that they are not coplanar
/// with it.
const DOT_HEIGHT: f64 = 1e-4;

/// Largest number of marks per row or column.
pub const MOST_MARKS: u32 = 500;

/// The pattern of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetPattern {
    /// Squares, one more per row and column than inner corners; OpenCV's `findChessboardCorners`.
    Chessboard,
    /// Black dots with a diameter of half their spacing; OpenCV's `findCirclesGrid`.
    Dots,
}

/// A calibration target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationTarget {
    /// The pattern.
    pub pattern: TargetPattern,
    /// Marks per row: inner corners of the chessboard, or dots.
    pub columns: u32,
    /// Marks per column.
    pub rows: u32,
    /// Distance between neighbouring marks, scene units.
    pub spacing: f64,
    /// Radiance of the white, W/(sr·m²), if the target is self-luminous; otherwise it is a matt
    /// surface that needs light.
    pub radiance: Option<f64>,
}

/// Why a target is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TargetError {
    /// Too few marks or too many.
    #[error("{columns} x {rows} marks: expected from 2 to {MOST_MARKS} each way")]
    Marks {
        /// Marks per row.
        columns: u32,
        /// Marks per column.
        rows: u32,
    },
    /// A length or radiance that is not positive and finite.
    #[error("the {quantity} is {value}, expected a finite number above 0")]
    NotPositive {
        /// Its name.
        quantity: &'static str,
        /// The value.
        value: f64,
    },
}

impl CalibrationTarget {
    /// The target as Radiance scene text.
    ///
    /// # Errors
    /// When its numbers are out of range.
    pub fn scene_text(&self) -> Result<String, TargetError> {
        let (columns, rows) = (self.columns, self.rows);
        if ![columns, rows].iter().all(|count| (2..=MOST_MARKS).contains(count)) {
            return Err(TargetError::Marks { columns, rows });
        }
        for (quantity, value) in [("spacing", self.spacing), ("radiance", self.radiance.unwrap_or(1.0))] {
            if !(value.is_finite() && value > 0.0) {
                return Err(TargetError::NotPositive { quantity, value });
            }
        }
        let mut out = self.materials();
        match self.pattern {
            TargetPattern::Chessboard => self.chessboard(&mut out),
            TargetPattern::Dots => self.dots(&mut out),
        }
        Ok(out)
    }

    fn materials(&self) -> String {
        let mut out = format!(
            "# Calibration target: {} x {} {}, {} scene units apart, in the plane z = 0, facing +z.\n\n",
            self.columns,
            self.rows,
            if self.pattern == TargetPattern::Chessboard { "inner corners" } else { "dots" },
            self.spacing
        );
        for (name, reflectance) in [("target_white", WHITE), ("target_black", BLACK)] {
            let _ = match self.radiance {
                Some(radiance) => {
                    let own = radiance * reflectance / WHITE;
                    write!(out, "void glow {name}\n0\n0\n4 {own} {own} {own} 0\n\n")
                }
                None => write!(out, "void plastic {name}\n0\n0\n5 {0} {0} {0} 0 0\n\n", reflectance),
            };
        }
        out
    }

    /// Adjacent squares without overlap, with a white margin as wide as a square.
    fn chessboard(&self, out: &mut String) {
        let (columns, rows) = (self.columns + 1, self.rows + 1);
        let corner = |column: u32, row: u32| {
            [
                (f64::from(column) - 0.5 * f64::from(columns)) * self.spacing,
                (f64::from(row) - 0.5 * f64::from(rows)) * self.spacing,
            ]
        };
        for row in 0..rows {
            for column in 0..columns {
                let material = if (column + row) % 2 == 0 { "target_black" } else { "target_white" };
                let name = format!("target_{column}_{row}");
                rectangle(material, &name, corner(column, row), corner(column + 1, row + 1), out);
            }
        }
        self.margin(corner(0, 0), corner(columns, rows), out);
    }

    fn margin(&self, [left, below]: [f64; 2], [right, above]: [f64; 2], out: &mut String) {
        let wide = self.spacing;
        let sides = [
            ([left - wide, below - wide], [right + wide, below]),
            ([left - wide, above], [right + wide, above + wide]),
            ([left - wide, below], [left, above]),
            ([right, below], [right + wide, above]),
        ];
        for (number, (low, high)) in sides.into_iter().enumerate() {
            rectangle("target_white", &format!("target_margin_{number}"), low, high, out);
        }
    }

    fn dots(&self, out: &mut String) {
        let half = |count: u32| 0.5 * f64::from(count + 1) * self.spacing;
        let (width, height) = (half(self.columns), half(self.rows));
        rectangle("target_white", "target_board", [-width, -height], [width, height], out);
        for row in 0..self.rows {
            for column in 0..self.columns {
                let x = (f64::from(column) - 0.5 * f64::from(self.columns - 1)) * self.spacing;
                let y = (f64::from(row) - 0.5 * f64::from(self.rows - 1)) * self.spacing;
                let _ = write!(
                    out,
                    "target_black ring target_{column}_{row}\n0\n0\n8\n  {x} {y} {}\n  0 0 1\n  0 {}\n\n",
                    DOT_HEIGHT * self.spacing,
                    0.25 * self.spacing
                );
            }
        }
    }
}

fn rectangle(material: &str, name: &str, [left, below]: [f64; 2], [right, above]: [f64; 2], out: &mut String) {
    let _ = write!(
        out,
        "{material} polygon {name}\n0\n0\n12\n  {left} {below} 0\n  {right} {below} 0\n  {right} {above} 0\n  {left} {above} 0\n\n"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOARD: CalibrationTarget =
        CalibrationTarget { pattern: TargetPattern::Chessboard, columns: 4, rows: 3, spacing: 0.02, radiance: None };

    #[test]
    fn a_chessboard_has_a_square_more_than_corners_each_way() {
        let text = BOARD.scene_text().unwrap();
        assert_eq!(text.matches(" polygon target_").count(), 5 * 4 + 4);
        assert_eq!(text.matches("target_black polygon").count(), 10);
    }

    #[test]
    fn dots_stand_where_they_should() {
        let dots = CalibrationTarget { pattern: TargetPattern::Dots, radiance: Some(2.0), ..BOARD };
        let text = dots.scene_text().unwrap();
        assert_eq!(text.matches(" ring ").count(), 12);
        assert!(text.contains("ring target_0_0\n0\n0\n8\n  -0.03 -0.02 "), "{text}");
        assert!(text.contains("glow target_white\n0\n0\n4 2 2 2 0"));
    }

    #[test]
    fn impossible_targets_are_refused() {
        let message = |target: CalibrationTarget| target.scene_text().unwrap_err().to_string();
        assert_eq!(message(CalibrationTarget { columns: 1, ..BOARD }), "1 x 3 marks: expected from 2 to 500 each way");
        assert!(message(CalibrationTarget { spacing: -1.0, ..BOARD }).starts_with("the spacing is -1"));
        assert!(message(CalibrationTarget { radiance: Some(f64::NAN), ..BOARD }).starts_with("the radiance is NaN"));
    }
}
