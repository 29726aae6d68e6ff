//! Programs that generate skies.

use super::rendering::{HELP, ONLY_HELP};
use crate::option::{ProgramOption, beginning, flag, value};
use crate::program::{Group, Program};

const SITE: Group = Group {
    title: "Site and ground",
    options: &[
        beginning("-y", "YEAR", "Year, for an accurate position of the sun"),
        beginning("-a", "LATITUDE", "Latitude, north above zero").unit("degrees").default("37.815214"),
        beginning("-o", "LONGITUDE", "Longitude, west above zero").unit("degrees").default("122.04"),
        beginning("-m", "MERIDIAN", "Standard meridian of the clock, west above zero").unit("degrees").default("120"),
        beginning("-g", "REFLECTANCE", "Reflectance of the ground").default("0.2"),
    ],
};

const ANSWERS: Group = Group {
    title: "Answers",
    options: &[flag("-defaults", "Print the defaults and exit; must be the only option"), HELP],
};

const ANGLES: ProgramOption =
    value("-ang", "ALTITUDE AZIMUTH", "Position of the sun instead of a time; must be the first option")
        .unit("degrees");

pub(super) const GENSKY: Program = Program {
    name: "gensky",
    summary: "generate a CIE standard sky",
    synopsis: "gensky month day hour [options] | gensky -ang altitude azimuth [options] | gensky -defaults",
    description: "Writes the sun (solar) and the function skyfunc, the modifier of a sky dome. x points east, y north, z up.",
    groups: &[
        Group {
            title: "Sky",
            options: &[
                ANGLES,
                beginning("+s", "", "Clear sky with sun"),
                beginning("-s", "", "Clear sky without sun"),
                beginning("+i", "", "Intermediate sky with sun"),
                beginning("-i", "", "Intermediate sky without sun"),
                beginning("-c", "", "Overcast sky").aliases(&["+c"]),
                beginning("-u", "", "Uniform sky").aliases(&["+u"]),
                beginning("-t", "TURBIDITY", "Turbidity of the atmosphere").default("2.45"),
                beginning("-b", "RADIANCE", "Radiance of the zenith").unit("W/(sr·m²)"),
                beginning("-B", "IRRADIANCE", "Diffuse horizontal irradiance").unit("W/m²"),
                beginning("-r", "RADIANCE", "Radiance of the sun").unit("W/(sr·m²)"),
                beginning("-R", "IRRADIANCE", "Direct horizontal irradiance").unit("W/m²"),
            ],
        },
        SITE,
        ANSWERS,
    ],
    defaults: &[],
};

pub(super) const GENDAYLIT: Program = Program {
    name: "gendaylit",
    summary: "generate a Perez sky from measured light",
    synopsis: "gendaylit month day hour [-y year] | -ang altitude azimuth  -P epsilon delta | -W|-L|-G direct diffuse | -E global  [options]",
    description: "",
    groups: &[
        Group {
            title: "Light",
            options: &[
                ANGLES,
                beginning("-P", "EPSILON DELTA", "Perez clearness and brightness"),
                beginning("-W", "DIRECT DIFFUSE", "Direct normal and diffuse horizontal irradiance").unit("W/m²"),
                beginning("-L", "DIRECT DIFFUSE", "Direct normal and diffuse horizontal illuminance").unit("lx"),
                beginning("-G", "DIRECT DIFFUSE", "Direct horizontal and diffuse horizontal irradiance").unit("W/m²"),
                beginning("-E", "GLOBAL", "Global horizontal irradiance").unit("W/m²"),
                beginning("-s", "", "Sky without sun"),
                beginning("+s", "", "Sky with sun (default)"),
                beginning("-c", "", "Overcast sky without sun").aliases(&["+c"]),
                beginning("-d", "CELSIUS", "Dew point").unit("°C").default("11"),
                beginning("-i", "MINUTES", "Length of a time step").unit("min").default("0"),
            ],
        },
        Group {
            title: "Output",
            options: &[
                beginning("-O", "0|1|2", "Output quantity: visible radiance, solar radiance, or luminance")
                    .default("0"),
                beginning("-C", "", "Add colour"),
                beginning("-CIE", "", "Use the CIE daylight locus"),
                beginning("-l", "A B C D E F G", "Coefficients of the colour locus"),
                beginning("-w", "", "Do not print warnings"),
                beginning("-R", "VALUE", "Accepted; has no effect, as in Radiance"),
                beginning("-t", "VALUE", "Accepted; has no effect, as in Radiance"),
                beginning("-b", "VALUE", "Accepted; has no effect, as in Radiance"),
            ],
        },
        SITE,
        ANSWERS,
    ],
    defaults: &[],
};

pub(super) const GENDAYMTX: Program = Program {
    name: "gendaymtx",
    summary: "generate a matrix of sky patches by time steps from a weather file",
    synopsis: "gendaymtx [-v][-h][-A][-d|-s|-n][-u][-D file [-M modfile]][-r deg][-m N][-g r g b][-c r g b][-o{f|d|a}][-O{0|1}][-5 deg][-i minutes] [weather]",
    description: "",
    groups: &[
        Group {
            title: "Sky",
            options: &[
                value("-m", "N", "Subdivision of Tregenza's patches into Reinhart's, per axis").default("1"),
                flag("-d", "Write only the sun"),
                flag("-s", "Write only the sky"),
                flag("-n", "Write no matrix"),
                flag("-u", "Omit the night"),
                flag("-A", "Write the mean of all time steps"),
                value("-r", "DEGREES", "Rotate the sky").unit("degrees").default("0").aliases(&["-rz"]),
                value("-g", "R G B", "Reflectance of the ground").default("0.2 0.2 0.2"),
                value("-c", "R G B", "Colour of the sky").default("0.960 1.004 1.118"),
                value("-5", "DEGREES", "Put the sun into one patch, as a disk of this size").unit("degrees"),
                value("-i", "MINUTES", "Length of a time step").unit("min"),
            ],
        },
        Group {
            title: "Output",
            options: &[
                flag("-oa", "Write text"),
                flag("-of", "Write floats"),
                flag("-od", "Write doubles"),
                flag("-O0", "Write visible radiation"),
                flag("-O1", "Write solar radiation"),
                flag("-h", "Omit the header"),
                value("-D", "FILE", "Write each sun as a light source"),
                value("-M", "FILE", "Write the names of these light sources"),
                flag("-v", "Accepted; has no effect"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GENSKYVEC: Program = Program {
    name: "genskyvec",
    summary: "generate a vector of sky patches from a sky on standard input",
    synopsis: "genskyvec [-m MF] [-c r g b] [-d] [-5] [-h] < sky.rad",
    description: "",
    groups: &[
        Group {
            title: "Patches",
            options: &[
                value("-m", "MF", "Subdivision of Tregenza's patches into Reinhart's, per axis").default("4"),
                value("-c", "R G B", "Colour of the sky").default("0.960 1.004 1.118"),
                flag("-d", "Write only the sun; the sky is black"),
                flag("-5", "Put the sun into the nearest patch only"),
                flag("-h", "Omit the header"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const EPW2WEA: Program = Program {
    name: "epw2wea",
    summary: "convert EnergyPlus weather files to Radiance's format",
    synopsis: "epw2wea [-a] file-name.epw [file-name.wea]",
    description: "",
    groups: &[
        Group { title: "Columns", options: &[flag("-a", "Add aerosol optical depth and cloud cover")] },
        ONLY_HELP,
    ],
    defaults: &[],
};
