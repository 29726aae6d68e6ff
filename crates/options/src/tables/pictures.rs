//! The programs that change pictures.

use super::rendering::{ONLY_HELP, VIEW};
use crate::option::{attached, beginning, flag, signed, switch, value};
use crate::program::{Group, Program};

pub(super) const FALSECOLOR: Program = Program {
    name: "falsecolor",
    summary: "show the brightness of a picture as colours, contours or bands, with a legend",
    synopsis: "falsecolor [options] [-i picture]",
    description: "Without -i the picture stands on standard input.",
    groups: &[
        Group {
            title: "Pictures",
            options: &[
                value("-i", "FILE", "The picture"),
                value("-p", "FILE", "A picture behind contours"),
                beginning("-ip", "FILE", "The same picture for both").aliases(&["-pi"]),
            ],
        },
        Group {
            title: "Scale",
            options: &[
                beginning("-s", "TOP|auto", "Top of the scale").unit("the unit of the label").default("1000"),
                beginning("-log", "DECADES", "Make the scale logarithmic, over so many decades"),
                beginning("-m", "FACTOR", "Factor from the picture's values to the scale's").default("179"),
                beginning("-n", "N", "Divisions of the legend").default("8"),
            ],
        },
        Group {
            title: "Colours",
            options: &[
                value("-pal", "NAME", "Palette: def, spec, pm3d, hot, eco or tbo").default("def"),
                beginning("-palettes", "", "Show all palettes instead"),
                attached("-spec", "", "Has gone; use -pal spec"),
                beginning("-cl", "", "Draw contour lines"),
                beginning("-cb", "", "Draw contour bands"),
                beginning("-cp", "", "Draw steps of even colour"),
                beginning("-c0", "", "Draw no colours"),
                beginning("-r", "EXPRESSION", "Red as a function of v, from 0 to 1 along the scale"),
                beginning("-g", "EXPRESSION", "Green, likewise"),
                beginning("-b", "EXPRESSION", "Blue, likewise"),
            ],
        },
        Group {
            title: "Legend and marks",
            options: &[
                value("-l", "LABEL", "Text above the legend").default("cd/m2"),
                beginning("-d", "N", "Most digits behind the point").default("3"),
                beginning("-lw", "N", "Width of the legend; 0 for none").unit("pixels").default("100"),
                beginning("-lh", "N", "Height of the legend; 0 for none").unit("pixels").default("200"),
                beginning("-e", "", "Mark the darkest and the brightest pixel"),
                value("-odim", "COLUMNS ROWS", "Write so many values over the picture"),
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
                beginning("-d", "", "Print the size of pictures instead"),
                beginning("+d", "", "Print the size of pictures, too"),
                value("-a", "LINE", "Add lines to the header of standard input; stands last"),
                value("-r", "LINE", "Replace lines of the header of standard input; NAME= alone removes; stands last"),
                value(
                    "-c",
                    "COMMAND",
                    "Let a command have all but the header of standard input, and add it there; stands last",
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
    description: "ro go bo or lo are what comes out, the sums where nothing is defined; ri(n) gi(n) bi(n) li(n) are the inputs, \
                  with offsets as second and third argument.",
    groups: &[
        Group {
            title: "Result",
            options: &[
                beginning("-h", "", "Leave the headers of the inputs out"),
                beginning("-w", "", "Do not print warnings"),
                value("-x", "N", "Columns of the result; an expression of xmax and ymax"),
                value("-y", "N", "Rows of the result; an expression of xmax and ymax"),
                attached("-f", "f|c", "Write floats, or as usual pixels of four bytes"),
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
    summary: "put pictures side by side and over one another",
    synopsis: "pcompos [-h] [-x N] [-y N] [-b R G B] [-lh H] [-la] [[-t L] [+t L] [=SS] [-l label] picture x y] …",
    description: "With -a the pictures stand in columns and have no places of their own. A picture that begins with ! is a command.",
    groups: &[
        Group {
            title: "Result",
            options: &[
                flag("-h", "Leave the headers of the inputs out"),
                value("-x", "N", "Columns of the result").unit("pixels"),
                value("-y", "N", "Rows of the result").unit("pixels"),
                value("-b", "R G B", "Colour of what no picture covers").default("0 0 0"),
                value("-a", "N", "Place the pictures in N columns; a negative N fills rows from the top"),
                value("-s", "N", "Space between columns").unit("pixels").default("0"),
                value("-o", "X Y", "Lower left corner of the first picture").unit("pixels").default("0 0"),
                flag("-la", "Label each picture with its name"),
                value("-lh", "H", "Height of labels").unit("pixels").default("24"),
            ],
        },
        Group {
            title: "Before a picture",
            options: &[
                beginning("-t", "L", "Show only what is brighter than this"),
                beginning("+t", "L", "Show only what is darker than this"),
                value("-l", "LABEL", "Label the picture"),
                attached(
                    "=",
                    "SS",
                    "For each axis, the corner that x and y mean: - the lower, + the upper, 0 the middle",
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
    summary: "show a picture on a display as the eye would see the scene",
    synopsis: "pcond [options] [input [output]]",
    description: "",
    groups: &[
        Group {
            title: "The eye",
            options: &[
                switch("-h", "Imitate all limits of the eye").default("-"),
                switch("-a", "Imitate the loss of acuity in the dark").default("-"),
                switch("-v", "Add veiling glare").default("-"),
                switch("-s", "Use the eye's sensitivity to contrast").default("-"),
                switch("-c", "Imitate the loss of colour in the dark").default("-"),
                switch("-w", "Weight the middle of the picture").default("-"),
                value("-i", "F", "Read fixations from standard input, which count as a share F"),
                switch("-I", "Read a histogram from standard input").default("-"),
            ],
        },
        Group {
            title: "Exposure",
            options: &[
                switch("-l", "Use a linear exposure").default("-"),
                value("-e", "E", "Use a linear exposure of this factor, or with a sign of so many stops"),
                value("-x", "FILE", "Also write the mapping that was used"),
            ],
        },
        Group {
            title: "The display",
            options: &[
                value("-u", "L", "Largest luminance").unit("cd/m²").default("100"),
                value("-d", "R", "Largest over smallest luminance").default("100"),
                value("-p", "RX RY GX GY BX BY WX WY", "Primaries and white"),
                value("-f", "FILE", "Calibration by macbethcal"),
                value("-m", "FILE", "Map of colours"),
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
                flag("-O", "Undo the exposures, and give XYZE pictures in W/(sr·m²) too"),
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
                flag("-1", "Read the picture once; the exposure is that of -e alone"),
                flag("-2", "Read the picture twice, and make its mean brightness 0.5"),
                value("-e", "E", "Factor of the exposure, or with a sign stops").default("1"),
                value("-er", "E", "The same of red"),
                value("-eg", "E", "The same of green"),
                value("-eb", "E", "The same of blue"),
                value("-t", "LAMP", "Make the light of this lamp white"),
                value("-f", "FILE", "Table of lamps for -t").default("lamp.tab"),
            ],
        },
        Group {
            title: "Size",
            options: &[
                value("-x", "N|/R", "Columns, or the factor by which they shrink"),
                value("-y", "N|/R", "Rows, or the factor by which they shrink"),
                value("-p", "A", "Height over width of a pixel; 0 keeps what fills the size"),
                flag("-c", "Do not record the shape of pixels"),
                flag("-b", "Average with a box filter, as usual"),
                value("-r", "R", "Average with a Gaussian filter of this radius").unit("output pixels").default("0"),
                value("-m", "F", "As -r, with at most this share of an output pixel from one input pixel"),
            ],
        },
        Group {
            title: "Star patterns",
            options: &[
                value("-n", "N", "Points of a star").default("0"),
                value("-s", "S", "Spread of a star").default("0.0001"),
                value("-h", "L", "Brightness from which a pixel is hot").unit("W/(sr·m²)").default("100"),
                flag("-a", "Average hot pixels, too"),
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
    summary: "turn a picture by 90° clockwise",
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
    summary: "make views from pictures of other views and their distances",
    synopsis: "pinterp [view options] [options] picture distances …",
    description: "Distances are a file of rpict -z, or one number for all pixels.",
    groups: &[
        VIEW,
        Group {
            title: "Picture",
            options: &[
                value("-x", "N", "Most columns").unit("pixels").default("512"),
                value("-y", "N", "Most rows").unit("pixels").default("512"),
                value("-pa", "A", "Height over width of a pixel").default("1"),
                value("-z", "FILE", "Also write distances").unit("scene units"),
                value("-e", "E", "Factor of the exposure, or with a sign stops").default("1"),
                value("-t", "EPS", "Relative difference of distances within one surface").default("0.02"),
                flag("-a", "Average pixels that show the same"),
                flag("-q", "Do not average"),
                flag("-B", "Average over all views of standard input"),
                flag("-n", "Take distances along the view's direction"),
            ],
        },
        Group {
            title: "Gaps",
            options: &[
                flag("-f0", "Fill no gaps"),
                flag("-ff", "Fill gaps between pixels of one surface"),
                flag("-fb", "Fill gaps behind edges"),
                flag("-fa", "Fill both, as usual"),
                value("-fs", "N", "Reach over which gaps are filled; 0 for any").unit("pixels").default("0"),
                value("-fc", "R G B", "Colour of the rest").default("0 0 0"),
                value("-fz", "Z", "Distance of the rest").unit("scene units"),
                value("-fr", "OPTIONS", "Trace rays for the rest: options and the scene of rtrace, in one word"),
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
                flag("-dr", "Write to the right, as usual"),
                flag("-du", "Write upwards"),
                flag("-dl", "Write to the left, upside down"),
                flag("-dd", "Write downwards"),
                value("-h", "N", "Height of a letter").unit("pixels").default("32"),
                value("-a", "A", "Height over width of a letter").default("1.67"),
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
    summary: "print a picture as numbers, or make one of numbers",
    synopsis: "pvalue [options] [file] | pvalue -r [options] [file | red green blue]",
    description: "",
    groups: &[
        Group {
            title: "Direction and header",
            options: &[
                signed("-r", "", "Make a picture of numbers"),
                signed("-h", "", "Leave the header out"),
                signed("-H", "", "Leave the resolution out"),
                signed("-s", "N", "Skip so many bytes of the input").unit("bytes"),
                signed("-u", "", "Leave repeated pixels out; with -r write no run-lengths"),
                beginning("-x", "N", "Columns of a picture without resolution").unit("pixels").aliases(&["+x", "-X", "+X"]),
                beginning("-y", "N", "Rows of a picture without resolution").unit("pixels").aliases(&["+y", "-Y", "+Y"]),
            ],
        },
        Group {
            title: "Values",
            options: &[
                signed("-o", "", "Undo the exposures"),
                signed("-O", "", "Undo the exposures, and give XYZE pictures in W/(sr·m²) too"),
                signed("-g", "GAMMA", "Gamma of the numbers").default("1"),
                signed("-e", "E", "Factor of the exposure, or with a sign stops").default("1"),
                signed("-R", "", "Write blue first"),
                signed("-n", "", "Write components one after another"),
                signed("-b", "", "Write the brightness alone"),
                beginning("-pr", "", "Write red alone").aliases(&["+pr", "-pR", "+pR"]),
                beginning("-pg", "", "Write green alone").aliases(&["+pg", "-pG", "+pG"]),
                beginning("-pb", "", "Write blue alone").aliases(&["+pb", "-pB", "+pB"]),
                beginning("-pX", "", "Make an XYZE picture").aliases(&["+pX", "-px", "+px"]),
                signed("-p", "RX RY GX GY BX BY WX WY", "Primaries and white of the picture that is made"),
                attached("-d", "[FORM]", "Leave positions out; form of numbers: a text, i integers, b bytes, w words, f floats, d doubles; capitals swap bytes")
                    .aliases(&["+d"]),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};
