//! `mgf2rad [-s] [-m matf] [-g dist] [-e mult] [file …]`: converts Materials and Geometry Format to
//! Radiance text.
//!
//! Luminaires (`ies`) become files `LUM.rad` in the current folder, made by `ies2rad` unless they
//! exist, and commands that transform them. `-s` writes spectra, `-m` appends the materials to a file of their own, `-g` makes emitters
//! `glow` with a radius of influence in metres, `-e` multiplies their radiance.

use std::fmt::Write;

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::mgf::{Converter, Luminaires, MaterialWriter};
use crate::text::Text;
use crate::{Error, Invocation, Output};

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut materials = MaterialWriter::default();
    let mut material_file = None;
    while let Some(option) = arguments.option()? {
        match option.name {
            "-s" => materials.spectral = !materials.spectral,
            "-m" => material_file = Some(arguments.required("a file of materials (-m)")?),
            "-g" => materials.glow_distance = Some(arguments.number("glow distance (-g)")?),
            "-e" => materials.emitter_multiplier = arguments.number("emitter multiplier (-e)")?,
            _ => return Err(arguments.unknown()),
        }
    }
    let mut text = Text::default();
    writeln!(text, "## Translated from MGF Version 2.0")?;
    let options = invocation.argv[..arguments.position()].join(" ");
    writeln!(text, "## {options}")?;
    let mut converter = Converter::new(invocation.loader, materials, text);
    converter.material_text = material_file.map(|_| Text::default());
    converter.luminaires = Some(Luminaires::default());
    if arguments.rest().is_empty() {
        converter.convert("standard input", invocation.standard_input()?)?;
    }
    for name in arguments.rest() {
        writeln!(converter.text, "## mgf2rad {name} ##############################")?;
        converter.convert(name, &invocation.loader.load(name, FileKind::Input)?.bytes)?;
        let unknown = std::mem::take(&mut converter.unknown);
        if unknown > 0 {
            writeln!(converter.text, "## mgf2rad {name}: {unknown} unknown entities")?;
        }
    }
    arguments.warnings.extend(converter.warnings);
    let materials = material_file.zip(converter.material_text).map(|(file, text)| {
        let mut bytes = invocation.loader.written(file).unwrap_or_default();
        bytes.extend(text.into_bytes());
        (file.to_owned(), bytes)
    });
    let mut files = converter.luminaires.map(|made| made.files).unwrap_or_default();
    files.extend(materials);
    let extended = material_file.map(str::to_owned);
    Ok(Output { standard_output: converter.text.into_bytes(), warnings: arguments.warnings, files, extended })
}
