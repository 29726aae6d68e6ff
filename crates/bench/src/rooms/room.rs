//! A random room: its scene, its view and the options of its picture.

use super::random::Random;
use super::text::SceneText;
use glam::DVec3;
use std::f64::consts::PI;

/// A typical room.
#[derive(Clone, Debug)]
pub(super) struct Room {
    /// Scene text.
    pub(super) scene: String,
    /// Words of a view.
    pub(super) view: Vec<String>,
    /// Further options of `rpict`.
    pub(super) options: Vec<String>,
    /// Its contents, for the table.
    pub(super) contents: Vec<&'static str>,
}

/// Thickness of the walls, m.
const WALL: f64 = 0.25;

impl Room {
    /// The room of a seed.
    pub(super) fn new(seed: u64) -> Room {
        let mut builder = Builder::new(seed);
        builder.shell();
        builder.lamps();
        builder.furniture();
        builder.view()
    }
}

/// Builds a room from the origin to `size`, with windows in the wall at the largest y. Lengths in
/// m.
struct Builder {
    random: Random,
    scene: SceneText,
    size: DVec3,
    has_window: bool,
    /// Whether a lamp emits in all directions, or in all downward ones.
    is_lit: bool,
    contents: Vec<&'static str>,
}

impl Builder {
    fn new(seed: u64) -> Builder {
        let mut random = Random::new(seed);
        let size = DVec3::new(random.uniform(3.0, 8.0), random.uniform(3.0, 8.0), random.uniform(2.4, 3.5));
        let has_window = random.is(0.65);
        Builder { random, scene: SceneText::default(), size, has_window, is_lit: false, contents: Vec::new() }
    }

    /// A diffuse material of about this reflectance, slightly coloured.
    fn paint(&mut self, name: &str, reflectance: f64) {
        let tint = |random: &mut Random| (reflectance * random.uniform(0.85, 1.1)).min(0.9);
        let color = [tint(&mut self.random), tint(&mut self.random), tint(&mut self.random)];
        let gloss = if self.random.is(0.2) { [0.03, self.random.uniform(0.03, 0.2)] } else { [0.0; 2] };
        self.scene.modifier("void", "plastic", name, &[color[0], color[1], color[2], gloss[0], gloss[1]]);
    }

    /// Floor, ceiling and walls, and the outside of the windows.
    fn shell(&mut self) {
        for (name, low, high) in [("floor", 0.1, 0.5), ("ceiling", 0.6, 0.85), ("wall", 0.25, 0.8), ("frame", 0.3, 0.8)]
        {
            let reflectance = self.random.uniform(low, high);
            self.paint(name, reflectance);
        }
        let DVec3 { x, y, z } = self.size;
        let at = DVec3::new;
        self.scene.polygon("floor", &[at(0.0, 0.0, 0.0), at(x, 0.0, 0.0), at(x, y, 0.0), at(0.0, y, 0.0)]);
        self.scene.polygon("ceiling", &[at(0.0, 0.0, z), at(0.0, y, z), at(x, y, z), at(x, 0.0, z)]);
        self.scene.polygon("wall", &[at(0.0, 0.0, 0.0), at(0.0, 0.0, z), at(x, 0.0, z), at(x, 0.0, 0.0)]);
        self.scene.polygon("wall", &[at(0.0, 0.0, 0.0), at(0.0, y, 0.0), at(0.0, y, z), at(0.0, 0.0, z)]);
        self.scene.polygon("wall", &[at(x, 0.0, 0.0), at(x, 0.0, z), at(x, y, z), at(x, y, 0.0)]);
        if self.has_window {
            self.window();
        } else {
            self.scene.polygon("wall", &[at(0.0, y, 0.0), at(x, y, 0.0), at(x, y, z), at(0.0, y, z)]);
        }
        if self.random.is(0.3) {
            self.mirror();
        }
    }

    /// A wall with a window, whose jambs are as deep as the wall; sky, ground and possibly sun
    /// outside.
    fn window(&mut self) {
        let DVec3 { x, y, z } = self.size;
        let width = self.random.uniform(0.8, 0.8 * x);
        let left = self.random.uniform(0.1, x - width - 0.1);
        let sill = self.random.uniform(0.05, 1.1);
        let top = self.random.uniform(sill + 0.8, z - 0.1);
        let right = left + width;
        // The wall as four blocks around the window.
        for (low, high) in
            [([0.0, 0.0], [left, z]), ([right, 0.0], [x, z]), ([left, 0.0], [right, sill]), ([left, top], [right, z])]
        {
            let low = DVec3::new(low[0], y, low[1]);
            self.scene.block("wall", low, DVec3::new(high[0], y + WALL, high[1]), 0.0);
        }
        self.contents.push("window");
        if self.random.is(0.7) {
            self.scene.modifier("void", "glass", "pane", &[0.92, 0.93, 0.92]);
            let middle = y + 0.5 * WALL;
            let corners = [[left, sill], [left, top], [right, top], [right, sill]];
            self.scene.polygon("pane", &corners.map(|[x, z]| DVec3::new(x, middle, z)));
        }
        if self.random.is(0.35) {
            self.blinds([left, right], [sill, top]);
        }
        self.outside();
    }

