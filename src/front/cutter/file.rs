//! The keys of a cutter file, and the structs that its values go into.

use crate::tables::Key;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

/// The keys of a cutter file.
pub const KEYS: &[Key] = &[
    Key::value("name"),
    Key::value("number"),
    Key::table(
        "cutter",
        &[
            Key::value("D1"),
            Key::value("S"),
            Key::value("C"),
            Key::value("r"),
            Key::value("length"),
            Key::value("flutes"),
            Key::value("index"),
            Key::value("hand"),
            Key::value("law"),
        ],
    ),
    Key::table(
        "interpolation",
        &[
            Key::value("dl"),
            Key::value("Δl"),
            Key::value("method"),
            Key::value("overrun"),
            Key::value("tolerance"),
        ],
    ),
    Key::table(
        "process",
        &[
            Key::value("feed"),
            Key::value("feed_along"),
            Key::value("approach_feed"),
            Key::value("return_feed"),
            Key::table("retract", &[Key::value("axis"), Key::value("to")]),
            Key::value("spindle"),
            Key::value("coolant"),
            Key::value("tool"),
            Key::value("travel"),
            Key::value("run_in"),
            Key::value("run_out"),
            Key::table(
                "infeed",
                &[Key::value("axis"), Key::value("sign"), Key::value("step"), Key::value("passes")],
            ),
            Key::value("spark_out"),
            Key::value("order"),
            Key::table("correction", &[Key::value("axis"), Key::value("value")]),
        ],
    ),
];

/// A conical cutter and how to grind it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// The program's name, 1 to 64 printable ASCII characters; each control has rules of its own. Default CUTTER.
    #[schemars(with = "Option<String>")]
    pub(super) name: Option<Spanned<String>>,
    /// The program's number, 1 to 9999, where the control wants one. Default 1, with a warning.
    #[schemars(with = "Option<i64>")]
    pub(super) number: Option<Spanned<i64>>,
    /// The cutter as its drawing states it.
    #[schemars(with = "Option<CutterTable>")]
    pub(super) cutter: Option<Spanned<CutterTable>>,
    /// How its curve is followed.
    pub(super) interpolation: Option<InterpolationTable>,
    /// What the machine needs beside the path.
    #[schemars(with = "Option<ProcessTable>")]
    pub(super) process: Option<Spanned<ProcessTable>>,
}

/// The cutter as its drawing states it. Angles in degrees, lengths in mm.
#[derive(Deserialize, JsonSchema)]
#[allow(non_snake_case, reason = "the keys are the drawing's letters")]
#[serde(deny_unknown_fields)]
pub(super) struct CutterTable {
    /// End diameter, mm; ISO 13399 DC.
    #[schemars(with = "Option<f64>")]
    pub(super) D1: Option<Spanned<f64>>,
    /// Spiral angle in the axial sense, degrees; FHA.
    #[schemars(with = "Option<f64>")]
    pub(super) S: Option<Spanned<f64>>,
    /// Cone angle to the axis, degrees: the diameter grows by 2 tan C per mm; BHTA.
    #[schemars(with = "Option<f64>")]
    pub(super) C: Option<Spanned<f64>>,
    /// Rake, degrees; GAMF.
    #[schemars(with = "Option<f64>")]
    pub(super) r: Option<Spanned<f64>>,
    /// Travel along X, mm; APMX.
    #[schemars(with = "Option<f64>")]
    pub(super) length: Option<Spanned<f64>>,
    /// Number of flutes, A indexed by 360/flutes; NOF. Default 1.
    #[schemars(with = "Option<i64>")]
    pub(super) flutes: Option<Spanned<i64>>,
    /// The angle of each flute, degrees, instead of flutes.
    #[schemars(with = "Option<Vec<f64>>")]
    pub(super) index: Option<Spanned<Vec<Spanned<f64>>>>,
    /// Which way A turns: right (default) or left.
    #[schemars(with = "Option<String>", extend("enum" = ["right", "left"]))]
    pub(super) hand: Option<Spanned<String>>,
    /// constant-helix (default): A is logarithmic in X; constant-lead: A is linear in X.
    #[schemars(with = "Option<String>", extend("enum" = ["constant-helix", "constant-lead"]))]
    pub(super) law: Option<Spanned<String>>,
}

/// How the curve is followed.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct InterpolationTable {
    /// Instruction step of odd-even steps, in the mixed measure of mm and radians; also spelled Δl. Default: the largest up to 0.2 that holds the tolerance.
    #[serde(alias = "Δl")]
    #[schemars(with = "Option<f64>")]
    pub(super) dl: Option<Spanned<f64>>,
    /// auto (default): odd-even for lines along a curve, direct otherwise; odd-even; direct.
    #[schemars(with = "Option<String>", extend("enum" = ["auto", "odd-even", "direct"]))]
    pub(super) method: Option<Spanned<String>>,
    /// Whole cycles until X reaches or passes the end, as in the paper. Default false.
    pub(super) overrun: Option<bool>,
    /// Greatest deviation at the cutter's surface, mm. Default: the machine's.
    #[schemars(with = "Option<f64>")]
    pub(super) tolerance: Option<Spanned<f64>>,
}

