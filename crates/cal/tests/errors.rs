//! Complete error messages.

use radsight_cal::{Bindings, Definitions, Program, Root, Scope};
use radsight_diag::{Diagnostic, SourceMap};

fn rendered(problems: &[Diagnostic], sources: &SourceMap) -> String {
    problems.iter().map(|problem| problem.render(sources)).collect()
}

/// Errors of a function file.
fn load(text: &str) -> String {
    let mut sources = SourceMap::default();
    let source = sources.add("sky.cal", text.as_bytes(), None);
    let mut definitions = Definitions::with_initial_library();
    match definitions.load(source, text.as_bytes(), &Scope::of_file("sky.cal")) {
        Ok(()) => rendered(&definitions.take_warnings(), &sources),
        Err(problems) => rendered(&problems, &sources),
    }
}

/// Errors of an expression that uses a function file.
fn compile(text: &str, expression: &str) -> String {
    let mut sources = SourceMap::default();
    let source = sources.add("sky.cal", text.as_bytes(), None);
    let mut definitions = Definitions::with_initial_library();
    let scope = Scope::of_file("sky.cal");
    definitions.load(source, text.as_bytes(), &scope).unwrap();
    let scene = format!("void brightfunc sky 2 {expression} sky.cal\n0 1 4\n");
    let scene = sources.add("scene.rad", scene.into_bytes(), None);
    let root = Root::Expression { text: expression, span: sources.span(scene, 22, 22 + expression.len()) };
    let bindings = Bindings { real_arguments: &[4.0], ..Bindings::of_ray() };
    match Program::compile(&definitions, &scope, &[root], &bindings) {
        Ok(_) => String::new(),
        Err(problems) => rendered(&problems, &sources),
    }
}

#[test]
fn an_unknown_name_is_shown_where_it_is_used_with_the_nearest_one() {
    assert_eq!(
        compile("a = 1;\nskybr = a * Nz1;\n", "skybr+skyb"),
        "sky.cal:2:13: error: unknown variable \"Nz1\"\n  2 | skybr = a * Nz1;\n    |             ^^^\nhint: did you mean \"Nz\"?\n\
         scene.rad:1:29: error: unknown variable \"skyb\"\n  1 | void brightfunc sky 2 skybr+skyb sky.cal\n    |                             ^^^^\nhint: did you mean \"skybr\"?\n"
    );
    assert_eq!(
        compile("f(x) = nois3(x,1,2);", "f(Dx)"),
        "sky.cal:1:8: error: unknown function \"nois3\"\n  1 | f(x) = nois3(x,1,2);\n    |        ^^^^^^^^^^^^\nhint: did you mean \"noise3\"?\n"
    );
}

#[test]
fn a_function_is_not_a_variable() {
    assert_eq!(
        compile("f(x) = 2*x;", "f"),
        "scene.rad:1:23: error: unknown variable \"f\"\n  1 | void brightfunc sky 2 f sky.cal\n    |                       ^\nhint: \"f\" is a function, and needs arguments in parentheses\n"
    );
    assert_eq!(
        compile("v = 2*Dx;", "v(1)"),
        "scene.rad:1:23: error: unknown function \"v\"\n  1 | void brightfunc sky 2 v(1) sky.cal\n    |                       ^^^^\nhint: \"v\" is a variable, and takes no arguments\n"
    );
}

#[test]
fn missing_arguments_are_errors() {
    assert_eq!(
        compile("f(a,b,c) = a*Dx;\ng = atan2(Dx);", "f(2)+g+A2+arg(3)"),
        "sky.cal:2:5: error: function \"atan2\" needs 2 arguments, 1 given\n  2 | g = atan2(Dx);\n    |     ^^^^^^^^^\n\
         scene.rad:1:30: error: real argument 2 is missing, 1 given\n  1 | void brightfunc sky 2 f(2)+g+A2+arg(3) sky.cal\n    |                              ^^\n\
         scene.rad:1:33: error: real argument 3 is missing, 1 given\n  1 | void brightfunc sky 2 f(2)+g+A2+arg(3) sky.cal\n    |                                 ^^^^^^\n"
    );
}

/// An argument is evaluated at its first use, so only a used one can be missing.
#[test]
fn a_missing_argument_is_an_error_where_it_is_used() {
    assert_eq!(
        compile("f(a,b) = if(a,Dx,b);", "f(1)+f(Dx)+if(Dx,2)"),
        "scene.rad:1:28: error: function \"f\" needs 2 arguments, 1 given\n  1 | void brightfunc sky 2 f(1)+f(Dx)+if(Dx,2) sky.cal\n    |                            ^^^^^\n\
         scene.rad:1:34: error: function \"if\" needs 3 arguments, 2 given\n  1 | void brightfunc sky 2 f(1)+f(Dx)+if(Dx,2) sky.cal\n    |                                  ^^^^^^^^\n"
    );
    assert_eq!(compile("g(h,x) = h(x);\nf(a,b) = if(a,1,b);", "f(1)+if(2,Dx)+g(f,2)"), "");
}

