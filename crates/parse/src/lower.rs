//! From scene text to the scene: names become handles, commands run, transforms are applied,
//! functions compiled.

mod bsdf_file;
mod data_file;
mod functions;
mod include;
mod log;
mod materials;
mod meshes;
mod modifiers;
mod numbering;
mod objects;
mod octrees;
mod options;
mod patterns;
mod pictures;
mod reader;
mod replacement;
mod surfaces;
mod texts;
mod volumes;

pub use numbering::Numbering;
pub use options::{Input, KeepPrimitives, Purpose, Read, ReadOptions, Tolerance, UnusedModifiers};
pub use replacement::BrdfReplacement;

use radsight_loader::Loader;

/// Reads scene files, in order, into one scene.
///
/// [`Read::diagnostics`] lists all mistakes of all files. After an error, the scene lacks the
/// primitives that the errors concern. The result depends on nothing but the inputs, the options
/// and the loader's files.
#[must_use]
pub fn read_scene(inputs: &[Input], loader: &dyn Loader, options: &ReadOptions) -> Read {
    let mut reader = reader::Reader::new(loader, options);
    reader.refuse_empty_files(inputs);
    for input in inputs {
        reader.read_input(input);
    }
    reader.finish()
}