    /// Slats in front of the pane.
    fn blinds(&mut self, [left, right]: [f64; 2], [sill, top]: [f64; 2]) {
        let reflectance = self.random.uniform(0.4, 0.75);
        self.paint("slat", reflectance);
        let (depth, tilt) = (self.random.uniform(0.03, 0.09), self.random.uniform(-0.9, 0.9));
        let count = ((top - sill) / (depth * self.random.uniform(0.8, 1.3))) as usize;
        let (sin, cos) = tilt.sin_cos();
        let middle = self.size.y + 0.25 * WALL;
        for slat in 0..count {
            let height = sill + (top - sill) * (slat as f64 + 0.5) / count as f64;
            let at =
                |x: f64, side: f64| DVec3::new(x, middle + side * 0.5 * depth * cos, height + side * 0.5 * depth * sin);
            self.scene.polygon("slat", &[at(left, -1.0), at(right, -1.0), at(right, 1.0), at(left, 1.0)]);
        }
        self.contents.push("blinds");
    }

    fn outside(&mut self) {
        let sky = self.random.log_uniform(3.0, 30.0);
        let ground = sky * self.random.uniform(0.1, 0.5);
        self.scene.modifier("void", "glow", "sky", &[0.9 * sky, sky, 1.15 * sky, 0.0]);
        self.scene.surface("sky", "source", &[0.0, 0.0, 1.0, 180.0]);
        self.scene.modifier("void", "glow", "ground", &[ground, ground, 0.8 * ground, 0.0]);
        self.scene.surface("ground", "source", &[0.0, 0.0, -1.0, 180.0]);
        if self.random.is(0.5) {
            let radiance = self.random.log_uniform(1e5, 3e6);
            let azimuth = self.random.uniform(-1.1, 1.1);
            let altitude = self.random.uniform(0.2, 1.1);
            let direction = DVec3::new(azimuth.sin() * altitude.cos(), azimuth.cos() * altitude.cos(), altitude.sin());
            self.scene.modifier("void", "light", "solar", &[radiance; 3]);
            self.scene.surface("solar", "source", &[direction.x, direction.y, direction.z, 0.533]);
            self.contents.push("sun");
        }
    }

    /// A plane mirror on the wall at x = 0.
    fn mirror(&mut self) {
        let reflectance = self.random.uniform(0.7, 0.95);
        self.scene.modifier("void", "mirror", "looking_glass", &[reflectance; 3]);
        let width = self.random.uniform(0.5, 0.6 * self.size.y);
        let near = self.random.uniform(0.1, self.size.y - width - 0.1);
        let (low, high) = (self.random.uniform(0.2, 1.0), self.random.uniform(1.5, self.size.z - 0.2));
        let at = |y: f64, z: f64| DVec3::new(0.02, y, z);
        let corners = [at(near, low), at(near + width, low), at(near + width, high), at(near, high)];
        self.scene.polygon("looking_glass", &corners);
        self.contents.push("mirror");
    }

    fn lamps(&mut self) {
        let fewest = usize::from(!self.has_window);
        for lamp in 0..self.random.count(fewest, 3) {
            let position = DVec3::new(
                self.random.uniform(0.4, self.size.x - 0.4),
                self.random.uniform(0.4, self.size.y - 0.4),
                self.size.z - self.random.uniform(0.1, 0.5),
            );
            let flux = self.random.log_uniform(0.3, 3.0);
            let form = self.random.count(0, 4);
            self.is_lit |= form < 4;
            match form {
                0 => self.sphere_lamp(lamp, position, flux),
                1 => self.disk_lamp(lamp, position, flux),
                2 => self.tube_lamp(lamp, position, flux),
                3 => self.quad_lamp(lamp, position, flux),
                _ => self.spot_lamp(lamp, position, flux),
            }
        }
    }

    fn light(&mut self, lamp: usize, radiance: f64) -> String {
        let name = format!("lamp{lamp}");
        self.scene.modifier("void", "light", &name, &[radiance, 0.9 * radiance, 0.7 * radiance]);
        name
    }

