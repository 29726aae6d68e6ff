//! Information for scripts about the ray-tracing programs: `-version`, and `-features` with
//! required features.

use crate::failure::{Failure, Outcome};
use crate::output::write_standard_output;

/// The features of all three programs, by Radiance's names.
const TRACING: [&str; 19] = [
    "VirtualSources",
    "SecondarySources",
    "SourceVisibility",
    "AmbientModifierSelection",
    "PathTracing",
    "RussianRoulette",
    "LowDiscrepancySeq",
    "SpecularSampling",
    "MaterialMixtures",
    "Antimatter",
    "BackFaceVisibility",
    "ScatteringModels=WGMD,Ashikhmin-Shirley",
    "TabulatedBSDFs=DataFile,KlemsXML,TensorTreeXML,+ViewPeakExtraction",
    "Instancing=Octree,TriangleMesh",
    "Aliases",
    "Hyperspectral",
    "ParticipatingMedia=Mist",
    "AmbientAveraging",
    "AmbientValueSharing",
];

/// The features of single programs.
const OWN: [(&str, &[&str]); 3] = [
    (
        "rpict",
        &[
            "Recovery",
            "IrradianceCalc",
            "ViewTypes=v,l,a,h,s,c",
            "PixelJitter",
            "PixelMotion",
            "PixelDepthOfField",
            "ViewSequence",
            "ProgressReporting",
            "Outputs=v,l",
            "OutputCS=RGB,XYZ,prims",
        ],
    ),
    (
        "rtrace",
        &[
            "Multiprocessing",
            "IrradianceCalc",
            "ImmediateIrradiance",
            "DistanceLimiting",
            "InputFormats=a,f,d",
            "OutputFormats=a,f,d,c",
            "Outputs=o,d,v,V,w,W,l,L,c,p,n,N,s,m,M,r,x,R,X,~",
            "OutputCS=RGB,XYZ,Y,S,M,prims,spec",
        ],
    ),
    (
        "rcontrib",
        &[
            "Multiprocessing",
            "Accumulation",
            "Summation",
            "Recovery",
            "ImmediateIrradiance",
            "DistanceLimiting",
            "InputFormats=a,f,d",
            "OutputFormats=a,f,d,c",
            "Outputs=V,W",
            "OutputCS=RGB,spec",
        ],
    ),
];

/// The answer to `-version` anywhere among the options: scripts search it for Radiance's name and
/// the required version.
pub(super) fn version() -> Failure {
    Failure::answer(concat!("RADIANCE 6.0a (radsight ", env!("CARGO_PKG_VERSION"), ")\n"))
}

/// Answers `-features` as the first word; `None` for other command lines.
pub(super) fn answer(words: &[String]) -> Option<Outcome> {
    let (name, asked) = (words.first()?.as_str(), words.get(1)?.as_str());
    let (_, own) = OWN.iter().find(|(program, _)| *program == name)?;
    let all = || TRACING.iter().chain(own.iter()).copied();
    match asked {
        "-features" if words.len() == 2 => {
            let text: String = all().map(|feature| format!("{feature}\n")).collect();
            Some(write_standard_output(text.as_bytes()))
        }
        "-features" => Some(
            words[2..].iter().filter(|needed| !needed.is_empty()).try_for_each(|needed| check(name, needed, all())),
        ),
        _ => None,
    }
}

/// Checks a required feature: its name, optionally with some of its kinds after `=`. For a name
/// alone, prints its kinds.
fn check(program: &str, needed: &str, mut features: impl Iterator<Item = &'static str>) -> Outcome {
    let (name, kinds) = needed.split_once('=').map_or((needed, None), |(name, kinds)| (name, Some(kinds)));
    let found =
        features.find(|feature| feature.split('=').next().is_some_and(|known| known.eq_ignore_ascii_case(name)));
    let missing = || Failure::input(format!("{program}: missing feature - {needed}"));
    let feature = found.ok_or_else(missing)?;
    let known = feature.split_once('=').map_or("", |(_, known)| known);
    match kinds {
        None if known.is_empty() => Ok(()),
        None => write_standard_output(format!("{feature}\n").as_bytes()),
        Some(kinds) if kinds.split(',').all(|kind| known.split(',').any(|known| known == kind)) => Ok(()),
        Some(_) => Err(missing()),
    }
}
