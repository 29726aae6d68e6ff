//! Splits a command line as `sh` does in simple cases.
//!
//! Supports words, single and double quotes, backslashes, continuation lines, comments, pipes, `;`
//! or a line end between commands, groups in parentheses, input from a file with `<`, and file name
//! patterns, which [`expanded`] replaces by the matching files. Any other construct of `sh` is an
//! error that names it: such a scene needs a real shell, and guessing would change its meaning.
//!
//! ```
//! let script = radsight_scene_generators::shell_words::split("genrev brass knob 'sin(PI*t)' t 8 | xform -t 0 0 1").unwrap();
//! let radsight_scene_generators::shell_words::Stage::Command(command) = &script.pipelines[0].stages[0] else { panic!() };
//! assert_eq!(command.words[3].text, "sin(PI*t)");
//! ```

use radsight_loader::Loader;
use std::ops::Range;

/// Largest nesting depth of groups.
pub const MAX_GROUP_DEPTH: usize = 32;

/// A word without quotes and backslashes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// The word that the program receives.
    pub text: String,
    /// The word as a file name pattern, if it has an unquoted `*`, `?` or `[`; quoted ones are put
    /// in brackets.
    pub pattern: Option<String>,
    /// Byte range in the line, quotes included.
    pub range: Range<usize>,
}

/// One program with its arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Command {
    /// The program's name and its arguments; never empty.
    pub words: Vec<Word>,
    /// The file after `<`.
    pub input: Option<Word>,
}

/// One stage of a pipe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A program.
    Command(Command),
    /// `( … )`: the concatenated outputs of its pipelines.
    Group {
        /// The script between the parentheses.
        script: Script,
        /// The file after `<`, read by every program inside that reads its standard input.
        input: Option<Word>,
    },
}

/// Stages joined by `|`, each reading the output of the one before; never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pipeline {
    /// From left to right.
    pub stages: Vec<Stage>,
}

/// Pipelines that run one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Script {
    /// In order.
    pub pipelines: Vec<Pipeline>,
}

/// Why a line cannot be split; every variant has the byte range of the mistake.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SyntaxError {
    /// A construct that requires a shell.
    #[error("{construct} (\"{text}\") needs a shell, and scene commands run without one{}", hint(.construct))]
    NeedsShell {
        /// Its name.
        construct: &'static str,
        /// As written.
        text: String,
        /// Its range.
        range: Range<usize>,
    },
    /// A quote without a closing quote.
    #[error("the quote {quote} is never closed")]
    UnclosedQuote {
        /// The quote.
        quote: char,
        /// From the quote to the end of the line.
        range: Range<usize>,
    },
    /// A parenthesis without a closing one.
    #[error("the parenthesis is never closed")]
    UnclosedGroup {
        /// The parenthesis.
        range: Range<usize>,
    },
    /// A program name is missing.
    #[error("expected a command, found {found}")]
    ExpectedCommand {
        /// What was found instead.
        found: String,
        /// Its range.
        range: Range<usize>,
    },
    /// An unexpected token after a complete command or group, or in place of a file name.
    #[error("unexpected {found}")]
    Unexpected {
        /// What was found.
        found: String,
        /// Its range.
        range: Range<usize>,
    },
    /// Groups are nested too deeply.
    #[error("more than {MAX_GROUP_DEPTH} nested parentheses")]
    TooDeep {
        /// The range of the parenthesis that exceeds the limit.
        range: Range<usize>,
    },
}

impl SyntaxError {
    /// The byte range of the mistake.
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        match self {
            SyntaxError::NeedsShell { range, .. }
            | SyntaxError::UnclosedQuote { range, .. }
            | SyntaxError::UnclosedGroup { range }
            | SyntaxError::ExpectedCommand { range, .. }
            | SyntaxError::Unexpected { range, .. }
            | SyntaxError::TooDeep { range } => range.clone(),
        }
    }

    /// Whether a real shell could still run the line.
    #[must_use]
    pub fn needs_shell(&self) -> bool {
        matches!(self, SyntaxError::NeedsShell { .. })
    }
}

fn hint(construct: &str) -> &'static str {
    match construct {
        "a variable" | "a command in back-quotes" => "; if it is meant literally, put it in single quotes",
        _ => "",
    }
}

/// Splits a command line.
///
/// # Errors
/// When a quote or parenthesis is not closed, a command is missing, or the line needs a real shell.
pub fn split(line: &str) -> Result<Script, SyntaxError> {
    let tokens = tokens(line)?;
    let mut parser = Parser { tokens: &tokens, next: 0, end: line.len() };
    let script = parser.script(0)?;
    match parser.tokens.get(parser.next) {
        Some(token) => Err(token.unexpected()),
        None => Ok(script),
    }
}

