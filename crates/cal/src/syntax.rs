//! Parser of expressions, with the constant folding that Radiance does while reading.
//!
//! The grammar, by ascending precedence: sums and differences; products and quotients; powers, from
//! the right; one sign; then numbers, names, calls, channels and parentheses. A sign binds more
//! tightly than a power: `-2^2` is 4.

use crate::lexer::{Lexer, SCOPE_MARK, Token};
use crate::names::SymbolId;
use radsight_diag::{Diagnostic, SourceId, Span};

/// Maximum nesting of parentheses and calls.
pub(crate) const DEEPEST: usize = 1000;

/// Index of an expression in a [`Body`].
pub(crate) type Node = u32;

/// An operator between two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Operator {
    fn of(mark: u8) -> Option<(Operator, u8)> {
        Some(match mark {
            b'+' => (Operator::Add, 1),
            b'-' => (Operator::Subtract, 1),
            b'*' => (Operator::Multiply, 2),
            b'/' => (Operator::Divide, 2),
            b'^' => (Operator::Power, 3),
            _ => return None,
        })
    }

    /// Arithmetic value; the caller handles division by zero and illegal powers.
    #[inline]
    pub(crate) fn apply(self, left: f64, right: f64) -> f64 {
        match self {
            // Radiance adds to zero, so a sum is never a negative zero.
            Operator::Add => 0.0 + left + right,
            Operator::Subtract => left - right,
            Operator::Multiply => left * right,
            Operator::Divide => left / right,
            Operator::Power => left.powf(right),
        }
    }
}

/// Target of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Callee {
    /// A function by its name.
    Symbol(SymbolId),
    /// A function passed as argument of the enclosing function, from 0.
    Parameter(u16),
}

/// One expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Expr {
    Number(f64),
    /// `$n`.
    Channel(u32),
    /// Argument of the enclosing function, from 0.
    Parameter(u16),
    Variable(SymbolId),
    /// The arguments are `count` entries of [`Body::arguments`] from `first`.
    Call {
        callee: Callee,
        first: u32,
        count: u16,
    },
    Negate(Node),
    Binary(Operator, Node, Node),
}

/// An expression with all its subexpressions, which precede it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Body {
    pub(crate) source: Option<SourceId>,
    nodes: Vec<Expr>,
    ranges: Vec<(u32, u32)>,
    arguments: Vec<Node>,
    pub(crate) root: Node,
}

impl Body {
    pub(crate) fn expr(&self, node: Node) -> Expr {
        self.nodes[node as usize]
    }

    pub(crate) fn arguments(&self, first: u32, count: u16) -> &[Node] {
        &self.arguments[first as usize..first as usize + usize::from(count)]
    }

    /// Position of the expression, if the text came from a file.
    pub(crate) fn span(&self, node: Node) -> Option<Span> {
        let (start, end) = self.ranges[node as usize];
        self.source.map(|source| Span { source, start, end })
    }

    /// A body that is one number.
    pub(crate) fn number(value: f64) -> Body {
        Body::of(Expr::Number(value))
    }

    /// A body that is one channel.
    pub(crate) fn channel(channel: u32) -> Body {
        Body::of(Expr::Channel(channel))
    }

    /// A body that is one variable.
    pub(crate) fn variable(symbol: SymbolId) -> Body {
        Body::of(Expr::Variable(symbol))
    }

    fn of(expr: Expr) -> Body {
        Body { nodes: vec![expr], ranges: vec![(0, 0)], ..Body::default() }
    }

    /// The channel, if the whole body is one.
    pub(crate) fn as_channel(&self) -> Option<u32> {
        match self.expr(self.root) {
            Expr::Channel(channel) => Some(channel),
            _ => None,
        }
    }

    /// The value, if the whole body is one number.
    pub(crate) fn as_number(&self) -> Option<f64> {
        match self.expr(self.root) {
            Expr::Number(value) => Some(value),
            _ => None,
        }
    }

    /// All expressions, used or not.
    pub(crate) fn exprs(&self) -> &[Expr] {
        &self.nodes
    }

    /// Whether both are the same expression.
    pub(crate) fn same_as(&self, other: &Body) -> bool {
        // Bodies are built in a fixed order, so equal texts give equal lists.
        self.nodes == other.nodes && self.arguments == other.arguments && self.root == other.root
    }

