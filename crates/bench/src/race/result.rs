//! Results: runs by scene and program, and the time of each program to an error.

use super::accuracy::Accuracy;
use super::program::Team;
use super::reference::Reference;
use super::scene::Scene;
use crate::curve::{Curve, TimeTo};
use crate::table::Table;
use crate::taken::Taken;
use radsight_picture::Image;

/// The compared time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clock {
    /// Processor time of all threads: other processes have little influence.
    Processor,
    /// From start to end.
    Wall,
}

impl Clock {
    pub(crate) fn of(self, taken: &Taken) -> f64 {
        match self {
            Clock::Processor => taken.processor,
            Clock::Wall => taken.wall,
        }
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Clock::Processor => "processor time of all threads, without start and reading or translating the scene",
            Clock::Wall => "wall time, without start and reading or translating the scene",
        }
    }
}

/// A rendered picture with its settings.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) label: String,
    /// Cost without reading the scene.
    pub(crate) taken: Taken,
    pub(crate) accuracy: Accuracy,
    pub(crate) picture: Image<f32>,
}

/// The runs of a program's series.
#[derive(Clone, Debug)]
pub(crate) struct Entrant {
    pub(crate) team: Team,
    pub(crate) program: String,
    pub(crate) series: String,
    pub(crate) unbiased: bool,
    pub(crate) runs: Vec<Run>,
}

/// The results of a scene.
#[derive(Debug)]
pub(crate) struct SceneResult {
    pub(crate) scene: Scene,
    pub(crate) reference: Reference,
    /// Processor time of each program for reading the scene.
    pub(crate) read: String,
    pub(crate) entrants: Vec<Entrant>,
}

/// Errors at which times are compared.
const ERRORS: [f64; 3] = [0.05, 0.02, 0.01];

/// Error of ours at which pictures are shown side by side.
const SHOWN_ERROR: f64 = 0.05;

/// A measured, bounded or extrapolated time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Known {
    seconds: f64,
    /// `<` if even the cheapest run was better, `~` for extrapolation of an unbiased series by time
    /// ~ 1/error², else empty.
    mark: &'static str,
}

impl SceneResult {
    /// All programs that rendered pictures.
    pub(crate) fn programs(&self) -> Vec<String> {
        let mut programs: Vec<String> = Vec::new();
        for entrant in self.entrants.iter().filter(|entrant| !entrant.runs.is_empty()) {
            if !programs.contains(&entrant.program) {
                programs.push(entrant.program.clone());
            }
        }
        programs
    }

    fn runs_of(&self, team: Team) -> impl Iterator<Item = &Run> {
        self.entrants.iter().filter(move |entrant| entrant.team == team).flat_map(|entrant| &entrant.runs)
    }

    /// The most accurate run of a program within a time, or its fastest.
    pub(crate) fn best_within(&self, program: &str, seconds: f64, clock: Clock) -> Option<&Run> {
        let runs =
            || self.entrants.iter().filter(|entrant| entrant.program == program).flat_map(|entrant| &entrant.runs);
        let within = runs().filter(|run| clock.of(&run.taken) <= seconds);
        let fastest = || runs().min_by(|a, b| clock.of(&a.taken).total_cmp(&clock.of(&b.taken)));
        within.min_by(|a, b| a.accuracy.error.total_cmp(&b.accuracy.error)).or_else(fastest)
    }

    /// The time of our first run that is accurate enough to be shown.
    pub(crate) fn equal_time(&self, clock: Clock) -> f64 {
        let good = self.runs_of(Team::Radsight).filter(|run| run.accuracy.error <= SHOWN_ERROR);
        let fastest = good.map(|run| clock.of(&run.taken)).fold(f64::INFINITY, f64::min);
        if fastest.is_finite() { fastest } else { 1.0 }
    }

    /// The smallest time of some programs to an error.
    fn time_to(&self, team: Team, error: f64, clock: Clock) -> Option<Known> {
        let point = |run: &Run| (run.accuracy.error, clock.of(&run.taken));
        match Curve::new(self.runs_of(team).map(point)).time_to(error) {
            TimeTo::Interpolated(seconds) => return Some(Known { seconds, mark: "" }),
            TimeTo::AtMost(seconds) => return Some(Known { seconds, mark: "<" }),
            TimeTo::NotReached => {}
        }
        let unbiased = self.entrants.iter().filter(|entrant| entrant.unbiased && entrant.team == team);
        let last = unbiased.filter_map(|entrant| entrant.runs.last().map(point)).filter(|(found, _)| *found > 0.0);
        let guesses = last.map(|(found, seconds)| seconds * (found / error).powi(2).max(1.0));
        guesses.min_by(f64::total_cmp).map(|seconds| Known { seconds, mark: "~" })
    }

