//! Jobs that name files, from the command line.

use crate::support::folder;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn splinepost(arguments: &[&str], within: &Path, input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_splinepost"))
        .args(arguments)
        .current_dir(within)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    // Whoever fails early reads nothing.
    let _ = child.stdin.take().expect("a pipe").write_all(input.as_bytes());
    child.wait_with_output().expect("it ends")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn every_command_takes_a_job_that_names_a_file() {
    let home = tempfile::tempdir().expect("a folder");
    let shop = home.path().join("shop");
    fs::create_dir(&shop).expect("a folder");
    for file in ["slot.dxf", "input.toml"] {
        fs::copy(folder("fixtures/curves/slot").join(file), shop.join(file)).expect("copied");
    }
    let run = |arguments: &[&str]| splinepost(arguments, home.path(), "");
    // The path of the drawing starts where the job stands.
    let job = "shop/input.toml";
    for (machine, file) in [("sinumerik", "A.MPF"), ("heidenhain", "A.H"), ("mazak", "A.EIA")] {
        let map = format!("{file}.json");
        let output = run(&["compile", job, "--to", machine, "-o", file, "--map", &map]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(
            fs::read_to_string(home.path().join(map)).expect("a map").contains("\"file\":\"shop/slot.dxf\"")
        );
        let output = run(&["verify", file, "--against", job, "--to", machine]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let damaged = fs::read_to_string(home.path().join(file)).expect("text").replace("50.8", "50.9");
        fs::write(home.path().join(file), damaged).expect("written");
        let output = run(&["verify", file, "--against", job, "--to", machine]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        let output = run(&["plot", file, "--to", machine, "--against", job, "-o", "a.svg"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    for arguments in [
        &["check", job][..],
        &["dump", job],
        &["interpolate", job, "--format", "csv"],
        &["simulate", job],
        &["plot", job, "-o", "b.html"],
        &["plot", job, "--to", "sinumerik", "-o", "c.svg"],
    ] {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains("slot.dxf"), "{arguments:?} tells nothing of TEXT");
    }
    // The arcs are there: the slot reaches 12.7 mm past its lines.
    let table = String::from_utf8(run(&["interpolate", job, "--format", "csv"]).stdout).expect("text");
    let x = table.lines().skip(1).filter_map(|line| line.split(',').nth(2)?.parse::<f64>().ok());
    assert!((x.fold(0.0, f64::max) - 63.5).abs() < 0.01);
    // From standard input the path starts in the current folder.
    let text = fs::read_to_string(shop.join("input.toml")).expect("a job");
    let output = splinepost(&["compile", "-", "--to", "mazak"], &shop, &text);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output =
        splinepost(&["--message-format", "json", "compile", "-", "--to", "mazak"], home.path(), &text);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    assert!(stderr(&output).contains("\"id\":\"file-unreadable\"") && stderr(&output).contains("\"line\":9"));
}

#[test]
fn what_is_read_is_not_written_over() {
    let home = tempfile::tempdir().expect("a folder");
    for file in ["slot.dxf", "input.toml"] {
        fs::copy(folder("fixtures/curves/slot").join(file), home.path().join(file)).expect("copied");
    }
    let before = fs::read(home.path().join("slot.dxf")).expect("the drawing");
    let output = splinepost(&["compile", "input.toml", "--to", "mazak", "-o", "slot.dxf"], home.path(), "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("output-is-input"));
    assert_eq!(fs::read(home.path().join("slot.dxf")).expect("the drawing"), before);
    let output = splinepost(&["compile", "slot.dxf", "--to", "mazak"], home.path(), "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("curve-file-alone") && stderr(&output).contains("file = \"slot.dxf\""));
}
