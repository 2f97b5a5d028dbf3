//! Arcs and helices, evaluated from the programs' text alone by the manuals' formulas, against the closed form of what was
//! asked; and damaged ones.

#![allow(
    clippy::disallowed_methods,
    reason = "the oracle uses the platform's functions so that it shares no code with the crate"
)]

mod cases;

use super::program;
use cases::{CASES, Case, cross, dot, minus};
use splinepost::dialect::Dialect;
use splinepost::machine::Machine;
use splinepost::source::{Source, Sources};
use splinepost::{Options, front, verify_program};
use std::f64::consts::PI;

type Point = [f64; 3];

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

/// CIP: the circle through three places, by the weights that they have in its centre, run by the second.
fn by_way(from: Point, way: Point, to: Point) -> Vec<Point> {
    let square = |a: Point, b: Point| dot(minus(a, b), minus(a, b));
    let (a, b, c) = (square(way, to), square(to, from), square(from, way));
    let weights = [a * (b + c - a), b * (c + a - b), c * (a + b - c)];
    let whole: f64 = weights.iter().sum();
    let center =
        std::array::from_fn(|i| (weights[0] * from[i] + weights[1] * way[i] + weights[2] * to[i]) / whole);
    let radial = minus(from, center);
    let normal = cross(minus(way, from), minus(to, from));
    let across = cross(normal.map(|x| x / dot(normal, normal).sqrt()), radial);
    let end = minus(to, center);
    let sweep = dot(end, across).atan2(dot(end, radial)).rem_euclid(2.0 * PI);
    (1..=400)
        .map(|i| {
            let (sin, cos) = (f64::from(i) / 400.0 * sweep).sin_cos();
            std::array::from_fn(|k| center[k] + radial[k] * cos + across[k] * sin)
        })
        .collect()
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
        let (mut clockwise, mut degrees, mut rise, mut turns) = (false, None, 0.0, 0.0);
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
                    } else if let Some(whole) = word.strip_prefix("TURN=") {
                        turns = number(whole);
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
                let once = sweep_to(plane, from, to, center, mode == "G2");
                let sweep = once + once.signum() * turns * 2.0 * PI;
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
    let machine = |dialect: &'static Dialect| crate::support::five(dialect.name);
    splinepost::dialect::DIALECTS.iter().map(move |dialect| (dialect, machine(dialect)))
}

/// Of Sinumerik also a machine whose tool keeps its length along Z in every plane.
fn with_planes() -> (&'static Dialect, Machine) {
    let dialect = splinepost::dialect::find("sinumerik").expect("sinumerik");
    (dialect, crate::support::machine("extends = \"sinumerik\"\n[arcs]\nplanes = true\n"))
}

#[test]
fn arcs_of_every_plane_run_where_they_were_asked() {
    for case in CASES {
        for (i, (dialect, machine)) in machines().chain([with_planes()]).enumerate() {
            let output = runs(case, dialect, &machine);
            if let Some(words) = case.words.get(i) {
                assert!(output.contains(words), "{} for {}: no {words}\n{output}", case.name, dialect.name);
            }
        }
    }
}

/// Runs a case's program, and returns it.
fn runs(case: &Case, dialect: &Dialect, machine: &Machine) -> String {
    let sweep = case.sweep.to_radians();
    let what = format!("{} for {}", case.name, dialect.name);
    let output = program(case.system(), &case.text(), machine).unwrap_or_else(|e| panic!("{what}: {e:?}"));
    let bound = output.report.expect("a proof").deviation.mm;
    assert!(bound <= 1e-3, "{what}: {bound}");
    let path = run(dialect.name, &output.text);
    let near = |p: &Point, q: &Point| (0..3).all(|k| (p[k] - q[k]).abs() < 1e-9);
    let first = path.iter().position(|p| near(p, &case.start)).unwrap_or_else(|| panic!("{what}: no start"));
    let ([.., low], [.., high]) = (case.local(case.start), case.local(case.end));
    // What is turned since the start, until the arc is over.
    let (mut turned, mut last) = (0.0, path[first]);
    let mut worst = 0.0f64;
    for p in &path[first + 1..] {
        let ([x, y, z], [x0, y0, _]) = (case.local(*p), case.local(last));
        turned += (x0 * y - y0 * x).atan2(x0 * x + y0 * y);
        last = *p;
        worst = worst.max((x.hypot(y) - case.radius()).abs());
        // At equal shares of the sweep, as the proof compares.
        worst = worst.max((z - low - turned / sweep * (high - low)).abs());
        if sweep.abs() - 1e-6 < turned.abs() {
            break;
        }
    }
    // Some 5e-7 mm of six decimals at R = 5 mm, of each block.
    assert!((turned - sweep).abs() < 2e-6, "{what}: turns by {turned}, not {sweep}");
    let gap = (0..3).map(|k| (last[k] - case.end[k]).abs()).fold(0.0, f64::max);
    worst = worst.max(gap);
    // What the oracle sees, the proof must have bounded; 1e-9 is for the oracle's own sums.
    assert!(worst <= bound + 1e-9, "{what}: {worst} seen, {bound} proved\n{}", output.text);
    output.text
}

