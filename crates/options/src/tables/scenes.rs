//! The programs that read, convert and arrange scenes.

use super::rendering::{ONLY_HELP, TRUST};
use crate::option::{attached, beginning, flag, value};
use crate::program::{Group, Program};

pub(super) const OCONV: Program = Program {
    name: "oconv",
    summary: "turn scenes into an octree",
    synopsis: "oconv [-i octree | -b xmin ymin zmin size] [-n objlim] [-r maxres] [-f] [-w] [-o file] [--allow-commands] [- | scene ...]",
    description: "",
    groups: &[
        Group {
            title: "Octree",
            options: &[
                beginning("-i", "FILE", "Begin with this octree"),
                beginning("-b", "XMIN YMIN ZMIN SIZE", "Cube of the octree").unit("scene units"),
                beginning("-n", "N", "Surfaces from which a cube is divided").default("6"),
                beginning("-r", "N", "Most divisions of the whole along an axis").default("16384"),
                beginning("-f", "", "Store the surfaces in the octree"),
                beginning("-w", "", "Do not print warnings"),
                beginning("-o", "FILE", "Write the octree here, when it is whole (radsight's own)").default("-"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const OBJ2MESH: Program = Program {
    name: "obj2mesh",
    summary: "turn Wavefront text into a mesh that a mesh primitive places",
    synopsis: "obj2mesh [-n limit] [-r resolution] [-a materials] [-l library] [-w] [-v] [file.obj [file.rtm]]",
    description: "",
    groups: &[
        Group {
            title: "Mesh",
            options: &[
                value("-n", "N", "Triangles from which a cube is divided").default("9"),
                value("-r", "N", "Most divisions of the whole along an axis").default("16384"),
                value("-a", "FILE", "Materials, which become part of the mesh"),
                value("-l", "FILE", "Materials that are looked for in RAYPATH, likewise"),
                flag("-w", "Do not print warnings"),
                flag("-v", "Say what the mesh has"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RAD: Program = Program {
    name: "rad",
    summary: "make the pictures of a project (.rif file)",
    synopsis: "rad [-s] [-n | -N threads] [-t] [-e] [-V] [-w] [-v view] [--allow-commands] file.rif [variable=value …]",
    description: "",
    groups: &[
        Group {
            title: "Work",
            options: &[
                flag("-s", "Do not say what is run"),
                flag("-n", "Only say what would be run"),
                value("-N", "THREADS", "Threads of the renderers; 0 as -n"),
                flag("-t", "Only say that files are up to date"),
                flag("-e", "Print the variables of the project"),
                flag("-V", "Print the views"),
                value("-v", "VIEW", "Render this view alone"),
                flag("-w", "Do not print warnings"),
                value("-o", "DRIVER", "The interactive viewer, which is refused"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const XFORM: Program = Program {
    name: "xform",
    summary: "place a scene: move, turn, scale and repeat it",
    synopsis: "xform [-m modifier] [-n name] [-I] [-c|-e] [-a count] [-f file] [-t x y z] [-rx|-ry|-rz degrees] [-s factor] [-mx|-my|-mz] [-i count] [file …]",
    description: "Transforms are done in the order in which they stand.",
    groups: &[
        Group {
            title: "Scene",
            options: &[
                value("-m", "MODIFIER", "Give all surfaces this modifier"),
                value("-n", "NAME", "Begin all names with this one"),
                flag("-I", "Turn surfaces inside out"),
                flag("-c", "Pass commands of the scene on"),
                flag("-e", "Run commands of the scene, as usual"),
                value("-a", "COUNT", "Repeat the transforms that follow 0, 1, … COUNT−1 times"),
                value("-f", "FILE", "Place the scene once for each line of transforms in a file"),
            ],
        },
        Group {
            title: "Transforms",
            options: &[
                value("-t", "X Y Z", "Move by this vector").unit("scene units"),
                value("-rx", "ANGLE", "Turn about x").unit("degrees"),
                value("-ry", "ANGLE", "Turn about y").unit("degrees"),
                value("-rz", "ANGLE", "Turn about z").unit("degrees"),
                value("-s", "FACTOR", "Scale by this factor"),
                flag("-mx", "Mirror at x = 0"),
                flag("-my", "Mirror at y = 0"),
                flag("-mz", "Mirror at z = 0"),
                value("-i", "COUNT", "Do the transforms that follow so many times"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const GETBBOX: Program = Program {
    name: "getbbox",
    summary: "print the bounding box of a scene",
    synopsis: "getbbox [-h] [-w] [scene …]",
    description: "",
    groups: &[
        Group {
            title: "Output",
            options: &[
                beginning("-h", "", "Leave the line of headings out"),
                beginning("-w", "", "Do not print warnings"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const REPLMARKS: Program = Program {
    name: "replmarks",
    summary: "put objects in place of marker polygons",
    synopsis: "replmarks [-e] [-s size] [-m modout] {-x objfile | -i octree | -I mesh} modname .. [file ..]",
    description: "The longest edge of a marker is ignored, the second longest is the new x axis, the third lies towards the new y axis.",
    groups: &[
        Group {
            title: "Objects",
            options: &[
                beginning("-x", "FILE", "Place a scene file with xform"),
                beginning("-i", "OCTREE", "Place an instance of an octree"),
                beginning("-I", "MESH", "Place a mesh"),
                beginning("-m", "MODIFIER", "Modifier of what is placed"),
                beginning("-s", "SIZE", "Length of a marker's x edge at which the object keeps its size")
                    .unit("scene units"),
                beginning("-e", "", "Run the commands of the file at once"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const MKSOURCE: Program = Program {
    name: "mksource",
    summary: "make distant sources for the bright parts of what surrounds a scene",
    synopsis: "mksource [-d nsamps] [-t thresh] [-a maxang] [octree]",
    description: "",
    groups: &[
        Group {
            title: "Sources",
            options: &[
                beginning("-d", "N", "Samples of the sphere").default("262144"),
                beginning("-t", "T", "Radiance above which a source grows").unit("W/(sr·m²)"),
                beginning("-a", "ANGLE", "Largest diameter of a source").unit("degrees"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const IES2RAD: Program = Program {
    name: "ies2rad",
    summary: "turn an IES luminaire file into a Radiance luminaire",
    synopsis: "ies2rad [-t lamp] [-c r g b] [-f lampfile] [-u lamp] [-d units] [-i rad] [-m factor] [-s] [-l libdir] [-p prefdir] [-o outname] [input ..]",
    description: "",
    groups: &[
        Group {
            title: "Luminaire",
            options: &[
                beginning("-t", "LAMP", "Lamp of the luminaire"),
                beginning("-u", "LAMP", "Lamp where the file's is not known"),
                beginning("-c", "R G B", "Colour where no lamp is known").default("1 1 1"),
                beginning("-f", "FILE", "Table of lamps").default("lamp.tab"),
                beginning("-m", "FACTOR", "Multiply the light").default("1"),
                beginning("-i", "RADIUS", "Put the light on a sphere of this radius").unit("scene units"),
                attached(
                    "-d",
                    "UNIT[/N]",
                    "Unit of the scene: m, c, f or i for metres, centimetres, feet or inches, over N",
                )
                .default("m"),
            ],
        },
        Group {
            title: "Files",
            options: &[
                beginning("-o", "NAME", "Name of the luminaire"),
                beginning("-l", "DIR", "Folder of a library, before the name"),
                beginning("-p", "DIR", "Folder within the library, before the name"),
                beginning("-s", "", "Write the scene text to standard output"),
                beginning("-g", "", "An octree, which is refused"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const MGF2RAD: Program = Program {
    name: "mgf2rad",
    summary: "turn Materials and Geometry Format into a scene",
    synopsis: "mgf2rad [-s] [-g dist] [-e mult] [file.mgf] ..",
    description: "",
    groups: &[
        Group {
            title: "Materials",
            options: &[
                beginning("-s", "", "Write spectra as spectra"),
                value("-g", "DISTANCE", "Make emitters glow to this distance").unit("m"),
                value("-e", "FACTOR", "Multiply emitters").default("1"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const OBJ2RAD: Program = Program {
    name: "obj2rad",
    summary: "turn Wavefront text into Radiance polygons",
    synopsis: "obj2rad [-o obj] [-m mapping] [-n] [-f] [file.obj]",
    description: "",
    groups: &[
        Group {
            title: "Faces",
            options: &[
                beginning("-o", "NAME", "Name of faces without a group"),
                beginning("-m", "FILE", "Choose materials by this mapping"),
                beginning("-n", "", "List the names that a mapping can use"),
                beginning("-f", "", "Leave smoothing out"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PKGBSDF: Program = Program {
    name: "pkgBSDF",
    summary: "make the surfaces that stand for a BSDF file in a scene",
    synopsis: "pkgBSDF -s input.xml",
    description: "",
    groups: &[
        Group { title: "Output", options: &[flag("-s", "Write to standard output; demanded")] },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};
