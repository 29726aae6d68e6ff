//! Programs that trace rays.

use super::rendering::{ANSWERS, DEFINITIONS, ONLY_HELP, READING, RENDERING, SAMPLING, TRUST, VIEW};
use crate::option::Listing::{Computed, Fixed, Switch, SwitchOn, Whole};
use crate::option::{ProgramOption, attached, flag, switch, value};
use crate::program::{Group, Program};

const COMMAND_LINE: &str = "@FILE is replaced by the options in a file, and $NAME by those in an environment variable.";

pub(super) const RPICT: Program = Program {
    name: "rpict",
    summary: "render a Radiance picture of a scene",
    synopsis: "rpict [options] [octree | scene …]",
    description: COMMAND_LINE,
    groups: &[
        VIEW,
        Group {
            title: "Picture",
            options: &[
                value("-x", "N", "Most columns").unit("pixels").default("512").listed(Computed),
                value("-y", "N", "Most rows").unit("pixels").default("512").listed(Computed),
                flag("-pRGB", "Write red, green and blue").listed(Computed),
                flag("-pXYZ", "Write CIE X, Y and Z"),
                PRIMARIES,
                value("-pa", "A", "Pixel aspect, height divided by width; 0 to fill the size")
                    .default("1")
                    .listed(Fixed("\t\t\t", "pixel aspect ratio")),
                value(
                    "-pj",
                    "J",
                    "Side of the square in a pixel over which its rays are jittered; 1 with --error or --samples",
                )
                .unit("pixels")
                .default("0.67")
                .listed(Computed),
                value("-pm", "M", "Motion blur: share of the time between two frames during which the view moves")
                    .default("0")
                    .listed(Fixed("\t\t\t", "pixel motion")),
                value("-pd", "D", "Diameter of the aperture; 0 for a pinhole")
                    .unit("scene units")
                    .default("0")
                    .listed(Fixed("\t\t\t", "pixel depth-of-field")),
                value("-ps", "N", "Spacing of the first samples of a preview").default("4").listed(Whole(
                    9,
                    "\t\t\t",
                    "pixel sample",
                )),
                value("-pt", "T", "Contrast below which pixels are interpolated")
                    .default("0.05")
                    .listed(Fixed("\t\t\t", "pixel threshold")),
                switch("-co", "Spectral pictures; -co+ is an error, as in Radiance"),
                flag("-ff", "Write floats instead of four-byte pixels"),
                value("-S", "N", "Number of the first frame of a sequence, whose views are read from standard input"),
            ],
        },
        Group {
            title: "Running",
            options: &[
                value("-t", "S", "Time between progress reports; 0 for none").unit("s").default("0").listed(Computed),
                switch("-w", "Print warnings")
                    .default("+")
                    .listed(Switch(["warning messages off", "warning messages on"])),
                value("-n", "N", "Threads").aliases(&["--threads"]),
                value("--time-limit", "S", "Stop the refinement to a requested error after this processor time")
                    .unit("s"),
                value("-P", "FILE", "Store the command line in a file, or repeat a stored one").aliases(&["-PP"]),
            ],
        },
        Group {
            title: "Files",
            options: &[
                value("-o", "FILE", "Output picture; %d is replaced by the frame number"),
                value("-z", "FILE", "Also write surface distances, as raw floats").unit("scene units"),
                value("-r", "FILE", "Recover rows from an earlier picture"),
                value("-ro", "FILE", "Recover rows from a picture, and finish it in place"),
                value(
                    "-e",
                    "FILE|DEFINITION",
                    "Write messages to a file; or add definitions for the functions of the scene",
                ),
                value("--error-map", "FILE", "Also write the estimated relative error of each pixel"),
                value("--ray-map", "FILE", "Also write the number of rays of each pixel"),
                value("--record", "OUT.json", "Also write a record of how the picture was made"),
            ],
        },
        RENDERING,
        SAMPLING,
        DEFINITIONS,
        READING,
        ANSWERS,
    ],
    defaults: &[
        ("-u", "-"),
        ("-dt", "0.05"),
        ("-dc", "0.5"),
        ("-ds", "0.25"),
        ("-dr", "1"),
        ("-aa", "0.2"),
        ("-ar", "64"),
        ("-ad", "512"),
        ("-as", "128"),
        ("-lr", "7"),
    ],
};

