//! Options shared by programs that trace rays.

use crate::option::Listing::{Computed, Fixed, OneDigit, Scientific, Switch, Whole};
use crate::option::{ProgramOption, attached, flag, switch, value};
use crate::program::Group;

/// Light transport, in Radiance's order.
pub(super) const RENDERING: Group = Group {
    title: "Rendering",
    options: &[
        switch("-i", "Compute the irradiance of surfaces instead of their radiance")
            .default("-")
            .listed(Switch(["irradiance calculation off", "irradiance calculation on"])),
        switch("-u", "Sample without correlation; accepted, but has no effect")
            .default("+")
            .listed(Switch(["correlated quasi-Monte Carlo sampling", "uncorrelated Monte Carlo sampling"])),
        switch("-bv", "Show the back faces of surfaces")
            .default("+")
            .listed(Switch(["back face visibility off", "back face visibility on"])),
        value("-dt", "T", "Threshold of direct light: shadows of weaker lights are tested at random; only pictures of few rays use it")
            .default("0.03")
            .listed(Fixed("\t\t\t", "direct threshold")),
        value("-dc", "C", "Certainty of direct light; accepted, but has no effect")
            .default("0.75")
            .listed(Fixed("\t\t\t", "direct certainty")),
        value("-dj", "J", "Jitter of light samples; accepted, but has no effect")
            .default("0")
            .listed(Fixed("\t\t\t", "direct jitter")),
        value("-ds", "S", "Ratio of size to distance above which a light is subdivided; 0 for one sample per light")
            .default("0.2")
            .listed(Fixed("\t\t\t", "direct sampling")),
        value("-dr", "N", "Depth of virtual sources: number of mirror reflections").default("2").listed(Whole(
            9,
            "\t\t\t",
            "direct relays",
        )),
        value("-dp", "D", "Density of the pretest of virtual sources; accepted, but has no effect")
            .unit("samples per steradian")
            .default("512")
            .listed(Whole(9, "\t\t\t", "direct pretest density")),
        switch("-dv", "Make light sources visible")
            .default("+")
            .listed(Switch(["direct visibility off", "direct visibility on"])),
        value("-ss", "S", "Number of samples per highlight; has no effect where many rays are averaged")
            .default("1")
            .listed(Fixed("\t\t\t", "specular sampling")),
        value("-st", "T", "Specular threshold: reflectance below which a lobe is not sampled")
            .default("0.15")
            .listed(Fixed("\t\t\t", "specular threshold")),
        value("-av", "R G B", "Ambient value: radiance used where indirect light is not computed")
            .unit("W/(sr·m²)")
            .default("0 0 0")
            .listed(Fixed("\t", "ambient value")),
        value("-aw", "N", "Weight of the ambient value; accepted, but has no effect").default("0").listed(Whole(
            9,
            "\t\t\t",
            "ambient value weight",
        )),
        value("-ab", "N", "Diffuse bounces").default("0").listed(Whole(9, "\t\t\t", "ambient bounces")),
        value("-aa", "ACC", "Interpolation error of the irradiance cache; 0 for no cache")
            .default("0.1")
            .listed(Fixed("\t\t\t", "ambient accuracy")),
        value("-ar", "RES", "Ratio of scene size to the smallest spacing of cache records; 0 for no limit")
            .default("256")
            .listed(Whole(9, "\t\t\t", "ambient resolution")),
        value("-ad", "N", "Number of hemisphere samples per cache record").default("1024").listed(Whole(
            9,
            "\t\t\t",
            "ambient divisions",
        )),
        value("-as", "N", "Number of additional samples where the first ones differ most")
            .default("512")
            .listed(Whole(9, "\t\t\t", "ambient super-samples")),
        value("-me", "R G B", "Extinction coefficient of the mist that fills the scene")
            .unit("1/scene unit")
            .default("0 0 0")
            .listed(Scientific("\t", "mist extinction coefficient")),
        value("-ma", "R G B", "Scattering albedo of that mist")
            .default("0 0 0")
            .listed(Fixed("\t", "mist scattering albedo")),
        value("-mg", "G", "Scattering eccentricity of that mist, from 0 to 1")
            .default("0")
            .listed(Fixed("\t\t\t", "mist scattering eccentricity")),
        value("-ms", "L", "Distance between samples in mist; 0 for one sample per ray")
            .unit("scene units")
            .default("0")
            .listed(Fixed("\t\t\t", "mist sampling distance")),
        value("-cs", "N", "Number of spectral bands").default("3").listed(Whole(
            2,
            "\t\t\t\t",
            "number of spectral bins",
        )),
        value("-cw", "FIRST LAST", "Range of the bands").unit("nm").default("380 780").listed(Whole(
            3,
            "\t\t\t",
            "wavelength limits (nm)",
        )),
        value("-lr", "N", "Largest number of reflections of a ray; 0 or less for Russian roulette, limited to |N|")
            .default("-10")
            .listed(Whole(9, "\t\t\t", "limit reflection")),
        value("-lw", "W", "Weight below which a ray ends or undergoes Russian roulette")
            .default("1e-4")
            .listed(Scientific("\t\t\t", "limit weight")),
        value("-am", "R", "Search radius of photon maps; accepted, but has no effect")
            .default("0")
            .listed(OneDigit("\t\t\t\t", "max photon search radius")),
        value("-ae", "NAME", "Exclude surfaces with this modifier from the ambient calculation"),
        value("-ai", "NAME", "Include only surfaces with this modifier in the ambient calculation"),
        value("-aE", "FILE", "As -ae, for all modifiers listed in a file"),
        value("-aI", "FILE", "As -ai, for all modifiers listed in a file"),
        value("-af", "FILE", "File for the irradiance cache of rpict and rtrace, shared by runs and processes"),
        flag(
            "--caustics",
            "Sample caustics: light of lamps on diffuse surfaces through curved mirrors and glass (radsight's own)",
        ),
        value("-ap", "FILE", "Photon map; not supported"),
    ],
};

