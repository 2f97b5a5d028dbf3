//! The keys of a machine file, and the structs that its values go into.

use crate::tables::Key;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// The keys of a machine file.
pub const KEYS: &[Key] = &[
    Key::value("extends"),
    Key::value("name"),
    Key::value("about"),
    Key::value("dialect"),
    Key::value("motion"),
    Key::value("tolerance"),
    Key::table("axes", &[Key::value("linear"), Key::value("rotary")]),
    Key::each(
        "axis",
        &[
            Key::value("kind"),
            Key::value("min"),
            Key::value("max"),
            Key::value("max_speed"),
            Key::value("max_acceleration"),
            Key::value("max_step"),
        ],
    ),
    Key::table(
        "digits",
        &[
            Key::value("linear"),
            Key::value("rotary"),
            Key::value("feed"),
            Key::value("knot"),
            Key::value("weight"),
        ],
    ),
    Key::table(
        "text",
        &[
            Key::value("point_always"),
            Key::value("sign_always"),
            Key::value("number_start"),
            Key::value("number_step"),
            Key::value("extension"),
        ],
    ),
    Key::table("feed", &[Key::value("rotary"), Key::value("block_time")]),
    Key::table(
        "spline",
        &[
            Key::value("axes"),
            Key::value("poly_degree"),
            Key::value("shared_parameter"),
            Key::value("bspline_min_blocks"),
            Key::value("begin"),
            Key::value("end"),
        ],
    ),
    Key::table(
        "program",
        &[
            Key::value("header"),
            Key::value("tool"),
            Key::value("spindle"),
            Key::value("tool_spindle"),
            Key::value("footer"),
        ],
    ),
];

/// One machine. Every key may be left out where `extends` names a built-in machine.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// The built-in machine that this one is but for what is stated here.
    #[schemars(with = "Option<String>")]
    pub(super) extends: Option<Spanned<String>>,
    /// Its name.
    pub(super) name: Option<String>,
    /// What it is, in one line.
    pub(super) about: Option<String>,
    /// How it is written to: sinumerik, heidenhain or mazak.
    #[schemars(with = "Option<String>")]
    pub(super) dialect: Option<Spanned<String>>,
    /// auto, or the motion for cutting pieces.
    #[schemars(with = "Option<String>")]
    pub(super) motion: Option<Spanned<String>>,
    /// mm, where neither the command line nor the input says.
    #[schemars(with = "Option<f64>")]
    pub(super) tolerance: Option<Spanned<f64>>,
    /// Its axes.
    pub(super) axes: Option<AxesFile>,
    /// What each axis can do, by its name.
    pub(super) axis: Option<BTreeMap<String, AxisFile>>,
    /// Decimals.
    pub(super) digits: Option<DigitsFile>,
    /// Spelling.
    pub(super) text: Option<TextFile>,
    /// What F means.
    pub(super) feed: Option<FeedFile>,
    /// What its splines take.
    pub(super) spline: Option<SplineFile>,
    /// The lines round a program.
    pub(super) program: Option<ProgramFile>,
}

/// Its axes, by name.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct AxesFile {
    /// Axes in mm.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) linear: Option<Spanned<Vec<Spanned<String>>>>,
    /// Axes in degrees.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) rotary: Option<Spanned<Vec<Spanned<String>>>>,
}

/// What one axis can do.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct AxisFile {
    /// linear (default): a rotary axis counts on past 360 degrees; modulo: it wraps there.
    #[schemars(with = "Option<String>", extend("enum" = ["linear", "modulo"]))]
    pub(super) kind: Option<Spanned<String>>,
    /// Least position, mm or degrees.
    #[schemars(with = "Option<f64>")]
    pub(super) min: Option<Spanned<f64>>,
    /// Greatest position, mm or degrees.
    #[schemars(with = "Option<f64>")]
    pub(super) max: Option<Spanned<f64>>,
    /// Greatest speed at feed, mm/min or degrees/min.
    #[schemars(with = "Option<f64>")]
    pub(super) max_speed: Option<Spanned<f64>>,
    /// Greatest acceleration, mm/s² or degrees/s².
    #[schemars(with = "Option<f64>")]
    pub(super) max_acceleration: Option<Spanned<f64>>,
    /// Greatest step in speed at the joint of two blocks, mm/min or degrees/min.
    #[schemars(with = "Option<f64>")]
    pub(super) max_step: Option<Spanned<f64>>,
}

