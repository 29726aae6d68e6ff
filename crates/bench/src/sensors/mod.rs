//! `radsight-bench sensors`: a few sensor points, compared with real Radiance.
//!
//! Both programs compute the same sensors with the same options several times, each time with other
//! random numbers. The truth is the mean of runs that share nothing between points.

mod setup;
mod spread;

use crate::args::Sensors;
use crate::capture::print;
use crate::cost::measure;
use crate::error::BenchError;
use crate::figure::read;
use crate::machine;
use crate::race::put;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::run::middle;
use crate::table::Table;
use crate::taken::taken;
use setup::{Setup, setups};
use spread::Spread;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, SystemTime};

/// Independent paths: nothing is shared, and no path is cut off.
const TRUTH: &str = "-aa 0 -ad 40000 -as 0 -lw 1e-9";

/// First seed of the truth, so that it shares no random numbers with measured runs.
const FIRST_SEED: u32 = 1_000_000;

const HEADING: [&str; 6] = ["set-up", "program", "mean %", "±", "deviation %", "processor s"];

/// Measures all set-ups and prints a table.
pub(crate) fn run(arguments: &Sensors) -> Result<(), BenchError> {
    let folder = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let radiance = if arguments.alone { Err("left out".to_owned()) } else { Radiance::find() };
    print(&machine::describe(
        &Radsight::find(),
        &radiance.as_ref().map(|found| found.version().to_owned()).map_err(Clone::clone),
    ));
    let mut table = Table::new(&HEADING, 2);
    for setup in setups() {
        let bench = Bench { arguments, setup: &setup, folder: folder.path() };
        for row in bench.measure(radiance.as_ref().ok())? {
            print(&format!("{}\n", row.join("  ")));
            table.push(row);
        }
    }
    print(&format!("\n{}", table.to_text()));
    Ok(())
}

/// The measurement of one set-up.
struct Bench<'a> {
    arguments: &'a Sensors,
    setup: &'a Setup,
    folder: &'a Path,
}

impl Bench<'_> {
    /// A row of the table for each program.
    fn measure(&self, radiance: Option<&Radiance>) -> Result<Vec<Vec<String>>, BenchError> {
        put(&self.folder.join("scene.rad"), self.setup.scene.as_bytes())?;
        let numbers = |vector: &glam::DVec3| format!("{} {} {}", vector.x, vector.y, vector.z);
        let lines = self.setup.sensors.iter().map(|sensor| sensor.each_ref().map(numbers).join(" ") + "\n");
        put(&self.folder.join("points"), lines.collect::<String>().as_bytes())?;
        let ours = |options: &str, seed: u32| {
            let mut command = Radsight::find().command(&["rtrace", "-h", "-I"]);
            command.args(options.split_whitespace()).args(["--seed", &seed.to_string(), "scene.rad"]);
            command
        };
        let (truth, _) = self.repeat(self.arguments.truth, |run| {
            let bounces = self.arguments.options.split_whitespace().skip_while(|word| *word != "-ab").take(2);
            ours(&format!("{} {TRUTH}", bounces.collect::<Vec<_>>().join(" ")), FIRST_SEED + run)
        })?;
        let (own, seconds) = self.repeat(self.arguments.repeat, |run| ours(&self.arguments.options, run))?;
        let mut rows = vec![self.row("radsight", &own, &truth, seconds)];
        if let Some(radiance) = radiance {
            let (real, seconds) = self.real(radiance)?;
            rows.push(self.row("real Radiance", &real, &truth, seconds));
        }
        Ok(rows)
    }

    /// The result of real Radiance.
    fn real(&self, radiance: &Radiance) -> Result<(Spread, f64), BenchError> {
        let octree = self.folder.join("scene.oct");
        let mut oconv = radiance.command("oconv");
        measure(oconv.arg(self.folder.join("scene.rad")), None, Some(&octree), "")?;
        self.repeat(self.arguments.repeat, |_| {
            // Its random numbers depend on the second in which it starts.
            wait_for_another_second();
            let mut command = radiance.command("rtrace");
            command.args(["-h", "-I"]).args(self.arguments.options.split_whitespace()).arg("scene.oct");
            command
        })
    }

    /// The results of some runs, and the median of their processor times.
    fn repeat(&self, runs: u32, command: impl Fn(u32) -> Command) -> Result<(Spread, f64), BenchError> {
        let (points, output) = (self.folder.join("points"), self.folder.join("values"));
        let (mut values, mut seconds) = (Vec::new(), Vec::new());
        for run in 0..runs {
            let took = taken(&mut command(run), self.folder, Some(&points), Some(&output))?;
            seconds.push(took.processor);
            values.push(luminances(&String::from_utf8_lossy(&read(&output)?)));
        }
        let unlike = || BenchError::Read { path: output.clone(), reason: "a sensor has no value".to_owned() };
        Ok((Spread::new(&values).ok_or_else(unlike)?, middle(seconds).unwrap_or(f64::NAN)))
    }

    fn row(&self, program: &str, found: &Spread, truth: &Spread, seconds: f64) -> Vec<String> {
        let [excess, uncertainty] = found.excess(truth).map(|share| 100.0 * share);
        vec![
            self.setup.name.to_owned(),
            program.to_owned(),
            format!("{excess:+.2}"),
            format!("{uncertainty:.2}"),
            format!("{:.2}", 100.0 * found.deviation()),
            format!("{seconds:.2}"),
        ]
    }
}

/// One grey value per line of three numbers: all set-ups are grey.
fn luminances(text: &str) -> Vec<f64> {
    text.lines().filter_map(|line| line.split_whitespace().nth(1)?.parse().ok()).collect()
}

fn wait_for_another_second() {
    let second = || SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |time| time.as_secs());
    let now = second();
    while second() == now {
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[cfg(test)]
mod tests {
    use super::luminances;

    #[test]
    fn a_line_is_a_sensor() {
        assert_eq!(luminances("1.0\t2.5\t3\t\n4 5 6\n"), [2.5, 5.0]);
    }
}
