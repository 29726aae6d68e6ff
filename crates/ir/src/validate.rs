//! Validation: turns a [`Scene`] into a [`ValidScene`].

use crate::planarity::{PolygonPlane, ROUNDING, make_planar};
use crate::{
    Anisotropic, Dielectric, Glossy, Handle, Material, Modifier, ModifierKind, Rgb, Scene, Shape, Surface, Translucent,
    ValidScene,
};
use glam::DVec3;
use radsight_diag::Diagnostic;
use radsight_triangulation::{MOST_EAR_CLIPPED, triangulate};
use std::collections::HashSet;

/// A valid scene, with warnings.
#[derive(Clone, Debug)]
pub struct Validated {
    /// The scene.
    pub scene: ValidScene,
    /// Suspicious properties that do not prevent rendering.
    pub warnings: Vec<Diagnostic>,
}

/// Deviation of a polygon's vertices from its plane, relative to its size, above which a warning is
/// given.
const PLANARITY_TOLERANCE: f64 = 1e-3;

impl Scene {
    /// Checks every number, handle and shape, and moves the vertices of polygons into their planes.
    ///
    /// # Errors
    /// All errors, each with its position in the scene text.
    pub fn validate(self) -> Result<Validated, Vec<Diagnostic>> {
        let (mut errors, mut warnings) = (Vec::new(), Vec::new());
        let mut is_planar = true;
        warnings.extend(unknown_mist_sources(&self));
        // Shared scenes are checked once.
        let mut seen = HashSet::new();
        let mut waiting = vec![&self];
        while let Some(scene) = waiting.pop() {
            let found = Findings::of(scene);
            errors.extend(found.errors);
            warnings.extend(found.warnings);
            is_planar &= found.is_planar;
            let octrees = scene.octrees.items().iter().rev();
            waiting
                .extend(octrees.map(|octree| &*octree.scene).filter(|inner| seen.insert(std::ptr::from_ref(*inner))));
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        let mut scene = self;
        if !is_planar {
            make_planar(&mut scene);
        }
        Ok(Validated { scene: ValidScene(scene), warnings })
    }
}

/// A warning for each name of a source in a mist's list that no surface of the scene has. A surface has
/// a name of its own, besides that of its material.
fn unknown_mist_sources(scene: &Scene) -> Vec<Diagnostic> {
    let mut warnings = Vec::new();
    let mut surfaces: Option<HashSet<&str>> = None;
    for modifier in scene.modifiers.items() {
        let ModifierKind::Material(Material::Mist(mist)) = &modifier.kind else { continue };
        for source in &mist.sources {
            let name = |surface: &Surface| scene.names.get(surface.name);
            let known = surfaces.get_or_insert_with(|| scene.surfaces.items().iter().map(name).collect());
            // `mirror>lamp` is the image of a lamp in a mirror.
            let lamp = source.rsplit('>').next().unwrap_or(source);
            if !known.contains(lamp) {
                let mist = scene.names.get(modifier.name);
                let message = format!("mist \"{mist}\" names the source \"{lamp}\", but no surface has this name");
                warnings.push(at(Diagnostic::warning(message), modifier.span));
            }
        }
    }
    warnings
}

struct Findings<'a> {
    scene: &'a Scene,
    /// By index of the mesh.
    sound_meshes: Vec<bool>,
    /// Whether the vertices of each polygon lie in its plane.
    is_planar: bool,
    errors: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
}

impl<'a> Findings<'a> {
    /// Errors of a scene, without those of the scenes that it places.
    fn of(scene: &'a Scene) -> Self {
        let sound_meshes = scene.meshes.items().iter().map(|mesh| mesh_is_sound(scene, mesh)).collect();
        let mut found = Findings { scene, sound_meshes, is_planar: true, errors: Vec::new(), warnings: Vec::new() };
        for (handle, modifier) in scene.modifiers.iter() {
            found.check_modifier(handle, modifier);
        }
        for surface in scene.surfaces.items() {
            found.check_surface(surface);
        }
        found
    }

    fn error(&mut self, span: Option<radsight_diag::Span>, message: String) {
        self.errors.push(at(Diagnostic::error(message), span));
    }

