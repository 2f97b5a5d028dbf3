//! Arcs and helices, evaluated from the programs' text alone by the manuals' formulas, against the closed form of what was
//! asked; and damaged ones.

#![allow(
    clippy::disallowed_methods,
    reason = "the oracle uses the platform's functions so that it shares no code with the crate"
)]

use super::program;
use splinepost::dialect::Dialect;
use splinepost::machine::Machine;
use splinepost::source::{Source, Sources};
use splinepost::{Options, front, verify_program};
use std::f64::consts::PI;

type Point = [f64; 3];

/// An arc as CIRCLE states it in Creo: counter-clockwise about its axis.
struct Case {
    name: &'static str,
    start: Point,
    center: Point,
    axis: Point,
    end: Point,
    /// Degrees, counter-clockwise about +X, +Y or +Z.
    sweep: f64,
    /// The words that each dialect has for it: Sinumerik, Heidenhain, Mazak.
    words: [&'static str; 3],
}

const CASES: &[Case] = &[
    Case {
        name: "three quarters in X Y",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [5.0, 5.0, 0.0],
        sweep: 270.0,
        words: ["G3 X5 Y5 I5 J0", "C X+5 Y+5 DR+", "G3 X5. Y5. I5. J0."],
    },
    Case {
        name: "a whole circle in X Y",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, -1.0],
        end: [0.0, 0.0, 0.0],
        sweep: -360.0,
        words: ["G2 X0 Y0 I5 J0", "C X+0 Y+0 DR-", "G2 X0. Y0. I5. J0."],
    },
    Case {
        name: "a quarter in Z X",
        start: [0.0, 2.0, 5.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        end: [5.0, 2.0, 0.0],
        sweep: 90.0,
        words: ["CIP X5 Z0 I1=AC(3.535534) J1=AC(2) K1=AC(3.535534)", "L X", "G18 G3 X5. Z0. I0. K-5."],
    },
    Case {
        name: "a whole circle in Z X",
        start: [0.0, 2.0, 5.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, -1.0, 0.0],
        end: [0.0, 2.0, 5.0],
        sweep: -360.0,
        words: ["CIP X0 Z-5", "L X", "G18 G2 X0. Z5. I0. K-5."],
    },
    Case {
        name: "three quarters in Y Z",
        start: [1.0, 5.0, 0.0],
        center: [1.0, 0.0, 0.0],
        axis: [-1.0, 0.0, 0.0],
        end: [1.0, 0.0, 5.0],
        sweep: -270.0,
        words: ["CIP Y0 Z5 I1=AC(1)", "L Y", "G19 G2 Y0. Z5. J-5. K0."],
    },
    Case {
        name: "a helix of three quarters",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [5.0, 5.0, -3.0],
        sweep: 270.0,
        words: ["G3 X5 Y5 Z-3 I5 J0", "CP IPA+270 IZ-3 DR+", "G3 X5. Y5. Z-3. I5. J0."],
    },
    Case {
        name: "a helix of a whole turn",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, -1.0],
        end: [0.0, 0.0, -3.0],
        sweep: -360.0,
        words: ["G2 X0 Y0 Z-3 I5 J0", "CP IPA-360 IZ-3 DR-", "G2 X0. Y0. Z-3. I5. J0."],
    },
    Case {
        // atan2(4, −3) of the 3-4-5 triangle: an angle that rounds.
        name: "a helix that ends at no round angle",
        start: [10.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [2.0, 4.0, 1.0],
        sweep: 126.869_897_645_844,
        words: ["G3 X2 Y4 Z1 I-5 J0", "CP IPA+126.8699 IZ+1 DR+", "G3 X2. Y4. Z1. I-5. J0."],
    },
    Case {
        // Its sagitta is 5e-5 mm: three places with six decimals say where it runs, and nothing about its centre.
        name: "a flat arc in Z X",
        start: [0.0, 2.0, 1000.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        end: [0.6, 2.0, 999.999_82],
        sweep: 0.034_377_469,
        words: ["X0.6 Z999.99982", "L X+0.6", "G18 G3 X0.6"],
    },
];

impl Case {
    fn text(&self) -> String {
        let list = |p: Point| p.map(|x| x.to_string()).join(",");
        let [x, y, _] = self.start;
        format!(
            "PARTNO ARC\nLOADTL/1\nSPINDL/500,CLW\nFEDRAT/100\nRAPID\nGOTO/{x},{y},1200\nGOTO/{start}\n\
             CIRCLE/{center},{axis},{radius}\nGOTO/{end}\nGOTO/40,-30,1100\nGOTO/40,-30,1200\nFINI\n",
            start = list(self.start),
            center = list(self.center),
            axis = list(self.axis),
            radius = self.radius(),
            end = list(self.end),
        )
    }

    /// Which coordinates are u, v and w of its plane.
    fn plane(&self) -> [usize; 3] {
        let w = (0..3).find(|i| self.axis[*i] != 0.0).expect("an axis");
        [(w + 1) % 3, (w + 2) % 3, w]
    }

    fn radius(&self) -> f64 {
        let [u, v, _] = self.plane();
        (self.start[u] - self.center[u]).hypot(self.start[v] - self.center[v])
    }
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("`{text}` is no number"))
}

/// The points of a turn by `sweep` radians about `center`, each of 1/400 of it, w evenly along.
fn turn([u, v, w]: [usize; 3], from: Point, center: [f64; 2], sweep: f64, rise: f64) -> Vec<Point> {
    let (x, y) = (from[u] - center[0], from[v] - center[1]);
    let (radius, angle) = (x.hypot(y), y.atan2(x));
    (1..=400)
        .map(|i| {
            let t = f64::from(i) / 400.0;
            let mut p = from;
            p[u] = center[0] + radius * (angle + t * sweep).cos();
            p[v] = center[1] + radius * (angle + t * sweep).sin();
            p[w] = from[w] + t * rise;
            p
        })
        .collect()
}

/// The sweep from one place to another about a centre; a place that is the other is a whole turn.
fn sweep_to([u, v, _]: [usize; 3], from: Point, to: Point, center: [f64; 2], clockwise: bool) -> f64 {
    if from[u] == to[u] && from[v] == to[v] {
        return if clockwise { -2.0 * PI } else { 2.0 * PI };
    }
    let angle = |p: Point| (p[v] - center[1]).atan2(p[u] - center[0]);
    let sweep = (angle(to) - angle(from)).rem_euclid(2.0 * PI);
    if clockwise { sweep - 2.0 * PI } else { sweep }
}

/// CIP: the circle through three places of a plane, by its perpendicular bisectors, run by the second.
fn by_way(from: Point, way: Point, to: Point) -> Vec<Point> {
    let w = (0..3).find(|i| from[*i] == way[*i] && from[*i] == to[*i]).expect("a plane");
    let plane @ [u, v, _] = [(w + 1) % 3, (w + 2) % 3, w];
    let (b, c) = ([way[u] - from[u], way[v] - from[v]], [to[u] - from[u], to[v] - from[v]]);
    let cross = b[0] * c[1] - b[1] * c[0];
    let (bb, cc) = (b[0] * b[0] + b[1] * b[1], c[0] * c[0] + c[1] * c[1]);
    let center = [
        from[u] + (c[1] * bb - b[1] * cc) / (2.0 * cross),
        from[v] + (b[0] * cc - c[0] * bb) / (2.0 * cross),
    ];
    turn(plane, from, center, sweep_to(plane, from, to, center, cross < 0.0), 0.0)
}

/// Where a program goes at feed, in order, from its text.
fn run(dialect: &str, text: &str) -> Vec<Point> {
    let mut at: Point = [0.0; 3];
    let mut path = Vec::new();
    let (mut mode, mut plane, mut about) = ("", [0, 1, 2], [0.0; 2]);
    for line in text.lines().filter(|line| !line.contains([';', '(', '%']) || line.contains("AC(")) {
        let mut words: Vec<&str> = line.split_whitespace().collect();
        if words.first().is_some_and(|word| word.trim_start_matches('N').parse::<u32>().is_ok()) {
            words.remove(0);
        }
        let (mut to, mut center, mut way) = (at, [0.0; 3], at);
        let (mut named, mut rapid) = (false, false);
        let (mut clockwise, mut degrees, mut rise) = (false, None, 0.0);
        if dialect == "heidenhain" {
            if !matches!(words.first(), Some(&("L" | "CC" | "C" | "CP"))) {
                continue;
            }
            mode = words.remove(0);
        }
        for word in words {
            match word {
                "G17" => plane = [0, 1, 2],
                "G18" => plane = [2, 0, 1],
                "G19" => plane = [1, 2, 0],
                "G0" | "G1" | "G2" | "G3" | "CIP" => mode = word,
                "FMAX" => rapid = true,
                "DR+" | "DR-" => clockwise = word == "DR-",
                _ => {
                    if let Some((name, place)) = word.split_once("=AC(") {
                        let axis =
                            ["I1", "J1", "K1"].iter().position(|known| *known == name).expect("I1 J1 K1");
                        way[axis] = number(place.trim_end_matches(')'));
                    } else if let Some(angle) = word.strip_prefix("IPA") {
                        degrees = Some(number(angle));
                    } else if let Some(step) = word.strip_prefix("IZ") {
                        rise = number(step);
                    } else if let Some(axis) = ["X", "Y", "Z"].iter().position(|name| word.starts_with(name))
                    {
                        to[axis] = number(&word[1..]);
                        named = true;
                    } else if let Some(axis) = ["I", "J", "K"].iter().position(|name| word.starts_with(name))
                    {
                        center[axis] = number(&word[1..]);
                    }
                }
            }
        }
        let [u, v, w] = plane;
        let from = at;
        match mode {
            "CC" => {
                about = [to[0], to[1]];
                continue;
            }
            "CP" => {
                path.extend(turn(plane, from, about, degrees.expect("IPA").to_radians(), rise));
                at = path[path.len() - 1];
                continue;
            }
            "C" => {
                path.extend(turn(plane, from, about, sweep_to(plane, from, to, about, clockwise), 0.0));
            }
            "G2" | "G3" if named => {
                let center = [from[u] + center[u], from[v] + center[v]];
                let sweep = sweep_to(plane, from, to, center, mode == "G2");
                path.extend(turn(plane, from, center, sweep, to[w] - from[w]));
            }
            "CIP" if named => path.extend(by_way(from, way, to)),
            "L" | "G1" if named && !rapid => path.extend((1..=400).map(|i| {
                let t = f64::from(i) / 400.0;
                std::array::from_fn(|k| from[k] + t * (to[k] - from[k]))
            })),
            _ => {}
        }
        if named {
            at = to;
        }
    }
    path
}

fn machines() -> impl Iterator<Item = (&'static Dialect, Machine)> {
    let machine = |dialect: &'static Dialect| Machine::built_in(dialect.name).expect("a default machine");
    splinepost::dialect::DIALECTS.iter().map(move |dialect| (dialect, machine(dialect)))
}

#[test]
fn arcs_of_every_plane_run_where_they_were_asked() {
    for case in CASES {
        let [u, v, w] = case.plane();
        let sweep = case.sweep.to_radians();
        for (i, (dialect, machine)) in machines().enumerate() {
            let what = format!("{} for {}", case.name, dialect.name);
            let output = program("creo", &case.text(), &machine).unwrap_or_else(|e| panic!("{what}: {e:?}"));
            assert!(output.text.contains(case.words[i]), "{what}: no {}\n{}", case.words[i], output.text);
            let bound = output.report.expect("a proof").deviation.mm;
            assert!(bound <= 1e-3, "{what}: {bound}");
            let path = run(dialect.name, &output.text);
            let near = |p: &Point, q: &Point| (0..3).all(|k| (p[k] - q[k]).abs() < 1e-9);
            let first =
                path.iter().position(|p| near(p, &case.start)).unwrap_or_else(|| panic!("{what}: no start"));
            // What is turned since the start, until the arc is over.
            let about = |p: &Point| (p[u] - case.center[u], p[v] - case.center[v]);
            let (mut turned, mut last) = (0.0, path[first]);
            let mut worst = 0.0f64;
            for p in &path[first + 1..] {
                let ((x, y), (x0, y0)) = (about(p), about(&last));
                turned += (x0 * y - y0 * x).atan2(x0 * x + y0 * y);
                last = *p;
                worst = worst.max((x.hypot(y) - case.radius()).abs());
                // At equal shares of the sweep, as the proof compares.
                let height = case.start[w] + turned / sweep * (case.end[w] - case.start[w]);
                worst = worst.max((p[w] - height).abs());
                if sweep.abs() - 1e-6 < turned.abs() {
                    break;
                }
            }
            assert!((turned - sweep).abs() < 2e-6, "{what}: turns by {turned}, not {sweep}");
            let gap = (0..3).map(|k| (last[k] - case.end[k]).abs()).fold(0.0, f64::max);
            worst = worst.max(gap);
            // What the oracle sees, the proof must have bounded; 1e-9 is for the oracle's own sums.
            assert!(worst <= bound + 1e-9, "{what}: {worst} seen, {bound} proved");
        }
    }
}

/// Every number of a block of an arc by a tenth, every sense, and every block left out: each is refused.
#[test]
fn damaged_arcs_of_every_plane_are_refused() {
    let language = front::find("creo").expect("creo");
    for case in CASES {
        for (i, (dialect, machine)) in machines().enumerate() {
            let input = case.text();
            let text =
                program("creo", &input, &machine).unwrap_or_else(|e| panic!("{}: {e:?}", case.name)).text;
            let refused = |damaged: String, what: &str| {
                let mut sources = Sources::new(Source::new("input.cl", input.clone()));
                let id = sources.push(Source::new("program", damaged));
                let verified = verify_program(&sources, language, id, &machine, &Options::default());
                assert!(verified.is_err(), "{} for {}: {what}", case.name, dialect.name);
            };
            let lines: Vec<&str> = text.lines().collect();
            let at = lines.iter().position(|line| line.contains(case.words[i])).expect("the arc");
            let mut blocks = vec![at];
            if lines[at - 1].contains("CC ") {
                blocks.push(at - 1);
            }
            let replaced = |at: usize, line: Option<String>| {
                let mut all: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
                match line {
                    Some(line) => all[at] = line,
                    None => drop(all.remove(at)),
                }
                all.join("\n") + "\n"
            };
            for at in blocks {
                refused(replaced(at, None), "a block left out");
                let words: Vec<&str> = lines[at].split(' ').collect();
                for (n, word) in words.iter().enumerate().skip(1) {
                    let mut other = words.clone();
                    let digit =
                        word.find(|c: char| c.is_ascii_digit() || "+-".contains(c)).unwrap_or(word.len());
                    let value = word[digit..].trim_end_matches(')').parse::<f64>().ok();
                    let damaged = match (*word, value) {
                        ("G2", _) => "G3".to_owned(),
                        ("G3", _) => "G2".to_owned(),
                        ("G18", _) => "G19".to_owned(),
                        ("G19", _) => "G17".to_owned(),
                        ("DR+", _) => "DR-".to_owned(),
                        ("DR-", _) => "DR+".to_owned(),
                        // A place on the way: its value stands behind the parenthesis.
                        (way, _) if way.contains("=AC(") => {
                            let (name, place) = way.split_once("=AC(").expect("AC");
                            format!("{name}=AC({:.6})", number(place.trim_end_matches(')')) + 0.1)
                        }
                        (_, Some(value)) => format!("{}{:+.4}", &word[..digit], value + 0.1),
                        _ => continue,
                    };
                    other[n] = &damaged;
                    refused(replaced(at, Some(other.join(" "))), &format!("{damaged} for {word}"));
                }
            }
        }
    }
}

/// What a program is refused with where one text stands in it for another.
fn refusal((input, text): (&str, &str), machine: &Machine, (from, to): (&str, &str)) -> &'static str {
    assert!(text.contains(from), "{text}");
    let mut sources = Sources::new(Source::new("input.cl", input));
    let id = sources.push(Source::new("program", text.replacen(from, to, 1)));
    let language = front::find("creo").expect("creo");
    verify_program(&sources, language, id, machine, &Options::default()).expect_err(to).0[0].id
}