/// How many decimals an address takes, at most 9.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct DigitsFile {
    /// Linear axes.
    #[schemars(with = "Option<u8>")]
    pub(super) linear: Option<Spanned<u8>>,
    /// Rotary axes.
    #[schemars(with = "Option<u8>")]
    pub(super) rotary: Option<Spanned<u8>>,
    /// Feed and spindle speed.
    #[schemars(with = "Option<u8>")]
    pub(super) feed: Option<Spanned<u8>>,
    /// PL of BSPLINE, K of G06.2.
    #[schemars(with = "Option<u8>")]
    pub(super) knot: Option<Spanned<u8>>,
    /// PW, R.
    #[schemars(with = "Option<u8>")]
    pub(super) weight: Option<Spanned<u8>>,
}

/// How text is spelled.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct TextFile {
    /// X30. instead of X30.
    pub(super) point_always: Option<bool>,
    /// X+30 instead of X30.
    pub(super) sign_always: Option<bool>,
    /// The first block number.
    pub(super) number_start: Option<u32>,
    /// What it grows by; 0 for no numbers.
    pub(super) number_step: Option<u32>,
    /// The usual extension of a program file.
    pub(super) extension: Option<String>,
}

/// What F means.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct FeedFile {
    /// free: F is the speed of the linear axes and rotary ones go along; degrees-as-mm: a degree counts as a mm.
    #[schemars(with = "Option<String>", extend("enum" = ["free", "degrees-as-mm"]))]
    pub(super) rotary: Option<Spanned<String>>,
    /// How long the control takes to make a block ready, ms.
    #[schemars(with = "Option<f64>")]
    pub(super) block_time: Option<Spanned<f64>>,
}

/// What splines the machine takes.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct SplineFile {
    /// The axes that spline blocks may move.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) axes: Option<Vec<Spanned<String>>>,
    /// Greatest degree of polynomial blocks, 3 to 5.
    #[schemars(with = "Option<usize>")]
    pub(super) poly_degree: Option<Spanned<usize>>,
    /// Whether all axes of a spline block follow one parameter; on Sinumerik, whether there is UPATH.
    pub(super) shared_parameter: Option<bool>,
    /// The fewest blocks of a B-spline.
    #[schemars(with = "Option<usize>")]
    pub(super) bspline_min_blocks: Option<Spanned<usize>>,
    /// Start condition of splines through points: BAUTO, BNAT, BTAN.
    #[schemars(with = "Option<String>")]
    pub(super) begin: Option<Spanned<String>>,
    /// End condition: EAUTO, ENAT, ETAN.
    #[schemars(with = "Option<String>")]
    pub(super) end: Option<Spanned<String>>,
}

/// The lines round a program. {name}, {tool} and {rpm} are filled in.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ProgramFile {
    /// Before the first step; {name}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) header: Option<Vec<Spanned<String>>>,
    /// A tool call; {tool}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) tool: Option<Vec<Spanned<String>>>,
    /// The spindle's start; {rpm}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) spindle: Option<Vec<Spanned<String>>>,
    /// Tool and spindle in one, where a control wants them so; {tool}, {rpm}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) tool_spindle: Option<Vec<Spanned<String>>>,
    /// After the last step; {name}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) footer: Option<Vec<Spanned<String>>>,
}

/// The JSON Schema of a machine file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(File)
}
