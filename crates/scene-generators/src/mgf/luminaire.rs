//! Luminaires of MGF (`ies`), which are converted by `ies2rad`.

use std::fmt::Write;

use radsight_loader::FileKind;

use super::{Converter, Placement};
use crate::Error;

/// Converted luminaires.
#[derive(Default)]
pub(crate) struct Luminaires {
    /// Their files, by name.
    pub(crate) files: Vec<(String, Vec<u8>)>,
    /// Name and multiplier of each luminaire; empty without a multiplier.
    made: Vec<(String, String)>,
}

impl Converter<'_> {
    /// Executes `ies file [-m multiplier] [transform …]`: writes the command that transforms the
    /// converted luminaire. As in Radiance, its files stand in the current folder under the name of
    /// the luminaire, and are made unless they exist. If they have another multiplier, it is part of
    /// the name: Radiance would write a command with the modifier of this name.
    pub(super) fn luminaire(&mut self, words: &[String]) -> Result<Result<(), String>, Error> {
        let [_, source, rest @ ..] = words else { return Ok(Err("a luminaire needs a file".to_owned())) };
        let (multiplier, transform) = match rest {
            [option, multiplier, transform @ ..] if option == "-m" => (multiplier.as_str(), transform),
            _ => ("", rest),
        };
        if !multiplier.is_empty()
            && let Err(mistake) = super::number(multiplier)
        {
            return Ok(Err(mistake));
        }
        let Some(luminaires) = &self.luminaires else {
            self.warnings.push(format!("luminaire {source} is left out"));
            return Ok(Ok(()));
        };
        let stem = stem_of(source);
        let of_stem = luminaires.made.iter().find(|(name, _)| name == stem).map(|(_, made)| made.as_str());
        let is_free = of_stem.is_none() && !self.exists(stem);
        let name = match multiplier.is_empty() || is_free || of_stem == Some(multiplier) {
            // Without a multiplier, a file from before the run is taken as it is.
            true if multiplier.is_empty() && of_stem.is_some_and(|made| !made.is_empty()) => format!("{stem}_m1"),
            true => stem.to_owned(),
            false => format!("{stem}_m{multiplier}"),
        };
        if !luminaires.made.iter().any(|(made, _)| *made == name) {
            if !self.exists(&name) {
                self.convert_luminaire(source, multiplier, &name)?;
            }
            self.luminaires.get_or_insert_default().made.push((name.clone(), multiplier.to_owned()));
        }
        self.write_transform(&format!("{name}.rad"), transform)?;
        Ok(Ok(()))
    }

    /// Whether a luminaire was converted before.
    fn exists(&self, name: &str) -> bool {
        let file = format!("{name}.rad");
        self.loader.written(&file).is_some() || self.loader.load(&format!("./{file}"), FileKind::Other).is_ok()
    }

    fn convert_luminaire(&mut self, source: &str, multiplier: &str, name: &str) -> Result<(), Error> {
        let mut argv = vec!["ies2rad"];
        if !multiplier.is_empty() {
            argv.extend(["-m", multiplier]);
        }
        if name != stem_of(source) {
            argv.extend(["-o", name]);
        }
        let path = self.beside_source(source);
        argv.push(&path);
        let argv: Vec<String> = argv.into_iter().map(str::to_owned).collect();
        let output = crate::run(&argv, &Vec::new(), self.loader)?;
        self.warnings.extend(output.warnings);
        self.luminaires.get_or_insert_default().files.extend(output.files);
        Ok(())
    }

    fn write_transform(&mut self, file: &str, arguments: &[String]) -> Result<(), Error> {
        write!(self.text, "\n!xform")?;
        let object = self.object_prefix();
        if let Some(name) = object.strip_suffix('.') {
            write!(self.text, " -n {name}")?;
        }
        for word in arguments {
            write!(self.text, " {word}")?;
        }
        if !arguments.is_empty() && !self.placements.is_empty() {
            write!(self.text, " -i 1")?;
        }
        for word in self.placements.iter().rev().flat_map(|Placement { arguments, .. }| arguments) {
            write!(self.text, " {word}")?;
        }
        Ok(writeln!(self.text, " {file}")?)
    }
}

/// The name of a file without its folder and the last part after a dot.
fn stem_of(path: &str) -> &str {
    let name = path.rsplit('/').next().unwrap_or(path);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}
