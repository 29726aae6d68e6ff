//! Expressions as a graph with shared common subexpressions and folded constants.
//!
//! The fast machine's code is generated from this graph. It may compute parts in another order than
//! Radiance, or parts that Radiance would skip: after any fault the exact machine repeats the whole
//! evaluation. A node need not model the effect of a fault; a fault must only never go unnoticed.
//! Built-in functions check their values. A function that only passes a value on (`if`, `select`,
//! `min`, `max`) would turn an infinite value into 0 and a fault. Its value is *tainted* unless it
//! is known to be finite: an operation that could hide an infinite value must check it first.

use crate::builtin::{Builtin, truncated};
use crate::syntax::Operator;
use std::collections::HashMap;

/// A node of the graph. Operands precede their users.
pub(crate) type Value = u32;

/// Deepest graph for which fast code is generated, since generation recurses.
pub(crate) const DEEPEST: u16 = 1000;

/// Operation of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    /// Bits of a number.
    Constant(u64),
    Channel(u32),
    /// Argument given by the host, from 0.
    Argument(u16),
    /// A real argument, from 0, that each program of a [`Family`](crate::Family) has its own value of.
    Late(u16),
    Negate(Value),
    Absolute(Value),
    Binary(Operator, Value, Value),
    /// The second if it is smaller, otherwise the first.
    Least(Value, Value),
    Greatest(Value, Value),
    /// A built-in function of one argument.
    Function(Builtin, Value),
    /// A built-in function of two arguments.
    Function2(Builtin, Value, Value),
    /// A noise function.
    Noise(Builtin, [Value; 3]),
    /// A value that a built-in function passes on.
    Guarded(Value),
    /// The second if the first is positive, otherwise the third; only that one is computed.
    If(Value, Value, Value),
    /// An entry of [`Graph::tables`], selected by an index rounded half up.
    Table(Value, u32),
    /// A host function; its arguments are an entry of [`Graph::lists`].
    Host(u16, u32),
    /// Always a fault.
    Fault,
}

/// A test, as a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Test {
    Positive(Value),
    Negative(Value),
    /// The first is greater than the second.
    Greater(Value, Value),
    /// The value is above the number.
    Above(Value, f64),
    Below(Value, f64),
}

/// A graph of values.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
    facts: Vec<Facts>,
    index: HashMap<Node, Value>,
    pub(crate) tables: Vec<Box<[f64]>>,
    pub(crate) lists: Vec<Box<[Value]>>,
    /// Late arguments whose values the graph depends on: it holds for these values alone. Values
    /// computed from them are faults here.
    pub(crate) decisive: Vec<u16>,
}

/// Properties of a value.
#[derive(Clone, Copy, Debug)]
struct Facts {
    /// The value is finite, or its computation has faulted.
    finite: bool,
    /// The value may be one that should have been replaced by 0, with a fault.
    tainted: bool,
    depth: u16,
}

impl Graph {
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn node(&self, value: Value) -> Node {
        self.nodes[value as usize]
    }

    pub(crate) fn constant(&mut self, number: f64) -> Value {
        self.insert(Node::Constant(number.to_bits()))
    }

