//! The command line.

use crate::figure::Figure;
use crate::generated::SQUARES;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Time and error of radsight beside real Radiance.
#[derive(Debug, Parser)]
#[command(name = "radsight-bench", version, about)]
pub(crate) struct Program {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What is measured.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Captures of the paper's figures: time, error against the truth, and Radiance's time for the same error
    Capture(Capture),
    /// Pictures of many scenes: time to an error beside real Radiance and Mitsuba 3, as a table, a CSV file and a page
    Race(Race),
    /// Other people's rpict commands beside real Radiance: processor time, and how near the pictures are to the truth
    Commands(Commands),
    /// Random rooms: whether rpict --error ends at the asked error, by references of single paths
    Rooms(Rooms),
    /// Few sensor points: mean, deviation over seeds and time of rtrace -I beside real Radiance's
    Sensors(Sensors),
    /// Rays without any order against a million triangles: first and any hits a second, beside Embree and real rtrace
    Rays(Rays),
    /// How time and memory grow with triangles, lights, pixels and threads, beside the other programs
    Scaling(Scaling),
    /// Scenes of a million triangles and of nested arrays: time and memory from text to a hierarchy, beside oconv
    Load(Load),
    /// Runs a program and prints its processor time and wall time in s and its peak memory in MiB
    #[command(hide = true)]
    Cost {
        /// Seconds of processor time after which a process is ended
        #[arg(long, value_name = "SECONDS")]
        limit: Option<u64>,
        /// What the program reads
        #[arg(long, value_name = "FILE")]
        input: Option<PathBuf>,
        /// Where what it writes goes
        #[arg(long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// The program and its arguments
        #[arg(required = true, trailing_var_arg = true)]
        words: Vec<String>,
    },
    /// What a reflectance model costs in a plugin, beside the same model in the program
    Plugin(Plugin),
}

/// `radsight-bench commands`.
#[derive(Debug, Args)]
pub(crate) struct Commands {
    /// Folders with a script run.sh, which makes its files in $OUT and finds Radiance's function files in $RADLIB
    #[arg(required = true, value_name = "FOLDER")]
    pub(crate) folders: Vec<PathBuf>,
    /// Rays a pixel of the truth
    #[arg(long, value_name = "N", default_value_t = 256)]
    pub(crate) truth: u32,
}

/// `radsight-bench rooms`.
#[derive(Debug, Args)]
pub(crate) struct Rooms {
    /// Seeds of the rooms, from A to B
    #[arg(long, value_name = "A..B", default_value = "1..20", value_parser = crate::rooms::seeds)]
    pub(crate) seeds: (u64, u64),
    /// Errors that are asked for, as shares
    #[arg(long, value_name = "E,…", value_delimiter = ',', default_values_t = [0.1, 0.05, 0.02])]
    pub(crate) errors: Vec<f64>,
    /// Seconds of processor time that rpict may take for a picture (its --time-limit); without it, as long as it takes
    #[arg(long, value_name = "SECONDS")]
    pub(crate) limit: Option<f64>,
    /// Columns of the pictures; rows are three quarters of that
    #[arg(long, value_name = "N", default_value_t = 48)]
    pub(crate) columns: usize,
    /// Seconds of processor time that may be spent on a room's references; what is there already is kept and made better
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    pub(crate) reference_budget: f64,
    /// Also renders every room with real Radiance at ever better settings, for the time to the same error
    #[arg(long)]
    pub(crate) beside: bool,
    /// Seconds of processor time that one of its pictures may take
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    pub(crate) beside_limit: u64,
    /// Writes scenes, views and options, names their folders, and ends
    #[arg(long)]
    pub(crate) scenes_only: bool,
    /// Where rooms and references go [default: bench in the folder above this program's]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

/// `radsight-bench sensors`.
#[derive(Debug, Args)]
pub(crate) struct Sensors {
    /// Runs of each program, each with random numbers of its own
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) repeat: u32,
    /// Runs of single paths whose mean is the truth
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
    /// Leaves real Radiance out
    #[arg(long)]
    pub(crate) alone: bool,
}

