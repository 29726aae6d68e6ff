//! `oconv`: compiles scenes to an octree.

use crate::failure::{Failure, Outcome, render, say};
use crate::input::{read, read_file, scene_inputs, use_default_threads};
use crate::option_table::{options_of, parse_option, unknown_option};
use crate::output::write_file;
use crate::trust::Trust;
use glam::DVec3;
use radsight_formats::{OCTREE_FORMAT, Octree, OctreeContent};
use radsight_ir::{Cube, Scene};
use radsight_octree::BuildOptions;
use radsight_parse::{Input, KeepPrimitives, Purpose, Read, ReadOptions, bounds, cube};
use radsight_picture::Header;

/// Margin added to a given cube on each side, scene units; as in Radiance.
const CUBE_MARGIN: f64 = 1e-5;

/// The parsed arguments.
struct Arguments {
    /// `-i`
    octree: Option<String>,
    /// `-b`
    cube: Option<Cube>,
    build: BuildOptions,
    /// `-f`
    is_frozen: bool,
    /// `-w`
    is_quiet: bool,
    /// `-o`, radsight's own: a file that appears whole; `-` for standard output.
    output: String,
    trust: Trust,
    files: Vec<String>,
}

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let arguments = Arguments::read(&words[1..], trust)?;
    let (mut inputs, mut names) = (Vec::new(), Vec::new());
    let mut old = None;
    if let Some(path) = &arguments.octree {
        let bytes = read_file(path, "octree")?;
        old = Some(Old::read(path, &bytes)?);
        inputs.push(Input::Text { name: path.clone(), text: bytes.into() });
    }
    names.extend(old.iter().flat_map(|old| old.files.clone()));
    for file in &arguments.files {
        names.push(file.clone());
        match file.starts_with('!') {
            true => inputs.push(Input::File(file.clone())),
            false => inputs.extend(scene_inputs(std::slice::from_ref(file), None, &arguments.trust)?),
        }
    }
    let is_frozen = arguments.is_frozen || arguments.files.iter().any(|file| file == "-");
    let was_frozen = old.as_ref().is_some_and(|old| old.files.is_empty());
    if was_frozen && !is_frozen {
        arguments.warn("the octree of -i is frozen, and so is the new one");
    }
    let is_frozen = is_frozen || was_frozen;
    let bytes = arguments.compile(words, inputs, (!is_frozen).then_some(&names[..]), old.as_ref())?;
    write_file(&arguments.output, &bytes)
}

/// The frozen octree of scene text, as `oconv -f -` makes it.
pub(crate) fn frozen(scene: &[u8]) -> Result<Vec<u8>, Failure> {
    let words = ["oconv", "-f", "-"].map(str::to_owned);
    let arguments = Arguments::read(&words[1..], &Trust::default())?;
    let input = Input::Text { name: "standard input".to_owned(), text: scene.to_vec().into() };
    arguments.compile(&words, vec![input], None, None)
}

/// The data of the octree of `-i`.
struct Old {
    cube: Cube,
    /// Empty if it is frozen.
    files: Vec<String>,
}

impl Old {
    fn read(path: &str, bytes: &[u8]) -> Result<Old, Failure> {
        let octree = Octree::read(bytes).map_err(|error| Failure::input(format!("oconv: \"{path}\": {error}")))?;
        let files = match &octree.content {
            OctreeContent::Files(files) => {
                files.iter().map(|file| String::from_utf8_lossy(file).into_owned()).collect()
            }
            OctreeContent::Objects(_) => Vec::new(),
        };
        Ok(Old { cube: Cube { origin: DVec3::from_array(octree.origin), size: octree.size }, files })
    }
}

