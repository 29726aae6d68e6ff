//! The variables of a `.rif` file.

use crate::ProjectError;

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variable {
    AmbientFile,
    Detail,
    Exposure,
    EyeSeparation,
    Illum,
    Indirect,
    Materials,
    Mkillum,
    Mkpmap,
    Objects,
    Oconv,
    Octree,
    OptionFile,
    CausticMap,
    Penumbras,
    Pfilt,
    GlobalMap,
    Picture,
    Quality,
    RawFile,
    Render,
    Report,
    Resolution,
    Rpict,
    Rvu,
    Scene,
    Up,
    Variability,
    View,
    ZFile,
    Zone,
}

/// The type of a variable, and the meaning of repeated assignments.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Text, optionally quoted; the last assignment is used.
    Text,
    /// Several words; the last assignment is used.
    Last,
    /// Assignments are joined into one text.
    Joined,
    /// Each assignment is kept.
    Each,
    /// Low, medium or high.
    Quality,
    Flag,
    Whole,
    Real,
}

use Variable as V;

/// Each variable with its name, the length of its shortest abbreviation, and its type; in printing
/// order.
const VARIABLES: [(Variable, &str, usize, Kind); 31] = [
    (V::AmbientFile, "AMBFILE", 3, Kind::Text),
    (V::Detail, "DETAIL", 3, Kind::Quality),
    (V::Exposure, "EXPOSURE", 3, Kind::Real),
    (V::EyeSeparation, "EYESEP", 3, Kind::Real),
    (V::Illum, "illum", 3, Kind::Joined),
    (V::Indirect, "INDIRECT", 3, Kind::Whole),
    (V::Materials, "materials", 3, Kind::Joined),
    (V::Mkillum, "mkillum", 3, Kind::Joined),
    (V::Mkpmap, "mkpmap", 3, Kind::Joined),
    (V::Objects, "objects", 3, Kind::Joined),
    (V::Oconv, "oconv", 3, Kind::Joined),
    (V::Octree, "OCTREE", 3, Kind::Text),
    (V::OptionFile, "OPTFILE", 3, Kind::Text),
    (V::CausticMap, "PCMAP", 2, Kind::Text),
    (V::Penumbras, "PENUMBRAS", 3, Kind::Flag),
    (V::Pfilt, "pfilt", 2, Kind::Joined),
    (V::GlobalMap, "PGMAP", 2, Kind::Text),
    (V::Picture, "PICTURE", 3, Kind::Text),
    (V::Quality, "QUALITY", 3, Kind::Quality),
    (V::RawFile, "RAWFILE", 3, Kind::Text),
    (V::Render, "render", 3, Kind::Joined),
    (V::Report, "REPORT", 3, Kind::Last),
    (V::Resolution, "RESOLUTION", 3, Kind::Last),
    (V::Rpict, "rpict", 3, Kind::Joined),
    (V::Rvu, "rvu", 3, Kind::Joined),
    (V::Scene, "scene", 3, Kind::Joined),
    (V::Up, "UP", 2, Kind::Last),
    (V::Variability, "VARIABILITY", 3, Kind::Quality),
    (V::View, "view", 2, Kind::Each),
    (V::ZFile, "ZFILE", 2, Kind::Text),
    (V::Zone, "ZONE", 2, Kind::Last),
];

/// Column after which a printed value is continued on the next line.
const JOINED_WIDTH: usize = 64;
const OTHER_WIDTH: usize = 236;

/// The origin of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedBy {
    /// The user: on the command line, or by the name of the `.rif` file as a default.
    CommandLine,
    /// The `.rif` file.
    File {
        /// The line, from 1.
        line: usize,
    },
}

/// A project: the variables of a `.rif` file.
#[derive(Clone, Debug)]
pub struct Project {
    /// The file's name without its suffix.
    pub(crate) root: String,
    values: [Vec<String>; VARIABLES.len()],
    /// The origins of the values.
    named_by: [NamedBy; VARIABLES.len()],
}

impl Project {
    /// Parses the text of a file with this name.
    ///
    /// # Errors
    /// [`ProjectError::UnknownVariable`].
    pub fn read(file: &str, text: &str) -> Result<Project, ProjectError> {
        let values = std::array::from_fn(|_| Vec::new());
        let named_by = [NamedBy::CommandLine; VARIABLES.len()];
        let mut project = Project { root: without_suffix(file).to_owned(), values, named_by };
        for (line, assignment) in logical_lines(text) {
            project.set(&assignment, &format!("{file}:{line}"), NamedBy::File { line })?;
        }
        Ok(project)
    }

