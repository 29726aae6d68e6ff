//! Prints evaluation times in nanoseconds for expressions that are typical of scenes.
//!
//! `cargo run --release -p radsight-cal --example cal_speed`

use radsight_cal::{Bindings, Definitions, Program, Root, Scope, Scratch};
use radsight_diag::SourceMap;
use std::hint::black_box;
use std::time::Instant;

/// Evaluations of one run; the quickest of [`RUNS`] counts, so that other work on the machine
/// matters less.
const EVALUATIONS: u32 = 10_000;
const RUNS: u32 = 300;

/// The relative intensity of an LED by its angle, as a chain of fifteen straight pieces.
fn led_table() -> String {
    let mut text = "angle = Acos(-Dz)/DEGREE; led = ".to_owned();
    for step in (0..15).rev() {
        let start = f64::from(step) * 2.0;
        text +=
            &format!("if(angle-{start}, linterp((angle-{start})/2, {}, {}), ", 1.0 - start / 40.0, 0.95 - start / 40.0);
    }
    text + "1" + &")".repeat(15) + ";"
}

fn main() {
    let cases = [
        ("constant", String::new(), "PI/4"),
        ("one channel", String::new(), "Dz"),
        ("short choice", String::new(), "if(Dz-.99,1,acos(Dz)*.3)"),
        ("LED, 15 branches", led_table(), "led"),
        ("cosine power", String::new(), "if(-Dz,(-Dz)^12.5,0)"),
        ("inside a box", String::new(), "if(and(inside(-.5,Px,.5),inside(-.5,Py,.5)),1,0)"),
        ("noise", String::new(), "1+.2*noise3(Px,Py,Pz)"),
        ("turbulence", String::new(), "turbulence(Px,Py,Pz,.1)"),
        ("recursion the ray ends", "down(x) = if(x,1+down(x-.1),0);".to_owned(), "down(abs(Dz))"),
        ("angles of a luminaire", String::new(), "source_phi(180)+source_theta(1)"),
    ];
    for (name, text, expression) in cases {
        println!("{name:>24}: {:7.1} ns", nanoseconds(&text, expression));
    }
}

fn nanoseconds(text: &str, expression: &str) -> f64 {
    let mut sources = SourceMap::default();
    let mut definitions = Definitions::with_initial_library();
    let source = sources.add("speed.cal", text.as_bytes(), None);
    definitions.load(source, text.as_bytes(), &Scope::global()).expect("the text is right");
    let root = Root::Expression { text: expression, span: sources.span(source, 0, 0) };
    let program = Program::compile(&definitions, &Scope::global(), &[root], &Bindings::of_ray()).expect("it compiles");
    let rays: Vec<[f64; 9]> = (0..1024).map(ray).collect();
    let mut scratch = Scratch::new();
    let mut quickest = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        let mut sum = 0.0;
        for index in 0..EVALUATIONS {
            let channels = &rays[index as usize % rays.len()][..];
            sum += program.eval(0, &[], channels, &mut scratch).unwrap_or(0.0);
        }
        black_box(sum);
        quickest = quickest.min(start.elapsed().as_secs_f64());
    }
    quickest * 1e9 / f64::from(EVALUATIONS)
}

/// Channels of a ray: direction within 40° of −z, normal, point.
fn ray(index: u32) -> [f64; 9] {
    let (turn, tilt) = (f64::from(index) * 2.4, f64::from(index * 7 % 1024) / 1024.0 * 0.7);
    let (x, y) = (turn.cos() * tilt.sin(), turn.sin() * tilt.sin());
    [x, y, -tilt.cos(), 0.0, 0.0, 1.0, 3.0 * x, 3.0 * y, 0.5 * turn]
}
