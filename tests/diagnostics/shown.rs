//! The smallest text that each of these diagnostics comes from, and that it is raised with its severity.

use crate::support::{compiled, fail_on, folder, input, machine, sources_with};
use splinepost::diagnostic::{Diagnostics, registry};
use splinepost::diff::{self, Origin};
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, compile, front, recompile, verify_program};

/// Lines of a machine file that extends `sinumerik`.
const MACHINE_FILES: &[(&str, &str)] = &[
    ("axes-count", "[axes]\nlinear = [\"X\", \"X\"]"),
    ("axis-kind", "[axis.A]\nkind = \"round\""),
    ("axis-limit", "[axis.A]\nmax_speed = 0.0"),
    ("axis-moves", "[axis.A]\nmoves = \"both\""),
    ("axis-sign", "[axis.A]\nsign = 2"),
    ("block-time", "[feed]\nblock_time = 0.0"),
    ("blocks-range", "[spline]\nbspline_min_blocks = 1001"),
    ("comment-length", "[text]\ncomment_length = 19"),
    ("comment-signs", "[text]\ncomment_signs = \".,:\""),
    ("cutter-axes", "[axes]\ncutter = [\"X\", \"Y\"]"),
    ("dialect-unknown", "dialect = \"fanuk\""),
    ("end-condition", "[spline]\nbegin = \"BBEST\""),
    ("feed-error", "[feed]\nerror = 20.0"),
    ("feed-rotary", "[feed]\nrotary = \"half\""),
    ("first-point", "[spline]\nfirst_point = \"g0\""),
    ("line-end", "[text]\nline_end = \"cr\""),
    ("orientation-range", "[orientation]\nlength = 0.0"),
    ("parameter-range", "[parameter]\nfirst = 9\nlast = 1"),
    ("plane-approach", "[orientation]\nplane_approach = \"under\""),
    ("template-text", "[program]\nfooter = [\"\"]"),
    ("template-variable", "[program]\nfooter = [\"M{m}\"]"),
    ("words-range", "[spline]\npoly_words = 1"),
];

/// A line of a cutter file, and what stands in its place.
const CUTTERS: &[(&str, &str, &str)] = &[
    ("correction-range", "feed = 200", "feed = 200\ncorrection = { axis = \"Y\", value = 2000.0 }"),
    ("diameter-range", "D1 = 10", "D1 = 0.0001"),
    ("feed-rounds-to-zero", "feed = 200", "feed = 0.0001"),
    ("index-range", "length = 30", "length = 30\nindex = [400.0]"),
    ("name-characters", "name = \"CONE10\"", "name = \"\""),
    ("overrun-direct", "[interpolation]", "[interpolation]\noverrun = true\nmethod = \"direct\""),
    ("overrun-unused", "[interpolation]", "[interpolation]\noverrun = true"),
    ("retract-range", "to = 500", "to = 1e7"),
    ("run-range", "feed = 200", "feed = 200\nrun_in = -1.0"),
    ("spindle-rounds-to-zero", "spindle = 3000", "spindle = 0.0001"),
    ("tool-range", "feed = 200", "feed = 200\ntool = 0"),
    ("turn-range", "S = 30", "S = 89.99"),
];

/// Curves of a job.
const CURVES: &[(&str, &str)] = &[
    ("axis-missing", "kind = \"points\"\naxes = [\"X\", \"U\"]\npoints = [[0, 0], [1, 1]]"),
    ("coefficient-count", "kind = \"polynomial\"\naxes = [\"X\", \"Y\"]\ncoefficients = [[0, 10]]"),
    (
        "knot-too-often",
        "kind = \"nurbs\"\naxes = [\"X\"]\ndegree = 1\nknots = [0, 0, 1, 1, 1, 2, 2]\npoints = [[0], [1], [2], [3], [4]]",
    ),
    ("position-range", "kind = \"points\"\naxes = [\"X\"]\npoints = [[0], [200000]]"),
    ("range-empty", "kind = \"polynomial\"\naxes = [\"X\"]\ncoefficients = [[0, 10]]\nrange = [1.0, 1.0]"),
    ("u-range", "kind = \"expression\"\nu = [0]\nX = \"u\""),
];

