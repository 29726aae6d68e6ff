//! The commands of a project, in order.

use crate::ProjectError;
use crate::quality::{Level, QualityOptions, Zone, own_options};
use crate::variables::{NamedBy, Project, Variable};
use crate::views::{NamedView, views};
use radsight_scene_generators::padded;

/// Time of the last modification of a file, seconds; 0 if it does not exist.
pub type Date = i64;

/// The bounding cube of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// Its corner with the smallest coordinates.
    pub corner: [f64; 3],
    /// Length of its sides.
    pub size: f64,
}

/// Access to the files of the project.
pub trait Site {
    /// Time of the last modification of a file.
    fn date(&self, name: &str) -> Date;

    /// The bounding cube of a scene given by files, of which one may be an octree, and commands
    /// that begin with `!`.
    fn cube(&self, scene: &[String]) -> Option<Cube>;
}

/// Options of the command line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct How {
    /// Only update the dates of files (`-t`).
    pub touch_only: bool,
    /// The only requested view: its name, its number, or options (`-v`).
    pub view: Option<String>,
    /// Whether to print the full view of each picture (`-V`).
    pub show_views: bool,
}

/// The kind of an output file; an existing file may be replaced only by its own kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    /// An octree.
    Octree,
    /// Scene text from `mkillum`.
    IllumScene,
    /// A picture.
    Picture,
    /// Distances (`rpict -z`).
    Distances,
    /// Rendering options.
    Options,
    /// Ambient values of `-af`.
    AmbientValues,
    /// Messages of programs, which are appended.
    Messages,
    /// A photon map.
    PhotonMap,
}

/// A file that is written, removed or touched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: OutputKind,
    /// The origin of its name.
    pub named_by: NamedBy,
}

/// One step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Run a program.
    Run {
        /// The program and its options in shell syntax.
        command: String,
        /// The destination of its standard output.
        output: Option<OutputFile>,
        /// Other files that it writes.
        also_writes: Vec<OutputFile>,
        /// Files to remove if it fails.
        removed_on_failure: Vec<String>,
    },
    /// Print the full view of these options.
    ShowView(String),
    /// Set a file's date to now.
    Touch(OutputFile),
    /// Remove a file.
    Remove(OutputFile),
    /// Give a file another name.
    Rename(OutputFile, OutputFile),
    /// Write the rendering options to a file, one per line.
    WriteOptions(OutputFile, String),
}

impl Step {
    /// The files that this step writes, removes or changes.
    #[must_use]
    pub fn outputs(&self) -> Vec<&OutputFile> {
        match self {
            Step::Run { output, also_writes, .. } => output.iter().chain(also_writes).collect(),
            Step::ShowView(_) => Vec::new(),
            Step::Touch(file) | Step::Remove(file) | Step::WriteOptions(file, _) => vec![file],
            Step::Rename(from, to) => vec![from, to],
        }
    }

    /// The command with its output redirection in shell syntax; empty for other steps.
    #[must_use]
    pub fn command_line(&self) -> String {
        match self {
            Step::Run { command, output: Some(output), .. } => format!("{command} > {}", output.name),
            Step::Run { command, output: None, .. } => command.clone(),
            _ => String::new(),
        }
    }

    fn run(command: String) -> Step {
        Step::Run { command, output: None, also_writes: Vec::new(), removed_on_failure: Vec::new() }
    }

    /// Redirects standard output to a file that is kept if the program fails.
    fn into_file(mut self, file: OutputFile) -> Step {
        if let Step::Run { output, .. } = &mut self {
            *output = Some(file);
        }
        self
    }

    fn also_writing(mut self, files: impl IntoIterator<Item = OutputFile>) -> Step {
        if let Step::Run { also_writes, .. } = &mut self {
            also_writes.extend(files);
        }
        self
    }

    fn removing_on_failure(mut self, names: &[&str]) -> Step {
        if let Step::Run { removed_on_failure, .. } = &mut self {
            removed_on_failure.extend(names.iter().map(|name| (*name).to_owned()));
        }
        self
    }
}

impl OutputFile {
    fn new(name: impl Into<String>, kind: OutputKind, named_by: NamedBy) -> OutputFile {
        OutputFile { name: name.into(), kind, named_by }
    }
}