    fn add(&mut self, expr: Expr, range: (u32, u32)) -> Node {
        self.nodes.push(expr);
        self.ranges.push(range);
        Node::try_from(self.nodes.len() - 1).unwrap_or(Node::MAX)
    }
}

/// Resolution of names for the parser.
pub(crate) trait Names {
    /// Symbol of a name.
    fn resolve(&mut self, name: &str) -> Result<SymbolId, Diagnostic>;
    /// Value of a variable or call, if it is constant.
    fn fold(&mut self, body: &Body, node: Node) -> Result<Option<f64>, Diagnostic>;
}

/// A parser of expressions.
pub(crate) struct Reader<'t, 'n, N> {
    pub(crate) lexer: Lexer<'t>,
    pub(crate) names: &'n mut N,
    /// Names of the enclosing function's arguments.
    pub(crate) parameters: Vec<&'t str>,
    body: Body,
    source: Option<SourceId>,
}

type Read<T> = Result<T, Diagnostic>;

impl<'t, 'n, N: Names> Reader<'t, 'n, N> {
    /// Starts on a text whose first byte is at `base` of `source`.
    pub(crate) fn new(text: &'t [u8], source: Option<SourceId>, base: u32, names: &'n mut N) -> Read<Self> {
        let lexer = Lexer::new(text, source, base)?;
        Ok(Reader { lexer, names, parameters: Vec::new(), body: Body::default(), source })
    }

    /// Parses the next expression, up to a token that cannot belong to it.
    pub(crate) fn body(&mut self) -> Read<Body> {
        self.body = Body { source: self.source, ..Body::default() };
        let root = self.expression(1, 0)?;
        let mut body = std::mem::take(&mut self.body);
        body.root = root;
        Ok(body)
    }

    fn expression(&mut self, lowest: u8, depth: usize) -> Read<Node> {
        let start = self.lexer.token_start();
        let mut left = self.signed(depth)?;
        while let Token::Mark(mark) = self.lexer.token
            && let Some((operator, level)) = Operator::of(mark)
            && level >= lowest
        {
            self.lexer.advance()?;
            let deeper = if operator == Operator::Power { 3 } else { level + 1 };
            let right = self.expression(deeper, depth + 1)?;
            left = self.combine(operator, left, right, start)?;
        }
        Ok(left)
    }

    fn signed(&mut self, depth: usize) -> Read<Node> {
        if depth > DEEPEST {
            let (start, end) = (self.lexer.token_start(), self.lexer.token_end());
            return Err(self.lexer.error(format!("expression is nested more than {DEEPEST} deep"), start, end));
        }
        let start = self.lexer.token_start();
        let negative = self.lexer.take(b'-')?;
        if !negative {
            self.lexer.take(b'+')?;
        }
        let inner = self.primary(depth)?;
        if !negative {
            return Ok(inner);
        }
        Ok(match self.body.expr(inner) {
            Expr::Number(value) => self.node(Expr::Number(-value), start),
            Expr::Negate(positive) => positive,
            _ => self.node(Expr::Negate(inner), start),
        })
    }

    fn primary(&mut self, depth: usize) -> Read<Node> {
        let start = self.lexer.token_start();
        match self.lexer.token {
            Token::Mark(b'(') => {
                self.lexer.advance()?;
                let inner = self.expression(1, depth + 1)?;
                self.lexer.expect(b')')?;
                Ok(inner)
            }
            Token::Mark(b'$') => {
                let channel = self.channel()?;
                Ok(self.node(Expr::Channel(channel), start))
            }
            Token::Number(value) => {
                self.lexer.advance()?;
                Ok(self.node(Expr::Number(value), start))
            }
            Token::Name(name) => {
                self.lexer.advance()?;
                self.named(name, start, depth)
            }
            _ => Err(self.lexer.unexpected("an expression")),
        }
    }

    /// `$n`; the next token is the `$`.
    pub(crate) fn channel(&mut self) -> Read<u32> {
        let start = self.lexer.token_start();
        self.lexer.advance()?;
        let end = self.lexer.token_end();
        match self.lexer.token {
            Token::Number(value) if self.lexer.is_digits() && (1.0..=f64::from(u32::MAX)).contains(&value) => {
                self.lexer.advance()?;
                Ok(value as u32)
            }
            _ => Err(self.lexer.error("illegal channel number", start, end).hint("channels are $1, $2, and so on")),
        }
    }

