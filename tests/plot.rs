//! `splinepost plot`: every figure is there, XML is sound, bytes are the same.

use crate::support::{folder, sources_with};
use splinepost::plot::deviation::deviation;
use splinepost::plot::paths::figures;
use splinepost::simulate::partition::Parametric;
use splinepost::simulate::track::{Setting, Track};
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, compile, front};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MILL: &str = "fixtures/compile/conical-mill/input.toml";

/// The figures of a cutter's program.
const FIGURES: [&str; 17] = [
    "trace",
    "trace-start",
    "trace-end",
    "steps",
    "xy",
    "xz",
    "yz",
    "spatial",
    "rotary",
    "cutter",
    "deviation",
    "feed",
    "acceleration",
    "acceleration-rotary",
    "curvature",
    "feed-error",
    "chord-error",
];

fn plot(arguments: &[&str], output: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_splinepost"))
        .arg("plot")
        .args(arguments)
        .arg("-o")
        .arg(output)
        .current_dir(folder(""))
        .output()
        .expect("it runs")
}

fn drawn(arguments: &[&str], output: &Path) -> String {
    let ran = plot(arguments, output);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    std::fs::read_to_string(output).expect("the picture")
}

#[test]
fn a_page_has_every_figure_and_the_same_bytes() {
    let dir = tempfile::tempdir().expect("a folder");
    let arguments = [MILL, "--to", "heidenhain", "--feed", "6000"];
    let page = drawn(&arguments, &dir.path().join("a.html"));
    for id in FIGURES {
        assert_eq!(page.matches(&format!("<figure id=\"{id}\">")).count(), 1, "{id}");
    }
    assert_eq!(page.matches("<figure ").count(), FIGURES.len());
    assert_eq!(page, drawn(&arguments, &dir.path().join("b.html")));
    // A browser mends an attribute that is there twice in silence.
    for drawing in page.split("<svg").skip(1) {
        let drawing = format!("<svg{}</svg>", drawing.split("</svg>").next().expect("a drawing"));
        roxmltree::Document::parse(&drawing).expect("sound XML");
    }
    for outside in ["<script", "http://", "https://", "src="] {
        let found = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!found.contains(outside), "{outside}");
    }
}

#[test]
fn a_sheet_is_sound_xml_with_numbers_only() {
    let dir = tempfile::tempdir().expect("a folder");
    let program = "fixtures/compile/conical-mill/sinumerik-bspline.mpf";
    let machine = "fixtures/compile/conical-mill/sinumerik-bspline.machine.toml";
    let arguments = [program, "--to", machine, "--against", MILL, "--feed", "6000"];
    let sheet = drawn(&arguments, &dir.path().join("a.svg"));
    let tree = roxmltree::Document::parse(&sheet).expect("XML");
    let ids: Vec<&str> = tree.root_element().children().filter_map(|node| node.attribute("id")).collect();
    assert_eq!(ids, FIGURES);
    assert!(!sheet.contains("NaN") && !sheet.contains("inf"));
    // A B-spline of ten flutes' control points is drawn as its polygon.
    assert!(sheet.contains("control polygons") && sheet.contains("block ends"));
}

#[test]
fn an_input_alone_is_drawn_without_what_needs_a_program() {
    let dir = tempfile::tempdir().expect("a folder");
    let page = drawn(&[MILL, "--feed", "6000"], &dir.path().join("a.html"));
    for id in FIGURES {
        assert_eq!(page.contains(&format!("<figure id=\"{id}\">")), id != "deviation", "{id}");
    }
}

#[test]
fn the_deviation_drawn_is_within_what_is_proved() {
    let text = std::fs::read_to_string(folder(MILL)).expect("the input");
    let sources = Sources::new(Source::new("input.toml", text));
    let language = front::find("cutter").expect("the cutter language");
    for name in ["sinumerik", "heidenhain"] {
        let machine = crate::support::five(name);
        let output = compile(&sources, language, &machine, &Options::default())
            .unwrap_or_else(|failure| panic!("{:?}", failure.diagnostics));
        let reading = (machine.dialect.read)(&output.text, SourceId::PROGRAM, &machine)
            .unwrap_or_else(|e| panic!("{e:?}"));
        let setting = Setting { machine: Some(&machine), tolerance: 0.001, ..Setting::default() };
        let program = Track::of_decimals(&reading.value.decimals, &setting).expect("a track");
        let asked = Track::of_program(&output.intent.program, &setting).expect("a track");
        let (log, ..) = output.intent.logarithmic().next().expect("a flute");
        let drawn = deviation(&program, &asked, Some(&log.curve)).expect("the same runs");
        let most = drawn.iter().map(|p| p[1]).fold(0.0, f64::max);
        let proved = output.report.expect("a proof").deviation.mm;
        // The bound is at equal X, the picture shows the nearest place, which is no farther; along a helix of 30° the
        // nearest is cos 30° of it, and bounds are within a few percent.
        assert!(most <= proved && 0.5 * proved < most, "{name}: {most:e}, {proved:e}");
    }
}

