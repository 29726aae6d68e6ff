//! The rules of the language, one by one.

use radsight_cal::{Bindings, Definitions, Fault, FaultKind, Host, NoHost, Program, Root, Scope, Scratch, channel};
use radsight_diag::{Diagnostic, SourceMap, Span};

struct World {
    sources: SourceMap,
    definitions: Definitions,
}

impl World {
    fn new(text: &str) -> World {
        let mut world = World { sources: SourceMap::default(), definitions: Definitions::with_initial_library() };
        world.load("file.cal", text);
        world
    }

    fn load(&mut self, name: &str, text: &str) {
        let source = self.sources.add(name, text.as_bytes(), None);
        let result = self.definitions.load(source, text.as_bytes(), &Scope::of_file(name));
        if let Err(problems) = result {
            panic!("{}", problems[0].render(&self.sources));
        }
    }

    /// An arbitrary span.
    fn span(&mut self) -> Span {
        let source = self.sources.add("scene.rad", &b""[..], None);
        self.sources.span(source, 0, 0)
    }

    fn compile(&mut self, text: &str, scope: &str, bindings: &Bindings<'_>) -> Result<Program, Vec<Diagnostic>> {
        let source = self.sources.add("scene.rad", text.as_bytes(), None);
        let root = Root::Expression { text, span: self.sources.span(source, 0, text.len()) };
        Program::compile(&self.definitions, &Scope::of_file(scope), &[root], bindings)
    }

    fn value(&mut self, text: &str) -> f64 {
        self.result(text, &[]).unwrap()
    }

    fn result(&mut self, text: &str, channels: &[f64]) -> Result<f64, Fault> {
        let bindings = Bindings { real_arguments: &[10.0, 20.0, 30.0], ..Bindings::of_ray() };
        let program = match self.compile(text, "file.cal", &bindings) {
            Ok(program) => program,
            Err(problems) => panic!("{}", problems[0].render(&self.sources)),
        };
        program.eval(0, &[], channels, &mut Scratch::new())
    }
}

fn value(text: &str) -> f64 {
    World::new("").value(text)
}

/// The recursion is too deep for a graph, so that the exact machine decides.
#[test]
fn missing_arguments_of_recursive_functions_are_faults_where_they_are_used() {
    let mut world =
        World::new("sum(n,end) = if(n-.5, n+sum(n-1), if($2, 0, end)); either(n) = if(n-.5, either(n-1), if($2, 3));");
    assert_eq!(world.result("sum($1)", &[300.0, 1.0]), Ok(45150.0));
    let missing = Err(Fault { kind: FaultKind::Undefined, value: 0.0 });
    assert_eq!(world.result("sum($1)", &[300.0, -1.0]), missing);
    assert_eq!(world.result("either($1)", &[300.0, 1.0]), Ok(3.0));
    assert_eq!(world.result("either($1)", &[300.0, -1.0]), missing);
}

#[test]
fn powers_go_from_the_right_and_signs_bind_most_tightly() {
    assert_eq!(value("2^3^2"), 512.0);
    assert_eq!(value("-2^2"), 4.0);
    assert_eq!(value("2^-1"), 0.5);
    assert_eq!(value("8/2/2"), 2.0);
    assert_eq!(value("2-3-4*2"), -9.0);
    assert_eq!(value("+3 - -4"), 7.0);
}

#[test]
fn zero_times_anything_is_zero_even_if_it_is_undefined() {
    assert_eq!(value("0*nowhere + nowhere*0 + 0/nowhere + 0^nowhere + 1^nowhere + nowhere^0"), 2.0);
}

#[test]
fn only_what_is_greater_than_zero_is_true() {
    assert_eq!(value("if(0, 1, 2)"), 2.0);
    assert_eq!(value("if(1e-300, 1, 2)"), 1.0);
    assert_eq!(value("if(-1, 1, 2)"), 2.0);
}

#[test]
fn select_counts_its_choices_and_rounds_half_up() {
    assert_eq!(value("select(0, 7, 8, 9)"), 3.0);
    assert_eq!(value("select(1.5, 7, 8, 9)"), 8.0);
    assert_eq!(value("select(1.49, 7, 8, 9)"), 7.0);
    let outside = World::new("").result("select($1, 7, 8, 9)", &[4.0]);
    assert_eq!(outside, Err(Fault { kind: FaultKind::Domain, value: 0.0 }));
}