/// Behind a helix by an angle the control stands at no place in decimals: the next path has to name X and Y.
#[test]
fn a_path_behind_a_helix_names_where_it_ends() {
    let machine = Machine::built_in("heidenhain").expect("heidenhain");
    let case = &CASES[7];
    let text = program("creo", &case.text(), &machine).expect("a program").text;
    let refused = |from, to| refusal((&case.text(), &text), &machine, (from, to));
    assert_eq!(refused("L X+40 Y-30", "L X+40"), "helix-end");
    assert_eq!(refused("IPA+126.8699", "IPA+486.8699"), "helix");
    assert_eq!(refused("IPA+126.8699", "IPA-126.8699"), "helix");
    assert_eq!(refused(" IZ+1", ""), "deviation-too-large");
    assert_eq!(refused("IZ+1", "IX+1"), "arc-word");
    assert_eq!(refused("L X+40 Y-30", "L X+40 IPA+3 Y-30"), "arc-word");
}

/// The usual bore: down a helix, round once at the bottom. A circle that ends where it starts, but for what the angle of the
/// helix missed, would be next to nothing on the control.
#[test]
fn a_circle_behind_a_helix_is_a_whole_one() {
    let case = &CASES[7];
    let text = case.text().replace("GOTO/40,-30,1100", "CIRCLE/5,0,1,0,0,1,5\nGOTO/2,4,1\nGOTO/40,-30,1100");
    for (dialect, machine) in machines() {
        let output = program("creo", &text, &machine).unwrap_or_else(|e| panic!("{}: {e:?}", dialect.name));
        let bound = output.report.expect("a proof").deviation.mm;
        let path = run(dialect.name, &output.text);
        let at = |p: &Point| ((p[1]).atan2(p[0] - 5.0), p[2]);
        let first = path.iter().position(|p| *p == case.start).expect("the start");
        let mut turned = 0.0;
        for pair in path[first..].windows(2).take(800) {
            let ((from, _), (to, height)) = (at(&pair[0]), at(&pair[1]));
            turned += (to - from + PI).rem_euclid(2.0 * PI) - PI;
            let asked = (turned / case.sweep.to_radians()).min(1.0);
            assert!((height - asked).abs() <= bound + 1e-9, "{}: {height} {asked}", dialect.name);
        }
        let whole = (case.sweep + 360.0).to_radians();
        assert!((turned - whole).abs() < 2e-6, "{}: {turned} {whole}", dialect.name);
        if dialect.name == "heidenhain" {
            assert!(output.text.contains("CP IPA+360 DR+"), "{}", output.text);
            let other = ("CP IPA+360 DR+", "C X+2 Y+4 DR+");
            assert_eq!(refusal((&text, &output.text), &machine, other), "helix-end");
        }
    }
}

#[test]
fn a_place_on_the_way_makes_an_arc() {
    let machine = Machine::built_in("sinumerik").expect("sinumerik");
    let case = &CASES[2];
    let text = program("creo", &case.text(), &machine).expect("a program").text;
    let refused = |from, to| refusal((&case.text(), &text), &machine, (from, to));
    assert_eq!(refused(" J1=AC(2)", ""), "arc-way");
    assert_eq!(refused("J1=AC(2)", "J1=AC(3)"), "arc-plane");
    assert_eq!(refused("J1=AC(2)", "L1=AC(2)"), "word-unknown");
    assert_eq!(refused("J1=AC(2)", "I1=AC(2)"), "axis-twice");
    // Whether it counts from zero or from the start would be the control's setting.
    assert_eq!(refused("J1=AC(2)", "J1=2"), "word-unknown");
    assert_eq!(
        refused("I1=AC(3.535534) J1=AC(2) K1=AC(3.535534)", "I1=AC(2.5) J1=AC(2) K1=AC(2.5)"),
        "arc-plane"
    );
    assert_eq!(refused("CIP X5", "G1 X5"), "arc-word");
}
