//! The command line, as typed.

use crate::failure::Outcome;
use crate::plugin_guard::PluginGuard;
use crate::trust::{OutputName, Trust};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::sync::Arc;

/// Takes Radiance scenes through a real camera: rays, pinhole, sensor, grey values.
#[derive(Debug, Parser)]
#[command(name = "radsight", version, arg_required_else_help = true, after_help = AFTER_HELP)]
pub(crate) struct Program {
    #[command(subcommand)]
    pub(crate) command: Command,
}

const AFTER_HELP: &str = "\
Exit codes: 0 done, 1 the input was wrong, 2 the command line was wrong, 3 a limit or fault stopped the work.
Options of rendering, as Radiance names them: -ab N (diffuse interreflections, 0), -dr N (mirror relays of a light, 2), --caustics (light of lamps by way of curved mirrors and bodies), -bv+/-bv-.
Every program takes --limit-memory SIZE (500M, 2G; 0 for none): the memory that it may have [default: three quarters of the machine's].
Called as `radsight rtrace …`, or through a link named rtrace, it is that Radiance program.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Captures the grey picture that the camera would give: all stages in one process
    Capture(Box<Capture>),
    /// Reads and checks scenes: all errors, with carets
    Check(Check),
    /// Says what a capture of this scene computes, and what it skips and why
    Explain(Explain),
    /// The pinhole alone: rays for any rtrace, and the average of what comes back
    #[command(subcommand)]
    Pinhole(Pinhole),
    /// Turns exposure (a float matrix in J/m² on standard input) into a grey PNG on standard output; or measures the sensor
    Sensor(Sensor),
    /// Makes one page (HTML) of a picture: values, false colour, error, where the time went, settings
    Report(Report),
    /// Renders parts of a picture or capture in other processes, and puts them together
    #[command(subcommand)]
    Job(crate::commands::job::Job),
    /// Prints the light ring of a camera file as Radiance scene text
    Rig(Rig),
    /// Prints a calibration target as Radiance scene text: a chessboard or a grid of dots, in the plane z = 0
    Target(Target),
    /// Fits K, gamma, G0 and Gmax to measured pairs of exposure and grey value
    Calibrate(Calibrate),
    /// BRDF plugins: start one, list them, check one, draw its lobe
    #[command(subcommand)]
    Plugin(Plugin),
    /// Retroreflectors: tables and plots of R_A, fits to data sheets, conversion, minimum tables, materials for scenes
    #[command(subcommand)]
    Retro(crate::commands::retro::Retro),
    /// Makes links named after Radiance's programs, their manual pages, and completions for Bash, Zsh and Fish
    InstallLinks(InstallLinks),
}

/// How scenes are read.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Reading {
    #[command(flatten)]
    allowed: Allowed,
    /// What the command line lets files cause
    #[arg(skip)]
    pub(crate) trust: Trust,
    #[command(flatten)]
    pub(crate) plugin_guard: PluginGuard,
    /// What is suspect is an error: warnings of a scene, findings of a plugin's self-check
    #[arg(long)]
    pub(crate) strict: bool,
    /// Do not print warnings
    #[arg(skip)]
    pub(crate) no_warnings: bool,
    /// Definitions for all functions of the scene: names for messages, and texts
    #[arg(skip)]
    pub(crate) definitions: Vec<(String, Arc<[u8]>)>,
    /// The file that holds the irradiance cache (`-af`)
    #[arg(skip)]
    pub(crate) ambient_file: Option<OutputName>,
    /// The file of the irradiance cache that a job names
    #[arg(skip)]
    pub(crate) irradiance_cache: Option<String>,
}

/// What files may cause.
#[derive(Args, Clone, Debug, Default)]
struct Allowed {
    /// Run `!` commands that are not known in process through a shell
    #[arg(long)]
    allow_commands: bool,
    /// Load plugins that stand beside the scene, which runs their code
    #[arg(long)]
    allow_plugins: bool,
    /// Replace a material by a model of a plugin: MATERIAL=LIBRARY:MODEL(number,…)
    #[arg(long, value_name = "MATERIAL=…")]
    brdf: Vec<String>,
    /// Look for plugins in this folder first
    #[arg(long, value_name = "DIR")]
    plugin_path: Vec<String>,
}

