//! What a capture leaves out, and what it does not reach. A series says it once for all pictures.

use crate::failure::say;
use radsight_capture::{Exposure, Stop};
use radsight_pinhole::{PinholeCamera, PinholeModel, Rays, fresnel_number};
use radsight_render::{Ray, RenderPlan};

/// Diffraction is mentioned when the pinhole's Fresnel number is below this.
const DIFFRACTION_MATTERS: f64 = 3.0;

/// An error is missed where its estimate is more than so many times the requested one.
const MISSED: f64 = 1.05;

/// Rows and columns of the rays that measure how far the scene is.
const ACROSS: u32 = 5;

/// Names of a series that a note lists.
const MOST_NAMES: usize = 5;

/// A note on one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Note {
    /// `-ab 0`.
    NoInterreflection,
    /// Each ray draws from the whole diffraction pattern, for this reason.
    WholePattern(&'static str),
    /// This small Fresnel number of a pinhole without diffraction.
    Diffraction(f64),
    /// This estimated error, due to rays that pixels share.
    SharedError(f64),
    /// This estimated error with the maximum number of rays.
    ErrorAtMostRays(f64),
}

impl Note {
    /// The note as a sentence.
    pub(super) fn sentence(&self) -> String {
        match self {
            Note::NoInterreflection => {
                "light between diffuse surfaces is left out (-ab 0); -ab 8 follows it".to_owned()
            }
            Note::WholePattern(reason) => {
                format!("each ray draws from the whole diffraction pattern, which takes many more rays: {reason}")
            }
            Note::Diffraction(number) => format!(
                "the pinhole's Fresnel number is {number:.2}: diffraction changes the image; pinhole_model = \"diffraction\" computes it"
            ),
            Note::SharedError(error) => format!(
                "the estimated error is {:.3} %, more than requested; what is left is due to rays that pixels share, and no number of rays lowers it",
                100.0 * error
            ),
            Note::ErrorAtMostRays(error) => format!(
                "the estimated error is {:.3} %, more than requested; every pixel has its maximum number of rays",
                100.0 * error
            ),
        }
    }

