//! The command line as typed.

use crate::failure::Outcome;
use crate::plugin_guard::PluginGuard;
use crate::trust::{OutputName, Trust};
use clap::{Args, Parser, Subcommand};
use radsight_picture::FileFormat;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Renders Radiance scenes through a real camera: rays, pinhole, sensor, grey values.
#[derive(Debug, Parser)]
#[command(name = "radsight", version, arg_required_else_help = true, after_help = AFTER_HELP)]
pub(crate) struct Program {
    #[command(subcommand)]
    pub(crate) command: Command,
}

const AFTER_HELP: &str = "\
Exit codes: 0 done, 1 the input was wrong, 2 the command line was wrong, 3 a limit or fault stopped the work.
Options of rendering, as Radiance names them: -ab N (diffuse interreflections, 0), -dr N (mirror reflections of a light, 2), --caustics (light of lamps through curved mirrors and bodies), -bv+/-bv-.
Every program takes --limit-memory SIZE (500M, 2G; 0 for none): the memory that it may have [default: three quarters of the machine's].
Called as `radsight rtrace …`, or through a link named rtrace, it is that Radiance program.";

const CAPTURE_HELP: &str = "\
Options of rendering, as of rpict: -ab -aa -ar -ad -as -av -ae -ai -aE -aI -ds -dt -dr -dv -st -bv -cs -cw -lr -lw -me -ma -mg -ms --caustics; \
`radsight rpict -defaults` lists them.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Captures the grey picture of a camera: all stages in one process
    #[command(after_help = CAPTURE_HELP)]
    Capture(Box<Capture>),
    /// Reads and checks scenes: all errors, with carets
    Check(Check),
    /// Prints what a capture of a scene computes, and what it skips and why
    Explain(Explain),
    /// The pinhole alone: rays for any rtrace, and the average of their radiances
    #[command(subcommand)]
    Pinhole(Pinhole),
    /// Converts an exposure (a float matrix in J/m² on standard input) to a grey PNG on standard
    /// output; or measures the sensor
    Sensor(Sensor),
    /// Writes an HTML page about a picture: values, false colour, error, times, settings
    Report(Report),
    /// Renders parts of a picture or capture in other processes, and merges them
    #[command(subcommand)]
    Job(crate::commands::job::Job),
    /// Prints the light ring of a camera file as Radiance scene text
    Rig(Rig),
    /// Prints a calibration target as Radiance scene text: a chessboard or a grid of dots, in the
    /// plane z = 0
    Target(Target),
    /// Fits K, gamma, G0 and Gmax to measured pairs of exposure and grey value
    Calibrate(Calibrate),
    /// BRDF plugins: create, list, check and plot them
    #[command(subcommand)]
    Plugin(Plugin),
    /// Retroreflectors: tables and plots of R_A, fits to data sheets, conversion, minimum tables,
    /// materials
    #[command(subcommand)]
    Retro(crate::commands::retro::Retro),
    /// Installs links named after Radiance's programs, manual pages, and completions for Bash, Zsh
    /// and Fish
    InstallLinks(InstallLinks),
}

/// Options of reading scenes.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Reading {
    #[command(flatten)]
    allowed: Allowed,
    /// Permissions that the command line gives to files
    #[arg(skip)]
    pub(crate) trust: Trust,
    #[command(flatten)]
    pub(crate) plugin_guard: PluginGuard,
    /// Treat warnings of scenes and findings of plugin self-checks as errors
    #[arg(long)]
    pub(crate) strict: bool,
    /// Do not print warnings
    #[arg(skip)]
    pub(crate) no_warnings: bool,
    /// Definitions for all functions of the scene: names for messages, and texts
    #[arg(skip)]
    pub(crate) definitions: Vec<(String, Arc<[u8]>)>,
    /// The file of the irradiance cache (`-af`)
    #[arg(skip)]
    pub(crate) ambient_file: Option<OutputName>,
    /// The file of the irradiance cache that a job names
    #[arg(skip)]
    pub(crate) irradiance_cache: Option<String>,
}

/// Permissions of files.
#[derive(Args, Clone, Debug, Default)]
struct Allowed {
    /// Run unknown `!` commands through a shell
    #[arg(long)]
    allow_commands: bool,
    /// Load plugins beside the scene, which runs their code
    #[arg(long)]
    allow_plugins: bool,
    /// Replace a material by a plugin's model: MATERIAL=LIBRARY:MODEL(number,…)
    #[arg(long, value_name = "MATERIAL=…")]
    brdf: Vec<String>,
    /// Search this folder for plugins first
    #[arg(long, value_name = "DIR")]
    plugin_path: Vec<String>,
}

