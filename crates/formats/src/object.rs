//! The primitives inside frozen octrees and meshes.

use crate::FormatError;
use crate::portable::{Reader, push_float, push_integer, push_string};
use std::borrow::Cow;

/// The types of Radiance 6, in its order. Each file has its own list.
const TYPES: [&str; 59] = [
    "polygon",
    "cone",
    "sphere",
    "texfunc",
    "ring",
    "cylinder",
    "instance",
    "cup",
    "bubble",
    "tube",
    "mesh",
    "alias",
    "plastic",
    "metal",
    "glass",
    "trans",
    "dielectric",
    "plastic2",
    "metal2",
    "trans2",
    "interface",
    "plasfunc",
    "metfunc",
    "brightfunc",
    "brightdata",
    "brighttext",
    "colorpict",
    "glow",
    "source",
    "light",
    "illum",
    "spotlight",
    "mist",
    "mirror",
    "transfunc",
    "BRTDfunc",
    "BSDF",
    "aBSDF",
    "WGMDfunc",
    "plasdata",
    "metdata",
    "transdata",
    "colorfunc",
    "antimatter",
    "colordata",
    "colortext",
    "texdata",
    "mixfunc",
    "mixdata",
    "mixtext",
    "mixpict",
    "prism1",
    "prism2",
    "ashik2",
    "spectrum",
    "specfile",
    "specfunc",
    "specdata",
    "specpict",
];

/// Largest number of arguments of one kind that real Radiance can read.
const MOST_ARGUMENTS: usize = 0x7fff;

/// A primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct Object<'a> {
    /// The name of its type, as scene text has it.
    pub kind: Cow<'a, [u8]>,
    /// The index of the primitive that modifies it, from 0; `None` for `void`.
    pub modifier: Option<usize>,
    /// Its identifier.
    pub name: Cow<'a, [u8]>,
    /// String arguments. An `alias` has its target here, or none if its target is its modifier.
    pub strings: Vec<Cow<'a, [u8]>>,
    /// Real arguments, to about nine digits.
    pub reals: Vec<f64>,
}

/// Reads a list of types and the objects after it, up to the end mark.
pub(crate) fn read_objects<'a>(reader: &mut Reader<'a>, size: usize) -> Result<Vec<Object<'a>>, FormatError> {
    let mut types = Vec::new();
    loop {
        match reader.string("the name of a type")? {
            b"" => break,
            name => types.push(name),
        }
    }
    let mut objects = Vec::new();
    loop {
        let offset = reader.offset();
        let index = reader.integer(1, "the type of an object")?;
        if index == -1 {
            return Ok(objects);
        }
        let Some(kind) = usize::try_from(index).ok().and_then(|index| types.get(index)) else {
            return Err(reader.unexpected(offset, format!("one of the {} types of the file", types.len()), index));
        };
        objects.push(read_object(reader, size, kind, objects.len())?);
    }
}

fn read_object<'a>(
    reader: &mut Reader<'a>,
    size: usize,
    kind: &'a [u8],
    own_index: usize,
) -> Result<Object<'a>, FormatError> {
    let offset = reader.offset();
    let modifier = match reader.integer(size, "the modifier of an object")? {
        -1 => None,
        index => match usize::try_from(index).ok().filter(|index| *index < own_index) {
            Some(index) => Some(index),
            None => return Err(reader.unexpected(offset, "a modifier defined before its object", index)),
        },
    };
    let name = reader.string("the name of an object")?.into();
    let count = reader.count("the number of string arguments")?;
    let mut strings = Vec::with_capacity(count);
    for _ in 0..count {
        strings.push(reader.string("a string argument")?.into());
    }
    let count = reader.count("the number of real arguments")?;
    let mut reals = Vec::with_capacity(count);
    for _ in 0..count {
        reals.push(reader.float("a real argument")?);
    }
    Ok(Object { kind: kind.into(), modifier, name, strings, reals })
}

/// Writes the list of types, the objects and the end mark.
pub(crate) fn write_objects(out: &mut Vec<u8>, objects: &[Object<'_>], size: usize) -> Result<(), FormatError> {
    let mut types: Vec<&[u8]> = TYPES.iter().map(|name| name.as_bytes()).collect();
    for object in objects {
        if !types.contains(&&*object.kind) {
            types.push(&object.kind);
        }
    }
    types.iter().for_each(|name| push_string(out, name));
    push_string(out, b"");
    for object in objects {
        let index = types.iter().position(|name| **name == *object.kind).unwrap_or_default();
        push_integer(out, index as i64, 1);
        push_integer(out, object.modifier.map_or(-1, |index| index as i64), size);
        push_string(out, &object.name);
        push_count(out, object, "string", object.strings.len())?;
        object.strings.iter().for_each(|string| push_string(out, string));
        push_count(out, object, "real", object.reals.len())?;
        object.reals.iter().for_each(|value| push_float(out, *value));
    }
    push_integer(out, -1, 1);
    Ok(())
}

fn push_count(out: &mut Vec<u8>, object: &Object<'_>, group: &str, found: usize) -> Result<(), FormatError> {
    if found > MOST_ARGUMENTS {
        let [kind, name] = [&object.kind, &object.name].map(|text| String::from_utf8_lossy(text));
        let what = format!("the number of {group} arguments of {kind} \"{name}\"");
        return Err(FormatError::TooMany { what, found, most: MOST_ARGUMENTS });
    }
    push_integer(out, found as i64, 2);
    Ok(())
}
