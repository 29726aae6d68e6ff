//! The fast machine against the exact one, on thousands of generated programs.

use crate::{Bindings, Definitions, Fault, Program, Root, Scope, Scratch};
use radsight_diag::SourceMap;

/// A small generator of numbers, so that a failure can be repeated.
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Dice {
        Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn roll(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 20
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.roll() % end
    }

    fn number(&mut self) -> f64 {
        match self.below(6) {
            0 => 0.0,
            1 => self.below(5) as f64,
            2 => -(self.below(3) as f64),
            _ => self.below(4000) as f64 / 1000.0 - 1.5,
        }
    }
}

/// Writes expressions.
struct Writer<'d> {
    dice: &'d mut Dice,
    parameters: u64,
    variables: u64,
    functions: u64,
}

impl Writer<'_> {
    fn expression(&mut self, depth: u64) -> String {
        if depth == 0 {
            return self.leaf();
        }
        let mut next = || self.expression(depth - 1);
        let (a, b, c) = (next(), next(), next());
        match self.dice.below(24) {
            0..4 => format!("({a}+{b})"),
            4..6 => format!("({a}-{b})"),
            6..9 => format!("{a}*{b}"),
            9 => format!("{a}/({b})"),
            10 => format!("({a})^{}", self.dice.below(4) as f64 / 2.0),
            11 => format!("({a})^({b})"),
            12..15 => format!("if({a},{b},{c})"),
            15 => format!("if({a}-{b},if({b}-{c},1,-1),{c})"),
            16 => format!("select({a},{b},{c},{a})"),
            17 => format!("min({a},{b},{c})"),
            18 => format!("max({a},{b})"),
            19 => format!("if(and({a},or({b},not({c}))),{c},{b})"),
            20 => format!("-({a})"),
            21 if self.functions > 0 => format!("f{}({a},{b})", self.dice.below(self.functions)),
            22 => format!("bound(-1,{a},1)+abs({b})+noneg({c})"),
            _ => format!(
                "{}({a})",
                ["sin", "sqrt", "acos", "exp", "log", "floor", "rand", "Acos"][self.dice.below(8) as usize]
            ),
        }
    }

    fn leaf(&mut self) -> String {
        match self.dice.below(8) {
            0..2 => format!("${}", 1 + self.dice.below(4)),
            2..4 if self.variables > 0 => format!("v{}", self.dice.below(self.variables)),
            4 if self.parameters > 0 => ["x", "y"][self.dice.below(2) as usize].to_owned(),
            5 => format!("arg({})", self.dice.below(3)),
            6 => "select($1+2,1,2,5,9)".to_owned(),
            _ => match self.dice.number() {
                number if number < 0.0 => format!("({number})"),
                number => number.to_string(),
            },
        }
    }
}

fn program_text(dice: &mut Dice) -> (String, [String; 2]) {
    let mut text = String::new();
    let mut writer = Writer { dice, parameters: 0, variables: 0, functions: 0 };
    for index in 0..writer.dice.below(4) {
        writer.parameters = 2;
        text += &format!("f{index}(x,y) = {};\n", writer.expression(2));
        writer.parameters = 0;
        writer.functions = index + 1;
        text += &format!("v{index} = {};\n", writer.expression(3));
        writer.variables = index + 1;
    }
    let roots = [writer.expression(3), writer.expression(2)];
    (text, roots)
}

fn close(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

fn agree(fast: Result<f64, Fault>, exact: Result<f64, Fault>) -> bool {
    match (fast, exact) {
        (Ok(a), Ok(b)) => close(a, b),
        (Err(a), Err(b)) => a.kind == b.kind && close(a.value, b.value),
        _ => false,
    }
}

#[test]
fn fast_code_and_exact_code_agree() {
    let mut scratch = Scratch::new();
    let (mut compiled, mut went_fast, mut evaluations) = (0, 0, 0);
    for seed in 0..4000 {
        let mut dice = Dice::new(seed);
        let (text, roots) = program_text(&mut dice);
        let mut sources = SourceMap::default();
        let file = sources.add("x.cal", text.as_bytes(), None);
        let mut definitions = Definitions::with_initial_library();
        // A constant subexpression that faults is an error.
        if definitions.load(file, text.as_bytes(), &Scope::global()).is_err() {
            continue;
        }
        let span = sources.span(file, 0, 0);
        let roots = [Root::Expression { text: &roots[0], span }, Root::Expression { text: &roots[1], span }];
        let bindings = Bindings { real_arguments: &[0.5, -2.0, 3.0], ..Bindings::of_ray() };
        let Ok(program) = Program::compile(&definitions, &Scope::global(), &roots, &bindings) else { continue };
        compiled += 1;
        for _ in 0..8 {
            let channels: Vec<f64> = (0..4).map(|_| dice.number()).collect();
            let channels = &channels[..];
            for root in 0..2 {
                let exact = program.eval_exactly(root, &[], channels, &mut scratch);
                let fast = program.eval(root, &[], channels, &mut scratch);
                assert!(agree(fast, exact), "{seed}: {fast:?} {exact:?} at {channels:?}\n{text}{roots:?}");
                evaluations += 1;
                went_fast += u32::from(program.goes_fast(root, channels, &mut scratch));
            }
            let (mut fast, mut exact) = ([0.0; 2], [0.0; 2]);
            let fast_end = program.eval_all(&[], channels, &mut scratch, &mut fast);
            let exact_end = program.eval_all_exactly(&[], channels, &mut scratch, &mut exact);
            assert_eq!(fast_end.map_err(|fault| fault.kind), exact_end.map_err(|fault| fault.kind), "{seed}");
            assert!(
                close(fast[0], exact[0]) && close(fast[1], exact[1]),
                "{seed}: {fast:?} {exact:?}\n{text}{roots:?}"
            );
        }
    }
    assert!(compiled > 2500, "only {compiled} of 4000 programs compiled");
    assert!(went_fast * 2 > evaluations, "only {went_fast} of {evaluations} evaluations went fast");
}