    /// One line per run; values with commas are quoted.
    pub(crate) fn to_csv(&self) -> String {
        let mut text = String::new();
        for entrant in &self.entrants {
            for Run { label, taken, accuracy, .. } in &entrant.runs {
                text.push_str(&format!(
                    "{},{},\"{}\",\"{label}\",{},{},{},{},{},{},{},{}\n",
                    self.scene.name,
                    entrant.program,
                    entrant.series,
                    taken.wall,
                    taken.processor,
                    taken.peak,
                    accuracy.error,
                    accuracy.percentile_95,
                    accuracy.worst_block,
                    accuracy.bias,
                    self.reference.noise,
                ));
            }
        }
        text
    }
}

/// The columns of [`SceneResult::to_csv`].
pub(crate) const CSV_HEADING: &str = "scene,program,series,setting,wall_s,processor_s,peak_mib,error_less_reference_noise,\
percentile_95,worst_block,bias,reference_noise\n";

/// The table of all scenes.
#[derive(Debug)]
pub(crate) struct Summary {
    table: Table,
    /// Ratios of real Radiance's and Mitsuba's time to ours at each error.
    ratios: [Vec<[Option<f64>; 2]>; 3],
}

impl Summary {
    pub(crate) fn new(results: &[SceneResult], clock: Clock) -> Summary {
        let heading = ["scene", "error %", "radsight s", "Radiance s", "times", "Mitsuba s", "times"];
        let mut summary = Summary { table: Table::new(&heading, 1), ratios: Default::default() };
        for result in results {
            for (at, error) in ERRORS.into_iter().enumerate() {
                let own = result.time_to(Team::Radsight, error, clock);
                let real = result.time_to(Team::Radiance, error, clock);
                let mitsuba = result.time_to(Team::Mitsuba, error, clock);
                let ratio = |peer: Option<Known>| Some(peer?.seconds / own?.seconds);
                let cell = |known: Option<Known>| {
                    known.map_or("-".to_owned(), |known| format!("{}{:.3}", known.mark, known.seconds))
                };
                let times = |peer: Option<Known>| ratio(peer).map_or("-".to_owned(), |ratio| format!("{ratio:.1}"));
                summary.ratios[at].push([ratio(real), ratio(mitsuba)]);
                summary.table.push(vec![
                    result.scene.name.to_owned(),
                    format!("{:.0}", 100.0 * error),
                    cell(own),
                    cell(real),
                    times(real),
                    cell(mitsuba),
                    times(mitsuba),
                ]);
            }
        }
        summary
    }

    /// The table, and geometric means.
    pub(crate) fn to_text(&self) -> String {
        let mut text = self.table.to_text();
        for (ratios, error) in self.ratios.iter().zip(ERRORS) {
            for (peer, name) in ["real Radiance", "Mitsuba"].iter().enumerate() {
                let logarithms: Vec<f64> = ratios.iter().filter_map(|ratio| ratio[peer]).map(f64::ln).collect();
                if !logarithms.is_empty() {
                    let mean = (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp();
                    let scenes = logarithms.len();
                    text.push_str(&format!(
                        "geometric mean at {:.0} %: {name} takes {mean:.1} times as long ({scenes} scenes)\n",
                        100.0 * error
                    ));
                }
            }
        }
        text.push_str(
            "< even the cheapest run was more accurate; ~ a series without bias continued by time ~ 1/error²\n",
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The series of a team, without bias.
    fn entrant(team: Team, points: &[(f64, f64)]) -> Entrant {
        let runs = points.iter().map(|(error, seconds)| Run {
            label: String::new(),
            taken: Taken { processor: *seconds, wall: *seconds, peak: 1.0 },
            accuracy: Accuracy { error: *error, percentile_95: 0.0, worst_block: 0.0, bias: 0.0 },
            picture: Image::filled(1, 1, 3, 1.0).unwrap(),
        });
        Entrant { team, program: String::new(), series: "s".to_owned(), unbiased: true, runs: runs.collect() }
    }

    fn result(entrants: Vec<Entrant>) -> SceneResult {
        let image = Image::filled(1, 1, 3, 1.0).unwrap();
        let reference = Reference { image, noise: 0.0, rays: 1, check: String::new() };
        SceneResult { scene: Scene::new("s", "", Path::new("."), "", "", 0), reference, read: String::new(), entrants }
    }

    #[test]
    fn a_series_without_bias_is_continued_and_one_with_bias_is_not() {
        let result = result(vec![
            entrant(Team::Radiance, &[(0.4, 1.0), (0.2, 4.0)]),
            Entrant { unbiased: false, ..entrant(Team::Radiance, &[(0.3, 0.5)]) },
            entrant(Team::Radsight, &[(0.05, 1.0), (0.005, 100.0)]),
        ]);
        let time = result.time_to(Team::Radiance, 0.05, Clock::Processor);
        assert_eq!(time.map(|known| known.mark), Some("~"));
        assert!((time.unwrap().seconds - 64.0).abs() < 1e-9);
        let text = Summary::new(&[result], Clock::Processor).to_text();
        assert!(text.contains("geometric mean at 5 %: real Radiance takes 64.0 times"), "{text}");
    }
}
