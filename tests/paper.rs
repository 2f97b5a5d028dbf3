//! Jiang and Chen's accuracy test: the 20 rows of Table 1 and the figures of the text.

#![allow(clippy::approx_constant, reason = "the paper's figures are not constants of nature")]

use crate::support::sources;
use splinepost::front::cutter;
use splinepost::points::Table;
use splinepost::source::SourceId;

/// Nos., X, A, PA, ErPA in units of 1e-4, as printed.
const TABLE_1: [(usize, f64, f64, f64, f64); 20] = [
    (0, 0.0, 0.0, 0.0, 0.0),
    (1, 0.1987, 0.0229, 0.0229, -0.3979),
    (2, 0.3974, 0.0457, 0.0457, -0.0001),
    (3, 0.5961, 0.0685, 0.0685, -0.3926),
    (4, 0.7948, 0.0911, 0.0911, -0.0002),
    (5, 0.9935, 0.1138, 0.1137, -0.3874),
    (6, 1.1922, 0.1363, 0.1363, -0.0003),
    (7, 1.3910, 0.1587, 0.1587, -0.3823),
    (8, 1.5897, 0.1811, 0.1811, -0.0004),
    (9, 1.7885, 0.2034, 0.2033, -0.3773),
    (143, 28.4736, 2.6679, 2.6679, -0.1829),
    (144, 28.6730, 2.6833, 2.6833, -0.0034),
    (145, 28.8724, 2.6986, 2.6986, -0.1813),
    (146, 29.0718, 2.7138, 2.7138, -0.0035),
    (147, 29.2713, 2.7291, 2.7291, -0.1797),
    (148, 29.4707, 2.7443, 2.7443, -0.0035),
    (149, 29.6701, 2.7595, 2.7595, -0.1781),
    (150, 29.8695, 2.7746, 2.7746, -0.0035),
    (151, 30.0689, 2.7897, 2.7897, -0.1765),
    (152, 30.2684, 2.8048, 2.8048, -0.0035),
];

fn table(interpolation: &str) -> Table {
    let text =
        format!("[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\n[interpolation]\n{interpolation}\n");
    let sources = sources(&text);
    let job =
        cutter::parse(sources.get(SourceId::INPUT).expect("the input"), SourceId::INPUT).expect("it reads");
    Table::new(&job.flutes[0], 0.001).expect("a table")
}

/// What the paper prints: four decimals.
fn printed(x: f64) -> String {
    let text = format!("{x:.4}");
    if text == "-0.0000" { "0.0000".to_owned() } else { text }
}

#[test]
fn every_printed_digit_of_table_1() {
    let table = table("dl = 0.2\noverrun = true");
    assert_eq!(table.count, 152);
    for (n, x, a, pa, er) in TABLE_1 {
        let row = &table.points[n];
        let ours = [row.x, row.a_rad, row.pa_rad, row.er_pa_rad * 1.0e4].map(printed);
        assert_eq!(ours, [x, a, pa, er].map(printed), "row {n}");
    }
}

#[test]
fn the_greatest_errors_as_printed() {
    let fine = table("dl = 0.2\noverrun = true");
    let figures = |table: &Table| [table.max, table.max_odd, table.max_even].map(|x| format!("{x:.4e}"));
    assert_eq!(figures(&fine), ["3.9785e-5", "3.9785e-5", "3.5000e-7"]);
    let coarse = table("dl = 0.5\noverrun = true");
    assert_eq!((coarse.count, printed(coarse.points[62].x)), (62, "30.8667".to_owned()));
    assert_eq!(figures(&coarse)[0], "2.4780e-4");
}

#[test]
fn the_text_form_has_the_papers_rows() {
    let text = table("dl = 0.2\noverrun = true").to_text();
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    for (n, x, a, pa, er) in TABLE_1 {
        let line = text.lines().nth(n + 1).expect("a row");
        assert_eq!(words(line), [n.to_string(), printed(x), printed(a), printed(pa), printed(er)]);
    }
    let ends: Vec<Vec<String>> = text.lines().rev().take(3).map(words).collect();
    assert_eq!(ends, [["MaxErPAe", "0.00350"], ["MaxErPAo", "0.39785"], ["MaxErPA", "0.39785"]]);
}

#[test]
fn without_overrun_the_last_point_is_the_end() {
    let table = table("dl = 0.2");
    let last = table.points.last().expect("points");
    assert_eq!((last.x, last.er_pa_rad), (30.0, 0.0));
    assert!(table.to_csv().starts_with("n,X,Y,Z,A_rad,PA_rad,ErPA_rad,A_deg\n0,0"));
}