/// A curve file, a text in it, and what stands in its place.
const CURVE_FILES: &[(&str, &str, &str, &str)] = &[
    ("block-external", "insert-only.dxf", "HOLES\n 70\n0\n", "HOLES\n 70\n4\n"),
    ("edge-part", "step-trim-own-ends.step", "VERTEX_POINT('',#20)", "VERTEX_POINT('',#21)"),
    ("model-scale", "iges100-full.igs", "4HTEST,1.0,2,2HMM", "4HTEST,2.0,2,2HMM"),
    ("parameter-kind", "step-trim-own-ends.step", "#22,#23,#24)", "#22,'x',#24)"),
    (
        "record-truncated",
        "iges100-full.igs",
        "     100       0       0       1",
        "     100       0       0       3",
    ),
    (
        "trim-missing",
        "step-trimmed-by-params.step",
        "#33=TRIMMED_CURVE('',#30,(PARAMETER_VALUE(0.5)),(PARAMETER_VALUE(1.5))",
        "#40=LINE('',#20,#42);\n#41=DIRECTION('',(1.,0.,0.));\n#42=VECTOR('',#41,1.);\n\
         #33=TRIMMED_CURVE('',#40,(PARAMETER_VALUE(0.5)),()",
    ),
    (
        "trim-unread",
        "step-trimmed-by-params.step",
        "(PARAMETER_VALUE(0.5)),(PARAMETER_VALUE(1.5))",
        "(#21),(#22)",
    ),
];

/// CL data behind a tool, a spindle, a feed and moves to the work.
const STATEMENTS: &[(&str, &str, &str)] = &[
    ("cycle-depth", "apt", "CYCLE/DRILL,CLEAR,3\nGOTO/1,0,0\nCYCLE/OFF\n"),
    ("dwell-range", "apt", "DELAY/0\n"),
    ("nurbs-weights", "creo", "MOVNRB/ON,4,8,4,4,3\n"),
    ("spindle-speed", "apt", "SPINDL/CLW\n"),
    (
        "spline-corner",
        "nx",
        "NURBS/\nKNOT/1.0\nCNTRL/1,0,0\nCNTRL/2,0,0\nCNTRL/3,0,0\n\
         NURBS/\nKNOT/1.0\nCNTRL/3,1,0\nCNTRL/3,2,0\nCNTRL/3,3,0\n",
    ),
    ("tool-axis-tilted", "nx", "NURBS/\nKNOT/0.5,1.0\nCNTRL/1,0,0,0,0,1\n"),
];

/// Whole files of CL data.
const CL_FILES: &[(&str, &str, &str)] = &[
    ("feed-per-revolution", "apt", "LOADTL/1\nFEDRAT/0.1,MMPR\nRAPID\nGOTO/0,0,10\nGOTO/0,0,0\nFINI\n"),
    (
        "nurbs-inches",
        "catia",
        "UNITS/INCHES\nFEDRAT/9\nGOTO/0,0,0\nBEGIN NURBS_SIEMENS(D=3,F=9,AXIS=0.0,0.0,1.0)\nFINI\n",
    ),
];

