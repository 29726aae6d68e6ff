//! Rendering options for each quality, as in Radiance's `rad`.

use crate::variables::{Project, Variable};
use crate::{Cube, ProjectError};
use radsight_scene_generators::padded;

/// Low, medium or high.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    Low,
    Medium,
    High,
}

impl Level {
    /// The level of a variable whose value was checked.
    pub(crate) fn of(project: &Project, variable: Variable) -> Level {
        match project.value(variable).and_then(|value| value.chars().next()) {
            Some('M' | 'm') => Level::Medium,
            Some('H' | 'h') => Level::High,
            _ => Level::Low,
        }
    }

    fn pick<T>(self, [low, medium, high]: [T; 3]) -> T {
        match self {
            Level::Low => low,
            Level::Medium => medium,
            Level::High => high,
        }
    }

    /// Ratio of the width of the rendering to that of the picture.
    pub(crate) fn oversampling(self) -> u32 {
        self.pick([1, 2, 3])
    }
}

/// The zone of interest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Zone {
    pub(crate) is_exterior: bool,
    pub(crate) low: [f64; 3],
    pub(crate) extent: [f64; 3],
}

impl Zone {
    pub(crate) fn of(project: &Project) -> Result<Zone, ProjectError> {
        let expected = "I or E and xmin xmax ymin ymax zmin zmax";
        let wrong = || project.wrong(Variable::Zone, expected);
        let value = project.value(Variable::Zone).unwrap_or_default();
        let mut words = value.split_whitespace();
        let is_exterior = match words.next().and_then(|word| word.chars().next()) {
            Some('E' | 'e') => true,
            Some('I' | 'i') => false,
            _ => return Err(wrong()),
        };
        let numbers: Option<Vec<f64>> = words.take(6).map(|word| word.parse().ok()).collect();
        let Some([x0, x1, y0, y1, z0, z1]) = numbers.and_then(|numbers| <[f64; 6]>::try_from(numbers).ok()) else {
            return Err(wrong());
        };
        let extent = [x1 - x0, y1 - y0, z1 - z0];
        if extent.iter().all(|side| *side > 1e-6 && side.is_finite()) {
            Ok(Zone { is_exterior, low: [x0, y0, z0], extent })
        } else {
            Err(wrong())
        }
    }

    fn mean_side(&self) -> f64 {
        self.extent.iter().sum::<f64>() / 3.0
    }
}

/// Options of a rendering.
#[derive(Clone, Debug, Default)]
pub(crate) struct QualityOptions {
    /// Options of light transport: `-d… -s… -a… -l…`, each after a space.
    pub(crate) render: String,
    /// Options of pixel sampling: `-p…`, each after a space.
    pub(crate) pixels: String,
    /// Whether a small picture is rendered first to fill the ambient file.
    pub(crate) overture: bool,
}

