//! `pinhole rays | rtrace | pinhole average | sensor` gives the same bits as `capture`, for any
//! number of threads.

use crate::pictures::{exposure, exposure_file, greys};
use crate::program::{self, Folder, command, gripps, pipeline, radsight};

/// The results of both ways.
struct Job {
    camera: String,
    scenes: Vec<String>,
    samples: &'static str,
    seed: &'static str,
}

impl Job {
    /// Picture and exposure of the single command.
    fn fused(&self, threads: &str) -> (Vec<u16>, Vec<u32>) {
        let folder = Folder::new();
        let (picture, matrix) = (folder.word("x.png"), folder.word("x.mtx"));
        let mut words = vec!["capture", &self.camera];
        words.extend(self.scenes.iter().map(String::as_str));
        words.extend(["--samples", self.samples, "--seed", self.seed, "--threads", threads]);
        words.extend(["-o", &picture, "--exposure", &matrix]);
        radsight(&words).done();
        (greys(&folder.read("x.png")).into_data(), bits(exposure_file(&folder.path("x.mtx")).data()))
    }

    /// Picture and exposure of the stages, chained by pipes.
    fn chained(&self, threads: &str) -> (Vec<u16>, Vec<u32>) {
        let folder = Folder::new();
        let mut scenes = self.scenes.clone();
        let rig = radsight(&["rig", &self.camera]);
        if rig.code == 0 {
            scenes.push(folder.file("rig.rad", rig.output));
        }
        let rays = ["--samples", self.samples, "--seed", self.seed];
        // `capture` does not use Radiance's default of the specular threshold.
        let mut trace = vec!["rtrace", "-h", "-fdd", "-st", "0", "-n", threads, "--seed", self.seed];
        trace.extend(scenes.iter().map(String::as_str));
        let average = pipeline(vec![
            command(&[&["pinhole", "rays", &self.camera], &rays[..]].concat()),
            command(&trace),
            command(&[&["pinhole", "average", &self.camera], &rays[..]].concat()),
        ]);
        let matrix = folder.file("x.mtx", &average);
        let grey = program::radsight_with(&["sensor", &self.camera, "--seed", self.seed], &average).done();
        assert_eq!(exposure_file(matrix.as_ref()), exposure(&average));
        (greys(&grey).into_data(), bits(exposure(&average).data()))
    }

    #[track_caller]
    fn check(&self) {
        let (picture, exposure) = self.fused("2");
        let (chained_picture, chained_exposure) = self.chained("2");
        let differing = exposure.iter().zip(&chained_exposure).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "of {} exposures differ", exposure.len());
        assert!(picture == chained_picture, "the grey pictures differ");
        assert!(picture.iter().any(|grey| *grey != picture[0]), "the picture shows something");
    }
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// A figure's camera file with a coarser sensor of the same size, so that the test is short.
fn coarse(folder: &Folder, figure: &str) -> String {
    let text = std::fs::read_to_string(gripps(figure)).expect("the camera file is read");
    let text = text.replace("[192, 165]", "[48, 40]").replace("[13.75, 16.0]", "[55.0, 66.0]");
    let table = gripps("hlmp-8104.csv").replace('\\', "/");
    folder.file("camera.toml", text.replace("\"hlmp-8104.csv\"", &format!("\"{table}\"")))
}

#[test]
fn figure_14_in_full() {
    let scenes = vec![gripps("sheet-retro.rad"), gripps("washer.rad")];
    Job { camera: gripps("fig14.toml"), scenes, samples: "4", seed: "0" }.check();
}

#[test]
fn figure_11_with_another_seed() {
    let folder = Folder::new();
    let scenes = vec![gripps("sheet-retro.rad")];
    Job { camera: coarse(&folder, "fig11.toml"), scenes, samples: "16", seed: "18446744073709551557" }.check();
}

#[test]
fn any_number_of_threads() {
    let folder = Folder::new();
    let scenes = vec![gripps("sheet-retro.rad"), gripps("washer.rad")];
    let job = Job { camera: coarse(&folder, "fig14.toml"), scenes, samples: "8", seed: "3" };
    let one = job.fused("1");
    assert!(one == job.fused("2"), "two threads differ from one");
    assert!(one == job.fused("5"), "five threads differ from one");
    assert!(one == job.chained("1"), "the chain with one thread differs");
    assert!(one == job.chained("5"), "the chain with five threads differs");
}