const PRIMARIES: ProgramOption =
    value("-pc", "RX RY GX GY BX BY WX WY", "Write red, green and blue of these primaries and this white");

const WARNINGS: ProgramOption =
    switch("-w", "Print warnings").default("+").listed(Switch(["warning messages off", "warning messages on"]));
const IMMEDIATE: ProgramOption = switch("-I", "Read points and normals, and compute their irradiance")
    .default("-")
    .listed(SwitchOn("immediate irradiance on"));
const THREADS: ProgramOption = value("-n", "N", "Number of threads; one per processor by default").listed(Computed);
const COLUMNS: ProgramOption =
    value("-x", "N", "Columns for the header; alone, number of records between flushes").default("0").listed(Computed);
const ROWS: ProgramOption =
    value("-y", "N", "Rows for the header, and the number of records").default("0").listed(Computed);
const LIMIT: ProgramOption = switch("-ld", "Limit rays to the length of their direction vectors")
    .default("-")
    .listed(Switch(["limit distance off", "limit distance on"]));
const HEADER: ProgramOption =
    switch("-h", "Write a header").default("+").listed(Switch(["no header", "output header"]));

pub(super) const RTRACE: Program = Program {
    name: "rtrace",
    summary: "trace rays from standard input in a scene",
    synopsis: "rtrace [options] octree | scene …",
    description: COMMAND_LINE,
    groups: &[
        Group {
            title: "Input and output",
            options: &[
                WARNINGS,
                IMMEDIATE,
                THREADS,
                COLUMNS,
                ROWS,
                LIMIT,
                HEADER,
                attached("-f", "IO", "Formats of input and output: a text, f floats, d doubles; c of the output alone: pixels")
                    .default("aa")
                    .listed(Computed),
                attached(
                    "-o",
                    "SPEC",
                    "Output of each ray: o origin, d direction, v value, V contribution, w weight, W coefficient, \
                     l length, L first length, c local coordinates, p point, n normal, N unperturbed normal, s surface, \
                     m modifier, M material, r mirrored part, R its length, x unmirrored part, X its length, ~ a tilde; t or T as \
                     prefix: the whole ray tree",
                )
                .default("v")
                .listed(Computed),
                flag("-pRGB", "Write red, green and blue").listed(Computed),
                flag("-pXYZ", "Write CIE X, Y and Z").unit("unit of the value times lm/W"),
                flag("-pY", "Write luminance").unit("cd/m²"),
                flag("-pS", "Write scotopic luminance"),
                flag("-pM", "Write melanopic luminance"),
                flag("-pA", "Write the mean of red, green and blue"),
                PRIMARIES,
                switch("-co", "Write all spectral bands").listed(Computed),
                value("-e", "FILE|DEFINITION", "Write messages to a file; or add definitions for the functions of the scene"),
                value("-ti", "NAME", "End ray trees at surfaces with this modifier"),
                value("-te", "NAME", "End ray trees at all surfaces except those with this modifier"),
                value("-tI", "FILE", "As -ti, for all modifiers listed in a file"),
                value("-tE", "FILE", "As -te, for all modifiers listed in a file"),
                value("-P", "FILE", "Store the command line in a file, or repeat a stored one").aliases(&["-PP"]),
            ],
        },
        RENDERING,
        SAMPLING,
        DEFINITIONS,
        READING,
        ANSWERS,
    ],
    defaults: &[],
};