impl QualityOptions {
    pub(crate) fn new(project: &Project, zone: &Zone, cube: &Cube) -> Result<QualityOptions, ProjectError> {
        let quality = Level::of(project, Variable::Quality);
        let detail = Level::of(project, Variable::Detail);
        let has_penumbras = project.value(Variable::Penumbras).is_some_and(|value| value.starts_with(['T', 't']));
        let shadows = if has_penumbras { Shadows::Soft } else { Shadows::Hard };
        let mut render = String::new();
        let map = |name: Variable| project.value(name).map(photon_map).unwrap_or_default();
        render.push_str(&map(Variable::GlobalMap));
        let pretest = detail.pick([64, 128, 256]) * quality.pick([1, 4, 16]);
        let resolution = detail.pick([8.0, 16.0, 32.0]) * quality.pick([1.0, 2.0, 4.0]);
        let resolution = (resolution * cube.size / zone.mean_side()) as i64;
        render.push_str(&format!(" -dp {pretest} -ar {resolution}"));
        if quality != Level::Low {
            let share = detail.pick([20.0, 40.0, 80.0]) * quality.pick([1.0, 1.0, 2.0]);
            render.push_str(&format!(" -ms {}", padded(zone.mean_side() / share, 0, 2)));
        }
        render.push_str(
            quality.pick([[" -ds 0", " -ds .4"], [" -ds .3", " -ds .2 -dj .9"], [" -ds .2", " -ds .1 -dj .9"]])
                [usize::from(has_penumbras)],
        );
        render.push_str(quality.pick([
            " -dt .1 -dc .5 -dr 0 -ss 0 -st .5",
            " -dt .07 -dc .7 -dr 1 -ss 1 -st .1",
            " -dt .04 -dc .9 -dr 3 -ss 16 -st .01",
        ]));
        let bounces = quality.pick([0, bounces(project), bounces(project) + 1]);
        if bounces != 0 || quality == Level::High {
            render.push_str(&format!(" -ab {bounces}"));
        }
        if let Some(file) = project.value(Variable::AmbientFile) {
            render.push_str(&format!(" -af {file}"));
        }
        let variability = Level::of(project, Variable::Variability);
        render.push_str(variability.pick(quality.pick([
            [" -aa .3 -ad 256", " -aa .25 -ad 512", " -aa .2 -ad 1024"],
            [" -aa .2 -ad 329 -as 42", " -aa .15 -ad 800 -as 128", " -aa .1 -ad 1536 -as 392"],
            [" -aa .125 -ad 512 -as 64", " -aa .1 -ad 1536 -as 768", " -aa .075 -ad 4096 -as 2048"],
        ])));
        let ambient = padded(ambient_value(project, zone), 0, 2).to_string();
        let supers = if quality == Level::Low { " -as 0" } else { "" };
        render.push_str(&format!("{supers} -av {ambient} {ambient} {ambient}"));
        render.push_str(quality.pick([" -lr 6 -lw .001", " -lr 8 -lw 1e-4", " -lr 12 -lw 5e-6"]));
        render.push_str(&map(Variable::CausticMap));
        let mut overture = bounces != 0 && project.value(Variable::AmbientFile).is_some();
        if let Some(more) = project.value(Variable::Render) {
            render.push_str(&format!(" {more}"));
            let accuracy = more.split_once("-aa ").and_then(|(_, rest)| rest.split_whitespace().next());
            overture &= accuracy.is_none_or(|word| word.parse().is_ok_and(|accuracy: f64| accuracy > 1e-6));
        }
        let mut pixels = pixels(quality, detail, shadows).to_owned();
        pixels.push_str(quality.pick([" -pt .16", " -pt .08", " -pt .04"]));
        pixels.push_str(&own_options(project, Variable::Rpict).1);
        Ok(QualityOptions { render, pixels, overture })
    }
}

/// The shadows of large lights (`PENUMBRAS`).
#[derive(Clone, Copy)]
enum Shadows {
    Soft,
    Hard,
}

fn pixels(quality: Level, detail: Level, shadows: Shadows) -> &'static str {
    match (quality, shadows) {
        (Level::Low, _) => detail.pick([" -ps 16", " -ps 8", " -ps 4"]),
        (Level::Medium, Shadows::Soft) => detail.pick([" -ps 4", " -ps 3", " -ps 2"]),
        (Level::Medium, Shadows::Hard) => detail.pick([" -ps 8", " -ps 6", " -ps 4"]),
        (Level::High, Shadows::Soft) => " -ps 1",
        (Level::High, Shadows::Hard) => detail.pick([" -ps 8", " -ps 5", " -ps 3"]),
    }
}

fn bounces(project: &Project) -> i64 {
    project.value(Variable::Indirect).and_then(|value| value.parse().ok()).unwrap_or(0)
}

/// The ambient value for an exposure: 0.18 is a medium grey.
fn ambient_value(project: &Project, zone: &Zone) -> f64 {
    let Some(exposure) = project.value(Variable::Exposure) else { return if zone.is_exterior { 10.0 } else { 0.01 } };
    let number: f64 = exposure.parse().unwrap_or(1.0);
    0.18 / if exposure.starts_with(['+', '-']) { number.exp2() } else { number }
}

/// The photon map option: its file, and its bandwidth if one is given.
fn photon_map(value: &str) -> String {
    let mut words = value.split_whitespace();
    let file = words.next().unwrap_or_default();
    match words.nth(1).filter(|bandwidth| bandwidth.parse::<i64>().is_ok_and(|bandwidth| bandwidth > 0)) {
        Some(bandwidth) => format!(" -ap {file} {bandwidth}"),
        None => format!(" -ap {file}"),
    }
}

/// The program that a variable names, if any, and its options, each after a space.
pub(crate) fn own_options(project: &Project, variable: Variable) -> (Option<String>, String) {
    let Some(value) = project.value(variable) else { return (None, String::new()) };
    if value.starts_with('-') {
        return (None, format!(" {value}"));
    }
    let (program, options) = value.split_once(' ').unwrap_or((value, ""));
    let options = if options.is_empty() { String::new() } else { format!(" {options}") };
    (Some(program.to_owned()), options)
}