/// `radsight-bench race`.
#[derive(Debug, Args)]
pub(crate) struct Race {
    /// Scenes, by name; all of them unless told otherwise
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub(crate) scenes: Vec<String>,
    /// Lists the scenes and ends
    #[arg(long)]
    pub(crate) list: bool,
    /// Seconds of processor time that a run may take: a program's series of ever dearer settings ends with the first that takes longer
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0)]
    pub(crate) budget: f64,
    /// Seconds of processor time after which a process of another program is ended, and its series with it
    #[arg(long, value_name = "SECONDS", default_value_t = 120)]
    pub(crate) limit: u64,
    /// Seconds of processor time that may be spent on a scene's reference; what is there already is kept and made better
    #[arg(long, value_name = "SECONDS", default_value_t = 120.0)]
    pub(crate) reference_budget: f64,
    /// Noise at which a reference is good enough, as a share
    #[arg(long, value_name = "SHARE", default_value_t = 0.003)]
    pub(crate) reference_noise: f64,
    /// Leaves the other programs out
    #[arg(long)]
    pub(crate) alone: bool,
    /// Compares wall time instead of processor time
    #[arg(long)]
    pub(crate) wall: bool,
    /// Where the page, the CSV file and the references go [default: bench in the folder above this program's]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
    /// The repository with the scenes [default: the one that this program was built from]
    #[arg(long, value_name = "DIR")]
    pub(crate) repo: Option<PathBuf>,
}

/// `radsight-bench plugin`.
#[derive(Debug, Args)]
pub(crate) struct Plugin {
    /// Rays a pixel
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) samples: u32,
    /// Times that each capture is repeated; the least time counts
    #[arg(long, value_name = "R", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// The repository with the scenes [default: the one that this program was built from]
    #[arg(long, value_name = "DIR")]
    pub(crate) repo: Option<PathBuf>,
}

/// `radsight-bench capture`.
#[derive(Debug, Args)]
pub(crate) struct Capture {
    /// Figures to capture
    #[arg(value_name = "FIGURE", default_values = ["t8", "t9", "t10", "t11", "t13", "t14"])]
    pub(crate) figures: Vec<Figure>,
    /// Rays a pixel of radsight's captures
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4, 8, 16, 32, 64, 128, 256],
          value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) samples: Vec<u32>,
    /// Errors that radsight is asked for, as shares of the mean exposure
    #[arg(long, value_name = "E,…", value_delimiter = ',', default_values_t = [0.02, 0.01, 0.005])]
    pub(crate) errors: Vec<f64>,
    /// Times that each capture of radsight is repeated, with another seed each; times and errors are medians
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Rays a pixel through real rtrace
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4],
          value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) radiance_samples: Vec<u32>,
    /// Also 16 rays a pixel through real rtrace, which takes minutes a figure
    #[arg(long)]
    pub(crate) long: bool,
    /// Leaves real Radiance out
    #[arg(long)]
    pub(crate) alone: bool,
    /// Also writes every run as a line of comma-separated values
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// The repository with the scenes and the truth [default: the one that this program was built from]
    #[arg(long, value_name = "DIR")]
    pub(crate) repo: Option<PathBuf>,
}

/// `radsight-bench rays`.
#[derive(Debug, Args)]
pub(crate) struct Rays {
    /// How many rays
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) rays: u32,
    /// Squares along each side of the land; each is two triangles
    #[arg(long, value_name = "N", default_value_t = SQUARES, value_parser = clap::value_parser!(u32).range(1..=4000))]
    pub(crate) squares: u32,
    /// Times that each program is run; the least time counts
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
}

/// `radsight-bench scaling`.
#[derive(Debug, Args)]
pub(crate) struct Scaling {
    /// Most triangles
    #[arg(long, value_name = "N", default_value_t = 1e7)]
    pub(crate) triangles: f64,
    /// Seconds of processor time that a run of another program may be expected to take: its series ends before that
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub(crate) budget: f64,
    /// Times that each program is run; medians count
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Leaves the other programs out
    #[arg(long)]
    pub(crate) alone: bool,
    /// Where the CSV file goes; `race` makes a section of its page of it [default: as for race]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

/// `radsight-bench load`.
#[derive(Debug, Args)]
pub(crate) struct Load {
    /// Times that each program is run; what is printed are medians
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
}

impl Capture {
    /// Rays a pixel through real rtrace, ascending.
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
