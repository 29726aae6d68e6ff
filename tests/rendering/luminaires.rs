//! Luminaires with measured distributions, beside the same ones whose functions are not recognised.

use crate::program::{Folder, command, run_with};

/// Zero from 50° to the negative z axis on, and a little light just before.
const TABLE: &str = "1\n0 90 10\n9 8 6 3 .5 0 0 0 0 0\n";

/// A round lamp that shines downwards; its distribution comes from a file of functions.
const LUMINAIRE: &str = "
void brightdata measured 4 flatcorr table.dat FUNCTIONS src_theta 0 1 2.5
measured light lamp 0 0 3 5 4 3
lamp ring disk 0 0 8 0 0 -.01 0 0 -1 0 .2
void plastic grey 0 0 5 .3 .3 .3 0 0
grey cylinder case 0 0 7 0 0 0 0 0 .3 .21
";

/// Three lamps, turned and mirrored, in a room with a mirror on a wall.
const ROOM: &str = "
!xform -t 0 0 2.5 lamp.rad
!xform -rx 35 -rz 20 -s .5 -t 1 -1 2.5 lamp.rad
!xform -mz -rx 160 -t -1 .5 2 lamp.rad
void plastic matte 0 0 5 .6 .5 .4 .02 .1
matte polygon floor 0 0 12 -3 -3 0 3 -3 0 3 3 0 -3 3 0
void mirror silver 0 0 3 .9 .9 .9
silver polygon wall 0 0 12 3 -3 0 3 -3 3 3 3 3 3 3 0
";

/// Radiances of rays to the floor.
fn radiances(functions: &str) -> String {
    let folder = Folder::new();
    folder.file("table.dat", TABLE);
    folder.file("own.cal", include_str!("../../crates/cal/library/source.cal"));
    folder.file("lamp.rad", LUMINAIRE.replace("FUNCTIONS", functions));
    folder.file("room.rad", ROOM);
    let rays: String = (0..900)
        .map(|ray| {
            let [x, y] = [ray % 30, ray / 30].map(|at| -2.9 + 0.2 * f64::from(at));
            format!("{x} {y} 1 .1 .1 -1\n")
        })
        .collect();
    run_with(command(&["rtrace", "-h", "-ab", "0", "room.rad"]).current_dir(folder.path("")), rays.as_bytes()).text()
}

#[test]
fn lamps_without_samples_beyond_their_last_angle_give_the_same_light() {
    let recognised = radiances("source.cal");
    assert_eq!(recognised, radiances("own.cal"));
    let lit = recognised.lines().filter(|line| !line.starts_with('0')).count();
    assert!((300..900).contains(&lit), "{lit} points are lit");
}
