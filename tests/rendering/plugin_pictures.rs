//! The same reflectance model as a built-in one and in a plugin gives the same picture, bit for
//! bit.

use glam::DVec3;
use radsight_brdf::{Brdf, Lambert, WardIsotropic};
use radsight_brdf_host::check::CHECK_BANDS;
use radsight_brdf_host::{Label, Registry, Request, SearchPath, SelfCheck};
use radsight_diag::Diagnostic;
use radsight_loader::MemoryLoader;
use radsight_parse::{Input, ReadOptions, read_scene};
use radsight_render::{ModelRequest, ModelSource, Ray, RenderOptions, RenderPlan, Renderer};
use radsight_test_support::plugins;
use std::path::PathBuf;
use std::sync::Arc;

/// The built-in models.
struct InProgram;

fn model<const BANDS: usize>(request: &ModelRequest<'_>) -> Arc<dyn Brdf> {
    let color = std::array::from_fn::<_, BANDS, _>(|band| request.numbers[band]);
    match request.model {
        "lambert" => Arc::new(Lambert { reflectance: color }),
        _ => Arc::new(WardIsotropic { specularity: color, roughness: request.numbers[3] }),
    }
}

impl ModelSource for InProgram {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        Ok(if request.bands == 1 { model::<1>(request) } else { model::<3>(request) })
    }
}

/// The plugin `builtin`.
struct InPlugin {
    registry: Registry,
    library: PathBuf,
}

impl ModelSource for InPlugin {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        let library = self.registry.library_file(&self.library).expect("the plugin loads");
        let bands = &CHECK_BANDS[..request.bands];
        let (label, words) = (Label::default(), request.words);
        let asked = Request {
            library: "",
            model: request.model,
            words,
            numbers: request.numbers,
            bands,
            label: &label,
            folder: None,
        };
        Ok(self.registry.instantiate_from(library, &asked).expect("the model is made").brdf)
    }
}

/// The bits of a picture of a scene from above, two bounces deep.
fn picture(scene: &str, models: &dyn ModelSource) -> Vec<u64> {
    let input = Input::Text { name: "scene.rad".to_owned(), text: scene.as_bytes().into() };
    let read = read_scene(&[input], &MemoryLoader::default(), &ReadOptions::default());
    assert!(!read.has_errors(), "{}", read.render(9));
    let scene = read.scene.validate().expect("the scene is valid").scene;
    let options = RenderOptions { ambient_bounces: 2, ..RenderOptions::default() };
    let renderer = Renderer::new(RenderPlan::new(scene, options, models).expect("the scene can be rendered"));
    let ray = |pixel: u32| {
        let (x, y) = (f64::from(pixel % 40) / 20.0 - 1.0, f64::from(pixel / 40) / 20.0 - 1.0);
        Ray::new(DVec3::new(0.2, -0.3, 3.0), DVec3::new(x, y, -3.0))
    };
    let rays: Vec<Option<Ray>> = (0..1600).map(ray).collect();
    let traced = renderer.trace_all(0, &rays);
    assert!(traced.iter().flatten().any(|traced| traced.value[0] > 0.0), "something is seen");
    traced.iter().flatten().flat_map(|traced| traced.value.map(f64::to_bits)).collect()
}

/// A ball and a textured floor between small lamps, a panel and a mirror.
fn scene(materials: &str) -> String {
    let lamps: String = (0..9)
        .map(|lamp| format!("lamp sphere lamp{lamp} 0 0 4 {} {} 2 .1\n", f64::from(lamp % 3) - 1.0, lamp / 3 - 1))
        .collect();
    format!(
        "{materials}void texfunc bumps 4 .1*sin(9*Px) .1*sin(7*Py) 0 . 0 0\n\
         void light lamp 0 0 3 3 3 3\n{lamps}\
         lamp polygon panel 0 0 12 2 -1 .2 2 -1 1 2 1 1 2 1 .2\n\
         void mirror silver 0 0 3 .9 .9 .9\nsilver polygon wall 0 0 12 -2 2 0 2 2 0 2 2 2 -2 2 2\n\
         painted sphere ball 0 0 4 .2 .3 .4 .4\nbumps alias rough painted\n\
         rough polygon floor 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0\n"
    )
}

#[test]
fn a_plugin_gives_the_picture_of_the_built_in_model() {
    let library = plugins::workspace_plugin("radsight-plugin-builtin");
    let plugin = InPlugin { registry: Registry::new(SearchPath::default(), SelfCheck::Off), library };
    for material in ["ward 0 4 .9 .5 .1 .15", "lambert 0 3 .9 .5 .1", "ward 0 4 .5 .5 .5 .05", "lambert 0 3 .5 .5 .5"] {
        let scene = scene(&format!("void brdfplugin painted 2 builtin {material}\n"));
        assert!(picture(&scene, &InProgram) == picture(&scene, &plugin), "{material}: the pictures differ");
    }
    assert!(plugin.registry.fault_reports().is_empty());
}
