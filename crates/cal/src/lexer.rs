//! Lexer: names, numbers and punctuation, without white space and nested `{ }` comments.

use radsight_diag::{Diagnostic, SourceId, Span};

/// Maximum length of a name; the rest of a longer one is ignored, as in Radiance.
const LONGEST_NAME: usize = 127;

/// Separator between a name and its scope.
pub(crate) const SCOPE_MARK: u8 = b'`';

/// One token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token<'t> {
    /// A name, with its scope marks.
    Name(&'t str),
    /// A number without its sign.
    Number(f64),
    /// Any other byte.
    Mark(u8),
    /// The end of the text.
    End,
}

/// A lexer with one token of lookahead.
#[derive(Debug)]
pub(crate) struct Lexer<'t> {
    text: &'t [u8],
    source: Option<SourceId>,
    base: u32,
    at: usize,
    /// The next token.
    pub(crate) token: Token<'t>,
    start: usize,
    previous_end: usize,
}

impl<'t> Lexer<'t> {
    /// Starts on a text whose first byte is at `base` of `source`.
    pub(crate) fn new(text: &'t [u8], source: Option<SourceId>, base: u32) -> Result<Self, Diagnostic> {
        let mut lexer = Lexer { text, source, base, at: 0, token: Token::End, start: 0, previous_end: 0 };
        lexer.advance()?;
        Ok(lexer)
    }