    fn sphere_lamp(&mut self, lamp: usize, position: DVec3, flux: f64) {
        let radius = self.random.log_uniform(0.03, 0.2);
        let name = self.light(lamp, flux / (PI * radius * radius));
        self.scene.surface(&name, "sphere", &[position.x, position.y, position.z, radius]);
        self.contents.push("sphere");
    }

    fn disk_lamp(&mut self, lamp: usize, position: DVec3, flux: f64) {
        let radius = self.random.log_uniform(0.05, 0.3);
        let name = self.light(lamp, flux / (PI * radius * radius));
        self.scene.surface(&name, "ring", &[position.x, position.y, position.z, 0.0, 0.0, -1.0, 0.0, radius]);
        self.contents.push("disk");
    }

    fn tube_lamp(&mut self, lamp: usize, position: DVec3, flux: f64) {
        let (radius, half) = (self.random.log_uniform(0.01, 0.04), self.random.uniform(0.2, 0.7));
        let name = self.light(lamp, flux / (4.0 * radius * half));
        let [first, last] = [-half, half].map(|along| (position.x + along).clamp(0.05, self.size.x - 0.05));
        self.scene.surface(&name, "cylinder", &[first, position.y, position.z, last, position.y, position.z, radius]);
        self.contents.push("tube");
    }

    /// The corners of a horizontal quad that faces down.
    fn panel(&mut self, position: DVec3) -> [DVec3; 4] {
        let [x, y] = [self.random.uniform(0.1, 0.4), self.random.uniform(0.1, 0.4)];
        [[-x, -y], [-x, y], [x, y], [x, -y]].map(|[x, y]| position + DVec3::new(x, y, 0.0))
    }

