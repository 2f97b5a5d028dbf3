//! Two programs beside each other: every F that differs, in blocks of any length, and planes by the angle between them.

use crate::support::{compiled, folder, input};
use splinepost::diff::{Comparison, Options, Origin, compare, detect};
use splinepost::geom::rotation::{Order, Rotation};
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use std::fs;

const NAMES: [&str; 3] = ["sinumerik", "heidenhain", "mazak"];

fn within(a: &str, b: &str, tolerance: Option<f64>) -> Comparison {
    let read = |text: &str| Sources::new(Source::new("part.nc", text));
    let machine = detect(&read(a)).unwrap_or_else(|errors| panic!("{errors:?}"));
    let own = Origin::Program(Box::new(machine));
    let other = detect(&read(b)).map_or(own.clone(), |machine| Origin::Program(Box::new(machine)));
    let found = compare([&read(a), &read(b)], [&own, &other], &Options { tolerance, radius: None });
    found.unwrap_or_else(|errors| panic!("{errors:?}"))
}

/// The same whichever is named first; what was found of the first order.
fn both_ways(a: &str, b: &str, tolerance: Option<f64>) -> Comparison {
    let (found, back) = (within(a, b, tolerance), within(b, a, tolerance));
    assert_eq!(found.figures.same, back.figures.same, "{:?}\n{:?}", found.differences, back.differences);
    found
}

/// CL data along X: each a place and the F of the way to it.
fn along(places: &[(f64, u32)]) -> String {
    let rows = places.iter().map(|(x, feed)| format!("FEDRAT/{feed},MMPM\nGOTO/{x:.4},0,0\n"));
    format!(
        "PARTNO FEEDS\nUNITS/MM\nLOADTL/1\nSPINDL/3000,RPM,CLW\nRAPID\nGOTO/0,0,0\n{}FINI\n",
        rows.collect::<String>()
    )
}

fn written(text: &str, name: &str) -> String {
    let machine = Machine::built_in(name).expect("a built-in");
    compiled(text, &machine, None).unwrap_or_else(|errors| panic!("{errors:?}")).text
}

/// Where F words have their last digit before any point.
fn feeds(text: &str) -> Vec<usize> {
    let bytes = text.as_bytes();
    let mut places = Vec::new();
    let mut from = 0;
    for line in text.split_inclusive('\n') {
        // Behind G4 it is a time.
        if !line.starts_with([';', '(']) && !line.contains("G4 ") {
            for (at, _) in line.match_indices(" F").chain(line.match_indices("G1F")) {
                let start = from + at + line[at..].find('F').unwrap_or(0) + 1;
                let count = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
                places.extend((0 < count).then(|| start + count - 1));
            }
        }
        from += line.len();
    }
    places
}

/// Paths of blocks of 0.0004 mm, a fifth of the tolerance of 0.002 mm, each at its own F; of long blocks with short ones between;
/// and of one place after the other at the same F.
fn short() -> [String; 2] {
    let each: Vec<(f64, u32)> = (1u32..=40).map(|i| (0.0004 * f64::from(i), 500 + 10 * i)).collect();
    let between: Vec<(f64, u32)> = (1u32..=20)
        .flat_map(|i| {
            let (x, feed) = (5.0 * f64::from(i), 300 + 20 * i);
            [(x, feed), (x + 0.0003, feed + 7), (x + 0.001, feed)]
        })
        .collect();
    [along(&each), along(&between)]
}