#[test]
fn arguments_are_evaluated_only_when_they_are_used() {
    let mut world = World::new("first(a,b) = a; forever(x) = forever(x+1);");
    assert_eq!(world.value("first(3, forever(1))"), 3.0);
    assert_eq!(world.value("if(1, 2, 1/(Dx-Dx))"), 2.0);
    assert_eq!(world.result("if($1, 2, forever(1))", &[1.0]), Ok(2.0));
    assert_eq!(world.result("first($1, log($1))", &[-1.0]), Ok(-1.0));
}

#[test]
fn functions_can_be_arguments_and_take_more_than_they_need() {
    let mut world = World::new(
        "twice(f,x) = f(f(x)); add(x) = x+1; apply(f,a,b) = f(a,b); through(g) = twice(g,1); both(f,g,x) = f(x)+g(x);",
    );
    assert_eq!(world.value("twice(add, 1)"), 3.0);
    assert_eq!(world.value("through(add)"), 3.0);
    assert_eq!(world.value("apply(max, 2, 5) + apply(min, 2, 5)"), 7.0);
    assert_eq!(world.value("apply(add, 2, 5)"), 3.0);
    assert_eq!(world.value("both(sqrt, add, 4)"), 7.0);
    assert_eq!(world.result("twice(add,$1)+dot(P,P)", &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0]), Ok(17.0));
}

#[test]
fn recursion_that_the_ray_ends_is_evaluated() {
    let mut world = World::new("sum(f,n) = if(n-.5, f(n)+sum(f,n-1), 0); fib(n) = if(n-1.5, fib(n-1)+fib(n-2), n);");
    assert_eq!(world.result("sum(sq,$1)", &[10.0]), Ok(385.0));
    assert_eq!(world.result("sum(sq,$1)", &[20_000.0]), Ok(20_000.0 * 20_001.0 * 40_001.0 / 6.0));
    assert_eq!(world.result("fib($1)", &[20.0]), Ok(6765.0));
    assert_eq!(world.value("sum(sq,100)"), 338_350.0);
}

#[test]
fn recursion_without_end_is_a_fault() {
    let mut world = World::new("up(x) = up(x+1); sum(x) = x+sum(x+1); busy(x) = if(x, busy(x-1)+busy(x-1), 0);");
    for text in ["up($1)", "sum($1)"] {
        assert_eq!(world.result(text, &[1.0]), Err(Fault { kind: FaultKind::TooDeep, value: 0.0 }), "{text}");
    }
    assert_eq!(world.result("busy($1)", &[60.0]), Err(Fault { kind: FaultKind::TooLong, value: 0.0 }));
}

#[test]
fn a_name_of_the_file_comes_before_a_global_one_from_its_definition_on() {
    let mut world = World::new("before = PI; PI : 3; after = PI; global = PI`; local = `PI;");
    assert_eq!(world.value("before"), std::f64::consts::PI);
    assert_eq!(world.value("after"), 3.0);
    assert_eq!(world.value("global"), std::f64::consts::PI);
    assert_eq!(world.value("local"), 3.0);
}

#[test]
fn files_do_not_see_each_other_but_by_full_names() {
    let mut world = World::new("x = 1; everyone` = 2; mine = x`other`; later = y; y = 9;");
    world.load("other.cal", "x = 10;");
    assert_eq!(world.value("x"), 1.0);
    assert_eq!(world.value("x`other`"), 10.0);
    assert_eq!(world.value("mine"), 10.0);
    assert_eq!(world.value("later"), 9.0);
    let program = world.compile("everyone", "other.cal", &Bindings::of_ray()).unwrap();
    assert_eq!(program.constant(0), Some(2.0));
}