    fn warn(&mut self, span: Option<radsight_diag::Span>, message: String) {
        self.warnings.push(at(Diagnostic::warning(message), span));
    }

    fn check_modifier(&mut self, handle: Handle<Modifier>, modifier: &Modifier) {
        if modifier.modifier.is_some_and(|parent| parent >= handle) {
            self.error(modifier.span, "a modifier is defined after the one that it modifies".to_owned());
        }
        let ModifierKind::Material(material) = &modifier.kind else { return };
        let name = self.scene.names.get(modifier.name).to_owned();
        let mut numbers = Vec::new();
        collect_numbers(material, &mut numbers);
        if let Some(bad) = numbers.iter().find(|value| !value.is_finite()) {
            self.error(modifier.span, format!("material \"{name}\" has the number {bad}, expected a finite one"));
        }
        if let Some(reflectance) = total_reflectance(material)
            && reflectance > 1.0 + 1e-6
        {
            self.warn(
                modifier.span,
                format!("material \"{name}\" reflects {reflectance:.4} of the incident light, expected at most 1"),
            );
        }
    }

    fn check_surface(&mut self, surface: &Surface) {
        if surface.modifier.is_some_and(|handle| self.scene.modifiers.get(handle).is_none()) {
            self.error(surface.span, "a surface has a modifier that does not exist".to_owned());
        }
        let scene = self.scene;
        let problem = match surface.shape {
            Shape::Polygon { start, count } => return self.check_polygon(surface, start, count),
            Shape::Sphere(handle) => scene
                .spheres
                .get(handle)
                .map(|sphere| sphere.center.is_finite() && sphere.radius.is_finite() && sphere.radius > 0.0),
            Shape::Cone(handle) => scene.cones.get(handle).map(|cone| {
                let radii = [cone.base_radius, cone.apex_radius];
                cone.base.is_finite()
                    && cone.apex.is_finite()
                    && cone.base != cone.apex
                    && radii.iter().all(|radius| radius.is_finite() && *radius >= 0.0)
                    && radii != [0.0; 2]
            }),
            Shape::Ring(handle) => scene.rings.get(handle).map(|ring| {
                ring.center.is_finite()
                    && is_unit(ring.normal)
                    && ring.inner_radius >= 0.0
                    && ring.outer_radius.is_finite()
                    && ring.outer_radius > ring.inner_radius
            }),
            Shape::Source(handle) => scene.sources.get(handle).map(|source| {
                let angle = source.extent.full_angle;
                is_unit(source.direction) && angle > 0.0 && angle <= std::f64::consts::TAU + 1e-9
            }),
            Shape::Mesh(handle) => scene.mesh_instances.get(handle).map(|placed| {
                placed.to_scene.scale > 0.0
                    && placed.to_scene.translation.is_finite()
                    && self.sound_meshes.get(placed.mesh.index()) == Some(&true)
            }),
            Shape::Instance(handle) => scene.instances.get(handle).map(|placed| {
                placed.to_scene.scale > 0.0
                    && placed.to_scene.translation.is_finite()
                    && scene.octrees.get(placed.octree).is_some()
            }),
        };
        if problem != Some(true) {
            let name = self.scene.names.get(surface.name);
            self.error(surface.span, format!("surface \"{name}\" has an invalid size or position"));
        }
    }

    fn check_polygon(&mut self, surface: &Surface, start: u32, count: u32) {
        let name = self.scene.names.get(surface.name);
        let range = start as usize..start as usize + count as usize;
        let Some(vertices) = self.scene.vertices.get(range).filter(|vertices| vertices.len() >= 3) else {
            return self.error(surface.span, format!("polygon \"{name}\" has fewer than three vertices"));
        };
        if vertices.iter().any(|vertex| !vertex.is_finite()) {
            return self.error(surface.span, format!("polygon \"{name}\" has a vertex that is not finite"));
        }
        let Some(plane) = PolygonPlane::of(vertices) else {
            return self.warn(surface.span, format!("polygon \"{name}\" has no area"));
        };
        if vertices.len() > MOST_EAR_CLIPPED
            && self.is_light(surface)
            && let Err(error) = triangulate(&plane.flattened(vertices))
        {
            return self.error(surface.span, format!("light \"{name}\" of {count} vertices {error}"));
        }
        let deviation = plane.deviation(vertices);
        self.is_planar &= deviation <= ROUNDING;
        if deviation > PLANARITY_TOLERANCE {
            self.warn(surface.span, format!("polygon \"{name}\" is not planar"));
        }
    }