    /// Parses an assignment such as `QUALITY=high` from the command line. False if the word is not
    /// an assignment.
    ///
    /// # Errors
    /// [`ProjectError::UnknownVariable`].
    pub fn assign(&mut self, assignment: &str) -> Result<bool, ProjectError> {
        self.set(assignment, "command line", NamedBy::CommandLine)
    }

    fn set(&mut self, assignment: &str, place: &str, by: NamedBy) -> Result<bool, ProjectError> {
        let assignment = assignment.trim();
        let end = assignment.find(|c: char| c.is_whitespace() || c == '=').unwrap_or(assignment.len());
        let (name, value) = assignment.split_at(end);
        let value = squeezed(value.trim_start_matches(|c: char| c.is_whitespace() || c == '='));
        if name.is_empty() || value.is_empty() {
            return Ok(false);
        }
        let known = VARIABLES.iter().position(|(_, full, least, _)| name.len() >= *least && full.starts_with(name));
        let Some(known) = known else {
            return Err(ProjectError::UnknownVariable { place: place.to_owned(), name: name.to_owned() });
        };
        // If assignments are joined, one from the file makes the file the origin of the whole.
        let adds_up = matches!(VARIABLES[known].3, Kind::Joined | Kind::Each);
        if !(adds_up && matches!(self.named_by[known], NamedBy::File { .. })) {
            self.named_by[known] = by;
        }
        self.values[known].push(value);
        Ok(true)
    }

    /// Checks the values and resolves repeated assignments. Returns warnings.
    ///
    /// # Errors
    /// [`ProjectError::Value`].
    pub fn check(&mut self) -> Result<Vec<String>, ProjectError> {
        let mut warnings = Vec::new();
        for ((variable, name, _, kind), values) in VARIABLES.iter().zip(&mut self.values) {
            match kind {
                Kind::Each => continue,
                Kind::Joined if !values.is_empty() => *values = vec![values.join(" ")],
                _ if values.len() > 1 => {
                    warnings.push(format!("multiple assignment of variable '{name}'"));
                    values.drain(..values.len() - 1);
                }
                _ => {}
            }
            let Some(value) = values.first_mut() else { continue };
            let allowed: &[&str] = match kind {
                Kind::Quality => &["LOW", "MEDIUM", "HIGH"],
                Kind::Flag => &["TRUE", "FALSE"],
                _ => &[],
            };
            let upper = value.to_ascii_uppercase();
            let expected = match kind {
                Kind::Quality if !allowed.iter().any(|word| word.starts_with(&upper)) => "low, medium or high",
                Kind::Flag if !allowed.iter().any(|word| word.starts_with(&upper)) => "true or false",
                Kind::Whole if value.parse::<i64>().is_err() => "a whole number",
                Kind::Real if value.parse::<f64>().is_err() => "a number",
                _ => {
                    if *kind == Kind::Text {
                        unquote(value);
                    }
                    if !(is_one_word(*variable) && value.contains(char::is_whitespace)) {
                        continue;
                    }
                    "a file name without white space"
                }
            };
            return Err(ProjectError::Value { variable: name, value: value.clone(), expected });
        }
        Ok(warnings)
    }

    /// All values, one assignment per line, as `rad -e` prints them.
    #[must_use]
    pub fn explained(&self) -> String {
        let mut text = String::new();
        for ((_, name, _, kind), values) in VARIABLES.iter().zip(&self.values) {
            let space = if matches!(kind, Kind::Joined | Kind::Last | Kind::Each) { " " } else { "" };
            let (width, next) = match kind {
                Kind::Joined => (JOINED_WIDTH, format!("\n{name}=")),
                _ => (OTHER_WIDTH, " \\\n".to_owned()),
            };
            for value in values {
                text.push_str(&format!("{name}={space}"));
                wrap(value, width - name.len(), &next, &mut text);
                text.push('\n');
            }
        }
        text
    }

    /// The value of a variable; the first of several.
    pub(crate) fn value(&self, variable: Variable) -> Option<&str> {
        self.values[place(variable)].first().map(String::as_str)
    }

    /// All values of a variable.
    pub(crate) fn all(&self, variable: Variable) -> &[String] {
        &self.values[place(variable)]
    }

    /// The origin of a variable's value.
    pub(crate) fn named_by(&self, variable: Variable) -> NamedBy {
        self.named_by[place(variable)]
    }

    /// Sets a variable that has no value.
    pub(crate) fn set_default(&mut self, variable: Variable, value: impl Into<String>) {
        let values = &mut self.values[place(variable)];
        if values.is_empty() {
            values.push(value.into());
        }
    }

    /// The error for a value that is found to be wrong on use.
    pub(crate) fn wrong(&self, variable: Variable, expected: &'static str) -> ProjectError {
        let value = self.value(variable).unwrap_or_default().to_owned();
        ProjectError::Value { variable: VARIABLES[place(variable)].1, value, expected }
    }
}