#[test]
fn a_constant_keeps_the_value_that_it_had_when_it_was_read() {
    let mut world = World::new("a : 1; b = a; a : 2; c = a; f(x) : x*a; d = f(3); g(x) : x+10; e = g(1); g(x) : x;");
    assert_eq!(world.value("b"), 1.0);
    assert_eq!(world.value("c"), 2.0);
    assert_eq!(world.value("d"), 6.0);
    assert_eq!(world.value("e"), 11.0);
    assert_eq!(world.definitions.take_warnings().len(), 2);
}

#[test]
fn a_definition_hides_a_library_function() {
    let mut world = World::new("sqrt(x) = 7; a = sqrt(4);");
    assert_eq!(world.value("a"), 7.0);
    assert_eq!(world.value("sqrt`(4)"), 2.0);
}

#[test]
fn real_arguments_are_constants() {
    let mut world = World::new("n = arg(0); second = A2; any(i) = arg(i);");
    assert_eq!(world.value("n + second + any(3)"), 53.0);
    assert_eq!(world.result("any($1)", &[1.6]), Ok(20.0));
    assert_eq!(world.result("any($1)", &[-3.0]), Ok(3.0));
    assert_eq!(world.result("any($1)", &[9.0]), Err(Fault { kind: FaultKind::Undefined, value: 0.0 }));
    assert_eq!(world.value("if(arg(0)-3.5, arg(4), -1)"), -1.0);
}

#[test]
fn constant_channels_and_real_arguments_make_constants_and_save_channels() {
    let mut world = World::new("f = if(A1-5, Dx*S, noise3(Px,Py,Pz));");
    let bindings = Bindings {
        real_arguments: &[10.0],
        constant_channels: &[(channel::S, 2.0), (channel::DX, 0.5)],
        ..Bindings::of_ray()
    };
    let program = world.compile("f", "file.cal", &bindings).unwrap();
    assert_eq!(program.constant(0), Some(1.0));
    assert!(program.is_constant() && program.channels_used().is_empty());
    let bindings = Bindings { real_arguments: &[1.0], ..Bindings::of_ray() };
    let program = world.compile("f", "file.cal", &bindings).unwrap();
    assert_eq!(program.channels_used(), [channel::PX, channel::PX + 1, channel::PX + 2]);
    assert!(!program.is_constant());
}

#[test]
fn functions_get_their_arguments_from_the_host() {
    let mut world = World::new("mix(a,b,c) = a + 10*b + 100*c*Dz;");
    let span = world.span();
    let roots = [
        Root::Function { name: "mix", arity: 3, span },
        Root::Function { name: "noop", arity: 3, span },
        Root::Function { name: "exp", arity: 1, span },
    ];
    let program =
        Program::compile(&world.definitions, &Scope::of_file("file.cal"), &roots, &Bindings::of_ray()).unwrap();
    let mut scratch = Scratch::new();
    let channels: &[f64] = &[0.0, 0.0, 2.0];
    assert_eq!(program.eval(0, &[1.0, 2.0, 3.0], channels, &mut scratch), Ok(621.0));
    assert_eq!(program.eval(1, &[4.0, 2.0, 3.0], channels, &mut scratch), Ok(4.0));
    assert_eq!(program.eval(2, &[0.0], channels, &mut scratch), Ok(1.0));
    assert_eq!(program.eval(2, &[1000.0], channels, &mut scratch), Err(Fault { kind: FaultKind::Range, value: 0.0 }));
}

#[test]
fn the_host_serves_functions_and_variables_that_nothing_defines() {
    struct Prism;
    impl Host for Prism {
        fn channel(&self, channel: u32) -> f64 {
            f64::from(channel)
        }
        fn call(&self, function: u32, arguments: &[f64]) -> f64 {
            100.0 * f64::from(function) + arguments.iter().sum::<f64>()
        }
    }
    let mut world = World::new("f = outside(1, Dx, tint) + outer(2); g(f) = f(3,4,5);");
    let bindings =
        Bindings { variables: &[("tint", 90)], functions: &[("outer", 1), ("outside", 3)], ..Bindings::default() };
    let program = world.compile("f + g(outside)", "file.cal", &bindings).unwrap();
    assert_eq!(program.eval(0, &[], &Prism, &mut Scratch::new()), Ok(100.0 + 1.0 + 1.0 + 90.0 + 2.0 + 112.0));
    assert_eq!(program.channels_used(), [1, 90]);
}

