//! Poses of scene parts.

use glam::DVec3;
use radsight_capture::Region;
use radsight_diag::{Diagnostic, hint_nearest};
use radsight_ir::{Arena, Material, Modifier, ModifierKind, Pattern, Scene, Shape, Surface, SurfaceHandle, Transform};
use radsight_parse::surface_bounds;
use std::collections::BTreeSet;

/// A part, selected by the names of its surfaces, and its rigid motion from its pose in the scene.
///
/// ```
/// use radsight::PartMove;
/// let moved = PartMove::new("washer_*", "-rz 30 -t .01 0 0").unwrap();
/// assert!(moved.is_of("washer_top") && !moved.is_of("washer"));
/// let error = PartMove::new("washer_*", "-rz 30 -t .01 0").unwrap_err();
/// assert_eq!(error, "missing z of -t");
/// assert!(PartMove::new("washer_*", "-s 2").unwrap_err().contains("rigid"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PartMove {
    /// The name of a surface, or a prefix followed by `*`.
    surfaces: String,
    /// A rotation and a translation.
    transform: Transform,
}

/// Tolerance for the orthonormality of the rotation and for a scale of 1.
const RIGID: f64 = 1e-12;

impl PartMove {
    /// Moves the surfaces with this name (with `*` at its end: this prefix) by `xform` options:
    /// `-t`, `-rx`, `-ry`, `-rz`, `-i`. Angles are in degrees, lengths in scene units.
    ///
    /// ```
    /// assert!(radsight::PartMove::new("washer", "-rz 30 -t .01 0 0").is_ok());
    /// ```
    ///
    /// # Errors
    /// A description of the mistake, including transforms that are not rigid.
    pub fn new(surfaces: &str, words: &str) -> Result<PartMove, String> {
        let words: Vec<&str> = words.split_whitespace().collect();
        let transform = radsight_parse::transform(&words).map_err(|(_, mistake)| mistake)?;
        if (transform.scale - 1.0).abs() > RIGID || transform.is_mirror_image() {
            return Err("the transform is not rigid, expected only -t -rx -ry -rz".to_owned());
        }
        Ok(PartMove { surfaces: surfaces.to_owned(), transform })
    }

    /// Moves the surfaces with this name or prefix by a rigid motion.
    pub(crate) fn rigid(surfaces: &str, transform: Transform) -> PartMove {
        PartMove { surfaces: surfaces.to_owned(), transform }
    }

    /// The name of its surfaces, with `*` at its end for a prefix.
    pub(crate) fn surfaces(&self) -> &str {
        &self.surfaces
    }

    /// Whether this surface belongs to the part.
    ///
    /// ```
    /// let moved = radsight::PartMove::new("washer_*", "-rz 30").unwrap();
    /// assert!(moved.is_of("washer_top") && !moved.is_of("sheet"));
    /// ```
    #[must_use]
    pub fn is_of(&self, surface: &str) -> bool {
        match self.surfaces.strip_suffix('*') {
            Some(start) => surface.starts_with(start),
            None => surface == self.surfaces,
        }
    }
}

/// The surfaces that any of the moves selects, in scene order.
pub(crate) fn moved_surfaces<'m>(
    scene: &Scene,
    moves: impl IntoIterator<Item = &'m PartMove>,
) -> Result<Vec<SurfaceHandle>, Diagnostic> {
    let mut moved = Vec::new();
    for part in moves {
        let before = moved.len();
        moved.extend(scene.surfaces.iter().map(|(handle, _)| handle).filter(|&at| part.is_of(scene.surface_name(at))));
        if moved.len() == before {
            let names = scene.surfaces.iter().map(|(handle, _)| scene.surface_name(handle));
            let message = format!("the scene has no surface \"{}\" that could be moved", part.surfaces);
            return Err(Diagnostic::error(message).maybe_hint(hint_nearest(&part.surfaces, names)));
        }
    }
    moved.sort_unstable();
    moved.dedup();
    Ok(moved)
}

/// Moves the parts of a scene.
pub(crate) fn move_parts(scene: &mut Scene, moves: &[PartMove]) -> Result<(), Diagnostic> {
    for part in moves.iter().filter(|part| part.transform != Transform::IDENTITY) {
        for handle in moved_surfaces(scene, [part])? {
            let surface = scene.surfaces[handle].clone();
            if let Some(modifier) = placed_modifier(scene, &surface) {
                let message = format!(
                    "\"{}\" cannot be moved: its modifier \"{}\" depends on the position",
                    scene.surface_name(handle),
                    scene.names.get(modifier.name)
                );
                let hint = "move it by xform in the scene itself";
                let error = Diagnostic::error(message).hint(hint);
                return Err(match surface.span {
                    Some(span) => error.at(span),
                    None => error,
                });
            }
            move_surface(scene, surface.shape, &part.transform);
        }
    }
    Ok(())
}

