//! The programs that turn pictures into other formats and back.

use super::rendering::{HELP, ONLY_HELP};
use crate::option::{ProgramOption, flag, value};
use crate::program::{Group, Program};

const REVERSE: ProgramOption = flag("-r", "Make a Radiance picture of the other format");
const GREY: ProgramOption = flag("-b", "Write grey values");
const GAMMA: ProgramOption = value("-g", "GAMMA", "Gamma of the display").default("2.2");
const STOPS: ProgramOption = value("-e", "±N", "Exposure, with its sign").unit("stops").default("+0");

pub(super) const RA_BMP: Program = Program {
    name: "ra_bmp",
    summary: "turn a Radiance picture into a bitmap (BMP), and back",
    synopsis: "ra_bmp [-b] [-g gamma] [-e exposure] [-p primaries] input [output] | ra_bmp -r input [output]",
    description: "",
    groups: &[Group {
        title: "Conversion",
        options: &[
            REVERSE,
            GREY,
            GAMMA,
            value("-e", "±N|auto|human|linear", "Exposure in stops, or a tone mapping"),
            value("-p", "RX RY GX GY BX BY WX WY", "Primaries and white of the display"),
            HELP,
        ],
    }],
    defaults: &[],
};

pub(super) const RA_PNG: Program = Program {
    name: "ra_png",
    summary: "turn a Radiance picture into PNG (radsight's own)",
    synopsis: "ra_png [-b] [-g gamma] [-e stops] input [output]",
    description: "",
    groups: &[Group { title: "Conversion", options: &[GREY, GAMMA, STOPS, HELP] }],
    defaults: &[],
};

pub(super) const RA_PPM: Program = Program {
    name: "ra_ppm",
    summary: "turn a Radiance picture into a portable pixmap (PPM), and back",
    synopsis: "ra_ppm [-r] [-a] [-b] [-s max] [-g gamma] [-e stops] [input [output]]",
    description: "",
    groups: &[Group {
        title: "Conversion",
        options: &[
            REVERSE,
            flag("-a", "Write numbers as text"),
            GREY,
            value("-s", "MAX", "Largest value; above 255 there are two bytes for each").default("255"),
            GAMMA,
            STOPS,
            HELP,
        ],
    }],
    defaults: &[],
};

pub(super) const RA_TIFF: Program = Program {
    name: "ra_tiff",
    summary: "turn a Radiance picture into TIFF, and back",
    synopsis: "ra_tiff [-z|-L|-f|-w] [-b] [-g gamma] [-e stops] input output | ra_tiff -r [-x] input output",
    description: "",
    groups: &[Group {
        title: "Conversion",
        options: &[
            REVERSE,
            flag("-x", "Make an XYZE picture with -r"),
            GREY,
            flag("-w", "Write 16 bits"),
            flag("-f", "Write floats"),
            flag("-L", "Write 32 bit LogLuv"),
            flag("-l", "24 bit LogLuv, which is refused"),
            flag("-z", "Compress with LZW"),
            GAMMA,
            STOPS,
            HELP,
        ],
    }],
    defaults: &[],
};

pub(super) const RA_RGBE: Program = Program {
    name: "ra_rgbe",
    summary: "write a picture without run-lengths, or with them",
    synopsis: "ra_rgbe [-r] [-e ±stops] [-n frame] [input [output]]",
    description: "Of an animation, whose frames follow each other in one file, all are written, each to a file of its own where \
                  %d in the output stands for its number.",
    groups: &[
        Group {
            title: "Conversion",
            options: &[
                flag("-r", "Write run-lengths"),
                STOPS,
                value("-n", "FRAME", "Write this frame alone"),
                flag("-f", "Accepted, and without effect here"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RA_XYZE: Program = Program {
    name: "ra_xyze",
    summary: "turn RGBE pictures and spectra into XYZE, and back",
    synopsis: "ra_xyze [-r] [-o] [-e exposure] [-c|-u] [-p rx ry gx gy bx by wx wy] [input [output]]",
    description: "",
    groups: &[
        Group {
            title: "Conversion",
            options: &[
                flag("-r", "Write RGBE"),
                flag("-o", "Undo the exposures"),
                value("-e", "E", "Factor of the exposure, or with a sign stops").default("1"),
                flag("-c", "Write run-lengths"),
                flag("-u", "Write no run-lengths"),
                value("-p", "RX RY GX GY BX BY WX WY", "Primaries and white of the RGB side"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};
