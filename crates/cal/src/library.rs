//! The function files that come with radsight, for machines without Radiance.

/// The variables of a ray, on their channels.
pub(crate) const RAY_VARIABLES: &str = include_str!("../library/ray_variables.cal");

/// Curves of Radiance's generators.
pub(crate) const CURVES: &str = include_str!("../library/curves.cal");

/// Our equivalent of Radiance's `rayinit.cal`.
pub(crate) const RAYINIT: &str = include_str!("../library/rayinit.cal");

/// Every file, by its name in scenes.
const FILES: &[(&str, &str)] = &[
    ("ray_variables.cal", RAY_VARIABLES),
    ("rayinit.cal", RAYINIT),
    ("Ashikhmin.cal", include_str!("../library/Ashikhmin.cal")),
    ("Earth.cal", include_str!("../library/Earth.cal")),
    ("LaFortune.cal", include_str!("../library/LaFortune.cal")),
    ("LaFortune1.cal", include_str!("../library/LaFortune1.cal")),
    ("WGMDaniso.cal", include_str!("../library/WGMDaniso.cal")),
    ("WGMDiso.cal", include_str!("../library/WGMDiso.cal")),
    ("WalterBSDF.cal", include_str!("../library/WalterBSDF.cal")),
    ("WalterBTDF.cal", include_str!("../library/WalterBTDF.cal")),
    ("adobe.cal", include_str!("../library/adobe.cal")),
    ("ball.cal", include_str!("../library/ball.cal")),
    ("bezier2.cal", include_str!("../library/bezier2.cal")),
    ("blinds.cal", include_str!("../library/blinds.cal")),
    ("brick.cal", include_str!("../library/brick.cal")),
    ("carpet.cal", include_str!("../library/carpet.cal")),
    ("circle.cal", include_str!("../library/circle.cal")),
    ("clamp.cal", include_str!("../library/clamp.cal")),
    ("climit.cal", include_str!("../library/climit.cal")),
    ("corrug.cal", include_str!("../library/corrug.cal")),
    ("covelight.cal", include_str!("../library/covelight.cal")),
    ("cubic.cal", include_str!("../library/cubic.cal")),
    ("cyl.cal", include_str!("../library/cyl.cal")),
    ("dichroic.cal", include_str!("../library/dichroic.cal")),
    ("dirt.cal", include_str!("../library/dirt.cal")),
    ("fisheye.cal", include_str!("../library/fisheye.cal")),
    ("fishgeom.cal", include_str!("../library/fishgeom.cal")),
    ("fprism.cal", include_str!("../library/fprism.cal")),
    ("gaussian.cal", include_str!("../library/gaussian.cal")),
    ("glass3.cal", include_str!("../library/glass3.cal")),
    ("glaze1.cal", include_str!("../library/glaze1.cal")),
    ("glaze2.cal", include_str!("../library/glaze2.cal")),
    ("glazing.cal", include_str!("../library/glazing.cal")),
    ("globe.cal", include_str!("../library/globe.cal")),
    ("gloss.cal", include_str!("../library/gloss.cal")),
    ("grating.cal", include_str!("../library/grating.cal")),
    ("hermite.cal", include_str!("../library/hermite.cal")),
    ("illum.cal", include_str!("../library/illum.cal")),
    ("jigglepic.cal", include_str!("../library/jigglepic.cal")),
    ("klems_ang.cal", include_str!("../library/klems_ang.cal")),
    ("klems_full.cal", include_str!("../library/klems_full.cal")),
    ("klems_half.cal", include_str!("../library/klems_half.cal")),
    ("klems_quarter.cal", include_str!("../library/klems_quarter.cal")),
    ("lcp0.cal", include_str!("../library/lcp0.cal")),
    ("limit.cal", include_str!("../library/limit.cal")),
    ("lumdist.cal", include_str!("../library/lumdist.cal")),
    ("marble.cal", include_str!("../library/marble.cal")),
    ("noise.cal", include_str!("../library/noise.cal")),
    ("noise2.cal", include_str!("../library/noise2.cal")),
    ("noise3.cal", include_str!("../library/noise3.cal")),
    ("orange.cal", include_str!("../library/orange.cal")),
    ("patch3w.cal", include_str!("../library/patch3w.cal")),
    ("perezlum.cal", include_str!("../library/perezlum.cal")),
    ("perezlum_c.cal", include_str!("../library/perezlum_c.cal")),
    ("picture.cal", include_str!("../library/picture.cal")),
    ("plink.cal", include_str!("../library/plink.cal")),
    ("prism.cal", include_str!("../library/prism.cal")),
    ("pucker.cal", include_str!("../library/pucker.cal")),
    ("quadratic.cal", include_str!("../library/quadratic.cal")),
    ("reinhart.cal", include_str!("../library/reinhart.cal")),
    ("reinhartb.cal", include_str!("../library/reinhartb.cal")),
    ("reinsrc.cal", include_str!("../library/reinsrc.cal")),
    ("retrorefl.cal", include_str!("../library/retrorefl.cal")),
    ("rev.cal", include_str!("../library/rev.cal")),
    ("root.cal", include_str!("../library/root.cal")),
    ("rskysrc.cal", include_str!("../library/rskysrc.cal")),
    ("screen.cal", include_str!("../library/screen.cal")),
    ("serraglaze.cal", include_str!("../library/serraglaze.cal")),
    ("skybright.cal", include_str!("../library/skybright.cal")),
    ("slate.cal", include_str!("../library/slate.cal")),
    ("source.cal", include_str!("../library/source.cal")),
    ("spline.cal", include_str!("../library/spline.cal")),
    ("sun.cal", include_str!("../library/sun.cal")),
    ("sun2.cal", include_str!("../library/sun2.cal")),
    ("surf.cal", include_str!("../library/surf.cal")),
    ("tilt.cal", include_str!("../library/tilt.cal")),
    ("tim1.cal", include_str!("../library/tim1.cal")),
    ("tmesh.cal", include_str!("../library/tmesh.cal")),
    ("trans.cal", include_str!("../library/trans.cal")),
    ("trans2.cal", include_str!("../library/trans2.cal")),
    ("tregenza.cal", include_str!("../library/tregenza.cal")),
    ("tregsrc.cal", include_str!("../library/tregsrc.cal")),
    ("weave.cal", include_str!("../library/weave.cal")),
    ("window.cal", include_str!("../library/window.cal")),
    ("winxmit.cal", include_str!("../library/winxmit.cal")),
    ("woodpat.cal", include_str!("../library/woodpat.cal")),
    ("woodtex.cal", include_str!("../library/woodtex.cal")),
    ("wrinkle.cal", include_str!("../library/wrinkle.cal")),
];

/// Text of a function file by name.
#[must_use]
pub fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Names of all files.
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(name, _)| *name)
}
