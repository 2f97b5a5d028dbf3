//! The program as a user meets it: exit codes, files, streams.

use crate::support::folder;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn splinepost(arguments: &[&str], within: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_splinepost"))
        .args(arguments)
        .current_dir(within)
        .output()
        .expect("it runs")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("an exit code")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn mill() -> String {
    folder("fixtures/compile/conical-mill/input.toml").display().to_string()
}

#[test]
fn compile_prints_the_program_and_a_summary() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = splinepost(&["compile", &mill(), "--to", "sinumerik"], folder.path());
    assert_eq!(code(&output), 0);
    let program = String::from_utf8(output.stdout.clone()).expect("ASCII");
    assert!(program.starts_with("; CONE10\n") && program.ends_with("M30\n"));
    let summary = stderr(&output);
    for word in ["blocks", "mm cutting", "proved", "rad in A", "axial", "generatrix", "lead", "diameter"] {
        assert!(summary.contains(word), "{word} is not in\n{summary}");
    }
}

#[test]
fn a_program_that_was_written_verifies() {
    let folder = tempfile::tempdir().expect("a folder");
    for (machine, file) in [("sinumerik", "A.MPF"), ("heidenhain", "A.H"), ("mazak", "A.EIA")] {
        assert_eq!(code(&splinepost(&["compile", &mill(), "--to", machine, "-o", file], folder.path())), 0);
        let output = splinepost(&["verify", file, "--against", &mill(), "--to", machine], folder.path());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        assert!(stderr(&output).contains("proved"));
        let path = folder.path().join(file);
        let damaged = fs::read_to_string(&path).expect("text").replacen("50", "40", 1);
        fs::write(&path, damaged).expect("written");
        let output = splinepost(&["verify", file, "--against", &mill(), "--to", machine], folder.path());
        assert_eq!(code(&output), 1, "{}", stderr(&output));
        assert!(stderr(&output).contains(file), "no place in\n{}", stderr(&output));
    }
}

#[test]
fn bad_input_ends_with_2_and_touches_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = dir.path();
    fs::write(at.join("empty.toml"), "").expect("written");
    fs::write(at.join("latin.toml"), b"name = \"Fr\xe4ser\"\n").expect("written");
    fs::write(at.join("old.mpf"), "old").expect("written");
    fs::create_dir(at.join("sub")).expect("made");
    fs::copy(mill(), at.join("mill.toml")).expect("copied");
    fs::write(at.join("mine.toml"), "extends = \"mazak\"\n").expect("written");
    let mill = mill();
    let cases: &[&[&str]] = &[
        &["compile", "empty.toml", "--to", "sinumerik", "-o", "old.mpf"],
        &["compile", "latin.toml", "--to", "sinumerik", "-o", "old.mpf"],
        &["compile", "sub", "--to", "sinumerik", "-o", "old.mpf"],
        &["compile", "none.toml", "--to", "sinumerik", "-o", "old.mpf"],
        &["compile", &mill, "--to", "sinumeric", "-o", "old.mpf"],
        &["compile", &mill, "--to", "sinumerik", "--motion", "spl", "-o", "old.mpf"],
        &["compile", &mill, "--to", "sinumerik", "--tolerance", "0", "-o", "old.mpf"],
        &["compile", &mill, "--to", "sinumerik", "--tolerance", "1e-9", "-o", "old.mpf"],
        &["compile", &mill, "--to", "sinumerik", "-o", "sub"],
        &["compile", &mill, "--to", "sinumerik", "-o", "none/there.mpf"],
        &["compile", "mill.toml", "--to", "sinumerik", "-o", "mill.toml"],
        &["compile", "mill.toml", "--to", "mine.toml", "-o", "mine.toml"],
        &["compile", &mill, "--to", "sinumerik", "-o", ""],
        &["compile", &mill],
        &["verify", "none.mpf", "--against", &mill, "--to", "sinumerik"],
        &["interpolate", "empty.toml"],
        &["machines", "--show", "none"],
    ];
    for case in cases {
        let output = splinepost(case, at);
        assert_eq!(code(&output), 2, "{case:?}: {}", stderr(&output));
        assert!(
            output.stdout.is_empty() && stderr(&output).contains("error"),
            "{case:?}: {}",
            stderr(&output)
        );
    }
    assert_eq!(fs::read_to_string(at.join("old.mpf")).expect("still there"), "old");
    let mut left: Vec<String> = fs::read_dir(at)
        .expect("a folder")
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .collect();
    left.sort();
    assert_eq!(left, ["empty.toml", "latin.toml", "mill.toml", "mine.toml", "old.mpf", "sub"]);
}