/// Reading of scenes, and their permissions. radsight's own.
pub(super) const READING: Group = Group {
    title: "Reading scenes (radsight's own)",
    options: &[
        value("--seed", "N", "Seed of the sample sequence").default("0").listed(Computed),
        flag("--strict", "Treat warnings about a scene as errors"),
        flag("--allow-commands", "Run unknown commands in scenes through a shell"),
        flag("--allow-plugins", "Load plugins beside the scene, which runs their code"),
        flag("--allow-outputs", "Allow scenes and option files to name output files"),
        value("--allow-output", "FILE", "Allow them to name this output file"),
        value("--plugin-path", "DIR", "Search this folder for plugins first"),
        value("--brdf", "MATERIAL=LIBRARY:MODEL(…)", "Replace a material by a plugin's model"),
        value("--project", "FILE", "Project name, for headers"),
        flag("--isolate-plugins", "Run each plugin library in a separate process"),
        value("--plugin-time-limit", "S", "Time limit of one plugin call; 0 for no limit").unit("s").default("120"),
        value("--plugin-memory-limit", "MB", "Memory limit of one plugin call; 0 for no limit").unit("MB"),
    ],
};

/// Permissions of scenes, for programs that read them and trace no rays. radsight's own.
pub(super) const TRUST: Group = Group {
    title: "Permissions of scenes (radsight's own)",
    options: &[
        flag("--allow-commands", "Run unknown commands in scenes through a shell"),
        flag("--allow-plugins", "Load plugins beside the scene, which runs their code"),
        flag("--allow-outputs", "Allow scenes and option files to name output files"),
        value("--allow-output", "FILE", "Allow them to name this output file"),
        value("--plugin-path", "DIR", "Search this folder for plugins first"),
        value("--brdf", "MATERIAL=LIBRARY:MODEL(…)", "Replace a material by a plugin's model"),
        value("--project", "FILE", "Project name, for headers"),
    ],
};

/// The sampling budget. radsight's own.
pub(super) const SAMPLING: Group = Group {
    title: "Sampling (radsight's own)",
    options: &[
        value("--samples", "N", "Number of rays per value; a power of two converges fastest").listed(Computed),
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
        value("-vd", "X Y Z", "View direction; its length is the focus distance of -pd")
            .default("0 1 0")
            .listed(Computed),
        value("-vu", "X Y Z", "Up direction in the picture").default("0 0 1").listed(Computed),
        value("-vh", "H", "Horizontal size; an angle, or scene units for a parallel view")
            .unit("degrees")
            .default("45")
            .listed(Computed),
        value("-vv", "V", "Vertical size; an angle, or scene units for a parallel view")
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

/// Information about the program.
pub(super) const ANSWERS: Group = Group {
    title: "Answers",
    options: &[
        flag("-defaults", "Print the current options and exit").aliases(&["-help"]),
        flag("-version", "Print the version and exit"),
        flag("-features", "Print the features of the program, or check those that follow; must be the first option"),
        HELP,
    ],
};

/// The option that every program has.
pub(super) const HELP: ProgramOption = flag("--help", "Print this help and exit; must be the first option");

/// A group with only this option.
pub(super) const ONLY_HELP: Group = Group { title: "Answers", options: &[HELP] };
