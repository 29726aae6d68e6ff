//! `obj2mesh`: compiles Wavefront text to a mesh for the `mesh` primitive.
//!
//! `obj2mesh [-n limit] [-r resolution] [-a material file] [-l library file] [-w] [-v] [file.obj
//! [file.rtm]]`: material files (`-a`, `-l`) become part of the mesh; triangles then have the
//! materials named by `usemtl`, else those of their groups. `-n` and `-r` are those of `oconv`.
//! `-v` prints statistics of the mesh.

use crate::commands::words::Words;
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, say};
use crate::input::{read, read_file, read_standard_input, use_default_threads};
use crate::output::write_file;
use crate::trust::Trust;
use glam::DVec3;
use radsight_formats::{Corner, Facet, MESH_FORMAT, MeshParts, Object};
use radsight_ir::{Cube, Scene, Shape, Surface};
use radsight_loader::{FileKind, Loader};
use radsight_octree::{BuildOptions, Built};
use radsight_parse::{Input, KeepPrimitives, Purpose, ReadOptions};
use radsight_picture::Header;
use radsight_scene_generators::WavefrontMesh;
use std::collections::HashMap;

/// Margin of the bounding cube, scene units; as in Radiance.
const CUBE_MARGIN: f64 = 1e-5;

/// Default number of triangles above which a cube is subdivided (`-n`).
const FEW: usize = 9;

/// The command line.
struct Request {
    build: BuildOptions,
    /// Files of materials, as scene text.
    materials: Vec<Input>,
    is_quiet: bool,
    tells: bool,
}

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let mut words = Words::new(words, trust);
    let request = Request::read(&mut words)?;
    let (source, output) = words.input_and_output()?;
    let bytes = if source == "-" { read_standard_input()? } else { read_file(source, "mesh")? };
    let wrong = |what: String| Failure::input(format!("obj2mesh: {source}: {what}"));
    let mesh = WavefrontMesh::read(&String::from_utf8_lossy(&bytes)).map_err(wrong)?;
    if mesh.triangles.is_empty() {
        return Err(wrong("no triangle with an area".to_owned()));
    }
    for (count, what) in [(mesh.unknown_statements, "unknown statements"), (mesh.degenerate, "triangles without area")]
    {
        if count > 0 {
            request.warn(&format!("{count} {what} are skipped"));
        }
    }
    let objects = request.objects()?;
    let facets = facets(&mesh, &materials(&mesh, &objects).map_err(wrong)?);
    let cube = cube(&mesh);
    let built = octree(&mesh, cube, &request.build)?;
    if let Some(warning) = built.warning("triangles") {
        request.warn(&warning);
    }
    let mut header = Header::new("RADIANCE");
    header.push_command(words.all().into_iter().filter(|word| output == "-" || *word != output));
    header.push_variable("FORMAT", MESH_FORMAT);
    let parts = MeshParts { header, origin: cube.origin.to_array(), size: cube.size, objects, facets };
    let written = parts.write(&built.tree).map_err(|error| Failure::input(format!("obj2mesh: {error}")))?;
    if request.tells {
        say(&format!(
            "{} triangles, {} materials, {} bytes\n",
            mesh.triangles.len(),
            mesh.materials.len(),
            written.len()
        ));
    }
    write_file(output, &written)
}