#[test]
fn messages_come_as_json_lines() {
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("bad.toml"), "[cutter]\nD2 = 1\n").expect("written");
    let output =
        splinepost(&["--message-format", "json", "compile", "bad.toml", "--to", "mazak"], dir.path());
    let line: serde_json::Value =
        serde_json::from_str(stderr(&output).lines().next().expect("a line")).expect("JSON");
    assert_eq!((&line["id"], &line["line"], &line["column"]), (&"key-unknown".into(), &2.into(), &1.into()));
    let output =
        splinepost(&["--message-format", "json", "compile", &mill(), "--to", "sinumerik"], dir.path());
    let last: serde_json::Value =
        serde_json::from_str(stderr(&output).lines().last().expect("a line")).expect("JSON");
    assert_eq!(last["summary"]["status"], "proved");
}

#[test]
fn standard_input_and_output_serve_as_files() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_splinepost"))
        .args(["compile", "-", "--to", "sinumerik"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    let text = fs::read(mill()).expect("the input");
    child.stdin.take().expect("a pipe").write_all(&text).expect("written");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(output.stdout.starts_with(b"; CONE10"));
}

#[test]
fn coarse_steps_are_warned_of_and_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let text =
        fs::read_to_string(mill()).expect("the input") + "[interpolation]\ndl = 0.5\ntolerance = 0.0005\n";
    fs::write(dir.path().join("coarse.toml"), text).expect("written");
    let output =
        splinepost(&["compile", "coarse.toml", "--to", "sinumerik", "--motion", "linear"], dir.path());
    assert_eq!(code(&output), 0);
    let told = stderr(&output);
    assert!(told.contains("warning[steps-exceed-tolerance]") && told.contains("dl = 0.3"), "{told}");
    assert!(!output.stdout.is_empty());
}

#[test]
fn a_curve_whose_speed_varies_is_warned_of() {
    let dir = tempfile::tempdir().expect("a folder");
    let job = folder("fixtures/compile/lissajous/input.toml").display().to_string();
    let told = |machine: &str| {
        let output = splinepost(&["compile", &job, "--to", machine], dir.path());
        assert_eq!(code(&output), 0);
        stderr(&output)
    };
    // With w degrees of A for a radian of u, F counts √(v² + w²) where v is the speed by u along X and Y: the ratio of the
    // two is greatest where v is least. v² = 900 sin²u + 3600 cos²2u is least where cos 2u = 1/16, greatest at u = π/2.
    let w = 180.0 / std::f64::consts::PI;
    let slow = (450.0 * (1.0 - 1.0 / 16.0) + 3600.0 / 256.0f64).sqrt();
    let fast = (900.0 + 3600.0f64).sqrt();
    let ratio = |v: f64| (v * v + w * w).sqrt() / v;
    assert!(ratio(fast) < ratio(slow));
    for machine in ["heidenhain", "mazak"] {
        let told = told(machine);
        let figure = told.split("the speed is up to ").nth(1).expect("a warning[feed-varies]");
        let percent: f64 = figure.split(' ').next().expect("a figure").parse().expect("a number");
        // F is such that the time holds, so the mean ratio lies between both: farther off than either end it cannot be.
        let most = 100.0 * (ratio(slow) / ratio(fast) - 1.0);
        assert!(5.0 < percent && percent < most, "{percent} {most}");
        assert!(told.contains(&format!("error = {}", percent.ceil() / 100.0)), "{told}");
    }
    assert!(!told("sinumerik").contains("feed-varies"));
}

