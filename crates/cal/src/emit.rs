//! Generates fast code from a graph and its schedule.

use crate::builtin::Builtin;
use crate::fast::{Chain, Code, Op, Register};
use crate::graph::{Graph, Node, Test, Value};
use crate::schedule::{Form, OUTERMOST, RegionId, Schedule};
use crate::syntax::Operator;

/// First number of the registers of shared values and their code, until the number of the others is
/// known.
const LASTING: Register = 1 << 15;

/// Which of two values is wanted.
#[derive(Clone, Copy)]
enum Extreme {
    Least,
    Greatest,
}

/// The position of a test.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Nesting {
    /// The test of an `if`.
    Outer,
    /// The test is itself chosen by an `if`, which would replace an infinite value by 0 and a
    /// fault.
    Inner,
}

/// A jump target, until its position is known.
type Label = u32;

/// Generates code.
struct Emitter<'g> {
    graph: &'g Graph,
    schedule: Schedule,
    ops: Vec<Op>,
    /// Code of shared values.
    bodies: Vec<(Label, Vec<Op>)>,
    /// Positions of the labels: body (0 is the main code), and step.
    labels: Vec<(usize, usize)>,
    body: usize,
    /// Register of each value that has been computed at the current position.
    registers: Vec<Option<Register>>,
    /// Values to forget at the end of a region.
    computed: Vec<Value>,
    next: u32,
    most: u32,
    next_lasting: u32,
    /// Number, register and label of each shared value.
    shared: Vec<Option<Shared>>,
    count: u32,
    lists: Vec<Register>,
    chains: Vec<Chain>,
    /// Late arguments, in the order of their registers, which are the first ones.
    late: Vec<u16>,
    too_large: bool,
}

#[derive(Clone, Copy)]
struct Shared {
    number: u16,
    register: Register,
    entry: Label,
}

/// Generates the code of `roots`; `None` if it needs too many registers.
pub(crate) fn emit(graph: &Graph, roots: &[Value]) -> Option<Code> {
    let schedule = Schedule::new(graph, roots);
    let mut emitter = Emitter {
        graph,
        schedule,
        ops: Vec::new(),
        bodies: Vec::new(),
        labels: Vec::new(),
        body: 0,
        registers: vec![None; graph.len()],
        computed: Vec::new(),
        next: 0,
        most: 0,
        next_lasting: 0,
        shared: vec![None; graph.len()],
        count: 0,
        lists: Vec::new(),
        chains: Vec::new(),
        late: Vec::new(),
        too_large: false,
    };
    let results = emitter.roots(roots);
    emitter.finish(results)
}