impl Request {
    fn read(words: &mut Words<'_>) -> Result<Request, Failure> {
        let build = BuildOptions { object_limit: FEW, ..BuildOptions::default() };
        let mut request = Request { build, materials: Vec::new(), is_quiet: false, tells: false };
        let loader = DiskLoader::new(Commands::Refused);
        while let Some(option) = words.option()? {
            match option {
                "-n" => request.build.object_limit = words.integer(option)?.max(1) as usize,
                "-r" => request.build.resolution = words.integer(option)?.clamp(1, i64::from(u32::MAX)) as u32,
                "-a" => {
                    let name = words.value(option, "a file of materials")?.to_owned();
                    let text = read_file(&name, "materials")?.into();
                    request.materials.push(Input::Text { name, text });
                }
                "-l" => {
                    let loaded = loader.load(words.value(option, "a file of materials")?, FileKind::Other);
                    let loaded = loaded.map_err(|error| Failure::input(format!("obj2mesh: {error}")))?;
                    request.materials.push(Input::Text { name: loaded.path, text: loaded.bytes.into() });
                }
                "-w" => request.is_quiet = true,
                "-v" => request.tells = true,
                _ => return Err(words.unknown(option)),
            }
        }
        Ok(request)
    }

    fn warn(&self, message: &str) {
        if !self.is_quiet {
            say(&format!("obj2mesh: warning - {message}\n"));
        }
    }

    /// The modifiers of all material files.
    fn objects(&self) -> Result<Vec<Object<'static>>, Failure> {
        let options =
            ReadOptions { primitives: KeepPrimitives::Yes, purpose: Purpose::Octree, ..ReadOptions::default() };
        let read = read(self.materials.clone(), Commands::Refused, &options);
        if read.has_errors() {
            return Err(Failure::diagnostics(&read.diagnostics, &read.sources));
        }
        if !read.numbering.of_surfaces.is_empty() {
            return Err(Failure::input("obj2mesh: a file of materials has surfaces, expected only materials"));
        }
        Ok(read.numbering.primitives)
    }
}

/// For each material of the mesh, the index of the last object with that name; `None` without
/// material files.
fn materials(mesh: &WavefrontMesh, objects: &[Object<'_>]) -> Result<Vec<Option<u32>>, String> {
    if objects.is_empty() {
        return Ok(vec![None; mesh.materials.len()]);
    }
    let known: HashMap<&[u8], u32> = objects.iter().map(|object| &*object.name).zip(0..).collect();
    let find = |name: &String| {
        let found = known.get(name.as_bytes()).copied();
        found.map(Some).ok_or_else(|| format!("undefined modifier \"{name}\", expected one of the files of -a and -l"))
    };
    mesh.materials.iter().map(find).collect()
}

fn facets(mesh: &WavefrontMesh, materials: &[Option<u32>]) -> Vec<Facet> {
    let facet = |triangle: &radsight_scene_generators::WavefrontTriangle| Facet {
        corners: std::array::from_fn(|corner| Corner {
            position: triangle.points[corner],
            normal: triangle.normals.map(|normals| normals[corner]),
            coordinates: triangle.textures.map(|textures| textures[corner]),
        }),
        material: triangle.material.and_then(|material| materials[material]),
    };
    mesh.triangles.iter().map(facet).collect()
}

fn points(mesh: &WavefrontMesh) -> impl Iterator<Item = DVec3> {
    mesh.triangles.iter().flat_map(|triangle| triangle.points.map(DVec3::from_array))
}

/// The bounding cube of the mesh.
fn cube(mesh: &WavefrontMesh) -> Cube {
    let low = points(mesh).fold(DVec3::INFINITY, DVec3::min);
    let high = points(mesh).fold(DVec3::NEG_INFINITY, DVec3::max);
    let size = (high - low).max_element() + 2.0 * CUBE_MARGIN;
    Cube { origin: 0.5 * (low + high - size), size }
}

fn octree(mesh: &WavefrontMesh, cube: Cube, options: &BuildOptions) -> Result<Built, Failure> {
    let mut scene = Scene { vertices: points(mesh).collect(), ..Scene::default() };
    let name = scene.names.add("triangle");
    for index in 0..mesh.triangles.len() as u32 {
        let shape = Shape::Polygon { start: 3 * index, count: 3 };
        scene.surfaces.add(Surface { name, span: None, modifier: None, shape });
    }
    let numbers: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    use_default_threads()?;
    Ok(radsight_octree::build(&scene, &numbers, cube, options))
}
