//! The programs that combine matrices.

use super::rendering::ONLY_HELP;
use crate::option::{ProgramOption, attached, flag, value};
use crate::program::{Group, Program};

const FORMAT: ProgramOption = attached("-f", "FORMAT", "Format of the result: a text, f floats, d doubles, c pixels");
const FACTORS: ProgramOption = value(
    "-s",
    "F",
    "Multiply the next matrix, or after the last one the result, by one factor or one for each component",
);
const COMPONENTS: ProgramOption = value(
    "-c",
    "COEFFICIENTS|LETTERS|FILE",
    "Make other components of the next matrix, or after the last one of the result",
);
const ALL_COMPONENTS: ProgramOption = value("-C", "LETTERS|FILE", "The same for all matrices that follow");

pub(super) const DCTIMESTEP: Program = Program {
    name: "dctimestep",
    summary: "multiply daylight coefficients by skies, of one moment or many",
    synopsis: "dctimestep [options] coefficients [sky] | dctimestep [options] view BSDF daylight [sky]",
    description: "Coefficients are a matrix, or pictures with their number in the name (dc%03d.hdr).",
    groups: &[
        Group {
            title: "Sky and result",
            options: &[
                value("-n", "STEPS", "Moments of a sky that is text without a header"),
                flag("-h", "Leave the header out"),
                attached("-i", "FORMAT", "Format of the sky: a text, f floats, d doubles"),
                value("-o", "FILE", "Write the result here; with %04d in the name a file for each moment"),
                flag("-oa", "Write text"),
                flag("-of", "Write floats"),
                flag("-od", "Write doubles"),
                flag("-oc", "Write pixels"),
                value("-x", "COLUMNS", "Columns of the result's pictures"),
                value("-y", "ROWS", "Rows of the result's pictures"),
                value("-N", "N", "Accepted, and without effect here"),
                value("-m", "MB", "Accepted, and without effect here"),
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
    description: "Options change the matrix that follows, after the last one the result. A full stop is the matrix product, also \
                  where nothing is said; + * / go element by element. A BSDF file (.xml) is its transmission.",
    groups: &[
        Group {
            title: "Result and matrices",
            options: &[
                flag("-v", "Accepted, and without effect here"),
                FORMAT,
                flag("-t", "Transpose the next matrix"),
                FACTORS,
                COMPONENTS,
                ALL_COMPONENTS,
                flag("-rf", "Take the reflection from the front of the next BSDF"),
                flag("-rb", "Take the reflection from the back of the next BSDF"),
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
    description: "co(component), co or ro go bo are what comes out, the sums where nothing is defined.",
    groups: &[
        Group {
            title: "Result and matrices",
            options: &[
                flag("-h", "Leave the headers of the inputs out"),
                flag("-w", "Do not print warnings"),
                value("-n", "N", "Threads; accepted, and without effect here"),
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