/// The modifier of a surface that depends on position, if any.
fn placed_modifier<'s>(scene: &'s Scene, surface: &Surface) -> Option<&'s Modifier> {
    let is_placed = |modifier: &Modifier| {
        modifier.kind.function_call().is_some()
            || matches!(
                modifier.kind,
                ModifierKind::Pattern(Pattern::Text(_))
                    | ModifierKind::Mixture(_)
                    | ModifierKind::Material(Material::Spotlight { .. } | Material::Mist(_))
            )
    };
    modifiers(scene, surface).into_iter().find(|modifier| is_placed(modifier))
}

/// All modifiers of a surface, including those of a mesh's triangles.
fn modifiers<'s>(scene: &'s Scene, surface: &Surface) -> Vec<&'s Modifier> {
    let mut first = BTreeSet::from([surface.modifier]);
    if let Shape::Mesh(handle) = surface.shape {
        let mesh = &scene.meshes[scene.mesh_instances[handle].mesh];
        first.extend(mesh.triangles.iter().map(|triangle| triangle.modifier));
    }
    first.into_iter().flat_map(|first| scene.chain(first)).map(|(_, modifier)| modifier).collect()
}

fn move_surface(scene: &mut Scene, shape: Shape, to: &Transform) {
    let point = |point: &mut DVec3| *point = to.point(*point);
    match shape {
        Shape::Polygon { start, count } => {
            let vertices = start as usize..start as usize + count as usize;
            scene.vertices.get_mut(vertices).into_iter().flatten().for_each(point);
        }
        Shape::Sphere(handle) => point(&mut scene.spheres.items_mut()[handle.index()].center),
        Shape::Cone(handle) => {
            let cone = &mut scene.cones.items_mut()[handle.index()];
            point(&mut cone.base);
            point(&mut cone.apex);
        }
        Shape::Ring(handle) => {
            let ring = &mut scene.rings.items_mut()[handle.index()];
            point(&mut ring.center);
            ring.normal = to.direction(ring.normal).normalize();
        }
        Shape::Source(handle) => {
            let source = &mut scene.sources.items_mut()[handle.index()];
            source.direction = to.direction(source.direction).normalize();
        }
        Shape::Mesh(handle) => {
            let placed = &mut scene.mesh_instances.items_mut()[handle.index()];
            placed.to_scene = placed.to_scene.then(to);
        }
        Shape::Instance(handle) => {
            let placed = &mut scene.instances.items_mut()[handle.index()];
            placed.to_scene = placed.to_scene.then(to);
        }
    }
}

/// The bounding box of each surface with a margin for rounding; `None` if one is unbounded.
pub(crate) fn regions(scene: &Scene, surfaces: &[SurfaceHandle]) -> Option<Vec<Region>> {
    let region = |handle: &SurfaceHandle| {
        let bounds = surface_bounds(scene, &scene.surfaces[*handle])?;
        Some(Region { low: bounds.low, high: bounds.high }.grown(MARGIN * (bounds.high - bounds.low).max_element()))
    };
    surfaces.iter().map(region).collect()
}

/// Margin of a bounding box, relative to its size.
const MARGIN: f64 = 1e-3;

/// Whether parts change the light only of rays that meet them or their virtual sources: they emit
/// nothing, contain no medium, subtract nothing, and have no contents that are not inspected.
pub(crate) fn change_only_what_meets_them(scene: &Scene, surfaces: &[SurfaceHandle]) -> bool {
    surfaces.iter().all(|handle| {
        let surface = &scene.surfaces[*handle];
        let is_plain = |modifier: &Modifier| match &modifier.kind {
            ModifierKind::Material(material) => !matches!(
                material,
                Material::Light { .. }
                    | Material::Illum { .. }
                    | Material::Glow { .. }
                    | Material::Spotlight { .. }
                    | Material::Mist(_)
                    | Material::Antimatter { .. }
            ),
            ModifierKind::Mixture(_) => false,
            ModifierKind::Texture(_) | ModifierKind::Pattern(_) => true,
        };
        !matches!(surface.shape, Shape::Source(_) | Shape::Instance(_))
            && modifiers(scene, surface).into_iter().all(is_plain)
    })
}

/// The scene without some of its surfaces.
pub(crate) fn without(scene: &Scene, surfaces: &[SurfaceHandle]) -> Scene {
    let mut left = Arena::default();
    for (handle, surface) in scene.surfaces.iter() {
        if surfaces.binary_search(&handle).is_err() {
            left.add(surface.clone());
        }
    }
    Scene { surfaces: left, ..scene.clone() }
}