/// Whether the value is a word of commands, which white space would divide, as in Radiance.
fn is_one_word(variable: Variable) -> bool {
    matches!(variable, V::AmbientFile | V::OptionFile | V::Picture | V::RawFile | V::ZFile)
}

fn place(variable: Variable) -> usize {
    variable as usize
}

/// The lines of the text, joined at backslashes, without comments, each with its number.
fn logical_lines(text: &str) -> Vec<(usize, String)> {
    let mut lines = Vec::new();
    let mut characters = text.chars();
    let (mut line, mut start, mut current, mut in_comment) = (1, 1, String::new(), false);
    while let Some(character) = characters.next() {
        match character {
            '\\' => {
                let next = characters.next();
                line += usize::from(next == Some('\n'));
                if !in_comment {
                    current.extend(next.map(|next| if next == '\n' { ' ' } else { next }));
                }
            }
            '\n' => {
                line += 1;
                lines.push((start, std::mem::take(&mut current)));
                (start, in_comment) = (line, false);
            }
            '#' => in_comment = true,
            _ if in_comment => {}
            _ => current.push(character),
        }
    }
    lines.push((start, current));
    lines
}

/// Reduces runs of white space outside quotes to their first character. As in Radiance, a quote at
/// the very start groups nothing, so that a quoted command can continue on the next line.
fn squeezed(value: &str) -> String {
    let mut text = String::with_capacity(value.len());
    let mut quote = None;
    for (place, character) in value.trim().char_indices() {
        match quote {
            _ if place == 0 => {}
            Some(open) if open == character => quote = None,
            Some(_) => {}
            None if character.is_whitespace() && text.ends_with(char::is_whitespace) => {
                continue;
            }
            None if matches!(character, '"' | '\'') => quote = Some(character),
            None => {}
        }
        text.push(character);
    }
    text
}

fn unquote(value: &mut String) {
    let quote = value.chars().next().filter(|quote| matches!(quote, '"' | '\''));
    if let Some(quote) = quote
        && let Some(inner) = value.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote))
    {
        *value = inner.to_owned();
    }
}

/// Writes a value, with line breaks at the first space beyond a width.
fn wrap(value: &str, width: usize, next: &str, text: &mut String) {
    let mut left = width;
    for character in value.chars() {
        if left == 0 && character.is_whitespace() {
            text.push_str(next);
            left = width;
        }
        left = left.saturating_sub(1);
        text.push(character);
    }
}

/// A file name without the last suffix of its last component.
pub(crate) fn without_suffix(name: &str) -> &str {
    let last = name.rfind('/').map_or(0, |slash| slash + 1);
    match name[last..].rfind('.') {
        Some(dot) => &name[..last + dot],
        None => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_variables() {
        assert!(VARIABLES.iter().enumerate().all(|(place, (variable, ..))| super::place(*variable) == place));
    }

    #[test]
    fn names_can_be_short_and_lines_long() {
        let text = "# all\nQUAL = Hi # best\nscene= a.rad \\\n  b.rad\nsce = \"!xform  -n c  d.rad\"\nEXP=\\#\n";
        let mut project = Project::read("x/y.z.rif", text).unwrap();
        assert_eq!(project.root, "x/y.z");
        assert!(project.check().is_err(), "an exposure is a number");
        project.assign("EXP=2").unwrap();
        assert_eq!(project.check().unwrap(), ["multiple assignment of variable 'EXPOSURE'"]);
        assert_eq!(project.value(Variable::Scene), Some("a.rad b.rad \"!xform -n c d.rad\""));
        assert_eq!(project.value(Variable::Quality), Some("Hi"));
    }

    #[test]
    fn the_origin_of_the_last_assignment_is_returned() {
        let mut project = Project::read("a.rif", "# one\nOCT= a.oct\nrender= -ab 1\n").unwrap();
        assert_eq!(project.named_by(Variable::Octree), NamedBy::File { line: 2 });
        assert_eq!(project.named_by(Variable::Picture), NamedBy::CommandLine);
        project.assign("OCTREE=b.oct").unwrap();
        project.assign("render=-ab 2").unwrap();
        assert_eq!(project.named_by(Variable::Octree), NamedBy::CommandLine);
        assert_eq!(project.named_by(Variable::Render), NamedBy::File { line: 3 }, "values that add up stay the file's");
    }

    #[test]
    fn unknown_variables_are_named_with_their_line() {
        let error = Project::read("a.rif", "view= X\n\nQU= low\n").unwrap_err();
        assert_eq!(error.to_string(), "a.rif:3: unknown variable \"QU\"");
    }
}