/// Words with each pattern replaced by the names of matching files. A pattern without matches is a
/// plain word, as in `sh`: scenes have arithmetic such as `t*.9` among their arguments.
#[must_use]
pub fn expanded(words: &[Word], loader: &dyn Loader) -> Vec<Word> {
    let mut all = Vec::with_capacity(words.len());
    for word in words {
        let names = word.pattern.as_deref().map_or(Vec::new(), |pattern| loader.names_like(pattern));
        if names.is_empty() {
            all.push(Word { pattern: None, ..word.clone() });
        }
        all.extend(names.into_iter().map(|text| Word { text, pattern: None, range: word.range.clone() }));
    }
    all
}

/// Joins words, quoted so that a shell parses them back.
#[must_use]
pub fn join(words: &[String]) -> String {
    let plain = |word: &str| {
        !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-+.,/:@%^".contains(&byte))
    };
    let quoted: Vec<String> = words
        .iter()
        .map(|word| if plain(word) { word.clone() } else { format!("'{}'", word.replace('\'', "'\\''")) })
        .collect();
    quoted.join(" ")
}

enum Token {
    Word(Word),
    Operator { kind: Operator, range: Range<usize> },
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Operator {
    Pipe,
    Separator,
    Open,
    Close,
    Input,
}

impl Token {
    fn range(&self) -> Range<usize> {
        match self {
            Token::Word(word) => word.range.clone(),
            Token::Operator { range, .. } => range.clone(),
        }
    }

    fn operator(&self) -> Option<Operator> {
        match self {
            Token::Operator { kind, .. } => Some(*kind),
            Token::Word(_) => None,
        }
    }

    fn words(&self) -> String {
        match self {
            Token::Word(word) => format!("\"{}\"", word.text),
            Token::Operator { kind, .. } => match kind {
                Operator::Pipe => "\"|\"",
                Operator::Separator => "the end of a command",
                Operator::Open => "\"(\"",
                Operator::Close => "\")\"",
                Operator::Input => "\"<\"",
            }
            .to_owned(),
        }
    }

    fn unexpected(&self) -> SyntaxError {
        SyntaxError::Unexpected { found: self.words(), range: self.range() }
    }
}

struct Parser<'a> {
    tokens: &'a [Token],
    next: usize,
    end: usize,
}

impl Parser<'_> {
    fn operator(&self) -> Option<Operator> {
        self.tokens.get(self.next).and_then(Token::operator)
    }

    fn script(&mut self, depth: usize) -> Result<Script, SyntaxError> {
        let mut script = Script::default();
        loop {
            while self.operator() == Some(Operator::Separator) {
                self.next += 1;
            }
            if self.next == self.tokens.len() || self.operator() == Some(Operator::Close) {
                return Ok(script);
            }
            let mut stages = vec![self.stage(depth)?];
            while self.operator() == Some(Operator::Pipe) {
                self.next += 1;
                while self.operator() == Some(Operator::Separator) {
                    self.next += 1;
                }
                stages.push(self.stage(depth)?);
            }
            script.pipelines.push(Pipeline { stages });
            match self.tokens.get(self.next) {
                None => return Ok(script),
                Some(token) => match token.operator() {
                    Some(Operator::Separator | Operator::Close) => {}
                    _ => return Err(token.unexpected()),
                },
            }
        }
    }

    fn stage(&mut self, depth: usize) -> Result<Stage, SyntaxError> {
        if self.operator() != Some(Operator::Open) {
            return Ok(Stage::Command(self.command()?));
        }
        let range = self.tokens[self.next].range();
        if depth == MAX_GROUP_DEPTH {
            return Err(SyntaxError::TooDeep { range });
        }
        self.next += 1;
        let script = self.script(depth + 1)?;
        if self.operator() != Some(Operator::Close) {
            return Err(SyntaxError::UnclosedGroup { range });
        }
        if script.pipelines.is_empty() {
            return Err(self.expected_command());
        }
        self.next += 1;
        let mut input = None;
        while self.operator() == Some(Operator::Input) {
            input = Some(self.input_file()?);
        }
        Ok(Stage::Group { script, input })
    }

    fn command(&mut self) -> Result<Command, SyntaxError> {
        let (mut words, mut input) = (Vec::new(), None);
        while let Some(token) = self.tokens.get(self.next) {
            match token {
                Token::Word(word) => {
                    words.push(word.clone());
                    self.next += 1;
                }
                Token::Operator { kind: Operator::Input, .. } => input = Some(self.input_file()?),
                Token::Operator { .. } => break,
            }
        }
        if words.is_empty() { Err(self.expected_command()) } else { Ok(Command { words, input }) }
    }

    fn input_file(&mut self) -> Result<Word, SyntaxError> {
        self.next += 1;
        match self.tokens.get(self.next) {
            Some(Token::Word(word)) => {
                self.next += 1;
                Ok(word.clone())
            }
            Some(token) => Err(token.unexpected()),
            None => Err(SyntaxError::Unexpected {
                found: "end of the line after \"<\"".to_owned(),
                range: self.end..self.end,
            }),
        }
    }

    fn expected_command(&self) -> SyntaxError {
        match self.tokens.get(self.next) {
            Some(token) => SyntaxError::ExpectedCommand { found: token.words(), range: token.range() },
            None => SyntaxError::ExpectedCommand { found: "the end of the line".to_owned(), range: self.end..self.end },
        }
    }
}

