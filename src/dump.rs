//! Programs as text, to be looked at: one step a line, numbers in full precision.

use crate::geom::arc::Arc;
use crate::ir::{
    ArcBy, Auxiliary, Circle, Curve, Cut, Decimals, Described, Intent, Method, Polyline, Role, Shift, Step,
    Units, Written,
};
use crate::units::{Axes, Position};
use std::fmt::{Display, Write as _};

/// The plane of an arc: its name, or the axis that it is square to.
fn plane(arc: &Arc) -> String {
    match arc.plane() {
        Some(plane) => format!("{plane:?}"),
        None => format!("about {:?}", arc.frame().axes()[2]),
    }
}

/// The centre of an arc: in its plane, or in X Y Z where that is tilted.
fn center(arc: &Arc) -> Vec<f64> {
    if arc.plane().is_some() { arc.center().to_vec() } else { arc.middle().to_vec() }
}

/// What was asked.
pub fn intent(intent: &Intent) -> String {
    let program = &intent.program;
    let axes = program.axes;
    let mut text = head(&program.name, axes);
    if let Some((tolerance, _)) = intent.tolerance {
        let _ = writeln!(text, "tolerance {tolerance}");
    }
    for located in &program.steps {
        step(&mut text, &axes, &located.step, |text, curve| match curve {
            Curve::Lines(line) => points(text, &axes, "lines", line),
            Curve::Arc(arc) => {
                let _ = writeln!(
                    text,
                    "arc {} {:?} from {} to {} about {:?} radius {}{}",
                    plane(arc),
                    arc.sense(),
                    position(&axes, &arc.start()),
                    position(&axes, &arc.end()),
                    center(arc),
                    arc.radius(),
                    if arc.turns() <= 1.0 { String::new() } else { format!(" turns {}", arc.turns()) }
                );
            }
            Curve::Through(kind, line) => points(text, &axes, &format!("through {kind:?}"), line),
            Curve::Polynomial(pieces) => {
                let _ = writeln!(text, "polynomial");
                for piece in pieces {
                    let _ = writeln!(text, "  piece of degree {}", piece.degree);
                    for (point, weight) in piece.control_points().iter().zip(piece.weights) {
                        let weight =
                            if piece.is_polynomial() { String::new() } else { format!(" weight {weight}") };
                        let _ = writeln!(text, "    {}{weight}", position(&axes, point));
                    }
                }
            }
            Curve::Nurbs(nurbs) => {
                let _ = writeln!(text, "nurbs of degree {}, knots {:?}", nurbs.degree(), nurbs.knots());
                for (point, weight) in nurbs.points().iter().zip(nurbs.weights()) {
                    let _ = writeln!(text, "    {} weight {weight}", position(&axes, point));
                }
            }
            Curve::Formula(Described { formula, bound, .. }) => {
                let (from, to) = formula.range();
                let _ = writeln!(text, "formula, u from {from} to {to}");
                for ((axis, _), expression) in axes.as_slice().iter().zip(formula.axes()) {
                    let _ = writeln!(text, "    {axis} = {}", expression.text());
                }
                let _ = writeln!(text, "  pieces stand for it within {}", position(&axes, bound));
            }
            Curve::Logarithmic(log) => {
                let method = match log.method {
                    Method::Auto => "auto",
                    Method::OddEven => "odd-even",
                    Method::Direct => "direct",
                };
                let c = log.curve.cutter();
                let dl = log.dl.map_or("auto".to_owned(), |dl| dl.to_string());
                let _ = writeln!(
                    text,
                    "logarithmic D1 {} S {} C {} r {} length {} {:?} {:?} index {} shift {} {} from {} to {} method {method} dl {dl} overrun {} back {} along {:?}",
                    c.d1,
                    c.s,
                    c.c,
                    c.r,
                    c.length,
                    c.hand,
                    c.law,
                    log.curve.index,
                    log.curve.shift[0],
                    log.curve.shift[1],
                    log.curve.start(),
                    log.curve.end(),
                    log.overrun,
                    log.back,
                    log.along
                );
            }
        });
    }
    text
}

