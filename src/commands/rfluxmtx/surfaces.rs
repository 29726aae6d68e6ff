//! The groups of surfaces in the scene text of senders and receivers.

use super::options::Options;
use super::wrong;
use crate::failure::Failure;
use crate::input::expanded_scene_text;
use crate::trust::{Existing, Refusal, Trust};
use radsight_diag::{SourceMap, Span};
use radsight_flux::{FluxError, FluxSurface, Group, Parameters, Shape};
use radsight_parse::Kind;
use radsight_parse::syntax::{Item, Items, Primitive, SyntaxError};

/// Prefix of comments that set options of surfaces.
const MARK: &str = "#@rfluxmtx";

/// The receivers in file order: consecutive surfaces with one modifier form one receiver.
pub(super) fn receivers(options: &Options) -> Result<Vec<Group>, Failure> {
    let mut groups: Vec<Group> = Vec::new();
    for (parameters, modifier, surface) in surfaces(options, &options.receiver, Flux::Received)? {
        if groups.last().is_none_or(|group| group.modifier != modifier) {
            let mut group = Group::new(&modifier);
            group.parameters = groups.last().map_or_else(Parameters::default, |before| before.parameters.next());
            group.parameters.read(&parameters).map_err(|error| wrong(&options.receiver, &error))?;
            groups.push(group);
        }
        if let Some(group) = groups.last_mut() {
            group.surfaces.push(surface);
        }
    }
    Ok(groups)
}

/// The sender: all surfaces of its file.
pub(super) fn sender(options: &Options, path: &str) -> Result<Group, Failure> {
    let mut sender: Option<Group> = None;
    for (parameters, modifier, surface) in surfaces(options, path, Flux::Sent)? {
        let group = sender.get_or_insert_with(|| Group::new(&modifier));
        if group.modifier != modifier {
            options.warn("multiple modifiers in sender");
            group.modifier = modifier;
        }
        group.parameters.read(&parameters).map_err(|error| wrong(path, &error))?;
        group.surfaces.push(surface);
    }
    sender.ok_or_else(|| wrong(path, &FluxError::Nothing))
}

/// Whether surfaces send or receive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Flux {
    Sent,
    Received,
}

/// Checks the file that a receiver names at its comment. Expanded patterns are checked when their
/// names are known, as are commands.
fn check_output(options: &Options, parameters: &str) -> Result<(), Refusal> {
    let mut parsed = Parameters::default();
    let (Ok(()), Some(name)) = (parsed.read(parameters), parsed.output) else { return Ok(()) };
    match name.starts_with('!') {
        true if options.trust.runs_commands() => return Ok(()),
        true => return Err(Trust::refused_output_command(&name)),
        false if name.contains('%') => return Ok(()),
        false => {}
    }
    let existing = match options.existing {
        Existing::Kept => Existing::MadeBy(&options.receiver),
        existing => existing,
    };
    options.trust.output_of_file(&name, existing).map(drop)
}

/// Each surface with its modifier, and the options in comments before it. Degenerate surfaces are
/// skipped.
fn surfaces(options: &Options, path: &str, surfaces_of: Flux) -> Result<Vec<(String, String, FluxSurface)>, Failure> {
    let text = expanded_scene_text("rfluxmtx", path, &options.trust)?;
    let mistake = |error: SyntaxError| {
        let mut sources = SourceMap::default();
        let source = sources.add(path, text.clone(), None);
        Failure::diagnostics(&[error.diagnostic(source)], &sources)
    };
    let mut items = Items::new(&text).map_err(mistake)?;
    let mut pending = String::new();
    let mut found = Vec::new();
    while let Some(item) = items.advance() {
        match item.map_err(mistake)? {
            Item::Comment(place) => {
                let comment = String::from_utf8_lossy(&text[place.start as usize..place.end as usize]);
                if let Some(parameters) =
                    comment.strip_prefix(MARK).filter(|rest| rest.starts_with(char::is_whitespace))
                {
                    if surfaces_of == Flux::Received {
                        check_output(options, parameters).map_err(|refusal| {
                            let mut sources = SourceMap::default();
                            let source = sources.add(path, text.clone(), None);
                            let span = Span { source, start: place.start, end: place.end };
                            Failure::diagnostics(&[refusal.at(span)], &sources)
                        })?;
                    }
                    pending.push(' ');
                    pending.push_str(parameters);
                }
            }
            Item::Primitive(primitive) => {
                let Some(shape) = shape(primitive.kind) else { continue };
                let [modifier, name] = names(&primitive);
                match FluxSurface::new(&name, shape, primitive.reals) {
                    Ok(surface) => found.push((std::mem::take(&mut pending), modifier, surface)),
                    Err(error @ FluxError::NoArea { .. }) => options.warn(&error.to_string()),
                    Err(error) => return Err(wrong(path, &error)),
                }
            }
            Item::Alias(_) | Item::Command(_) => {}
        }
    }
    Ok(found)
}

fn shape(kind: Kind) -> Option<Shape> {
    match kind {
        Kind::Polygon => Some(Shape::Polygon),
        Kind::Ring => Some(Shape::Ring),
        Kind::Source => Some(Shape::Source),
        _ => None,
    }
}

fn names(primitive: &Primitive<'_>) -> [String; 2] {
    [primitive.modifier, primitive.name].map(|word| String::from_utf8_lossy(&primitive.text(word)).into_owned())
}