    fn is_light(&self, surface: &Surface) -> bool {
        self.scene.chain(surface.modifier).any(|(_, modifier)| match &modifier.kind {
            ModifierKind::Material(material) => material.is_light(),
            _ => false,
        })
    }
}

fn mesh_is_sound(scene: &Scene, mesh: &crate::Mesh) -> bool {
    mesh.triangles.iter().all(|triangle| {
        triangle.modifier.is_none_or(|handle| scene.modifiers.get(handle).is_some())
            && triangle.vertices.iter().all(|&index| {
                let index = index as usize;
                index < mesh.vertices.len()
                    && (!triangle.smooth || index < mesh.normals.len())
                    && (!triangle.textured || index < mesh.uvs.len())
            })
    }) && mesh.vertices.iter().chain(&mesh.normals).all(|vertex| vertex.is_finite())
        && mesh.uvs.as_flattened().iter().all(|coordinate| coordinate.is_finite())
}

fn is_unit(direction: DVec3) -> bool {
    (direction.length_squared() - 1.0).abs() < 1e-6
}

fn at(diagnostic: Diagnostic, span: Option<radsight_diag::Span>) -> Diagnostic {
    match span {
        Some(span) => diagnostic.at(span),
        None => diagnostic,
    }
}

fn collect_numbers(material: &Material, out: &mut Vec<f64>) {
    let mut rgb = |color: &Rgb| out.extend(color.0);
    match material {
        Material::Light { radiance } | Material::Illum { radiance, .. } => rgb(radiance),
        Material::Glow { radiance, max_radius } => {
            rgb(radiance);
            out.push(*max_radius);
        }
        Material::Spotlight { radiance, cone_angle, direction, focal_distance } => {
            rgb(radiance);
            out.extend([*cone_angle, *focal_distance]);
            out.extend(direction.to_array());
        }
        Material::Mirror { reflectance, .. } => rgb(reflectance),
        Material::Plastic(surface) | Material::Metal(surface) => collect_glossy(surface, out),
        Material::Trans(surface) => collect_translucent(surface, out),
        Material::AnisotropicPlastic(Anisotropic { surface, roughness_v, .. })
        | Material::AnisotropicMetal(Anisotropic { surface, roughness_v, .. }) => {
            collect_glossy(surface, out);
            out.push(*roughness_v);
        }
        Material::AnisotropicTrans(Anisotropic { surface, roughness_v, .. }) => {
            collect_translucent(surface, out);
            out.push(*roughness_v);
        }
        Material::Ashikhmin { diffuse, specular, exponents, .. } => {
            rgb(diffuse);
            rgb(specular);
            out.extend(exponents);
        }
        Material::Dielectric(body) => collect_dielectric(body, out),
        Material::Interface(boundary) => {
            collect_dielectric(&boundary.inside, out);
            collect_dielectric(&boundary.outside, out);
        }
        Material::Glass { transmissivity, refractive_index } => {
            rgb(transmissivity);
            out.push(*refractive_index);
        }
        Material::Mist(mist) => {
            rgb(&mist.extinction);
            mist.albedo.iter().for_each(rgb);
            out.extend(mist.eccentricity);
        }
        Material::Plugin { numbers, .. } => out.extend(numbers),
        Material::Bsdf { added_diffuse, .. } => added_diffuse.iter().for_each(rgb),
        _ => {}
    }
}

fn collect_glossy(surface: &Glossy, out: &mut Vec<f64>) {
    out.extend(surface.color.0);
    out.extend([surface.specularity, surface.roughness]);
}

fn collect_translucent(surface: &Translucent, out: &mut Vec<f64>) {
    collect_glossy(&surface.surface, out);
    out.extend([surface.transmissivity, surface.transmitted_specularity]);
}

fn collect_dielectric(body: &Dielectric, out: &mut Vec<f64>) {
    out.extend(body.transmissivity.0);
    out.extend([body.refractive_index, body.hartmann]);
}

