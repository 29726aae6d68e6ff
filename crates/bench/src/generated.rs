//! Large scenes, written as text.

use crate::error::BenchError;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// A scene and its folder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Generated {
    pub(crate) what: &'static str,
    pub(crate) file: &'static str,
}

/// Squares along each side of the terrain; each is two triangles.
pub(crate) const SQUARES: u32 = 707;

const TRIANGLES: Generated = Generated { what: "999,698 triangles", file: "triangles.rad" };
const ARRAYS: Generated = Generated { what: "200,000 primitives in nested arrays", file: "city.rad" };

/// Writes all scenes.
pub(crate) fn write(folder: &Path) -> Result<[Generated; 2], BenchError> {
    triangles_in(folder, SQUARES)?;
    file(folder, "house.rad", house)?;
    file(folder, "street.rad", |out| out.write_all(STREET.as_bytes()))?;
    file(folder, ARRAYS.file, |out| out.write_all(CITY.as_bytes()))?;
    Ok([TRIANGLES, ARRAYS])
}

/// Writes only the terrain, with `side` squares along each side; returns its file.
pub(crate) fn triangles_in(folder: &Path, squares: u32) -> Result<&'static str, BenchError> {
    file(folder, TRIANGLES.file, |out| triangles(out, squares))?;
    Ok(TRIANGLES.file)
}

const STREET: &str = "!xform -n row -a 10 -t 1.5 0 0 -a 10 -t 0 1.5 .01 house.rad\n";

const CITY: &str = "void plastic wall 0 0 5 .6 .6 .5 0 0
void metal pipe 0 0 5 .7 .7 .7 .8 .05
!xform -n block -s .5 -a 10 -t 9 0 0 -rz 2 -a 10 -t 0 9 0 -rx 1 street.rad
";

fn file(folder: &Path, name: &str, text: impl Fn(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), BenchError> {
    let path = folder.join(name);
    let written = File::create(&path).and_then(|file| {
        let mut out = BufWriter::new(file);
        text(&mut out)?;
        out.flush()
    });
    written.map_err(|reason| BenchError::Write { path, reason })
}

/// A hilly square of terrain.
fn triangles(out: &mut BufWriter<File>, squares: u32) -> io::Result<()> {
    out.write_all(b"void plastic ground\n0\n0\n5 .5 .5 .5 0 0\n")?;
    let corner = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) / f64::from(squares), f64::from(j) / f64::from(squares));
        let height = 0.05 * (13.0 * x).sin() * (17.0 * y).cos() + 0.01 * (97.0 * x + 31.0 * y).sin();
        format!("{x:.6} {y:.6} {height:.6}")
    };
    let mut row: Vec<String> = (0..=squares).map(|j| corner(0, j)).collect();
    for i in 0..squares {
        let next: Vec<String> = (0..=squares).map(|j| corner(i + 1, j)).collect();
        for j in 0..squares as usize {
            let [a, b, c, d] = [&row[j], &next[j], &next[j + 1], &row[j + 1]];
            write!(out, "\nground polygon t{i}.{j}a\n0\n0\n9\n{a}\n{b}\n{c}\n")?;
            write!(out, "\nground polygon t{i}.{j}b\n0\n0\n9\n{a}\n{c}\n{d}\n")?;
        }
        row = next;
    }
    Ok(())
}

/// Twenty primitives of all forms in a unit cube.
fn house(out: &mut BufWriter<File>) -> io::Result<()> {
    for k in 0..4 {
        let at = 0.2 * f64::from(k);
        writeln!(out, "wall sphere ball.{k} 0 0 4 {at} .1 .2 .07")?;
        writeln!(out, "pipe cylinder pipe.{k} 0 0 7 {at} .3 0 {at} .3 .9 .04")?;
        writeln!(out, "pipe cone spout.{k} 0 0 8 {at} .5 0 {at} .6 .4 .06 .02")?;
        writeln!(out, "wall ring plate.{k} 0 0 8 {at} .8 .5 0 .3 1 .02 .08")?;
        writeln!(out, "wall polygon wall.{k} 0 0 12 {at} .9 0 {at} 1 0 {at} 1 .8 {at} .9 .7")?;
    }
    Ok(())
}
