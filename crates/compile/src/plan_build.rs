//! Builds the render plan of a scene.

use crate::compile::compile_shaders;
use crate::hierarchy_choice::HierarchyChoice;
use crate::light_policy::{ALWAYS_ALL, light_draws};
use crate::lighting::collect_lights;
use crate::mist_lights::MistLights;
use crate::model_source::ModelSource;
use crate::options::{BareSurfaces, RenderOptions, Skip};
use crate::plan::{RenderPlan, Sky, virtual_source_shader};
use crate::portal_search::makes_caustics;
use crate::portals::Portals;
use crate::reflectors::{find_flat_reflectors, find_reflectors};
use crate::shader::{Emitter, EmitterType, Kind, Shader, Substitution};
use crate::shader_sets::{all_cut, excluded, mark_tracked};
use crate::substance::substance;
use crate::unbounded::Unbounded;
use crate::veils::find_veils;
use crate::visibility_class::{UnsampledLight, Visibility};
use radsight_accel::Geometry;
use radsight_diag::Diagnostic;
use radsight_ir::{Shape, SurfaceHandle, ValidScene};
use radsight_light::{LightId, LightTree};
use radsight_texture::BandLayout;
use std::sync::{Arc, OnceLock};

impl RenderPlan {
    /// Plans the rendering of a scene.
    ///
    /// # Errors
    /// What the scene uses and this renderer does not support, with its position in the scene text.
    pub fn new(
        scene: ValidScene,
        mut options: RenderOptions,
        models: &dyn ModelSource,
    ) -> Result<RenderPlan, Vec<Diagnostic>> {
        if options.gathering.divisions == 0 {
            options.ambient_bounces = 0;
        }
        let layout = Arc::new(BandLayout::new(options.sampling));
        let colors = [options.ambient_value, options.medium.extinction, options.medium.albedo];
        let (mut shaders, shader_table, bands) = compile_shaders(&scene, models, &colors, &layout, options.skipping)?;
        mark_tracked(&mut shaders, &scene, &options.tracked_modifiers);
        let shader = |handle: SurfaceHandle| &shaders[shader_table.of(scene.surfaces[handle].modifier).0 as usize];
        let is_bare = |shader: &Shader| matches!(shader.kind, Kind::Transparent);
        let meets_bare = options.bare_surfaces == BareSurfaces::Reported;
        let hierarchy = HierarchyChoice::new(&scene, &options);
        let wanted = |handle| meets_bare || !is_bare(shader(handle));
        let geometry = Geometry::build(&scene, substance, wanted, hierarchy.builder).map_err(|error| vec![error])?;
        let virtual_source = |handle: SurfaceHandle| virtual_source_shader(&shaders, shader(handle));
        let lights = collect_lights(&scene, &geometry, shader, virtual_source, options.mirror_sources);
        let mut lights_of: Vec<_> =
            lights.iter().enumerate().map(|(id, light)| (light.surface, LightId(id as u32))).collect();
        lights_of.sort_by_key(|(surface, id)| (*surface, id.0));
        let sky = collect_sky(&scene, shader);
        let skipping = options.skipping;
        let may_skip = |skip| skipping.allows(skip);
        let any = |is: fn(&Kind) -> bool| shaders.iter().any(|shader| is(&shader.kind));
        let see_through = shaders.iter().any(|shader| shader.lets_light_through() || meets_bare && is_bare(shader))
            || geometry.holds_void(&scene, &shader_table, |id| shaders.get(id.0 as usize).is_some_and(is_bare));
        let veils = find_veils(&scene, &geometry, shader);
        let in_medium = !options.medium.extinction.is_black();
        let has_mist = in_medium || any(|kind| matches!(kind, Kind::Mist(_)));
        let has_dielectrics = any(|kind| matches!(kind, Kind::Dielectric(_)));
        let has_panes = any(|kind| matches!(kind, Kind::Glass { .. }));
        let has_media = has_mist || has_dielectrics;
        let stands_in = any(|kind| matches!(kind, Kind::Illum { .. } | Kind::Mirror { substitute: Some(_), .. }));
        let cut_shaders = all_cut(&shaders);
        let has_antimatter = any(|kind| matches!(kind, Kind::Antimatter(_)));
        let shadow_rays_interact = has_media || stands_in || has_antimatter;
        let lights_are_covered = has_media
            && (!options.medium.albedo.is_black() || any(|kind| matches!(kind, Kind::Mist(mist) if mist.scatters())));
        let has_unsampled_sky = sky.iter().any(|sky| !lights.iter().any(|light| light.surface == sky.surface));
        let unsampled_light = match has_unsampled_sky || lights_are_covered {
            true => UnsampledLight::Some,
            false => UnsampledLight::None,
        };
        let visibility = if may_skip(Skip::Unreached) && !has_antimatter {
            Visibility::new(&scene, &geometry, shader, &lights, unsampled_light)
        } else {
            Visibility::everything()
        };
        let reflectors = find_reflectors(&scene, &geometry, &shaders, shader);
        let flat_reflectors = find_flat_reflectors(&scene, &geometry, &shaders, shader, lights.len());
        let mist_lights = MistLights::new(&scene, &lights, &mut shaders).map_err(|error| vec![error])?;
        let excluded = excluded(&scene, &shaders, &options.ambient_surfaces);
        let mut plan = RenderPlan {
            scene,
            options,
            geometry,
            hierarchy,
            shaders,
            shader_table,
            lights,
            lights_of,
            light_tree: None,
            light_draws: [0; 2],
            portals: Portals::default(),
            reflectors,
            flat_reflectors,
            has_caustics: false,
            sky,
            visibility,
            veils,
            see_through: see_through || !may_skip(Skip::BehindShadows),
            shadow_rays_interact: shadow_rays_interact || !may_skip(Skip::RefractedShadows),
            has_mist,
            has_panes,
            divides_rays: has_dielectrics || has_panes,
            has_media: has_media || !may_skip(Skip::Media),
            has_antimatter: has_antimatter || !may_skip(Skip::Antimatter),
            cut_shaders,
            lights_are_covered,
            mist_lights,
            excluded,
            bands,
            layout,
            unusable_hit: OnceLock::new(),
            unbounded: Unbounded::default(),
            decisions: OnceLock::new(),
        };
        plan.find_profiles();
        if plan.lights.len() > ALWAYS_ALL {
            plan.light_tree = Some(LightTree::new(&plan.lights, |light| plan.typical_radiance(light)));
        }
        plan.light_draws = light_draws(&plan.lights, plan.light_tree.as_ref(), &plan.options);
        if plan.options.ambient_bounces > 0 {
            plan.portals = Portals::new(&plan);
            plan.has_caustics = makes_caustics(&plan);
        }
        Ok(plan)
    }
}

/// Sorts the distant sources. A ray sees the first light that contains its direction, otherwise the
/// first illum whose alternate material is void, otherwise the first glow.
fn collect_sky<'a>(scene: &ValidScene, shader: impl Fn(SurfaceHandle) -> &'a Shader) -> Vec<Sky> {
    let rank = |kind: &Kind| match kind {
        Kind::Illum { substitute: Substitution::Void, .. } => 1,
        Kind::Emitter(Emitter { class: EmitterType::Glow(_), .. }) | Kind::Unusable(_) => 2,
        _ => 0,
    };
    let mut sky: Vec<Sky> = scene
        .surfaces
        .iter()
        .filter(|(handle, _)| match &shader(*handle).kind {
            Kind::Unusable(_) => true,
            kind => kind.emitter().is_some_and(|emitter| !emitter.radiance.is_black()),
        })
        .filter_map(|(handle, surface)| match surface.shape {
            Shape::Source(source) => {
                let source = scene.sources[source];
                let sin = (0.25 * source.extent.full_angle).sin();
                Some(Sky { surface: handle, direction: source.direction, cap: sin * sin })
            }
            _ => None,
        })
        .collect();
    sky.sort_by_key(|sky| rank(&shader(sky.surface).kind));
    sky
}
