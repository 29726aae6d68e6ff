//! No text makes loading, compiling or evaluating panic, overflow the stack or hang.

use proptest::prelude::*;
use radsight_cal::{Bindings, Definitions, Environment, FaultKind, NoHost, Program, Root, Scope, Scratch, library};
use radsight_diag::SourceMap;
use std::time::{Duration, Instant};

/// Loads a text as a function file, and evaluates what it defines under a few names.
fn evaluate(text: &[u8]) {
    let mut sources = SourceMap::default();
    let source = sources.add("x.cal", text, None);
    let mut definitions = Definitions::with_initial_library();
    if let Err(problems) = definitions.load(source, text, &Scope::of_file("x.cal")) {
        problems.iter().for_each(|problem| assert!(!problem.render(&sources).is_empty()));
    }
    let mut scratch = Scratch::new();
    for name in ["a", "b", "f(Dx,Dy)", "g(f,Dz)", "v+v0"] {
        let root = Root::Expression { text: name, span: sources.span(source, 0, 1) };
        let bindings = Bindings { real_arguments: &[1.0, 2.0], ..Bindings::of_ray() };
        match Program::compile(&definitions, &Scope::of_file("x.cal"), &[root], &bindings) {
            Ok(program) => {
                let _ = program.eval(0, &[], &[0.1, -0.2, 0.9][..], &mut scratch);
            }
            Err(problems) => problems.iter().for_each(|problem| assert!(!problem.render(&sources).is_empty())),
        }
    }
    let mut environment = Environment::for_generators();
    let _ = environment.define(source, text);
    let _ = environment.eval_outputs(&[1.0, 2.0, 3.0][..]);
}