impl Project {
    /// All steps, with missing variables set to their defaults.
    ///
    /// # Errors
    /// The missing or wrong variable.
    pub fn steps(&mut self, how: &How, site: &dyn Site) -> Result<Vec<Step>, ProjectError> {
        let mut maker = Maker { how, site, steps: Vec::new(), octree: Octree::new(self, site)? };
        let cube = maker.octree.cube(self, site);
        self.fill_in(cube)?;
        maker.make_octree(self);
        maker.make_photon_maps(self)?;
        maker.check_ambient_file(self);
        maker.make_pictures(self, cube)?;
        Ok(maker.steps)
    }

    fn fill_in(&mut self, cube: Option<Cube>) -> Result<(), ProjectError> {
        if self.value(Variable::Zone).is_none() {
            let Cube { corner, size } = cube.ok_or(ProjectError::NoCube)?;
            let side = |axis: usize| format!("{} {}", padded(corner[axis], 0, 6), padded(corner[axis] + size, 0, 6));
            self.set_default(Variable::Zone, format!("E {} {} {}", side(0), side(1), side(2)));
        }
        let zone = Zone::of(self)?;
        self.set_default(Variable::EyeSeparation, format!("{:.6}", 0.01 * zone.extent.iter().sum::<f64>()));
        let picture = self.root.clone();
        for (variable, value) in [
            (Variable::Indirect, "0"),
            (Variable::Quality, "L"),
            (Variable::Resolution, "512"),
            (Variable::Picture, &picture),
            (Variable::View, "X"),
            (Variable::Detail, "M"),
            (Variable::Penumbras, "F"),
            (Variable::Variability, "L"),
        ] {
            self.set_default(variable, value);
        }
        Ok(())
    }
}

/// The octree and its inputs.
struct Octree {
    name: String,
    named_by: NamedBy,
    scene: Date,
    date: Date,
    illum: Date,
    materials: Date,
}

impl Octree {
    fn new(project: &mut Project, site: &dyn Site) -> Result<Octree, ProjectError> {
        let usual = format!("{}.oct", project.root);
        project.set_default(Variable::Octree, usual);
        let name = project.value(Variable::Octree).unwrap_or_default().to_owned();
        if name.starts_with('!') {
            return Err(project.wrong(Variable::Octree, "a file"));
        }
        let latest = |variable| latest(&words(project.value(variable).unwrap_or_default()), site);
        let mut scene = latest(Variable::Scene)?;
        if scene > 0 {
            scene = scene.max(latest(Variable::Objects)?);
        }
        let (date, illum) = (site.date(&name), latest(Variable::Illum)?);
        if date == 0 && scene == 0 && illum == 0 {
            return Err(ProjectError::NoScene);
        }
        let named_by = project.named_by(Variable::Octree);
        Ok(Octree { date, scene, illum, materials: latest(Variable::Materials)?, name, named_by })
    }

    fn file(&self, name: &str) -> OutputFile {
        OutputFile::new(name, OutputKind::Octree, self.named_by)
    }

    fn cube(&self, project: &Project, site: &dyn Site) -> Option<Cube> {
        let files = if self.date > 0 && self.date >= self.scene.max(self.illum) {
            vec![self.name.clone()]
        } else {
            let scene = project.value(Variable::Scene).or(project.value(Variable::Illum)).unwrap_or_default();
            words(project.value(Variable::Materials).unwrap_or_default()).into_iter().chain(words(scene)).collect()
        };
        site.cube(&files)
    }
}

struct Maker<'a> {
    how: &'a How,
    site: &'a dyn Site,
    steps: Vec<Step>,
    octree: Octree,
}

/// Later than any file: the date of a file made in this run.
const NOW: Date = Date::MAX;

