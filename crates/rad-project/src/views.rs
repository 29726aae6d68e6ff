//! Views: those of the file, and standard ones such as `Xl`, which are derived from the zone.

use crate::ProjectError;
use crate::quality::Zone;
use crate::variables::{Project, Variable};
use radsight_scene_generators::padded;

/// A picture's name and view options.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NamedView {
    pub(crate) name: String,
    pub(crate) options: String,
}

/// The requested views: all, or the one that the command line selects.
pub(crate) fn views(project: &Project, zone: &Zone, selected: Option<&str>) -> Result<Vec<NamedView>, ProjectError> {
    let listed = project.all(Variable::View);
    let numbered = |number: usize| -> Result<Option<NamedView>, ProjectError> {
        let Some(view) = listed.get(number) else { return Ok(None) };
        let first = view.split_whitespace().next().unwrap_or_default();
        let name = if view.starts_with('-') { (number + 1).to_string() } else { first.to_owned() };
        Ok(options(project, zone, view)?.map(|options| NamedView { name, options }))
    };
    let Some(selected) = selected else {
        let mut views = Vec::new();
        for number in 0..listed.len() {
            // As in Radiance, the list ends at a view without options.
            let Some(view) = numbered(number)? else { break };
            views.push(view);
        }
        return Ok(views);
    };
    if let Ok(number) = selected.trim().parse::<usize>() {
        return Ok(numbered(number.wrapping_sub(1))?.into_iter().collect());
    }
    if selected.starts_with('-') {
        return Ok(vec![NamedView { name: "0".to_owned(), options: selected.to_owned() }]);
    }
    let name = selected.split_whitespace().next().unwrap_or_default();
    let view = listed.iter().find(|view| view.split_whitespace().next() == Some(name)).map_or(selected, String::as_str);
    let options = options(project, zone, view)?;
    Ok(options.into_iter().map(|options| NamedView { name: name.to_owned(), options }).collect())
}

/// The up vectors by axis, −3 to 3; 0 for none.
const UP: [&str; 7] = ["-vu 0 0 -1", "-vu 0 -1 0", "-vu -1 0 0", "-vu 0 0 1", "-vu 1 0 0", "-vu 0 1 0", "-vu 0 0 1"];

fn up_vector(axis: i32) -> &'static str {
    UP[(axis + 3).clamp(0, 6) as usize]
}

/// The options of a view; `None` for a name that is no standard view.
fn options(project: &Project, zone: &Zone, view: &str) -> Result<Option<String>, ProjectError> {
    if view.starts_with('-') {
        return Ok(Some(view.to_owned()));
    }
    let up = up_axis(project)?;
    let (name, more) = view.split_once(' ').unwrap_or((view, ""));
    if let Some(standard) = standard_view(zone, name, up) {
        return Ok(Some(if more.is_empty() { standard } else { format!("{standard} {more}") }));
    }
    if more.is_empty() {
        return Ok(None);
    }
    Ok(Some(if up == 0 { more.to_owned() } else { format!("{} {more}", up_vector(up)) }))
}

/// The axis that the variable `UP` names, 1 to 3, negative if it points down; 0 for none.
fn up_axis(project: &Project) -> Result<i32, ProjectError> {
    let Some(value) = project.value(Variable::Up) else { return Ok(0) };
    let axis = match value.trim_start_matches(['+', '-']).chars().next() {
        Some('X' | 'x') => 1,
        Some('Y' | 'y') => 2,
        Some('Z' | 'z') => 3,
        _ => return Err(project.wrong(Variable::Up, "X, Y or Z, with a sign or without")),
    };
    Ok(if value.starts_with('-') { -axis } else { axis })
}

/// A standard view such as `XYa`: from the sides of the zone given by capital letters (the far end
/// of an axis) or small ones (the near end), with the view type of the last letter.
fn standard_view(zone: &Zone, name: &str, up: i32) -> Option<String> {
    let mut letters = name.chars().peekable();
    let mut side = |far: char| {
        let sign = match letters.peek() {
            Some(letter) if *letter == far => 1.0,
            Some(letter) if *letter == far.to_ascii_lowercase() => -1.0,
            _ => return 0.0,
        };
        letters.next();
        sign
    };
    let sides = [side('X'), side('Y'), side('Z')];
    let kind = letters.next().unwrap_or('v');
    if !"vlahsc".contains(kind) || letters.next().is_some() || sides == [0.0; 3] {
        return None;
    }
    let reach = if zone.is_exterior { 2.0 } else { 0.45 };
    let g = |value: f64| padded(value, 0, 3).to_string();
    let from: Vec<String> =
        (0..3).map(|axis| g(zone.low[axis] + zone.extent[axis] * (0.5 + sides[axis] * reach))).collect();
    let towards: Vec<String> = (0..3).map(|axis| g(0.0 - sides[axis] * zone.extent[axis])).collect();
    // A view along the up axis needs another up vector.
    let [x, y, z] = sides.map(|side| side != 0.0);
    let up = match up.abs() {
        1 if !(y || z) => 3,
        2 if !(x || z) => 1,
        0 | 3 if !(x || y) => 2,
        _ => up,
    };
    let size = match kind {
        'v' => "-vh 45 -vv 45".to_owned(),
        'l' => {
            let diagonal = g(zone.extent.iter().map(|side| side * side).sum::<f64>().sqrt());
            format!("-vh {diagonal} -vv {diagonal}")
        }
        'c' => "-vh 180 -vv 90".to_owned(),
        _ => "-vh 180 -vv 180".to_owned(),
    };
    let (from, towards) = (from.join(" "), towards.join(" "));
    Some(format!("-vt{kind} -vp {from} -vd {towards} {} {size}", up_vector(up)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_from_above_has_another_up() {
        let zone = Zone { is_exterior: true, low: [0.0, 1.0, 2.0], extent: [2.0, 4.0, 8.0] };
        let view = standard_view(&zone, "Zl", 0).unwrap();
        assert_eq!(view, "-vtl -vp 1 3 22 -vd 0 0 -8 -vu 0 1 0 -vh 9.17 -vv 9.17");
        assert_eq!(standard_view(&zone, "Zq", 0), None);
        assert_eq!(standard_view(&zone, "v", 0), None);
    }
}