    fn named(&mut self, name: &'t str, start: usize, depth: usize) -> Read<Node> {
        let parameter = self.parameters.iter().position(|parameter| *parameter == name);
        let parameter = parameter.and_then(|index| u16::try_from(index).ok());
        let callee = match parameter {
            Some(index) => Callee::Parameter(index),
            None => Callee::Symbol(self.names.resolve(name).map_err(|diagnostic| self.at(diagnostic, start))?),
        };
        let expr = if self.lexer.token == Token::Mark(b'(') {
            let (first, count) = self.call_arguments(depth)?;
            Expr::Call { callee, first, count }
        } else {
            match callee {
                Callee::Parameter(index) => Expr::Parameter(index),
                Callee::Symbol(symbol) => Expr::Variable(symbol),
            }
        };
        let node = self.node(expr, start);
        match self.names.fold(&self.body, node).map_err(|diagnostic| self.at(diagnostic, start))? {
            Some(value) => Ok(self.node(Expr::Number(value), start)),
            None => Ok(node),
        }
    }

    fn call_arguments(&mut self, depth: usize) -> Read<(u32, u16)> {
        let open = self.lexer.token_start();
        let mut nodes = Vec::new();
        loop {
            self.lexer.advance()?;
            nodes.push(self.expression(1, depth + 1)?);
            if self.lexer.token != Token::Mark(b',') {
                break;
            }
        }
        self.lexer.expect(b')')?;
        let too_many = |_| self.lexer.error("call has too many arguments", open, self.lexer.passed_end());
        let count = u16::try_from(nodes.len()).map_err(too_many)?;
        let first = u32::try_from(self.body.arguments.len()).map_err(too_many)?;
        self.body.arguments.extend(nodes);
        Ok((first, count))
    }

    fn combine(&mut self, operator: Operator, left: Node, right: Node, start: usize) -> Read<Node> {
        let as_number = |body: &Body, node| match body.expr(node) {
            Expr::Number(value) => Some(value),
            _ => None,
        };
        let (a, b) = (as_number(&self.body, left), as_number(&self.body, right));
        let folded = match (operator, a, b) {
            (Operator::Divide, _, Some(0.0)) => return Err(self.fault("division by the constant zero", start)),
            (Operator::Power, Some(a), Some(b)) if !a.powf(b).is_finite() => {
                return Err(self.fault("illegal power of constants", start));
            }
            (_, Some(a), Some(b)) => Some(operator.apply(a, b)),
            // The zero keeps its sign.
            (Operator::Multiply, _, Some(zero)) if zero == 0.0 => Some(zero),
            (Operator::Multiply | Operator::Divide | Operator::Power, Some(zero), _) if zero == 0.0 => Some(zero),
            (Operator::Power, _, Some(0.0)) | (Operator::Power, Some(1.0), _) => Some(1.0),
            (Operator::Power, None, Some(1.0)) => return Ok(left),
            _ => None,
        };
        if let Some(value) = folded {
            return Ok(self.node(Expr::Number(value), start));
        }
        let (operator, right) = match (operator, b) {
            (Operator::Divide, Some(b)) => (Operator::Multiply, self.node(Expr::Number(1.0 / b), start)),
            // Radiance adds the negative, which differs from subtraction in the sign of a zero.
            (Operator::Subtract, Some(b)) => (Operator::Add, self.node(Expr::Number(-b), start)),
            _ => (operator, right),
        };
        Ok(self.node(Expr::Binary(operator, left, right), start))
    }

    fn node(&mut self, expr: Expr, start: usize) -> Node {
        let end = self.lexer.passed_end();
        let range = self.lexer.place(start, end).map_or((0, 0), |span| (span.start, span.end));
        self.body.add(expr, range)
    }

    fn fault(&self, message: &str, start: usize) -> Diagnostic {
        self.lexer.error(message, start, self.lexer.passed_end())
    }

    fn at(&self, diagnostic: Diagnostic, start: usize) -> Diagnostic {
        if diagnostic.span.is_some() {
            return diagnostic;
        }
        self.lexer.place(start, self.lexer.passed_end()).into_iter().fold(diagnostic, Diagnostic::at)
    }
}

/// Whether a name is valid for an argument: it has no scope mark.
pub(crate) fn is_parameter_name(name: &str) -> bool {
    !name.as_bytes().contains(&SCOPE_MARK)
}
