//! Functions of a scene that fail during rendering: reported once, with number, kind and position;
//! no invalid values.

use crate::program::{Folder, Run, command, run_with};

const INPUT: i32 = 1;

/// A ball with a pattern from this function file, seen from the front.
fn ball(functions: &str) -> Folder {
    let folder = Folder::new();
    folder.file("pattern.cal", functions);
    folder.file(
        "scene.rad",
        "void light l\n0\n0\n3 100 100 100\nl sphere lamp\n0\n0\n4 0 -3 3 .5\n\
         void brightfunc stripes\n2 shade pattern.cal\n0\n0\nstripes plastic paint\n0\n0\n5 .5 .5 .5 0 0\n\
         paint sphere ball\n0\n0\n4 0 0 0 1\n",
    );
    folder
}

fn picture(folder: &Folder, options: &[&str]) -> Run {
    let view = ["-vp", "0", "-4", "0", "-vd", "0", "1", "0", "-x", "8", "-y", "8", "-ab", "0", "-pj", "0"];
    let words = [&["rpict"][..], &view, options, &["scene.rad"]].concat();
    run_with(command(&words).current_dir(folder.path("")), b"")
}

#[track_caller]
fn assert_reported(run: &Run, what: &str) {
    let message = &run.messages;
    assert!(message.contains("scene.rad:9:1: warning: functions of \"stripes\" failed in "), "{message}");
    assert!(message.contains(" evaluations, such as at (") && message.contains(what), "{message}");
    assert_eq!(message.matches("stripes\" failed").count(), 1, "{message}");
}

const ENDLESS: &str = "f(x)=f(x+1);shade=f(Px);\n";
const BEYOND: &str = "shade=if(Px,1e30*Pz*1e30,1);\n";

#[test]
fn endless_recursion_is_reported_once_with_position_and_count() {
    let run = picture(&ball(ENDLESS), &[]);
    assert_reported(&run, "functions call each other more than 100000 deep");
    assert_eq!(run.code, 0);
}

#[test]
fn functions_that_take_exponential_time_end_the_render() {
    let folder = ball("f(n)=if(n-.5,f(n-1)+f(n-1),1);shade=f(60);\n");
    let before = folder.names();
    let run = picture(&folder, &["-o", "out.hdr"]);
    assert_eq!(run.code, INPUT, "{}", run.messages);
    let told = "scene.rad:9:1: error: 8 evaluations of the functions of \"stripes\" take more than 50000000 steps each";
    assert!(run.messages.contains(told), "{}", run.messages);
    assert_eq!(folder.names(), before);
}

#[test]
fn values_outside_single_precision_are_reported() {
    let run = picture(&ball(BEYOND), &[]);
    assert_reported(&run, "a value exceeds single precision");
    assert_eq!(run.code, 0);
}

#[test]
fn faults_of_functions_are_errors_when_strict_and_leave_no_picture() {
    for functions in [ENDLESS, BEYOND] {
        let folder = ball(functions);
        let before = folder.names();
        let run = picture(&folder, &["--strict", "-o", "out.hdr"]);
        assert_eq!(run.code, INPUT, "{}", run.messages);
        assert_eq!(folder.names(), before);
    }
}

#[test]
fn nothing_is_reported_with_warnings_off_or_without_a_fault() {
    assert_eq!(picture(&ball(ENDLESS), &["-w"]).messages, "");
    assert_eq!(picture(&ball("shade=if(Px,.5,1);\n"), &["--strict"]).messages, "");
}

#[test]
fn no_picture_has_values_that_are_none() {
    for functions in ["shade=if(Px,1e300*Pz,1)*1e300;\n", "shade=if(Px,1e300*Pz,1)*1e300-if(Px,1e300*Pz,1)*1e300;\n"] {
        let folder = ball(functions);
        let run = picture(&folder, &["-ff"]);
        let start = run.output.windows(2).position(|pair| pair == b"\n\n").expect("a header ends") + 2;
        let start = start + run.output[start..].iter().position(|byte| *byte == b'\n').expect("a size ends") + 1;
        let (values, rest) = run.output[start..].as_chunks::<4>();
        assert_eq!((values.len(), rest.len()), (3 * 64, 0));
        assert!(values.iter().all(|value| f32::from_ne_bytes(*value).is_finite()), "{functions}: {}", run.messages);
    }
}

/// A lamp of infinite radiance behind a roof: the other lamp lights the ball as before.
#[test]
fn a_hidden_lamp_of_infinite_radiance_takes_no_light() {
    let folder = ball("shade=1;\n");
    folder.file("endless.cal", "endless=if(Pz,1e300,1)*1e300;\n");
    let roof = "void plastic black\n0\n0\n5 0 0 0 0 0\nblack ring roof\n0\n0\n8 0 -3 6 0 0 -1 0 9\n";
    let lamp = "void brightfunc pattern\n2 endless endless.cal\n0\n0\npattern light sun\n0\n0\n3 1 1 1\n\
                sun sphere hidden\n0\n0\n4 0 -3 9 .5\n";
    let scene = [roof, lamp].map(|part| {
        let before = std::fs::read_to_string(folder.path("scene.rad")).expect("the scene can be read");
        folder.file("scene.rad", format!("{before}{part}"));
        let run = picture(&folder, &["-ff", "-pa", "1"]);
        assert_eq!(run.code, 0, "{}", run.messages);
        let start = run.output.windows(2).position(|pair| pair == b"\n\n").expect("a header ends");
        run.output[start..].to_vec()
    });
    let [without, with] = scene;
    assert_eq!(with, without);
}

