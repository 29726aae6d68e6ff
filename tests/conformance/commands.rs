//! The commands of Radiance's own render tests, and the results of real Radiance.
//!
//! Scenes and references are not part of this repository: `RADSIGHT_SHARED` names their folder. The
//! octrees are built by real Radiance's `rad`, so that only the rendering is compared.
//! `RADSIGHT_ORACLE` names a folder for slow results of real Radiance: repeated pictures, and the
//! truth of some blocks.

use crate::pictures_folder;
use crate::program::{Folder, Run, finish_command, run_with};
use radsight_picture::{Image, Picture};
use radsight_test_support::Radiance;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One line of `commands.tsv`.
pub(crate) struct Reference {
    scene: String,
    pub(crate) name: String,
    /// Processor time of real `rpict`.
    pub(crate) seconds: f64,
    options: Vec<String>,
    octree: String,
    /// The result of real Radiance.
    pub(crate) picture: Image<f32>,
}

/// Options of views and of pictures, with their numbers of values.
const VIEW: [(&str, usize); 12] = [
    ("-vf", 1),
    ("-vp", 3),
    ("-vd", 3),
    ("-vu", 3),
    ("-vh", 1),
    ("-vv", 1),
    ("-vo", 1),
    ("-va", 1),
    ("-vs", 1),
    ("-vl", 1),
    ("-x", 1),
    ("-y", 1),
];
const PICTURE: [(&str, usize); 6] = [("-ps", 1), ("-pt", 1), ("-pj", 1), ("-pd", 1), ("-pm", 1), ("-dp", 1)];

/// Defaults of real `rpict -defaults`.
const DEFAULT_JITTER: f64 = 0.67;

impl Reference {
    /// The commands of the folder; `RADSIGHT_ONLY=mist,trans` selects scenes.
    pub(crate) fn all(shared: &Path) -> Vec<Reference> {
        let text = fs::read_to_string(shared.join("ref/renders/commands.tsv")).expect("the list of references");
        let read = |line: &str| {
            let columns: Vec<&str> = line.split('\t').collect();
            let mut options: Vec<String> = columns[4].split_whitespace().map(str::to_owned).collect();
            let picture = fs::read(shared.join("ref/renders").join(columns[2])).expect("the reference");
            Reference {
                scene: columns[0].to_owned(),
                name: columns[2].trim_end_matches(".hdr").to_owned(),
                seconds: columns[3].parse().expect("seconds"),
                octree: options.pop().expect("a command has words"),
                options,
                picture: radiance_values(&picture),
            }
        };
        text.lines().skip(1).filter(|line| wanted(line.split('\t').next().unwrap_or_default())).map(read).collect()
    }

    /// The command with additional options.
    pub(crate) fn words<'a>(&'a self, more: &'a str) -> Vec<&'a str> {
        let options = self.options.iter().map(String::as_str);
        options.chain(more.split_whitespace()).chain([self.octree.as_str()]).collect()
    }

    /// The path of our picture.
    pub(crate) fn our_path(&self) -> PathBuf {
        pictures_folder().join(format!("renders-{}.hdr", self.name))
    }

    /// The path of the last picture from `radiance_render_tests`.
    pub(crate) fn our_picture(&self) -> Option<Image<f32>> {
        fs::read(self.our_path()).ok().map(|bytes| radiance_values(&bytes))
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.picture.width(), self.picture.height())
    }

    /// The share of a pixel's width over which its ray is jittered (`-pj`): a lamp that ends near
    /// pixel borders is seen only by pixels whose centre it covers.
    pub(crate) fn jitter(&self) -> f64 {
        let place = self.options.iter().rposition(|word| word == "-pj");
        place.map_or(DEFAULT_JITTER, |place| self.options[place + 1].parse().expect("a share"))
    }

    /// The words of its view, and those that `rtrace` accepts as well.
    fn view_and_tracing(&self) -> [Vec<&str>; 2] {
        let [mut view, mut tracing] = [Vec::new(), Vec::new()];
        let mut rest = &self.options[1..];
        while let Some(word) = rest.first() {
            let follow =
                |known: &[(&str, usize)]| known.iter().find(|(name, _)| name == word).map(|(_, count)| 1 + count);
            let of_view = follow(&VIEW).or(word.starts_with("-vt").then_some(1));
            let count = of_view.or(follow(&PICTURE)).unwrap_or(1);
            let (words, others) = rest.split_at(count);
            if of_view.is_some() {
                view.extend(words.iter().map(String::as_str));
            } else if follow(&PICTURE).is_none() {
                tracing.extend(words.iter().map(String::as_str));
            }
            rest = others;
        }
        [view, tracing]
    }
}

/// `RADSIGHT_ONLY=mist,trans` names the scenes.
fn wanted(scene: &str) -> bool {
    std::env::var("RADSIGHT_ONLY").map_or(true, |only| only.split(',').any(|name| name == scene))
}

pub(crate) fn radiance_values(bytes: &[u8]) -> Image<f32> {
    Picture::read(bytes).expect("a picture").radiance().expect("its radiance")
}

