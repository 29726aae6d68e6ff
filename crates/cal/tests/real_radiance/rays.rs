//! Patterns on surfaces compared with `rtrace`: scopes of files, real arguments, noise, channels of
//! a ray.

use crate::close;
use crate::oracle::{Radiance, to_bytes, to_numbers};
use crate::writer::Dice;
use radsight_cal::{Bindings, Definitions, Program, Root, Scope, Scratch};
use radsight_diag::SourceMap;
use std::fmt::Write;

/// Function files in which the same names mean different things.
const FILES: [(&str, &str); 3] = [
    (
        "first.cal",
        "v = 2*Px + A1; f(x) = x + v; later = w`first*2; w`first = 9; w = Py; mine = f(w)+`w;
         everywhere` = Px+7; c : sqrt(2)*PI; sqrt(x) = 5; hidden = sqrt(4)+sqrt`(4);",
    ),
    ("second.cal", "v = 100 + Py; f(x) = x*v; mine = f(2)+everywhere+v`first; PI : 3; round = PI+PI`; f2 = f(v);"),
    ("folder/in.cal", "v = arg(2)*Px; mine = v + if(arg(0)-2.5, arg(3), -1);"),
];

/// Patterns: expression and file.
const PATTERNS: [(&str, &str); 52] = [
    ("mine", "first.cal"),
    ("hidden", "first.cal"),
    ("c", "first.cal"),
    ("f(later)", "first.cal"),
    ("everywhere", "first.cal"),
    ("mine", "second.cal"),
    ("round", "second.cal"),
    ("f2", "second.cal"),
    ("`v+v`first", "second.cal"),
    ("mine", "folder/in.cal"),
    ("v", "folder/in.cal"),
    ("arg(0)", "."),
    ("A1+A2*10+A3*100", "."),
    ("arg(1.6)+arg(1+3*frac(Px))", "."),
    ("noise3(Px*3,Py*5,.3)", "."),
    ("noise3x(Px*3,Py*5,.3)", "."),
    ("noise3y(-Px*3,-Py*5,-.3)", "."),
    ("noise3z(Px*3,-Py*5,7.3)", "."),
    ("fnoise3(Px*3,Py*5,.3)", "."),
    ("fnoise3(-Px*30,Py*500,-7.3)", "."),
    ("noise3a(Px,Py,1)+noise3b(Px,Py,1)+noise3c(Px,Py,1)", "."),
    ("noise3d(2,Px,Py,1.7)", "."),
    ("turbulence(Px,Py,.4,.1)", "."),
    ("turbulencex(Px,Py,.4,.1)", "."),
    ("turbulencey(Px,Py,.4,.1)", "."),
    ("turbulencez(Px,Py,.4,.1)", "."),
    ("noise3(300*Px,-1e5*Py,1e7)", "."),
    ("rand(Px)+rand(-Py*1e6)", "."),
    ("nrand(Px)", "."),
    ("unif2norm(mod(Px,1))", "."),
    ("erf(Px-5)+erfc(Py)", "."),
    ("Dx+2*Dy+3*Dz", "."),
    ("Nx+2*Ny+3*Nz", "."),
    ("Px+2*Py+3*Pz", "."),
    ("T+Ts*10+Rdot*100", "."),
    ("S+Tx+2*Ty+3*Tz", "."),
    ("Ix+2*Iy+4*Iz+Jx+3*Jy+Jz+Kx+Ky+7*Kz", "."),
    ("dot(D,N)+dot(P,D)", "."),
    ("cross(1,D,P)+cross(2,D,P)*3+cross(3,D,P)*9", "."),
    ("U+10*V", "."),
    ("source_theta(1)", "."),
    ("source_phi(90)/100", "."),
    ("source_phi(180)/100", "."),
    ("source_phi(360)/100", "."),
    ("source_corr(Px, 0)", "."),
    ("source_corr(Px, 1)", "."),
    ("source_corr(Px, 2)", "."),
    ("source_corr(Px, 3)", "."),
    ("source_corr(Px, 4)", "."),
    ("fade(1,2,T)+hermite(1,2,3,4,mod(Px,1))", "."),
    ("bezier(1,2,3,4,mod(Px,1))+bspline(1,2,3,4,mod(Py,1))", "."),
    ("1/(Pz*Nx)+sin(1)", "."),
];

const REAL_ARGUMENTS: [f64; 4] = [0.5, 0.25, 0.125, 0.75];
const RAYS: usize = 25;