#[test]
fn branches_that_constants_exclude_are_not_checked() {
    assert_eq!(compile("f = if(arg(0)-1.5, arg(2)+nowhere, 1);", "f"), "");
}

#[test]
fn a_cyclic_definition_is_an_error() {
    assert_eq!(
        compile("a = b+1;\nb = 2*a;", "a"),
        "sky.cal:2:7: error: variable \"a\" depends on itself\n  2 | b = 2*a;\n    |       ^\n"
    );
}

#[test]
fn all_errors_of_a_file_are_reported() {
    assert_eq!(
        load("a = 1 +;\nb = 2;\n3c = 4;\nd(x,) = 1;\ne = (1;\nf 3;\ng = 1 2;\nh = $;"),
        "sky.cal:1:8: error: expected an expression, found \";\"\n  1 | a = 1 +;\n    |        ^\n\
         sky.cal:3:1: error: expected the name of a definition, found the number 3\n  3 | 3c = 4;\n    | ^\n\
         sky.cal:4:5: error: expected the name of an argument, found \")\"\n  4 | d(x,) = 1;\n    |     ^\n\
         sky.cal:5:7: error: expected \")\", found \";\"\n  5 | e = (1;\n    |       ^\n\
         sky.cal:6:3: error: expected \"=\" or \":\", found the number 3\n  6 | f 3;\n    |   ^\n\
         sky.cal:7:7: error: expected \";\" or an operator, found the number 2\n  7 | g = 1 2;\n    |       ^\n\
         sky.cal:8:5: error: illegal channel number\n  8 | h = $;\n    |     ^^\nhint: channels are $1, $2, and so on\n"
    );
}

#[test]
fn channels_are_numbered_by_digits() {
    assert_eq!(
        load("a = $1e2;"),
        "sky.cal:1:5: error: illegal channel number\n  1 | a = $1e2;\n    |     ^^^^\nhint: channels are $1, $2, and so on\n"
    );
}

#[test]
fn comments_must_be_closed() {
    assert_eq!(
        load("a = 1; { open { closed }\nb = 2;"),
        "sky.cal:1:8: error: comment is not closed\n  1 | a = 1; { open { closed }\n    |        ^\nhint: expected a \"}\" for each \"{\"\n"
    );
}

#[test]
fn a_constant_cannot_depend_on_the_ray() {
    assert_eq!(
        load("a : 2*Dx;\nb = a+1;"),
        "sky.cal:2:5: error: constant \"a\" depends on $1, which changes from ray to ray\n  2 | b = a+1;\n    |     ^\nhint: define it with \"=\" in place of \":\"\n"
    );
}

#[test]
fn invalid_constants_are_errors() {
    assert_eq!(
        load("a = acos(2);\nb = 1/0;\nc = (-1)^.5;\nd : 2*exp(1000);"),
        "sky.cal:1:5: error: bad constant expression: acos(): domain error\n  1 | a = acos(2);\n    |     ^^^^^^^\n\
         sky.cal:2:5: error: division by the constant zero\n  2 | b = 1/0;\n    |     ^^^\n\
         sky.cal:3:5: error: illegal power of constants\n  3 | c = (-1)^.5;\n    |     ^^^^^^^\n\
         sky.cal:4:7: error: bad constant expression: exp(): range error\n  4 | d : 2*exp(1000);\n    |       ^^^^^^^^^\n"
    );
    assert_eq!(
        load("f(x) : f(x+1);\na = f(1);"),
        "sky.cal:2:5: error: bad constant expression: functions call each other more than 100000 deep\n  2 | a = f(1);\n    |     ^^^^\n"
    );
}

#[test]
fn a_constant_that_is_defined_again_is_a_warning() {
    assert_eq!(
        load("a : 1; a : 1;\na : 2; b = 1; b = 2;"),
        "sky.cal:2:1: warning: constant \"a\" is redefined\n  2 | a : 2; b = 1; b = 2;\n    | ^\n"
    );
}

#[test]
fn a_ray_has_no_other_channels() {
    assert_eq!(
        compile("", "$99"),
        "scene.rad:1:23: error: illegal channel $99\n  1 | void brightfunc sky 2 $99 sky.cal\n    |                       ^^^\nhint: channels are $1 to $37\n"
    );
}