/// Replaces, inserts, doubles or removes a few bytes.
fn spoil(text: &str, changes: &[(u32, u8, u8)]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for &(place, kind, byte) in changes {
        let at = place as usize % (bytes.len() + 1);
        let marks = b"(){}:=;,$`^*/+-.0123456789eEfxv\n \0\xff";
        let byte = marks[usize::from(byte) % marks.len()];
        match kind % 4 {
            0 if at < bytes.len() => bytes[at] = byte,
            1 => bytes.insert(at, byte),
            2 if at < bytes.len() => {
                let end = (at + 20).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => {
                let end = (at + 5).min(bytes.len());
                bytes.drain(at..end);
            }
        }
    }
    bytes
}

const PROGRAM: &str = "a = if(Dx, b, v(1)); b : 2*PI; f(x,y) = if(x-y, f(x-.3,y)+1, g(sqrt,x)); g(h,x) = h(x)^2;
    v = select(2, a, b, noise3(Px,Py,1)); v0 = arg(1)+max(1,2,Dz)/3; $1 = a*b; $2 = rand(v0)-$1;";

/// Number of texts per test; `RADSIGHT_FUZZ_CASES` sets another number.
fn cases() -> u32 {
    std::env::var("RADSIGHT_FUZZ_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(3000)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_do_no_harm(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        evaluate(&bytes);
    }

    #[test]
    fn random_tokens_do_no_harm(tokens in proptest::collection::vec(proptest::sample::select(vec![
        "a", "b", "f", "g", "x", "(", ")", ",", ";", "=", ":", "+", "-", "*", "/", "^", "1", "0", ".5", "$1", "$2", "if", "select",
        "max", "sin", "noise3", "arg", "f(x)=", "a=", "b:", "g(f,x)=", "{", "}", "`", "x`", "Dx",
    ]), 0..60)) {
        evaluate(tokens.concat().as_bytes());
    }

    #[test]
    fn spoiled_programs_do_no_harm(changes in proptest::collection::vec((any::<u32>(), any::<u8>(), any::<u8>()), 1..12)) {
        evaluate(&spoil(PROGRAM, &changes));
    }

    #[test]
    fn spoiled_function_files_do_no_harm(
        which in any::<prop::sample::Index>(),
        changes in proptest::collection::vec((any::<u32>(), any::<u8>(), any::<u8>()), 1..5),
    ) {
        let names: Vec<&str> = library::names().collect();
        evaluate(&spoil(library::file(names[which.index(names.len())]).unwrap(), &changes));
    }
}

/// Value of `a`, or the error, within a time limit.
fn within(limit: Duration, text: &str) -> Result<f64, String> {
    let start = Instant::now();
    let mut sources = SourceMap::default();
    let source = sources.add("x.cal", text.as_bytes(), None);
    let mut definitions = Definitions::with_initial_library();
    let first = |problems: Vec<radsight_diag::Diagnostic>| problems[0].message.clone();
    let result = definitions.load(source, text.as_bytes(), &Scope::global()).map_err(first).and_then(|()| {
        let root = Root::Expression { text: "a", span: sources.span(source, 0, 1) };
        let program = Program::compile(&definitions, &Scope::global(), &[root], &Bindings::of_ray()).map_err(first)?;
        program.eval(0, &[], &[0.5, 0.25, 0.125][..], &mut Scratch::new()).map_err(|fault| fault.to_string())
    });
    // A generous limit, which detects unbounded growth even on a busy machine.
    assert!(start.elapsed() < limit, "took {:?}", start.elapsed());
    result
}

const SOON: Duration = Duration::from_secs(30);

#[test]
fn deep_nesting_is_an_error_or_right() {
    // Half the stack that threads have by default.
    let small = std::thread::Builder::new().stack_size(1 << 20).spawn(nest_deeply).unwrap();
    small.join().unwrap();
}

fn nest_deeply() {
    let nested =
        |depth: usize, open: &str, close: &str| format!("a = {}Dx{};", open.repeat(depth), close.repeat(depth));
    for (open, close) in [("(", ")"), ("sqrt(", ")"), ("if(Dy-.5,1,", ")"), ("-(", ")"), (".5^", ""), ("1+(", ")")] {
        assert!(within(SOON, &nested(450, open, close)).is_ok(), "{open}");
        for depth in [2000, 200_000] {
            let error = within(SOON, &nested(depth, open, close)).unwrap_err();
            assert!(error.contains("nested more than"), "{error}");
        }
    }
    for operator in ["+", "-", "*", "/"] {
        for operand in ["1", "Dx", "2*Dx"] {
            let long = format!("{operand}{operator}").repeat(200_000);
            assert!(within(SOON, &format!("a = {long}1;")).is_ok(), "{operand}{operator}");
        }
    }
}

#[test]
fn long_chains_of_definitions_are_right() {
    let mut text = "v0 = Dx;".to_owned();
    for index in 1..20_000 {
        text += &format!("v{index} = v{}+1;", index - 1);
    }
    assert_eq!(within(SOON, &(text + "a = v19999;")), Ok(19_999.5));
}

#[test]
fn expressions_that_double_at_each_step_stay_small() {
    let mut variables = "v0 = Dx;".to_owned();
    let mut functions = "f0(x) = if(x-Dy, x+Dz, x*Dz);".to_owned();
    for index in 1..60 {
        let before = index - 1;
        variables += &format!("v{index} = if(Dy-v{before}, v{before}*.5, v{before}+.25*sin(v{before}));");
        functions += &format!("f{index}(x) = if(x-Dy, f{before}(f{before}(x)), f{before}(x)+f{before}(-x));");
    }
    assert!(within(SOON, &(variables + "a = v59;")).is_ok());
    // 2^59 calls are too many at run time; but compiling must end too.
    assert_eq!(within(SOON, &(functions + "a = f59(Dx);")), Err(FaultKind::TooLong.to_string()));
}

#[test]
fn expressions_shared_by_many_branches_compile_quickly() {
    let mut text = "v0 = Dx; v1 = Dy;".to_owned();
    for index in 2..300 {
        let (before, earlier) = (index - 1, index - 2);
        text +=
            &format!("v{index} = if(Dx-{index}, sin(v{before}), if(Dy-v{earlier}, exp(-v{before}), cos(v{earlier})));");
    }
    let all: String = (0..300).map(|index| format!("+if(Dz-.{index},v{index},0)")).collect();
    assert!(within(SOON, &format!("{text} a = 0{all};")).is_ok());
    let wide: String = (0..5000)
        .map(|index| format!("+if(Dz-.{index:04},sin(Dx*{index}),if(Dx-.{index:04},sin(Dx*{index}),0))"))
        .collect();
    assert!(within(SOON, &format!("a = 0{wide};")).is_ok());
}

#[test]
fn constants_that_do_not_terminate_are_errors() {
    let text = "f(n) : if(n, f(n-1)+f(n-1), 1); a = f(100); b = f(100); c = f(100); d = f(101);";
    assert!(within(SOON, text).unwrap_err().starts_with("bad constant expression"));
}

#[test]
fn many_arguments_are_an_error() {
    let text = format!("a = max({}1);", "1,".repeat(70_000));
    assert!(within(SOON, &text).unwrap_err().contains("too many arguments"));
}

#[test]
fn a_host_that_gives_nonsense_does_no_harm() {
    let mut sources = SourceMap::default();
    let source = sources.add("x", &b""[..], None);
    let definitions = Definitions::with_initial_library();
    for text in
        ["select(Dx,1,2,3)", "arg(Dx)", "noise3(Dx,Dy,Dz)+fnoise3(Dx,Dy,Dz)", "if(Dx,Dy,Dz)^Dx", "max(Dx,Dy)", "D(Dx)"]
    {
        let root = Root::Expression { text, span: sources.span(source, 0, 0) };
        let program = Program::compile(&definitions, &Scope::global(), &[root], &Bindings::of_ray()).unwrap();
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0, -0.0] {
            let _ = program.eval(0, &[], &[x, x, x][..], &mut Scratch::new());
            let _ = program.eval(0, &[], &NoHost, &mut Scratch::new());
        }
    }
}