#[test]
fn every_changed_feed_is_found_however_short_its_block() {
    let mut programs: Vec<String> =
        short().iter().flat_map(|text| NAMES.map(|name| written(text, name))).collect();
    // F of lines is a time here.
    programs.push(written(&input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 3", ""), "mazak"));
    for (case, file) in
        [("nx-contour", "sinumerik.mpf"), ("nx-planes", "heidenhain.h"), ("fusion-turns", "mazak.eia")]
    {
        programs.push(fs::read_to_string(folder("fixtures/apt").join(case).join(file)).expect("a program"));
    }
    let mut count = 0;
    for text in programs {
        let places = feeds(&text);
        assert!(!places.is_empty(), "{text}");
        for at in places {
            let digit = text.as_bytes()[at] - b'0';
            let mut other = text.clone();
            other.replace_range(at..=at, &((digit + 1) % 10).to_string());
            let line = text[..at].matches('\n').count();
            let found = both_ways(&text, &other, None);
            assert!(!found.figures.same, "{}", text.lines().nth(line).unwrap_or_default());
            assert_eq!(found.differences.0[0].id, "feed-differs", "{:?}", found.differences);
            // One F is one difference, told at its line; where F stays in force, at the first block that moves.
            let span = found.differences.0[0].span.expect("a place");
            let told = text[..span.start as usize].matches('\n').count();
            assert!((line..=line + 2).contains(&told), "{told}, not {line}\n{text}");
            count += 1;
        }
    }
    println!("{count} feeds");
    assert!(300 < count, "{count}");
}

/// A path of 20 blocks of 10 mm, each at its own F, every end moved along by what `shift` says.
fn blocks(shift: impl Fn(i32) -> f64) -> String {
    let places = (1..=20).map(|i| {
        let x = 10.0 * f64::from(i);
        // The end of the whole path is one place.
        (if i == 20 { x } else { x + shift(i) }, 500 + 10 * i.unsigned_abs())
    });
    along(&places.collect::<Vec<_>>())
}

#[test]
fn block_limits_may_be_off_by_less_than_the_tolerance() {
    let plain = blocks(|_| 0.0);
    for (i, own) in NAMES.iter().enumerate() {
        let text = written(&plain, own);
        for name in NAMES {
            for shift in [0.0015, -0.0015] {
                for other in [blocks(|_| shift), blocks(|i| if i % 2 == 0 { shift } else { -shift })] {
                    let found = both_ways(&text, &written(&other, name), None);
                    assert!(found.figures.same, "{own} {name} {shift}: {:?}", found.differences);
                }
            }
            // Four tolerances of 0.002 mm are the most.
            for shift in [0.01, -0.01] {
                let found = both_ways(&text, &written(&blocks(|_| shift), name), None);
                assert_eq!(found.figures.differences, 19, "{own} {name} {shift}: {:?}", found.differences);
                assert_eq!(found.differences.0[0].id, "feed-differs");
            }
        }
        // And every F of the moved blocks counts.
        let moved = written(&blocks(|_| 0.0015), NAMES[(i + 1) % 3]);
        for at in feeds(&moved) {
            let digit = moved.as_bytes()[at] - b'0';
            let mut other = moved.clone();
            other.replace_range(at..=at, &((digit + 1) % 10).to_string());
            let found = both_ways(&text, &other, None);
            assert_eq!(found.differences.0.first().map(|d| d.id), Some("feed-differs"), "{other}");
        }
    }
}

/// Blocks of other limits, so that none is a block of the other, and an F that one of them has more, less or elsewhere.
#[test]
fn a_feed_more_or_less_is_found_where_no_blocks_correspond() {
    let text = |places: &[(f64, u32)]| written(&along(places), "sinumerik");
    let own = text(&[(3.0, 500), (9.9998, 500), (10.0004, 700), (20.0, 600)]);
    for (name, places, same) in [
        ("moved", &[(4.0, 500), (10.0, 500), (10.0006, 700), (20.0, 600)][..], true),
        ("longer", &[(4.0, 500), (9.999, 500), (10.001, 700), (20.0, 600)], true),
        ("another", &[(4.0, 500), (10.0, 500), (10.0006, 701), (20.0, 600)], false),
        ("missing", &[(4.0, 500), (10.0, 500), (10.0006, 600), (20.0, 600)], false),
        ("missing before", &[(4.0, 500), (10.0, 500), (10.0006, 500), (20.0, 600)], false),
        ("one more", &[(4.0, 500), (10.0, 500), (10.0006, 700), (10.001, 650), (20.0, 600)], false),
        ("swapped", &[(4.0, 500), (10.0, 700), (10.0006, 500), (20.0, 600)], false),
        ("at the start", &[(0.0005, 501), (10.0, 500), (10.0006, 700), (20.0, 600)], false),
        ("at the end", &[(4.0, 500), (10.0, 500), (10.0006, 700), (19.9995, 600), (20.0, 601)], false),
    ] {
        let found = both_ways(&own, &text(places), None);
        assert_eq!(found.figures.same, same, "{name}: {:?}", found.differences);
        if !same {
            assert_eq!(found.differences.0[0].id, "feed-differs", "{name}");
        }
    }
}

#[test]
fn planes_are_the_same_up_to_the_angle_that_both_machines_allow() {
    let path = folder("fixtures/apt/nx-planes/sinumerik.mpf");
    let text = fs::read_to_string(path).expect("a program");
    let machine = Machine::built_in("sinumerik").expect("a built-in");
    let allowed = 2.0 * machine.orientation.tolerance;
    let order = machine.orientation.plane_order;
    // Planes alone are looked at: what their difference moves is less than a millimetre here.
    let planes_within = |other: &str| both_ways(&text, other, Some(1.0));
    for angles in ["0,0,0", "90,0,0", "-45,35.26439,150"] {
        let own: Vec<f64> = angles.split(',').map(|angle| angle.parse().expect("an angle")).collect();
        let own = Rotation::of(order, [own[0], own[1], own[2]]);
        for axis in 0..3 {
            // Angles have five decimals, so that each of three is off by 5e-6 degrees at most.
            for (share, same) in [(0.45, true), (0.999, true), (1.001, false), (1.5, false)] {
                let turned = own.then(&Rotation::about(axis, share * allowed)).angles(order);
                let spelled = turned.map(|angle| format!("{angle:.5}")).join(",");
                let other = text.replace(
                    &format!("CYCLE800(0,\"\",0,57,0,0,0,{angles},"),
                    &format!("CYCLE800(0,\"\",0,57,0,0,0,{spelled},"),
                );
                assert_ne!(text, other);
                let found = planes_within(&other);
                assert_eq!(found.figures.same, same, "{angles} {axis} {share}: {:?}", found.differences);
                if same {
                    let degrees = found.figures.planes_deg.expect("planes");
                    assert!((degrees - share * allowed).abs() < 1.5e-5, "{degrees}, not {}", share * allowed);
                } else {
                    assert_eq!(found.differences.0[0].id, "step-differs");
                }
            }
        }
    }
    // Another order of angles is the same plane.
    assert!(Order::new("xyz") == Some(order) && found_same(&text));
}

fn found_same(text: &str) -> bool {
    let found = within(text, text, None);
    (found.figures.planes_deg, found.figures.same) == (Some(0.0), true)
}

/// Every program of the fixtures is the same as itself, exactly.
#[test]
fn every_golden_program_is_the_same_as_itself() {
    let mut count = 0;
    for folder in ["fixtures/apt", "fixtures/compile", "fixtures/curves"].map(folder) {
        for case in fs::read_dir(folder).expect("a folder").flatten() {
            for file in fs::read_dir(case.path()).expect("a folder").flatten() {
                let Ok(text) = fs::read_to_string(file.path()) else { continue };
                let sources = Sources::new(Source::new("part.nc", text.as_str()));
                if detect(&sources).is_err() {
                    continue;
                }
                let found = within(&text, &text, None);
                assert!(found.figures.same, "{}: {:?}", file.path().display(), found.differences);
                assert!(matches!(found.figures.deviation_mm, None | Some(0.0)), "{}", file.path().display());
                assert_eq!(sources.get(SourceId::INPUT).map(|s| s.text.len()), Some(text.len()));
                count += 1;
            }
        }
    }
    println!("{count} programs");
    assert!(60 < count, "{count}");
}
