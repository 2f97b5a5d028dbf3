//! What is written reads back, and writes to the same text again.

use crate::support::{CUTTERS, compiled, input, machines};
use proptest::prelude::*;
use splinepost::machine::Machine;
use splinepost::pass::check::check;
use splinepost::source::SourceId;

fn writes_back(text: &str, machine: &Machine) -> String {
    let reading =
        (machine.dialect.read)(text, SourceId::PROGRAM, machine).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
    assert!(reading.value.header && reading.value.footer && reading.value.misnumbered.is_none(), "{text}");
    let legal = check(reading.value.decimals, machine).unwrap_or_else(|e| panic!("{e:?}"));
    (machine.dialect.write)(&legal.value, machine)
}

#[test]
fn every_cutter_in_every_motion() {
    for machine in machines() {
        for motion in machine.dialect.motions {
            for (name, cutter) in CUTTERS {
                for method in ["auto", "odd-even"] {
                    let input = input(cutter, &format!("method = \"{method}\""));
                    let output = compiled(&input, &machine, Some(motion))
                        .unwrap_or_else(|e| panic!("{name} {} {}: {e:?}", machine.name, motion.name));
                    // A direct fit meets within 0.1 degrees, in the decimals that are written.
                    let corners = output.warnings.0.iter().any(|d| d.id == "corner");
                    assert!(!corners || method == "odd-even", "{name} {} {}", machine.name, motion.name);
                    assert!(output.report.is_some());
                    assert_eq!(
                        writes_back(&output.text, &machine),
                        output.text,
                        "{name} {} {}",
                        machine.name,
                        motion.name
                    );
                }
            }
        }
    }
}

proptest! {
    // Each case compiles for every motion of every machine.
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn any_cutter_compiles_and_verifies(
        d1 in 0.3f64..80.0, s in -75.0f64..75.0, c in -8.0f64..40.0, r in -20.0f64..20.0, share in 0.1f64..4.0,
        flutes in 1usize..4, left in any::<bool>(), tolerance in 4e-4f64..0.05,
    ) {
        // The length stays where the taper leaves a third of the diameter.
        let shrink = if c < 0.0 { (-c).to_radians() * 3.2 } else { 0.0 };
        let length = (d1 * share).min(if shrink > 0.0 { d1 / shrink } else { f64::INFINITY });
        let hand = if left { "left" } else { "right" };
        let cutter = format!("D1 = {d1}\nS = {s}\nC = {c}\nr = {r}\nlength = {length}\nflutes = {flutes}\nhand = \"{hand}\"");
        let text = input(&cutter, &format!("tolerance = {tolerance}"));
        for machine in machines() {
            for motion in machine.dialect.motions {
                let output = compiled(&text, &machine, Some(motion)).unwrap_or_else(|e| panic!("{} {}: {e:?}\n{text}", machine.name, motion.name));
                prop_assert_eq!(writes_back(&output.text, &machine), output.text);
            }
        }
    }
}
