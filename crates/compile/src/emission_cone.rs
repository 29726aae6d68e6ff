//! Cones outside of which a luminaire with a measured distribution gives no light.
//!
//! Tables of luminaires often end in zeros, well before the plane of the lamp. `ies2rad` writes them
//! as `brightdata` with the functions of Radiance's `source.cal`: the value is a factor times the
//! table, and the last coordinate, `src_theta`, is the angle to the negative z axis in degrees.
//! Interpolation between zeros gives zero, so receivers beyond the last angle with light need no
//! light sample.

use glam::DVec3;
use radsight_accel::Ray;
use radsight_cal::Scratch;
use radsight_ir::{Axis, DataGrid, GridCall, ModifierHandle, ModifierKind, Pattern, Scene};
use radsight_light::LightCone;
use radsight_texture::{Function, SurfaceInteraction};

/// Added to the cone because of rounding, degrees.
const MARGIN: f64 = 1e-6;

/// Number of directions in which the functions are compared with those of `source.cal`, and the
/// largest difference, degrees.
const DIRECTIONS: u32 = 32;
const SAME_ANGLE: f64 = 1e-9;

/// The cone around the emission of surfaces with a modifier; `None` if it is not known.
pub(crate) fn emission_cone(scene: &Scene, modifier: Option<ModifierHandle>) -> Option<LightCone> {
    scene.chain(modifier).find_map(|(_, modifier)| match &modifier.kind {
        ModifierKind::Pattern(Pattern::BrightData(call)) => cone_of(scene, call),
        _ => None,
    })
}

fn cone_of(scene: &Scene, call: &GridCall) -> Option<LightCone> {
    let [_, _, file, coordinates @ ..] = &*call.call.words else { return None };
    let grid = &scene.grids[call.grids[0]];
    let is_known = |coordinate: &String| coordinate.starts_with("src_phi");
    let (last, others) = coordinates.get(..grid.axes.len())?.split_last()?;
    if file != "source.cal" || last != "src_theta" || !others.iter().all(is_known) {
        return None;
    }
    let half_angle = last_angle(grid)? + MARGIN;
    // The file may be another one of this name.
    let is_measured_from_below = (0..DIRECTIONS).all(|index| has_usual_functions(call, grid, direction(index)));
    let axis = call.call.to_scene.direction(-DVec3::Z).try_normalize()?;
    (half_angle < 90.0 && is_measured_from_below).then(|| LightCone::new(axis, half_angle.to_radians()))
}

/// The angle from which on a table is zero; `None` if there is none. The last axis is the angle.
fn last_angle(grid: &DataGrid) -> Option<f64> {
    let angles = grid.axes.last()?;
    let count = angles.count();
    let rows = grid.values.chunks_exact(count);
    let lit = rows.map(|row| row.iter().rposition(|value| *value != 0.0).map_or(0, |last| last + 1)).max()?;
    // Beyond its end, a table is continued by its last two values.
    if lit + 2 > count {
        return None;
    }
    let angle = |index: usize| match angles {
        Axis::Regular { first, last, .. } => first + (last - first) * index as f64 / (count - 1) as f64,
        Axis::Irregular(points) => points[index],
    };
    (angle(count - 1) > angle(0)).then(|| angle(lit))
}

/// Whether the functions give zero for zero, and the angle to the negative z axis, for a ray in
/// this direction.
fn has_usual_functions(call: &GridCall, grid: &DataGrid, direction: DVec3) -> bool {
    let function = Function::new(&call.call);
    let mut scratch = Scratch::default();
    let ray = Ray { origin: -direction, direction };
    let interaction = SurfaceInteraction::new(&ray, DVec3::ZERO, -direction, 1.0, 1.0);
    let view = function.view(&interaction);
    let mut value = |root: usize, arguments: &[f64]| function.program.eval(root, arguments, &view, &mut scratch).ok();
    let down = call.call.to_scene.direction(DVec3::Z).normalize_or_zero();
    let angle = direction.dot(down).clamp(-1.0, 1.0).acos().to_degrees();
    let is_angle = |theta: f64| (theta - angle).abs() <= SAME_ANGLE;
    value(0, &[0.0]) == Some(0.0) && value(grid.axes.len(), &[]).is_some_and(is_angle)
}

/// Directions over the sphere (Roberts' R₂ sequence).
fn direction(index: u32) -> DVec3 {
    let [height, turn] =
        [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (f64::from(index + 1) * step).fract());
    let cosine = 2.0 * height - 1.0;
    let (sin_turn, cos_turn) = (std::f64::consts::TAU * turn).sin_cos();
    let sine = (1.0 - cosine * cosine).sqrt();
    DVec3::new(sine * cos_turn, sine * sin_turn, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(values: &[f32]) -> DataGrid {
        let axes = vec![
            Axis::Regular { first: 0.0, last: 90.0, count: 2 },
            Axis::Regular { first: 0.0, last: 90.0, count: values.len() / 2 },
        ];
        DataGrid { file: String::new(), axes, values: values.to_vec() }
    }

    #[test]
    fn a_table_is_zero_from_the_first_angle_without_light_in_all_rows() {
        let grid = table(&[3.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(last_angle(&grid), Some(45.0));
        for angle in [45.0, 46.0, 60.0, 90.0, 180.0] {
            assert_eq!(grid.value(&[30.0, angle]), 0.0, "{angle}");
        }
    }

    #[test]
    fn a_table_with_light_at_its_end_has_no_last_angle() {
        assert_eq!(last_angle(&table(&[1.0, 0.0, 0.0, 1.0, 0.5, 0.0])), None);
    }
}