/// Where the tool keeps its length along Z, arcs of every plane of the machine are G2 and G3, and G17 stands again before
/// anything else.
#[test]
fn planes_are_chosen_where_the_machine_file_allows_it() {
    let (dialect, machine) = with_planes();
    let text = |name: &str| {
        let case = CASES.iter().find(|case| case.name == name).expect("a case");
        runs(case, dialect, &machine)
    };
    let helix = text("a helix about Y");
    assert!(helix.contains("G18 G3 X5 Y4 Z0 I0 K-5"), "{helix}");
    let [arc, plane, end] = ["G18", "G17\n", "M30"].map(|word| helix.find(word).expect(word));
    assert!(arc < plane && plane < end, "{helix}");
    assert!(text("a turn and a quarter in Z X").contains("G18 G3 X5 Z0 I0 K-5 TURN=1"));
    assert!(text("a quarter in a tilted plane").contains("CIP X1 Y-3 Z3"));
    // Another machine of the same control does not take what it would read in another way.
    let built_in = Machine::built_in("sinumerik").expect("sinumerik");
    let mut sources = Sources::new(Source::new("input.cl", CASES[17].text()));
    let id = sources.push(Source::new("program", helix));
    let language = front::find("creo").expect("creo");
    let refused = verify_program(&sources, language, id, &built_in, &Options::default());
    assert_eq!(refused.expect_err("G18").0[0].id, "arc-plane");
}