pub(super) const RCONTRIB: Program = Program {
    name: "rcontrib",
    summary: "compute the contributions of lights or materials to rays from standard input",
    synopsis: "rcontrib [options] { -M FILE | -m NAME } … octree | scene …",
    description: COMMAND_LINE,
    groups: &[
        Group {
            title: "Contributions",
            options: &[
                value("-c", "N", "Number of rays accumulated per record; 0 for all").default("1").listed(Computed),
                switch("-V", "Write contributions instead of coefficients")
                    .default("-")
                    .listed(Switch(["output coefficients", "output contributions"])),
                value("-m", "NAME", "Track the surfaces with this modifier"),
                value("-M", "FILE", "Track all modifiers listed in a file"),
                value(
                    "-o",
                    "FILE",
                    "Output of the following modifiers, with %s for the name and %d for the bin; !COMMAND pipes",
                ),
                value("-b", "EXPRESSION", "Bin of a ray, for the following modifiers"),
                value("-bn", "N", "Number of bins"),
                value("-p", "NAME=VALUE,…", "Parameters of the bins"),
                value("-f", "FILE", "Read definitions for bins from a file"),
                value("-e", "DEFINITIONS", "Add definitions for bins"),
            ],
        },
        Group {
            title: "Input and output",
            options: &[
                IMMEDIATE,
                THREADS,
                COLUMNS,
                ROWS,
                LIMIT,
                HEADER,
                attached(
                    "-f",
                    "IO",
                    "Formats of input and output: a text, f floats, d doubles; c of the output alone: pixels",
                )
                .default("aa")
                .listed(Computed),
                switch("-fo", "Overwrite existing files").default("-"),
                switch("-r", "Recover records from existing files").default("-"),
                value("-t", "S", "Time between reports; accepted, but has no effect")
                    .unit("s")
                    .default("0")
                    .listed(Computed),
                WARNINGS,
            ],
        },
        RENDERING,
        Group {
            title: "Sampling (radsight's own)",
            options: &[
                value("--samples", "N", "Number of paths per ray, instead of -ad"),
                value("--error", "E", "Requested error; not supported"),
            ],
        },
        READING,
        ANSWERS,
    ],
    defaults: &[
        ("-dt", "0"),
        ("-dj", "0.9"),
        ("-dr", "3"),
        ("-st", "0.02"),
        ("-ab", "1"),
        ("-aa", "0"),
        ("-ad", "350"),
        ("-as", "0"),
        ("-lw", "2e-3"),
    ],
};

pub(super) const MKILLUM: Program = Program {
    name: "mkillum",
    summary: "convert windows and other surfaces to light sources",
    synopsis: "mkillum [options] octree | scene … [ < FILE … ]",
    description: "Comments #@mkillum in the files set options of the following surfaces: m=MATERIAL, f=DATA FILE, c=n|a|d colour, \
                  d=DIRECTIONS, s=SAMPLES, b=SMALLEST BRIGHTNESS, l+ or l-, i=NAME or e=NAME or a or n, o=OUTPUT.",
    groups: &[
        Group {
            title: "Running",
            options: &[
                flag("-w", "Do not print warnings"),
                value("-n", "N", "Number of threads; one per processor by default"),
                value("-e", "DEFINITION", "Add definitions for the functions of the scene"),
            ],
        },
        RENDERING,
        SAMPLING,
        DEFINITIONS,
        READING,
        Group {
            title: "Answers",
            options: &[flag("-defaults", "Print the current options and exit"), super::rendering::HELP],
        },
    ],
    defaults: &[("-dj", "0.5"), ("-dr", "3"), ("-ab", "2")],
};

