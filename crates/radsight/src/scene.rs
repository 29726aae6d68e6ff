//! Scenes, read and validated.

use crate::error::{Error, Report};
use crate::file_loader::FileLoader;
use crate::material::Materials;
use radsight_brdf::Brdf;
use radsight_diag::{Diagnostic, SourceMap};
use radsight_ir::ValidScene;
use radsight_loader::{FileKind, Loader};
use radsight_parse::{Input, Read, ReadOptions, read_scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene: surfaces, materials, patterns and lights, checked.
///
/// ```
/// use radsight::{Error, Scene};
/// let error = Scene::from_text("chrome sphere ball 0 0 4 0 0 0 -1").unwrap_err();
/// let Error::Scene(report) = error else { panic!("the scene is wrong") };
/// assert_eq!(report.position(&report.diagnostics[0]).unwrap(), ("<text>", 1, 1));
/// assert!(report.to_string().contains("undefined modifier \"chrome\""));
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) scene: ValidScene,
    pub(crate) sources: SourceMap,
    pub(crate) materials: Materials,
    warnings: Vec<Diagnostic>,
}

impl Scene {
    /// Reads scene files and octrees. Files that they name are searched in the working folder, then
    /// beside the scenes.
    ///
    /// ```no_run
    /// let scene = radsight::Scene::load(["office.rad", "lamps.rad"])?;
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Load`] for a file that cannot be read, [`Error::Scene`] with every mistake in them.
    pub fn load<P: AsRef<Path>>(paths: impl IntoIterator<Item = P>) -> Result<Scene, Error> {
        let paths: Vec<PathBuf> = paths.into_iter().map(|path| path.as_ref().to_owned()).collect();
        let beside = paths.iter().filter_map(|path| path.parent().filter(|folder| *folder != Path::new("")));
        let folders: Vec<PathBuf> = std::iter::once(Path::new(".")).chain(beside).map(Path::to_owned).collect();
        Scene::builder().loader(FileLoader::new(folders)).files(paths)?.build()
    }

    /// Reads scene text. Files that it names are searched in the working folder.
    ///
    /// ```
    /// let error = radsight::Scene::from_text("void plastic").unwrap_err();
    /// assert!(error.to_string().contains(":1:"), "{error}");
    /// ```
    ///
    /// # Errors
    /// [`Error::Scene`] with every mistake in it.
    pub fn from_text(text: impl AsRef<[u8]>) -> Result<Scene, Error> {
        Scene::builder().text("<text>", text).build()
    }

    /// A scene from several sources, with custom materials and loader.
    ///
    /// ```
    /// let scene = radsight::Scene::builder().text("empty.rad", "# nothing").build()?;
    /// assert_eq!(scene.surface_count(), 0);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn builder() -> SceneBuilder<'static> {
        SceneBuilder {
            inputs: Vec::new(),
            loader: Box::new(FileLoader::default()),
            materials: Materials::default(),
            options: ReadOptions::default(),
        }
    }

    /// The warnings, with lines, carets and hints; empty if there are none.
    ///
    /// ```
    /// assert!(radsight::example::scene().warnings().diagnostics.is_empty());
    /// ```
    #[must_use]
    pub fn warnings(&self) -> Report {
        Report { diagnostics: self.warnings.clone(), sources: self.sources.clone() }
    }

    /// Number of surfaces; those of a mesh or an instance count once.
    ///
    /// ```
    /// assert_eq!(radsight::example::scene().surface_count(), 3);
    /// ```
    #[must_use]
    pub fn surface_count(&self) -> usize {
        self.scene.surfaces.len()
    }
}

/// The name of a camera file's light ring in messages.
pub(crate) const LIGHT_RING: &str = "<light ring>";

