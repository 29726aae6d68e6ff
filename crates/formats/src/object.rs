//! The primitives inside frozen octrees and meshes.

use crate::FormatError;
use crate::portable::{FLOAT_SIZE, Reader, push_float, push_integer, push_string};
use std::borrow::Cow;
use std::ops::ControlFlow;

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

/// The primitives of a file that was checked, read one by one: all together they take several times
/// the memory of the file.
#[derive(Clone, Debug)]
pub struct PackedObjects<'a> {
    types: Vec<&'a [u8]>,
    /// At the first object.
    reader: Reader<'a>,
    index_size: usize,
    count: usize,
}

/// What an object begins with.
struct Head<'a> {
    kind: &'a [u8],
    modifier: Option<usize>,
    name: &'a [u8],
}

impl<'a> PackedObjects<'a> {
    /// Checks a list of types and the objects after it, up to the end mark.
    pub(crate) fn read(reader: &mut Reader<'a>, index_size: usize) -> Result<Self, FormatError> {
        let mut types = Vec::new();
        loop {
            match reader.string("the name of a type")? {
                b"" => break,
                name => types.push(name),
            }
        }
        let mut objects = PackedObjects { types, reader: reader.clone(), index_size, count: 0 };
        while objects.head(reader, objects.count)?.is_some() {
            skip_arguments(reader)?;
            objects.count += 1;
        }
        Ok(objects)
    }

    /// Number of objects.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are no objects.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Calls `visit` for each object, with the name of its modifier, until it breaks.
    pub fn for_each(&self, mut visit: impl FnMut(&Object<'a>, Option<&'a [u8]>) -> ControlFlow<()>) {
        let mut reader = self.reader.clone();
        let mut names: Vec<&[u8]> = Vec::with_capacity(self.count);
        let mut object = Object {
            kind: b""[..].into(),
            modifier: None,
            name: b""[..].into(),
            strings: Vec::new(),
            reals: Vec::new(),
        };
        // All of it was read before, without an error.
        while let Ok(Some(Head { kind, modifier, name })) = self.head(&mut reader, names.len()) {
            (object.kind, object.modifier, object.name) = (kind.into(), modifier, name.into());
            if read_arguments(&mut reader, &mut object).is_err()
                || visit(&object, modifier.map(|index| names[index])).is_break()
            {
                return;
            }
            names.push(name);
        }
    }

    /// All objects.
    #[must_use]
    pub fn to_vec(&self) -> Vec<Object<'a>> {
        let mut objects = Vec::with_capacity(self.count);
        self.for_each(|object, _| {
            objects.push(object.clone());
            ControlFlow::Continue(())
        });
        objects
    }

    /// The head of the object of this index; `None` at the end mark.
    fn head(&self, reader: &mut Reader<'a>, own_index: usize) -> Result<Option<Head<'a>>, FormatError> {
        let offset = reader.offset();
        let index = reader.integer(1, "the type of an object")?;
        if index == -1 {
            return Ok(None);
        }
        let types = &self.types;
        let Some(kind) = usize::try_from(index).ok().and_then(|index| types.get(index)) else {
            return Err(reader.unexpected(offset, format!("one of the {} types of the file", types.len()), index));
        };
        let offset = reader.offset();
        let modifier = match reader.integer(self.index_size, "the modifier of an object")? {
            -1 => None,
            index => match usize::try_from(index).ok().filter(|index| *index < own_index) {
                Some(index) => Some(index),
                None => return Err(reader.unexpected(offset, "a modifier defined before its object", index)),
            },
        };
        let name = reader.string("the name of an object")?;
        Ok(Some(Head { kind, modifier, name }))
    }
}

/// Reads a list of types and the objects after it, up to the end mark.
pub(crate) fn read_objects<'a>(reader: &mut Reader<'a>, index_size: usize) -> Result<Vec<Object<'a>>, FormatError> {
    PackedObjects::read(reader, index_size).map(|packed| packed.to_vec())
}

fn read_arguments<'a>(reader: &mut Reader<'a>, object: &mut Object<'a>) -> Result<(), FormatError> {
    object.strings.clear();
    for _ in 0..reader.count(STRING_COUNT)? {
        object.strings.push(reader.string(STRING)?.into());
    }
    object.reals.clear();
    for _ in 0..reader.count(REAL_COUNT)? {
        object.reals.push(reader.float(REAL)?);
    }
    Ok(())
}

/// Checks the arguments of an object.
fn skip_arguments(reader: &mut Reader<'_>) -> Result<(), FormatError> {
    for _ in 0..reader.count(STRING_COUNT)? {
        reader.string(STRING)?;
    }
    let count = reader.count(REAL_COUNT)?;
    reader.take(count * FLOAT_SIZE, REAL)?;
    Ok(())
}

/// What stands after the name of an object, for messages.
const STRING_COUNT: &str = "the number of string arguments";
const STRING: &str = "a string argument";
const REAL_COUNT: &str = "the number of real arguments";
const REAL: &str = "a real argument";

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

#[cfg(test)]
mod tests {
    use super::*;

    fn object(kind: &str, modifier: Option<usize>, name: &str, reals: &[f64]) -> Object<'static> {
        let bytes = |text: &str| text.as_bytes().to_vec().into();
        let strings = vec![bytes("a word"), bytes("")];
        Object { kind: bytes(kind), modifier, name: bytes(name), strings, reals: reals.to_vec() }
    }

    fn written() -> (Vec<Object<'static>>, Vec<u8>) {
        let objects = vec![
            object("plastic", None, "paint", &[0.5, 0.25, 0.125]),
            object("sphere", Some(0), "ball", &[1.0, 2.0, -3.0, 0.5]),
            object("light", None, "lamp", &[]),
            object("ring", Some(2), "disk", &[8.0]),
        ];
        let mut bytes = Vec::new();
        write_objects(&mut bytes, &objects, 4).unwrap();
        (objects, bytes)
    }

    fn packed(bytes: &[u8]) -> Result<PackedObjects<'_>, FormatError> {
        PackedObjects::read(&mut Reader::of(bytes), 4)
    }

    #[test]
    fn objects_are_read_one_by_one_with_the_names_of_their_modifiers() {
        let (objects, bytes) = written();
        let packed = packed(&bytes).unwrap();
        let mut visited = Vec::new();
        packed.for_each(|object, modifier| {
            visited.push((object.name.to_vec(), modifier.map(<[u8]>::to_vec)));
            if visited.len() == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let expected = [("paint", None), ("ball", Some("paint")), ("lamp", None)];
        let expected = expected.map(|(name, modifier)| (name.into(), modifier.map(|name| name.as_bytes().to_vec())));
        assert_eq!(visited, expected);
        assert_eq!((packed.len(), packed.is_empty()), (4, false));
        let near = |(read, written): (&Object<'_>, &Object<'_>)| {
            let close = read.reals.iter().zip(&written.reals).all(|(read, written)| (read - written).abs() < 1e-8);
            close && read.reals.len() == written.reals.len() && read.strings == written.strings
        };
        assert!(packed.to_vec().iter().zip(&objects).all(near));
    }

    #[test]
    fn objects_that_end_early_are_an_error_before_the_first_is_visited() {
        let (_, bytes) = written();
        for end in 0..bytes.len() {
            assert!(matches!(packed(&bytes[..end]), Err(FormatError::Truncated { .. })), "{end} bytes");
        }
    }
}