pub(super) const RFLUXMTX: Program = Program {
    name: "rfluxmtx",
    summary: "compute the flux matrix from a sender to receivers",
    synopsis: "rfluxmtx [options] { sender | - } receiver [-i octree] [scene …]",
    description: "Options of rcontrib that are not listed here are passed to it. Comments #@rfluxmtx in the files of sender and \
                  receivers select their bases.",
    groups: &[
        Group {
            title: "Flux matrices",
            options: &[
                switch("-fo", "Overwrite existing files").default("-"),
                flag("-v", "Print commands"),
                value("-bj", "EXPRESSION", "Position of a direction within its patch"),
                value("-c", "N", "Number of rays per sender direction, or per record").default("10000"),
                value("-x", "N", "Columns of rays from standard input"),
                value("-y", "N", "Rows of rays from standard input"),
                switch("-I", "Read points and normals; only for rays from standard input"),
                switch("-i", "Compute the irradiance of surfaces; only for rays from standard input"),
                switch("-ld", "Limit rays to the length of their direction vectors"),
                attached(
                    "-f",
                    "IO",
                    "Formats of input and output: a text, f floats, d doubles; c of the output alone: pixels",
                )
                .default("aa"),
            ],
        },
        Group {
            title: "Passed to rcontrib",
            options: &[
                value("-f", "FILE", "Read definitions for bins from a file"),
                value("-e", "DEFINITIONS", "Add definitions for bins"),
                value("-o", "FILE", "Output of receivers without their own"),
                value("-n", "N", "Threads"),
                value("-t", "S", "Time between reports; accepted, but has no effect").unit("s"),
                switch("-w", "Print warnings").default("+"),
                switch("-V", "Write contributions instead of coefficients").default("-"),
                switch("-h", "Write a header").default("+"),
                switch("-r", "Recover records from existing files").default("-"),
                switch("-u", "Sample without correlation; accepted, but has no effect").default("+"),
                switch("-bv", "Show the back faces of surfaces").default("+"),
                switch("-dv", "Make light sources visible").default("+"),
                value("-dt", "T", "Threshold of direct light; accepted, but has no effect"),
                value("-dc", "C", "Certainty of direct light; accepted, but has no effect"),
                value("-dj", "J", "Jitter of light samples; accepted, but has no effect"),
                value("-ds", "S", "Ratio of size to distance above which a light is subdivided"),
                value("-dr", "N", "Depth of virtual sources: number of mirror reflections"),
                value("-dp", "D", "Density of the pretest; accepted, but has no effect"),
                value("-ss", "S", "Number of samples per highlight; has no effect where many rays are averaged"),
                value("-st", "T", "Specular threshold: reflectance below which a lobe is not sampled").default("0.02"),
                value("-av", "R G B", "Ambient value: radiance used where indirect light is not computed")
                    .unit("W/(sr·m²)")
                    .default("0 0 0"),
                value("-aw", "N", "Weight of the ambient value; accepted, but has no effect"),
                value("-ab", "N", "Diffuse bounces").default("1"),
                value("-aa", "ACC", "Accuracy of the irradiance cache; accepted, but has no effect"),
                value("-ar", "RES", "Resolution of the irradiance cache; accepted, but has no effect"),
                value("-ad", "N", "Number of paths per ray, shared among the rays of a record").default("350"),
                value("-as", "N", "Additional samples; accepted, but has no effect"),
                value("-ae", "NAME", "Exclude surfaces with this modifier from the ambient calculation"),
                value("-ai", "NAME", "Include only surfaces with this modifier in the ambient calculation"),
                value("-aE", "FILE", "As -ae, for all modifiers listed in a file"),
                value("-aI", "FILE", "As -ai, for all modifiers listed in a file"),
                value("-af", "FILE", "File for an irradiance cache; accepted, but has no effect"),
                value("-ap", "FILE", "Photon map; not supported"),
                value("-am", "R", "Search radius of photon maps; accepted, but has no effect"),
                value("-me", "R G B", "Extinction coefficient of the mist that fills the scene").unit("1/scene unit"),
                value("-ma", "R G B", "Scattering albedo of that mist"),
                value("-mg", "G", "Scattering eccentricity of that mist, from 0 to 1"),
                value("-ms", "L", "Distance between samples in mist").unit("scene units"),
                value("-cs", "N", "Number of spectral bands").default("3"),
                value("-cw", "FIRST LAST", "Range of the bands").unit("nm").default("380 780"),
                value("-lr", "N", "Largest number of reflections of a ray; 0 or less for Russian roulette")
                    .default("-10"),
                value("-lw", "W", "Weight below which a ray ends").default("2e-3"),
                value("--samples", "N", "Number of paths per ray"),
                value("--seed", "N", "Seed of the sample sequence").default("0"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const VWRAYS: Program = Program {
    name: "vwrays",
    summary: "write the rays of a view's pixels, for rtrace",
    synopsis: "vwrays [options] { view options | picture [distances] }",
    description: "",
    groups: &[
        Group {
            title: "Rays",
            options: &[
                attached("-f", "FORMAT", "Format of the rays: a text, f floats, d doubles").default("a"),
                flag("-d", "Print only the size of the picture, as options of rtrace"),
                flag("-i", "Read the coordinates of pixels from standard input"),
                flag("-u", "Flush each record before reading more"),
                value("-x", "N", "Most columns").unit("pixels").default("512"),
                value("-y", "N", "Most rows").unit("pixels").default("512"),
                value("-c", "N", "Number of rays per pixel").default("1"),
                value("-pa", "A", "Pixel aspect, height divided by width").default("1"),
                value("-pj", "J", "Side of the square in a pixel over which its rays are jittered")
                    .unit("pixels")
                    .default("0"),
                value("-pd", "D", "Diameter of the aperture").unit("scene units").default("0"),
                value("--seed", "N", "Seed of the sample sequence").default("0"),
            ],
        },
        VIEW,
        ONLY_HELP,
    ],
    defaults: &[],
};