/// A tilted camera without a ring, lamps of its own, pixels that are not square, 16 bits.
const TILTED: &str = r#"
[camera]
position_m = [0.5, -0.9, 0.7]
direction = [-0.4, 0.8, -0.6]
up = [0.1, 0.2, 1.0]
pixels = [50, 31]
pixel_pitch_um = [80.0, 120.0]
focal_distance_mm = 8.0
pinhole_diameter_mm = 0.4
pinhole_model = "finite"
exposure_ms = 20.0
wavelength_nm = 550.0

[sensor]
response = "power-law"
k = 90.0
gamma = 0.7
grey_background = 100
grey_max = 65535
exposure_unit = "uJ/cm2"
bits = 16
band_weights = [0.3, 0.6, 0.1]
"#;

const COLOURED: &str = "
void light lamp 0 0 3 30 25 18
lamp sphere bulb 0 0 4 .3 -.2 .8 .04
void spotlight torch 0 0 7 80 90 120 60 0 .3 -1
torch ring lens 0 0 8 -.5 -.4 .9 0 .3 -1 0 .05
void glow night 0 0 4 .02 .03 .05 0
night source sky 0 0 4 0 0 1 180
void brightfunc stripes 2 .7+.3*sin(40*Px) . 0 0
stripes plastic floor 0 0 5 .5 .4 .3 .05 .08
floor polygon ground 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0
void texfunc ripple 4 .1*sin(30*Py) .1*cos(30*Px) 0 . 0 0
ripple metal brass 0 0 5 .8 .6 .2 .7 .05
brass sphere ball 0 0 4 -.2 .2 .15 .15
void glass pane 0 0 3 .9 .95 .92
pane polygon window 0 0 12 -.1 -.3 0 .5 -.3 0 .5 -.3 .4 -.1 -.3 .4
void mirror looking 0 0 3 .9 .9 .9
looking polygon wall 0 0 12 -1 .9 0 -1 .9 1 1 .9 1 1 .9 0
void colorfunc tint 4 .5+.5*Nx .5+.5*Ny .5 . 0 0
tint plastic paint 0 0 5 1 1 1 0 0
!xform -n post -t .3 .3 0 -a 3 -rz 120 -i 1 -t 0 0 .01 post.rad
";

const POST: &str = "paint cylinder post 0 0 7 .2 0 0 .2 0 .3 .03\npaint ring cap 0 0 8 .2 0 .3 0 0 1 0 .03\n";

#[test]
fn a_coloured_scene_with_a_tilted_camera_and_seven_samples() {
    let folder = Folder::new();
    let camera = folder.file("camera.toml", TILTED);
    let post = folder.file("post.rad", POST);
    let scenes = vec![folder.file("scene.rad", COLOURED.replace("post.rad", &post))];
    Job { camera, scenes, samples: "7", seed: "11" }.check();
}

#[test]
fn a_scene_in_millimetres() {
    let folder = Folder::new();
    let metres = coarse(&folder, "fig11.toml");
    let text = std::fs::read_to_string(metres).expect("the camera file is read");
    let camera = folder.file("millimetres.toml", text.replace("[camera]", "[camera]\nscene_unit_m = 0.001"));
    let sheet = folder.file("sheet.rad", format!("!xform -s 1000 {}\n", gripps("sheet-retro.rad")));
    let job = Job { camera, scenes: vec![sheet], samples: "8", seed: "1" };
    job.check();
    // The unit belongs to the scene: the picture equals that of the same scene in metres.
    let scenes = vec![gripps("sheet-retro.rad")];
    let metres = Job { camera: folder.word("camera.toml"), scenes, samples: "8", seed: "1" }.fused("2").0;
    let far = job.fused("2").0.iter().zip(&metres).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    assert!(far * 100 < metres.len(), "{far} of {} greys differ between units", metres.len());
}
