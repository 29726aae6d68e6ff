//! Programs for matrices.

use super::rendering::ONLY_HELP;
use crate::option::{ProgramOption, attached, flag, value};
use crate::program::{Group, Program};

const FORMAT: ProgramOption = attached("-f", "FORMAT", "Output format: a text, f floats, d doubles, c pixels");
const FACTORS: ProgramOption = value(
    "-s",
    "F",
    "Multiply the next matrix, or the result if after the last one, by one factor or one per component",
);
const COMPONENTS: ProgramOption = value(
    "-c",
    "COEFFICIENTS|LETTERS|FILE",
    "Transform the components of the next matrix, or of the result if after the last one",
);
const ALL_COMPONENTS: ProgramOption = value("-C", "LETTERS|FILE", "The same for all matrices after it");

pub(super) const DCTIMESTEP: Program = Program {
    name: "dctimestep",
    summary: "multiply daylight coefficients by the skies of one or many time steps",
    synopsis: "dctimestep [options] coefficients [sky] | dctimestep [options] view BSDF daylight [sky]",
    description: "Coefficients are a matrix, or pictures numbered by their name (dc%03d.hdr).",
    groups: &[
        Group {
            title: "Sky and result",
            options: &[
                value("-n", "STEPS", "Number of time steps of a sky without a header"),
                flag("-h", "Omit the header"),
                attached("-i", "FORMAT", "Format of the sky: a text, f floats, d doubles"),
                value("-o", "FILE", "Output file; a name with %04d makes one file per time step"),
                flag("-oa", "Write text"),
                flag("-of", "Write floats"),
                flag("-od", "Write doubles"),
                flag("-oc", "Write pixels"),
                value("-x", "COLUMNS", "Columns of the result's pictures"),
                value("-y", "ROWS", "Rows of the result's pictures"),
                value("-N", "N", "Accepted; has no effect"),
                value("-m", "MB", "Accepted; has no effect"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RMTXOP: Program = Program {
    name: "rmtxop",
    summary: "add, multiply and transpose matrices",
    synopsis: "rmtxop [-v] [-f FORMAT] [-t] [-s F …] [-c …] [-C …] [-rf|-rb] matrix [. + * / matrix] …",
    description: "Options apply to the next matrix, or to the result if after the last one. A full stop is the matrix product, \
                  the default; + * / are element-wise. A BSDF file (.xml) stands for its transmission.",
    groups: &[
        Group {
            title: "Result and matrices",
            options: &[
                flag("-v", "Accepted; has no effect"),
                FORMAT,
                flag("-t", "Transpose the next matrix"),
                FACTORS,
                COMPONENTS,
                ALL_COMPONENTS,
                flag("-rf", "Use the front reflection of the next BSDF"),
                flag("-rb", "Use the back reflection of the next BSDF"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RCOMB: Program = Program {
    name: "rcomb",
    summary: "combine matrices and pictures by functions of their elements",
    synopsis: "rcomb [-h] [-w] [-f FORMAT] [-n N] [-e definitions] [-f file] [-s F …] [-c …] [-C …] matrix … [-m[t] matrix]",
    description: "co(component), co or ro go bo define the output; the default is the sum.",
    groups: &[
        Group {
            title: "Result and matrices",
            options: &[
                flag("-h", "Omit the headers of the inputs"),
                flag("-w", "Do not print warnings"),
                value("-n", "N", "Number of threads; accepted, but has no effect"),
                value("-e", "DEFINITIONS", "Define something"),
                value("-f", "FILE", "Read definitions from a file"),
                FORMAT,
                FACTORS,
                COMPONENTS,
                ALL_COMPONENTS,
                value("-m", "MATRIX", "Multiply the result by a matrix"),
                value("-mt", "MATRIX", "Multiply the result by a transposed matrix"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};
