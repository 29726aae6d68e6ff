//! Compares genbox, genprism, replmarks and similar generators with the real programs.

mod oracle;

use oracle::{Numbers, Radiance, TestLoader, expect_same, ours, words};

#[test]
fn boxes_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(1);
    let loader = TestLoader::default();
    let mut identical = 0;
    let lines = 300;
    for _ in 0..lines {
        let mut argv = words("genbox some_mat a.box");
        argv.extend((0..3).map(|_| numbers.text(0.51, 9.0)));
        match numbers.below(4) {
            0 => {}
            1 => argv.extend(["-b".into(), numbers.text(0.6, 2.0)]),
            2 => argv.extend(["-r".into(), "0.2".into()]),
            _ => {
                argv.extend(["-r".into(), format!("{:.3}", numbers.between(0.01, 0.25))]);
                argv.extend(["-n".into(), (1 + numbers.below(9)).to_string()]);
                if numbers.chance(2) {
                    argv.push("-s".into());
                }
            }
        }
        for option in ["-i", "-o"] {
            if numbers.chance(4) {
                argv.push(option.into());
            }
        }
        if argv.contains(&"-s".to_owned()) && !argv.contains(&"-o".to_owned()) {
            oracle::expect_same_smoothing(&radiance, &argv, b"", &loader);
        } else {
            identical += usize::from(expect_same(&radiance, &argv, b"", &loader));
        }
    }
    println!("genbox: {identical} of {lines} outputs are the same bytes");
}

#[test]
fn prisms_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(2);
    let loader = TestLoader::default();
    let mut identical = 0;
    let lines = 400;
    for _ in 0..lines {
        let count = 3 + numbers.below(9);
        let mut corners = Vec::new();
        for index in 0..count {
            let (angle, radius) = (index as f64 * 6.2 / count as f64, numbers.between(1.0, 4.0));
            corners.push(format!("{:.6}", radius * angle.cos()));
            corners.push(format!("{:.6}", radius * angle.sin()));
        }
        if numbers.chance(3) {
            corners.reverse();
        }
        let mut argv = words("genprism mat p.1");
        let mut standard_input = String::new();
        if numbers.chance(3) {
            argv.push("-".into());
            standard_input = corners.join("\n") + if numbers.chance(3) { " x" } else { "\n" };
        } else {
            argv.push(count.to_string());
            argv.extend(corners);
        }
        if numbers.chance(2) {
            let up = if numbers.chance(2) { -1.0 } else { 1.0 };
            argv.push("-l".into());
            argv.extend([numbers.text(-2.0, 2.0), numbers.text(-2.0, 2.0), numbers.text(up * 0.6, up * 3.0)]);
        }
        if numbers.chance(2) {
            argv.extend(["-r".into(), format!("{:.4}", numbers.between(0.01, 0.5))]);
        }
        for option in ["-c", "-e"] {
            if numbers.chance(4) {
                argv.push(option.into());
            }
        }
        identical += usize::from(expect_same(&radiance, &argv, standard_input.as_bytes(), &loader));
    }
    println!("genprism: {identical} of {lines} outputs are the same bytes");
}