#[test]
fn more_roots_than_usual_registers_have_their_own_values() {
    let mut world = World::new("");
    let span = world.span();
    let texts: Vec<String> = (1..=700).map(|factor| format!("Dx*{factor}")).collect();
    let roots: Vec<Root<'_>> = texts.iter().map(|text| Root::Expression { text, span }).collect();
    let program =
        Program::compile(&world.definitions, &Scope::of_file("file.cal"), &roots, &Bindings::of_ray()).unwrap();
    let mut values = vec![0.0; roots.len()];
    let (mut scratch, channels) = (Scratch::new(), &[2.0][..]);
    program.eval_all(&[], channels, &mut scratch, &mut values).unwrap();
    let expected: Vec<f64> = (1..=700).map(|factor| 2.0 * f64::from(factor)).collect();
    assert_eq!(values, expected);
    // Another program on the same memory.
    assert_eq!(program.eval(9, &[], channels, &mut scratch), Ok(20.0));
}

#[test]
fn several_roots_are_computed_together() {
    let mut world = World::new("v = noise3(Px,Py,Pz); r = v+1; g = 2*v; b = if(v, v, -v);");
    let span = world.span();
    let roots = ["r", "g", "b"].map(|text| Root::Expression { text, span });
    let program =
        Program::compile(&world.definitions, &Scope::of_file("file.cal"), &roots, &Bindings::of_ray()).unwrap();
    let mut scratch = Scratch::new();
    let channels: &[f64] = &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, 0.4, 0.9];
    let mut together = [0.0; 3];
    program.eval_all(&[], channels, &mut scratch, &mut together).unwrap();
    for (root, value) in together.into_iter().enumerate() {
        assert_eq!(program.eval(root, &[], channels, &mut scratch), Ok(value));
    }
}

#[test]
fn a_later_root_forgets_the_fault_of_an_earlier_one() {
    let mut world = World::new("");
    let span = world.span();
    let together = |texts: [&str; 2]| {
        let roots = texts.map(|text| Root::Expression { text, span });
        let program = Program::compile(&world.definitions, &Scope::global(), &roots, &Bindings::of_ray()).unwrap();
        let mut values = [9.0; 2];
        let result = program.eval_all(&[], &[0.0, 1.0][..], &mut Scratch::new(), &mut values);
        (result.map_err(|fault| fault.kind), values)
    };
    assert_eq!(together(["1/Dx", "sqrt(Dy)"]), (Ok(()), [0.0, 1.0]));
    assert_eq!(together(["1/Dx", "Dy"]), (Err(FaultKind::Range), [0.0, 1.0]));
}

#[test]
fn a_fault_makes_the_functions_around_it_zero() {
    let mut world = World::new("");
    let mut fault = |text: &str| world.result(text, &[2.0, 0.0]);
    assert_eq!(fault("1+acos($1)"), Err(Fault { kind: FaultKind::Domain, value: 1.0 }));
    assert_eq!(fault("max(5,acos($1))"), Err(Fault { kind: FaultKind::Domain, value: 0.0 }));
    assert_eq!(fault("if($1/$2,1,5)"), Err(Fault { kind: FaultKind::Range, value: 0.0 }));
    assert_eq!(fault("acos($1)+sqrt(4*$1/2)^2"), Ok(4.0));
    assert_eq!(fault("($2-1)^.5"), Err(Fault { kind: FaultKind::Domain, value: 0.0 }));
}

#[test]
fn faults_of_the_last_evaluation_are_reported() {
    let mut world = World::new("");
    let program = world.compile("max(1/Dx, acos(2+Dx))", ".", &Bindings::of_ray()).unwrap();
    let mut scratch = Scratch::new();
    program.eval(0, &[], &NoHost, &mut scratch).unwrap_err();
    let reported: Vec<String> = scratch.warnings().iter().map(ToString::to_string).collect();
    assert_eq!(reported, ["division by zero", "acos(): domain error", "max(): domain error"]);
}

#[test]
fn programs_can_be_shared_between_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Program>();
    shared::<Definitions>();
}