/// What the machine needs beside the path. A program needs feed and retract.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ProcessTable {
    /// mm/min along what feed_along says; degrees/min along A.
    #[schemars(with = "Option<f64>")]
    pub(super) feed: Option<Spanned<f64>>,
    /// What feed is a speed of. path (default): X Y Z together; edge: the cutting edge at the surface; X; A: its degrees.
    #[schemars(with = "Option<String>", extend("enum" = ["path", "edge", "X", "A"]))]
    pub(super) feed_along: Option<Spanned<String>>,
    /// mm/min of the move to the work. Default: what feed makes along X Y Z where the path begins.
    #[schemars(with = "Option<f64>")]
    pub(super) approach_feed: Option<Spanned<f64>>,
    /// mm/min of the linear axes on their way back to the start of a path. Default: rapid traverse.
    #[schemars(with = "Option<f64>")]
    pub(super) return_feed: Option<Spanned<f64>>,
    /// Where it is clear, reached before X returns and before A turns; beyond all that is cut.
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
    /// from-D1 (default): X grows along a path; to-D1: it falls.
    #[schemars(with = "Option<String>", extend("enum" = ["from-D1", "to-D1"]))]
    pub(super) travel: Option<Spanned<String>>,
    /// How far a path begins before the flute, on the extended curve, mm along X. Default 0.
    #[schemars(with = "Option<f64>")]
    pub(super) run_in: Option<Spanned<f64>>,
    /// How far it goes on behind the flute, mm along X. Default 0.
    #[schemars(with = "Option<f64>")]
    pub(super) run_out: Option<Spanned<f64>>,
    /// Rough passes before the finishing one.
    #[schemars(with = "Option<InfeedTable>")]
    pub(super) infeed: Option<Spanned<InfeedTable>>,
    /// How often the finishing pass is made again. Default 0.
    #[schemars(with = "Option<i64>")]
    pub(super) spark_out: Option<Spanned<i64>>,
    /// flute (default): all passes of a flute, then the next; pass: a pass on all flutes, then the next.
    #[schemars(with = "Option<String>", extend("enum" = ["flute", "pass"]))]
    pub(super) order: Option<Spanned<String>>,
    /// A parameter of the program that shifts all paths, set to its value: zero, or clear of the work for an air cut.
    #[schemars(with = "Option<CorrectionTable>")]
    pub(super) correction: Option<Spanned<CorrectionTable>>,
}

/// A parameter that shifts all paths.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CorrectionTable {
    /// Y or Z.
    #[schemars(with = "Option<String>", extend("enum" = ["Y", "Z"]))]
    pub(super) axis: Option<Spanned<String>>,
    /// mm; default 0.
    #[schemars(with = "Option<f64>")]
    pub(super) value: Option<Spanned<f64>>,
}

/// Rough passes: the path shifted away from the finished one, step by step.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct InfeedTable {
    /// Y or Z.
    #[schemars(with = "Option<String>", extend("enum" = ["Y", "Z"]))]
    pub(super) axis: Option<Spanned<String>>,
    /// 1 (default) or -1: on which side of the finished path the stock is; a negative step says the same.
    #[schemars(with = "Option<i64>", extend("enum" = [1, -1]))]
    pub(super) sign: Option<Spanned<i64>>,
    /// mm from pass to pass.
    #[schemars(with = "Option<f64>")]
    pub(super) step: Option<Spanned<f64>>,
    /// How many rough passes.
    #[schemars(with = "Option<i64>")]
    pub(super) passes: Option<Spanned<i64>>,
}

/// A position in clear air.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RetractTable {
    /// Y or Z.
    #[schemars(with = "Option<String>", extend("enum" = ["Y", "Z"]))]
    pub(super) axis: Option<Spanned<String>>,
    /// Absolute position, mm.
    #[schemars(with = "Option<f64>")]
    pub(super) to: Option<Spanned<f64>>,
}

/// The JSON Schema of a cutter file.
pub fn schema() -> schemars::Schema {
    let mut schema = schemars::schema_for!(File);
    // The other spelling of dl.
    if let Some(properties) = schema.pointer_mut("/$defs/InterpolationTable/properties")
        && let Some(dl) = properties.get("dl").cloned()
    {
        properties["Δl"] = dl;
    }
    schema
}