impl Maker<'_> {
    /// Adds a command whose output is removed if it fails.
    fn run(&mut self, command: String, output: OutputFile) {
        let step = Step::run(command).removing_on_failure(&[&output.name]);
        self.steps.push(step.into_file(output));
    }

    /// Adds the octree and, with `illum` files, the second one with luminous windows.
    fn make_octree(&mut self, project: &Project) {
        let (program, options) = own_options(project, Variable::Oconv);
        let oconv = format!("{}{options}", program.as_deref().unwrap_or("oconv"));
        let name = self.octree.name.clone();
        let value = |variable| project.value(variable).unwrap_or_default();
        let materials = match project.value(Variable::Materials) {
            Some(files) => format!(" {files}"),
            None => String::new(),
        };
        if self.octree.date < self.octree.scene {
            if self.how.touch_only && self.octree.date > 0 {
                self.steps.push(Step::Touch(self.octree.file(&name)));
            } else {
                self.run(format!("{oconv}{materials} {}", value(Variable::Scene)), self.octree.file(&name));
            }
            self.octree.date = NOW;
        }
        let Some(illum) = project.value(Variable::Illum) else {
            self.octree.date = self.octree.date.max(self.octree.materials);
            return;
        };
        let (before, after) = (numbered(&name, '0'), numbered(&name, '1'));
        let [before_date, after_date] = [&before, &after].map(|name| self.site.date(name));
        let Octree { date, scene, illum: illum_date, materials: materials_date, .. } = self.octree;
        self.octree.name = after.clone();
        self.octree.date = after_date;
        if after_date >= date && after_date >= materials_date && after_date >= illum_date {
            return;
        }
        let from = if date > 0 { format!(" -i {name}") } else { materials };
        if before_date < scene || before_date < illum_date {
            if self.how.touch_only && (before_date > 0 || after_date > 0) {
                if before_date > 0 {
                    self.steps.push(Step::Touch(self.octree.file(&before)));
                }
            } else {
                self.run(format!("{oconv}{from} {illum}"), self.octree.file(&before));
            }
        }
        if self.how.touch_only && after_date > 0 {
            self.steps.push(Step::Touch(self.octree.file(&after)));
        } else {
            let (program, options) = own_options(project, Variable::Mkillum);
            let mkillum = format!("{}{options}", program.as_deref().unwrap_or("mkillum"));
            let made = hidden_illum_scene(&project.root);
            let scene = OutputFile::new(&made, OutputKind::IllumScene, NamedBy::CommandLine);
            self.run(format!("{mkillum} {before} \"<\" {illum}"), scene.clone());
            self.steps.push(Step::Remove(self.octree.file(&before)));
            let step = Step::run(format!("{oconv} -f{from} {made}")).removing_on_failure(&[&after, &made]);
            self.steps.push(step.into_file(self.octree.file(&after)));
            self.steps.push(Step::Remove(scene));
        }
        self.octree.date = NOW;
    }

    fn make_photon_maps(&mut self, project: &Project) -> Result<(), ProjectError> {
        let maps = [(Variable::GlobalMap, "-apg"), (Variable::CausticMap, "-apc")];
        let mut outdated = Vec::new();
        let mut all_there = true;
        for (variable, option) in maps {
            let Some(value) = project.value(variable) else { continue };
            let words: Vec<&str> = value.split_whitespace().collect();
            let [file, photons, ..] = words[..] else {
                return Err(project.wrong(variable, "a file and a number of photons"));
            };
            let date = self.site.date(file);
            all_there &= date > 0;
            if date < self.octree.date {
                let map = OutputFile::new(file, OutputKind::PhotonMap, project.named_by(variable));
                outdated.push((map, format!(" {option} {file} {photons}")));
            }
        }
        if outdated.is_empty() {
            return Ok(());
        }
        if self.how.touch_only && all_there {
            self.steps.extend(outdated.into_iter().map(|(file, _)| Step::Touch(file)));
        } else {
            let (program, options) = own_options(project, Variable::Mkpmap);
            let mut command = format!("{}{options} -fo+{}", program.as_deref().unwrap_or("mkpmap"), report(project)?);
            outdated.iter().for_each(|(_, map)| command.push_str(map));
            let files: Vec<&str> = outdated.iter().map(|(file, _)| file.name.as_str()).collect();
            self.steps.push(Step::run(format!("{command} {}", self.octree.name)).removing_on_failure(&files));
        }
        self.octree.date = NOW;
        Ok(())
    }

    fn check_ambient_file(&mut self, project: &Project) {
        let Some(file) = project.value(Variable::AmbientFile) else { return };
        let date = self.site.date(file);
        if date > 0 && self.octree.date > date {
            let file = OutputFile::new(file, OutputKind::AmbientValues, project.named_by(Variable::AmbientFile));
            self.steps.push(if self.how.touch_only { Step::Touch(file) } else { Step::Remove(file) });
        }
    }

    fn make_pictures(&mut self, project: &Project, cube: Option<Cube>) -> Result<(), ProjectError> {
        let zone = Zone::of(project)?;
        let cube = cube.ok_or(ProjectError::NoCube)?;
        let mut options = QualityOptions::new(project, &zone, &cube)?;
        if let Some(file) = project.value(Variable::OptionFile) {
            let render = std::mem::replace(&mut options.render, format!(" @{file}"));
            let file = OutputFile::new(file, OutputKind::Options, project.named_by(Variable::OptionFile));
            self.steps.push(Step::WriteOptions(file, one_a_line(&render)));
        }
        let size = Size::of(project)?;
        let report = report(project)?;
        for view in views(project, &zone, self.how.view.as_deref())? {
            self.make_picture(project, &view, &options, &size, &report);
        }
        Ok(())
    }

    fn make_picture(
        &mut self,
        project: &Project,
        view: &NamedView,
        options: &QualityOptions,
        size: &Size,
        report: &str,
    ) {
        if self.how.show_views {
            self.steps.push(Step::ShowView(view.options.clone()));
        }
        let value = |variable| project.value(variable).unwrap_or_default();
        let root = value(Variable::Picture);
        let named = |root: Variable, root_name: &str, suffix: &str, kind| {
            // A view's name may lead to another folder.
            let by = if view.name.contains('/') { project.named_by(Variable::View) } else { project.named_by(root) };
            OutputFile::new(format!("{root_name}_{}.{suffix}", view.name), kind, by)
        };
        let picture_file = named(Variable::Picture, root, "hdr", OutputKind::Picture);
        let picture = picture_file.name.clone();
        let date = self.site.date(&picture);
        if date >= self.octree.date {
            return;
        }
        let raw_root = project.value(Variable::RawFile);
        let raw_variable = if raw_root.is_some() { Variable::RawFile } else { Variable::Picture };
        let raw_file = named(raw_variable, raw_root.unwrap_or(root), "unf", OutputKind::Picture);
        let raw = raw_file.name.clone();
        let raw_date = self.site.date(&raw);
        if self.how.touch_only {
            let outdated =
                if raw_date > 0 { (raw_date < self.octree.date).then_some(raw_file) } else { Some(picture_file) };
            let outdated = outdated.filter(|_| raw_date > 0 || date > 0);
            return self.steps.extend(outdated.map(Step::Touch));
        }
        let (program, _) = own_options(project, Variable::Rpict);
        let rpict = format!("{}{report}", program.as_deref().unwrap_or("rpict"));
        let distances = project.value(Variable::ZFile);
        let distances = distances.map(|root| named(Variable::ZFile, root, "zbf", OutputKind::Distances));
        let depths = distances.as_ref().map(|file| format!(" -z {}", file.name)).unwrap_or_default();
        let messages = messages(project);
        let (octree, QualityOptions { render, pixels, .. }) = (&self.octree.name, options);
        if raw_date >= self.octree.date {
            let command = format!("{rpict}{render}{pixels}{depths} -ro {raw} {octree}");
            self.steps.push(
                Step::run(command).also_writing(distances.into_iter().chain(messages)).also_writing([raw_file.clone()]),
            );
        } else {
            let view = &view.options;
            if options.overture {
                let small = format!("{rpict} {view}{render}{pixels} -x 64 -y 64 -ps 1 {octree}");
                let nowhere = OutputFile::new("/dev/null", OutputKind::Picture, NamedBy::CommandLine);
                self.steps.push(Step::run(small).into_file(nowhere));
            }
            let size = &size.rendered;
            let command = format!("{rpict} {view} {size}{render}{pixels}{depths} {}", self.octree.name);
            let step = Step::run(command).into_file(raw_file.clone());
            self.steps.push(step.also_writing(distances.into_iter().chain(messages)));
        }
        if raw_root != Some(root) {
            let (program, pfilt) = filter_options(project);
            let command = format!("{}{pfilt}{} {raw}", program.as_deref().unwrap_or("pfilt"), size.reduction);
            self.run(command, picture_file);
        }
        self.steps.push(match raw_root {
            Some(root) => Step::Rename(raw_file, named(Variable::RawFile, root, "hdr", OutputKind::Picture)),
            None => Step::Remove(raw_file),
        });
    }
}