    /// Whether two notes are one line of a series.
    fn is_like(&self, other: &Note) -> bool {
        match (self, other) {
            (Note::WholePattern(a), Note::WholePattern(b)) => a == b,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }

    /// The worse of two notes of a line.
    fn worse(self, other: Note) -> Note {
        match (self, other) {
            (Note::Diffraction(a), Note::Diffraction(b)) => Note::Diffraction(a.min(b)),
            (Note::SharedError(a), Note::SharedError(b)) => Note::SharedError(a.max(b)),
            (Note::ErrorAtMostRays(a), Note::ErrorAtMostRays(b)) => Note::ErrorAtMostRays(a.max(b)),
            _ => self,
        }
    }
}

/// What the options leave out.
pub(super) fn left_out(plan: &RenderPlan) -> Option<Note> {
    plan.leaves_out_interreflection().then_some(Note::NoInterreflection)
}

/// What matters for this camera.
pub(super) fn of_camera(plan: &RenderPlan, camera: &PinholeCamera) -> Vec<Note> {
    let pattern = camera.whole_pattern_reason().map(Note::WholePattern);
    let is_geometric = camera.pinhole_model() == PinholeModel::Finite
        && camera.lens().is_none()
        && camera.telecentric_lens().is_none();
    let number = is_geometric.then(|| fresnel_number(camera, distance_m(plan, camera)?)).flatten();
    let diffraction = number.filter(|number| *number < DIFFRACTION_MATTERS).map(Note::Diffraction);
    pattern.into_iter().chain(diffraction).collect()
}

/// The error that an exposure did not reach.
pub(super) fn missed(exposure: &Exposure, asked: f64) -> Option<Note> {
    let error = exposure.estimated_error.filter(|error| *error > MISSED * asked)?;
    Some(match exposure.stopped {
        Some(Stop::Shared) => Note::SharedError(error),
        _ => Note::ErrorAtMostRays(error),
    })
}

/// Why a diffracting camera needs many rays; `None` where it does not.
pub(super) fn whole_pattern_reason(camera: &PinholeCamera) -> Option<String> {
    camera.whole_pattern_reason().map(|reason| Note::WholePattern(reason).sentence())
}

/// The distance of what the camera sees, along its axis, metres: the median over the picture.
/// `None` where it sees no surface.
fn distance_m(plan: &RenderPlan, camera: &PinholeCamera) -> Option<f64> {
    let rays = Rays::new(camera, 1, 0);
    let place = |index: u32, count: u32| u64::from(count) * u64::from(2 * index + 1) / u64::from(2 * ACROSS);
    let mut distances: Vec<f64> = (0..ACROSS * ACROSS)
        .filter_map(|index| {
            let (column, row) = (place(index % ACROSS, camera.columns()), place(index / ACROSS, camera.rows()));
            let ray = rays.ray_through(row * u64::from(camera.columns()) + column, [0.5; 2], [0.0; 2])?;
            let distance = plan.distance_behind_panes(&Ray::new(ray.origin, ray.direction)?)?;
            let depth = distance * camera.scene_unit_m() * ray.direction.dot(camera.direction());
            (depth > 0.0).then_some(depth)
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied()
}

/// Notes on the pictures of a series, one line for each kind.
#[derive(Debug, Default)]
pub(super) struct SeriesNotes {
    pictures: usize,
    lines: Vec<SeriesNote>,
}

/// One line: the worst case, and the pictures.
#[derive(Debug)]
struct SeriesNote {
    worst: Note,
    pictures: usize,
    /// The first of them.
    names: Vec<String>,
}

impl SeriesNotes {
    /// Adds the notes on a picture.
    pub(super) fn add(&mut self, name: &str, notes: Vec<Note>) {
        self.pictures += 1;
        for note in notes {
            match self.lines.iter_mut().find(|line| line.worst.is_like(&note)) {
                Some(line) => line.add(name, note),
                None => {
                    self.lines.push(SeriesNote { worst: note, pictures: 1, names: vec![name.to_owned()] });
                }
            }
        }
    }

    /// The lines.
    pub(super) fn lines(&self) -> impl Iterator<Item = String> {
        self.lines.iter().map(|line| line.sentence(self.pictures))
    }
}

impl SeriesNote {
    fn add(&mut self, name: &str, note: Note) {
        self.worst = self.worst.worse(note);
        self.pictures += 1;
        if self.names.len() < MOST_NAMES {
            self.names.push(name.to_owned());
        }
    }

    fn sentence(&self, of: usize) -> String {
        let more = if self.pictures > self.names.len() { ", …" } else { "" };
        let which = match self.pictures == of {
            true if of == 1 => format!("picture {}", self.names.join(", ")),
            true => format!("all {of} pictures"),
            false => format!("{} of {of} pictures ({}{more})", self.pictures, self.names.join(", ")),
        };
        let what = self.worst.sentence();
        match self.worst {
            Note::NoInterreflection | Note::WholePattern(_) => format!("{which}: {what}"),
            _ if self.pictures == 1 => format!("{which}: {what}"),
            _ => format!("{which}, the worst of which: {what}"),
        }
    }
}

/// Prints the notes on one picture.
pub(super) fn say_each(notes: impl IntoIterator<Item = Note>) {
    say_all(notes.into_iter().map(|note| note.sentence()));
}

/// Prints notes.
pub(super) fn say_all(sentences: impl IntoIterator<Item = String>) {
    for sentence in sentences {
        say(&format!("radsight: note: {sentence}\n"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_names_its_first_pictures_and_its_worst_error() {
        let mut notes = SeriesNotes::default();
        for picture in 0..9 {
            let missed = (picture > 1).then_some(Note::ErrorAtMostRays(0.01 * f64::from(picture)));
            notes.add(&picture.to_string(), missed.into_iter().collect());
        }
        let lines: Vec<String> = notes.lines().collect();
        assert_eq!(lines.len(), 1);
        let expected = "7 of 9 pictures (2, 3, 4, 5, 6, …), the worst of which: the estimated error is 8.000 %";
        assert!(lines[0].starts_with(expected), "{}", lines[0]);
    }
}
