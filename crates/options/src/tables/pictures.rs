//! Programs that process pictures.

use super::rendering::{ONLY_HELP, VIEW};
use crate::option::{attached, beginning, flag, signed, switch, value};
use crate::program::{Group, Program};

pub(super) const FALSECOLOR: Program = Program {
    name: "falsecolor",
    summary: "map the brightness of a picture to colours, contours or bands, with a legend",
    synopsis: "falsecolor [options] [-i picture]",
    description: "Without -i the picture is read from standard input.",
    groups: &[
        Group {
            title: "Pictures",
            options: &[
                value("-i", "FILE", "The picture"),
                value("-p", "FILE", "Background picture of contours"),
                beginning("-ip", "FILE", "The same picture for both").aliases(&["-pi"]),
            ],
        },
        Group {
            title: "Scale",
            options: &[
                beginning("-s", "TOP|auto", "Top of the scale").unit("as labelled").default("1000"),
                beginning("-log", "DECADES", "Logarithmic scale over this many decades"),
                beginning("-m", "FACTOR", "Factor from picture values to scale values").default("179"),
                beginning("-n", "N", "Number of divisions of the legend").default("8"),
            ],
        },
        Group {
            title: "Colours",
            options: &[
                value("-pal", "NAME", "Palette: def, spec, pm3d, hot, eco or tbo").default("def"),
                beginning("-palettes", "", "Show all palettes instead"),
                attached("-spec", "", "Removed; use -pal spec"),
                beginning("-cl", "", "Draw contour lines"),
                beginning("-cb", "", "Draw contour bands"),
                beginning("-cp", "", "Draw steps of even colour"),
                beginning("-c0", "", "Use no colours"),
                beginning("-r", "EXPRESSION", "Red as a function of v, from 0 to 1 along the scale"),
                beginning("-g", "EXPRESSION", "Green, likewise"),
                beginning("-b", "EXPRESSION", "Blue, likewise"),
            ],
        },
        Group {
            title: "Legend and marks",
            options: &[
                value("-l", "LABEL", "Text above the legend").default("cd/m2"),
                beginning("-d", "N", "Largest number of decimals").default("3"),
                beginning("-lw", "N", "Width of the legend; 0 for none").unit("pixels").default("100"),
                beginning("-lh", "N", "Height of the legend; 0 for none").unit("pixels").default("200"),
                beginning("-e", "", "Mark the darkest and the brightest pixel"),
                value("-odim", "COLUMNS ROWS", "Print this many values on the picture"),
                beginning("-orct", "LEFT LOWER RIGHT UPPER", "The part of the picture for -odim").unit("pixels"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GETINFO: Program = Program {
    name: "getinfo",
    summary: "print or change the headers of Radiance files",
    synopsis: "getinfo [-d | +d] [file … | - | -a line … | -r line … | -c command …]",
    description: "",
    groups: &[
        Group {
            title: "What is printed or changed",
            options: &[
                beginning("-d", "", "Print only the size of pictures"),
                beginning("+d", "", "Also print the size of pictures"),
                value("-a", "LINE", "Add lines to the header of standard input; must be the last option"),
                value(
                    "-r",
                    "LINE",
                    "Replace lines of the header of standard input; NAME= alone removes; must be the last option",
                ),
                value(
                    "-c",
                    "COMMAND",
                    "Pipe standard input without its header through a command, and record the command in the header; must be the last option",
                ),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PCOMB: Program = Program {
    name: "pcomb",
    summary: "combine pictures by functions of their pixels",
    synopsis: "pcomb [-h] [-w] [-ff|-fc] [-x N] [-y N] [-f file] [-e definitions] [[-o] [-s F] [-c R G B] picture …]",
    description: "ro go bo or lo define the output; the default is the sum. ri(n) gi(n) bi(n) li(n) are the inputs, with optional \
                  pixel offsets as second and third argument.",
    groups: &[
        Group {
            title: "Result",
            options: &[
                beginning("-h", "", "Omit the headers of the inputs"),
                beginning("-w", "", "Do not print warnings"),
                value("-x", "N", "Columns of the result; an expression of xmax and ymax"),
                value("-y", "N", "Rows of the result; an expression of xmax and ymax"),
                attached("-f", "f|c", "Write floats, or four-byte pixels (default)"),
                value("-f", "FILE", "Read definitions from a file"),
                value("-e", "DEFINITIONS", "Define something"),
            ],
        },
        Group {
            title: "Before a picture",
            options: &[
                beginning("-o", "", "Undo the exposures of the next picture"),
                beginning("-s", "F", "Multiply the next picture"),
                beginning("-c", "R G B", "Multiply the components of the next picture"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PCOMPOS: Program = Program {
    name: "pcompos",
    summary: "compose pictures side by side and on top of each other",
    synopsis: "pcompos [-h] [-x N] [-y N] [-b R G B] [-lh H] [-la] [[-t L] [+t L] [=SS] [-l label] picture x y] …",
    description: "With -a pictures are arranged in columns and have no positions. A picture that begins with ! is a command.",
    groups: &[
        Group {
            title: "Result",
            options: &[
                flag("-h", "Omit the headers of the inputs"),
                value("-x", "N", "Columns of the result").unit("pixels"),
                value("-y", "N", "Rows of the result").unit("pixels"),
                value("-b", "R G B", "Background colour").default("0 0 0"),
                value("-a", "N", "Arrange the pictures in N columns; a negative N fills rows from the top"),
                value("-s", "N", "Space between columns").unit("pixels").default("0"),
                value("-o", "X Y", "Lower left corner of the first picture").unit("pixels").default("0 0"),
                flag("-la", "Label each picture with its name"),
                value("-lh", "H", "Height of labels").unit("pixels").default("24"),
            ],
        },
        Group {
            title: "Before a picture",
            options: &[
                beginning("-t", "L", "Show only pixels brighter than this"),
                beginning("+t", "L", "Show only pixels darker than this"),
                value("-l", "LABEL", "Label the picture"),
                attached(
                    "=",
                    "SS",
                    "For each axis, the anchor of x and y: - the lower side, + the upper side, 0 the centre",
                )
                .default("--"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PCOND: Program = Program {
    name: "pcond",
    summary: "tone map a picture as an observer would see the scene",
    synopsis: "pcond [options] [input [output]]",
    description: "",
    groups: &[
        Group {
            title: "The eye",
            options: &[
                switch("-h", "Simulate all limits of the eye").default("-"),
                switch("-a", "Simulate the loss of acuity in the dark").default("-"),
                switch("-v", "Add veiling glare").default("-"),
                switch("-s", "Simulate the contrast sensitivity of the eye").default("-"),
                switch("-c", "Simulate the loss of colour in the dark").default("-"),
                switch("-w", "Weight the centre of the picture").default("-"),
                value("-i", "F", "Read fixation points from standard input, with a weight F"),
                switch("-I", "Read a histogram from standard input").default("-"),
            ],
        },
        Group {
            title: "Exposure",
            options: &[
                switch("-l", "Use a linear exposure").default("-"),
                value("-e", "E", "Use a linear exposure factor; with a sign, stops"),
                value("-x", "FILE", "Also write the mapping to a file"),
            ],
        },
        Group {
            title: "The display",
            options: &[
                value("-u", "L", "Largest luminance").unit("cd/m²").default("100"),
                value("-d", "R", "Dynamic range: largest divided by smallest luminance").default("100"),
                value("-p", "RX RY GX GY BX BY WX WY", "Primaries and white"),
                value("-f", "FILE", "Calibration by macbethcal"),
                value("-m", "FILE", "Colour warp"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PEXTREM: Program = Program {
    name: "pextrem",
    summary: "find the darkest and the brightest pixel of a picture",
    synopsis: "pextrem [-o|-O] [picture]",
    description: "",
    groups: &[
        Group {
            title: "Values",
            options: &[
                flag("-o", "Undo the exposures"),
                flag("-O", "Undo the exposures, and print XYZE pictures in W/(sr·m²), too"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PFILT: Program = Program {
    name: "pfilt",
    summary: "change the exposure and the size of a picture",
    synopsis: "pfilt [options] [picture]",
    description: "",
    groups: &[
        Group {
            title: "Passes and exposure",
            options: &[
                flag("-1", "Read the picture once; only -e sets the exposure"),
                flag("-2", "Read the picture twice, and scale its mean brightness to 0.5"),
                value("-e", "E", "Exposure factor; with a sign, stops").default("1"),
                value("-er", "E", "The same of red"),
                value("-eg", "E", "The same of green"),
                value("-eb", "E", "The same of blue"),
                value("-t", "LAMP", "Balance the light of this lamp to white"),
                value("-f", "FILE", "Lamp table for -t").default("lamp.tab"),
            ],
        },
        Group {
            title: "Size",
            options: &[
                value("-x", "N|/R", "Columns, or /N to reduce them by a factor N"),
                value("-y", "N|/R", "Rows, or /N to reduce them by a factor N"),
                value("-p", "A", "Pixel aspect, height divided by width; 0 to fill the size"),
                flag("-c", "Do not record the pixel aspect"),
                flag("-b", "Use a box filter (default)"),
                value("-r", "R", "Use a Gaussian filter of this radius").unit("output pixels").default("0"),
                value("-m", "F", "As -r, with a limit on the share of an output pixel from one input pixel"),
            ],
        },
        Group {
            title: "Star patterns",
            options: &[
                value("-n", "N", "Points of a star").default("0"),
                value("-s", "S", "Spread of a star").default("0.0001"),
                value("-h", "L", "Brightness threshold of hot pixels").unit("W/(sr·m²)").default("100"),
                flag("-a", "Include hot pixels in the average"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PFLIP: Program = Program {
    name: "pflip",
    summary: "mirror a picture",
    synopsis: "pflip [-h] [-v] [-c] [picture [output]]",
    description: "",
    groups: &[
        Group {
            title: "Direction",
            options: &[
                flag("-h", "Mirror left and right"),
                flag("-v", "Mirror top and bottom"),
                flag("-c", "Keep the order of the input in the resolution, so that the picture is seen mirrored"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PROTATE: Program = Program {
    name: "protate",
    summary: "rotate a picture by 90° clockwise",
    synopsis: "protate [-r] [-c] picture [output]",
    description: "",
    groups: &[
        Group {
            title: "Direction",
            options: &[
                flag("-r", "Turn counterclockwise"),
                flag("-c", "Keep the order of the input in the resolution, so that the picture is seen turned"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PINTERP: Program = Program {
    name: "pinterp",
    summary: "synthesise views from pictures of other views and their distances",
    synopsis: "pinterp [view options] [options] picture distances …",
    description: "Distances are a file from rpict -z, or one number for all pixels.",
    groups: &[
        VIEW,
        Group {
            title: "Picture",
            options: &[
                value("-x", "N", "Most columns").unit("pixels").default("512"),
                value("-y", "N", "Most rows").unit("pixels").default("512"),
                value("-pa", "A", "Pixel aspect, height divided by width").default("1"),
                value("-z", "FILE", "Also write distances").unit("scene units"),
                value("-e", "E", "Exposure factor; with a sign, stops").default("1"),
                value("-t", "EPS", "Relative difference of distances within one surface").default("0.02"),
                flag("-a", "Average pixels of the same surface"),
                flag("-q", "Do not average"),
                flag("-B", "Average over all views of standard input"),
                flag("-n", "Measure distances along the view direction"),
            ],
        },
        Group {
            title: "Gaps",
            options: &[
                flag("-f0", "Fill no gaps"),
                flag("-ff", "Fill gaps between pixels of one surface"),
                flag("-fb", "Fill gaps behind edges"),
                flag("-fa", "Fill both (default)"),
                value("-fs", "N", "Largest width of filled gaps; 0 for no limit").unit("pixels").default("0"),
                value("-fc", "R G B", "Colour of the remaining pixels").default("0 0 0"),
                value("-fz", "Z", "Distance of the remaining pixels").unit("scene units"),
                value("-fr", "OPTIONS", "Trace rays for the remaining pixels: rtrace's options and scene, in one word"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PSIGN: Program = Program {
    name: "psign",
    summary: "write text as a picture",
    synopsis: "psign [options] [text …]",
    description: "Without text it is read from standard input.",
    groups: &[
        Group {
            title: "Letters",
            options: &[
                value("-cb", "R G B", "Colour of the background").default("1 1 1"),
                value("-cf", "R G B", "Colour of the letters").default("0 0 0"),
                value("-f", "FONT", "Font file").default("helvet.fnt"),
                flag("-dr", "Write to the right (default)"),
                flag("-du", "Write upwards"),
                flag("-dl", "Write to the left, upside down"),
                flag("-dd", "Write downwards"),
                value("-h", "N", "Height of a letter").unit("pixels").default("32"),
                value("-a", "A", "Height divided by width of a letter").default("1.67"),
                value("-s", "S", "Space between letters").unit("letter widths").default("0"),
                value("-x", "N", "Columns of the picture").unit("pixels"),
                value("-y", "N", "Rows of the picture").unit("pixels"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PVALUE: Program = Program {
    name: "pvalue",
    summary: "print a picture as numbers, or convert numbers to a picture",
    synopsis: "pvalue [options] [file] | pvalue -r [options] [file | red green blue]",
    description: "",
    groups: &[
        Group {
            title: "Direction and header",
            options: &[
                signed("-r", "", "Convert numbers to a picture"),
                signed("-h", "", "Omit the header"),
                signed("-H", "", "Omit the resolution"),
                signed("-s", "N", "Skip this many bytes of the input").unit("bytes"),
                signed("-u", "", "Omit repeated pixels; with -r write no run-length encoding"),
                beginning("-x", "N", "Columns of a picture without resolution").unit("pixels").aliases(&["+x", "-X", "+X"]),
                beginning("-y", "N", "Rows of a picture without resolution").unit("pixels").aliases(&["+y", "-Y", "+Y"]),
            ],
        },
        Group {
            title: "Values",
            options: &[
                signed("-o", "", "Undo the exposures"),
                signed("-O", "", "Undo the exposures, and print XYZE pictures in W/(sr·m²), too"),
                signed("-g", "GAMMA", "Gamma of the numbers").default("1"),
                signed("-e", "E", "Exposure factor; with a sign, stops").default("1"),
                signed("-R", "", "Write blue first"),
                signed("-n", "", "Write components as planes, one after another"),
                signed("-b", "", "Write only brightness"),
                beginning("-pr", "", "Write only red").aliases(&["+pr", "-pR", "+pR"]),
                beginning("-pg", "", "Write only green").aliases(&["+pg", "-pG", "+pG"]),
                beginning("-pb", "", "Write only blue").aliases(&["+pb", "-pB", "+pB"]),
                beginning("-pX", "", "Write an XYZE picture").aliases(&["+pX", "-px", "+px"]),
                signed("-p", "RX RY GX GY BX BY WX WY", "Primaries and white of the picture"),
                attached("-d", "[FORM]", "Omit positions; number format: a text, i integers, b bytes, w words, f floats, d doubles; capitals swap bytes")
                    .aliases(&["+d"]),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};