/// A program of tilted planes is drawn where its input is: in the coordinates of the work.
#[test]
fn tilted_planes_are_drawn_in_the_work() {
    let text = std::fs::read_to_string(folder("fixtures/apt/nx-planes/input.cls")).expect("the input");
    let sources = Sources::new(Source::new("input.cls", text));
    let language = front::find("apt").expect("CL data");
    for name in ["sinumerik", "heidenhain", "mazak"] {
        let machine = crate::support::five(name);
        let output = compile(&sources, language, &machine, &Options::default())
            .unwrap_or_else(|failure| panic!("{:?}", failure.diagnostics));
        let machine = machine.with_axes(&output.intent.program.axes).expect("its axes");
        let reading = (machine.dialect.read)(&output.text, SourceId::PROGRAM, &machine)
            .unwrap_or_else(|e| panic!("{e:?}"));
        let setting = Setting { machine: Some(&machine), tolerance: 0.001, ..Setting::default() };
        let program = Track::of_decimals(&reading.value.decimals, &setting).expect("a track");
        let asked = Track::of_program(&output.intent.program, &setting).expect("a track");
        let drawn = deviation(&program, &asked, None).expect("the same runs");
        let most = drawn.iter().map(|p| p[1]).fold(0.0, f64::max);
        // Half a unit of the fourth decimal in each axis, which moves the centre of an arc as well.
        assert!(most < 2.0e-4, "{name}: {most:e}");
        let read = (language.parse)(&sources).expect("an intent");
        let asked = Track::of_program(&read.program, &setting).expect("a track");
        assert_eq!(program.pieces.len(), asked.pieces.len());
        for (own, asked) in program.pieces.iter().zip(&asked.pieces) {
            for (p, q) in [
                (own.curve.at(own.from), asked.curve.at(asked.from)),
                (own.curve.at(own.to), asked.curve.at(asked.to)),
            ] {
                assert!((0..3).all(|i| (p[i] - q[i]).abs() < 1.0e-4), "{name}: {p:?} {q:?}");
            }
        }
    }
}

/// The figure of a job's path, and where its box says that it goes.
fn pictured(job: &str, files: &[(&str, &str)], id: &str) -> (Vec<[f64; 2]>, String) {
    let sources = sources_with(job, files);
    let intent = (front::find("job").expect("jobs").parse)(&sources).unwrap_or_else(|e| panic!("{e:?}"));
    let setting = Setting { tolerance: 0.001, ..Setting::default() };
    let track = Track::of_program(&intent.program, &setting).expect("a track");
    let figures = figures(&track, None);
    let of = |id: &str| figures.iter().find(|figure| figure.id == id).expect("a figure");
    let path = of(id).series.iter().find(|series| series.name == "path").expect("a path");
    (path.points.clone(), of("spatial").series[0].name.clone())
}

/// One block of thirty thousand plunges: it is in the picture and in the box.
#[test]
fn a_plunge_among_many_blocks_is_drawn() {
    let points: Vec<String> = (0..30_000)
        .map(|i| format!("[{}, 0, {}]", f64::from(i) / 100.0, if i == 15_001 { -20 } else { 0 }))
        .collect();
    let job = format!(
        "[process]\nfeed = 1000\nretract = {{ axis = \"Z\", to = 50 }}\n[[curve]]\nkind = \"points\"\n\
         axes = [\"X\", \"Y\", \"Z\"]\npoints = [{}]\n",
        points.join(", ")
    );
    let (path, told) = pictured(&job, &[], "xz");
    assert!(path.contains(&[150.01, -20.0]) && path.len() < 2000, "{}", path.len());
    assert_eq!(told, "X 0 to 299.99, Y 0 to 0, Z -20 to 50");
}

/// Arcs of radius 5 about ten places, twenty-five thousand of them, are drawn as arcs.
#[test]
fn arcs_of_many_are_round() {
    let arc = |i: u32| format!("  0\nARC\n 10\n{}\n 20\n0\n 40\n5\n 50\n0\n 51\n180\n", 20 * (i % 10));
    let arcs: String = (0..25_000).map(arc).collect::<Vec<_>>().concat();
    let drawing = format!(
        "  0\nSECTION\n  2\nHEADER\n  9\n$INSUNITS\n 70\n4\n  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n{arcs}  0\nENDSEC\n  0\nEOF\n"
    );
    let job = "[process]\nfeed = 1000\nretract = { axis = \"Z\", to = 50 }\n[[curve]]\nfile = \"a.dxf\"\nat = { Z = 0 }\n";
    let (path, _) = pictured(job, &[("a.dxf", &drawing)], "xy");
    for pair in path.windows(2).filter(|pair| pair.iter().flatten().all(|x| x.is_finite())) {
        let middle = [pair[0][0].midpoint(pair[1][0]), pair[0][1].midpoint(pair[1][1])];
        let about = (0..10).map(|i| {
            let x = middle[0] - 20.0 * f64::from(i);
            ((x * x + middle[1] * middle[1]).sqrt() - 5.0).abs()
        });
        // Parts of 4.5° are 0.004 off, and what is left out is within 190/12000.
        assert!(about.fold(f64::INFINITY, f64::min) < 0.025, "{middle:?}");
    }
    assert!(path.iter().any(|p| 4.99 < p[1]));
}