#[test]
fn a_closed_pipe_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_splinepost"))
        .args(["compile", &mill(), "--to", "sinumerik", "--motion", "linear"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
}

#[test]
fn without_proof_the_program_says_so() {
    let dir = tempfile::tempdir().expect("a folder");
    let output = splinepost(&["compile", &mill(), "--to", "sinumerik", "--no-verify"], dir.path());
    assert!(String::from_utf8_lossy(&output.stdout).contains("; NOT VERIFIED\n"));
    assert!(stderr(&output).contains("not verified"));
}

#[cfg(unix)]
#[test]
fn an_existing_file_keeps_its_mode_and_links_are_followed() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let dir = tempfile::tempdir().expect("a folder");
    let target = dir.path().join("real.mpf");
    fs::write(&target, "old").expect("written");
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).expect("set");
    symlink("real.mpf", dir.path().join("link.mpf")).expect("linked");
    assert_eq!(
        code(&splinepost(&["compile", &mill(), "--to", "sinumerik", "-o", "link.mpf"], dir.path())),
        0
    );
    assert!(dir.path().join("link.mpf").is_symlink());
    assert_eq!(fs::metadata(&target).expect("there").permissions().mode() & 0o777, 0o640);
    assert!(fs::read_to_string(&target).expect("text").starts_with("; CONE10"));
    let output = splinepost(&["compile", &mill(), "--to", "sinumerik", "-o", "/dev/null"], dir.path());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
}

#[cfg(unix)]
#[test]
fn a_link_leads_to_a_file_that_is_not_there_yet() {
    use std::os::unix::fs::symlink;
    let dir = tempfile::tempdir().expect("a folder");
    symlink("new.mpf", dir.path().join("link.mpf")).expect("linked");
    symlink("gone/new.mpf", dir.path().join("lost.mpf")).expect("linked");
    symlink("circle.mpf", dir.path().join("circle.mpf")).expect("linked");
    let written = |name: &str| splinepost(&["compile", &mill(), "--to", "sinumerik", "-o", name], dir.path());
    assert_eq!(code(&written("link.mpf")), 0);
    assert!(dir.path().join("link.mpf").is_symlink());
    assert!(fs::read_to_string(dir.path().join("new.mpf")).expect("text").starts_with("; CONE10"));
    for (name, why) in [("lost.mpf", "there is no folder gone"), ("circle.mpf", "leads nowhere")] {
        let output = written(name);
        let told = stderr(&output);
        assert_eq!(code(&output), 2, "{told}");
        assert!(told.contains("output-failed") && told.contains(why), "{told}");
        assert!(dir.path().join(name).is_symlink());
    }
}

#[test]
fn lists_and_dumps_are_printed() {
    let dir = tempfile::tempdir().expect("a folder");
    let machines = splinepost(&["machines"], dir.path());
    assert!(String::from_utf8_lossy(&machines.stdout).contains("sinumerik-840d"));
    let show = splinepost(&["machines", "--show", "mazak"], dir.path());
    assert!(String::from_utf8_lossy(&show.stdout).contains("which axes G06.1 and G06.2 may move"));
    let dump = splinepost(&["dump", &mill()], dir.path());
    assert!(String::from_utf8_lossy(&dump.stdout).contains("logarithmic D1 10 S 30"));
    assert_eq!(code(&splinepost(&["check", &mill()], dir.path())), 0);
    assert_eq!(code(&splinepost(&["completions", "bash"], dir.path())), 0);
}

