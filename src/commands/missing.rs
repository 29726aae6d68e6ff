//! Radiance's programs that radsight does not replace, and their alternatives.

use crate::failure::Failure;

/// The programs, and the messages about them.
const MISSING: [(&[&str], &str); 14] = [
    (&["rvu", "rview", "rholo"], "expected rpict, which renders the same view: add -x, -y and -o"),
    (&["mkpmap", "pmapdump"], "radsight has no photon maps: rpict --caustics samples light through mirrors and glass"),
    (&["rtcontrib"], "expected rcontrib, its successor"),
    (&["rlux"], "expected rtrace -I, and rcalc -e '$1=47.4*$1+120*$2+11.6*$3' for lux"),
    (&["rcrop"], "expected pcompos -x WIDTH -y HEIGHT PICTURE -LEFT -BOTTOM"),
    (&["pdfblur"], "expected rpict -pd, which renders with depth of field"),
    (&["lookamb", "ambpos", "genambpos", "compamb"], "radsight has no files of ambient values"),
    (&["tmesh2rad", "robjutil"], "expected obj2rad or obj2mesh"),
    (
        &["gensdaymtx", "genssky"],
        "expected Radiance's own: rmtxop, rcomb and dctimestep here take the same matrices, and gendaymtx makes those without spectra",
    ),
    (
        &["pcwarp", "pmblur", "pmblur2", "pmdblur", "psketch", "normtiff", "macbethcal", "ttyimage"],
        "expected Radiance's own, which reads the pictures and distances (-z) of rpict here",
    ),
    (
        &["evalglare", "findglare", "glarendx", "xglaresrc", "glare", "pveil"],
        "expected Radiance's own, which reads the pictures of rpict here",
    ),
    (
        &[
            "bsdf2klems",
            "bsdf2ttree",
            "bsdf2rad",
            "pabopto2bsdf",
            "wrapBSDF",
            "checkBSDF",
            "genBSDF",
            "rttree_reduce",
            "genglaze",
        ],
        "expected Radiance's own: its BSDF files are read",
    ),
    (
        &["ra_gif", "ra_pict", "ra_ps", "ra_t8", "ra_t16", "ra_hexbit", "ra_pixar", "ra_pr"],
        "expected ra_tiff, ra_bmp or ra_ppm",
    ),
    (
        &[
            "rpiece",
            "ranimate",
            "ranimove",
            "rtpict",
            "rsensor",
            "ximage",
            "xshowtrace",
            "raddepend",
            "objview",
            "glrad",
            "trad",
            "mgf2inv",
            "mgfilt",
            "3ds2mgf",
            "nff2rad",
            "rad2mgf",
            "neaten",
            "debugcal",
            "icalc",
            "lampcolor",
            "objpict",
            "normpat",
            "phisto",
            "vwright",
        ],
        "expected Radiance's own",
    ),
];

/// The error of a program that is called by name and not provided.
pub(super) fn refused(name: &str) -> Option<Failure> {
    let (_, instead) = MISSING.iter().find(|(names, _)| names.contains(&name))?;
    Some(Failure::usage(format!("{name} is not part of radsight: {instead}")))
}
