//! A custom loader, which generates scene files on request. It needs no disk.

use radsight::{Error, FileKind, LoadError, Loaded, Loader, Renderer, Scene, View};

/// `lamps-N.rad` is a row of N lamps.
#[derive(Debug)]
struct Lamps;

impl Loader for Lamps {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        let count = name.strip_prefix("lamps-").and_then(|rest| rest.strip_suffix(".rad"));
        let Some(count) = count.and_then(|count| count.parse::<u32>().ok()) else {
            return Err(LoadError::not_found(name, kind));
        };
        let lamp = |lamp: u32| format!("glowing sphere lamp_{lamp} 0 0 4 {} 9 0 .3\n", f64::from(lamp) - 2.0);
        let text = std::iter::once("void glow glowing 0 0 4 1 1 1 0\n".to_owned()).chain((0..count).map(lamp));
        Ok(Loaded { path: name.to_owned(), bytes: text.collect::<String>().into_bytes() })
    }
}

pub(crate) fn main() -> Result<(), Error> {
    let scene = Scene::builder().loader(Lamps).files(["lamps-5.rad"])?.build()?;
    assert_eq!(scene.surface_count(), 5);
    let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 20")?;
    let image = Renderer::new(&scene)?.error(0.1).render(&view, 64, 32)?;
    print!("{}", image.report());
    Ok(())
}
