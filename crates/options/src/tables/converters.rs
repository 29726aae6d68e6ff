//! Programs that convert pictures to other formats and back.

use super::rendering::{HELP, ONLY_HELP};
use crate::option::{ProgramOption, flag, value};
use crate::program::{Group, Program};

const REVERSE: ProgramOption = flag("-r", "Convert the other format to a Radiance picture");
const GREY: ProgramOption = flag("-b", "Write grey values");
const GAMMA: ProgramOption = value("-g", "GAMMA", "Gamma of the display").default("2.2");
const STOPS: ProgramOption = value("-e", "±N", "Exposure, with its sign").unit("stops").default("+0");

pub(super) const RA_BMP: Program = Program {
    name: "ra_bmp",
    summary: "convert between Radiance pictures and bitmaps (BMP)",
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
    summary: "convert Radiance pictures to PNG (radsight's own)",
    synopsis: "ra_png [-b] [-g gamma] [-e stops] input [output]",
    description: "",
    groups: &[Group { title: "Conversion", options: &[GREY, GAMMA, STOPS, HELP] }],
    defaults: &[],
};

pub(super) const RA_PPM: Program = Program {
    name: "ra_ppm",
    summary: "convert between Radiance pictures and portable pixmaps (PPM)",
    synopsis: "ra_ppm [-r] [-a] [-b] [-s max] [-g gamma] [-e stops] [input [output]]",
    description: "",
    groups: &[Group {
        title: "Conversion",
        options: &[
            REVERSE,
            flag("-a", "Write numbers as text"),
            GREY,
            value("-s", "MAX", "Largest value; two bytes per value above 255").default("255"),
            GAMMA,
            STOPS,
            HELP,
        ],
    }],
    defaults: &[],
};

pub(super) const RA_TIFF: Program = Program {
    name: "ra_tiff",
    summary: "convert between Radiance pictures and TIFF",
    synopsis: "ra_tiff [-z|-L|-f|-w] [-b] [-g gamma] [-e stops] input output | ra_tiff -r [-x] input output",
    description: "",
    groups: &[Group {
        title: "Conversion",
        options: &[
            REVERSE,
            flag("-x", "With -r, write an XYZE picture"),
            GREY,
            flag("-w", "Write 16 bits"),
            flag("-f", "Write floats"),
            flag("-L", "Write 32-bit LogLuv"),
            flag("-l", "24-bit LogLuv; not supported"),
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
    summary: "write a picture with or without run-length encoding",
    synopsis: "ra_rgbe [-r] [-e ±stops] [-f] [-n frame] [input [output]]",
    description: "All frames of an animation in one file are written; if the output name has %d, which is replaced by the \
                  frame number, each frame goes to its own file.",
    groups: &[
        Group {
            title: "Conversion",
            options: &[
                flag("-r", "Write run-length encoding"),
                STOPS,
                value("-n", "FRAME", "Write only this frame"),
                flag("-f", "Overwrite files that exist"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RA_XYZE: Program = Program {
    name: "ra_xyze",
    summary: "convert between RGBE or spectral pictures and XYZE",
    synopsis: "ra_xyze [-r] [-o] [-e exposure] [-c|-u] [-p rx ry gx gy bx by wx wy] [input [output]]",
    description: "",
    groups: &[
        Group {
            title: "Conversion",
            options: &[
                flag("-r", "Write RGBE"),
                flag("-o", "Undo the exposures"),
                value("-e", "E", "Exposure factor; with a sign, stops").default("1"),
                flag("-c", "Write run-length encoding"),
                flag("-u", "Write no run-length encoding"),
                value("-p", "RX RY GX GY BX BY WX WY", "Primaries and white of the RGB side"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};
