//! Benchmarks: `cargo bench`, or `cargo bench -- NAME` for one of them.
//!
//! The machine is shared and noisy: compare ratios.

mod stages;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use splinepost::geom::bezier::Bezier;
use splinepost::geom::fit;
use splinepost::geom::logcurve::{Cutter, Hand, Law, LogCurve};
use splinepost::geom::oddeven::OddEven;
use splinepost::geom::smooth::{CORNER, Fitting, parts};
use splinepost::machine::Machine;
use splinepost::simulate::partition;
use splinepost::simulate::partition::{Cycles, Method, Piece, Weights};
use splinepost::simulate::shape::{Shape, Way};
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, compile, front};
use std::hint::black_box;

const PAPER: Cutter =
    Cutter { d1: 10.0, s: 30.0, c: 5.0, r: 8.0, length: 30.0, hand: Hand::Right, law: Law::ConstantHelix };

fn curve(cutter: Cutter) -> LogCurve {
    LogCurve::new(cutter, 0.0).unwrap_or_else(|error| panic!("{error}"))
}

/// Points a second: aim 20 million.
fn odd_even(c: &mut Criterion) {
    let long = curve(Cutter { length: 200.0, ..PAPER });
    let steps = || OddEven::new(long, 0.001, false).unwrap_or_else(|error| panic!("{error}"));
    let count = steps().count();
    let mut group = c.benchmark_group("odd-even");
    group.throughput(Throughput::Elements(count as u64));
    group.bench_function("points", |b| b.iter(|| steps().fold(0.0, |sum, (x, a)| sum + x + black_box(a))));
    group.finish();
}

/// A cutter's direct fit, at tolerances from easy to hard.
fn direct(c: &mut Criterion) {
    let mut group = c.benchmark_group("direct");
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let curve = curve(Cutter { length: 200.0, ..PAPER });
        group.bench_function(format!("along-itself/{tolerance:e}"), |b| {
            b.iter(|| fit::along_itself(black_box(&curve), tolerance));
        });
        group.bench_function(format!("quintic/{tolerance:e}"), |b| {
            b.iter(|| fit::linear_in_x(black_box(&curve), 5, tolerance));
        });
    }
    group.finish();
}

fn sources(length: f64, flutes: usize, dl: f64) -> Sources {
    let text = format!(
        "name = \"BENCH\"\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = {length}\nflutes = {flutes}\n\
         [interpolation]\ndl = {dl}\n[process]\nfeed = 200\nretract = {{ axis = \"Z\", to = 50 }}\n"
    );
    Sources::new(Source::new("bench", text))
}

fn text(sources: &Sources, machine: &str, motion: Option<&str>) -> String {
    let machine = Machine::built_in(machine).unwrap_or_else(|| panic!("no machine {machine}"));
    let options = Options { motion: motion.and_then(|m| machine.dialect.motion(m)), ..Options::default() };
    match compile(sources, &front::LANGUAGES[0], &machine, &options) {
        Ok(output) => output.text,
        Err(failure) => panic!("{:?}", failure.diagnostics),
    }
}

/// The whole way for the paper's cutter.
fn whole(c: &mut Criterion) {
    let mut group = c.benchmark_group("compile");
    let sources = sources(30.0, 4, 0.2);
    for (machine, motion) in
        [("sinumerik", "poly"), ("sinumerik", "bspline"), ("sinumerik", "linear"), ("heidenhain", "spl")]
    {
        group.bench_function(format!("{machine}/{motion}"), |b| {
            b.iter(|| text(black_box(&sources), machine, Some(motion)));
        });
    }
    group.finish();
}

/// A million points as lines, written and proved: aim 100 MB/s of text.
fn million(c: &mut Criterion) {
    let mut group = c.benchmark_group("million");
    group.sample_size(10);
    let sources = sources(200.0, 50, 0.01);
    for machine in ["sinumerik", "heidenhain", "mazak"] {
        let size = text(&sources, machine, Some("linear")).len();
        group.throughput(Throughput::Bytes(size as u64));
        group.bench_function(machine, |b| b.iter(|| text(black_box(&sources), machine, Some("linear"))));
    }
    let sinumerik = Machine::built_in("sinumerik").unwrap_or_else(|| panic!("no machine"));
    let program = text(&sources, "sinumerik", Some("linear"));
    group.throughput(Throughput::Bytes(program.len() as u64));
    group.bench_function("sinumerik/read", |b| {
        b.iter(|| (sinumerik.dialect.read)(black_box(&program), SourceId::PROGRAM, &sinumerik).is_ok());
    });
    group.finish();
}

