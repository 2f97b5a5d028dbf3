//! Where the time of a compilation goes, and the most memory that it takes: the stages of `splinepost::compile`, one by one.

use splinepost::ir::Intent;
use splinepost::machine::Machine;
use splinepost::source::{SourceId, Sources};
use splinepost::{Options, compile, front, pass, setup, verify};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Each stage is timed so often, and its fastest time taken.
const ROUNDS: usize = 5;

/// Bytes in a megabyte.
const MEGABYTE: f64 = 1.0e6;

/// The time that this thread has spent on a processor, where the system tells: others share the machine. Elsewhere the time
/// of day.
enum Clock {
    Processor(u64),
    Wall(Instant),
}

impl Clock {
    fn now() -> Clock {
        match processor() {
            Some(nanoseconds) => Clock::Processor(nanoseconds),
            None => Clock::Wall(Instant::now()),
        }
    }

    fn elapsed(&self) -> Duration {
        match self {
            Clock::Processor(start) => Duration::from_nanos(processor().unwrap_or(*start) - start),
            Clock::Wall(start) => start.elapsed(),
        }
    }
}

/// Nanoseconds on a processor so far.
fn processor() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_ascii_whitespace().next()?.parse().ok()
}

/// The fastest times of the stages, by name, in the order in which they run.
struct Times(Vec<(&'static str, Duration)>);

impl Times {
    fn stage<T>(&mut self, name: &'static str, run: impl FnOnce() -> T) -> T {
        let start = Clock::now();
        let value = black_box(run());
        let took = start.elapsed();
        match self.0.iter_mut().find(|(known, _)| *known == name) {
            Some((_, fastest)) => *fastest = took.min(*fastest),
            None => self.0.push((name, took)),
        }
        value
    }
}

/// Prints time, speed and share of each stage for CL data, and peak memory.
#[allow(clippy::print_stdout, reason = "the table is what this benchmark is for")]
pub(crate) fn report(sources: &Sources, name: &str) {
    let machine = Machine::built_in(name).unwrap_or_else(|| panic!("no machine {name}"));
    let size = sources.get(SourceId::INPUT).map_or(0, |source| source.text.len()) as f64;
    let mut times = Times(Vec::new());
    for _ in 0..ROUNDS {
        stages(sources, &machine, &mut times);
    }
    let whole: Duration = times.0.iter().map(|(_, took)| *took).sum();
    println!(
        "cl-data/{name}: {:.1} MB of input, fastest of {ROUNDS}, processor time of one thread",
        size / MEGABYTE
    );
    for (stage, took) in times.0.iter().chain([&("all", whole)]) {
        println!(
            "  {stage:<12} {:7.1} ms {:8.0} MB/s {:5.1} %",
            took.as_secs_f64() * 1.0e3,
            size / MEGABYTE / took.as_secs_f64(),
            100.0 * took.as_secs_f64() / whole.as_secs_f64(),
        );
    }
    let before = forget_peak();
    let language = front::find("apt").unwrap_or_else(|| panic!("no CL data"));
    let output = compile(sources, language, &machine, &Options::default());
    match (before, memory("VmHWM:")) {
        // The input was in memory before.
        (Some(before), Some(peak)) => {
            let taken = (peak - before).max(0.0) + size;
            println!("  peak memory  {:7.1} MB, {:.1} times the input", taken / MEGABYTE, taken / size);
        }
        _ => println!("  peak memory  is not known on this system"),
    }
    drop(output);
}

/// The stages of `compile`, for lines.
fn stages(sources: &Sources, machine: &Machine, times: &mut Times) {
    let told = |diagnostics: splinepost::diagnostic::Diagnostics| -> ! { panic!("{diagnostics:?}") };
    let language = times.stage("detect", || front::detect(sources.get(SourceId::INPUT).expect("an input")));
    let language = language.unwrap_or_else(|error| told(error));
    let intent: Intent =
        times.stage("parse", || (language.parse)(sources)).unwrap_or_else(|error| told(error));
    let machine = machine.with_axes(&intent.program.axes).unwrap_or_else(|error| told(error));
    let motion = machine.dialect.motion("linear").expect("lines");
    let (tolerance, form) = (machine.tolerance, motion.form);
    let intent = times.stage("settle", || {
        let intent = pass::place::place(intent, &machine).unwrap_or_else(|error| told(error));
        pass::settle::settle(intent, form, false, tolerance).unwrap_or_else(|error| told(error))
    });
    let program = times.stage("convert", || {
        let program = pass::interpolate::interpolate(&intent, form, &machine, (tolerance, tolerance), true)
            .unwrap_or_else(|error| told(error));
        pass::convert::convert(program, form, &machine, false).unwrap_or_else(|error| told(error))
    });
    let legal = times.stage("quantise", || {
        pass::quantise::quantise(program, form, &machine, tolerance, intent.radius())
            .unwrap_or_else(|error| told(error))
    });
    let legal = times.stage("check", || {
        let mut decimals = legal;
        decimals.setup = setup::Setup::new(&intent, &decimals, &machine).remarks(&machine);
        pass::check::check(decimals, &machine).unwrap_or_else(|error| told(error)).value
    });
    let text = times.stage("write", || (machine.dialect.write)(&legal, &machine));
    drop(legal);
    let reading = times
        .stage("read", || (machine.dialect.read)(&text, SourceId::PROGRAM, &machine))
        .unwrap_or_else(|error| told(error));
    let proof = times.stage("verify", || {
        verify::verify(&intent, &reading.value, &text, SourceId::PROGRAM, &machine, tolerance)
    });
    drop(proof.unwrap_or_else(|error| told(error)));
}

/// A figure of this process in bytes, where the system tells.
fn memory(name: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? * 1024.0)
}

/// Lets the system count the peak anew, and gives what is in use now.
fn forget_peak() -> Option<f64> {
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    memory("VmRSS:")
}