/// Every number of a block of an arc by a tenth, every sense, and every block left out: each is refused.
#[test]
fn damaged_arcs_of_every_plane_are_refused() {
    for case in CASES {
        let language = front::find(case.system()).expect("a system");
        for (i, (dialect, machine)) in machines().enumerate() {
            let input = case.text();
            let text = program(case.system(), &input, &machine)
                .unwrap_or_else(|e| panic!("{}: {e:?}", case.name))
                .text;
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
                    other.remove(n);
                    refused(replaced(at, Some(other.join(" "))), &format!("without {word}"));
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
                        ("TURN=1", _) => "TURN=2".to_owned(),
                        ("TURN=2", _) => "TURN=1".to_owned(),
                        ("TURN=18", _) => "TURN=17".to_owned(),
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
    assert_eq!(refused("IPA+126.8699", "IPA+486.8699"), "deviation-too-large");
    assert_eq!(refused("IPA+126.8699", "IPA+5486.8699"), "helix");
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

/// Of several turns each word counts: what one more or less is told.
#[test]
fn a_turn_more_or_less_is_refused() {
    let named = |name: &str| CASES.iter().find(|case| case.name == name).expect("a case");
    let refused = |name: &str, dialect: &str, from: &str, to: &str| {
        let (case, machine) = (named(name), crate::support::five(dialect));
        let text = program(case.system(), &case.text(), &machine).expect("a program").text;
        assert!(text.contains(from), "{text}");
        let mut sources = Sources::new(Source::new("input.cl", case.text()));
        let id = sources.push(Source::new("program", text.replacen(from, to, 1)));
        let language = front::find(case.system()).expect("a system");
        verify_program(&sources, language, id, &machine, &Options::default()).expect_err(to).0[0].id
    };
    let (helix, flat) = ("two turns and three quarters of a helix", "round twice in X Y");
    for (from, to) in [(" TURN=2", ""), ("TURN=2", "TURN=1"), ("TURN=2", "TURN=3")] {
        assert_eq!(refused(helix, "sinumerik", from, to), "deviation-too-large");
    }
    assert_eq!(refused(helix, "sinumerik", "TURN=2", "TURN=2.5"), "arc-turns");
    assert_eq!(refused(helix, "sinumerik", "TURN=2", "TURN=1000"), "arc-turns");
    assert_eq!(refused(helix, "sinumerik", "TURN=2", "TURN=2 TURN=2"), "axis-twice");
    assert_eq!(refused(helix, "sinumerik", "G3 X5", "G1 X5"), "arc-word");
    // Whether the turn of an end over its start is one of TURN's no page says.
    assert_eq!(refused(flat, "sinumerik", "X10 Y0 I5 J0 TURN=1", "X0 Y0 I5 J0 TURN=1"), "arc-turns");
    // Of turns in one plane the path is the same, only not how often: what comes next is none of the arc.
    assert_eq!(refused(flat, "sinumerik", " TURN=1", ""), "deviation-too-large");
    assert_eq!(refused(flat, "heidenhain", "IPA+720", "IPA+360"), "deviation-too-large");
    assert_eq!(refused(flat, "heidenhain", "IPA+720", "IPA+1080"), "deviation-too-large");
    assert_eq!(refused(helix, "heidenhain", "IPA+990", "IPA+630"), "deviation-too-large");
}

/// How an arc is cut into blocks is the text's to say: a turn a block is the same path.
#[test]
fn any_cut_of_an_arc_is_as_good() {
    let machine = crate::support::machine("extends = \"sinumerik\"\n[text]\nnumber_step = 0\n");
    let case = CASES.iter().find(|case| case.name == "two turns and three quarters of a helix").expect("it");
    let text = program(case.system(), &case.text(), &machine).expect("a program").text;
    let verified = |blocks: &str| {
        let whole = "G17 G3 X5 Y5 Z-11 I5 J0 TURN=2\n";
        assert!(text.contains(whole), "{text}");
        let mut sources = Sources::new(Source::new("input.cl", case.text()));
        let id = sources.push(Source::new("program", text.replacen(whole, blocks, 1)));
        let language = front::find(case.system()).expect("a system");
        let verified = verify_program(&sources, language, id, &machine, &Options::default());
        verified.map(|verified| verified.report.deviation.mm).map_err(|errors| errors.0[0].id)
    };
    let turns = "G17 G3 X0 Y0 Z-4 I5 J0\nX0 Y0 Z-8 I5 J0\nX5 Y5 Z-11 I5 J0\n";
    assert!(verified(turns).is_ok_and(|mm| mm < 1e-9));
    assert!(verified("G17 G3 X10 Y0 Z-6 I5 J0 TURN=1\nX5 Y5 Z-11 I-5 J0 TURN=1\n").is_ok_and(|mm| mm < 1e-9));
    // Another pitch for a while, a part too few, and one the other way round.
    let faster = "G17 G3 X0 Y0 Z-4.1 I5 J0\nX0 Y0 Z-8 I5 J0\nX5 Y5 Z-11 I5 J0\n";
    assert_eq!(verified(faster), Err("deviation-too-large"));
    assert_eq!(verified("G17 G3 X0 Y0 Z-4 I5 J0\nX0 Y0 Z-8 I5 J0\n"), Err("deviation-too-large"));
    let back = "G17 G3 X0 Y0 Z-4 I5 J0\nG2 X0 Y0 Z-8 I5 J0\nG3 X5 Y5 Z-11 I5 J0\n";
    assert_eq!(verified(back), Err("arc-differs"));
}

#[test]
fn a_place_on_the_way_makes_an_arc() {
    let machine = Machine::built_in("sinumerik").expect("sinumerik");
    let case = &CASES[2];
    let text = program("creo", &case.text(), &machine).expect("a program").text;
    let refused = |from, to| refusal((&case.text(), &text), &machine, (from, to));
    assert_eq!(refused(" J1=AC(2)", ""), "arc-way");
    assert_eq!(refused("J1=AC(2)", "J1=AC(3)"), "deviation-too-large");
    assert_eq!(refused("J1=AC(2)", "L1=AC(2)"), "word-unknown");
    assert_eq!(refused("J1=AC(2)", "I1=AC(2)"), "axis-twice");
    // Whether it counts from zero or from the start would be the control's setting.
    assert_eq!(refused("J1=AC(2)", "J1=2"), "word-unknown");
    assert_eq!(
        refused("I1=AC(3.535534) J1=AC(2) K1=AC(3.535534)", "I1=AC(2.5) J1=AC(2) K1=AC(2.5)"),
        "arc-plane"
    );
    assert_eq!(refused("CIP X5", "G1 X5"), "arc-word");
    // In a tilted plane: beside it, on the other side, and another end.
    let case = CASES.iter().find(|case| case.name == "a quarter in a tilted plane").expect("a case");
    let text = program("creo", &case.text(), &machine).expect("a program").text;
    let refused = |from, to| refusal((&case.text(), &text), &machine, (from, to));
    assert_eq!(refused("I1=AC(3.12132)", "I1=AC(3.12332)"), "deviation-too-large");
    assert_eq!(
        refused(
            "I1=AC(3.12132) J1=AC(-1.535534) K1=AC(5.828427)",
            "I1=AC(-1.12132) J1=AC(5.535534) K1=AC(0.171573)"
        ),
        "deviation-too-large"
    );
    assert_eq!(refused("CIP X1 Y-3 Z3", "CIP X1 Y-3 Z3.002"), "deviation-too-large");
}
