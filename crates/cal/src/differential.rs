//! Compares the fast machine with the exact one on thousands of generated programs.

mod writer;

use crate::{Bindings, Definitions, Family, Fault, Program, Root, Scope, Scratch};
use radsight_diag::{SourceMap, Span};
use std::sync::Arc;
use writer::{Dice, program_text};

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

/// A function file and two expressions, at random.
struct Generated {
    dice: Dice,
    text: String,
    expressions: [String; 2],
    span: Span,
    definitions: Definitions,
}

impl Generated {
    /// `None` where the file has an error: a constant subexpression that faults is one.
    fn new(seed: u64) -> Option<Generated> {
        let mut dice = Dice::new(seed);
        dice.calls_library = true;
        let (text, expressions) = program_text(&mut dice);
        let mut sources = SourceMap::default();
        let file = sources.add("x.cal", text.as_bytes(), None);
        let mut definitions = Definitions::with_initial_library();
        definitions.load(file, text.as_bytes(), &Scope::global()).ok()?;
        let span = sources.span(file, 0, 0);
        Some(Generated { dice, text, expressions, span, definitions })
    }
}

#[test]
fn fast_code_and_exact_code_agree() {
    let mut scratch = Scratch::new();
    let (mut compiled, mut went_fast, mut evaluations) = (0, 0, 0);
    for seed in 0..4000 {
        let Some(Generated { mut dice, text, expressions, span, definitions }) = Generated::new(seed) else { continue };
        let roots = expressions.each_ref().map(|text| Root::Expression { text, span });
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

#[test]
fn recursion_that_ends_soon_goes_fast() {
    let text = b"half(x) = if(x - 1, half(x / 2), x);";
    let mut sources = SourceMap::default();
    let file = sources.add("half.cal", text.as_slice(), None);
    let mut definitions = Definitions::with_initial_library();
    definitions.load(file, text, &Scope::global()).expect("the text is right");
    let root = Root::Expression { text: "half($1) + half($2)", span: sources.span(file, 0, 0) };
    let program = Program::compile(&definitions, &Scope::global(), &[root], &Bindings::of_ray()).expect("it compiles");
    let mut scratch = Scratch::new();
    for (channels, is_fast, value) in [([0.5, 6.0], true, 1.25), ([3.0, 1e6], false, 0.75 + 1e6 / f64::from(1 << 20))] {
        let channels = &channels[..];
        assert_eq!(program.goes_fast(0, channels, &mut scratch), is_fast, "{channels:?}");
        assert_eq!(program.eval(0, &[], channels, &mut scratch), Ok(value));
    }
}

#[test]
fn programs_of_a_family_compute_the_same_bits() {
    let mut scratch = Scratch::new();
    let (mut sharing, mut alone) = (0, 0);
    for seed in 0..3000 {
        let Some(Generated { mut dice, text, expressions, span, definitions }) = Generated::new(seed) else { continue };
        let roots = expressions.each_ref().map(|text| Root::Expression { text, span });
        let mut family = Family::default();
        for turn in 0..12 {
            // Ones and zeros are simplified away where they are known.
            let real_arguments = [dice.number(), [0.0, 1.0, -0.0, 0.25][turn % 4], dice.number()];
            let bindings = Bindings { real_arguments: &real_arguments, ..Bindings::of_ray() };
            let own = Program::compile(&definitions, &Scope::global(), &roots, &bindings);
            let of_family = family.program(&definitions, &Scope::global(), &roots, &bindings);
            assert_eq!(own.as_ref().err(), of_family.as_ref().err(), "{seed}");
            let (Ok(own), Ok(of_family)) = (own, of_family) else { continue };
            match Arc::strong_count(of_family.compiled_code()) > 1 {
                true => sharing += 1,
                false => alone += 1,
            }
            assert_eq!(own.constant(0).map(f64::to_bits), of_family.constant(0).map(f64::to_bits), "{seed}");
            for _ in 0..4 {
                let channels: Vec<f64> = (0..4).map(|_| dice.number()).collect();
                let (mut first, mut second) = ([0.0; 2], [0.0; 2]);
                let first_end = own.eval_all(&[], &channels[..], &mut scratch, &mut first);
                let second_end = of_family.eval_all(&[], &channels[..], &mut scratch, &mut second);
                assert_eq!(first_end.map_err(|fault| fault.kind), second_end.map_err(|fault| fault.kind), "{seed}");
                let what = (first, second, real_arguments, &text, roots);
                assert_eq!(first.map(f64::to_bits), second.map(f64::to_bits), "{seed}: {what:?}");
            }
        }
    }
    assert!(sharing > 500 && alone > 500, "{sharing} programs share code, {alone} do not");
}
