//! Parts of a scene in other places.

use glam::DVec3;
use radsight_capture::Region;
use radsight_diag::{Diagnostic, hint_nearest};
use radsight_ir::{Arena, Material, Modifier, ModifierKind, Pattern, Scene, Shape, Surface, SurfaceHandle, Transform};
use radsight_parse::surface_bounds;
use std::collections::BTreeSet;

/// A part, by the names of its surfaces, and where it goes from its place in the scene.
///
/// ```
/// use radsight::PartMove;
/// let moved = PartMove::new("washer_*", "-rz 30 -t .01 0 0").unwrap();
/// assert!(moved.is_of("washer_top") && !moved.is_of("washer"));
/// let error = PartMove::new("washer_*", "-rz 30 -t .01 0").unwrap_err();
/// assert_eq!(error, "missing z of -t");
/// assert!(PartMove::new("washer_*", "-s 2").unwrap_err().contains("keeps its size"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PartMove {
    /// The whole name of a surface, or with `*` at its end how names begin.
    surfaces: String,
    /// A turn and a shift.
    transform: Transform,
}

/// How far a rotation's columns may be from unit length and its scale from 1.
const RIGID: f64 = 1e-12;

impl PartMove {
    /// Moves the surfaces of this name (with `*` at its end: those whose names begin so) as words of `xform` say: `-t`, `-rx`, `-ry`, `-rz`,
    /// `-i`. Angles are degrees, lengths scene units.
    ///
    /// # Errors
    /// What is wrong with the words, or that they change more than a place.
    pub fn new(surfaces: &str, words: &str) -> Result<PartMove, String> {
        let words: Vec<&str> = words.split_whitespace().collect();
        let transform = radsight_parse::transform(&words).map_err(|(_, mistake)| mistake)?;
        if (transform.scale - 1.0).abs() > RIGID || transform.is_mirror_image() {
            return Err("a part keeps its size and its hands, expected -t -rx -ry -rz".to_owned());
        }
        Ok(PartMove { surfaces: surfaces.to_owned(), transform })
    }

    /// Whether the part has a surface of this name.
    #[must_use]
    pub fn is_of(&self, surface: &str) -> bool {
        match self.surfaces.strip_suffix('*') {
            Some(start) => surface.starts_with(start),
            None => surface == self.surfaces,
        }
    }
}

/// The surfaces that some of the moves are of, in the order of the scene.
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
                    "\"{}\" cannot be moved: its modifier \"{}\" is different from place to place",
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

/// What of a surface's modifiers would have to move with it.
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

/// All that modifies a surface, and the triangles of a mesh.
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

/// The box around each of these surfaces, with a margin for rounding; `None` where one has no place.
pub(crate) fn regions(scene: &Scene, surfaces: &[SurfaceHandle]) -> Option<Vec<Region>> {
    let region = |handle: &SurfaceHandle| {
        let bounds = surface_bounds(scene, &scene.surfaces[*handle])?;
        Some(Region { low: bounds.low, high: bounds.high }.grown(MARGIN * (bounds.high - bounds.low).max_element()))
    };
    surfaces.iter().map(region).collect()
}

/// Margin around a surface's box, as a share of its size.
const MARGIN: f64 = 1e-3;

/// Whether parts change light only where a ray meets them or their mirror images of lights: they neither shine, nor fill space, nor cut away,
/// nor hold what is not looked into.
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
