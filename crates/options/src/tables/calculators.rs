//! Programs for columns of numbers and for records.

use super::rendering::ONLY_HELP;
use crate::option::{ProgramOption, attached, beginning, flag, value};
use crate::program::{Group, Program};

pub(super) const CNT: Program = Program {
    name: "cnt",
    summary: "count, a line for each combination of indices",
    synopsis: "cnt [-s] N0 [N1 ..]",
    description: "",
    groups: &[Group { title: "Order", options: &[beginning("-s", "", "Shuffle the lines")] }, ONLY_HELP],
    defaults: &[],
};

pub(super) const EV: Program = Program {
    name: "ev",
    summary: "print the values of expressions, one per line",
    synopsis: "ev expression ..",
    description: "",
    groups: &[ONLY_HELP],
    defaults: &[],
};

pub(super) const HISTO: Program = Program {
    name: "histo",
    summary: "print histograms of the columns of standard input",
    synopsis: "histo [-c] [-p] min max n, or histo [-c] [-p] imin imax",
    description: "",
    groups: &[
        Group {
            title: "Counts",
            options: &[beginning("-c", "", "Print cumulative counts"), beginning("-p", "", "Print percentages")],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const TABFUNC: Program = Program {
    name: "tabfunc",
    summary: "convert a table on standard input to functions of one variable",
    synopsis: "tabfunc [-i] func1 [func2 ..]",
    description: "The first column is the variable; the name 0 skips a column.",
    groups: &[Group { title: "Values", options: &[flag("-i", "Interpolate")] }, ONLY_HELP],
    defaults: &[],
};

const MOST_READ: ProgramOption = beginning("-in", "N", "Largest number of records read; 0 for all").default("0");
const MOST_WRITTEN: ProgramOption = beginning("-on", "N", "Largest number of records written; 0 for all").default("0");

pub(super) const TOTAL: Program = Program {
    name: "total",
    summary: "sum up columns of numbers",
    synopsis: "total [-m] [-sE|p|u|l] [-tC] [-i{f|d}[N]] [-o{f|d}] [-count [-r]] [file ..]",
    description: "",
    groups: &[
        Group {
            title: "Results",
            options: &[
                beginning("-m", "", "Print means"),
                attached("-s", "E", "Sum absolute values to the power E"),
                beginning("-p", "", "Print products"),
                beginning("-u", "", "Print the largest values"),
                beginning("-l", "", "Print the smallest values"),
                beginning("-r", "", "Continue the sum after each result"),
                attached("-", "COUNT", "Print a result for every COUNT records"),
            ],
        },
        Group {
            title: "Records",
            options: &[
                attached("-t", "C", "Separator of columns").default("a tab"),
                attached("-i", "{a|f|d}[N]", "Format of the input: a text, f floats, d doubles; N columns"),
                attached("-o", "{a|f|d}", "Format of the results"),
                MOST_READ,
                MOST_WRITTEN,
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RCALC: Program = Program {
    name: "rcalc",
    summary: "compute records from records",
    synopsis: "rcalc [-b] [-l] [-n] [-p|-P] [-w] [-u] [-tS] [-s svar=sval] [-e expr] [-f source] [-i infmt] [-o outfmt] [file ..]",
    description: "Columns of the input are $1, $2, …; columns of the output are the definitions of $1, $2, …. A record passes \
                  if cond is above zero.",
    groups: &[
        Group {
            title: "Definitions",
            options: &[
                beginning("-e", "EXPR", "Define something"),
                beginning("-f", "FILE", "Read definitions from a file"),
                beginning("-s", "NAME=TEXT", "Define a string variable"),
                beginning("-n", "", "Read no input and write one record"),
                beginning("-w", "", "No warnings of mathematical errors"),
                beginning("-u", "", "Accepted; output is always flushed before input is awaited"),
            ],
        },
        Group {
            title: "Records",
            options: &[
                beginning("-b", "", "Match blanks of the input format literally"),
                beginning("-l", "", "Treat line ends as blanks"),
                beginning("-p", "", "Copy input that does not match the format"),
                beginning("-P", "", "Also copy records that cond rejects"),
                attached("-t", "C", "Separator of columns").default("a tab"),
                value("-i", "FORMAT", "Format of input records, as a text or a file"),
                attached("-i", "{a|f|d|F|D}[N]", "Read columns of text, floats or doubles; capitals swap bytes"),
                value("-o", "FORMAT", "Format of output records, as a text or a file"),
                attached("-o", "{a|f|d|F|D}", "Write columns of text, floats or doubles; capitals swap bytes"),
                MOST_READ,
                MOST_WRITTEN,
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RCOLLATE: Program = Program {
    name: "rcollate",
    summary: "rearrange the records of a matrix into other rows and columns",
    synopsis: "rcollate [-h[io]][-w][-c][-f[afdb][N]][-t][-ic in_col][-ir in_row][-oc out_col][-or out_row][-o RxC[xR1xC1..]] [input.dat]",
    description: "",
    groups: &[
        Group {
            title: "Matrix",
            options: &[
                flag("-h", "Omit headers of input and output"),
                flag("-hi", "The input has no header"),
                flag("-ho", "Write no header"),
                beginning("-w", "", "Do not print warnings"),
                beginning("-c", "", "Check that text has numbers"),
                attached("-f", "{a|f|d|b}[N]", "Format: a text, f floats, d doubles, b bytes; N components"),
                beginning("-t", "", "Transpose"),
                beginning("-ic", "N", "Columns of the input"),
                beginning("-ir", "N", "Rows of the input"),
                beginning("-oc", "N", "Columns of the output"),
                beginning("-or", "N", "Rows of the output"),
                value("-o", "RxC[xR1xC1…]", "Rows and columns of the output, in blocks of blocks"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RLAM: Program = Program {
    name: "rlam",
    summary: "join the records of several inputs side by side",
    synopsis: "rlam [-tS] [-u] [-iaN|-ifN|-idN|-iiN|-iwN|-ibN] [-in M] input1 [options] input2 ..",
    description: "An input is a file, - for standard input, or a command after !. Options apply to the inputs after them.",
    groups: &[
        Group {
            title: "Records",
            options: &[
                attached("-t", "S", "Separator before each line; a line break if S is empty").default("a tab"),
                attached("-i", "{a|f|d|i|w|b}[N]", "Format: N lines, or N numbers of 4, 8, 4, 2 or 1 byte")
                    .default("a1"),
                value("-in", "M", "Largest number of records; 0 for all").default("0"),
                flag("-u", "Accepted; has no effect"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RSPLIT: Program = Program {
    name: "rsplit",
    summary: "split records into several outputs",
    synopsis: "rsplit [options] output [options] output …",
    description: "An output is a file, - for standard output, . for none, or a command after !. Options apply to the outputs after them.",
    groups: &[
        Group {
            title: "Input",
            options: &[
                flag("-ih", "The input has a header"),
                flag("-iH", "The input has a resolution"),
                value("-x", "N", "Columns for the resolution"),
                value("-y", "N", "Rows for the resolution"),
                value("-on", "N", "Largest number of records; 0 for all").default("0"),
            ],
        },
        Group {
            title: "Outputs",
            options: &[
                flag("-f", "Overwrite existing files"),
                flag("-a", "Append to existing files"),
                flag("-oh", "Write a header"),
                flag("-oH", "Write a resolution"),
                attached("-o", "{a|f|d|i|w|b}[N]", "Format: N fields of text, or N numbers of 4, 8, 4, 2 or 1 byte")
                    .default("a1"),
                attached("-t", "C", "Separator after a field of text").default("a line break"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};