    fn quad_lamp(&mut self, lamp: usize, position: DVec3, flux: f64) {
        let corners = self.panel(position);
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[1]).length();
        let name = self.light(lamp, flux / area);
        self.scene.polygon(&name, &corners);
        self.contents.push("quad");
    }

    fn spot_lamp(&mut self, lamp: usize, position: DVec3, flux: f64) {
        let corners = self.panel(position).map(|corner| position + 0.3 * (corner - position));
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[1]).length();
        let (angle, radiance) = (self.random.uniform(30.0, 90.0), 3.0 * flux / area);
        let [x, y] = [self.random.uniform(-0.4, 0.4), self.random.uniform(-0.4, 0.4)];
        let name = format!("lamp{lamp}");
        self.scene.modifier("void", "spotlight", &name, &[radiance, 0.9 * radiance, 0.7 * radiance, angle, x, y, -1.0]);
        self.scene.polygon(&name, &corners);
        self.contents.push("spot");
    }

    fn furniture(&mut self) {
        for piece in 0..self.random.count(1, 5) {
            let name = format!("wood{piece}");
            let is_dark = self.random.is(0.4);
            let reflectance = if is_dark { self.random.uniform(0.02, 0.08) } else { self.random.uniform(0.15, 0.6) };
            self.paint(&name, reflectance);
            if is_dark {
                self.contents.push("dark");
            }
            if self.random.is(0.4) { self.table(&name) } else { self.cupboard(&name) }
        }
        if self.random.is(0.35) {
            self.glass_body();
        }
        if self.random.is(0.35) {
            self.plant();
        }
    }

    /// A position on the floor with this margin to the walls.
    fn position(&mut self, margin: f64) -> DVec3 {
        let [x, y] = [self.size.x, self.size.y].map(|size| self.random.uniform(margin, size - margin));
        DVec3::new(x, y, 0.0)
    }

    fn cupboard(&mut self, name: &str) {
        let half = DVec3::new(self.random.uniform(0.15, 0.5), self.random.uniform(0.15, 0.4), 0.0);
        let height = self.random.uniform(0.3, 0.8 * self.size.z);
        let rotation = if self.random.is(0.5) { 0.0 } else { self.random.uniform(-0.8, 0.8) };
        let position = self.position(0.75);
        self.scene.block(name, position - half, position + half + DVec3::Z * height, rotation);
    }

    fn table(&mut self, name: &str) {
        let half = DVec3::new(self.random.uniform(0.3, 0.7), self.random.uniform(0.25, 0.5), 0.0);
        let height = self.random.uniform(0.6, 0.9);
        let position = self.position(0.9);
        let top = DVec3::Z * height;
        self.scene.block(name, position - half + top, position + half + top + DVec3::Z * 0.03, 0.0);
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            let leg = position + DVec3::new(x * (half.x - 0.05), y * (half.y - 0.05), 0.0);
            let thick = DVec3::new(0.025, 0.025, 0.0);
            self.scene.block(name, leg - thick, leg + thick + top, 0.0);
        }
    }

    /// A sphere or a block of glass on a plinth.
    fn glass_body(&mut self) {
        self.scene.modifier("void", "dielectric", "crystal", &[0.95, 0.97, 0.96, 1.52, 0.0]);
        let position = self.position(0.6);
        let (radius, height) = (self.random.uniform(0.1, 0.3), self.random.uniform(0.3, 1.0));
        let half = DVec3::new(radius, radius, 0.0);
        self.scene.block("frame", position - half, position + half + DVec3::Z * height, 0.0);
        let middle = position + DVec3::Z * (height + radius + 0.01);
        if self.random.is(0.6) {
            self.scene.surface("crystal", "sphere", &[middle.x, middle.y, middle.z, radius]);
        } else {
            let half = DVec3::splat(0.7 * radius);
            let rotation = self.random.uniform(0.0, 1.0);
            self.scene.block("crystal", middle - half, middle + half, rotation);
        }
        self.contents.push("glass");
    }

    /// Translucent leaves without a stem.
    fn plant(&mut self) {
        self.scene.modifier("void", "trans", "leaf", &[0.25, 0.45, 0.15, 0.02, 0.1, 0.3, 0.0]);
        let position = self.position(0.7);
        let (height, spread) = (self.random.uniform(0.5, 1.4), self.random.uniform(0.15, 0.45));
        for _ in 0..self.random.count(20, 80) {
            let mut within = |size: f64| self.random.uniform(-size, size);
            let middle = position + DVec3::new(within(spread), within(spread), height + within(spread));
            let across = DVec3::new(within(0.06), within(0.06), within(0.06));
            let along = DVec3::new(within(0.1), within(0.1), within(0.1));
            self.scene.polygon("leaf", &[middle - across, middle + along, middle + across]);
        }
        self.contents.push("plant");
    }

    /// The view of the room, and the requested quality.
    fn view(mut self) -> Room {
        let eye = DVec3::new(
            self.random.uniform(0.15, self.size.x - 0.15),
            self.random.uniform(0.1, 0.25 * self.size.y),
            self.random.uniform(1.0, 1.8),
        );
        let aim = DVec3::new(
            self.random.uniform(0.0, self.size.x),
            self.random.uniform(0.5 * self.size.y, self.size.y),
            self.random.uniform(0.2, 1.6),
        );
        let direction = aim - eye;
        let angle = self.random.uniform(45.0, 90.0);
        let view = format!(
            "-vtv -vp {:.4} {:.4} {:.4} -vd {:.4} {:.4} {:.4} -vu 0 0 1 -vh {angle:.2} -vv {:.2}",
            eye.x,
            eye.y,
            eye.z,
            direction.x,
            direction.y,
            direction.z,
            2.0 * (0.75 * (0.5 * angle).to_radians().tan()).atan().to_degrees(),
        );
        let divisions = 256 << self.random.count(0, 2);
        let options = format!(
            "-ab {} -aa {:.2} -ar {} -ad {divisions} -as {}",
            // With one bounce, a room without a lamp that emits in all directions would be mostly
            // black.
            self.random.count(if self.is_lit { 1 } else { 2 }, 3),
            self.random.uniform(0.1, 0.25),
            64 << self.random.count(0, 2),
            divisions / 4,
        );
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect();
        self.contents.dedup();
        Room {
            scene: self.scene.as_str().to_owned(),
            view: words(&view),
            options: words(&options),
            contents: self.contents,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rooms_repeat_with_their_seed_and_contain_all_required_parts() {
        let rooms: Vec<Room> = (0..100).map(Room::new).collect();
        assert_eq!(Room::new(3).scene, rooms[3].scene);
        assert_ne!(rooms[3].scene, rooms[4].scene);
        for content in
            ["window", "blinds", "sun", "mirror", "sphere", "disk", "tube", "quad", "spot", "dark", "glass", "plant"]
        {
            let count = rooms.iter().filter(|room| room.contents.contains(&content)).count();
            assert!((5..=95).contains(&count), "{content}: {count} of 100");
        }
        for bounces in ["1", "2", "3"] {
            assert!(rooms.iter().any(|room| room.options[1] == bounces));
        }
    }

    #[test]
    fn every_room_has_light() {
        for seed in 0..200 {
            let room = Room::new(seed);
            assert!(
                room.scene.contains(" light ") || room.scene.contains(" spotlight ") || room.scene.contains(" glow ")
            );
        }
    }
}