fn tokens(line: &str) -> Result<Vec<Token>, SyntaxError> {
    let mut scanner = Scanner { line, position: 0 };
    let mut tokens = Vec::new();
    while let Some(character) = scanner.peek() {
        let start = scanner.position;
        let operator = match character {
            ' ' | '\t' | '\r' => {
                scanner.position += 1;
                continue;
            }
            '\\' if scanner.at("\\\n") || scanner.at("\\\r\n") => {
                scanner.position = start + 1 + line[start + 1..].find('\n').unwrap_or(0) + 1;
                continue;
            }
            '#' => {
                scanner.position = line[start..].find('\n').map_or(line.len(), |length| start + length);
                continue;
            }
            '\n' => Operator::Separator,
            ';' if scanner.at(";;") => return Err(scanner.needs_shell("\";;\"", start, 2)),
            ';' => Operator::Separator,
            '|' if scanner.at("||") => return Err(scanner.needs_shell("the operator \"or\"", start, 2)),
            '|' => Operator::Pipe,
            '&' if scanner.at("&&") => return Err(scanner.needs_shell("the operator \"and\"", start, 2)),
            '&' => return Err(scanner.needs_shell("a background command", start, 1)),
            '>' => return Err(scanner.needs_shell("output into a file", start, if scanner.at(">>") { 2 } else { 1 })),
            '<' if scanner.at("<<") => return Err(scanner.needs_shell("a here-document", start, 2)),
            '<' if scanner.at("<&") || scanner.at("<(") || scanner.at("<>") => {
                return Err(scanner.needs_shell("this redirection", start, 2));
            }
            '<' => Operator::Input,
            '(' => Operator::Open,
            ')' => Operator::Close,
            _ => {
                let position = match tokens.last() {
                    Some(Token::Word(_)) => WordPosition::Argument,
                    _ => WordPosition::Command,
                };
                tokens.push(Token::Word(scanner.word(position)?));
                continue;
            }
        };
        scanner.position += 1;
        tokens.push(Token::Operator { kind: operator, range: start..scanner.position });
    }
    Ok(tokens)
}

/// The position of a word.
#[derive(Clone, Copy, PartialEq, Eq)]
enum WordPosition {
    /// The first word of a command, where `name=value` would set a variable.
    Command,
    Argument,
}

/// Characters of file name patterns. The closing bracket is special only after an opening one.
const WILDCARDS: [char; 4] = ['*', '?', '[', ']'];

/// A word as a pattern, where some of its bytes are unquoted wildcards.
fn pattern(text: &str, wildcards: &[usize]) -> Option<String> {
    if !wildcards.iter().any(|at| !text[*at..].starts_with(']')) {
        return None;
    }
    let mut pattern = String::with_capacity(text.len());
    for (at, character) in text.char_indices() {
        match character {
            // In sh two stars equal one; elsewhere they would match folders recursively.
            '*' if wildcards.contains(&at) && at > 0 && wildcards.contains(&(at - 1)) && pattern.ends_with('*') => {}
            _ if !WILDCARDS.contains(&character) || wildcards.contains(&at) => pattern.push(character),
            _ => pattern.extend(['[', character, ']']),
        }
    }
    Some(pattern)
}

struct Scanner<'a> {
    line: &'a str,
    position: usize,
}

