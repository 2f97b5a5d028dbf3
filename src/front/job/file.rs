//! The keys of a job file, and the structs that its values go into.

use crate::tables::Key;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// The keys of a job file.
pub const KEYS: &[Key] = &[
    Key::value("name"),
    Key::value("number"),
    Key::value("tolerance"),
    Key::value("radius"),
    Key::tables(
        "curve",
        &[
            Key::value("kind"),
            Key::value("file"),
            Key::value("units"),
            Key::value("order"),
            Key::value("join"),
            Key::value("axes"),
            Key::value("at"),
            Key::value("degree"),
            Key::value("knots"),
            Key::value("points"),
            Key::value("weights"),
            Key::value("coefficients"),
            Key::value("range"),
            Key::value("u"),
            Key::value("constants"),
            Key::value("X"),
            Key::value("Y"),
            Key::value("Z"),
            Key::value("U"),
            Key::value("V"),
            Key::value("W"),
            Key::value("A"),
            Key::value("B"),
            Key::value("C"),
        ],
    ),
    Key::table(
        "process",
        &[
            Key::value("feed"),
            Key::table("retract", &[Key::value("axis"), Key::value("to")]),
            Key::value("spindle"),
            Key::value("coolant"),
            Key::value("tool"),
        ],
    ),
];

/// Curves and how to run along them.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// The program's name, 1 to 64 printable ASCII characters; each control has rules of its own. Default JOB.
    #[schemars(with = "Option<String>")]
    pub(super) name: Option<Spanned<String>>,
    /// The program's number, 1 to 9999, where the control wants one. Default 1, with a warning.
    #[schemars(with = "Option<i64>")]
    pub(super) number: Option<Spanned<i64>>,
    /// Greatest deviation from the curves, mm. Default: the machine's.
    #[schemars(with = "Option<f64>")]
    pub(super) tolerance: Option<Spanned<f64>>,
    /// The radius at which a rotary axis counts, mm. Default 180/π: a degree counts as a millimetre.
    #[schemars(with = "Option<f64>")]
    pub(super) radius: Option<Spanned<f64>>,
    /// The curves, in the order in which they are run.
    #[schemars(with = "Option<Vec<CurveTable>>")]
    pub(super) curve: Option<Vec<Spanned<CurveTable>>>,
    /// What the machine needs beside the path.
    #[schemars(with = "Option<ProcessTable>")]
    pub(super) process: Option<Spanned<ProcessTable>>,
}