/// Blocks of an NC program, with the machine whose they are and what its file states beside.
const BLOCKS: &[(&str, &str, &str, &str)] = &[
    ("arc-end", "heidenhain", "", "1 L X+0 Y+0 Z+0 R0 FMAX\n2 CC X+1 Y+1\n3 C Z+5 DR+\n"),
    ("arc-radius", "mazak", "", "G0 X0. Y0. Z0. A0.\nG1 X1. F100.\nG2 X1. I0. J0.\n"),
    (
        "axis-left-out",
        "mazak",
        "",
        "G0 X0. Y0. Z0. A0.\nG1 X1. F100.\nG06.2 P2 K0. X1. Y0.\nK0. X2.\nK1.\nK1.\nG1 X3. Y0.\n",
    ),
    (
        "inverse-time",
        "mazak",
        "[feed]\nrotary = \"inverse-time\"",
        "G0 X0. Y0. Z0. A0.\nG93 G2 X1. I0.5 F9.\n",
    ),
    (
        "knot-range",
        "mazak",
        "",
        "G0 X0. Y0. Z0. A0.\nG1 X1. F100.\nG06.2 P2 K0. X1. Y0.\nK0. X2. Y0.\n\
         K99999999999999999.\nK99999999999999999.\nG1 X3. Y0.\n",
    ),
    (
        "remark-within",
        "heidenhain",
        "",
        "1 L X+0 Y+0 Z+0 R0 FMAX\n2 SPL X+1 K3X+0 ~\n ; REMARK\n K2X+0 K1X-1 F100\n",
    ),
    ("second-curve", "sinumerik", "", "TRAORI\nG0 X0 Y0 Z0 A3=0 B3=0 C3=1\nG1 F9 X1 XH=1 YH=0 ZH=5\n"),
    ("short-way", "sinumerik", "[axis.A]\nkind = \"modulo\"", "G0 X0 Y0 Z0\nG1 F100 A=DC(5)\n"),
    (
        "spline-step",
        "heidenhain",
        "[axis.A]\nkind = \"modulo\"",
        "1 L X+0 Y+0 Z+0 A+0 R0 FMAX\n2 SPL IA+1 K3A+0 K2A+0 K1A-1 F100\n",
    ),
    (
        "splinepath-missing",
        "sinumerik",
        "",
        "G0 X0 Y0 Z0 A0\nG1 F100 X1\nSPLINEPATH(1,X,Y,Z)\nUPATH\n\
         BSPLINE SD=3 X1 A1 PL=0\nX2 A2 PL=1\nX3 A3 PL=0\nG1 X4\n",
    ),
    ("step-unknown", "heidenhain", "[axis.A]\nkind = \"modulo\"", "1 L X+0 Y+0 Z+0 R0 FMAX\n2 L IA+1 F100\n"),
    ("tip-control", "sinumerik", "", "TRAORI\nG0 X0 Y0 Z0 A3=0 B3=0 C3=1\nTRAFOOF X0\n"),
];

/// The program of a cutter, as a motion, a text in it, and what stands in its place.
const PROGRAMS: &[(&str, &str, &str, &str)] = &[
    ("less-than-asked", "linear", "\nX30 Y2.62466 Z0.365282 A159.540524", ""),
    ("more-than-asked", "linear", "\nG0 Z500\nG0 SUPA Z0 D0", "\nX31\nG0 Z500\nG0 SUPA Z0 D0"),
    ("name-differs", "poly", "CONE10", "CONE11"),
    ("points-differ", "aspline", "\nX1.", "\nX1.5 Y0 Z0 A9\nX1."),
    ("section-differs", "poly", "; FLUTE 1 OF 1", "; FLUTE 1 OF 2"),
    ("setup-differs", "poly", "; RANGE: X 0", "; RANGE: X 1"),
];

/// What is raised, as errors or beside what they make.
fn raised<T>(of: Result<T, Diagnostics>, warnings: impl Fn(T) -> Diagnostics) -> Diagnostics {
    match of {
        Ok(value) => warnings(value),
        Err(errors) => errors,
    }
}

#[derive(Default)]
struct Shown(Vec<String>);

impl Shown {
    /// Holds an id against what a text raised.
    fn hold(&mut self, id: &str, found: &Diagnostics) {
        let entry = registry::find(id).unwrap_or_else(|| panic!("{id} has no entry"));
        let own = found.0.iter().find(|diagnostic| diagnostic.id == id);
        if !own.is_some_and(|own| entry.severities.contains(&own.severity)) {
            let ids: Vec<&str> = found.0.iter().map(|diagnostic| diagnostic.id).collect();
            self.0.push(format!("{id} is not raised, but {ids:?}"));
        }
    }
}

fn compiled_warnings(text: &str, machine: &Machine) -> Diagnostics {
    raised(compiled(text, machine, None), |output| output.warnings)
}

