//! Documents, fixtures and the rules of `docs/architecture.md` in step with the code.

use crate::support::folder;
use std::fs;
use std::path::{Path, PathBuf};

pub(crate) fn files(under: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(under).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

pub(crate) fn source(path: &Path) -> String {
    fs::read_to_string(path).expect("UTF-8")
}

/// The code without its tests and comments.
pub(crate) fn code(path: &Path) -> String {
    if path.ends_with("tests.rs") {
        return String::new();
    }
    let text = source(path);
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_dialect_has_a_page_and_a_machine() {
    for dialect in splinepost::dialect::DIALECTS {
        let page = folder("docs/dialects").join(format!("{}.md", dialect.name));
        let text = source(&page);
        for motion in dialect.motions {
            assert!(
                text.contains(&format!("`{}`", motion.name)),
                "{} does not name {}",
                page.display(),
                motion.name
            );
        }
        assert!(
            splinepost::machine::built_in(dialect.name).is_some(),
            "{} has no default machine",
            dialect.name
        );
    }
}

/// A key that no page speaks of is a key that nobody finds.
#[test]
fn every_key_stands_in_a_document() {
    let mut pages: String = files(&folder("docs"), "md").iter().map(|path| source(path)).collect();
    pages.push_str(&source(&folder("README.md")));
    pages.extend(files(&folder("grammar"), "ebnf").iter().map(|path| source(path)));
    let mut keys: Vec<&splinepost::tables::Key> =
        [splinepost::front::cutter::KEYS, splinepost::front::job::KEYS, splinepost::machine::KEYS]
            .into_iter()
            .flatten()
            .collect();
    while let Some(key) = keys.pop() {
        let named = [
            format!("`{}", key.name),
            format!("\"{}\"", key.name),
            format!("[{}", key.name),
            format!("{}\"", key.name),
        ];
        assert!(named.iter().any(|form| pages.contains(form.as_str())), "no page speaks of {}", key.name);
        keys.extend(key.inner);
    }
}

#[test]
fn storeys_import_only_what_they_may() {
    let forbidden: &[(&str, &[&str])] = &[
        (
            "src/geom",
            &[
                "crate::ir",
                "crate::decimal",
                "crate::diagnostic",
                "crate::source",
                "crate::machine",
                "crate::dialect",
                "crate::front",
                "crate::pass",
                "crate::verify",
            ],
        ),
        ("src/dialect", &["crate::front"]),
        ("src/front", &["crate::dialect"]),
    ];
    for (storey, names) in forbidden {
        for path in files(&folder(storey), "rs") {
            for name in *names {
                assert!(!code(&path).contains(name), "{} imports {name}", path.display());
            }
        }
    }
}

#[test]
fn the_library_does_no_input_or_output() {
    for path in files(&folder("src"), "rs") {
        if path.components().any(|part| part.as_os_str() == "cli") || path.ends_with("main.rs") {
            continue;
        }
        for word in
            ["std::fs", "std::io", "println!", "std::env", "std::process", ".unwrap()", ".expect(", "panic!("]
        {
            assert!(!code(&path).contains(word), "{} has {word}", path.display());
        }
    }
}

#[test]
fn intermediate_types_are_not_serialised() {
    for path in files(&folder("src/ir"), "rs").into_iter().chain([folder("src/ir.rs")]) {
        assert!(!code(&path).contains("serde"), "{}", path.display());
    }
}

#[test]
fn numbers_are_rounded_in_one_place() {
    // Knots are free numbers, so `convert` chooses them on the control's grid, as `place` chooses the angles of planes;
    // nothing else rounds before or after.
    for storey in ["src/pass", "src/dialect"] {
        for path in files(&folder(storey), "rs") {
            if ["quantise.rs", "convert/spline.rs", "place/plane.rs"].iter().any(|free| path.ends_with(free))
            {
                continue;
            }
            for word in ["round_units", "Decimal::round"] {
                assert!(!code(&path).contains(word), "{} rounds", path.display());
            }
        }
    }
}

#[test]
fn transcendental_functions_have_one_home() {
    for path in files(&folder("src"), "rs") {
        if !path.ends_with("elementary.rs") {
            assert!(!code(&path).contains("libm::"), "{} calls libm", path.display());
        }
    }
}

#[test]
fn files_stay_readable() {
    for path in files(&folder("src"), "rs") {
        let lines = source(&path).lines().count();
        assert!(lines <= 600, "{} has {lines} lines: look for the seam", path.display());
    }
    for path in
        [files(&folder("src"), "rs"), files(&folder("docs"), "md"), files(&folder("tests"), "rs")].concat()
    {
        for (i, line) in source(&path).lines().enumerate() {
            assert_eq!(line, line.trim_end(), "{}:{} has blanks at its end", path.display(), i + 1);
        }
    }
}