/// The size of pictures.
struct Size {
    /// Options of the rendering.
    rendered: String,
    /// Options that reduce the rendering to the picture, each after a space.
    reduction: String,
}

impl Size {
    fn of(project: &Project) -> Result<Size, ProjectError> {
        let wrong = || project.wrong(Variable::Resolution, "columns, and rows and pixel aspect if wanted");
        let times = Level::of(project, Variable::Quality).oversampling();
        let words: Vec<&str> = project.value(Variable::Resolution).unwrap_or_default().split_whitespace().collect();
        let pixels = |word: &str| word.parse::<u32>().ok().and_then(|size| size.checked_mul(times)).ok_or_else(wrong);
        let columns = pixels(words.first().ok_or_else(wrong)?)?;
        let rows = match words.get(1) {
            Some(word) => pixels(word)?,
            None => columns,
        };
        let mut rendered = format!("-x {columns} -y {rows}");
        if let Some(word) = words.get(2) {
            let aspect: f64 = word.parse().map_err(|_| wrong())?;
            rendered.push_str(&format!(" -pa {aspect:.3}"));
        }
        let reduction = if times > 1 { format!(" -x /{times} -y /{times}") } else { String::new() };
        Ok(Size { rendered, reduction })
    }
}

/// The options for progress reports: minutes between them, and a file for messages.
fn report(project: &Project) -> Result<String, ProjectError> {
    let Some(value) = project.value(Variable::Report) else { return Ok(String::new()) };
    let mut words = value.split_whitespace();
    let minutes: Option<f64> = words.next().and_then(|word| word.parse().ok());
    let minutes = minutes.ok_or_else(|| project.wrong(Variable::Report, "minutes, and a file if wanted"))?;
    let seconds = (minutes * 60.0) as i64;
    Ok(match words.next() {
        Some(file) => format!(" -t {seconds} -e {file}"),
        None => format!(" -t {seconds}"),
    })
}

