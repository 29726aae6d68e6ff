//! Set-ups with a few points, as in daylight and photovoltaic tools.

use crate::rooms::text::SceneText;
use glam::DVec3;

/// A scene and the points of its sensors.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub(super) name: &'static str,
    pub(super) scene: String,
    /// Position and direction of each sensor.
    pub(super) sensors: Vec<[DVec3; 2]>,
}

/// The room extends from the origin to this point, m; its window is in the wall at y = 0.
const ROOM: DVec3 = DVec3::new(4.0, 6.0, 3.0);

/// Left and right, low and high.
const WINDOW: [[f64; 2]; 2] = [[1.0, 3.0], [0.9, 2.6]];

/// The filling of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Opening {
    Empty,
    Blinds,
    Wall,
}

/// All of them.
pub(super) fn setups() -> [Setup; 5] {
    [
        indoors("nine points from a window with sun inwards", Opening::Empty, |scene| {
            sky(scene, 15.0);
            sun(scene);
        }),
        indoors("nine points from a window under an overcast sky", Opening::Empty, |scene| sky(scene, 20.0)),
        indoors("nine points behind blinds in the sun", Opening::Blinds, |scene| {
            sky(scene, 15.0);
            sun(scene);
        }),
        indoors("nine points by a lamp that shines upwards", Opening::Wall, |scene| {
            scene.modifier("void", "light", "lamp", &[500.0; 3]);
            scene.surface("lamp", "ring", &[1.2, 1.5, 2.0, 0.0, 0.0, 1.0, 0.0, 0.15]);
        }),
        modules(),
    ]
}

fn sky(scene: &mut SceneText, radiance: f64) {
    scene.modifier("void", "glow", "sky", &[radiance, radiance, radiance, 0.0]);
    scene.surface("sky", "source", &[0.0, 0.0, 1.0, 180.0]);
    scene.modifier("void", "glow", "ground", &[5.0, 5.0, 5.0, 0.0]);
    scene.surface("ground", "source", &[0.0, 0.0, -1.0, 180.0]);
}

fn sun(scene: &mut SceneText) {
    scene.modifier("void", "light", "solar", &[6e6; 3]);
    scene.surface("solar", "source", &[0.3, -0.7, 0.65, 0.533]);
}

fn paint(scene: &mut SceneText, name: &str, reflectance: f64) {
    scene.modifier("void", "plastic", name, &[reflectance, reflectance, reflectance, 0.0, 0.0]);
}

/// A line of sensors from the window inwards, at table height.
fn indoors(name: &'static str, opening: Opening, light: impl Fn(&mut SceneText)) -> Setup {
    let mut scene = SceneText::default();
    for (name, reflectance) in [("floor", 0.2), ("ceiling", 0.8), ("wall", 0.5), ("slat", 0.6)] {
        paint(&mut scene, name, reflectance);
    }
    light(&mut scene);
    shell(&mut scene, opening);
    let sensors = (1..=9).map(|at| [DVec3::new(2.0, 1.6 + 0.45 * f64::from(at), 0.8), DVec3::Z]).collect();
    Setup { name, scene: scene.as_str().to_owned(), sensors }
}

fn shell(scene: &mut SceneText, opening: Opening) {
    let DVec3 { x, y, z } = ROOM;
    let at = DVec3::new;
    scene.polygon("floor", &[at(0.0, 0.0, 0.0), at(x, 0.0, 0.0), at(x, y, 0.0), at(0.0, y, 0.0)]);
    scene.polygon("ceiling", &[at(0.0, 0.0, z), at(0.0, y, z), at(x, y, z), at(x, 0.0, z)]);
    scene.polygon("wall", &[at(0.0, y, 0.0), at(x, y, 0.0), at(x, y, z), at(0.0, y, z)]);
    scene.polygon("wall", &[at(0.0, 0.0, 0.0), at(0.0, y, 0.0), at(0.0, y, z), at(0.0, 0.0, z)]);
    scene.polygon("wall", &[at(x, 0.0, 0.0), at(x, 0.0, z), at(x, y, z), at(x, y, 0.0)]);
    let [[left, right], [low, high]] = WINDOW;
    let mut wall = |[left, right]: [f64; 2], [low, high]: [f64; 2]| {
        scene.polygon("wall", &[at(left, 0.0, low), at(left, 0.0, high), at(right, 0.0, high), at(right, 0.0, low)]);
    };
    wall([0.0, left], [0.0, z]);
    wall([right, x], [0.0, z]);
    wall([left, right], [0.0, low]);
    wall([left, right], [high, z]);
    match opening {
        Opening::Empty => {}
        Opening::Wall => wall([left, right], [low, high]),
        Opening::Blinds => {
            for slat in 0..((high - low) / 0.05) as u32 {
                let height = low + 0.05 * f64::from(slat);
                let corner = |x: f64, inwards: f64| at(x, -0.05 + 0.04 * inwards, height + 0.03 * inwards);
                scene.polygon("slat", &[corner(left, 0.0), corner(right, 0.0), corner(right, 1.0), corner(left, 1.0)]);
            }
        }
    }
}

/// Three rows of tilted modules over a meadow; the sensors are behind the middle row.
fn modules() -> Setup {
    let mut scene = SceneText::default();
    paint(&mut scene, "meadow", 0.2);
    paint(&mut scene, "module", 0.05);
    sky(&mut scene, 15.0);
    sun(&mut scene);
    let at = DVec3::new;
    let far = 60.0;
    scene.polygon("meadow", &[at(-far, -far, 0.0), at(far, -far, 0.0), at(far, far, 0.0), at(-far, far, 0.0)]);
    for row in [-5.0, 0.0, 5.0] {
        let corner = |x: f64, up: f64| at(x, row + 1.7 * up, 0.8 + up);
        scene.polygon("module", &[corner(-8.0, 0.0), corner(8.0, 0.0), corner(8.0, 1.0), corner(-8.0, 1.0)]);
    }
    let behind = at(0.0, 1.0, -1.7).normalize();
    let sensors = (1..=9)
        .map(|index| {
            let up = 0.1 * f64::from(index);
            [at(0.3, 1.7 * up, 0.8 + up) + 0.02 * behind, behind]
        })
        .collect();
    Setup { name: "nine points behind modules in the sun", scene: scene.as_str().to_owned(), sensors }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_ups_have_nine_sensors_with_unit_directions() {
        for setup in setups() {
            assert_eq!(setup.sensors.len(), 9, "{}", setup.name);
            assert!(setup.sensors.iter().all(|[_, direction]| (direction.length() - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn sensors_are_behind_their_modules() {
        let across = DVec3::new(0.0, -1.0, 1.7).normalize();
        let setup = modules();
        for [position, direction] in setup.sensors {
            // The plane of the middle row contains (0, 0, 0.8).
            assert!((across.dot(position - DVec3::new(0.0, 0.0, 0.8)) + 0.02).abs() < 1e-9);
            assert!(across.dot(direction) < -0.999);
        }
    }
}