impl Scanner<'_> {
    fn peek(&self) -> Option<char> {
        self.line[self.position..].chars().next()
    }

    fn at(&self, text: &str) -> bool {
        self.line[self.position..].starts_with(text)
    }

    fn needs_shell(&self, construct: &'static str, start: usize, length: usize) -> SyntaxError {
        let range = start..start + length;
        SyntaxError::NeedsShell { construct, text: self.line[range.clone()].to_owned(), range }
    }

    /// A whole word.
    fn word(&mut self, position: WordPosition) -> Result<Word, SyntaxError> {
        let start = self.position;
        let mut text = String::new();
        let mut wildcards = Vec::new();
        if self.peek() == Some('~') {
            return Err(self.needs_shell("a home directory", start, 1));
        }
        while let Some(character) = self.peek() {
            match character {
                ' ' | '\t' | '\r' | '\n' | ';' | '|' | '&' | '<' | '>' | ')' => break,
                '(' => {
                    return Err(SyntaxError::Unexpected {
                        found: "\"(\"".to_owned(),
                        range: self.position..self.position + 1,
                    });
                }
                '\'' => self.single_quoted(&mut text)?,
                '"' => self.double_quoted(&mut text)?,
                '\\' => self.escaped(&mut text),
                '$' => self.dollar(&mut text)?,
                '`' => return Err(self.back_quotes()),
                '=' if position == WordPosition::Command && is_name(&self.line[start..self.position]) => {
                    return Err(self.needs_shell("a variable setting", start, self.position + 1 - start));
                }
                _ => {
                    if WILDCARDS.contains(&character) {
                        wildcards.push(text.len());
                    }
                    text.push(character);
                    self.position += character.len_utf8();
                }
            }
        }
        let digits_only = !text.is_empty() && self.line[start..self.position].bytes().all(|byte| byte.is_ascii_digit());
        if digits_only && matches!(self.peek(), Some('<' | '>')) {
            return Err(self.needs_shell("a numbered redirection", start, self.position + 1 - start));
        }
        let pattern = pattern(&text, &wildcards);
        Ok(Word { text, pattern, range: start..self.position })
    }

    fn single_quoted(&mut self, text: &mut String) -> Result<(), SyntaxError> {
        let start = self.position;
        let rest = &self.line[start + 1..];
        let Some(length) = rest.find('\'') else {
            return Err(SyntaxError::UnclosedQuote { quote: '\'', range: start..self.line.len() });
        };
        text.push_str(&rest[..length]);
        self.position = start + length + 2;
        Ok(())
    }

    fn double_quoted(&mut self, text: &mut String) -> Result<(), SyntaxError> {
        let start = self.position;
        self.position += 1;
        while let Some(character) = self.peek() {
            match character {
                '"' => {
                    self.position += 1;
                    return Ok(());
                }
                '\\' if ["\\\"", "\\\\", "\\$", "\\`", "\\\n"].iter().any(|escape| self.at(escape)) => {
                    self.escaped(text)
                }
                '$' => self.dollar(text)?,
                '`' => return Err(self.back_quotes()),
                _ => {
                    text.push(character);
                    self.position += character.len_utf8();
                }
            }
        }
        Err(SyntaxError::UnclosedQuote { quote: '"', range: start..self.line.len() })
    }

    /// A backslash and the character it protects; with a line end both are removed.
    fn escaped(&mut self, text: &mut String) {
        if self.at("\\\r\n") {
            self.position += 3;
            return;
        }
        self.position += 1;
        match self.peek() {
            Some('\n') => self.position += 1,
            Some(character) => {
                text.push(character);
                self.position += character.len_utf8();
            }
            None => text.push('\\'),
        }
    }

    /// A dollar sign is literal unless something expandable follows.
    fn dollar(&mut self, text: &mut String) -> Result<(), SyntaxError> {
        let start = self.position;
        let rest = &self.line[start + 1..];
        let name = rest.bytes().take_while(|byte| byte.is_ascii_alphanumeric() || *byte == b'_').count();
        match rest.bytes().next() {
            Some(b'(') => Err(self.needs_shell("a command in \"$()\"", start, 2)),
            Some(b'{') => Err(self.needs_shell("a variable", start, 2)),
            Some(digit) if digit.is_ascii_digit() => Err(self.needs_shell("a variable", start, 2)),
            Some(b'@' | b'*' | b'#' | b'?' | b'-' | b'$' | b'!') => Err(self.needs_shell("a variable", start, 2)),
            Some(_) if name > 0 => Err(self.needs_shell("a variable", start, 1 + name)),
            _ => {
                text.push('$');
                self.position += 1;
                Ok(())
            }
        }
    }

    fn back_quotes(&self) -> SyntaxError {
        let rest = &self.line[self.position + 1..];
        let length = rest.find('`').map_or(1, |length| length + 2);
        self.needs_shell("a command in back-quotes", self.position, length)
    }
}

fn is_name(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}

#[cfg(test)]
mod tests;