#[test]
fn diagnostics_are_explained() {
    let dir = tempfile::tempdir().expect("a folder");
    let printed = |arguments: &[&str]| {
        let output = splinepost(arguments, dir.path());
        assert_eq!((code(&output), stderr(&output).as_str()), (0, ""), "{arguments:?}");
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    let page = printed(&["explain", "arc-sense"]);
    assert!(
        page.starts_with("arc-sense: error (exit code 2), warning (exit code 0)\n\nThe arcs of the file")
    );
    assert!(page.lines().all(|line| line.len() <= 88) && page.contains("--words"), "{page}");
    // As it stands in a message.
    assert_eq!(printed(&["explain", "error[arc-sense]:"]), page);
    assert!(printed(&["explain", "arc-sweep", "--format", "json"]).starts_with("{\"id\":\"arc-sweep\","));
    let all = splinepost::diagnostic::registry::all();
    let listed = printed(&["explain"]);
    assert!(
        all.iter().all(|entry| listed.contains(&format!("  {} ", entry.id)) && listed.contains(entry.says))
    );
    let lines = printed(&["explain", "--format", "json"]);
    let ids = lines.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
    assert!(ids.map(|value| value["id"].clone()).eq(all.iter().map(|entry| entry.id)));
    let output = splinepost(&["explain", "arc-sens"], dir.path());
    assert_eq!(code(&output), 2);
    let told = stderr(&output);
    assert!(
        told.contains("error[diagnostic-unknown]") && told.contains("did you mean `arc-sense` or"),
        "{told}"
    );
    assert!(output.stdout.is_empty());
}

#[test]
fn what_is_asked_of_the_command_is_told_by_its_id() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = dir.path();
    let told = |arguments: &[&str], id: &str, exit: i32| {
        let output = splinepost(arguments, at);
        let told = stderr(&output);
        assert!(code(&output) == exit && told.contains(&format!("[{id}]")), "{arguments:?}: {told}");
    };
    told(&["man", "nonsense"], "command-unknown", 2);
    let text = fs::read_to_string(mill()).expect("the input");
    fs::write(at.join("part.toml"), text.replace("feed = ", "approach_feed = ")).expect("written");
    told(&["check", "part.toml"], "process-incomplete", 0);
    assert_eq!(code(&splinepost(&["compile", &mill(), "--to", "sinumerik", "-o", "p.mpf"], at)), 0);
    let other = folder("fixtures/compile/cylinder/input.toml").display().to_string();
    let plot = ["plot", "p.mpf", "--to", "sinumerik", "--against", &other, "-o", "p.svg"];
    told(&plot, "figure-left-out", 0);
}

