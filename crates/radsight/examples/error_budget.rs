//! The cost of accuracy: the same picture as a preview, and with errors of 10 % and 2 %.

use radsight::{Error, ErrorBudget, Renderer, Scene, View};
use std::time::Instant;

pub(crate) fn main() -> Result<(), Error> {
    let scene = Scene::load([concat!(env!("CARGO_MANIFEST_DIR"), "/../../radiance-scenes/gallery/materials.rad")])?;
    let view = View::from_args("-vp 0 -8 3.5 -vd 0 8 -2.6 -vh 40 -vv 30")?;
    let budgets =
        [("preview", ErrorBudget::default()), ("10 %", ErrorBudget::error(0.1)), ("2 %", ErrorBudget::error(0.02))];
    for (name, budget) in budgets {
        let begun = Instant::now();
        let image = Renderer::new(&scene)?.budget(budget).render(&view, 80, 60)?;
        println!("{name} in {:.2} s\n{}", begun.elapsed().as_secs_f64(), image.report());
    }
    Ok(())
}
