//! The scenes of the race: generated ones, those of the repository, and published ones in
//! `RADSIGHT_SHARED`.

use super::scene::{LONGEST, Scene};
use crate::error::BenchError;
use crate::generated;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders of scenes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places<'a> {
    /// This repository.
    pub(crate) repository: &'a Path,
    /// Where generated scenes are written.
    pub(crate) folder: &'a Path,
    /// The folder with published scenes, if there is one.
    pub(crate) shared: Option<&'a Path>,
}

/// Prepares a scene; `None` if its files are missing.
type Prepare = fn(&Places<'_>) -> Result<Option<Scene>, BenchError>;

/// All scenes by name.
pub(crate) const SCENES: [(&str, Prepare); 14] = [
    ("cornell", cornell),
    ("exterior", exterior),
    ("lights100", |places| luminaires(places, "lights100", "room under 100 lights", 10)),
    ("lights10000", |places| luminaires(places, "lights10000", "room under 10,000 lights", 100)),
    ("mesh", mesh),
    ("mirrors", mirrors),
    ("caustics", caustics),
    ("office-lamp", office_lamp),
    ("office-day", office_day),
    ("virtual", virtual_lights),
    ("render-mirror", render_mirror),
    ("render-dielectric", render_dielectric),
    ("render-trans", render_trans),
    ("render-patterns", render_patterns),
];

/// The requested names, or all; the first unknown one is an error.
pub(crate) fn chosen(names: &[String]) -> Result<Vec<Prepare>, BenchError> {
    if names.is_empty() {
        return Ok(SCENES.iter().map(|scene| scene.1).collect());
    }
    let find = |name: &String| SCENES.iter().find(|scene| scene.0 == name).map(|scene| scene.1);
    names.iter().map(|name| find(name).ok_or_else(|| BenchError::UnknownScene { name: name.clone() })).collect()
}

fn cornell(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let folder = places.repository.join("radiance-scenes/cornell");
    let view = "-vtv -vp .5 -1.35 .5 -vd 0 1 0 -vu 0 0 1 -vh 40 -vv 40";
    Ok(Some(Scene::new("cornell", "diffuse box, area light", &folder, "cornell.rad", view, 8).translated()))
}

fn write(places: &Places<'_>, name: &str, text: &str) -> Result<PathBuf, BenchError> {
    let path = places.folder.join(name);
    fs::write(&path, text).map_err(|reason| BenchError::Write { path: path.clone(), reason })?;
    Ok(path)
}

const EXTERIOR: &str = "# Blocks of houses around a place, under a clear sky with sun.
!gensky 6 21 +15 +s -a 42 -o 71 -m 75 -g .2
skyfunc glow sky_glow 0 0 4 .9 .95 1.2 0
sky_glow source sky 0 0 4 0 0 1 180
skyfunc glow ground_glow 0 0 4 1 .9 .7 0
ground_glow source ground 0 0 4 0 0 -1 180
void plastic grass 0 0 5 .12 .2 .08 0 0
void plastic paving 0 0 5 .4 .38 .35 0 0
void plastic brick 0 0 5 .45 .2 .15 0 0
void plastic render 0 0 5 .7 .68 .6 0 0
void plastic slate 0 0 5 .15 .15 .18 0 0
grass polygon land 0 0 12 -80 -80 0 80 -80 0 80 80 0 -80 80 0
paving polygon place 0 0 12 -15 -15 .02 15 -15 .02 15 15 .02 -15 15 .02
!genbox brick north 14 6 9 | xform -t -20 18 0 -a 3 -t 16 0 0
!genbox render west 6 12 7 | xform -t -24 -18 0 -a 2 -t 0 15 0
!genbox render east 7 20 12 | xform -t 19 -12 0
!genbox slate roof.n 15 7 .4 | xform -t -20.5 17.5 9 -a 3 -t 16 0 0
!genbox slate roof.w 7 13 .4 | xform -t -24.5 -18.5 7 -a 2 -t 0 15 0
!genbox paving steps 8 1 .3 | xform -t -4 5 0 -a 6 -t 0 .5 .3
!genbox render column .8 .8 5 | xform -t -6.4 -3 0 -a 5 -t 3 0 0
!genbox render architrave 13.4 .9 .7 | xform -t -6.7 -3.05 5
grass sphere tree.1 0 0 4 -9 -9 3.2 2
grass sphere tree.2 0 0 4 9 -8 2.6 1.7
brick cylinder trunk.1 0 0 7 -9 -9 0 -9 -9 1.5 .25
brick cylinder trunk.2 0 0 7 9 -8 0 9 -8 1.2 .22
";

fn exterior(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    write(places, "exterior.rad", EXTERIOR)?;
    let view = "-vtv -vp -3 -34 7 -vd .08 1 -.12 -vu 0 0 1 -vh 55 -vv 55";
    let what = "houses under gensky with sun";
    Ok(Some(Scene::new("exterior", what, places.folder, "exterior.rad", view, 3).translated()))
}

/// A room with square lights of two colours and many intensities below its ceiling, and objects
/// that cast shadows.
fn luminaires(
    places: &Places<'_>,
    name: &'static str,
    what: &'static str,
    side: u32,
) -> Result<Option<Scene>, BenchError> {
    let mut text = "void plastic wall 0 0 5 .6 .6 .6 0 0
void plastic wood 0 0 5 .5 .35 .2 0 0
void plastic varnish 0 0 5 .3 .3 .35 .04 .1
varnish polygon floor 0 0 12 0 0 0 8 0 0 8 8 0 0 8 0
wall polygon back 0 0 12 0 8 0 8 8 0 8 8 3 0 8 3
wall polygon left 0 0 12 0 0 0 0 8 0 0 8 3 0 0 3
wall polygon right 0 0 12 8 0 0 8 0 3 8 8 3 8 8 0
wall polygon ceiling 0 0 12 0 0 3 0 8 3 8 8 3 8 0 3
!genbox wood table 1.6 .9 .05 | xform -t 1.2 2 .7 -a 3 -t 2.1 .4 0 -a 2 -t 0 2.6 0
!genbox wood leg .06 .06 .7 | xform -t 1.25 2.05 0 -a 2 -t 1.45 0 0 -a 2 -t 0 .75 0 -a 3 -t 2.1 .4 0
!genbox wall column .4 .4 3 | xform -t 2 6.4 0 -a 3 -t 2 0 0
wood sphere ball 0 0 4 4.2 3 1.05 .3
"
    .to_owned();
    let cell = 8.0 / f64::from(side);
    // The brightness of the room does not depend on the number of lights.
    let radiance = 50.0 * 64.0 / (f64::from(side * side) * (0.3 * cell).powi(2)) * 0.02;
    for class in 0..4_u32 {
        let strength = radiance * 0.25 * f64::from((class + 1) * (class + 1));
        let blue = if class % 2 == 0 { 0.7 } else { 1.0 };
        let _ =
            writeln!(text, "void light lamp{class} 0 0 3 {strength:.4} {:.4} {:.4}", 0.9 * strength, blue * strength);
    }
    for index in 0..side * side {
        let (column, row) = (index % side, index / side);
        let (x, y) = (cell * (f64::from(column) + 0.35), cell * (f64::from(row) + 0.35));
        let (right, back) = (x + 0.3 * cell, y + 0.3 * cell);
        let class = (column * 7 + row * 13) / 3 % 4;
        let _ = writeln!(
            text,
            "lamp{class} polygon l{index} 0 0 12 {x:.5} {y:.5} 2.95 {x:.5} {back:.5} 2.95 {right:.5} {back:.5} 2.95 {right:.5} {y:.5} 2.95"
        );
    }
    let file = format!("{name}.rad");
    write(places, &file, &text)?;
    // The lights are not visible: at their edges a pixel would be all noise.
    let view = "-vtv -vp 4 .3 2.3 -vd 0 1 -.7 -vu 0 0 1 -vh 75 -vv 55";
    Ok(Some(Scene::new(name, what, places.folder, &file, view, 0)))
}

const DAYLIGHT: &str = "void glow sky_glow 0 0 4 .6 .75 1 0
sky_glow source sky 0 0 4 0 0 1 180
void light sun_light 0 0 3 60000 55000 45000
sun_light source sun 0 0 4 -.5 -.3 .6 .533
";

fn mesh(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let file = generated::triangles_in(places.folder, generated::SQUARES)?;
    write(places, "daylight.rad", DAYLIGHT)?;
    // Radiance starts rays a millionth of a unit away: on terrain of one unit the triangles would
    // shade their neighbours by 1.7 % of the light.
    write(places, "land.rad", &format!("!xform -s 1000 {file}\n"))?;
    let view = "-vtv -vp 500 -350 450 -vd 0 .8 -.4 -vu 0 0 1 -vh 45 -vv 45";
    let what = "a million triangles under sun and sky";
    Ok(Some(Scene::new("mesh", what, places.folder, "land.rad daylight.rad", view, 2).translated()))
}

const MIRRORS: &str = "# A room with two mirrors that face each other, glass bodies, and a bright panel that is seen only through mirrors and glass.
void plastic wall 0 0 5 .4 .38 .35 0 0
void plastic tiles 0 0 5 .3 .4 .5 0 0
void mirror silver 0 0 3 .8 .82 .8
void dielectric crystal 0 0 5 1 1 1 1.5 0
void glow panel_glow 0 0 4 12 11 10 0
tiles polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0
wall polygon ceiling 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3
wall polygon back 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3
wall polygon front 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0
wall polygon left 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
wall polygon right 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0
silver polygon mirror.l 0 0 12 .02 .5 .3 .02 3.5 .3 .02 3.5 2.6 .02 .5 2.6
silver polygon mirror.r 0 0 12 3.98 .5 .3 3.98 .5 2.6 3.98 3.5 2.6 3.98 3.5 .3
panel_glow polygon panel 0 0 12 1 1.2 2.98 1 2.8 2.98 3 2.8 2.98 3 1.2 2.98
crystal sphere ball.1 0 0 4 1.3 2.4 .5 .5
crystal sphere ball.2 0 0 4 2.5 2.9 .4 .4
crystal sphere ball.3 0 0 4 2.3 1.8 .3 .3
!genbox crystal block .5 .5 1.2 | xform -rz 25 -t 3.1 2.6 .001
!genbox crystal block .4 .4 .8 | xform -rz -15 -t 1.8 3.2 .001
";

fn mirrors(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    write(places, "mirrors.rad", MIRRORS)?;
    let view = "-vtv -vp 2 .15 1.5 -vd 0 1 -.18 -vu 0 0 1 -vh 70 -vv 70";
    let what = "glass bodies between mirrors, without sampled lights";
    Ok(Some(
        Scene::new("mirrors", what, places.folder, "mirrors.rad", view, 6).with(&format!("-lr {LONGEST}")).translated(),
    ))
}

const CAUSTICS: &str = "# A small lamp lights a table through a ring of metal and a lens.
void plastic table_paint 0 0 5 .6 .55 .5 0 0
void mirror steel 0 0 3 .9 .9 .9
void dielectric crystal 0 0 5 1 1 1 1.5 0
table_paint polygon table 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0
steel tube ring.inside 0 0 7 -.35 0 0 -.35 0 .25 .45
steel cylinder ring.outside 0 0 7 -.35 0 0 -.35 0 .25 .46
crystal sphere lens 0 0 4 .6 -.1 .45 .3
lamp sphere bulb 0 0 4 1.1 .7 1.6 .05
";

/// Lines that make the lamp, for programs that sample lights and for those that hit it by chance.
const SAMPLED_LAMP: &str = "void light lamp 0 0 3 400 380 340\n";
const GLOWING_LAMP: &str = "void glow lamp 0 0 4 400 380 340 0\n";

fn caustics(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    write(places, "caustics.rad", &format!("{SAMPLED_LAMP}{CAUSTICS}"))?;
    write(places, "caustics-glow.rad", &format!("{GLOWING_LAMP}{CAUSTICS}"))?;
    let view = "-vtv -vp 0 -2.4 2 -vd 0 .77 -.64 -vu 0 0 1 -vh 34 -vv 34";
    let what = "ring of metal, lens and small lamp";
    let scene = Scene::new("caustics", what, places.folder, "caustics.rad", view, 2);
    Ok(Some(scene.with(&format!("-lr {LONGEST}")).with_caustics("caustics-glow.rad").translated()))
}

/// A published scene; `files` and `view` as words.
fn of_others(
    places: &Places<'_>,
    (name, what): (&'static str, &'static str),
    folder: &str,
    (files, view): (&str, &str),
    bounces: u32,
) -> Option<Scene> {
    let folder = places.shared?.join("radiance").join(folder);
    let mut scene = Scene::new(name, what, &folder, files, view, bounces);
    scene.library = vec![folder.join("lib")];
    folder.is_dir().then_some(scene)
}

fn office_lamp(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let files = "model.b90 desk misc window blinds lights lamp picture";
    let named = ("office-lamp", "office by its lamps (G. Ward and others)");
    let scene = of_others(places, named, "scenes/lbnl_office", (files, "-vf model.vp"), 0);
    Ok(scene.map(|scene| scene.with("-av .1 .1 .1")))
}

fn office_day(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let sky = write(places, "office-sky.rad", "!gensky 7 12 17 | xform -rx -90 -ry 90\n")?;
    let files = format!("{} sky model.b90 desk misc window blinds lamp picture", sky.display());
    let named = ("office-day", "office by day (G. Ward and others)");
    let scene = of_others(places, named, "scenes/lbnl_office", (&files, "-vf fish.vp"), 1);
    Ok(scene.map(|scene| scene.with("-av .1 .1 .1")))
}

fn virtual_lights(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let named = ("virtual", "daylight office (LBNL)");
    let files = ("plainoff.rad environ.rad furniture.rad", "-vf back.vp");
    Ok(of_others(places, named, "scenes/lbnl_virtual", files, 0).map(|scene| scene.with("-av 4 4 4 -dr 2")))
}

/// One of Radiance's render tests.
fn render_test(
    places: &Places<'_>,
    named: (&'static str, &'static str),
    files: &str,
    view: &str,
    ambient: f64,
) -> Result<Option<Scene>, BenchError> {
    let files = format!("basic.mat diorama_walls.rad {files}");
    let Some(mut scene) = of_others(places, named, "renders", (&files, view), 1) else { return Ok(None) };
    // The font of the render tests, which Radiance's package lacks.
    scene.library.push(places.repository.join("crates/formats/library"));
    Ok(Some(scene.with(&format!("-av {ambient} {ambient} {ambient} -dr 1"))))
}

fn render_mirror(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let files = "closed_end.rad front_cap.rad glass_pane.rad antimatter_portal.rad bubble_in_cube.rad mirror.rad sunset_sky.rad";
    render_test(places, ("render-mirror", "render test (Radiance)"), files, "-vf fish.vf", 0.022)
}

fn render_dielectric(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let files = "rect_opening.rad front_cap.rad vase.rad rect_fixture.rad sunset_sky.rad dielectric_pane.rad";
    render_test(places, ("render-dielectric", "render test (Radiance)"), files, "-vf inside.vf", 0.12)
}

fn render_trans(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let files =
        "rect_opening.rad front_cap.rad ballcompare.rad spotlights.rad rect_fixture.rad trans_pane.rad sunset_sky.rad";
    render_test(places, ("render-trans", "render test (Radiance)"), files, "-vf inside.vf", 0.09)
}

fn render_patterns(places: &Places<'_>) -> Result<Option<Scene>, BenchError> {
    let files = "patterns.mat closed_end.rad front_cap.rad disks.rad rect_fixture.rad";
    let view = "-vta -vp -.2 3.07 2.78 -vd -2.64 -.48 -1.25 -vh 66.6667 -vv 37.5";
    render_test(places, ("render-patterns", "render test (Radiance)"), files, view, 0.12)
}
