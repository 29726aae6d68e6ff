//! Writes a scene as text that Radiance reads.
//!
//! Comments and commands are lost (the output of commands is written), as are skipped modifiers and
//! aliases (the copy under the alias's name is written). Modifiers that share a name get unique
//! names. Plugins are written as `brdfplugin`, which only radsight reads.

mod modifiers;
mod surfaces;

use crate::syntax::is_space;
use crate::transform_words;
use radsight_ir::{ModifierHandle, Scene, Transform};
use std::collections::{HashMap, HashSet};
use std::fmt::{self, Display, Formatter, Write};

/// Writes a whole scene.
///
/// # Errors
/// When `out` takes no more.
///
/// ```
/// use radsight_parse::{Input, ReadOptions, read_scene, write_scene};
/// let text = b"void plastic red 0 0 5 .5 0 0 0 0 red cone c 0 0 8 0 0 0 0 0 1 .5 .5";
/// let input = Input::Text { name: "scene.rad".to_owned(), text: text[..].into() };
/// let scene = read_scene(&[input], &radsight_loader::MemoryLoader::default(), &ReadOptions::default()).scene;
/// let mut written = String::new();
/// write_scene(&scene, &mut written).unwrap();
/// assert_eq!(written, "void plastic red\n0\n0\n5 0.5 0 0 0 0\n\nred cylinder c\n0\n0\n7 0 0 0 0 0 1 0.5\n\n");
/// ```
pub fn write_scene(scene: &Scene, out: &mut dyn Write) -> fmt::Result {
    let mut writer = Writer { scene, out, names: unique_names(scene) };
    for (handle, _) in scene.modifiers.iter() {
        writer.modifier(handle)?;
    }
    for surface in scene.surfaces.items() {
        writer.surface(surface)?;
    }
    Ok(())
}

struct Writer<'a> {
    scene: &'a Scene,
    out: &'a mut dyn Write,
    /// Unique names, by modifier index.
    names: Vec<String>,
}

/// String and real arguments. There are never integer arguments.
#[derive(Default)]
struct Arguments {
    strings: Vec<String>,
    reals: Vec<f64>,
}

impl Arguments {
    fn of_reals(reals: impl IntoIterator<Item = f64>) -> Self {
        Arguments { strings: Vec::new(), reals: reals.into_iter().collect() }
    }

    fn with_transform(mut self, to_scene: &Transform) -> Self {
        self.strings.extend(transform_words::write(to_scene));
        self
    }
}

impl Writer<'_> {
    fn name_of(&self, handle: Option<ModifierHandle>) -> &str {
        handle.map_or("void", |handle| &self.names[handle.index()])
    }

    fn primitive(
        &mut self,
        modifier: Option<ModifierHandle>,
        kind: &str,
        name: &str,
        arguments: &Arguments,
    ) -> fmt::Result {
        let modifier = modifier.map_or("void", |handle| &self.names[handle.index()]);
        writeln!(self.out, "{} {kind} {}", Quoted(modifier), Quoted(name))?;
        write!(self.out, "{}", arguments.strings.len())?;
        for word in &arguments.strings {
            write!(self.out, " {}", Quoted(word))?;
        }
        write!(self.out, "\n0\n{}", arguments.reals.len())?;
        for value in &arguments.reals {
            write!(self.out, " {}", Number(*value))?;
        }
        self.out.write_str("\n\n")
    }
}

/// A unique name for each modifier. The first modifier of a name keeps it.
fn unique_names(scene: &Scene) -> Vec<String> {
    let own: HashSet<&str> = scene.modifiers.items().iter().map(|modifier| scene.names.get(modifier.name)).collect();
    let mut taken: HashSet<String> = HashSet::new();
    let mut last_number: HashMap<String, u64> = HashMap::new();
    let mut names = Vec::with_capacity(scene.modifiers.len());
    for modifier in scene.modifiers.items() {
        let own_name = scene.names.get(modifier.name).replace('\t', " ");
        let is_good = !matches!(&*own_name, "" | "void" | "inherit") && !taken.contains(&own_name);
        let name = if is_good {
            own_name
        } else {
            // Numbers continue from the last one, so a name used a million times takes linear time.
            let number = last_number.entry(own_name.clone()).or_insert(1);
            loop {
                *number += 1;
                let candidate = format!("{own_name}.{number}");
                if !taken.contains(&candidate) && !own.contains(&*candidate) {
                    break candidate;
                }
            }
        };
        taken.insert(name.clone());
        names.push(name);
    }
    names
}

/// A word, quoted if necessary.
pub(crate) struct Quoted<'a>(pub(crate) &'a str);

impl Display for Quoted<'_> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let word = self.0;
        let has = |quote| word.contains(quote);
        let has_space = word.bytes().any(is_space);
        let is_mark = word.starts_with(['#', '!']);
        if !word.is_empty() && !has_space && !is_mark && !has('"') && !has('\'') {
            return formatter.write_str(word);
        }
        if !has('"') {
            return write!(formatter, "\"{word}\"");
        }
        if !has('\'') {
            return write!(formatter, "'{word}'");
        }
        // A word with both kinds of quote becomes adjacent parts, each in quotes of the other kind.
        for part in word.split_inclusive('"') {
            let (text, quote) = part.strip_suffix('"').map_or((part, ""), |text| (text, "'\"'"));
            if !text.is_empty() {
                write!(formatter, "\"{text}\"")?;
            }
            formatter.write_str(quote)?;
        }
        Ok(())
    }
}

/// The shortest form that parses back to the same number.
struct Number(f64);

impl Display for Number {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && !(1e-5..1e16).contains(&size) {
            write!(formatter, "{:e}", self.0)
        } else {
            write!(formatter, "{}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::words;
    use proptest::prelude::*;
    use radsight_ir::{Material, Modifier, ModifierKind, Rgb};

    #[test]
    fn modifiers_that_share_a_name_get_their_own() {
        let mut scene = Scene::default();
        for name in ["a", "a", "a.2", "a", "void", ""] {
            let name = scene.names.add(name);
            let kind = ModifierKind::Material(Material::Light { radiance: Rgb::WHITE });
            scene.modifiers.add(Modifier { name, span: None, modifier: None, kind });
        }
        assert_eq!(unique_names(&scene), ["a", "a.3", "a.2", "a.4", "void.2", ".2"]);
    }

    proptest! {
        #[test]
        fn a_quoted_word_reads_back(word in "[a-c\"' \n]{0,8}") {
            let text = Quoted(&word).to_string();
            let read: Vec<_> = words(text.as_bytes(), 0).collect();
            prop_assert_eq!(read.len(), 1);
            prop_assert_eq!(String::from_utf8(read[0].of(text.as_bytes()).into_owned()).unwrap(), word);
        }

        #[test]
        fn a_number_reads_back(value in any::<f64>().prop_filter("finite", |value| value.is_finite())) {
            prop_assert_eq!(crate::syntax::parse_real(Number(value).to_string().as_bytes()), Some(value));
        }
    }
}