/// Largest reflectance of a simple material over all bands, without patterns.
fn total_reflectance(material: &Material) -> Option<f64> {
    let largest = |color: &Rgb| color.0.iter().copied().fold(f64::MIN, f64::max);
    match material {
        Material::Plastic(s) => Some(s.specularity + largest(&s.color) * (1.0 - s.specularity)),
        Material::Metal(s) => Some(largest(&s.color)),
        Material::Trans(t) => {
            let s = &t.surface;
            Some(s.specularity + largest(&s.color) * (1.0 - s.specularity))
        }
        Material::Mirror { reflectance, .. } => Some(largest(reflectance)),
        Material::Glass { transmissivity, .. } => Some(largest(transmissivity)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::*;
    use glam::DVec3;

    fn polygon(vertices: &[[f64; 3]]) -> Scene {
        let mut scene = Scene::default();
        scene.vertices.extend(vertices.iter().map(|v| DVec3::from_array(*v)));
        let name = scene.names.add("wall");
        let shape = Shape::Polygon { start: 0, count: vertices.len() as u32 };
        scene.surfaces.add(Surface { name, span: None, modifier: None, shape });
        scene
    }

    #[test]
    fn a_polygon_with_a_nan_is_an_error() {
        let errors = polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [f64::NAN, 1.0, 0.0]]).validate().unwrap_err();
        assert!(errors[0].message.contains("not finite"));
    }

    #[test]
    fn a_polygon_without_area_is_a_warning() {
        let valid = polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]).validate().unwrap();
        assert_eq!(valid.warnings[0].message, "polygon \"wall\" has no area");
    }

    #[test]
    fn a_large_light_that_intersects_itself_is_an_error() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mut scene = polygon(&corners.repeat(400));
        assert!(scene.clone().validate().is_ok());
        let name = scene.names.add("lamp");
        let kind = ModifierKind::Material(Material::Light { radiance: Rgb::WHITE });
        let lamp = scene.modifiers.add(Modifier { name, span: None, modifier: None, kind });
        scene.surfaces.items_mut()[0].modifier = Some(lamp);
        let errors = scene.validate().unwrap_err();
        assert!(
            errors[0].message.contains("light \"wall\" of 1200 vertices has an outline that intersects itself"),
            "{errors:?}"
        );
    }

    #[test]
    fn a_warped_polygon_is_a_warning() {
        let valid = polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.3], [0.0, 1.0, 0.0]]).validate().unwrap();
        assert_eq!(valid.warnings[0].message, "polygon \"wall\" is not planar");
    }

    #[test]
    fn a_tilted_plane_far_from_the_origin_is_planar() {
        let at = |u: f64, v: f64| [1e5 + u, -1e5 + v, 0.3 * u + 0.7 * v];
        let valid = polygon(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]).validate().unwrap();
        assert!(valid.warnings.is_empty(), "{:?}", valid.warnings);
    }

    #[test]
    fn a_source_of_mist_that_no_surface_is_called_is_a_warning() {
        let mut scene = polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let name = scene.names.add("fog");
        let sources = ["wall", "mirror>wall", "paint", "wall>paint"].map(str::to_owned).to_vec();
        let mist = Mist { extinction: Rgb([0.1; 3]), albedo: None, eccentricity: None, sources };
        let kind = ModifierKind::Material(Material::Mist(mist));
        scene.modifiers.add(Modifier { name, span: None, modifier: None, kind });
        let messages: Vec<String> =
            scene.validate().unwrap().warnings.into_iter().map(|warning| warning.message).collect();
        let expected = "mist \"fog\" names the source \"paint\", but no surface has this name";
        assert_eq!(messages, [expected, expected]);
    }

    #[test]
    fn energy_gain_is_a_warning() {
        let mut scene = Scene::default();
        let name = scene.names.add("bright");
        let glossy = Glossy { color: Rgb([1.2; 3]), specularity: 0.0, roughness: 0.0 };
        let kind = ModifierKind::Material(Material::Plastic(glossy));
        scene.modifiers.add(Modifier { name, span: None, modifier: None, kind });
        assert_eq!(scene.validate().unwrap().warnings.len(), 1);
    }
}
