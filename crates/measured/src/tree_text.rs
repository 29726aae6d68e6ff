//! Parser of tensor trees: braces and numbers.

use crate::mistake::Mistake;
use crate::tree::{MOST_HALVINGS, Node, Rank, Tree};

/// Splits a text into braces and numbers, separated by white space and commas; positions are
/// relative to the text.
pub(crate) struct Numbers<'t> {
    text: &'t str,
    at: usize,
}

/// Next token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token<'t> {
    Open,
    Close,
    Word(&'t str),
    End,
}

impl<'t> Numbers<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        Numbers { text, at: 0 }
    }

    /// Next token and its position.
    pub(crate) fn next(&mut self) -> (Token<'t>, usize) {
        let is_space = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',' || *byte == 0x0b;
        let bytes = self.text.as_bytes();
        self.at += bytes[self.at..].iter().take_while(|byte| is_space(byte)).count();
        let start = self.at;
        let token = match bytes.get(start) {
            None => return (Token::End, start),
            Some(b'{') => Token::Open,
            Some(b'}') => Token::Close,
            Some(_) => {
                let in_word = |byte: &&u8| !is_space(byte) && **byte != b'{' && **byte != b'}';
                let length = bytes[start..].iter().take_while(in_word).count();
                self.at += length;
                return (Token::Word(&self.text[start..start + length]), start);
            }
        };
        self.at += 1;
        (token, start)
    }

    pub(crate) fn peek(&mut self) -> Token<'t> {
        let before = self.at;
        let (token, _) = self.next();
        self.at = before;
        token
    }
}

/// A value of scattering data: finite; a negative one counts as zero, as in Radiance.
pub(crate) fn scattering_value(word: &str, at: usize) -> Result<f32, Mistake> {
    let value = word.parse::<f64>().ok().map(|value| value as f32).filter(|value| value.is_finite());
    value
        .map(|value| value.max(0.0))
        .ok_or_else(|| Mistake::unexpected("a scattering value", word, "a finite number", at..at + word.len()))
}

/// Reads a whole tree.
pub(crate) fn read_tree(text: &str, rank: Rank) -> Result<Tree, Mistake> {
    let root = Node::Grid { halvings: 0, first: 0 };
    let mut reader = Reader { numbers: Numbers::new(text), tree: Tree { rank, nodes: vec![root], values: Vec::new() } };
    reader.node(0, 0)?;
    match reader.numbers.next() {
        (Token::End, _) => Ok(reader.tree),
        (token, at) => Err(unexpected(token, "nothing after its last \"}\"", at)),
    }
}

struct Reader<'t> {
    numbers: Numbers<'t>,
    tree: Tree,
}

impl Reader<'_> {
    /// Reads a node with its braces into a reserved position.
    fn node(&mut self, place: usize, depth: u32) -> Result<(), Mistake> {
        let (token, at) = self.numbers.next();
        if token != Token::Open {
            return Err(unexpected(token, "\"{\"", at));
        }
        let dimensions = self.tree.rank.dimensions();
        if self.numbers.peek() != Token::Open {
            self.tree.nodes[place] = self.grid(depth, at)?;
            return Ok(());
        }
        if depth >= MOST_HALVINGS {
            return Err(too_deep(at));
        }
        let first = self.tree.nodes.len();
        self.tree.nodes[place] = Node::Branch(first as u32);
        self.tree.nodes.resize(first + (1 << dimensions), Node::Grid { halvings: 0, first: 0 });
        for child in 0..1 << dimensions {
            self.node(first + child, depth + 1)?;
        }
        match self.numbers.next() {
            (Token::Close, _) => Ok(()),
            (token, at) => Err(unexpected(token, &format!("\"}}\" after {} branches", 1 << dimensions), at)),
        }
    }

    fn grid(&mut self, depth: u32, start: usize) -> Result<Node, Mistake> {
        let first = self.tree.values.len();
        loop {
            match self.numbers.next() {
                (Token::Word(word), at) => self.tree.values.push(scattering_value(word, at)?),
                (Token::Close, _) => break,
                (token, at) => return Err(unexpected(token, "a number or \"}\"", at)),
            }
        }
        let (count, dimensions) = (self.tree.values.len() - first, self.tree.rank.dimensions());
        let halvings = count.trailing_zeros() / dimensions;
        if count == 0 || count != 1_usize << (halvings * dimensions) {
            let expected = format!("a power of {}", 1 << dimensions);
            return Err(Mistake::Count { found: count, expected, place: start..start + 1 });
        }
        if depth + halvings > MOST_HALVINGS {
            return Err(too_deep(start));
        }
        Ok(Node::Grid { halvings, first: first as u32 })
    }
}

fn unexpected(token: Token<'_>, expected: &str, at: usize) -> Mistake {
    let (found, length) = match token {
        Token::Open => ("\"{\"".to_owned(), 1),
        Token::Close => ("\"}\"".to_owned(), 1),
        Token::Word(word) => {
            let shown: String = word.chars().take(20).collect();
            (format!("\"{shown}\""), word.len())
        }
        Token::End => ("its end".to_owned(), 0),
    };
    Mistake::Tree { found, expected: expected.to_owned(), place: at..at + length }
}

fn too_deep(at: usize) -> Mistake {
    let found = "more branches within branches".to_owned();
    Mistake::Tree { found, expected: format!("at most {MOST_HALVINGS} halvings"), place: at..at + 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_and_grids_keep_their_places() {
        let branch = "{ {1} {2}, {3} {4} {5} {6} {7} {8 8 8 8, 8 8 8 9} }";
        let tree = read_tree(branch, Rank::Isotropic).unwrap();
        // Bit 0 of a branch is the first dimension; in a grid the first dimension varies slowest.
        assert_eq!(tree.leaf(&[0.7, 0.1, 0.1, 0.0]).value, 2.0);
        assert_eq!(tree.leaf(&[0.1, 0.1, 0.7, 0.0]).value, 5.0);
        assert_eq!(tree.leaf(&[0.8, 0.8, 0.8, 0.0]).value, 9.0);
        assert_eq!(tree.leaf(&[0.8, 0.8, 0.8, 0.0]).halvings, 2);
        let grid = read_tree("{ 1 2 3 4 5 6 7 -8 }", Rank::Isotropic).unwrap();
        assert_eq!(grid.leaf(&[0.1, 0.1, 0.7, 0.0]).value, 2.0);
        assert_eq!(grid.leaf(&[0.7, 0.1, 0.1, 0.0]).value, 5.0);
        assert_eq!(grid.leaf(&[0.7, 0.7, 0.7, 0.0]).value, 0.0);
    }

    #[test]
    fn mistakes_say_what_was_expected() {
        let deep = "{".repeat(100);
        for (text, expected) in [
            ("", "the tensor tree has its end, expected \"{\""),
            ("{1} 2", "the tensor tree has \"2\", expected nothing after its last \"}\""),
            ("{1 2 3}", "the scattering data hold 3 numbers, expected a power of 8"),
            ("{}", "the scattering data hold 0 numbers, expected a power of 8"),
            ("{1 x}", "a scattering value is \"x\", expected a finite number"),
            ("{{1}{1}}", "the tensor tree has \"}\", expected \"{\""),
            ("{1e99}", "a scattering value is \"1e99\", expected a finite number"),
            (&deep, "the tensor tree has more branches within branches, expected at most 15 halvings"),
        ] {
            assert_eq!(read_tree(text, Rank::Isotropic).unwrap_err().to_string(), expected, "{text}");
        }
    }
}