/// One curve.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CurveTable {
    /// What the numbers mean; a curve file needs none.
    #[schemars(with = "Option<String>", extend("enum" = ["nurbs", "bezier", "polynomial", "points", "expression"]))]
    pub(super) kind: Option<Spanned<String>>,
    /// Instead of `kind`: a DXF, IGES or STEP file with curves; its path, from where this file stands.
    #[schemars(with = "Option<String>")]
    pub(super) file: Option<Spanned<String>>,
    /// The unit of that file, where it does not say. Default: what it says.
    #[schemars(with = "Option<String>", extend("enum" = ["mm", "cm", "m", "inch"]))]
    pub(super) units: Option<Spanned<String>>,
    /// Whether the curves of that file are run as they stand in it, or each next to the one that it meets. Default file.
    #[schemars(with = "Option<String>", extend("enum" = ["file", "chain"]))]
    pub(super) order: Option<Spanned<String>>,
    /// Gaps between the curves of that file up to this, mm, are closed by a straight line. Default none.
    #[schemars(with = "Option<f64>")]
    pub(super) join: Option<Spanned<f64>>,
    /// The coordinates of a point, in order: X Y Z U V W in mm, A B C in degrees. Default of a curve file: X Y Z, or X Y where
    /// all of it has z = 0.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) axes: Option<Spanned<Vec<Spanned<String>>>>,
    /// Where other axes stand on this curve. Default: where the curve before left them.
    #[schemars(with = "Option<BTreeMap<String, f64>>")]
    pub(super) at: Option<Spanned<BTreeMap<String, Spanned<f64>>>>,
    /// Degree, 1 to 5; of Bezier curves by default one less than there are points.
    #[schemars(with = "Option<i64>")]
    pub(super) degree: Option<Spanned<i64>>,
    /// Knots of a NURBS, as many as points + degree + 1, never falling.
    #[schemars(with = "Option<Vec<f64>>")]
    pub(super) knots: Option<Spanned<Vec<Spanned<f64>>>>,
    /// Control points, or the points of a run.
    #[schemars(with = "Option<Vec<Vec<f64>>>")]
    pub(super) points: Option<Spanned<Vec<Spanned<Vec<f64>>>>>,
    /// A weight for each control point, greater than zero. Default: all 1.
    #[schemars(with = "Option<Vec<f64>>")]
    pub(super) weights: Option<Spanned<Vec<Spanned<f64>>>>,
    /// For each axis the coefficients of 1, u, u² and so on.
    #[schemars(with = "Option<Vec<Vec<f64>>>")]
    pub(super) coefficients: Option<Spanned<Vec<Spanned<Vec<f64>>>>>,
    /// From where to where u runs. Default [0, 1].
    #[schemars(with = "Option<Vec<f64>>")]
    pub(super) range: Option<Spanned<Vec<Spanned<f64>>>>,
    /// From where to where u of an expression runs: numbers, or expressions of constants.
    #[schemars(with = "Option<Vec<Bound>>")]
    pub(super) u: Option<Spanned<Vec<Spanned<Bound>>>>,
    /// Numbers that expressions name.
    #[schemars(with = "Option<BTreeMap<String, f64>>")]
    pub(super) constants: Option<Spanned<BTreeMap<String, Spanned<f64>>>>,
    /// X of an expression, mm, in u.
    #[serde(rename = "X")]
    #[schemars(with = "Option<String>")]
    pub(super) x: Option<Spanned<String>>,
    /// Y of an expression, mm, in u.
    #[serde(rename = "Y")]
    #[schemars(with = "Option<String>")]
    pub(super) y: Option<Spanned<String>>,
    /// Z of an expression, mm, in u.
    #[serde(rename = "Z")]
    #[schemars(with = "Option<String>")]
    pub(super) z: Option<Spanned<String>>,
    /// U of an expression, mm, in u.
    #[serde(rename = "U")]
    #[schemars(with = "Option<String>")]
    pub(super) u_axis: Option<Spanned<String>>,
    /// V of an expression, mm, in u.
    #[serde(rename = "V")]
    #[schemars(with = "Option<String>")]
    pub(super) v: Option<Spanned<String>>,
    /// W of an expression, mm, in u.
    #[serde(rename = "W")]
    #[schemars(with = "Option<String>")]
    pub(super) w: Option<Spanned<String>>,
    /// A of an expression, degrees, in u.
    #[serde(rename = "A")]
    #[schemars(with = "Option<String>")]
    pub(super) a: Option<Spanned<String>>,
    /// B of an expression, degrees, in u.
    #[serde(rename = "B")]
    #[schemars(with = "Option<String>")]
    pub(super) b: Option<Spanned<String>>,
    /// C of an expression, degrees, in u.
    #[serde(rename = "C")]
    #[schemars(with = "Option<String>")]
    pub(super) c: Option<Spanned<String>>,
}

/// An end of a range: a number, or an expression of constants.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum Bound {
    /// A number.
    Number(f64),
    /// An expression.
    Text(String),
}

impl CurveTable {
    /// The expressions of all axes.
    pub(super) fn expressions(&self) -> [(&'static str, &Option<Spanned<String>>); 9] {
        [
            ("X", &self.x),
            ("Y", &self.y),
            ("Z", &self.z),
            ("U", &self.u_axis),
            ("V", &self.v),
            ("W", &self.w),
            ("A", &self.a),
            ("B", &self.b),
            ("C", &self.c),
        ]
    }
}

/// What the machine needs beside the path. A program needs feed and retract.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ProcessTable {
    /// mm/min along the path of the linear axes.
    #[schemars(with = "Option<f64>")]
    pub(super) feed: Option<Spanned<f64>>,
    /// Where it is clear, reached before the first curve, after the last, and between curves that do not meet.
    #[schemars(with = "Option<RetractTable>")]
    pub(super) retract: Option<Spanned<RetractTable>>,
    /// rev/min; without it no spindle word is written.
    #[schemars(with = "Option<f64>")]
    pub(super) spindle: Option<Spanned<f64>>,
    /// Whether the coolant flows. Default false.
    pub(super) coolant: Option<bool>,
    /// The tool's number. Default 1.
    #[schemars(with = "Option<i64>")]
    pub(super) tool: Option<Spanned<i64>>,
}

/// A position in clear air.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RetractTable {
    /// A linear axis.
    #[schemars(with = "Option<String>")]
    pub(super) axis: Option<Spanned<String>>,
    /// Absolute position, mm.
    #[schemars(with = "Option<f64>")]
    pub(super) to: Option<Spanned<f64>>,
}

/// The JSON Schema of a job file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(File)
}