/// Offset of every pattern, which keeps radiance positive.
const OFFSET: f64 = 20.0;

/// A scene with a square for each pattern, from x = 2i to 2i + 1.
fn scene() -> String {
    let mut text = String::new();
    for (index, (expression, file)) in PATTERNS.iter().enumerate() {
        let (left, right) = (2 * index, 2 * index + 1);
        writeln!(
            text,
            "void brightfunc p{index}\n2 {OFFSET}+{} {file}\n0\n4 .5 .25 .125 .75",
            expression.replace(' ', "")
        )
        .unwrap();
        writeln!(text, "p{index} glow g{index} 0 0 4 1 1 1 0").unwrap();
        writeln!(text, "g{index} polygon q{index} 0 0 12 {left} 0 0 {right} 0 0 {right} 1 0 {left} 1 0").unwrap();
    }
    text
}

/// Rays from above, by their start and unit direction.
fn rays(index: usize) -> Vec<[f64; 6]> {
    let mut dice = Dice::new(index as u64 + 50);
    let mut uniform = || dice.below(1 << 20) as f64 / (1 << 20) as f64;
    (0..RAYS)
        .map(|_| {
            let target = [2.0 * index as f64 + uniform(), uniform(), 0.0];
            let direction = [uniform() - 0.5, uniform() - 0.5, -1.0 - uniform()];
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            let [x, y, z] = direction.map(|x| x / length);
            let distance = 2.0 + uniform();
            [target[0] - x * distance, target[1] - y * distance, -z * distance, x, y, z]
        })
        .collect()
}

/// The channels of a ray that hits the level plane.
fn channels(ray: &[f64; 6]) -> [f64; 27] {
    let [x, y, z, dx, dy, dz] = *ray;
    let distance = -z / dz;
    let mut channels = [0.0; 27];
    channels[..9].copy_from_slice(&[dx, dy, dz, 0.0, 0.0, 1.0, x + dx * distance, y + dy * distance, 0.0]);
    channels[9..12].copy_from_slice(&[distance, -dz, 1.0]);
    for axis in [15, 19, 23] {
        channels[axis] = 1.0;
    }
    channels[24] = distance;
    channels
}

#[test]
fn patterns_have_the_values_that_rtrace_sees() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    for (name, text) in FILES {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let all: Vec<[f64; 6]> = (0..PATTERNS.len()).flat_map(rays).collect();
    std::fs::write(folder.path().join("scene.rad"), scene()).unwrap();
    let Some(octree) = radiance.run_in(folder.path(), "oconv", &["scene.rad"], b"") else {
        println!("skipped: oconv not found");
        return;
    };
    std::fs::write(folder.path().join("scene.oct"), octree).unwrap();
    let arguments = ["-h", "-fdd", "-ov", "-w", "-ab", "0", "scene.oct"];
    let output = radiance.run_in(folder.path(), "rtrace", &arguments, &to_bytes(all.as_flattened()));
    let theirs = to_numbers(&output.expect("rtrace traces"));
    assert_eq!(theirs.len(), 3 * all.len());

    let mut sources = SourceMap::default();
    let mut definitions = Definitions::with_initial_library();
    let mut scratch = Scratch::new();
    for (index, (expression, file)) in PATTERNS.iter().enumerate() {
        let scope = Scope::of_file(file);
        if !definitions.is_loaded(&scope) {
            let (_, text) = FILES.iter().find(|(name, _)| name == file).unwrap();
            let source = sources.add(*file, text.as_bytes(), None);
            definitions.load(source, text.as_bytes(), &scope).unwrap();
        }
        let text = format!("{OFFSET}+{expression}");
        let source = sources.add("scene.rad", text.as_bytes(), None);
        let root = Root::Expression { text: &text, span: sources.span(source, 0, text.len()) };
        let bindings = Bindings { real_arguments: &REAL_ARGUMENTS, ..Bindings::of_ray() };
        let program = Program::compile(&definitions, &scope, &[root], &bindings)
            .unwrap_or_else(|problems| panic!("{}", problems[0].render(&sources)));
        for (ray, theirs) in rays(index).iter().zip(theirs[3 * RAYS * index..].chunks(3)) {
            // After a computation error in Radiance, the pattern has no effect.
            let value = program.eval(0, &[], &channels(ray)[..], &mut scratch).unwrap_or(1.0);
            assert!(close(value, theirs[0]), "{expression} in {file} is {value}, rtrace has {}", theirs[0]);
        }
    }
}
