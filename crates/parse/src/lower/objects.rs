//! Writes the primitives of compiled files as scene text, so that mistakes in them are reported
//! like any other.

use crate::write::Quoted;
use radsight_formats::Object;
use std::fmt::Write;

/// One item of scene text per object. A name refers to the object of that name read last, as in any
/// scene text.
pub(super) fn scene_text(objects: &[Object<'_>]) -> String {
    let mut text = String::new();
    for object in objects {
        let lossy = |bytes| String::from_utf8_lossy(bytes).into_owned();
        let parent = object.modifier.map_or("void".to_owned(), |index| lossy(&objects[index].name));
        let (kind, name) = (lossy(&object.kind), lossy(&object.name));
        let _ = match (&*kind, object.strings.first()) {
            ("alias", Some(target)) => {
                writeln!(text, "{} alias {} {}", Quoted(&parent), Quoted(&name), Quoted(&lossy(target)))
            }
            ("alias", None) => writeln!(text, "inherit alias {} {}", Quoted(&name), Quoted(&parent)),
            _ => write_primitive(&mut text, object, [&parent, &kind, &name]),
        };
    }
    text
}

fn write_primitive(text: &mut String, object: &Object<'_>, words: [&str; 3]) -> std::fmt::Result {
    let [parent, kind, name] = words.map(Quoted);
    writeln!(text, "{parent} {kind} {name}")?;
    write!(text, "{}", object.strings.len())?;
    for string in &object.strings {
        write!(text, " {}", Quoted(&String::from_utf8_lossy(string)))?;
    }
    write!(text, "\n0\n{}", object.reals.len())?;
    let mut digits = zmij::Buffer::new();
    for value in &object.reals {
        text.push(' ');
        text.push_str(digits.format(*value));
    }
    text.push('\n');
    Ok(())
}