#[test]
fn replaced_markers_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(3);
    let loader = TestLoader::default();
    let mut identical = 0;
    let lines = 200;
    for line in 0..lines {
        let mut scene = String::from("# a comment\n!xform -t 1 2 3 a.rad\nvoid plastic other\n0\n0\n5 1 1 1 0 0\n");
        scene += "other alias copy other\nother \"polygon\" \"with space\"\n0 0 9 1 2 3 4 5 6 7 8 9\n";
        for marker in 0..4 {
            let modifier = ["rmod", "other", "smod", "rmod"][marker];
            let quad = numbers.chance(3);
            let corner: [f64; 3] = std::array::from_fn(|_| numbers.between(-5.0, 5.0));
            let mut x: [f64; 3] = std::array::from_fn(|_| numbers.between(2.0, 3.0));
            let y: [f64; 3] = std::array::from_fn(|_| numbers.between(-1.0, 1.0));
            if numbers.chance(4) {
                x = [0.0, 0.0, 3.0];
            }
            let mut points = vec![corner];
            points.push(std::array::from_fn(|axis| corner[axis] + x[axis]));
            points.push(std::array::from_fn(|axis| corner[axis] + y[axis]));
            if quad {
                // The far side is indented, so that two long edges meet at one corner.
                points.insert(2, std::array::from_fn(|axis| corner[axis] + 0.2 * x[axis] + 1.001 * y[axis]));
            }
            let count = points.len() * 3;
            scene += &format!("{modifier} polygon m.{line}.{marker}\n0\n0\n{count}\n");
            for point in points {
                scene += &format!(" {:.7} {:.7} {:.7}\n", point[0], point[1], point[2]);
            }
        }
        let mut argv = words(["replmarks -s 1 -x dummy.rad rmod", "replmarks -i a.oct -m new rmod"][line % 2]);
        if numbers.chance(3) {
            argv = words("replmarks -I a.rtm -s .5 rmod -x b.rad -m other_mod smod");
        }
        let real = radiance.run(&argv, scene.as_bytes(), None);
        match ours(&argv, scene.as_bytes(), &loader) {
            Ok(output) => {
                let mine = String::from_utf8(output.standard_output).unwrap();
                assert_ne!(real.standard_output, "", "{}", real.standard_error);
                match oracle::compare(&mine, &real.standard_output) {
                    oracle::Likeness::Identical => identical += 1,
                    oracle::Likeness::Rounded => {}
                    oracle::Likeness::Different(what) => {
                        panic!("{argv:?} {what}\n{mine}\n---\n{}", real.standard_output)
                    }
                }
            }
            Err(error) => assert!(!real.succeeded, "{argv:?}: {error}\n{scene}"),
        }
    }
    println!("replmarks: {identical} of {lines} outputs are the same bytes");
}

#[test]
fn blinds_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(5);
    let loader = TestLoader::default();
    let (mut identical, lines) = (0, 200);
    for _ in 0..lines {
        let mut argv = words("genblinds mat blind");
        argv.extend([numbers.text(0.5, 3.0), numbers.text(0.5, 30.0), numbers.text(0.5, 30.0)]);
        argv.extend([numbers.below(7).to_string(), numbers.text(-80.0, 80.0)]);
        if numbers.chance(2) {
            argv.extend([["-r", "+r"][numbers.below(2)].to_owned(), numbers.text(1.8, 5.0)]);
        }
        identical += usize::from(expect_same(&radiance, &argv, b"", &loader));
    }
    println!("genblinds: {identical} of {lines} outputs are the same bytes");
}

#[test]
fn clocks_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    for line in
        ["genclock 12:34", "genclock -f paint 3.75", "genclock -c x -n y 23:1", "genclock -n z 0", "genclock 11:59:30"]
    {
        assert!(expect_same(&radiance, &words(line), b"", &TestLoader::default()), "{line}");
    }
}

#[test]
fn beads_lie_on_the_curve_at_the_asked_spacing() {
    let argv = words("genbeads mat b 0 0 0 1 2 3 4 0 0 0 0 -5 .1 .05");
    let text = String::from_utf8(ours(&argv, b"", &TestLoader::default()).unwrap().standard_output).unwrap();
    let spheres: Vec<Vec<f64>> = text
        .lines()
        .filter_map(|line| line.strip_prefix("4 "))
        .map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect())
        .collect();
    assert_eq!(spheres[0], [0.0, 0.0, 0.0, 0.1]);
    assert!(text.contains(&format!("mat sphere b.{}\n", spheres.len() - 1)));
    let last = spheres.last().unwrap();
    assert!((last[0] - 1.0).abs() < 0.1 && (last[1] - 2.0).abs() < 0.1 && (last[2] - 3.0).abs() < 0.1);
    for pair in spheres.windows(2) {
        let distance = (0..3).map(|axis| (pair[0][axis] - pair[1][axis]).powi(2)).sum::<f64>().sqrt();
        assert!((distance - 0.05).abs() < 0.01, "{distance}");
    }
}
