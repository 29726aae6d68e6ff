//! The irradiance cache of a renderer: filled, saved, loaded.

use crate::Renderer;
use crate::error::Error;
use radsight_capture::Progress;
use radsight_render::{Ray, RaySpacing, RenderOptions, Uncached};

/// Whether a renderer's rays gather irradiance where the cache has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CacheFilling {
    /// Rays gather irradiance, and new records are added.
    Gather,
    /// Only loaded records are used; paths are traced where they do not suffice.
    Loaded,
}

impl Renderer {
    /// The irradiance cache as bytes for [`Renderer::load_irradiance_cache`]; `None` if it is
    /// empty.
    ///
    /// ```
    /// use radsight::{Renderer, Scene, View};
    /// # fn main() -> Result<(), radsight::Error> {
    /// let text = "void plastic grey 0 0 5 .5 .5 .5 0 0 grey sphere ball 0 0 4 0 9 0 2 void glow sky 0 0 4 1 1 1 0 sky source dome 0 0 4 0 0 1 360";
    /// let scene = Scene::from_text(text)?;
    /// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
    /// let mut first = Renderer::new(&scene)?.ambient_bounces(1);
    /// let image = first.render(&view, 16, 16)?;
    /// let cache = first.save_irradiance_cache().expect("a bounce fills it");
    /// // In another process:
    /// let mut second = Renderer::new(&scene)?.ambient_bounces(1).seed(7);
    /// assert!(second.load_irradiance_cache(cache)? > 0);
    /// # let _ = (image, second.render(&view, 16, 16)?);
    /// # Ok(())
    /// # }
    /// ```
    pub fn save_irradiance_cache(&mut self) -> Option<Vec<u8>> {
        let scene = self.scene.scene.fingerprint();
        let cached = self.ready.as_mut().and_then(|(_, renderer)| renderer.save_irradiance_cache(scene));
        cached.or_else(|| self.loaded.clone())
    }

    /// Loads an irradiance cache saved for the same scene and equivalent options, and returns its
    /// number of records. Rays for which it was gathered get the same results, bit for bit.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let mut first = Renderer::new(&scene())?.ambient_bounces(1);
    /// first.render(&view(), 32, 32)?;
    /// let bytes = first.save_irradiance_cache().unwrap();
    /// assert!(Renderer::new(&scene())?.ambient_bounces(1).load_irradiance_cache(bytes)? > 0);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Cache`] if it was saved for another scene or other options, also after a later
    /// change of options; as [`Renderer::new`].
    pub fn load_irradiance_cache(&mut self, bytes: Vec<u8>) -> Result<usize, Error> {
        let (before, options) = (self.loaded.take(), self.options.clone());
        let scene = self.scene.scene.fingerprint();
        let records = match self.prepare(options)?.load_irradiance_cache(&bytes, scene) {
            Ok(records) => records,
            Err(error) => {
                self.loaded = before;
                return Err(error.into());
            }
        };
        self.loaded = Some(bytes);
        Ok(records)
    }

    /// Uses only the records of this cache, which was saved for the same scene and light. No records
    /// are added: where the cache has none, paths are traced. Parts of a list of rays thus get the
    /// results of the whole list if the cache was filled for the whole list. A cache of another
    /// scene or other options is an error when rays are traced.
    ///
    /// ```
    /// # use radsight::example::scene;
    /// use glam::DVec3;
    /// use radsight::{Ray, Renderer};
    /// let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
    /// let stone = Ray::new(DVec3::new(2.7, 0.0, 0.0), DVec3::Y).unwrap();
    /// let mut first = Renderer::new(&scene())?.ambient_bounces(1);
    /// let cache = first.irradiance_cache_of(&[ahead, stone], &radsight::Silent)?.unwrap();
    /// let mut second = Renderer::new(&scene())?.ambient_bounces(1);
    /// second.only_irradiance_cache(cache);
    /// assert_eq!(second.trace(&[ahead, stone])?[1].value, first.trace(&[ahead, stone])?[1].value);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    pub fn only_irradiance_cache(&mut self, bytes: Vec<u8>) {
        (self.loaded, self.filling, self.ready) = (Some(bytes), CacheFilling::Loaded, None);
    }

    /// Fills the irradiance cache for the rays of [`Renderer::trace`], and returns it as bytes;
    /// `None` if the options use no cache, or if `progress` stopped the work.
    ///
    /// ```
    /// # use radsight::example::scene;
    /// use glam::DVec3;
    /// use radsight::{Ray, Renderer};
    /// let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
    /// let below = Ray::new(DVec3::new(2.7, 0.0, 0.0), DVec3::Y).unwrap();
    /// let mut renderer = Renderer::new(&scene())?.ambient_bounces(1);
    /// assert!(renderer.irradiance_cache_of(&[ahead, below], &radsight::Silent)?.is_some());
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn irradiance_cache_of(&mut self, rays: &[Ray], progress: &dyn Progress) -> Result<Option<Vec<u8>>, Error> {
        let mut options = self.options.clone();
        options.gathering.uncached = Uncached::Split;
        options.gathering.bounded = true;
        let all = || rays.iter().copied().map(Some).collect();
        if self.gather(&options, all, RaySpacing::UNKNOWN, progress)?.is_none() {
            return Ok(None);
        }
        self.check_met()?;
        Ok(self.save_irradiance_cache())
    }

    /// Gathers irradiance for rays, if requested. `None` if it was stopped.
    pub(crate) fn gather(
        &mut self,
        options: &RenderOptions,
        rays: impl FnOnce() -> Vec<Option<Ray>>,
        spacing: RaySpacing,
        progress: &dyn Progress,
    ) -> Result<Option<()>, Error> {
        let filling = self.filling;
        let renderer = self.prepare(options.clone())?;
        if filling == CacheFilling::Loaded || !renderer.caches_irradiance() {
            return Ok(Some(()));
        }
        let found = renderer.gather_irradiance_until(&rays(), spacing, &|| progress.stops());
        if found.is_none() {
            // The loaded records are read again when rays are traced the next time.
            self.ready = None;
        }
        Ok(found.map(drop))
    }
}