    /// The number, if the value is constant.
    pub(crate) fn as_constant(&self, value: Value) -> Option<f64> {
        match self.node(value) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Notes that the graph depends on the values of those operands that are late, if all of them
    /// are late or constant.
    fn decided_by_all(&mut self, operands: &[Value]) -> bool {
        let is_fixed = |value: &Value| matches!(self.node(*value), Node::Constant(_) | Node::Late(_));
        if !operands.iter().all(is_fixed) {
            return false;
        }
        let decided_before = self.decisive.len();
        for operand in operands {
            self.decided_by(*operand);
        }
        self.decisive.len() > decided_before
    }

    /// Whether the value is late; notes that the graph depends on it.
    pub(crate) fn decided_by(&mut self, value: Value) -> bool {
        let Node::Late(index) = self.node(value) else { return false };
        self.decisive.push(index);
        true
    }

    /// Whether the value is finite unless a fault was noticed.
    pub(crate) fn is_finite(&self, value: Value) -> bool {
        self.facts[value as usize].finite
    }

    /// Whether the value must be checked before an operation hides that it is not finite.
    pub(crate) fn is_tainted(&self, value: Value) -> bool {
        self.facts[value as usize].tainted
    }

    pub(crate) fn depth(&self, value: Value) -> u16 {
        self.facts[value as usize].depth
    }

    /// Operands of a node, used always or sometimes.
    pub(crate) fn operands(&self, node: Node, mut each: impl FnMut(Value)) {
        match node {
            Node::Constant(_) | Node::Channel(_) | Node::Argument(_) | Node::Late(_) | Node::Fault => {}
            Node::Negate(a) | Node::Absolute(a) | Node::Function(_, a) | Node::Guarded(a) | Node::Table(a, _) => {
                each(a)
            }
            Node::Binary(_, a, b) | Node::Least(a, b) | Node::Greatest(a, b) | Node::Function2(_, a, b) => {
                each(a);
                each(b);
            }
            Node::Noise(_, [a, b, c]) | Node::If(a, b, c) => {
                each(a);
                each(b);
                each(c);
            }
            Node::Host(_, list) => self.lists[list as usize].iter().for_each(|&value| each(value)),
        }
    }

    pub(crate) fn channel(&mut self, channel: u32) -> Value {
        self.insert(Node::Channel(channel))
    }

    pub(crate) fn argument(&mut self, index: u16) -> Value {
        self.insert(Node::Argument(index))
    }

    pub(crate) fn late(&mut self, index: u16) -> Value {
        self.insert(Node::Late(index))
    }

    pub(crate) fn fault(&mut self) -> Value {
        self.insert(Node::Fault)
    }

    pub(crate) fn negate(&mut self, value: Value) -> Value {
        if self.decided_by(value) {
            return self.fault();
        }
        match self.node(value) {
            Node::Constant(bits) => self.constant(-f64::from_bits(bits)),
            Node::Negate(inner) => inner,
            _ => self.insert(Node::Negate(value)),
        }
    }

    pub(crate) fn binary(&mut self, operator: Operator, left: Value, right: Value) -> Value {
        // A division by a constant becomes a product, which rounds differently.
        let by_one = match operator {
            Operator::Divide => self.decided_by(right),
            Operator::Power => self.decided_by(left) | self.decided_by(right),
            Operator::Add | Operator::Subtract | Operator::Multiply => false,
        };
        if by_one || self.decided_by_all(&[left, right]) {
            return self.fault();
        }
        match (operator, self.as_constant(left), self.as_constant(right)) {
            (Operator::Divide, _, Some(0.0)) => self.fault(),
            (Operator::Power, _, _) => self.power(left, right),
            (_, Some(a), Some(b)) => self.constant(operator.apply(a, b)),
            // A sum is never a negative zero.
            (Operator::Add, Some(zero), None) | (Operator::Add, None, Some(zero)) if zero == 0.0 => {
                let (value, zero) = (if self.as_constant(left).is_some() { right } else { left }, self.constant(0.0));
                self.insert(Node::Binary(Operator::Add, value, zero))
            }
            (Operator::Multiply | Operator::Divide, None, Some(1.0)) => left,
            (Operator::Multiply, Some(1.0), None) => right,
            (Operator::Divide, None, Some(b)) if (1.0 / b).is_normal() => {
                let reciprocal = self.constant(1.0 / b);
                self.insert(Node::Binary(Operator::Multiply, left, reciprocal))
            }
            _ => self.insert(Node::Binary(operator, left, right)),
        }
    }

    fn power(&mut self, base: Value, exponent: Value) -> Value {
        match (self.as_constant(base), self.as_constant(exponent)) {
            (Some(a), Some(b)) if a.powf(b).is_finite() => self.constant(a.powf(b)),
            (Some(_), Some(_)) => self.fault(),
            (None, Some(1.0)) => self.guarded(base),
            (None, Some(2.0)) => {
                let square = self.insert(Node::Binary(Operator::Multiply, base, base));
                self.guarded(square)
            }
            (None, Some(0.5)) => {
                // The power of a negative zero is a positive zero.
                let (root, zero) = (self.insert(Node::Function(Builtin::Sqrt, base)), self.constant(0.0));
                self.insert(Node::Binary(Operator::Add, root, zero))
            }
            _ => self.insert(Node::Binary(Operator::Power, base, exponent)),
        }
    }

    /// A built-in function that evaluates all its arguments.
    pub(crate) fn function(&mut self, builtin: Builtin, arguments: &[Value]) -> Value {
        if self.decided_by_all(arguments) {
            return self.fault();
        }
        let numbers: Option<Vec<f64>> = arguments.iter().map(|&value| self.as_constant(value)).collect();
        if let Some(numbers) = numbers {
            let value = builtin.apply(&numbers);
            return if value.is_finite() { self.constant(value) } else { self.fault() };
        }
        match *arguments {
            [x] => self.insert(Node::Function(builtin, x)),
            [x, y] => self.insert(Node::Function2(builtin, x, y)),
            [x, y, z] => self.insert(Node::Noise(builtin, [x, y, z])),
            _ => self.fault(),
        }
    }

    /// `min` or `max` of two values, in Radiance's order of comparison.
    pub(crate) fn extreme(&mut self, builtin: Builtin, so_far: Value, next: Value) -> Value {
        if self.decided_by_all(&[so_far, next]) {
            return self.fault();
        }
        let least = builtin == Builtin::Min;
        match (self.as_constant(so_far), self.as_constant(next)) {
            (Some(a), Some(b)) => {
                let next_wins = if least { a > b } else { a < b };
                if next_wins { next } else { so_far }
            }
            _ if least => self.insert(Node::Least(so_far, next)),
            _ => self.insert(Node::Greatest(so_far, next)),
        }
    }

    /// A value that a built-in function passes on.
    pub(crate) fn guarded(&mut self, value: Value) -> Value {
        match self.node(value) {
            Node::Constant(bits) if !f64::from_bits(bits).is_finite() => self.fault(),
            _ if self.is_finite(value) || matches!(self.node(value), Node::Guarded(_)) => value,
            _ => self.insert(Node::Guarded(value)),
        }
    }

    /// `if`. The caller decides a constant test itself and skips the other branch.
    pub(crate) fn choose(&mut self, test: Value, then: Value, otherwise: Value) -> Value {
        match self.branchless(test, then, otherwise) {
            Some(value) => self.guarded(value),
            None => self.insert(Node::If(test, then, otherwise)),
        }
    }

    /// Choices that amount to a minimum, a maximum or an absolute value.
    fn branchless(&mut self, test: Value, then: Value, otherwise: Value) -> Option<Value> {
        if test == then && self.node(otherwise) == Node::Negate(test) {
            return Some(self.insert(Node::Absolute(test)));
        }
        if test == then && self.as_constant(otherwise) == Some(0.0) {
            return Some(self.insert(Node::Greatest(otherwise, test)));
        }
        let (greater, lesser) = match self.test(test) {
            Test::Greater(a, b) => (a, b),
            Test::Above(a, limit) => (a, self.constant(limit)),
            Test::Below(b, limit) => (self.constant(limit), b),
            Test::Negative(_) | Test::Positive(_) => return None,
        };
        if (then, otherwise) == (lesser, greater) {
            return Some(self.insert(Node::Least(greater, lesser)));
        }
        if (then, otherwise) == (greater, lesser) {
            return Some(self.insert(Node::Greatest(lesser, greater)));
        }
        // bound(a,x,b): a if a > x, otherwise the smaller of x and b.
        let lower = self.as_constant(greater).filter(|_| then == greater)?;
        match self.node(otherwise) {
            Node::Least(x, upper) if x == lesser && self.as_constant(upper).is_some_and(|upper| lower <= upper) => {
                Some(self.insert(Node::Greatest(otherwise, greater)))
            }
            Node::Guarded(inner) => self.branchless(test, then, inner),
            _ => None,
        }
    }

    /// The cheapest form of a test.
    pub(crate) fn test(&self, test: Value) -> Test {
        match self.node(test) {
            Node::Negate(a) => Test::Negative(a),
            Node::Binary(operator @ (Operator::Add | Operator::Subtract), a, b) => {
                match (operator, self.as_constant(a), self.as_constant(b)) {
                    (Operator::Subtract, None, Some(b)) => Test::Above(a, b),
                    (Operator::Add, None, Some(b)) => Test::Above(a, -b),
                    (Operator::Add, Some(a), None) => Test::Above(b, -a),
                    (Operator::Subtract, Some(a), None) => Test::Below(b, a),
                    (Operator::Subtract, None, None) => Test::Greater(a, b),
                    _ => Test::Positive(test),
                }
            }
            _ => Test::Positive(test),
        }
    }

    /// Selects one of several numbers; `entries[0]` is the value for index 0.
    pub(crate) fn table(&mut self, index: Value, entries: Box<[f64]>) -> Value {
        if let Some(index) = self.as_constant(index) {
            return match table_entry(&entries, index) {
                Some(entry) => self.constant(entry),
                None => self.fault(),
            };
        }
        let same = |table: &[f64]| table.iter().map(|x| x.to_bits()).eq(entries.iter().map(|x| x.to_bits()));
        let table = self.tables.iter().position(|table| same(table)).unwrap_or_else(|| {
            self.tables.push(entries);
            self.tables.len() - 1
        });
        self.insert(Node::Table(index, table as u32))
    }

    pub(crate) fn host(&mut self, function: u16, arguments: Box<[Value]>) -> Value {
        let list = self.lists.iter().position(|list| *list == arguments).unwrap_or_else(|| {
            self.lists.push(arguments);
            self.lists.len() - 1
        });
        self.insert(Node::Host(function, list as u32))
    }

    fn insert(&mut self, node: Node) -> Value {
        if let Some(&value) = self.index.get(&node) {
            return value;
        }
        let facts = self.facts_of(node);
        let value = Value::try_from(self.nodes.len()).unwrap_or(Value::MAX);
        self.nodes.push(node);
        self.facts.push(facts);
        self.index.insert(node, value);
        value
    }

    fn facts_of(&self, node: Node) -> Facts {
        let mut depth = 0;
        let mut tainted = false;
        self.operands(node, |operand| {
            depth = depth.max(self.depth(operand).saturating_add(1));
            tainted |= self.is_tainted(operand);
        });
        let finite = match node {
            Node::Constant(bits) => f64::from_bits(bits).is_finite(),
            Node::Late(_) => true,
            // Built-in functions, and values from outside, are checked where they are computed.
            Node::Channel(_) | Node::Function(..) | Node::Function2(..) | Node::Noise(..) | Node::Host(..) => true,
            Node::Binary(Operator::Power, ..) | Node::Table(..) => true,
            Node::Argument(_) | Node::Binary(..) | Node::Fault => false,
            Node::Negate(a) | Node::Absolute(a) | Node::Guarded(a) => self.is_finite(a),
            Node::Least(a, b) | Node::Greatest(a, b) | Node::If(_, a, b) => self.is_finite(a) && self.is_finite(b),
        };
        let passes_on = matches!(node, Node::Guarded(_) | Node::If(..) | Node::Fault);
        Facts { finite, tainted: !finite && (tainted || passes_on), depth }
    }
}

/// Value of `select` or `arg` from a table of numbers, if it does not fault.
#[inline]
pub(crate) fn table_entry(entries: &[f64], index: f64) -> Option<f64> {
    let rounded = truncated(index + 0.5);
    if index < -0.5 { None } else { usize::try_from(rounded).ok().and_then(|at| entries.get(at)).copied() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_subexpressions_are_shared() {
        let mut graph = Graph::default();
        let x = graph.channel(1);
        let (a, b) = (graph.binary(Operator::Multiply, x, x), graph.binary(Operator::Multiply, x, x));
        assert_eq!(a, b);
    }

    #[test]
    fn a_bound_between_numbers_needs_no_branch() {
        let mut graph = Graph::default();
        let (x, low, high) = (graph.channel(1), graph.constant(-1.0), graph.constant(1.0));
        let above = graph.binary(Operator::Subtract, x, high);
        let upper = graph.choose(above, high, x);
        let below = graph.binary(Operator::Subtract, low, x);
        let bound = graph.choose(below, low, upper);
        assert_eq!(graph.node(bound), Node::Greatest(upper, low));
        assert_eq!(graph.node(upper), Node::Least(x, high));
    }

    #[test]
    fn a_choice_of_unknown_size_is_tainted_and_a_sine_is_not() {
        let mut graph = Graph::default();
        let x = graph.channel(1);
        let square = graph.binary(Operator::Multiply, x, x);
        let choice = graph.choose(x, square, x);
        let sine = graph.function(Builtin::Sin, &[choice]);
        assert!(!graph.is_tainted(square) && graph.is_tainted(choice) && !graph.is_tainted(sine));
    }
}