#[test]
fn only_a_variable_defined_by_itself_is_reported() {
    let run = picture(&ball("a=b;b=a;shade=a;\n"), &[]);
    assert_eq!(run.code, INPUT, "{}", run.messages);
    assert!(run.messages.contains("variable \"a\" depends on itself"), "{}", run.messages);
    assert!(!run.messages.contains("modifies another material"), "{}", run.messages);
}

#[test]
fn an_index_of_refraction_of_zero_is_reported_with_its_material_and_rejected_when_strict() {
    let folder = Folder::new();
    folder.file("scene.rad", "void light l\n0\n0\n3 1 1 1\nl sphere lamp\n0\n0\n4 0 -3 3 .5\nvoid dielectric d\n0\n0\n5 1 1 1 0 0\nd sphere ball\n0\n0\n4 0 0 0 1\n");
    let told = "the refractive index of dielectric \"d\" is 0, expected a number above zero";
    let tolerant = picture(&folder, &[]);
    assert_eq!((tolerant.code, tolerant.messages.matches(told).count()), (0, 1), "{}", tolerant.messages);
    let strict = picture(&folder, &["--strict"]);
    assert_eq!((strict.code, strict.messages.matches(told).count()), (INPUT, 1), "{}", strict.messages);
}

#[test]
fn contributions_are_numbers_too() {
    let folder = ball("shade=if(Px,1e300*Pz,1)*1e300;\n");
    let mut command = command(&["rcontrib", "-h", "-V+", "-m", "l", "scene.rad"]);
    let run = run_with(command.current_dir(folder.path("")), b".1 -4 .4 0 1 0\n");
    let text = String::from_utf8(run.output).expect("the values are text");
    let values: Vec<f32> = text.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    assert_eq!(values.len(), 3, "{text}");
    assert!(values.iter().all(|value| value.is_finite() && *value > 1e38), "{text}");
    assert!(run.messages.contains("warning: the radiance of "), "{}", run.messages);
}

/// As in Radiance: an error of a pattern or texture counts when a ray meets the surface.
#[test]
fn unusable_patterns_and_textures_count_where_a_ray_meets_them() {
    let scene = |modifiers: &str| {
        format!(
            "void plastic good 0 0 5 .5 .5 .5 0 0\ngood sphere near 0 0 4 0 0 0 1\n\
             void light l 0 0 3 9 9 9\nl source sun 0 0 4 0 -.6 .8 1\n{modifiers}\n"
        )
    };
    let trace = |modifiers: &str, x: f64| {
        let folder = Folder::new();
        folder.file("scene.rad", scene(modifiers));
        let rays = format!("{x} -5 .5 0 1 0\n");
        run_with(command(&["rtrace", "-h", "-ab", "0", "scene.rad"]).current_dir(folder.path("")), rays.as_bytes())
    };
    let paint = "plastic bad 0 0 5 .5 .5 .5 0 0\nbad sphere far 0 0 4 5 0 0 1";
    let sheet = "glass bad 0 0 3 .9 .9 .9\nbad ring far 0 0 8 5 -3 3 0 -.6 .8 0 2.5\ngood sphere behind 0 0 4 5 0 0 1";
    for (modifiers, reason) in [
        (format!("void brightfunc p 2 none .\n0 0\np {paint}"), "unknown variable \"none\""),
        (format!("void brightfunc p 2 f none.cal\n0 0\np {paint}"), "cannot find function file \"none.cal\""),
        (format!("void brightfunc p 1 f\n0 0\np {paint}"), "brightfunc \"p\" has 1 string argument"),
        (format!("void brightdata p 4 noop none.dat . Px\n0 0\np {paint}"), "cannot find data file \"none.dat\""),
        (format!("void texfunc p 4 none 0 0 .\n0 0\np {paint}"), "unknown variable \"none\""),
        (format!("void brightfunc q 2 none .\n0 0\nvoid mixfunc p 4 q void .5 .\n0 0\np {paint}"), "\"none\""),
        // A shadow ray meets the pane.
        (format!("void brightfunc p 2 none .\n0 0\np {sheet}"), "unknown variable \"none\""),
        (
            "void brightfunc p 2 none .\n0 0\np glow bad 0 0 4 1 1 1 0\nbad source far 0 0 4 0 1 0 20".to_owned(),
            "\"none\"",
        ),
    ] {
        let apart = trace(&modifiers, 0.0);
        assert_eq!(apart.code, 0, "{modifiers}: {}", apart.messages);
        assert!(apart.messages.contains(reason) && apart.messages.contains("warning"), "{}", apart.messages);
        let met = trace(&modifiers, 5.0);
        assert_eq!(met.code, INPUT, "{modifiers}: {}", met.messages);
        let message = "error: a ray hit \"far\", whose material cannot be used: ";
        assert!(met.messages.contains(message) && met.messages.contains(reason), "{modifiers}: {}", met.messages);
    }
    // Every surface that a lamp lights evaluates its pattern.
    let lamp = trace("void brightfunc p 2 none .\n0 0\np light bad 0 0 3 1 1 1\nbad sphere far 0 0 4 0 0 9 1", 0.0);
    assert_eq!(lamp.code, INPUT, "{}", lamp.messages);
}
