//! The programs that trace rays.

use super::rendering::{ANSWERS, DEFINITIONS, ONLY_HELP, READING, RENDERING, SAMPLING, TRUST, VIEW};
use crate::option::Listing::{Computed, Fixed, Switch, SwitchOn, Whole};
use crate::option::{ProgramOption, attached, flag, switch, value};
use crate::program::{Group, Program};

const COMMAND_LINE: &str = "Among the options @FILE stands for the words of a file, and $NAME for those of a variable of the \
                            environment.";

pub(super) const RPICT: Program =
    Program {
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
                    value("-pa", "A", "Height over width of a pixel; 0 for whatever fills the size")
                        .default("1")
                        .listed(Fixed("\t\t\t", "pixel aspect ratio")),
                    value(
                        "-pj",
                        "J",
                        "Side of the square in which the rays of a pixel are spread; 1 with --error or --samples",
                    )
                    .unit("pixels")
                    .default("0.67")
                    .listed(Computed),
                    value("-pm", "M", "Share of the time between two frames during which the view moves")
                        .default("0")
                        .listed(Fixed("\t\t\t", "pixel motion")),
                    value("-pd", "D", "Diameter of the aperture; 0 for a pinhole")
                        .unit("scene units")
                        .default("0")
                        .listed(Fixed("\t\t\t", "pixel depth-of-field")),
                    value("-ps", "N", "Pixels between the first samples of a quick picture")
                        .default("4")
                        .listed(Whole(9, "\t\t\t", "pixel sample")),
                    value("-pt", "T", "Contrast below which pixels between samples are interpolated")
                        .default("0.05")
                        .listed(Fixed("\t\t\t", "pixel threshold")),
                    switch("-co", "Spectral pictures; -co+ is refused, as in Radiance"),
                    flag("-ff", "Write floats in place of pixels of four bytes"),
                    value("-S", "N", "Number of the first frame of a sequence, whose views stand on standard input"),
                ],
            },
            Group {
                title: "Running",
                options: &[
                    value("-t", "S", "Time between reports of progress; 0 for none")
                        .unit("s")
                        .default("0")
                        .listed(Computed),
                    switch("-w", "Print warnings")
                        .default("+")
                        .listed(Switch(["warning messages off", "warning messages on"])),
                    value("-n", "N", "Threads").aliases(&["--threads"]),
                    value("--time-limit", "S", "Stop work on an asked error after this processor time").unit("s"),
                    value("-P", "FILE", "Keep the command line in a file, or do again what it says").aliases(&["-PP"]),
                ],
            },
            Group {
                title: "Files",
                options: &[
                    value("-o", "FILE", "Write the picture here; %d stands for the number of a frame"),
                    value("-z", "FILE", "Also write the distances of the surfaces, as raw floats").unit("scene units"),
                    value("-r", "FILE", "Recover the rows of an earlier picture"),
                    value("-ro", "FILE", "Recover the rows of a picture, and finish it in place"),
                    value(
                        "-e",
                        "FILE|DEFINITION",
                        "Send messages to a file; or define something for the functions of the scene",
                    ),
                    value("--error-map", "FILE", "Also write the estimated relative error of each pixel"),
                    value("--ray-map", "FILE", "Also write the number of rays of each pixel"),
                    value("--record", "OUT.json", "Also write how the picture was made"),
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
const IMMEDIATE: ProgramOption = switch("-I", "Take the rays as points and normals, and give their irradiance")
    .default("-")
    .listed(SwitchOn("immediate irradiance on"));
const THREADS: ProgramOption =
    value("-n", "N", "Threads; one for each processor where nothing is said").listed(Computed);
const COLUMNS: ProgramOption = value("-x", "N", "Columns for the header; alone, records after which output is sent on")
    .default("0")
    .listed(Computed);
const ROWS: ProgramOption =
    value("-y", "N", "Rows for the header, and the number of records").default("0").listed(Computed);
const LIMIT: ProgramOption = switch("-ld", "End rays where their directions end")
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
                    "What is written of each ray: o origin, d direction, v value, V contribution, w weight, W coefficient, \
                     l length, L first length, c local coordinates, p point, n normal, N unperturbed normal, s surface, \
                     m modifier, M material, r mirrored part, R its length, x the rest, X its length, ~ a tilde; t or T in \
                     front: the whole ray tree",
                )
                .default("v")
                .listed(Computed),
                flag("-pRGB", "Write red, green and blue").listed(Computed),
                flag("-pXYZ", "Write CIE X, Y and Z").unit("lm/W times the unit of the value"),
                flag("-pY", "Write luminance").unit("cd/m²"),
                flag("-pS", "Write scotopic luminance"),
                flag("-pM", "Write melanopic luminance"),
                flag("-pA", "Write the mean of red, green and blue"),
                PRIMARIES,
                switch("-co", "Write all spectral bands").listed(Computed),
                value("-e", "FILE|DEFINITION", "Send messages to a file; or define something for the functions of the scene"),
                value("-ti", "NAME", "End ray trees at surfaces with this modifier"),
                value("-te", "NAME", "End ray trees at all surfaces but those with this modifier"),
                value("-tI", "FILE", "As -ti, for all modifiers that a file names"),
                value("-tE", "FILE", "As -te, for all modifiers that a file names"),
                value("-P", "FILE", "Keep the command line in a file, or do again what it says").aliases(&["-PP"]),
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
    summary: "find how much each light or material contributes to rays from standard input",
    synopsis: "rcontrib [options] { -M FILE | -m NAME } … octree | scene …",
    description: COMMAND_LINE,
    groups: &[
        Group {
            title: "Contributions",
            options: &[
                value("-c", "N", "Rays that are summed up in a record; 0 for all").default("1").listed(Computed),
                switch("-V", "Write contributions in place of coefficients")
                    .default("-")
                    .listed(Switch(["output coefficients", "output contributions"])),
                value("-m", "NAME", "Track the surfaces with this modifier"),
                value("-M", "FILE", "Track all modifiers that a file names"),
                value(
                    "-o",
                    "FILE",
                    "Output of the modifiers that follow, with %s for the name and %d for the bin; !COMMAND pipes",
                ),
                value("-b", "EXPRESSION", "Bin of a ray, for the modifiers that follow"),
                value("-bn", "N", "Number of bins"),
                value("-p", "NAME=VALUE,…", "Parameters of the bins"),
                value("-f", "FILE", "Read definitions for bins from a file"),
                value("-e", "DEFINITIONS", "Define something for bins"),
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
                switch("-fo", "Write over files that exist").default("-"),
                switch("-r", "Go on with records that the files have already").default("-"),
                value("-t", "S", "Time between reports; accepted, and without effect here")
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
                value("--samples", "N", "Paths that each ray stands for, in place of -ad"),
                value("--error", "E", "An asked error, which is refused"),
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
    summary: "turn windows and other surfaces into lights with the light that they pass on",
    synopsis: "mkillum [options] octree | scene … [ < FILE … ]",
    description: "Comments #@mkillum in the files set, for the surfaces that follow: m=MATERIAL, f=DATA FILE, c=n|a|d colour, \
                  d=DIRECTIONS, s=SAMPLES, b=LEAST BRIGHTNESS, l+ or l-, i=NAME or e=NAME or a or n, o=OUTPUT.",
    groups: &[
        Group {
            title: "Running",
            options: &[
                flag("-w", "Do not print warnings"),
                value("-n", "N", "Threads; one for each processor where nothing is said"),
                value("-e", "DEFINITION", "Define something for the functions of the scene"),
            ],
        },
        RENDERING,
        SAMPLING,
        DEFINITIONS,
        READING,
        Group {
            title: "Answers",
            options: &[flag("-defaults", "Print the options as they stand, then end"), super::rendering::HELP],
        },
    ],
    defaults: &[("-dj", "0.5"), ("-dr", "3"), ("-ab", "2")],
};

pub(super) const RFLUXMTX: Program = Program {
    name: "rfluxmtx",
    summary: "compute the flux matrix from a sender to receivers",
    synopsis: "rfluxmtx [options] { sender | - } receiver [-i octree] [scene …]",
    description: "The options of rcontrib not listed here are passed on to it. Comments #@rfluxmtx in the files of sender and \
                  receivers choose their bases.",
    groups: &[
        Group {
            title: "Flux matrices",
            options: &[
                switch("-fo", "Write over files that exist").default("-"),
                flag("-v", "Say what is run"),
                value("-bj", "EXPRESSION", "Place in its patch at which a direction counts"),
                value("-c", "N", "Rays for each direction of the sender, or in a record").default("10000"),
                value("-x", "N", "Columns of rays from standard input"),
                value("-y", "N", "Rows of rays from standard input"),
                switch("-I", "Take the rays as points and normals; for rays from standard input alone"),
                switch("-i", "Give the irradiance of surfaces; for rays from standard input alone"),
                switch("-ld", "End rays where their directions end"),
                attached(
                    "-f",
                    "IO",
                    "Formats of input and output: a text, f floats, d doubles; c of the output alone: pixels",
                )
                .default("aa"),
            ],
        },
        Group {
            title: "Passed on to rcontrib",
            options: &[
                value("-f", "FILE", "Read definitions for bins from a file"),
                value("-e", "DEFINITIONS", "Define something for bins"),
                value("-o", "FILE", "Output of receivers that name none"),
                value("-n", "N", "Threads"),
                value("-t", "S", "Time between reports; accepted, and without effect here").unit("s"),
                switch("-w", "Print warnings").default("+"),
                switch("-V", "Write contributions in place of coefficients").default("-"),
                switch("-h", "Write a header").default("+"),
                switch("-r", "Go on with records that the files have already").default("-"),
                switch("-u", "Sample without correlation; accepted, and without effect here").default("+"),
                switch("-bv", "Show the back faces of surfaces").default("+"),
                switch("-dv", "Show the lights themselves").default("+"),
                value("-dt", "T", "Threshold of direct light; accepted, and without effect here"),
                value("-dc", "C", "Certainty of direct light; accepted, and without effect here"),
                value("-dj", "J", "Jitter of the points on lights; accepted, and without effect here"),
                value("-ds", "S", "Size over distance above which a light is sampled in parts"),
                value("-dr", "N", "Mirror reflections through which a light is followed"),
                value("-dp", "D", "Density of the pretest; accepted, and without effect here"),
                value("-ss", "S", "Rays for each highlight; without effect where many rays are averaged"),
                value("-st", "T", "Reflectance below which a lobe is not sampled").default("0.02"),
                value("-av", "R G B", "Ambient radiance where nothing is gathered").unit("W/(sr·m²)").default("0 0 0"),
                value("-aw", "N", "Weight of the ambient value; accepted, and without effect here"),
                value("-ab", "N", "Diffuse bounces").default("1"),
                value("-aa", "ACC", "Accuracy of the irradiance cache; accepted, and without effect here"),
                value("-ar", "RES", "Resolution of the irradiance cache; accepted, and without effect here"),
                value("-ad", "N", "Paths that each ray stands for, shared among the rays of a record").default("350"),
                value("-as", "N", "Further rays; accepted, and without effect here"),
                value("-ae", "NAME", "Gather no ambient light on surfaces with this modifier"),
                value("-ai", "NAME", "Gather ambient light on surfaces with this modifier alone"),
                value("-aE", "FILE", "As -ae, for all modifiers that a file names"),
                value("-aI", "FILE", "As -ai, for all modifiers that a file names"),
                value("-af", "FILE", "File for an irradiance cache; accepted, and without effect here"),
                value("-ap", "FILE", "Photon maps, which are refused: there are none here"),
                value("-am", "R", "Search radius of photon maps; accepted, and without effect here"),
                value("-me", "R G B", "Extinction of the mist that fills the scene").unit("1/scene unit"),
                value("-ma", "R G B", "Scattering albedo of that mist"),
                value("-mg", "G", "Scattering eccentricity of that mist, from 0 to 1"),
                value("-ms", "L", "Distance between samples in mist").unit("scene units"),
                value("-cs", "N", "Spectral bands that are traced").default("3"),
                value("-cw", "FIRST LAST", "Range of the bands").unit("nm").default("380 780"),
                value("-lr", "N", "Reflections after which a ray ends; 0 or less for Russian roulette").default("-10"),
                value("-lw", "W", "Weight below which a ray ends").default("2e-3"),
                value("--samples", "N", "Paths that each ray stands for"),
                value("--seed", "N", "Choose the sample sequence").default("0"),
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
                flag("-d", "Print the size of the picture as options of rtrace instead"),
                flag("-i", "Read the coordinates of pixels from standard input"),
                flag("-u", "Send each record on before more is read"),
                value("-x", "N", "Most columns").unit("pixels").default("512"),
                value("-y", "N", "Most rows").unit("pixels").default("512"),
                value("-c", "N", "Rays for each pixel").default("1"),
                value("-pa", "A", "Height over width of a pixel").default("1"),
                value("-pj", "J", "Side of the square in which the rays of a pixel are spread")
                    .unit("pixels")
                    .default("0"),
                value("-pd", "D", "Diameter of the aperture").unit("scene units").default("0"),
                value("--seed", "N", "Choose the sample sequence").default("0"),
            ],
        },
        VIEW,
        ONLY_HELP,
    ],
    defaults: &[],
};