#[test]
fn machine_files_raise_them() {
    let mut shown = Shown::default();
    for (id, lines) in MACHINE_FILES {
        // The table of a key may stand behind it only.
        let text = format!("extends = \"sinumerik\"\n{lines}\n");
        shown.hold(id, &raised(Machine::parse(&text, SourceId::INPUT), |_| Diagnostics::new()));
    }
    fail_on(&shown.0);
}

#[test]
fn cutters_and_jobs_raise_them() {
    let mut shown = Shown::default();
    let sinumerik = machine("extends = \"sinumerik\"\n");
    let cutter = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
    for (id, line, changed) in CUTTERS {
        assert!(cutter.contains(line), "{id}");
        shown.hold(id, &compiled_warnings(&cutter.replacen(line, changed, 1), &sinumerik));
    }
    let head = "name = \"JOB\"\n[process]\nfeed = 100.0\nretract = { axis = \"Z\", to = 50.0 }\n";
    for (id, curve) in CURVES {
        shown.hold(id, &compiled_warnings(&format!("{head}[[curve]]\n{curve}\n"), &sinumerik));
    }
    // What the machine file decides.
    for (id, lines, changed) in [
        ("length-below-decimals", "tolerance = 1.0\n[digits]\nlinear = 0", "length = 0.3"),
        ("shift-missing", "[axis.A]\nkind = \"modulo\"\n[program]\nshift = []", "length = 30\nflutes = 4"),
        ("spline-wraps", "[axis.A]\nkind = \"modulo\"", "length = 30\n"),
    ] {
        let own = machine(&format!("extends = \"sinumerik\"\n{lines}\n"));
        let steep = if id == "spline-wraps" { cutter.replace("S = 30", "S = 75") } else { cutter.clone() };
        shown.hold(id, &compiled_warnings(&steep.replacen("length = 30", changed, 1), &own));
    }
    fail_on(&shown.0);
}

#[test]
fn curve_files_raise_them() {
    let mut shown = Shown::default();
    let sinumerik = machine("extends = \"sinumerik\"\n");
    for (id, name, text, changed) in CURVE_FILES {
        let file = std::fs::read_to_string(folder("fixtures/cases/curves").join(name)).expect("a case");
        let file = file.replace('\r', "");
        assert!(file.contains(text), "{id}");
        let job = format!(
            "name = \"PART\"\n[process]\nfeed = 1000.0\nretract = {{ axis = \"Z\", to = 50.0 }}\n\
             [[curve]]\nfile = \"{name}\"\nat = {{ Z = -2.0 }}\n"
        );
        let sources = sources_with(&job, &[(name, &file.replacen(text, changed, 1))]);
        let language = front::detect(sources.get(SourceId::INPUT).expect("an input")).expect("a language");
        let output = compile(&sources, language, &sinumerik, &Options::default());
        shown.hold(id, &raised(output.map_err(|failure| failure.diagnostics), |output| output.warnings));
    }
    fail_on(&shown.0);
}

fn cl_data(system: &str, text: &str, machine: &Machine) -> Diagnostics {
    let sources = Sources::new(Source::new("input.cl", text));
    let language = front::find(system).expect("a system");
    let output = compile(&sources, language, machine, &Options::default());
    raised(output.map_err(|failure| failure.diagnostics), |output| output.warnings)
}

#[test]
fn cl_data_raises_them() {
    let mut shown = Shown::default();
    let mazak = machine("extends = \"mazak\"\n");
    let start = "LOADTL/1\nSPINDL/1000\nFEDRAT/100\nRAPID\nGOTO/0,0,10\nGOTO/0,0,0\n";
    for (id, system, statements) in STATEMENTS {
        shown.hold(id, &cl_data(system, &format!("{start}{statements}FINI\n"), &mazak));
    }
    for (id, system, text) in CL_FILES {
        shown.hold(id, &cl_data(system, text, &mazak));
    }
    let stops = format!("{start}STOP\nGOTO/1,0,0\nFINI\n");
    let own = machine("extends = \"mazak\"\n[program]\nstop = []\n");
    shown.hold("auxiliary-missing", &cl_data("apt", &stops, &own));
    let open = "CYCLE/DRILL,CLEAR,3,FEDTO,2,MMPM,9\nGOTO/1,0,0\nGOHOME/0,0,50\n".repeat(21);
    let found = cl_data("apt", &format!("{start}{open}FINI\n"), &mazak);
    shown.hold("warnings-many", &found);
    assert_eq!(found.0.iter().filter(|warning| warning.id == "cycle-open").count(), 20);
    fail_on(&shown.0);
}