impl Reading {
    /// The default options of reading scenes.
    pub(crate) fn trusted(trust: &Trust) -> Reading {
        Reading { trust: trust.clone(), ..Reading::default() }
    }

    /// Adds the permissions of the command line to those of the process.
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
    #[arg(short, long, value_name = "OUT.png", value_parser = png_name, required_unless_present_any = ["exposure", "report", "color", "derivatives", "fisher"])]
    pub(crate) output: Option<String>,
    /// Also write the demosaiced colour picture of a sensor with a colour filter mosaic
    #[arg(long, value_name = "OUT.png", value_parser = png_name)]
    pub(crate) color: Option<String>,
    /// Also write the actual alignment of this specimen, as [alignment] of a camera file with
    /// [tolerances]
    #[arg(long, value_name = "OUT.toml")]
    pub(crate) specimen: Option<String>,
    /// Also write the exposure E_pixel in J/m² in the format of the file name (.pfm .exr .npy .tif;
    /// else a Radiance float matrix)
    #[arg(long, value_name = "FILE")]
    pub(crate) exposure: Option<String>,
    #[command(flatten)]
    pub(crate) accounts: Accounts,
    /// Expose a picture for each line of a table of changes to camera file and scene
    /// (docs/series.md); {} in the names of -o and --exposure is replaced by the picture's name
    #[arg(long, value_name = "TABLE.csv")]
    pub(crate) variants: Option<String>,
    /// Differentiate the exposure by these parameters (docs/derivatives.md): NAME.x .y .z .rx .ry
    /// .rz of a part, led.intensity, led[K].intensity, ring.diameter, distance, pinhole.diameter,
    /// focal.distance, exposure.time
    #[arg(long, value_name = "PARAMETER", value_delimiter = ',', conflicts_with = "variants")]
    pub(crate) derivative: Vec<String>,
    /// Derivative of the exposure by each parameter in J/m² per its unit; {} is replaced by the
    /// parameter, and by the parameter and .error for the standard errors
    #[arg(long, value_name = "OUT-{}.pfm", requires = "derivative")]
    pub(crate) derivatives: Option<String>,
    /// Rms of the standard errors of a derivative, relative to its rms
    #[arg(long, value_name = "E", default_value_t = 0.01, requires = "derivative")]
    pub(crate) derivative_error: f64,
    /// Fisher information of the sensor's picture about the parameters, and the smallest possible
    /// standard deviations of their estimates
    #[arg(long, value_name = "OUT.json", requires = "derivative")]
    pub(crate) fisher: Option<String>,
    /// Stop when the estimated rms error of the pixels, relative to the mean exposure, reaches this
    /// value [default: 0.005]
    #[arg(long, value_name = "E", conflicts_with = "samples")]
    pub(crate) error: Option<f64>,
    /// Number of rays per pixel, instead of an error; a power of two converges fastest
    #[arg(long, value_name = "N")]
    pub(crate) samples: Option<u32>,
    /// Seed of the sample sequence and of the sensor's noise
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Continue an interrupted capture from OUT.png.checkpoint, with the same bits
    #[arg(long)]
    pub(crate) resume: bool,
    /// Save progress in OUT.png.checkpoint at this interval until the capture is complete
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub(crate) checkpoint_interval: f64,
    /// Number of threads [default: one per processor]
    #[arg(long)]
    pub(crate) threads: Option<usize>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// Additional outputs of a capture.
#[derive(Args, Debug)]
pub(crate) struct Accounts {
    /// Also write an HTML page with the exposure in false colour, its error, the grey values, and
    /// times
    #[arg(long, value_name = "OUT.html")]
    pub(crate) report: Option<String>,
    /// Also write the estimated standard error of each pixel in J/m², in the format of the file
    /// name
    #[arg(long, value_name = "FILE", conflicts_with = "samples")]
    pub(crate) error_map: Option<String>,
    /// Also write the number of rays of each pixel, in the format of the file name
    #[arg(long, value_name = "FILE", conflicts_with = "samples")]
    pub(crate) ray_map: Option<String>,
    /// Also write a record of how the picture was made: times, error, skipped work, settings
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
    /// Also measure the time saved by each kind of skipped work, with a few rays per pixel
    #[arg(long)]
    pub(crate) measure: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// Camera rays.
#[derive(Args, Debug)]
pub(crate) struct CameraRays {
    /// Camera file
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
    /// Number of rays per pixel
    #[arg(long, value_name = "N")]
    pub(crate) samples: u32,
    /// Seed of the sample sequence
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Number format of the stream: d native doubles, f native floats, a text
    #[arg(short = 'f', value_name = "a|f|d", default_value = "d")]
    pub(crate) format: String,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Pinhole {
    /// Rays over pixel × pinhole for any rtrace: origin and direction, in scanline order, the rays
    /// of a pixel together
    Rays(CameraRays),
    /// The exposure (a float matrix in J/m²) from the radiances that rtrace returned for the rays
    Average(Average),
    /// The paper's method: pictures from several pinhole positions, shifted by whole pixels and
    /// weighted by area
    Shift(Shift),
}

#[derive(Args, Debug)]
pub(crate) struct Average {
    #[command(flatten)]
    pub(crate) rays: CameraRays,
    /// Number of values per ray in the stream: 3 as from rtrace, or 1
    #[arg(long, default_value_t = 3)]
    pub(crate) bands: usize,
}

#[derive(Args, Debug)]
pub(crate) struct Shift {
    /// Camera file
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
    /// Radiance pictures, one per position in the order of --views; the exposure is written to
    /// standard output
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
    /// Seed of the sensor's noise
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Measure the sensor by the photon transfer method of EMVA 1288 and print a table with
    /// intervals
    #[arg(long)]
    pub(crate) characterise: bool,
    /// Also write the measurement as a page with plots
    #[arg(long, value_name = "OUT.html", requires = "characterise")]
    pub(crate) report: Option<String>,
    /// Number of exposure steps from dark to saturation
    #[arg(long, value_name = "N", default_value_t = 50, requires = "characterise")]
    pub(crate) steps: u32,
    /// Number of pictures averaged for the non-uniformity of pixels
    #[arg(long, value_name = "N", default_value_t = 100, requires = "characterise")]
    pub(crate) stack: u32,
    /// Also write the demosaiced colour picture of a sensor with a colour filter mosaic
    #[arg(long, value_name = "OUT.png", value_parser = png_name, conflicts_with = "characterise")]
    pub(crate) color: Option<String>,
}

/// Extensions of pictures that radsight neither reads nor writes.
const UNKNOWN_PICTURES: [&str; 4] = ["jpg", "jpeg", "bmp", "gif"];

/// The name of a PNG file: not one that stands for another format.
fn png_name(name: &str) -> Result<String, String> {
    let path = Path::new(name);
    let is_unknown = |extension: &OsStr| UNKNOWN_PICTURES.iter().any(|other| extension.eq_ignore_ascii_case(other));
    match FileFormat::from_name(name) {
        Some(FileFormat::Png) => Ok(name.to_owned()),
        None if !path.extension().is_some_and(is_unknown) => Ok(name.to_owned()),
        _ => Err(format!("the picture is written as PNG; for example \"{}\"", path.with_extension("png").display())),
    }
}

/// The physical quantity of a picture's values.
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

/// The meaning of an error map's values.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum ErrorMapKind {
    /// In the unit of the picture
    Absolute,
    /// Relative to each pixel's value
    Relative,
}

#[derive(Args, Debug)]
pub(crate) struct Report {
    /// Picture: .hdr .exr .tif .pfm .npy .mtx or .png
    #[arg(value_name = "PICTURE")]
    pub(crate) picture: String,
    /// Output page, or - for standard output
    #[arg(short, long, value_name = "OUT.html")]
    pub(crate) output: String,
    /// Standard error of each pixel, as written by capture and rpict
    #[arg(long, value_name = "FILE")]
    pub(crate) error_map: Option<String>,
    /// Meaning of the error map's values [default: from its header, else relative for colour and
    /// absolute for one component]
    #[arg(long, value_name = "KIND", requires = "error_map")]
    pub(crate) error_map_kind: Option<ErrorMapKind>,
    /// Number of rays of each pixel
    #[arg(long, value_name = "FILE")]
    pub(crate) ray_map: Option<String>,
    /// Record of how the picture was made, as written by capture and rpict
    #[arg(long, value_name = "FILE.json")]
    pub(crate) record: Option<String>,
    /// Output of rpict -t, radsight's or Radiance's
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<String>,
    /// Camera file of the capture
    #[arg(long, value_name = "CAMERA.toml")]
    pub(crate) camera: Option<String>,
    /// The sensor's grey picture
    #[arg(long, value_name = "GREY.png")]
    pub(crate) grey: Option<String>,
    /// Quantity of the picture's values [default: exposure for one component, radiance for three]
    #[arg(long, value_name = "QUANTITY")]
    pub(crate) quantity: Option<QuantityName>,
    /// Title of the page [default: the picture's name]
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,
}

#[derive(Args, Debug)]
pub(crate) struct Rig {
    /// Camera file with a `[rig]` table
    #[arg(value_name = "CAMERA.toml")]
    pub(crate) camera: String,
}

/// The pattern of a target.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum TargetKind {
    /// For OpenCV's findChessboardCorners
    Chessboard,
    /// For OpenCV's findCirclesGrid
    Dots,
}

#[derive(Args, Debug)]
pub(crate) struct Target {
    /// Pattern of the target
    pub(crate) kind: TargetKind,
    /// Number of inner corners or dots per row
    #[arg(long, default_value_t = 9)]
    pub(crate) columns: u32,
    /// Number of inner corners or dots per column
    #[arg(long, default_value_t = 6)]
    pub(crate) rows: u32,
    /// Distance between neighbours, scene units
    #[arg(long, value_name = "LENGTH", default_value_t = 0.025)]
    pub(crate) spacing: f64,
    /// Make the target self-luminous: radiance of its white, W/(sr·m²)
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
    /// Also plot data and fit
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<String>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Plugin {
    /// Creates a plugin project that builds, with its test
    New(PluginNew),
    /// Lists the plugins in the search path, their models and parameters
    List(PluginList),
    /// Checks a plugin: loading, arguments, physics, sampling, crashes, leaks; each check in a
    /// separate process
    Check(PluginCheck),
    /// Plots the lobe of a model as SVG on standard output
    Plot(PluginPlot),
    /// Child process of a check
    #[command(hide = true)]
    CheckChild,
    /// Child process of `--isolate-plugins` for a library
    #[command(hide = true)]
    IsolationChild,
}

#[derive(Args, Debug)]
pub(crate) struct PluginNew {
    /// Name of the plugin and of the new folder
    #[arg(value_name = "NAME")]
    pub(crate) name: String,
    /// Create a project in C, from the header alone
    #[arg(long)]
    pub(crate) c: bool,
    /// Folder of radsight's sources with the SDK for Rust projects [default: the sources of this
    /// program]
    #[arg(long, value_name = "DIR", conflicts_with = "c")]
    pub(crate) sdk_path: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct PluginList {
    /// Search this folder for plugins first
    #[arg(long, value_name = "DIR")]
    pub(crate) plugin_path: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct PluginCheck {
    /// File of the library, or its name in the search path
    #[arg(value_name = "LIB")]
    pub(crate) library: String,
    /// Only this model, with optional parameters: MODEL or MODEL(number,…)
    #[arg(long, value_name = "MODEL")]
    pub(crate) model: Option<String>,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Time limit of each check, seconds
    #[arg(long, default_value_t = 60)]
    pub(crate) time_limit: u64,
    /// Print the report as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Search this folder for plugins first
    #[arg(long, value_name = "DIR")]
    pub(crate) plugin_path: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct PluginPlot {
    /// File of the library, or its name in the search path
    #[arg(value_name = "LIB")]
    pub(crate) library: String,
    /// The model with its parameters: MODEL or MODEL(number,…)
    #[arg(value_name = "MODEL")]
    pub(crate) model: String,
    /// Search this folder for plugins first
    #[arg(long, value_name = "DIR")]
    pub(crate) plugin_path: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct InstallLinks {
    /// Folder for the links
    #[arg(value_name = "DIR")]
    pub(crate) folder: String,
    /// Folder for manual pages and completions, such as /usr/share [default: DIR/share]
    #[arg(long, value_name = "DIR", conflicts_with = "only_links")]
    pub(crate) share: Option<String>,
    /// Install only the links
    #[arg(long)]
    pub(crate) only_links: bool,
}
