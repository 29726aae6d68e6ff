//! Schedule: the region in which each value of a graph is computed.
//!
//! Code consists of regions: the root region, in it the two branches of each `if`, and so on. A
//! value that a region certainly needs is computed there, once. A value needed only in some
//! branches of a region is computed before them if that is cheap; otherwise it gets code of its
//! own, which the branches call and which runs at most once per evaluation.

use crate::builtin::Builtin;
use crate::graph::{Graph, Node, Test, Value};
use crate::syntax::Operator;

/// A part of the code that runs as a whole, except for the branches in it.
pub(crate) type RegionId = u32;

/// The outermost region.
pub(crate) const OUTERMOST: RegionId = 0;

/// Maximum cost of a value that may be unused, in additions.
const CHEAP: u32 = 6;

#[derive(Clone, Debug, Default)]
pub(crate) struct Region {
    parent: RegionId,
    depth: u32,
    /// Values computed at the start of the region for its branches, operands first.
    pub(crate) hoisted: Vec<Value>,
    /// Values with code of their own that branches of this region call.
    pub(crate) shared: Vec<Value>,
}

/// How a value is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Form {
    /// Into a register, in its region.
    #[default]
    Register,
    /// Not at all: it is a choice between tests, which becomes jumps.
    Jump,
    /// Into a register, by code of its own.
    Shared,
}

/// Schedule of a program.
#[derive(Debug)]
pub(crate) struct Schedule {
    pub(crate) regions: Vec<Region>,
    places: Vec<Place>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Place {
    /// Innermost region that contains all uses so far.
    common: RegionId,
    /// Outermost region of a use so far.
    outermost: RegionId,
    uses: u32,
    tests: u32,
    cost: u32,
    form: Form,
    branches: [RegionId; 2],
}

impl Schedule {
    /// Schedules the code that computes `roots`.
    pub(crate) fn new(graph: &Graph, roots: &[Value]) -> Schedule {
        let mut schedule = Schedule { regions: vec![Region::default()], places: vec![Place::default(); graph.len()] };
        for value in 0..graph.len() as Value {
            schedule.places[value as usize].cost = schedule.cost(graph, value);
        }
        for &root in roots {
            schedule.used(root, OUTERMOST);
        }
        for value in (0..graph.len() as Value).rev() {
            if schedule.places[value as usize].uses > 0 {
                schedule.place(graph, value);
            }
        }
        for region in &mut schedule.regions {
            region.hoisted.reverse();
        }
        schedule
    }

    pub(crate) fn form(&self, value: Value) -> Form {
        self.places[value as usize].form
    }

    /// Regions of the two branches of an `if`.
    pub(crate) fn branches(&self, value: Value) -> [RegionId; 2] {
        self.places[value as usize].branches
    }

    /// Region of a shared value's code.
    pub(crate) fn own_region(&self, value: Value) -> RegionId {
        self.places[value as usize].common
    }

    fn cost(&self, graph: &Graph, value: Value) -> u32 {
        let node = graph.node(value);
        let own = match node {
            Node::Constant(_) | Node::Late(_) | Node::Guarded(_) | Node::Argument(_) => 0,
            Node::Channel(_) | Node::Table(..) => 3,
            // Before a branch it would end every evaluation.
            Node::Fault => CHEAP + 1,
            Node::Binary(Operator::Divide, ..) => 4,
            Node::Binary(Operator::Power, ..) | Node::Noise(..) | Node::Host(..) | Node::Function2(..) => 50,
            Node::Function(Builtin::Sqrt | Builtin::Floor | Builtin::Ceil, _) => 4,
            Node::Function(..) => 15,
            _ => 1,
        };
        let mut cost: u32 = own;
        graph.operands(node, |operand| cost = cost.saturating_add(self.places[operand as usize].cost));
        cost
    }

    fn new_region(&mut self, parent: RegionId) -> RegionId {
        let depth = self.regions[parent as usize].depth + 1;
        self.regions.push(Region { parent, depth, ..Region::default() });
        self.regions.len() as RegionId - 1
    }

    fn depth(&self, region: RegionId) -> u32 {
        self.regions[region as usize].depth
    }

    /// Innermost region that contains both.
    fn common(&self, mut a: RegionId, mut b: RegionId) -> RegionId {
        while a != b {
            if self.depth(a) >= self.depth(b) {
                a = self.regions[a as usize].parent;
            } else {
                b = self.regions[b as usize].parent;
            }
        }
        a
    }

    /// Records the use of a value as a test, of which only the sign matters: instead of a
    /// difference or negation its operands are compared.
    fn tested(&mut self, graph: &Graph, test: Value, region: RegionId) {
        match graph.test(test) {
            Test::Positive(_) => {
                self.used(test, region);
                self.places[test as usize].tests += 1;
            }
            Test::Negative(a) | Test::Above(a, _) | Test::Below(a, _) => self.used(a, region),
            Test::Greater(a, b) => {
                self.used(a, region);
                self.used(b, region);
            }
        }
    }

    fn used(&mut self, value: Value, region: RegionId) {
        let place = self.places[value as usize];
        let (common, outermost) = if place.uses == 0 {
            (region, region)
        } else {
            let nearer = self.depth(region) < self.depth(place.outermost);
            (self.common(place.common, region), if nearer { region } else { place.outermost })
        };
        let place = &mut self.places[value as usize];
        (place.common, place.outermost) = (common, outermost);
        place.uses += 1;
    }

    /// Schedules a value, all of whose uses are known, and records the uses of its operands.
    fn place(&mut self, graph: &Graph, value: Value) {
        let place = self.places[value as usize];
        let node = graph.node(value);
        if matches!(node, Node::Constant(_) | Node::Late(_)) {
            return;
        }
        let certain = place.outermost == place.common;
        let mut region = place.common;
        if place.uses == 1 && place.tests == 1 && matches!(node, Node::If(..)) {
            self.places[value as usize].form = Form::Jump;
        } else if !certain && place.cost > CHEAP {
            self.regions[region as usize].shared.push(value);
            region = self.new_region(region);
            self.places[value as usize].form = Form::Shared;
            self.places[value as usize].common = region;
        } else if place.uses > 1 {
            // A use may be in a branch, or in code that a branch calls.
            self.regions[region as usize].hoisted.push(value);
        }
        self.use_operands(graph, value, region);
    }

    fn use_operands(&mut self, graph: &Graph, value: Value, region: RegionId) {
        let Node::If(test, then, otherwise) = graph.node(value) else {
            graph.operands(graph.node(value), |operand| self.used(operand, region));
            return;
        };
        self.tested(graph, test, region);
        let branches = [self.new_region(region), self.new_region(region)];
        self.places[value as usize].branches = branches;
        for (branch, inside) in [then, otherwise].into_iter().zip(branches) {
            match self.form(value) {
                // In a jump, a branch that equals the test is decided by the test.
                Form::Jump if branch == test => {}
                Form::Jump => self.tested(graph, branch, inside),
                _ => self.used(branch, inside),
            }
        }
    }

    /// Whether a region computes only the value of its branch.
    pub(crate) fn is_plain(&self, region: RegionId) -> bool {
        let region = &self.regions[region as usize];
        region.hoisted.is_empty() && region.shared.is_empty()
    }

    /// Whether code uses the value.
    pub(crate) fn is_used(&self, value: Value) -> bool {
        self.places[value as usize].uses > 0
    }

    /// Whether the value is used once.
    pub(crate) fn is_used_once(&self, value: Value) -> bool {
        self.places[value as usize].uses == 1
    }
}