/// A million points as a CAM system writes them, about 40 MB.
fn cl_data() -> Sources {
    use std::fmt::Write as _;
    let mut text = String::from(
        "PARTNO MILLION\nUNITS/MM\nLOADTL/1\nSPINDL/RPM,9000,CLW\nRAPID\nGOTO/0.0,0.0,50.0\nFEDRAT/400.0,MMPM\n",
    );
    for i in 0..1_000_000u32 {
        let t = f64::from(i);
        // A zigzag over a wavy surface, with six decimals as CAM systems print them.
        let (x, y, z) = ((t * 0.137) % 200.0, t * 2.0e-4, -5.0 + ((t * 0.011) % 7.0) * 0.3);
        let _ = writeln!(text, "GOTO / {x:.6}, {y:.6}, {z:.6}");
    }
    text.push_str("FINI\n");
    Sources::new(Source::new("million.cl", text))
}

/// CL data of a million points: reading alone, the whole way with proof, and without it. Aim 100 MB/s of input.
fn points_of_cl_data(c: &mut Criterion) {
    let mut group = c.benchmark_group("cl-data");
    group.sample_size(10);
    let sources = cl_data();
    let size = sources.get(SourceId::INPUT).map_or(0, |source| source.text.len());
    group.throughput(Throughput::Bytes(size as u64));
    let Some(language) = front::find("apt") else { return };
    for name in ["sinumerik", "heidenhain", "mazak"] {
        stages::report(&sources, name);
    }
    group.bench_function("parse", |b| b.iter(|| (language.parse)(black_box(&sources)).is_ok()));
    for name in ["sinumerik", "heidenhain", "mazak"] {
        let machine = Machine::built_in(name).unwrap_or_else(|| panic!("no machine {name}"));
        for no_verify in [false, true] {
            let what = if no_verify { "written" } else { "proved" };
            let options = Options { no_verify, ..Options::default() };
            group.bench_function(format!("{name}/{what}"), |b| {
                b.iter(|| compile(black_box(&sources), language, &machine, &options).is_ok());
            });
        }
    }
    group.finish();
}

/// Control cycles a second at 6 m/min and 1 ms, to a feed error of 1e-8: aim two million.
fn cycles(c: &mut Criterion) {
    let at = |x: f64, y: f64| [x, y, 0.1 * x, 2.0 * y, 0.0, 0.0];
    let cubic = Bezier::new(&[at(0.0, 0.0), at(40.0, 90.0), at(110.0, -70.0), at(150.0, 20.0)]);
    let long = curve(Cutter { length: 200.0, ..PAPER });
    let shapes =
        [("cubic", Shape::bezier(&cubic)), ("logarithmic", Shape::Logarithmic(Box::new(long), Way::Forth))];
    let mut group = c.benchmark_group("cycles");
    for (name, shape) in shapes {
        let (from, to) = shape.range();
        let counts = Weights([1.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
        let pieces = [Piece { curve: shape, from, to, feed: 100.0, counts, surface: counts }];
        for (word, method) in
            [("secant", Method::Secant), ("bisection", Method::Bisection), ("taylor", Method::Taylor)]
        {
            let law = partition::Law { method, cycle: 1e-3, tolerance: 1e-8 };
            let run = || Cycles::new(black_box(&pieces), law);
            group.throughput(Throughput::Elements(run().count() as u64));
            group.bench_function(format!("{name}/{word}"), |b| {
                b.iter(|| run().fold(0.0, |sum, cycle| sum + cycle.feed_error + cycle.chord_error));
            });
        }
    }
    group.finish();
}

/// Runs of points as splines: from ten thousand points to a million, in points a second, which should stay level.
fn fit(c: &mut Criterion) {
    let mut group = c.benchmark_group("fit");
    group.sample_size(10);
    for count in [10_000usize, 100_000, 1_000_000] {
        let points: Vec<splinepost::units::Position> = (0..count)
            .map(|i| {
                let x = 0.05 * i as f64;
                let fine = splinepost::geom::elementary::sin(0.3 * x);
                [x, 5.0 * fine, 0.5 * fine * fine, 0.0, 0.0, 0.0]
            })
            .collect();
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(count.to_string(), |b| {
            b.iter(|| parts(black_box(&points), Fitting { tolerance: 0.01, corner: CORNER }).is_some());
        });
    }
    group.finish();
}

criterion_group!(benches, odd_even, direct, whole, million, points_of_cl_data, fit, cycles);
criterion_main!(benches);
