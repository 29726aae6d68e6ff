//! Programs that generate surfaces.

use super::rendering::ONLY_HELP;
use crate::option::{ProgramOption, beginning, flag, value};
use crate::program::{Group, Program};

const EXPRESSION: ProgramOption = value("-e", "EXPR", "Add definitions for the functions");
const FUNCTIONS: ProgramOption = value("-f", "FILE", "Read definitions from a file");

pub(super) const GENBEADS: Program = Program {
    name: "genbeads",
    summary: "generate a string of beads along a curve",
    synopsis: "genbeads material name p0 p1 r0 r1 rad inc",
    description: "",
    groups: &[ONLY_HELP],
    defaults: &[],
};

pub(super) const GENBLINDS: Program = Program {
    name: "genblinds",
    summary: "generate venetian blinds",
    synopsis: "genblinds mat name depth width height nslats angle [-r|+r rcurv]",
    description: "Slats extend along y (width) and x (depth), and are distributed over height along z. The angle is in degrees.",
    groups: &[
        Group {
            title: "Slats",
            options: &[
                value("-r", "RADIUS", "Curve slats upwards with this radius of curvature").unit("scene units"),
                value("+r", "RADIUS", "Curve slats downwards with this radius of curvature").unit("scene units"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GENBOX: Program = Program {
    name: "genbox",
    summary: "generate a box with a corner at the origin",
    synopsis: "genbox material name xsize ysize zsize [-i] [-b bevel | -r round [-n nsegs] [-s]] [-o]",
    description: "",
    groups: &[
        Group {
            title: "Shape",
            options: &[
                beginning("-i", "", "Turn the box inside out"),
                beginning("-b", "BEVEL", "Bevel the edges").unit("scene units"),
                beginning("-r", "RADIUS", "Round the edges").unit("scene units"),
                beginning("-n", "N", "Number of facets of a rounded edge, a power of two"),
                beginning("-s", "", "Smooth the facets"),
                beginning("-o", "", "Write Wavefront text instead of a scene"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GENCLOCK: Program = Program {
    name: "genclock",
    summary: "generate a clock on the wall x = 0, facing +x, of radius 1.1",
    synopsis: "genclock [-f face_mat] [-c case_mat] [-n name] {HH:MM | HH.hh}",
    description: "",
    groups: &[
        Group {
            title: "Materials",
            options: &[
                beginning("-f", "MATERIAL", "Material of the face"),
                beginning("-c", "MATERIAL", "Material of the case"),
                beginning("-n", "NAME", "Name of the clock").default("clock"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GENPRISM: Program = Program {
    name: "genprism",
    summary: "generate a prism over a polygon",
    synopsis: "genprism material name { - | vfile | N v1 v2 .. vN } [-l lvect] [-r radius] [-c] [-e]",
    description: "The polygon's corners lie in the xy plane.",
    groups: &[
        Group {
            title: "Shape",
            options: &[
                beginning("-l", "X Y Z", "Extrusion").unit("scene units").default("0 0 1"),
                beginning("-r", "RADIUS", "Round the edges").unit("scene units").default("0"),
                beginning("-e", "", "Omit the ends"),
                beginning("-c", "", "Leave the last corner unconnected to the first"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GENREV: Program = Program {
    name: "genrev",
    summary: "generate a surface of revolution about the z axis",
    synopsis: "genrev material name z(t) r(t) nseg [-e expr] [-f file] [-s]",
    description: "",
    groups: &[
        Group { title: "Functions", options: &[EXPRESSION, FUNCTIONS, flag("-s", "Smooth the surface")] },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GENSURF: Program = Program {
    name: "gensurf",
    summary: "generate a surface over a grid of s and t, each from 0 to 1",
    synopsis: "gensurf material name x(s,t) y(s,t) z(s,t) m n [-s] [-o] [-i] [-e expr] [-f file]",
    description: "",
    groups: &[
        Group {
            title: "Functions",
            options: &[
                EXPRESSION,
                FUNCTIONS,
                flag("-s", "Smooth the surface"),
                flag("-o", "Write Wavefront text instead of a scene"),
                flag("-i", "Reverse the surface"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GENWORM: Program = Program {
    name: "genworm",
    summary: "generate a worm of spheres, cylinders and cones along a curve",
    synopsis: "genworm material name x(t) y(t) z(t) r(t) nseg [-e expr] [-f file]",
    description: "",
    groups: &[Group { title: "Functions", options: &[EXPRESSION, FUNCTIONS] }, ONLY_HELP],
    defaults: &[],
};
