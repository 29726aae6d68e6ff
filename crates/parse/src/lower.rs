//! From scene text to the scene: names become handles, commands run, transforms are applied, functions compiled.

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
/// All the mistakes of all the files are in [`Read::diagnostics`]; if there is an error among them, the scene lacks what
/// the errors are about. The result does not depend on anything but the inputs, the options and what the loader gives.
#[must_use]
pub fn read_scene(inputs: &[Input], loader: &dyn Loader, options: &ReadOptions) -> Read {
    let mut reader = reader::Reader::new(loader, options);
    for input in inputs {
        reader.read_input(input);
    }
    reader.refuse_empty_files(inputs);
    reader.finish()
}
