//! Options that the programs share which trace rays.

use crate::option::Listing::{Computed, Fixed, OneDigit, Scientific, Switch, Whole};
use crate::option::{ProgramOption, attached, flag, switch, value};
use crate::program::Group;

/// How light is computed. In the order in which Radiance prints them.
pub(super) const RENDERING: Group = Group {
    title: "Rendering",
    options: &[
        switch("-i", "Give the irradiance of surfaces in place of their radiance")
            .default("-")
            .listed(Switch(["irradiance calculation off", "irradiance calculation on"])),
        switch("-u", "Sample without correlation; accepted, and without effect here")
            .default("+")
            .listed(Switch(["correlated quasi-Monte Carlo sampling", "uncorrelated Monte Carlo sampling"])),
        switch("-bv", "Show the back faces of surfaces")
            .default("+")
            .listed(Switch(["back face visibility off", "back face visibility on"])),
        value(
            "-dt",
            "T",
            "Threshold of direct light below which shadows are not tested; accepted, and without effect here",
        )
        .default("0.03")
        .listed(Fixed("\t\t\t", "direct threshold")),
        value("-dc", "C", "Certainty of direct light; accepted, and without effect here")
            .default("0.75")
            .listed(Fixed("\t\t\t", "direct certainty")),
        value("-dj", "J", "Jitter of the points on lights; accepted, and without effect here")
            .default("0")
            .listed(Fixed("\t\t\t", "direct jitter")),
        value("-ds", "S", "Size over distance above which a light is sampled in parts; 0 for one sample each")
            .default("0.2")
            .listed(Fixed("\t\t\t", "direct sampling")),
        value("-dr", "N", "Mirror reflections through which a light is followed as a virtual source")
            .default("2")
            .listed(Whole(9, "\t\t\t", "direct relays")),
        value("-dp", "D", "Density of the pretest of virtual sources; accepted, and without effect here")
            .unit("samples per steradian")
            .default("512")
            .listed(Whole(9, "\t\t\t", "direct pretest density")),
        switch("-dv", "Show the lights themselves")
            .default("+")
            .listed(Switch(["direct visibility off", "direct visibility on"])),
        value("-ss", "S", "Rays for each highlight; without effect where many rays are averaged")
            .default("1")
            .listed(Fixed("\t\t\t", "specular sampling")),
        value("-st", "T", "Reflectance below which a lobe is not sampled")
            .default("0.15")
            .listed(Fixed("\t\t\t", "specular threshold")),
        value("-av", "R G B", "Ambient radiance where nothing is gathered")
            .unit("W/(sr·m²)")
            .default("0 0 0")
            .listed(Fixed("\t", "ambient value")),
        value("-aw", "N", "Weight of the ambient value among gathered ones; accepted, and without effect here")
            .default("0")
            .listed(Whole(9, "\t\t\t", "ambient value weight")),
        value("-ab", "N", "Diffuse bounces").default("0").listed(Whole(9, "\t\t\t", "ambient bounces")),
        value("-aa", "ACC", "Error that the irradiance cache may make by interpolation; 0 for no cache")
            .default("0.1")
            .listed(Fixed("\t\t\t", "ambient accuracy")),
        value("-ar", "RES", "Scene size over the smallest spacing of cache records; 0 for no limit")
            .default("256")
            .listed(Whole(9, "\t\t\t", "ambient resolution")),
        value("-ad", "N", "Final gather rays of a cache record").default("1024").listed(Whole(
            9,
            "\t\t\t",
            "ambient divisions",
        )),
        value("-as", "N", "Further rays where the first ones differ most").default("512").listed(Whole(
            9,
            "\t\t\t",
            "ambient super-samples",
        )),
        value("-me", "R G B", "Extinction of the mist that fills the scene")
            .unit("1/scene unit")
            .default("0 0 0")
            .listed(Scientific("\t", "mist extinction coefficient")),
        value("-ma", "R G B", "Scattering albedo of that mist")
            .default("0 0 0")
            .listed(Fixed("\t", "mist scattering albedo")),
        value("-mg", "G", "Scattering eccentricity of that mist, from 0 to 1")
            .default("0")
            .listed(Fixed("\t\t\t", "mist scattering eccentricity")),
        value("-ms", "L", "Distance between samples in mist; 0 for one sample each ray")
            .unit("scene units")
            .default("0")
            .listed(Fixed("\t\t\t", "mist sampling distance")),
        value("-cs", "N", "Spectral bands that are traced").default("3").listed(Whole(
            2,
            "\t\t\t\t",
            "number of spectral bins",
        )),
        value("-cw", "FIRST LAST", "Range of the bands").unit("nm").default("380 780").listed(Whole(
            3,
            "\t\t\t",
            "wavelength limits (nm)",
        )),
        value("-lr", "N", "Reflections after which a ray ends; 0 or less for Russian roulette, at most |N| deep")
            .default("-10")
            .listed(Whole(9, "\t\t\t", "limit reflection")),
        value("-lw", "W", "Weight below which a ray ends, or Russian roulette decides")
            .default("1e-4")
            .listed(Scientific("\t\t\t", "limit weight")),
        value("-am", "R", "Search radius of photon maps; accepted, and without effect here")
            .default("0")
            .listed(OneDigit("\t\t\t\t", "max photon search radius")),
        value("-ae", "NAME", "Gather no ambient light on surfaces with this modifier"),
        value("-ai", "NAME", "Gather ambient light on surfaces with this modifier alone"),
        value("-aE", "FILE", "As -ae, for all modifiers that a file names"),
        value("-aI", "FILE", "As -ai, for all modifiers that a file names"),
        value("-af", "FILE", "File that keeps the irradiance cache of rpict and rtrace, shared by runs and processes"),
        flag(
            "--caustics",
            "Let diffuse surfaces sample the light of lamps by way of curved mirrors and glass (radsight's own)",
        ),
        value("-ap", "FILE", "Photon maps, which are refused: there are none here"),
    ],
};