/// The message file of `REPORT`.
fn messages(project: &Project) -> Option<OutputFile> {
    let file = project.value(Variable::Report)?.split_whitespace().nth(1)?;
    Some(OutputFile::new(file, OutputKind::Messages, project.named_by(Variable::Report)))
}

fn filter_options(project: &Project) -> (Option<String>, String) {
    let mut options = match project.value(Variable::Exposure) {
        Some(exposure) => format!(" -1 -e {exposure}"),
        None => String::new(),
    };
    options.push_str(match Level::of(project, Variable::Quality) {
        Level::Low => "",
        Level::Medium => " -r .6",
        Level::High => " -m .25",
    });
    let (program, own) = own_options(project, Variable::Pfilt);
    (program, options + &own)
}

/// Options, one per line.
fn one_a_line(options: &str) -> String {
    let mut text = String::new();
    let words: Vec<&str> = options.split_whitespace().collect();
    for (place, word) in words.iter().enumerate() {
        let begins = word.starts_with('@')
            || word.strip_prefix('-').is_some_and(|name| name.starts_with(|c: char| c.is_ascii_alphabetic()));
        if place > 0 {
            text.push(if begins { '\n' } else { ' ' });
        }
        text.push_str(word);
    }
    text + "\n"
}

/// The words of a value; quotes group words and are removed.
fn words(value: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut rest = value.trim_start();
    while let Some(first) = rest.chars().next() {
        let quoted = rest.get(1..).filter(|_| matches!(first, '"' | '\''));
        let (word, after) = match quoted {
            Some(inner) => inner.split_once(first).unwrap_or((inner, "")),
            None => rest.split_once(char::is_whitespace).unwrap_or((rest, "")),
        };
        words.push(word.to_owned());
        rest = after.trim_start();
    }
    words
}

/// The latest modification among some files; commands have no date but always exist.
fn latest(files: &[String], site: &dyn Site) -> Result<Date, ProjectError> {
    let mut latest = 0;
    for file in files {
        let date = match file.starts_with('!') || file.starts_with("\\!") {
            true => 1,
            false => site.date(file),
        };
        if date == 0 {
            return Err(ProjectError::NoFile(file.clone()));
        }
        latest = latest.max(date);
    }
    Ok(latest)
}

/// A file name with a digit before its suffix.
fn numbered(name: &str, digit: char) -> String {
    let root = crate::variables::without_suffix(name);
    format!("{root}{digit}{}", &name[root.len()..])
}

/// The temporary scene that `mkillum` writes: a hidden file, so no scene of the user has this name.
fn hidden_illum_scene(root: &str) -> String {
    let (folder, name) = root.rfind('/').map_or(("", root), |slash| root.split_at(slash + 1));
    format!("{folder}.{name}_illum.rad")
}