#[test]
fn cl_data_goes_the_same_way() {
    let folder = tempfile::tempdir().expect("a folder");
    let within = folder.path();
    let input = crate::support::folder("fixtures/apt/creo-pocket/input.ncl").display().to_string();
    let run = |arguments: &[&str]| splinepost(arguments, within);
    let output = run(&["compile", &input, "--to", "mazak", "-o", "P.EIA", "--map", "P.json"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let map = fs::read_to_string(within.join("P.json")).expect("a map");
    assert!(map.contains("\"blocks\":[") && map.contains("input.ncl"), "{map}");
    let output = run(&["verify", "P.EIA", "--against", &input, "--to", "mazak"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(code(&run(&["check", &input])), 0);
    let dump = String::from_utf8(run(&["dump", &input, "--from", "creo"]).stdout).expect("UTF-8");
    assert!(dump.contains("arc Xy CounterClockwise"), "{dump}");
    // As another system the arcs go the other way, which their neighbours contradict.
    let output = run(&["dump", &input, "--from", "nx"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("arc Xy Clockwise"));
    assert!(stderr(&output).contains("warning[arc-sense]"), "{}", stderr(&output));
    // What nobody knows: an error, a warning, or what the shop says.
    let text = "UNITS/MM\nFEDRAT/9\nFROBNI/1\nGOTO/1,2,3\nGOTO/1,2,4\n";
    fs::write(within.join("a.cl"), text).expect("written");
    fs::write(within.join("shop.toml"), "[words]\nFROBNI = \"comment\"\n").expect("written");
    let output = run(&["compile", "a.cl", "--to", "sinumerik", "-o", "A.MPF"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("a.cl:3:1") && !within.join("A.MPF").exists(), "{}", stderr(&output));
    assert_eq!(code(&run(&["compile", "a.cl", "--to", "sinumerik", "--lenient", "-o", "A.MPF"])), 0);
    let output = run(&["compile", "a.cl", "--to", "sinumerik", "--words", "shop.toml"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("; FROBNI 1\n"), "{}", stderr(&output));
    // Understood, and not compiled: the answer is no.
    fs::write(within.join("a.cl"), "FEDRAT/9\nGOTO/1,2,3\nCUTCOM/LEFT\nGOTO/1,2,4\n").expect("written");
    let output = run(&["compile", "a.cl", "--to", "sinumerik", "-o", "B.MPF"]);
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("cutter-compensation") && !within.join("B.MPF").exists());
    // Bytes that are no text at all.
    let bytes: Vec<u8> = (0..4096u32).map(|i| (i * 7919 % 256) as u8).collect();
    fs::write(within.join("b.cl"), &bytes).expect("written");
    for from in
        [&["compile", "b.cl", "--to", "mazak"][..], &["compile", "b.cl", "--from", "apt", "--to", "mazak"]]
    {
        let output = run(from);
        assert_eq!(code(&output), 2, "{}", stderr(&output));
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn a_program_for_one_machine_becomes_one_for_another() {
    let temporary = tempfile::tempdir().expect("a folder");
    let within = temporary.path();
    let circle = folder("fixtures/compile/circle/input.toml").display().to_string();
    let run = |arguments: &[&str]| splinepost(arguments, within);
    let first = run(&["compile", &circle, "--to", "sinumerik", "--motion", "bspline", "-o", "a.mpf"]);
    assert_eq!(code(&first), 0, "{}", stderr(&first));
    let second = run(&["compile", "a.mpf", "--from", "sinumerik", "--to", "mazak", "-o", "b.eia"]);
    assert_eq!(code(&second), 0, "{}", stderr(&second));
    assert!(stderr(&second).contains("proved"));
    let text = fs::read_to_string(within.join("a.mpf")).expect("a program");
    let head = |lines: usize| text.split_inclusive('\n').take(lines).collect::<String>();
    for (name, damaged, id) in [
        ("cut.mpf", head(22), "footer-differs"),
        ("head.mpf", head(4), "moves-missing"),
        ("word.mpf", text.replace("BSPLINE", "BSPLNE"), "word-unknown"),
    ] {
        fs::write(within.join(name), damaged).expect("written");
        let output = run(&["compile", name, "--from", "sinumerik", "--to", "mazak", "-o", "none.eia"]);
        assert_eq!(code(&output), 2, "{name}: {}", stderr(&output));
        assert!(stderr(&output).contains(id) && stderr(&output).contains(name), "{}", stderr(&output));
        assert!(!within.join("none.eia").exists());
    }
    for wrong in [&["--from", "nonsense"][..], &["--corner", "30"], &["--fit", "--corner", "180"]] {
        let output = run(&[&["compile", "a.mpf", "--to", "mazak"], wrong].concat());
        assert_eq!(code(&output), 2, "{wrong:?}: {}", stderr(&output));
    }
}

/// Program and map are two files of their own, or nothing is written.
#[cfg(unix)]
#[test]
fn a_map_is_written_over_nothing() {
    use std::os::unix::fs::symlink;
    let dir = tempfile::tempdir().expect("a folder");
    let at = dir.path();
    fs::copy(folder("fixtures/apt/catia-arcs/input.aptsource"), at.join("part.apt")).expect("copied");
    fs::write(at.join("mine.toml"), "extends = \"sinumerik\"\n").expect("written");
    fs::write(at.join("words.toml"), "[words]\n").expect("written");
    fs::write(at.join("old.mpf"), "old").expect("written");
    fs::create_dir(at.join("sub")).expect("made");
    for (target, link) in [("part.apt", "link.apt"), ("old.mpf", "link.mpf"), ("new.mpf", "new.link")] {
        symlink(target, at.join(link)).expect("a link");
    }
    let before: Vec<_> = files(at);
    let cases: &[(&str, &str, &str)] = &[
        ("old.mpf", "part.apt", "output-is-input"),
        ("old.mpf", "./part.apt", "output-is-input"),
        ("old.mpf", "sub/../part.apt", "output-is-input"),
        ("old.mpf", "link.apt", "output-is-input"),
        ("old.mpf", "mine.toml", "output-is-input"),
        ("old.mpf", "words.toml", "output-is-input"),
        ("words.toml", "map.json", "output-is-input"),
        ("old.mpf", "old.mpf", "outputs-are-one"),
        ("old.mpf", "link.mpf", "outputs-are-one"),
        ("new.mpf", "./new.mpf", "outputs-are-one"),
        ("new.mpf", "sub/../new.mpf", "outputs-are-one"),
        ("new.mpf", "new.link", "outputs-are-one"),
        ("-", "-", "outputs-are-one"),
        ("old.mpf", "none/map.json", "output-failed"),
        ("new.mpf", "none/map.json", "output-failed"),
        ("new.mpf", "", "output-failed"),
        ("none/new.mpf", "map.json", "output-failed"),
        ("new.mpf", "sub", "file-is-directory"),
    ];
    for (output, map, id) in cases {
        let arguments =
            ["compile", "part.apt", "--to", "mine.toml", "--words", "words.toml", "-o", output, "--map", map];
        let ran = splinepost(&arguments, at);
        assert_eq!(code(&ran), 2, "{output} {map}: {}", stderr(&ran));
        assert!(stderr(&ran).contains(id), "{output} {map}: {}", stderr(&ran));
        assert!(ran.stdout.is_empty(), "{output} {map}");
        assert_eq!(files(at), before, "{output} {map}");
    }
    // Either may be standard output.
    let ran = splinepost(&["compile", "part.apt", "--to", "mine.toml", "-o", "a.mpf", "--map", "-"], at);
    assert_eq!(code(&ran), 0, "{}", stderr(&ran));
    assert!(serde_json::from_slice::<serde_json::Value>(&ran.stdout).is_ok() && at.join("a.mpf").exists());
    let ran = splinepost(&["compile", "part.apt", "--to", "mine.toml", "--map", "old.mpf"], at);
    assert_eq!(code(&ran), 0, "{}", stderr(&ran));
    assert!(ran.stdout.starts_with(b"; ") && fs::read(at.join("old.mpf")).expect("it")[0] == b'{');
}

/// The names of the files in a folder, and what they hold.
#[cfg(unix)]
fn files(at: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(at).expect("a folder").flatten();
    let mut all: Vec<_> = entries
        .map(|entry| {
            let bytes = fs::read(entry.path()).unwrap_or_default();
            (entry.file_name().to_string_lossy().into_owned(), bytes)
        })
        .collect();
    all.sort();
    all
}

#[test]
fn a_tolerance_of_metres_is_a_slip() {
    let dir = tempfile::tempdir().expect("a folder");
    for (tolerance, expected) in [("1", 0), ("1.001", 2), ("1e9", 2), ("inf", 2)] {
        let ran =
            splinepost(&["compile", &mill(), "--to", "sinumerik", "--tolerance", tolerance], dir.path());
        assert_eq!(code(&ran), expected, "{tolerance}: {}", stderr(&ran));
    }
}

/// What has no end is read no farther than a file may be long.
#[cfg(unix)]
#[test]
fn an_input_without_end_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = dir.path();
    std::os::unix::fs::symlink("/dev/zero", at.join("zero.dxf")).expect("a link");
    fs::write(
        at.join("job.toml"),
        "name = \"ZERO\"\n[process]\nfeed = 100.0\n[[curve]]\nfile = \"zero.dxf\"\n",
    )
    .expect("written");
    let mill = mill();
    let cases: [&[&str]; 4] = [
        &["compile", "/dev/zero", "--to", "mazak", "-o", "out.nc"],
        &["compile", "job.toml", "--to", "mazak", "-o", "out.nc"],
        &["compile", &mill, "--to", "/dev/zero", "-o", "out.nc"],
        &["verify", "/dev/zero", "--against", &mill, "--to", "mazak"],
    ];
    for case in cases {
        let output = splinepost(case, at);
        assert_eq!(code(&output), 2, "{case:?}: {}", stderr(&output));
        let told = stderr(&output);
        assert!(
            told.contains("larger than 512 MiB") && told.matches("error[").count() == 1,
            "{case:?}: {told}"
        );
        assert!(!at.join("out.nc").exists());
    }
    let endless = fs::File::open("/dev/zero").expect("zeros");
    let output = Command::new(env!("CARGO_BIN_EXE_splinepost"))
        .args(["compile", "-", "--to", "mazak"])
        .stdin(endless)
        .output()
        .expect("it runs");
    assert_eq!(code(&output), 2);
    let told = stderr(&output);
    assert!(told.contains("error[file-too-large]: standard input is larger than 512 MiB"), "{told}");
}
