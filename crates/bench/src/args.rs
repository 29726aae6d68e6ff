//! The command line.

use crate::figure::Figure;
use crate::generated::SQUARES;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Measures time and error of radsight and real Radiance
#[derive(Debug, Parser)]
#[command(name = "radsight-bench", version, about)]
pub(crate) struct Program {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The measurement to run.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Captures of the paper's figures: time, error against the truth, and Radiance's time for the
    /// same error
    Capture(Capture),
    /// Pictures of many scenes: time to an error beside real Radiance and Mitsuba 3, as a table, a
    /// CSV file and a page
    Race(Race),
    /// Other people's rpict commands beside real Radiance: processor time, and how near the
    /// pictures are to the truth
    Commands(Commands),
    /// Random rooms: whether rpict --error reaches the requested error, with references of
    /// independent paths
    Rooms(Rooms),
    /// Few sensor points: mean, deviation over seeds and time of rtrace -I, with real Radiance's
    Sensors(Sensors),
    /// Incoherent rays in a million triangles: first and any hits per second, with Embree and real
    /// rtrace
    Rays(Rays),
    /// Growth of time and memory with triangles, lights, pixels and threads, with other programs
    Scaling(Scaling),
    /// Scenes of a million triangles and of nested arrays: time and memory from text to a
    /// hierarchy, with oconv
    Load(Load),
    /// Runs a program and prints its processor time and wall time in s and its peak memory in MiB
    #[command(hide = true)]
    Cost {
        /// Limit of processor time, seconds
        #[arg(long, value_name = "SECONDS")]
        limit: Option<u64>,
        /// Standard input of the program
        #[arg(long, value_name = "FILE")]
        input: Option<PathBuf>,
        /// File for its standard output
        #[arg(long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// The program and its arguments
        #[arg(required = true, trailing_var_arg = true)]
        words: Vec<String>,
    },
    /// The cost of a reflectance model in a plugin, compared with the built-in one
    Plugin(Plugin),
}

/// `radsight-bench commands`.
#[derive(Debug, Args)]
pub(crate) struct Commands {
    /// Folders with a script run.sh, which writes its files to $OUT and finds Radiance's function
    /// files in $RADLIB; or with projects of rad; or folders of folders with scripts
    #[arg(required = true, value_name = "FOLDER")]
    pub(crate) folders: Vec<PathBuf>,
    /// Replace an assignment of all projects of rad; without a value, remove it
    #[arg(long = "rad", value_name = "VARIABLE=VALUE", default_values = ["RESOLUTION=128", "AMBFILE=", "PGMAP=", "PCMAP="])]
    pub(crate) assignments: Vec<String>,
    /// Renderings of each picture by each program, in turns; times are medians. Long ones are
    /// rendered once
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Processor time for the truth of a picture, seconds; an existing truth is refined
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    pub(crate) truth_budget: f64,
    /// Rms error of blocks at which a truth is sufficient
    #[arg(long, value_name = "SHARE", default_value_t = 0.005)]
    pub(crate) truth_noise: f64,
    /// Folder of prepared scenes, pictures and truths, which are used again [default: bench in the
    /// folder above this program's]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

/// `radsight-bench rooms`.
#[derive(Debug, Args)]
pub(crate) struct Rooms {
    /// Seeds of the rooms, from A to B
    #[arg(long, value_name = "A..B", default_value = "1..20", value_parser = crate::rooms::seeds)]
    pub(crate) seeds: (u64, u64),
    /// Requested relative errors
    #[arg(long, value_name = "E,…", value_delimiter = ',', default_values_t = [0.1, 0.05, 0.02])]
    pub(crate) errors: Vec<f64>,
    /// Limit of processor time of rpict for a picture, seconds (its --time-limit); unlimited by
    /// default
    #[arg(long, value_name = "SECONDS")]
    pub(crate) limit: Option<f64>,
    /// Columns of the pictures; rows are three quarters of them
    #[arg(long, value_name = "N", default_value_t = 48)]
    pub(crate) columns: usize,
    /// Processor time for a room's references, seconds; existing references are refined
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    pub(crate) reference_budget: f64,
    /// Also render every room with real Radiance at increasing quality, for the time to the same
    /// error
    #[arg(long)]
    pub(crate) beside: bool,
    /// Limit of processor time for one of its pictures, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    pub(crate) beside_limit: u64,
    /// Write scenes, views and options, print their folders, and exit
    #[arg(long)]
    pub(crate) scenes_only: bool,
    /// Folder of rooms and references [default: bench in the folder above this program's]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

/// `radsight-bench sensors`.
#[derive(Debug, Args)]
pub(crate) struct Sensors {
    /// Runs of each program, each with its own random numbers
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) repeat: u32,
    /// Runs of independent paths whose mean is the truth
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) truth: u32,
    /// Options of both programs
    #[arg(
        long,
        value_name = "OPTIONS",
        allow_hyphen_values = true,
        default_value = "-ab 2 -aa .1 -ar 256 -ad 2048 -as 256"
    )]
    pub(crate) options: String,
    /// Omit real Radiance
    #[arg(long)]
    pub(crate) alone: bool,
}