    /// Moves to the next token and returns the current one.
    pub(crate) fn advance(&mut self) -> Result<Token<'t>, Diagnostic> {
        let passed = self.token;
        self.previous_end = self.at;
        self.token = Token::End; // What stands if an error is found.
        self.skip_blanks()?;
        self.start = self.at;
        self.token = match self.text.get(self.at) {
            None => Token::End,
            Some(&byte) if byte.is_ascii_alphabetic() || byte == SCOPE_MARK => self.name(),
            Some(&byte) if byte.is_ascii_digit() || byte == b'.' => self.number()?,
            Some(&byte) => {
                self.at += 1;
                Token::Mark(byte)
            }
        };
        Ok(passed)
    }

    /// Consumes the mark if it is the next token.
    pub(crate) fn take(&mut self, mark: u8) -> Result<bool, Diagnostic> {
        let found = self.token == Token::Mark(mark);
        if found {
            self.advance()?;
        }
        Ok(found)
    }

    /// Consumes the mark, which must be the next token.
    pub(crate) fn expect(&mut self, mark: u8) -> Result<(), Diagnostic> {
        if self.take(mark)? { Ok(()) } else { Err(self.unexpected(&format!("\"{}\"", char::from(mark)))) }
    }

    /// Error about the next token.
    pub(crate) fn unexpected(&self, expected: &str) -> Diagnostic {
        let found = match self.token {
            Token::Name(name) => format!("\"{name}\""),
            Token::Number(number) => format!("the number {number}"),
            Token::Mark(byte) if byte.is_ascii_graphic() => format!("\"{}\"", char::from(byte)),
            Token::Mark(byte) => format!("the byte {byte:#04x}"),
            Token::End => "the end".to_owned(),
        };
        self.error(format!("expected {expected}, found {found}"), self.start, self.at)
    }

    /// An error at a byte range of the text.
    pub(crate) fn error(&self, message: impl Into<String>, start: usize, end: usize) -> Diagnostic {
        let diagnostic = Diagnostic::error(message);
        match self.source {
            Some(_) => self.place(start, end).into_iter().fold(diagnostic, Diagnostic::at),
            None => diagnostic,
        }
    }

    /// Span of a byte range of the text.
    pub(crate) fn place(&self, start: usize, end: usize) -> Option<Span> {
        let offset = |byte: usize| self.base.saturating_add(u32::try_from(byte).unwrap_or(u32::MAX));
        self.source.map(|source| Span { source, start: offset(start), end: offset(end.max(start)) })
    }

    /// Start of the next token, in bytes.
    pub(crate) fn token_start(&self) -> usize {
        self.start
    }

    /// Whether the current token is written in digits alone.
    pub(crate) fn is_digits(&self) -> bool {
        self.text[self.token_start()..self.token_end()].iter().all(u8::is_ascii_digit)
    }

    /// End of the next token, in bytes.
    pub(crate) fn token_end(&self) -> usize {
        self.at
    }

    /// End of the last consumed token, in bytes.
    pub(crate) fn passed_end(&self) -> usize {
        self.previous_end
    }

    /// Error recovery: continues after the next `;` outside of comments, or at the end.
    pub(crate) fn recover(&mut self) -> Result<(), Diagnostic> {
        if self.token == Token::Mark(b';') {
            return self.advance().map(|_| ());
        }
        loop {
            match self.text.get(self.at) {
                None => {
                    self.token = Token::End;
                    return Ok(());
                }
                Some(b'{') => self.skip_comment()?,
                Some(b';') => {
                    self.at += 1;
                    return self.advance().map(|_| ());
                }
                Some(_) => self.at += 1,
            }
        }
    }

    fn skip_blanks(&mut self) -> Result<(), Diagnostic> {
        while let Some(&byte) = self.text.get(self.at) {
            match byte {
                b' ' | b'\t'..=b'\r' => self.at += 1,
                b'{' => self.skip_comment()?,
                _ => break,
            }
        }
        Ok(())
    }

    fn skip_comment(&mut self) -> Result<(), Diagnostic> {
        let start = self.at;
        let mut depth = 0_usize;
        while let Some(&byte) = self.text.get(self.at) {
            self.at += 1;
            match byte {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return Ok(());
            }
        }
        self.start = self.at;
        Err(self.error("comment is not closed", start, start + 1).hint("expected a \"}\" for each \"{\""))
    }

    fn name(&mut self) -> Token<'t> {
        let rest = &self.text[self.at..];
        let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(*byte, b'_' | b'.' | SCOPE_MARK);
        let length = rest.iter().position(|byte| !is_part(byte)).unwrap_or(rest.len());
        self.at += length;
        Token::Name(std::str::from_utf8(&rest[..length.min(LONGEST_NAME)]).unwrap_or(""))
    }

    fn number(&mut self) -> Result<Token<'t>, Diagnostic> {
        let begin = self.at;
        self.skip_digits();
        if self.text.get(self.at) == Some(&b'.') {
            self.at += 1;
            if self.skip_digits() == 0 && self.at - begin == 1 {
                return Err(self.error("badly formed number", begin, self.at).hint("a number has at least one digit"));
            }
        }
        if matches!(self.text.get(self.at), Some(b'e' | b'E')) {
            self.at += 1;
            if matches!(self.text.get(self.at), Some(b'+' | b'-')) {
                self.at += 1;
            }
            if self.skip_digits() == 0 {
                return Err(self.error("number has no digits after its exponent mark", begin, self.at));
            }
        }
        let digits = std::str::from_utf8(&self.text[begin..self.at]).unwrap_or("");
        Ok(Token::Number(digits.parse().unwrap_or(0.0)))
    }

    fn skip_digits(&mut self) -> usize {
        let begin = self.at;
        while self.text.get(self.at).is_some_and(u8::is_ascii_digit) {
            self.at += 1;
        }
        self.at - begin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<Token<'_>> {
        let mut lexer = Lexer::new(text.as_bytes(), None, 0).unwrap();
        let mut all = Vec::new();
        while lexer.token != Token::End {
            all.push(lexer.advance().unwrap());
        }
        all
    }

    #[test]
    fn comments_nest_and_separate() {
        assert_eq!(tokens("a{ x { y } z }b"), [Token::Name("a"), Token::Name("b")]);
    }

    #[test]
    fn an_open_comment_is_an_error() {
        assert!(Lexer::new(b" { {} ", None, 0).is_err());
    }

    #[test]
    fn numbers_need_no_digit_before_or_after_the_point() {
        assert_eq!(tokens(".5 1. 1.e2 3E-1"), [0.5, 1.0, 100.0, 0.3].map(Token::Number));
        for wrong in [".", ".e5", "1e", "2e+"] {
            assert!(Lexer::new(wrong.as_bytes(), None, 0).is_err(), "{wrong}");
        }
    }

    #[test]
    fn names_hold_points_underscores_and_scope_marks() {
        assert_eq!(tokens("un2`P. `x_1"), [Token::Name("un2`P."), Token::Name("`x_1")]);
    }
}