/// The folder for slow results of real Radiance.
pub(crate) fn oracle() -> Option<PathBuf> {
    std::env::var_os("RADSIGHT_ORACLE").map(PathBuf::from).filter(|folder| folder.is_dir())
}

/// Repeated results of real Radiance: `NAME-1.hdr`, `NAME-2.hdr`…
pub(crate) fn repeats(folder: &Path, reference: &Reference) -> Vec<Image<f32>> {
    let path = |count: u32| folder.join(format!("{}-{count}.hdr", reference.name));
    (1..).map_while(|count| fs::read(path(count)).ok()).map(|bytes| radiance_values(&bytes)).collect()
}

/// The program whose `rtrace` is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RtraceProgram {
    Real,
    Ours,
}

/// A copy of the scenes in which octrees are built.
pub(crate) struct Scenes<'a> {
    radiance: &'a Radiance,
    raypath: String,
    pub(crate) folder: Folder,
    built: HashSet<String>,
}

impl Scenes<'_> {
    pub(crate) fn new<'a>(shared: &Path, radiance: &'a Radiance) -> Scenes<'a> {
        let folder = Folder::new();
        for entry in fs::read_dir(shared.join("renders")).expect("the scenes") {
            let entry = entry.expect("an entry");
            fs::copy(entry.path(), folder.path(&entry.file_name().to_string_lossy())).expect("a copy");
        }
        let raypath = format!("{}:{}", radiance.raypath(), shared.join("loose/fnt").display());
        Scenes { radiance, raypath, folder, built: HashSet::new() }
    }

    /// Builds the octree of a command, without photon maps, which no command uses.
    pub(crate) fn build(&mut self, reference: &Reference) {
        if self.built.insert(reference.scene.clone()) {
            self.build_anew(reference);
        }
    }

    /// Builds it even if it exists: light through windows depends on random numbers (`mkillum`).
    pub(crate) fn build_anew(&self, reference: &Reference) {
        for octree in ["", "1"].map(|with_windows| format!("{}{with_windows}.oct", reference.scene)) {
            let octree = self.folder.path(&octree);
            if octree.exists() {
                fs::remove_file(octree).expect("the octree is removed");
            }
        }
        let rif = format!("{}.rif", reference.scene);
        let text = fs::read_to_string(self.folder.path(&rif)).expect("variables of rad");
        let lines = text.lines().filter(|line| !line.starts_with("PGMAP") && !line.starts_with("PCMAP"));
        self.folder.file(&rif, lines.map(|line| format!("{line}\n")).collect::<String>());
        self.real("rad", &["-v", "0", &rif], None).done();
    }

    /// Runs a program of radsight.
    pub(crate) fn ours(&self, words: &[&str], input: Option<&[u8]>) -> Run {
        self.run(&mut crate::program::command(words), input)
    }

    /// Runs a program of real Radiance.
    pub(crate) fn real(&self, program: &str, words: &[&str], input: Option<&[u8]>) -> Run {
        self.run(&mut self.radiance.command(program, words), input)
    }

    fn run(&self, command: &mut Command, input: Option<&[u8]>) -> Run {
        command.env("RAYPATH", &self.raypath).current_dir(self.folder.path(""));
        match input {
            Some(input) => run_with(command, input),
            None => finish_command(command),
        }
    }

    /// Rays through these positions of the picture (pixels from its top left corner), as 32-bit
    /// numbers. `vwrays` counts from the centre of the lower left pixel.
    fn rays_through(&self, reference: &Reference, places: &[(f64, f64)]) -> Vec<u8> {
        let [view, _] = reference.view_and_tracing();
        let height = reference.size().1 as f64;
        let text: String = places.iter().map(|(x, y)| format!("{:.6} {:.6}\n", x - 0.5, height - y - 0.5)).collect();
        self.real("vwrays", &[&["-i", "-ff"][..], &view].concat(), Some(text.as_bytes())).done()
    }

    /// Radiance along rays through these positions by `rtrace`, with additional options.
    pub(crate) fn radiance_at(
        &self,
        program: RtraceProgram,
        reference: &Reference,
        places: &[(f64, f64)],
        more: &str,
    ) -> Vec<f64> {
        let [_, tracing] = reference.view_and_tracing();
        let more: Vec<&str> = more.split_whitespace().collect();
        let words = [&["-h", "-fff", "-ov"][..], &tracing, &more, &[&reference.octree]].concat();
        let rays = self.rays_through(reference, places);
        let run = match program {
            RtraceProgram::Real => self.real("rtrace", &words, Some(&rays)),
            RtraceProgram::Ours => self.ours(&[&["rtrace"], &words[..]].concat(), Some(&rays)),
        };
        let values = run.done();
        let values: Vec<f64> =
            values.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().expect("four")).into()).collect();
        assert_eq!(values.len(), 3 * places.len(), "{}: a value for each ray", reference.name);
        values.chunks_exact(3).map(|bands| bands.iter().sum::<f64>() / 3.0).collect()
    }
}