/// What compiles for a dialect is drawn for it, five axes too.
#[test]
fn every_fixture_is_drawn_for_every_dialect() {
    let dir = tempfile::tempdir().expect("a folder");
    let picture = dir.path().join("a.svg");
    let mut inputs = Vec::new();
    for group in ["fixtures/apt", "fixtures/compile"] {
        for case in std::fs::read_dir(folder(group)).expect("fixtures").flatten() {
            let files = std::fs::read_dir(case.path()).expect("a case").flatten().map(|file| file.path());
            let is_input = |path: &PathBuf| {
                path.file_stem().is_some_and(|stem| stem == "input")
                    && path.extension().is_some_and(|extension| extension != "stderr")
            };
            inputs.extend(files.filter(is_input));
        }
    }
    inputs.sort();
    let mut count = 0;
    for input in &inputs {
        let input = input.display().to_string();
        for machine in ["sinumerik", "heidenhain", "mazak"] {
            let compiled = Command::new(env!("CARGO_BIN_EXE_splinepost"))
                .args(["compile", &input, "--to", machine])
                .output()
                .expect("it runs");
            let ran = plot(&[&input, "--to", machine, "--cycle", "20ms"], &picture);
            let told = String::from_utf8_lossy(&ran.stderr).into_owned();
            assert_eq!(ran.status.code(), compiled.status.code(), "{input} {machine}: {told}");
            count += usize::from(ran.status.success());
        }
    }
    // Nine of ten go to every machine.
    assert!(27 * inputs.len() < 10 * count && 40 < count, "{count} of {}", 3 * inputs.len());
}

#[test]
fn what_cannot_be_drawn_is_told() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    std::fs::copy(folder(MILL), at("mill.html")).expect("copied");
    let mill = at("mill.html").display().to_string();
    let cases: &[(&[&str], PathBuf, &str)] = &[
        (&[MILL], at("a.png"), "output-kind"),
        (&[&mill, "--from", "cutter"], at("mill.html"), "output-is-input"),
        (&[MILL, "--against", MILL], at("a.svg"), "against-unused"),
        (&["none.toml"], at("a.svg"), "file-unreadable"),
        (&[MILL, "--to", "nowhere"], at("a.svg"), "machine-unknown"),
    ];
    for (arguments, output, id) in cases {
        let ran = plot(arguments, output);
        let told = String::from_utf8_lossy(&ran.stderr).into_owned();
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(told.contains(id), "{arguments:?}: {told}");
    }
    assert!(!at("a.svg").exists() && !at("a.png").exists());
}

/// A headless browser: the one that CHROMIUM names, or one in a usual place.
fn chromium() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("CHROMIUM") {
        return Some(PathBuf::from(named));
    }
    let usual = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    usual.iter().map(|name| Path::new("/usr/bin").join(name)).find(|path| path.exists())
}

#[test]
fn pages_open_in_chromium_without_errors() {
    let Some(chromium) = chromium() else {
        println!("skipped: no Chromium in /usr/bin; CHROMIUM names one elsewhere");
        return;
    };
    let dir = tempfile::tempdir().expect("a folder");
    let cutter: Vec<&str> = FIGURES.to_vec();
    let without = |left_out: &[&str]| -> Vec<&str> {
        FIGURES.into_iter().filter(|id| !left_out.contains(id)).collect()
    };
    let flute = ["trace", "trace-start", "trace-end", "steps", "cutter"];
    let rotary = ["rotary", "acceleration-rotary"];
    let bspline = "fixtures/compile/conical-mill/sinumerik-bspline";
    let (program, machine) = (format!("{bspline}.mpf"), format!("{bspline}.machine.toml"));
    let pages: [(&str, &[&str], Vec<&str>); 4] = [
        ("cutter", &[MILL, "--to", "sinumerik"], cutter.clone()),
        ("program", &[&program, "--to", &machine, "--against", MILL, "--feed", "6000"], cutter),
        ("job", &["fixtures/compile/lissajous/input.toml", "--to", "heidenhain"], without(&flute)),
        (
            "cl-data",
            &["fixtures/apt/nx-planes/input.cls"],
            without(&[&flute[..], &rotary, &["deviation"]].concat()),
        ),
    ];
    for (name, arguments, figures) in pages {
        let page = dir.path().join(format!("{name}.html"));
        drawn(arguments, &page);
        let output = Command::new(&chromium)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--dump-dom"])
            .arg(format!("--user-data-dir={}", dir.path().join("profile").display()))
            .arg(format!("file://{}", page.display()))
            .output()
            .expect("chromium runs");
        let (dom, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        let shown: Vec<&str> =
            dom.split("<figure id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(shown, figures, "{name}");
        assert!(dom.ends_with("</html>\n") && dom.matches("</svg>").count() == figures.len(), "{name}");
        let logged: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
        assert!(logged.is_empty(), "{name}: {logged:?}");
    }
}
