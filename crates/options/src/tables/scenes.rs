//! Programs that read, convert and arrange scenes.

use super::rendering::{ONLY_HELP, TRUST};
use crate::option::{attached, beginning, flag, value};
use crate::program::{Group, Program};

pub(super) const OCONV: Program = Program {
    name: "oconv",
    summary: "compile scenes to an octree",
    synopsis: "oconv [-i octree | -b xmin ymin zmin size] [-n objlim] [-r maxres] [-f] [-w] [-o file] [--allow-commands] [- | scene ...]",
    description: "",
    groups: &[
        Group {
            title: "Octree",
            options: &[
                beginning("-i", "FILE", "Start from this octree"),
                beginning("-b", "XMIN YMIN ZMIN SIZE", "Bounding cube of the octree").unit("scene units"),
                beginning("-n", "N", "Number of surfaces above which a cube is subdivided").default("6"),
                beginning("-r", "N", "Largest number of divisions along an axis").default("16384"),
                beginning("-f", "", "Store the surfaces in the octree"),
                beginning("-w", "", "Do not print warnings"),
                beginning("-o", "FILE", "Output file, which appears when it is complete (radsight's own)").default("-"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const OBJ2MESH: Program = Program {
    name: "obj2mesh",
    summary: "compile Wavefront text to a file for the mesh primitive",
    synopsis: "obj2mesh [-n limit] [-r resolution] [-a materials] [-l library] [-w] [-v] [file.obj [file.rtm]]",
    description: "",
    groups: &[
        Group {
            title: "Mesh",
            options: &[
                value("-n", "N", "Number of triangles above which a cube is subdivided").default("9"),
                value("-r", "N", "Largest number of divisions along an axis").default("16384"),
                value("-a", "FILE", "File of materials to include in the mesh"),
                value("-l", "FILE", "File of materials in RAYPATH to include in the mesh"),
                flag("-w", "Do not print warnings"),
                flag("-v", "Print statistics of the mesh"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const RAD: Program = Program {
    name: "rad",
    summary: "render the pictures of a project (.rif file)",
    synopsis: "rad [-s] [-n | -N threads] [-t] [-e] [-V] [-w] [-v view] [--allow-commands] file.rif [variable=value …]",
    description: "",
    groups: &[
        Group {
            title: "Work",
            options: &[
                flag("-s", "Do not print commands"),
                flag("-n", "Print commands without running them"),
                value("-N", "THREADS", "Number of threads of renderers; 0 as -n"),
                flag("-t", "Only update the dates of files"),
                flag("-e", "Print the variables of the project"),
                flag("-V", "Print the views"),
                value("-v", "VIEW", "Render only this view"),
                flag("-w", "Do not print warnings"),
                value("-o", "DRIVER", "Interactive viewer; not supported"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const XFORM: Program = Program {
    name: "xform",
    summary: "transform a scene: translate, rotate, scale and repeat it",
    synopsis: "xform [-m modifier] [-n name] [-I] [-c|-e] [-a count] [-f file] [-t x y z] [-rx|-ry|-rz degrees] [-s factor] [-mx|-my|-mz] [-i count] [file …]",
    description: "Transforms apply in the given order.",
    groups: &[
        Group {
            title: "Scene",
            options: &[
                value("-m", "MODIFIER", "Set the modifier of all surfaces"),
                value("-n", "NAME", "Prefix all names"),
                flag("-I", "Turn surfaces inside out"),
                flag("-c", "Keep commands in the scene"),
                flag("-e", "Run commands in the scene (default)"),
                value("-a", "COUNT", "Make COUNT copies, with the following transforms applied 0, 1, … COUNT−1 times"),
                value("-f", "FILE", "Make a copy for each line of transforms in a file"),
            ],
        },
        Group {
            title: "Transforms",
            options: &[
                value("-t", "X Y Z", "Translate by this vector").unit("scene units"),
                value("-rx", "ANGLE", "Turn about x").unit("degrees"),
                value("-ry", "ANGLE", "Turn about y").unit("degrees"),
                value("-rz", "ANGLE", "Turn about z").unit("degrees"),
                value("-s", "FACTOR", "Scale by this factor"),
                flag("-mx", "Mirror at x = 0"),
                flag("-my", "Mirror at y = 0"),
                flag("-mz", "Mirror at z = 0"),
                value("-i", "COUNT", "Apply the following transforms this many times"),
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
            options: &[beginning("-h", "", "Omit the headings"), beginning("-w", "", "Do not print warnings")],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const REPLMARKS: Program = Program {
    name: "replmarks",
    summary: "replace marker polygons by objects",
    synopsis: "replmarks [-e] [-s size] [-m modout] {-x objfile | -i octree | -I mesh} modname .. [file ..]",
    description: "The longest edge of a marker is ignored, the second longest is the new x axis, the third points towards the new y axis.",
    groups: &[
        Group {
            title: "Objects",
            options: &[
                beginning("-x", "FILE", "Insert a scene file with xform"),
                beginning("-i", "OCTREE", "Insert an instance of an octree"),
                beginning("-I", "MESH", "Insert a mesh"),
                beginning("-m", "MODIFIER", "Modifier of the inserted objects"),
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
    summary: "generate distant sources for the bright parts of an environment",
    synopsis: "mksource [-d nsamps] [-t thresh] [-a maxang] [octree]",
    description: "",
    groups: &[
        Group {
            title: "Sources",
            options: &[
                beginning("-d", "N", "Number of samples of the sphere").default("262144"),
                beginning("-t", "T", "Radiance threshold of sources").unit("W/(sr·m²)"),
                beginning("-a", "ANGLE", "Largest diameter of a source").unit("degrees"),
            ],
        },
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const IES2RAD: Program = Program {
    name: "ies2rad",
    summary: "convert an IES luminaire file to a Radiance luminaire",
    synopsis: "ies2rad [-t lamp] [-c r g b] [-f lampfile] [-u lamp] [-d units] [-i rad] [-m factor] [-s] [-l libdir] [-p prefdir] [-o outname] [input ..]",
    description: "",
    groups: &[
        Group {
            title: "Luminaire",
            options: &[
                beginning("-t", "LAMP", "Lamp of the luminaire"),
                beginning("-u", "LAMP", "Default lamp, if the file's is unknown"),
                beginning("-c", "R G B", "Colour if the lamp is unknown").default("1 1 1"),
                beginning("-f", "FILE", "Lamp table").default("lamp.tab"),
                beginning("-m", "FACTOR", "Factor of the light output").default("1"),
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
                beginning("-g", "", "No octree of the geometry is written: the scene holds the geometry itself"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const MGF2RAD: Program = Program {
    name: "mgf2rad",
    summary: "convert Materials and Geometry Format to a scene",
    synopsis: "mgf2rad [-s] [-m matf] [-g dist] [-e mult] [file.mgf] ..",
    description: "",
    groups: &[
        Group {
            title: "Materials",
            options: &[
                beginning("-s", "", "Write spectra instead of RGB"),
                value("-m", "FILE", "Append materials to this file"),
                value("-g", "DISTANCE", "Radius of influence of emitters, which become glow").unit("m"),
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
    summary: "convert Wavefront text to Radiance polygons",
    synopsis: "obj2rad [-o obj] [-m mapping] [-n] [-f] [file.obj]",
    description: "",
    groups: &[
        Group {
            title: "Faces",
            options: &[
                beginning("-o", "NAME", "Name of faces without a group"),
                beginning("-m", "FILE", "Choose materials by this mapping"),
                beginning("-n", "", "List the names that a mapping can use"),
                beginning("-f", "", "Do not smooth"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};

pub(super) const PKGBSDF: Program = Program {
    name: "pkgBSDF",
    summary: "generate the surfaces that represent a BSDF file in a scene",
    synopsis: "pkgBSDF [-i] [-s] input.xml ..",
    description: "",
    groups: &[
        Group {
            title: "Output",
            options: &[
                flag("-s", "Write to standard output instead of NAME.rad"),
                flag("-i", "Write geometry to the octree NAME.oct and instance it"),
            ],
        },
        TRUST,
        ONLY_HELP,
    ],
    defaults: &[],
};