impl Reading {
    /// How scenes are read where nothing else is said.
    pub(crate) fn trusted(trust: &Trust) -> Reading {
        Reading { trust: trust.clone(), ..Reading::default() }
    }

    /// Adds what the command line allows to what the process was started with.
    pub(crate) fn entrust(&mut self, trust: &Trust) -> Outcome {
        self.trust = trust.clone();
        let Allowed { allow_commands, allow_plugins, brdf, plugin_path } = std::mem::take(&mut self.allowed);
        let flags = [("--allow-commands", allow_commands), ("--allow-plugins", allow_plugins)];
        let flags = flags.into_iter().filter(|(_, is_set)| *is_set).map(|(name, _)| vec![name.to_owned()]);
        let option = |name: &'static str| move |value: String| vec![name.to_owned(), value];
        let values = plugin_path.into_iter().map(option("--plugin-path")).chain(brdf.into_iter().map(option("--brdf")));
        flags.chain(values).try_for_each(|words| self.trust.take(&words).map(drop))
    }
}

#[derive(Args, Debug)]
pub(crate) struct Capture {
    /// Camera file
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
    /// Scene files in Radiance's format, or - for standard input
    #[arg(value_name = "SCENE.rad", required = true)]
    pub(crate) scenes: Vec<String>,
    /// Grey picture
    #[arg(short, long, value_name = "OUT.png", required_unless_present_any = ["exposure", "report", "color"])]
    pub(crate) output: Option<String>,
    /// Also writes the colours behind a mosaic of colour filters, demosaiced
    #[arg(long, value_name = "OUT.png")]
    pub(crate) color: Option<String>,
    /// Also writes where the parts of this specimen are, as [alignment] of a camera file, where there are [tolerances]
    #[arg(long, value_name = "OUT.toml")]
    pub(crate) specimen: Option<String>,
    /// Also writes the exposure E_pixel in J/m²; the format follows from the name (.pfm .exr .npy .tif; else a Radiance float matrix)
    #[arg(long, value_name = "FILE")]
    pub(crate) exposure: Option<String>,
    #[command(flatten)]
    pub(crate) accounts: Accounts,
    /// Exposes a picture for each line of a table, which says what of camera file and scene is other than usual (docs/series.md); {} in the
    /// names of -o and --exposure stands for the picture's name
    #[arg(long, value_name = "TABLE.csv")]
    pub(crate) variants: Option<String>,
    /// Stop when the estimated rms error over the pixels is this share of the mean exposure [default: 0.005]
    #[arg(long, value_name = "E", conflicts_with = "samples")]
    pub(crate) error: Option<f64>,
    /// Rays a pixel, instead of an error; a power of two converges fastest
    #[arg(long, value_name = "N")]
    pub(crate) samples: Option<u32>,
    /// Chooses the sample sequence and the sensor's noise
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Go on with what an interrupted capture has left in OUT.png.checkpoint, to the same bits
    #[arg(long)]
    pub(crate) resume: bool,
    /// Save what is done this often, in OUT.png.checkpoint, until the capture is complete
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub(crate) checkpoint_interval: f64,
    /// Threads [default: one for each processor]
    #[arg(long)]
    pub(crate) threads: Option<usize>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// What else a capture tells of itself.
#[derive(Args, Debug)]
pub(crate) struct Accounts {
    /// Also writes a page (HTML) with the exposure in false colour, its error, the grey values, and where the time went
    #[arg(long, value_name = "OUT.html")]
    pub(crate) report: Option<String>,
    /// Also writes the estimated standard error of each pixel in J/m², in a format that follows from the name
    #[arg(long, value_name = "FILE", conflicts_with = "samples")]
    pub(crate) error_map: Option<String>,
    /// Also writes the number of rays of each pixel, likewise
    #[arg(long, value_name = "FILE", conflicts_with = "samples")]
    pub(crate) ray_map: Option<String>,
    /// Also writes how the picture was made: times, error, what was skipped, settings
    #[arg(long, value_name = "OUT.json")]
    pub(crate) record: Option<String>,
}

#[derive(Args, Debug)]
pub(crate) struct Check {
    /// Scene files, or - for standard input
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) scenes: Vec<String>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

#[derive(Args, Debug)]
pub(crate) struct Explain {
    /// Camera file
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
    /// Scene files, or - for standard input
    #[arg(value_name = "SCENE.rad", required = true)]
    pub(crate) scenes: Vec<String>,
    /// Also measures how much time each thing that is left out saves, with a few rays a pixel
    #[arg(long)]
    pub(crate) measure: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// Rays of a camera.
#[derive(Args, Debug)]
pub(crate) struct CameraRays {
    /// Camera file
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
    /// Rays a pixel
    #[arg(long, value_name = "N")]
    pub(crate) samples: u32,
    /// Chooses the sample sequence
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Numbers in the stream: d native doubles, f native floats, a text
    #[arg(short = 'f', value_name = "a|f|d", default_value = "d")]
    pub(crate) format: String,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Pinhole {
    /// Rays over pixel × pinhole for any rtrace: origin and direction, scanline order, the rays of a pixel together
    Rays(CameraRays),
    /// The exposure (a float matrix in J/m²) from the radiances that rtrace returned for those rays
    Average(Average),
    /// The paper's method: pictures from several pinhole positions, moved by whole pixels and weighted by area
    Shift(Shift),
}

#[derive(Args, Debug)]
pub(crate) struct Average {
    #[command(flatten)]
    pub(crate) rays: CameraRays,
    /// Values a ray in the stream: 3 as rtrace gives them, or 1
    #[arg(long, default_value_t = 3)]
    pub(crate) bands: usize,
}

#[derive(Args, Debug)]
pub(crate) struct Shift {
    /// Camera file
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
    /// Radiance pictures, one for each position in the order of --views; the exposure goes to standard output
    #[arg(value_name = "PIC")]
    pub(crate) pictures: Vec<String>,
    /// Pixels between neighbouring positions
    #[arg(long, default_value_t = 1)]
    pub(crate) step: u32,
    /// Print the view options and picture size of each position instead
    #[arg(long, conflicts_with = "pictures")]
    pub(crate) views: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Sensor {
    /// Camera file with a `[sensor]` table
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
    /// Chooses the sensor's noise
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Measure the sensor instead, by the photon transfer method of EMVA 1288: a table with intervals on standard output
    #[arg(long)]
    pub(crate) characterise: bool,
    /// Also write the measurement as a page with plots
    #[arg(long, value_name = "OUT.html", requires = "characterise")]
    pub(crate) report: Option<String>,
    /// Steps of light from dark to saturation
    #[arg(long, value_name = "N", default_value_t = 50, requires = "characterise")]
    pub(crate) steps: u32,
    /// Pictures that are averaged for the differences between pixels
    #[arg(long, value_name = "N", default_value_t = 100, requires = "characterise")]
    pub(crate) stack: u32,
    /// Also write the colours behind a mosaic of colour filters, demosaiced
    #[arg(long, value_name = "OUT.png", conflicts_with = "characterise")]
    pub(crate) color: Option<String>,
}

/// What the values of a picture are.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum QuantityName {
    /// W/(sr·m²)
    Radiance,
    /// W/m²
    Irradiance,
    /// J/m²
    Exposure,
    /// Numbers without a unit
    Other,
}

/// What the values of an error map are.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum ErrorMapKind {
    /// In the unit of the picture
    Absolute,
    /// Shares of each pixel's value
    Relative,
}

#[derive(Args, Debug)]
pub(crate) struct Report {
    /// Picture: .hdr .exr .tif .pfm .npy .mtx or .png
    #[arg(value_name = "PICTURE")]
    pub(crate) picture: String,
    /// The page, or - for standard output
    #[arg(short, long, value_name = "OUT.html")]
    pub(crate) output: String,
    /// Standard error of each pixel, as capture and rpict write it
    #[arg(long, value_name = "FILE")]
    pub(crate) error_map: Option<String>,
    /// What the error map's values are [default: as its header says, else relative for colour and absolute for one component]
    #[arg(long, value_name = "KIND", requires = "error_map")]
    pub(crate) error_map_kind: Option<ErrorMapKind>,
    /// Number of rays of each pixel
    #[arg(long, value_name = "FILE")]
    pub(crate) ray_map: Option<String>,
    /// How the picture was made, as capture and rpict write it
    #[arg(long, value_name = "FILE.json")]
    pub(crate) record: Option<String>,
    /// What rpict -t said while it worked, ours or Radiance's
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<String>,
    /// Camera file with which it was captured
    #[arg(long, value_name = "CAMERA.toml")]
    pub(crate) camera: Option<String>,
    /// The sensor's grey picture
    #[arg(long, value_name = "GREY.png")]
    pub(crate) grey: Option<String>,
    /// What the picture's values are [default: exposure for one component, radiance for three]
    #[arg(long, value_name = "QUANTITY")]
    pub(crate) quantity: Option<QuantityName>,
    /// The page's title [default: the picture's name]
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,
}

#[derive(Args, Debug)]
pub(crate) struct Rig {
    /// Camera file with a `[rig]` table
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
}

/// What is drawn on a target.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum TargetKind {
    /// For OpenCV's findChessboardCorners
    Chessboard,
    /// For OpenCV's findCirclesGrid
    Dots,
}

#[derive(Args, Debug)]
pub(crate) struct Target {
    /// What is drawn
    pub(crate) kind: TargetKind,
    /// Inner corners or dots in a row
    #[arg(long, default_value_t = 9)]
    pub(crate) columns: u32,
    /// Inner corners or dots in a column
    #[arg(long, default_value_t = 6)]
    pub(crate) rows: u32,
    /// From one to the next, scene units
    #[arg(long, value_name = "LENGTH", default_value_t = 0.025)]
    pub(crate) spacing: f64,
    /// Let the target shine by itself: radiance of its white, W/(sr·m²)
    #[arg(long, value_name = "L")]
    pub(crate) radiance: Option<f64>,
}

#[derive(Args, Debug)]
pub(crate) struct Calibrate {
    /// Two columns: exposure, grey value
    #[arg(value_name = "DATA.csv")]
    pub(crate) data: String,
    /// Unit of the exposures
    #[arg(long, default_value = "uJ/cm2")]
    pub(crate) unit: String,
    /// Also draw data and fit
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<String>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Plugin {
    /// Starts a plugin project that builds, with its test
    New(PluginNew),
    /// Lists the plugins that are found, their models and parameters
    List(PluginList),
    /// Checks a plugin: loading, arguments, physics, sampling, crashes, leaks; each check in a process of its own
    Check(PluginCheck),
    /// Draws the lobe of a model as SVG on standard output
    Plot(PluginPlot),
    /// What each check runs
    #[command(hide = true)]
    CheckChild,
    /// What `--isolate-plugins` runs for each library
    #[command(hide = true)]
    IsolationChild,
}

#[derive(Args, Debug)]
pub(crate) struct PluginNew {
    /// Name of the plugin, and of the folder that is made
    #[arg(value_name = "NAME")]
    pub(crate) name: String,
    /// In C, from the header alone
    #[arg(long)]
    pub(crate) c: bool,
    /// The folder of radsight's sources, whose SDK a project in Rust uses [default: those that this program was built from]
    #[arg(long, value_name = "DIR", conflicts_with = "c")]
    pub(crate) sdk_path: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct PluginList {
    /// Look for plugins in this folder first
    #[arg(long, value_name = "DIR")]
    pub(crate) plugin_path: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct PluginCheck {
    /// The library's file, or the name of one that is found
    #[arg(value_name = "LIB")]
    pub(crate) library: String,
    /// Only this model, with parameters if wanted: MODEL or MODEL(number,…)
    #[arg(long, value_name = "MODEL")]
    pub(crate) model: Option<String>,
    /// Of all random numbers
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Seconds for each check
    #[arg(long, default_value_t = 60)]
    pub(crate) time_limit: u64,
    /// Print the report as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Look for plugins in this folder first
    #[arg(long, value_name = "DIR")]
    pub(crate) plugin_path: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct PluginPlot {
    /// The library's file, or the name of one that is found
    #[arg(value_name = "LIB")]
    pub(crate) library: String,
    /// The model with its parameters: MODEL or MODEL(number,…)
    #[arg(value_name = "MODEL")]
    pub(crate) model: String,
    /// Look for plugins in this folder first
    #[arg(long, value_name = "DIR")]
    pub(crate) plugin_path: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct InstallLinks {
    /// Folder for the links
    #[arg(value_name = "DIR")]
    pub(crate) folder: String,
    /// Folder for manual pages and completions, as /usr/share is [default: DIR/share]
    #[arg(long, value_name = "DIR", conflicts_with = "only_links")]
    pub(crate) share: Option<String>,
    /// Make the links alone
    #[arg(long)]
    pub(crate) only_links: bool,
}
