//! The numbers that Radiance assigns to primitives, and the primitives themselves for a frozen
//! octree.

use super::reader::{Here, Reader};
use crate::Kind;
use crate::syntax::{Alias, Primitive};
use crate::transform_words;
use radsight_formats::Object;
use std::collections::HashMap;

/// The numbers of primitives: in the order of the texts, from 0, including modifiers, aliases and
/// the output of commands.
#[derive(Clone, Debug, Default)]
pub struct Numbering {
    /// Number of primitives.
    pub count: usize,
    /// The number of each surface of the scene.
    pub of_surfaces: Vec<u32>,
    /// The primitives after placement, if [`super::KeepPrimitives::Yes`] requests them.
    pub primitives: Vec<Object<'static>>,
}

/// The numbering state while a text is read.
#[derive(Default)]
pub(super) struct Numberer {
    pub(super) numbering: Numbering,
    /// The numbers of modifiers by name, if primitives are kept.
    pub(super) modifiers: Option<HashMap<Vec<u8>, usize>>,
}

impl Numberer {
    fn keep_modifier(&mut self, object: Object<'static>) {
        if let Some(modifiers) = &mut self.modifiers {
            modifiers.insert(object.name.to_vec(), self.numbering.primitives.len());
        }
        self.keep(object);
    }

    fn keep(&mut self, object: Object<'static>) {
        if self.modifiers.is_some() {
            self.numbering.primitives.push(object);
        }
    }

    fn modifier(&self, name: &[u8]) -> Option<usize> {
        self.modifiers.as_ref().and_then(|modifiers| modifiers.get(name)).copied()
    }

    /// Assigns the number of the last primitive to the next surface of the scene.
    pub(super) fn note_surface(&mut self) {
        self.numbering.of_surfaces.push(self.numbering.count.saturating_sub(1) as u32);
    }
}

impl Reader<'_> {
    pub(super) fn number_primitive(&mut self, primitive: &Primitive<'_>, here: Here<'_>) {
        self.numberer.numbering.count += 1;
        if self.numberer.modifiers.is_none() {
            return;
        }
        let placement = &here.context.placement;
        let kind = placement.kind(primitive.kind);
        let (name, modifier) = (primitive.text(primitive.name), primitive.text(primitive.modifier));
        let is_modifier = kind.is_modifier();
        let (name, modifier) = if is_modifier {
            (name.into_owned(), self.numberer.modifier(&modifier))
        } else {
            let prefix = placement.prefix.as_bytes();
            let dot = if prefix.is_empty() { &b""[..] } else { b"." };
            let new = placement.modifier.as_ref().map(|new| new.name.as_bytes());
            ([prefix, dot, &name].concat(), self.numberer.modifier(new.unwrap_or(&modifier)))
        };
        let mut strings: Vec<Vec<u8>> =
            primitive.strings.iter().map(|word| primitive.text(*word).into_owned()).collect();
        if kind == Kind::Mist {
            for string in &mut strings {
                *string = placement.mist_source(&String::from_utf8_lossy(string)).into_bytes();
            }
        }
        if kind.takes_transform_words() {
            strings.extend(transform_words::write(&placement.transform).into_iter().map(String::into_bytes));
        }
        let mut reals = Vec::new();
        placement.reals(primitive.kind, primitive.reals, &mut reals);
        let kind = kind.name().as_bytes();
        let strings = strings.into_iter().map(Into::into).collect();
        let object = Object { kind: kind.into(), modifier, name: name.into(), strings, reals };
        if is_modifier {
            self.numberer.keep_modifier(object);
        } else {
            self.numberer.keep(object);
        }
    }

    /// Numbers an alias. An alias whose modifier equals its target's has the target as modifier;
    /// others hold its name as a string argument.
    pub(super) fn number_alias(&mut self, alias: &Alias<'_>) {
        self.numberer.numbering.count += 1;
        if self.numberer.modifiers.is_none() {
            return;
        }
        let (target, modifier) = (alias.text(alias.target), alias.text(alias.modifier));
        let primitives = &self.numberer.numbering.primitives;
        let mut found = self.numberer.modifier(&target);
        while let Some(Object { modifier: Some(next), .. }) = found
            .map(|index| &primitives[index])
            .filter(|object| *object.kind == *b"alias" && object.strings.is_empty())
        {
            found = Some(*next);
        }
        let own = self.numberer.modifier(&modifier);
        let is_target = *modifier == *b"inherit" || found.is_some_and(|index| primitives[index].modifier == own);
        let (modifier, strings) = if is_target { (found, Vec::new()) } else { (own, vec![target.into_owned().into()]) };
        let name = alias.text(alias.name).into_owned().into();
        let kind = b"alias"[..].into();
        self.numberer.keep_modifier(Object { kind, modifier, name, strings, reals: Vec::new() });
    }
}