#[test]
fn nc_programs_raise_them() {
    let mut shown = Shown::default();
    for (id, name, lines, text) in BLOCKS {
        let own = machine(&format!("extends = \"{name}\"\n{lines}\n")).for_program(text);
        let reading = (own.dialect.read)(text, SourceId::INPUT, &own);
        shown.hold(id, &raised(reading, |reading| reading.warnings));
    }
    fail_on(&shown.0);
}

fn verified(input: &str, text: &str, machine: &Machine) -> Diagnostics {
    let mut sources = Sources::new(Source::new("input.toml", input));
    let id = sources.push(Source::new("program", text));
    let language = front::find("cutter").expect("a language");
    let found = verify_program(&sources, language, id, machine, &Options::default());
    raised(found, |verified| verified.warnings)
}

#[test]
fn programs_that_were_changed_raise_them() {
    let mut shown = Shown::default();
    let own = machine("extends = \"sinumerik\"\n[text]\nnumber_step = 0\n");
    let cutter = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
    for (id, motion, text, changed) in PROGRAMS {
        let program = compiled(&cutter, &own, own.dialect.motion(motion)).expect("it compiles").text;
        assert!(program.contains(text), "{id}: {program}");
        shown.hold(id, &verified(&cutter, &program.replacen(text, changed, 1), &own));
    }
    let mazak = machine("extends = \"mazak\"\n");
    let program = compiled(&cutter, &mazak, None).expect("it compiles").text;
    shown.hold("number-differs", &verified(&cutter, &program.replacen("O0001", "O0002", 1), &mazak));
    fail_on(&shown.0);
}

#[test]
fn two_programs_raise_them() {
    let mut shown = Shown::default();
    let own = machine("extends = \"sinumerik\"\n[text]\nnumber_step = 0\n");
    let head = "name = \"JOB\"\n[process]\nfeed = 100.0\nretract = { axis = \"Z\", to = 50.0 }\n";
    let curve = |y: usize| {
        format!(
            "[[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\", \"Z\"]\npoints = [[0, {y}, 0], [9, {y}, 0]]\n"
        )
    };
    let lines: String = std::iter::once(head.to_owned()).chain((1..=8).map(|i| curve(20 * i))).collect();
    let program = compiled(&lines, &own, None).expect("it compiles").text;
    let cutter = compiled(&input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", ""), &own, None);
    let cutter = cutter.expect("it compiles").text;
    let differences = |a: &str, b: &str| {
        let sources = [a, b].map(|text| Sources::new(Source::new("program", text)));
        let origin = Origin::Program(Box::new(own.clone()));
        let options = diff::Options::default();
        let found = diff::compare([&sources[0], &sources[1]], [&origin, &origin], &options);
        raised(found, |comparison| comparison.differences)
    };
    let faster = program.replace("F100", "F101");
    shown.hold("more-differences", &differences(&program, &faster));
    shown.hold("axes-differ", &differences(&cutter, &program));
    fail_on(&shown.0);
}

#[test]
fn translations_raise_them() {
    let mut shown = Shown::default();
    let (from, to) = (machine("extends = \"sinumerik\"\n"), machine("extends = \"mazak\"\n"));
    let corrected = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "").replacen(
        "feed = 200",
        "feed = 200\ncorrection = { axis = \"Y\", value = 0.0 }",
        1,
    );
    let program = compiled(&corrected, &from, None).expect("it compiles").text;
    let sources = Sources::new(Source::new("program.mpf", program));
    let output = recompile(&sources, &from, &to, &Options::default());
    shown.hold(
        "parameter-translated",
        &raised(output.map_err(|failure| failure.diagnostics), |output| output.warnings),
    );
    fail_on(&shown.0);
}