/// `radsight-bench race`.
#[derive(Debug, Args)]
pub(crate) struct Race {
    /// Names of scenes; all by default
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub(crate) scenes: Vec<String>,
    /// List the scenes and exit
    #[arg(long)]
    pub(crate) list: bool,
    /// Limit of processor time of a run, seconds: a program's series of increasing quality ends
    /// with the first run that exceeds it
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0)]
    pub(crate) budget: f64,
    /// Processor time after which another program is stopped, with its series, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 120)]
    pub(crate) limit: u64,
    /// Processor time for a scene's reference, seconds; an existing reference is refined
    #[arg(long, value_name = "SECONDS", default_value_t = 120.0)]
    pub(crate) reference_budget: f64,
    /// Relative noise at which a reference is sufficient
    #[arg(long, value_name = "SHARE", default_value_t = 0.003)]
    pub(crate) reference_noise: f64,
    /// Omit the other programs
    #[arg(long)]
    pub(crate) alone: bool,
    /// Compare wall time instead of processor time
    #[arg(long)]
    pub(crate) wall: bool,
    /// Folder of the page, the CSV file and the references [default: bench in the folder above this
    /// program's]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
    /// Repository with the scenes [default: the one from which this program was built]
    #[arg(long, value_name = "DIR")]
    pub(crate) repo: Option<PathBuf>,
}

/// `radsight-bench plugin`.
#[derive(Debug, Args)]
pub(crate) struct Plugin {
    /// Rays per pixel
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) samples: u32,
    /// Repetitions of each capture; the smallest time is used
    #[arg(long, value_name = "R", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Repository with the scenes [default: the one from which this program was built]
    #[arg(long, value_name = "DIR")]
    pub(crate) repo: Option<PathBuf>,
}

/// `radsight-bench capture`.
#[derive(Debug, Args)]
pub(crate) struct Capture {
    /// Figures to capture
    #[arg(value_name = "FIGURE", default_values = ["t8", "t9", "t10", "t11", "t13", "t14"])]
    pub(crate) figures: Vec<Figure>,
    /// Rays per pixel of radsight's captures
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4, 8, 16, 32, 64, 128, 256],
          value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) samples: Vec<u32>,
    /// Requested errors of radsight, relative to the mean exposure
    #[arg(long, value_name = "E,…", value_delimiter = ',', default_values_t = [0.02, 0.01, 0.005])]
    pub(crate) errors: Vec<f64>,
    /// Repetitions of each capture of radsight, each with another seed; times and errors are
    /// medians
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Rays per pixel through real rtrace
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4],
          value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) radiance_samples: Vec<u32>,
    /// Also trace 16 rays per pixel through real rtrace, which takes minutes per figure
    #[arg(long)]
    pub(crate) long: bool,
    /// Omit real Radiance
    #[arg(long)]
    pub(crate) alone: bool,
    /// Also write every run as a line of comma-separated values
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Repository with the scenes and the truth [default: the one from which this program was
    /// built]
    #[arg(long, value_name = "DIR")]
    pub(crate) repo: Option<PathBuf>,
}

/// `radsight-bench rays`.
#[derive(Debug, Args)]
pub(crate) struct Rays {
    /// Number of rays
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) rays: u32,
    /// Squares along each side of the terrain; each is two triangles
    #[arg(long, value_name = "N", default_value_t = SQUARES, value_parser = clap::value_parser!(u32).range(1..=4000))]
    pub(crate) squares: u32,
    /// Repetitions of each program; rates are those of the fastest, ratios are medians over the
    /// repetitions
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
}

/// `radsight-bench scaling`.
#[derive(Debug, Args)]
pub(crate) struct Scaling {
    /// Largest number of triangles
    #[arg(long, value_name = "N", default_value_t = 1e7)]
    pub(crate) triangles: f64,
    /// Largest expected processor time of a run of another program, seconds: its series ends before
    /// it
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub(crate) budget: f64,
    /// Repetitions of each program; medians are used
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Omit the other programs
    #[arg(long)]
    pub(crate) alone: bool,
    /// CSV file, which `race` includes in its page [default: as for race]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

/// `radsight-bench load`.
#[derive(Debug, Args)]
pub(crate) struct Load {
    /// Repetitions of each program; medians are printed
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
}

impl Capture {
    /// Rays per pixel through real rtrace, ascending.
    pub(crate) fn radiance_samples(&self) -> Vec<u32> {
        let mut samples = self.radiance_samples.clone();
        if self.long {
            samples.push(16);
        }
        samples.sort_unstable();
        samples.dedup();
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Program::command().debug_assert();
    }

    #[test]
    fn a_long_run_adds_sixteen_rays_once() {
        let parse = |words: &[&str]| match Program::parse_from(words).command {
            Command::Capture(capture) => capture.radiance_samples(),
            _ => unreachable!("the words ask for a capture"),
        };
        assert_eq!(parse(&["radsight-bench", "capture", "t10"]), [1, 2, 4]);
        assert_eq!(parse(&["radsight-bench", "capture", "--long", "--radiance-samples", "16,2"]), [2, 16]);
    }
}