/// What a control reads.
pub fn decimals(decimals: &Decimals) -> String {
    let program = &decimals.program;
    let axes = program.axes;
    let at = |units: &Units| position(&axes, &decimals.position(units));
    let mut text = head(&program.name, axes);
    for located in &program.steps {
        step(&mut text, &axes, &located.step, |text, curve| match curve {
            Written::Lines(line) | Written::Through(_, line) => {
                let kind = match curve {
                    Written::Through(kind, _) => format!("through {kind:?}"),
                    Written::Lines(_) | Written::Arc(_) | Written::Polynomial(_) | Written::Nurbs(_) => {
                        "lines".to_owned()
                    }
                };
                let _ = writeln!(text, "{kind} from {}", at(&line.start));
                for point in line.points() {
                    let _ = writeln!(text, "    {}", at(&point));
                }
            }
            Written::Arc(arc) => {
                let kind = |circle: Circle| format!("{:?} {:?} ", circle.plane, circle.sense);
                let about = |circle: Circle| format!("about {:?}", circle.place(&decimals.digits));
                let (kind, by) = match arc.by {
                    ArcBy::Center(circle, 0) => (kind(circle), about(circle)),
                    ArcBy::Center(circle, turns) => {
                        (kind(circle), format!("{} after {turns} turns", about(circle)))
                    }
                    ArcBy::Way(place) => (String::new(), format!("by {}", at(&place))),
                    ArcBy::Turn(circle, degrees) => {
                        (kind(circle), format!("{} by {degrees} degrees", about(circle)))
                    }
                };
                let (from, to) = (at(&arc.start), at(&arc.end));
                let _ = writeln!(text, "arc {kind}from {from} to {to} {by}");
            }
            Written::Polynomial(polynomial) => {
                let _ = writeln!(text, "polynomial from {}", at(&polynomial.start));
                for block in &polynomial.blocks {
                    let _ = writeln!(text, "  to {} over {}", at(&block.end), block.pl);
                    if let Some(denominator) = &block.denominator {
                        let [d2, d3, d4, d5] = denominator.coefficients;
                        let _ = writeln!(text, "    divided by {} {d2} {d3} {d4} {d5}", denominator.end);
                    }
                    for (i, (axis, _)) in axes.as_slice().iter().enumerate() {
                        let [a2, a3, a4, a5] = block.coefficients[i];
                        let _ = writeln!(text, "    {axis} {a2} {a3} {a4} {a5}");
                    }
                }
            }
            Written::Nurbs(nurbs) => {
                let knots: Vec<f64> =
                    nurbs.knots.iter().map(|t| crate::decimal::units_to_f64(*t, nurbs.knot_digits)).collect();
                let _ = writeln!(text, "nurbs of degree {}, knots {knots:?}", nurbs.degree);
                for (i, point) in nurbs.points.iter().enumerate() {
                    let weight =
                        nurbs.weights.as_ref().map_or(String::new(), |w| format!(" weight {}", w[i]));
                    let _ = writeln!(text, "    {}{weight}", at(point));
                }
            }
        });
    }
    text
}

fn head(name: &str, axes: Axes) -> String {
    let names: Vec<&str> = axes.as_slice().iter().map(|(axis, _)| axis.as_str()).collect();
    format!("program {name}\naxes {}\n", names.join(" "))
}

fn step<N: Display, C>(text: &mut String, axes: &Axes, step: &Step<N, C>, curve: impl Fn(&mut String, &C)) {
    // Writing to a String cannot fail.
    let _ = match step {
        Step::Comment(comment) => writeln!(text, "comment {comment}"),
        Step::Tool(call) => writeln!(text, "{call}"),
        Step::Spindle(rpm) => writeln!(text, "spindle {rpm}"),
        Step::Coolant => writeln!(text, "coolant"),
        Step::Auxiliary(auxiliary) => match auxiliary {
            Auxiliary::CoolantStop => writeln!(text, "coolant stops"),
            Auxiliary::SpindleStop => writeln!(text, "spindle stops"),
            Auxiliary::Stop => writeln!(text, "stop"),
            Auxiliary::OptionalStop => writeln!(text, "optional stop"),
            Auxiliary::Dwell(seconds) => writeln!(text, "dwell {seconds}"),
            Auxiliary::TipControl => writeln!(text, "tip control"),
            Auxiliary::TipControlEnd => writeln!(text, "tip control ends"),
            Auxiliary::LengthEnd => writeln!(text, "tool length ends"),
            Auxiliary::Plane([first, second, third]) => writeln!(text, "plane {first} {second} {third}"),
            Auxiliary::PlaneEnd => writeln!(text, "plane ends"),
        },
        Step::Home(axis) => writeln!(text, "home {}", axes.name(*axis)),
        Step::Shift(shifts) => {
            let word = |Shift { axis, to, parameter }: &Shift<N>| {
                format!(" {} {to}{}", axes.name(*axis), if *parameter { " parameter" } else { "" })
            };
            writeln!(text, "shift{}", shifts.iter().map(word).collect::<String>())
        }
        Step::Rapid(targets) => {
            let words: Vec<String> =
                targets.iter().map(|(axis, to)| format!("{} {to}", axes.name(*axis))).collect();
            writeln!(text, "rapid {}", words.join(" "))
        }
        Step::Cut(Cut { feed, role, curve: shape }) => {
            let role = match role {
                Role::Path => "cut",
                Role::Approach => "approach",
                Role::AsAsked => "cut as asked",
            };
            let feed = feed.as_ref().map_or("none".to_owned(), ToString::to_string);
            let _ = write!(text, "{role} feed {feed} ");
            curve(text, shape);
            Ok(())
        }
    };
}

fn points(text: &mut String, axes: &Axes, kind: &str, line: &Polyline) {
    let _ = writeln!(text, "{kind} from {}", position(axes, &line.start));
    for point in line.points() {
        let _ = writeln!(text, "    {}", position(axes, &point));
    }
}

fn position(axes: &Axes, point: &Position) -> String {
    let mut buffer = zmij::Buffer::new();
    let words: Vec<String> = axes
        .as_slice()
        .iter()
        .enumerate()
        .map(|(i, (axis, _))| format!("{axis} {}", buffer.format(point[i] + 0.0)))
        .collect();
    words.join(" ")
}