impl Emitter<'_> {
    fn roots(&mut self, roots: &[Value]) -> Vec<Register> {
        self.place_late_arguments();
        self.hoist(OUTERMOST);
        let mut results = Vec::with_capacity(roots.len());
        for &root in roots {
            let register = self.checked(root, OUTERMOST);
            results.push(register);
        }
        self.ops.push(Op::End);
        self.emit_shared(OUTERMOST);
        results
    }

    /// Gives each late argument a register for the whole evaluation.
    fn place_late_arguments(&mut self) {
        for value in 0..self.graph.len() as Value {
            if let Node::Late(index) = self.graph.node(value)
                && self.schedule.is_used(value)
            {
                let register = self.fresh();
                self.registers[value as usize] = Some(register);
                self.late.push(index);
            }
        }
    }

    fn finish(mut self, mut results: Vec<Register>) -> Option<Code> {
        let registers = self.most + self.next_lasting;
        if self.too_large || registers > u32::from(LASTING) || self.count > u32::from(u16::MAX) {
            return None;
        }
        let mut starts = vec![0];
        for (_, body) in &mut self.bodies {
            starts.push(self.ops.len());
            self.ops.append(body);
        }
        let labels: Vec<u32> = self.labels.iter().map(|(body, step)| (starts[*body] + step) as u32).collect();
        let most = self.most as Register;
        for op in &mut self.ops {
            for register in op.registers().into_iter().flatten() {
                if *register >= LASTING {
                    *register = *register - LASTING + most;
                }
            }
            if let Some(target) = op.target() {
                *target = labels[*target as usize];
            }
        }
        for register in results.iter_mut().chain(&mut self.lists) {
            if *register >= LASTING {
                *register = *register - LASTING + most;
            }
        }
        for target in self.chains.iter_mut().flat_map(|chain| &mut chain.targets) {
            *target = labels[*target as usize];
        }
        shorten(&mut self.ops);
        let tables = self.graph.tables.clone();
        let (ops, lists, chains, shared) = (self.ops, self.lists, self.chains, self.count as u16);
        Some(Code { ops, results, tables, lists, chains, late: self.late, shared, registers })
    }

    fn fresh(&mut self) -> Register {
        if self.body == 0 {
            self.next += 1;
            self.most = self.most.max(self.next);
            self.too_large |= self.next >= u32::from(LASTING);
            (self.next - 1).min(u32::from(LASTING) - 1) as Register
        } else {
            self.lasting()
        }
    }

    fn lasting(&mut self) -> Register {
        self.next_lasting += 1;
        self.too_large |= self.next_lasting >= u32::from(LASTING);
        LASTING + (self.next_lasting - 1).min(u32::from(LASTING) - 1) as Register
    }

    fn label(&mut self) -> Label {
        self.labels.push((0, 0));
        self.labels.len() as Label - 1
    }

    fn bind(&mut self, label: Label) {
        self.labels[label as usize] = (self.body, self.ops.len());
    }

    fn record(&mut self, value: Value, register: Register) {
        self.registers[value as usize] = Some(register);
        self.computed.push(value);
    }

    /// Generates `code` in a region of its own, whose registers are free afterwards.
    fn within<T>(&mut self, region: RegionId, code: impl FnOnce(&mut Self) -> T) -> T {
        let (computed, next) = (self.computed.len(), self.next);
        self.hoist(region);
        let result = code(self);
        self.emit_shared(region);
        for value in self.computed.drain(computed..) {
            self.registers[value as usize] = None;
        }
        self.next = next;
        result
    }

    /// At the start of a region: computes values that its branches, and the code they call, rely
    /// on.
    fn hoist(&mut self, region: RegionId) {
        for value in self.schedule.regions[region as usize].hoisted.clone() {
            self.value(value, region);
        }
    }

    /// Code of the shared values that branches of a region call.
    fn emit_shared(&mut self, region: RegionId) {
        for value in self.schedule.regions[region as usize].shared.clone() {
            let Some(shared) = self.shared[value as usize] else { continue };
            let outer_body = std::mem::replace(&mut self.body, self.bodies.len() + 1);
            self.bodies.push((shared.entry, Vec::new()));
            let outer_ops = std::mem::take(&mut self.ops);
            // Values computed by one calling branch are not available to all callers.
            let hidden = self.hide_shared();
            self.bind(shared.entry);
            let own = self.schedule.own_region(value);
            self.within(own, |emitter| {
                emitter.compute(value, shared.register, own);
                emitter.ops.push(Op::Return { shared: shared.number });
            });
            let ops = std::mem::replace(&mut self.ops, outer_ops);
            self.bodies[self.body - 1].1 = ops;
            self.body = outer_body;
            for (value, register) in hidden {
                self.registers[value as usize] = Some(register);
            }
        }
    }

    /// Forgets shared values that may not be computed when shared code runs.
    fn hide_shared(&mut self) -> Vec<(Value, Register)> {
        let mut hidden = Vec::new();
        for &value in &self.computed {
            if self.schedule.form(value) == Form::Shared
                && let Some(register) = self.registers[value as usize].take()
            {
                hidden.push((value, register));
            }
        }
        hidden
    }

    /// Register of a value, which is computed if necessary.
    fn value(&mut self, value: Value, region: RegionId) -> Register {
        if let Some(register) = self.registers[value as usize] {
            return register;
        }
        let register = match (self.graph.node(value), self.schedule.form(value)) {
            (Node::Constant(bits), _) => {
                // The value is not recorded, because shared code could not rely on it.
                let d = self.fresh();
                self.ops.push(Op::Constant { d, value: f64::from_bits(bits) });
                return d;
            }
            (_, Form::Shared) => self.share(value),
            (Node::Guarded(inner), _) => self.value(inner, region),
            _ => {
                let d = self.fresh();
                self.compute(value, d, region);
                d
            }
        };
        self.record(value, register);
        register
    }

    fn share(&mut self, value: Value) -> Register {
        let shared = match self.shared[value as usize] {
            Some(shared) => shared,
            None => {
                let number = self.count.min(u32::from(u16::MAX)) as u16;
                self.count += 1;
                let shared = Shared { number, register: self.lasting(), entry: self.label() };
                self.shared[value as usize] = Some(shared);
                shared
            }
        };
        self.ops.push(Op::Share { shared: shared.number, target: shared.entry });
        shared.register
    }

    /// Register of a value, with a check that it is finite.
    fn checked(&mut self, value: Value, region: RegionId) -> Register {
        let a = self.value(value, region);
        if self.graph.is_tainted(value) {
            self.ops.push(Op::Check { a });
        }
        a
    }

    /// Computes a value into a register.
    fn compute(&mut self, value: Value, d: Register, region: RegionId) {
        let op = match self.graph.node(value) {
            Node::Constant(bits) => Op::Constant { d, value: f64::from_bits(bits) },
            Node::Channel(channel) => Op::Channel { d, channel },
            Node::Argument(index) => Op::Argument { d, index },
            Node::Late(_) => return self.compute_or_move(value, d, region),
            Node::Negate(a) => Op::Negate { d, a: self.value(a, region) },
            Node::Absolute(a) => Op::Absolute { d, a: self.value(a, region) },
            Node::Guarded(inner) => return self.compute_or_move(inner, d, region),
            Node::Binary(operator, a, b) => self.binary(operator, a, b, d, region),
            Node::Least(a, b) => self.extreme([a, b], d, region, Extreme::Least),
            Node::Greatest(a, b) => self.extreme([a, b], d, region, Extreme::Greatest),
            Node::Function(builtin, a) => {
                let a = self.checked(a, region);
                match builtin {
                    Builtin::Sqrt => Op::SquareRoot { d, a },
                    Builtin::Floor => Op::Floor { d, a },
                    _ => Op::Function { d, a, builtin },
                }
            }
            Node::Function2(builtin, a, b) => {
                let (a, b) = (self.checked(a, region), self.checked(b, region));
                Op::Function2 { d, a, b, builtin }
            }
            Node::Noise(builtin, [a, b, c]) => {
                let (a, b, c) = (self.checked(a, region), self.checked(b, region), self.checked(c, region));
                Op::Noise { d, a, b, c, builtin }
            }
            Node::Table(a, table) => Op::Table { d, a: self.checked(a, region), table },
            Node::Host(function, list) => self.host(function, list, d, region),
            Node::If(test, then, otherwise) => {
                let chain = self.chain(value);
                return match chain.tests.len() {
                    ..SHORTEST_CHAIN => self.branches(value, [test, then, otherwise], d, region),
                    _ => self.follow(&chain, d, region),
                };
            }
            Node::Fault => Op::GiveUp,
        };
        self.ops.push(op);
    }

    /// Computes a value into a given register, or copies it there.
    fn compute_or_move(&mut self, value: Value, d: Register, region: RegionId) {
        let elsewhere = self.registers[value as usize].is_some() || self.schedule.form(value) == Form::Shared;
        if elsewhere {
            let a = self.value(value, region);
            self.ops.push(Op::Move { d, a });
        } else {
            self.compute(value, d, region);
            if self.graph.as_constant(value).is_none() {
                self.record(value, d);
            }
        }
    }

    fn binary(&mut self, operator: Operator, a: Value, b: Value, d: Register, region: RegionId) -> Op {
        let (left, right) = (self.graph.as_constant(a), self.graph.as_constant(b));
        match (operator, left, right) {
            (Operator::Add, _, Some(b)) => Op::AddConstant { d, a: self.value(a, region), b },
            (Operator::Add, Some(a), _) => Op::AddConstant { d, a: self.value(b, region), b: a },
            (Operator::Subtract, _, Some(b)) => Op::AddConstant { d, a: self.value(a, region), b: -b },
            (Operator::Subtract, Some(from), _) => Op::SubtractFrom { d, a: self.value(b, region), b: from },
            (Operator::Multiply, _, Some(b)) => Op::MultiplyConstant { d, a: self.value(a, region), b },
            (Operator::Multiply, Some(factor), _) => Op::MultiplyConstant { d, a: self.value(b, region), b: factor },
            (Operator::Divide, Some(dividend), _) => Op::DivideInto { d, a: self.checked(b, region), b: dividend },
            (Operator::Power, _, Some(b)) => Op::PowerConstant { d, a: self.checked(a, region), b },
            _ => {
                let left = if operator == Operator::Power { self.checked(a, region) } else { self.value(a, region) };
                let divisor = matches!(operator, Operator::Divide | Operator::Power);
                let right = if divisor { self.checked(b, region) } else { self.value(b, region) };
                let (a, b) = (left, right);
                match operator {
                    Operator::Add => Op::Add { d, a, b },
                    Operator::Subtract => Op::Subtract { d, a, b },
                    Operator::Multiply => Op::Multiply { d, a, b },
                    Operator::Divide => Op::Divide { d, a, b },
                    Operator::Power => Op::Power { d, a, b },
                }
            }
        }
    }

    fn extreme(&mut self, [a, b]: [Value; 2], d: Register, region: RegionId, extreme: Extreme) -> Op {
        match (self.graph.as_constant(a), self.graph.as_constant(b), extreme) {
            (_, Some(b), Extreme::Least) => Op::LeastConstant { d, a: self.checked(a, region), b },
            (_, Some(b), Extreme::Greatest) => Op::GreatestConstant { d, a: self.checked(a, region), b },
            (Some(first), _, Extreme::Least) => Op::ConstantOrLess { d, a: self.checked(b, region), b: first },
            (Some(first), _, Extreme::Greatest) => Op::ConstantOrGreater { d, a: self.checked(b, region), b: first },
            (None, None, _) => {
                let (a, b) = (self.checked(a, region), self.checked(b, region));
                match extreme {
                    Extreme::Least => Op::Least { d, a, b },
                    Extreme::Greatest => Op::Greatest { d, a, b },
                }
            }
        }
    }

    fn host(&mut self, function: u16, list: u32, d: Register, region: RegionId) -> Op {
        let values = self.graph.lists[list as usize].clone();
        let registers: Vec<Register> = values.iter().map(|&value| self.checked(value, region)).collect();
        let first = self.lists.len() as u32;
        self.lists.extend(&registers);
        Op::Host { d, function, first, count: registers.len() as u16 }
    }

    fn branches(&mut self, value: Value, parts: [Value; 3], d: Register, region: RegionId) {
        let [test, then, otherwise] = parts;
        let [then_region, else_region] = self.schedule.branches(value);
        let (else_label, end) = (self.label(), self.label());
        self.jump_unless(test, else_label, region, Nesting::Outer);
        self.within(then_region, |emitter| emitter.compute_or_move(then, d, then_region));
        self.ops.push(Op::Jump { target: end });
        self.bind(else_label);
        self.within(else_region, |emitter| emitter.compute_or_move(otherwise, d, else_region));
        self.bind(end);
    }

    /// Tests of one value against numbers, which begin with `value` and continue where each fails.
    fn chain(&self, value: Value) -> Tests {
        let mut tests = Tests { subject: value, above: true, tests: Vec::new(), otherwise: value };
        let mut next = value;
        while let Node::If(test, then, otherwise) = self.graph.node(next)
            && let Some((subject, above, limit)) = self.against_number(test)
        {
            let follows = match tests.tests.last() {
                None => true,
                Some((_, before)) => {
                    let ordered = if above { limit < *before } else { limit > *before };
                    ordered && (subject, above) == (tests.subject, tests.above) && self.schedule.is_used_once(next)
                }
            };
            if !follows {
                break;
            }
            (tests.subject, tests.above, tests.otherwise) = (subject, above, otherwise);
            tests.tests.push(((next, then), limit));
            if !self.schedule.is_plain(self.schedule.branches(next)[1]) {
                break;
            }
            next = otherwise;
        }
        tests
    }

    /// A test of the form "this value above (or below) that number".
    fn against_number(&self, test: Value) -> Option<(Value, bool, f64)> {
        match self.graph.test(test) {
            Test::Above(x, limit) => Some((x, true, limit)),
            Test::Below(x, limit) => Some((x, false, limit)),
            _ => None,
        }
    }

    fn follow(&mut self, chain: &Tests, d: Register, region: RegionId) {
        let a = self.tested(chain.subject, region, Nesting::Outer);
        let number = self.chains.len();
        self.ops.push(Op::Chain { a, chain: number as u32 });
        let limits = chain.tests.iter().map(|(_, limit)| *limit).collect();
        let targets: Box<[Label]> = (0..=chain.tests.len()).map(|_| self.label()).collect();
        self.chains.push(Chain { above: chain.above, limits, targets: targets.clone() });
        let end = self.label();
        for (((choice, then), _), target) in chain.tests.iter().zip(&targets) {
            let inside = self.schedule.branches(*choice)[0];
            self.bind(*target);
            self.within(inside, |emitter| emitter.compute_or_move(*then, d, inside));
            self.ops.push(Op::Jump { target: end });
        }
        let Some((((last, _), _), target)) = chain.tests.last().zip(targets.last()) else { return };
        let inside = self.schedule.branches(*last)[1];
        self.bind(*target);
        self.within(inside, |emitter| emitter.compute_or_move(chain.otherwise, d, inside));
        self.bind(end);
    }

    /// Jumps unless the test is positive.
    fn jump_unless(&mut self, test: Value, target: Label, region: RegionId, nesting: Nesting) {
        match self.condition(test, region, nesting) {
            Condition::Constant(true) => {}
            Condition::Constant(false) => self.ops.push(Op::Jump { target }),
            Condition::Choice(parts) => self.jump_unless_choice(test, parts, target, region),
            Condition::Positive(a) => self.ops.push(Op::JumpUnlessPositive { a, target }),
            Condition::Negative(a) => self.ops.push(Op::JumpUnlessNegative { a, target }),
            Condition::Greater(a, b) => self.ops.push(Op::JumpUnlessGreater { a, b, target }),
            Condition::Above(a, b) => self.ops.push(Op::JumpUnlessAbove { a, b, target }),
            Condition::Below(a, b) => self.ops.push(Op::JumpUnlessBelow { a, b, target }),
        }
    }

    /// Jumps if the test is positive.
    fn jump_if(&mut self, test: Value, target: Label, region: RegionId, nesting: Nesting) {
        match self.condition(test, region, nesting) {
            Condition::Constant(true) => self.ops.push(Op::Jump { target }),
            Condition::Constant(false) => {}
            Condition::Choice(parts) => {
                let end = self.label();
                self.jump_unless_choice(test, parts, end, region);
                self.ops.push(Op::Jump { target });
                self.bind(end);
            }
            Condition::Positive(a) => self.ops.push(Op::JumpIfPositive { a, target }),
            Condition::Negative(a) => self.ops.push(Op::JumpIfNegative { a, target }),
            Condition::Greater(a, b) => self.ops.push(Op::JumpIfGreater { a, b, target }),
            Condition::Above(a, b) => self.ops.push(Op::JumpIfAbove { a, b, target }),
            Condition::Below(a, b) => self.ops.push(Op::JumpIfBelow { a, b, target }),
        }
    }

    /// Jumps unless a choice between tests is positive: `and`, `or`, `not` and similar functions
    /// become jumps alone.
    fn jump_unless_choice(&mut self, test: Value, parts: [Value; 3], target: Label, region: RegionId) {
        let [first, then, otherwise] = parts;
        let [then_region, else_region] = self.schedule.branches(test);
        let is_true = |emitter: &Self, value| emitter.graph.as_constant(value).map(|number| number > 0.0);
        if otherwise == first || is_true(self, otherwise) == Some(false) {
            self.jump_unless(first, target, region, Nesting::Outer);
            self.within(then_region, |emitter| emitter.jump_unless(then, target, then_region, Nesting::Inner));
        } else if then == first || is_true(self, then) == Some(true) {
            let end = self.label();
            self.jump_if(first, end, region, Nesting::Outer);
            self.within(else_region, |emitter| emitter.jump_unless(otherwise, target, else_region, Nesting::Inner));
            self.bind(end);
        } else {
            let (else_label, end) = (self.label(), self.label());
            self.jump_unless(first, else_label, region, Nesting::Outer);
            self.within(then_region, |emitter| emitter.jump_unless(then, target, then_region, Nesting::Inner));
            self.ops.push(Op::Jump { target: end });
            self.bind(else_label);
            self.within(else_region, |emitter| emitter.jump_unless(otherwise, target, else_region, Nesting::Inner));
            self.bind(end);
        }
    }

    fn tested(&mut self, test: Value, region: RegionId, nesting: Nesting) -> Register {
        let a = self.value(test, region);
        if self.graph.is_tainted(test) || (nesting == Nesting::Inner && !self.graph.is_finite(test)) {
            self.ops.push(Op::Check { a });
        }
        a
    }

    /// Condition of a test, after computing its operands.
    fn condition(&mut self, test: Value, region: RegionId, nesting: Nesting) -> Condition {
        match self.graph.test(test) {
            Test::Positive(_) => match self.graph.node(test) {
                Node::Constant(bits) => Condition::Constant(f64::from_bits(bits) > 0.0),
                Node::If(first, then, otherwise) if self.schedule.form(test) == Form::Jump => {
                    Condition::Choice([first, then, otherwise])
                }
                _ => Condition::Positive(self.tested(test, region, nesting)),
            },
            Test::Negative(a) => Condition::Negative(self.tested(a, region, nesting)),
            Test::Above(x, limit) => Condition::Above(self.tested(x, region, nesting), limit),
            Test::Below(x, limit) => Condition::Below(self.tested(x, region, nesting), limit),
            Test::Greater(a, b) => {
                let a = self.tested(a, region, nesting);
                Condition::Greater(a, self.tested(b, region, nesting))
            }
        }
    }
}

/// Number of tests from which a chain is decided in one step.
const SHORTEST_CHAIN: usize = 4;

/// A chain of tests: the `if` with the value it chooses, and the number tested against.
struct Tests {
    subject: Value,
    above: bool,
    tests: Vec<((Value, Value), f64)>,
    otherwise: Value,
}

/// Condition of a jump.
enum Condition {
    Constant(bool),
    Choice([Value; 3]),
    Positive(Register),
    Negative(Register),
    Greater(Register, Register),
    /// The register is above the number.
    Above(Register, f64),
    Below(Register, f64),
}

/// Redirects jumps to jumps to their final targets.
fn shorten(ops: &mut [Op]) {
    for at in 0..ops.len() {
        let mut op = ops[at];
        let Some(target) = op.target() else { continue };
        while let Some(Op::Jump { target: further }) = ops.get(*target as usize)
            && *further > *target
        {
            *target = *further;
        }
        let ends = matches!(op, Op::Jump { target } if ops.get(target as usize) == Some(&Op::End));
        ops[at] = if ends { Op::End } else { op };
    }
}