/// How scenes are read, and what they may cause. Ours alone.
pub(super) const READING: Group = Group {
    title: "Reading scenes (radsight's own)",
    options: &[
        value("--seed", "N", "Choose the sample sequence").default("0").listed(Computed),
        flag("--strict", "Treat warnings about a scene as errors"),
        flag("--allow-commands", "Run the commands of scenes that are not known in process through a shell"),
        flag("--allow-plugins", "Load plugins that stand beside the scene, which runs their code"),
        flag("--allow-outputs", "Let scenes and files of options name files to be written"),
        value("--allow-output", "FILE", "Let them name this file"),
        value("--plugin-path", "DIR", "Look for plugins in this folder first"),
        value("--brdf", "MATERIAL=LIBRARY:MODEL(…)", "Replace a material by a model of a plugin"),
        value("--project", "FILE", "The project for which the work is done, for headers"),
        flag("--isolate-plugins", "Run each plugin library in a process of its own"),
        value("--plugin-time-limit", "S", "Time that one call of a plugin may take; 0 for no limit")
            .unit("s")
            .default("120"),
        value("--plugin-memory-limit", "MB", "Memory that one call of a plugin may take; 0 for no limit").unit("MB"),
    ],
};

/// What scenes may cause, for programs that read them and trace no rays. Ours alone.
pub(super) const TRUST: Group = Group {
    title: "What scenes may cause (radsight's own)",
    options: &[
        flag("--allow-commands", "Run the commands of scenes that are not known in process through a shell"),
        flag("--allow-plugins", "Load plugins that stand beside the scene, which runs their code"),
        flag("--allow-outputs", "Let scenes and files of options name files to be written"),
        value("--allow-output", "FILE", "Let them name this file"),
        value("--plugin-path", "DIR", "Look for plugins in this folder first"),
        value("--brdf", "MATERIAL=LIBRARY:MODEL(…)", "Replace a material by a model of a plugin"),
        value("--project", "FILE", "The project for which the work is done, for headers"),
    ],
};

/// How many rays are spent. Ours alone.
pub(super) const SAMPLING: Group = Group {
    title: "Sampling (radsight's own)",
    options: &[
        value("--samples", "N", "Rays for each value; a power of two converges fastest").listed(Computed),
        value("--error", "E", "Trace until the estimated relative error of the result is E").listed(Computed),
    ],
};

/// Definitions for the functions of a scene.
pub(super) const DEFINITIONS: Group = Group {
    title: "Functions",
    options: &[value("-f", "FILE", "Read definitions for all functions of the scene from a file")],
};

/// The view.
pub(super) const VIEW: Group = Group {
    title: "View",
    options: &[
        attached(
            "-vt",
            "TYPE",
            "Projection: v perspective, l parallel, h hemispherical, a angular, c cylindrical, s planispheric",
        )
        .default("v")
        .listed(Computed),
        value("-vp", "X Y Z", "View point").unit("scene units").default("0 0 0").listed(Computed),
        value("-vd", "X Y Z", "View direction; its length is the focal distance of -pd")
            .default("0 1 0")
            .listed(Computed),
        value("-vu", "X Y Z", "Direction that is up in the picture").default("0 0 1").listed(Computed),
        value("-vh", "H", "Horizontal size; scene units for a parallel view")
            .unit("degrees")
            .default("45")
            .listed(Computed),
        value("-vv", "V", "Vertical size; scene units for a parallel view")
            .unit("degrees")
            .default("45")
            .listed(Computed),
        value("-vo", "D", "Distance of the fore clipping plane").unit("scene units").default("0").listed(Computed),
        value("-va", "D", "Distance of the aft clipping plane; 0 for none")
            .unit("scene units")
            .default("0")
            .listed(Computed),
        value("-vs", "S", "Shift of the picture to the right").unit("picture widths").default("0").listed(Computed),
        value("-vl", "L", "Shift of the picture upwards").unit("picture heights").default("0").listed(Computed),
        value("-vf", "FILE", "Read view options from a view file or a picture"),
    ],
};

/// What the programs say of themselves.
pub(super) const ANSWERS: Group = Group {
    title: "Answers",
    options: &[
        flag("-defaults", "Print the options as they stand, then end").aliases(&["-help"]),
        flag("-version", "Print the version, then end"),
        flag("-features", "Print what the program can do, or check the features that follow; stands first"),
        HELP,
    ],
};

/// The option that every program has.
pub(super) const HELP: ProgramOption = flag("--help", "Print this help, then end; stands first");

/// The same as a group of its own.
pub(super) const ONLY_HELP: Group = Group { title: "Answers", options: &[HELP] };