/// Collects what a scene is read from.
///
/// ```
/// use radsight::{MemoryLoader, Scene};
/// let files = MemoryLoader::default().with("half.cal", "half = .5;");
/// let text = "void brightfunc dim 2 half half.cal 0 0 dim glow panel 0 0 4 2 2 2 0 panel ring disk 0 0 8 0 9 0 0 -1 0 0 1";
/// let scene = Scene::builder().loader(files).text("panel.rad", text).build()?;
/// assert_eq!(scene.surface_count(), 1);
/// # Ok::<(), radsight::Error>(())
/// ```
pub struct SceneBuilder<'l> {
    inputs: Vec<Input>,
    loader: Box<dyn Loader + 'l>,
    materials: Materials,
    options: ReadOptions,
}

impl<'l> SceneBuilder<'l> {
    /// Adds scene files and octrees from disk.
    ///
    /// ```no_run
    /// let scene = radsight::Scene::builder().files(["office.rad"])?.build()?;
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Load`] for a file that cannot be read.
    pub fn files<P: AsRef<Path>>(mut self, paths: impl IntoIterator<Item = P>) -> Result<SceneBuilder<'l>, Error> {
        for path in paths {
            let name = path.as_ref().display().to_string();
            let loaded = self.loader.load(&name, FileKind::Scene)?;
            self.inputs.push(Input::Text { name: loaded.path, text: loaded.bytes.into() });
        }
        Ok(self)
    }

    /// Adds scene text. `name` denotes it in messages.
    ///
    /// ```
    /// let text = "void glow lamp 0 0 4 1 1 1 0  lamp sphere ball 0 0 4 0 0 0 1";
    /// assert_eq!(radsight::Scene::builder().text("ball.rad", text).build()?.surface_count(), 1);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn text(mut self, name: &str, text: impl AsRef<[u8]>) -> SceneBuilder<'l> {
        self.inputs.push(Input::Text { name: name.to_owned(), text: text.as_ref().into() });
        self
    }

    /// Sets the loader of all files named from here on. A borrowed loader remains usable.
    ///
    /// ```
    /// use radsight::{MemoryLoader, Scene};
    /// let memory = MemoryLoader::default().with("ball.rad", "void glow g 0 0 4 1 1 1 0 g sphere b 0 0 4 0 0 0 1");
    /// let scene = Scene::builder().loader(&memory).files(["ball.rad"])?.build()?;
    /// assert_eq!(scene.surface_count(), 1);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn loader<'n>(self, loader: impl Loader + 'n) -> SceneBuilder<'n>
    where
        'l: 'n,
    {
        SceneBuilder { loader: Box::new(loader), inputs: self.inputs, materials: self.materials, options: self.options }
    }

    /// Replaces the material with this name by a custom model.
    #[must_use]
    pub fn material(mut self, name: &str, model: Arc<dyn Brdf>) -> SceneBuilder<'l> {
        self.materials.insert(name, model);
        self
    }

    /// Reads and checks the scene.
    ///
    /// ```
    /// assert!(radsight::Scene::builder().text("a.rad", "void plastic").build().is_err());
    /// ```
    ///
    /// # Errors
    /// [`Error::Scene`] with every mistake in it.
    pub fn build(self) -> Result<Scene, Error> {
        self.read(None)
    }

    /// Reads and checks the scene with a light ring.
    pub(crate) fn read(&self, ring: Option<&str>) -> Result<Scene, Error> {
        let options = ReadOptions { brdf: self.materials.replacements(), ..self.options.clone() };
        let ring = ring.map(|text| Input::Text { name: LIGHT_RING.to_owned(), text: text.as_bytes().into() });
        let inputs: Vec<Input> = self.inputs.iter().cloned().chain(ring).collect();
        let read = read_scene(&inputs, &*self.loader, &options);
        if read.has_errors() {
            return Err(Error::Scene(Report::new(read.diagnostics, read.sources)));
        }
        let Read { scene, sources, diagnostics, .. } = read;
        match scene.validate() {
            Ok(valid) => {
                let warnings = diagnostics.into_iter().chain(valid.warnings).collect();
                Ok(Scene { scene: valid.scene, sources, materials: self.materials.clone(), warnings })
            }
            Err(errors) => Err(Error::Scene(Report::new(errors, sources))),
        }
    }
}