impl Arguments {
    fn read(words: &[String], trust: &Trust) -> Result<Arguments, Failure> {
        let mut arguments = Arguments {
            octree: None,
            cube: None,
            build: BuildOptions::default(),
            is_frozen: false,
            is_quiet: false,
            output: "-".to_owned(),
            trust: trust.clone(),
            files: Vec::new(),
        };
        let program = options_of("oconv");
        let mut rest = words.iter();
        while let Some(word) = rest.as_slice().first().filter(|word| word.starts_with('-') && *word != "-") {
            let used = arguments.trust.take(rest.as_slice())?;
            if used > 0 {
                rest.nth(used - 1);
                continue;
            }
            rest.next();
            let mut value = || {
                rest.next().ok_or_else(|| {
                    Failure::usage(format!("oconv: missing value of \"{word}\"; usage: {}", program.synopsis))
                })
            };
            match parse_option(program, word)?.option.name {
                "-i" => arguments.octree = Some(value()?.clone()),
                "-b" => {
                    let mut number = || number::<f64>(word, value()?);
                    let origin = DVec3::new(number()?, number()?, number()?) - CUBE_MARGIN;
                    arguments.cube = Some(Cube { origin, size: number()? + 2.0 * CUBE_MARGIN });
                }
                // Radiance takes numbers below 1 as 1.
                "-n" => arguments.build.object_limit = number::<i64>(word, value()?)?.max(1) as usize,
                "-r" => arguments.build.resolution = number(word, value()?)?,
                "-f" => arguments.is_frozen = true,
                "-w" => arguments.is_quiet = true,
                "-o" => arguments.output = value()?.clone(),
                _ => return Err(unknown_option(program, word)),
            }
        }
        arguments.files = rest.cloned().collect();
        if arguments.octree.is_some() && arguments.cube.is_some() {
            return Err(Failure::usage("oconv: -i and -b both give the cube, expected one of them"));
        }
        Ok(arguments)
    }

    /// The bytes of the octree that names its scene files, or without them of a frozen one.
    fn compile(
        &self,
        words: &[String],
        inputs: Vec<Input>,
        names: Option<&[String]>,
        old: Option<&Old>,
    ) -> Result<Vec<u8>, Failure> {
        let read = self.read_scene(inputs, if names.is_none() { KeepPrimitives::Yes } else { KeepPrimitives::No })?;
        let cube = self.cube(old, &read.scene)?;
        use_default_threads()?;
        let built = radsight_octree::build(&read.scene, &read.numbering.of_surfaces, cube, &self.build);
        if let Some(warning) = built.warning("surfaces") {
            self.warn(&warning);
        }
        let octree = Octree {
            header: header(words, &read.history),
            origin: cube.origin.to_array(),
            size: cube.size,
            object_count: read.numbering.count,
            content: match names {
                Some(names) => OctreeContent::Files(names.iter().map(String::as_bytes).collect()),
                None => OctreeContent::Objects(read.numbering.primitives),
            },
        };
        octree.write(&built.tree).map_err(|error| Failure::input(format!("oconv: {error}")))
    }

    fn read_scene(&self, inputs: Vec<Input>, primitives: KeepPrimitives) -> Result<Read, Failure> {
        let options = ReadOptions { primitives, purpose: Purpose::Octree, ..ReadOptions::default() };
        let read = read(inputs, self.trust.commands(), &options);
        if read.has_errors() {
            return Err(Failure::diagnostics(&read.diagnostics, &read.sources));
        }
        if !self.is_quiet {
            say(&render(&read.diagnostics, &read.sources));
        }
        Ok(read)
    }

    /// The requested cube, or the bounding cube of the scene.
    fn cube(&self, old: Option<&Old>, scene: &Scene) -> Result<Cube, Failure> {
        let Some(given) = self.cube.or(old.map(|old| old.cube).filter(|cube| cube.size > 0.0)) else {
            return Ok(cube(scene).unwrap_or_default());
        };
        let (low, high) = (given.origin, given.origin + given.size);
        match bounds(scene) {
            Some(found) if found.low.cmplt(low).any() || found.high.cmpgt(high).any() => {
                Err(Failure::input("oconv: the cube does not hold the whole scene"))
            }
            _ => Ok(given),
        }
    }

    fn warn(&self, message: &str) {
        if !self.is_quiet {
            say(&format!("oconv: warning - {message}\n"));
        }
    }
}

fn number<T: std::str::FromStr>(option: &str, word: &str) -> Result<T, Failure> {
    word.parse().map_err(|_| Failure::usage(format!("oconv: option \"{option}\" is \"{word}\", expected a number")))
}

/// The history of the octree, including that of `-i`.
fn header(words: &[String], history: &Header) -> Header {
    let mut header = Header::new("RADIANCE");
    history.lines().for_each(|line| header.push_line(&String::from_utf8_lossy(line)));
    header.push_command(words.iter().map(String::as_str));
    header.push_variable("FORMAT", OCTREE_FORMAT);
    header
}
