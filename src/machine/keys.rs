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
    Key::table("axes", &[Key::value("linear"), Key::value("rotary"), Key::value("cutter")]),
    Key::each(
        "axis",
        &[
            Key::value("kind"),
            Key::value("min"),
            Key::value("max"),
            Key::value("max_speed"),
            Key::value("max_acceleration"),
            Key::value("max_step"),
            Key::value("home"),
            Key::value("digits"),
            Key::value("sign"),
            Key::value("moves"),
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
            Key::value("leading_zero"),
            Key::value("without_point"),
            Key::value("spaces"),
            Key::value("number_start"),
            Key::value("number_step"),
            Key::value("number_comments"),
            Key::value("line_end"),
            Key::value("comment_length"),
            Key::value("comment_signs"),
            Key::value("comment_lower"),
            Key::value("extension"),
        ],
    ),
    Key::table(
        "feed",
        &[Key::value("rotary"), Key::value("error"), Key::value("parameter"), Key::value("block_time")],
    ),
    Key::table("parameter", &[Key::value("first"), Key::value("last")]),
    Key::table(
        "spline",
        &[
            Key::value("axes"),
            Key::value("poly_degree"),
            Key::value("poly_words"),
            Key::value("shared_parameter"),
            Key::value("bspline_min_blocks"),
            Key::value("first_point"),
            Key::value("begin"),
            Key::value("end"),
        ],
    ),
    Key::table("arcs", &[Key::value("planes")]),
    Key::table(
        "orientation",
        &[
            Key::value("digits"),
            Key::value("tolerance"),
            Key::value("turn"),
            Key::value("second_curve"),
            Key::value("length"),
            Key::value("arcs"),
            Key::value("safe_height"),
            Key::value("plane_order"),
            Key::value("plane_approach"),
        ],
    ),
    Key::table(
        "program",
        &[
            Key::value("header"),
            Key::value("setup"),
            Key::value("start"),
            Key::value("home"),
            Key::value("tool"),
            Key::value("spindle"),
            Key::value("tool_spindle"),
            Key::value("coolant"),
            Key::value("coolant_stop"),
            Key::value("spindle_stop"),
            Key::value("stop"),
            Key::value("optional_stop"),
            Key::value("dwell"),
            Key::value("tip_control"),
            Key::value("tip_control_end"),
            Key::value("length_end"),
            Key::value("length_end_moves"),
            Key::value("plane"),
            Key::value("plane_end"),
            Key::value("shift"),
            Key::value("unwind"),
            Key::value("footer"),
            Key::value("subprograms"),
            Key::value("call"),
            Key::value("begin"),
            Key::value("end"),
            Key::value("close"),
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
    #[schemars(with = "Option<BTreeMap<String, AxisFile>>")]
    pub(super) axis: Option<BTreeMap<Spanned<String>, AxisFile>>,
    /// Decimals.
    pub(super) digits: Option<DigitsFile>,
    /// Spelling.
    pub(super) text: Option<TextFile>,
    /// What F means.
    pub(super) feed: Option<FeedFile>,
    /// Which parameters a program may use.
    pub(super) parameter: Option<ParameterFile>,
    /// What its splines take.
    pub(super) spline: Option<SplineFile>,
    /// What arcs take.
    pub(super) arcs: Option<ArcsFile>,
    /// How the direction of the tool is stated in five axes.
    pub(super) orientation: Option<OrientationFile>,
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
    /// Which of them are X, Y, Z and A of a cutter, in this order. Default X, Y, Z, A.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) cutter: Option<Spanned<Vec<Spanned<String>>>>,
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
    /// Greatest acceleration at feed, mm/s² or degrees/s².
    #[schemars(with = "Option<f64>")]
    pub(super) max_acceleration: Option<Spanned<f64>>,
    /// Greatest step in speed at the joint of two blocks, mm/min or degrees/min.
    #[schemars(with = "Option<f64>")]
    pub(super) max_step: Option<Spanned<f64>>,
    /// Where it is clear in machine coordinates, mm: before the tool change and at the end. Without it no program goes there.
    #[schemars(with = "Option<f64>")]
    pub(super) home: Option<Spanned<f64>>,
    /// Decimals of this axis, instead of those of its kind.
    #[schemars(with = "Option<u8>")]
    pub(super) digits: Option<Spanned<u8>>,
    /// 1 (default), or -1 where the control counts the other way.
    #[schemars(with = "Option<i64>", extend("enum" = [1, -1]))]
    pub(super) sign: Option<Spanned<i64>>,
    /// What moves with it: wheel (default) or work. It changes no number: programs say how the wheel moves relative to the work.
    #[schemars(with = "Option<String>", extend("enum" = ["wheel", "work"]))]
    pub(super) moves: Option<Spanned<String>>,
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
    /// X0.5 instead of X.5.
    pub(super) leading_zero: Option<bool>,
    /// What 1 without a point is, mm or degrees, where a control may count least increments: 1.0 or 0.001. Without it a number
    /// that has no point is not read there.
    #[schemars(with = "Option<f64>")]
    pub(super) without_point: Option<Spanned<f64>>,
    /// G1 X30 F200 instead of G1X30F200.
    pub(super) spaces: Option<bool>,
    /// The first block number.
    #[schemars(with = "Option<u32>")]
    pub(super) number_start: Option<Spanned<u32>>,
    /// What it grows by; 0 for no numbers.
    #[schemars(with = "Option<u32>")]
    pub(super) number_step: Option<Spanned<u32>>,
    /// Whether comments have block numbers too.
    pub(super) number_comments: Option<bool>,
    /// lf or crlf.
    #[schemars(with = "Option<String>", extend("enum" = ["lf", "crlf"]))]
    pub(super) line_end: Option<Spanned<String>>,
    /// The most characters of a comment, 20 to 500; longer ones go on in another.
    #[schemars(with = "Option<usize>")]
    pub(super) comment_length: Option<Spanned<usize>>,
    /// The signs that a comment may have beside capitals, digits and blanks; others are written with these, or become blanks.
    #[schemars(with = "Option<String>")]
    pub(super) comment_signs: Option<Spanned<String>>,
    /// Whether comments may have small letters.
    pub(super) comment_lower: Option<bool>,
    /// The usual extension of a program file.
    pub(super) extension: Option<String>,
}

/// What F means.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct FeedFile {
    /// What F counts of rotary axes beside linear ones. free: nothing; degrees-as-mm: a degree as a mm; surface: mm at the cutter's surface; inverse-time: lines have their time.
    #[schemars(with = "Option<String>", extend("enum" = ["free", "degrees-as-mm", "surface", "inverse-time"]))]
    pub(super) rotary: Option<Spanned<String>>,
    /// How far the speed may be from the one asked for inside a block, as a share; beyond it paths are cut into more blocks.
    #[schemars(with = "Option<f64>")]
    pub(super) error: Option<Spanned<f64>>,
    /// Whether feeds are parameters, set at the head of the program.
    pub(super) parameter: Option<bool>,
    /// How long the control takes to make a block ready, ms.
    #[schemars(with = "Option<f64>")]
    pub(super) block_time: Option<Spanned<f64>>,
}

/// Which parameters a program may use: R of Sinumerik, Q of Heidenhain, # of Mazak.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ParameterFile {
    /// The first.
    #[schemars(with = "Option<u32>")]
    pub(super) first: Option<Spanned<u32>>,
    /// The last.
    #[schemars(with = "Option<u32>")]
    pub(super) last: Option<Spanned<u32>>,
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
    /// The most numbers of a polynomial block: the ends and coefficients of its axes and those of its denominator together.
    #[schemars(with = "Option<usize>")]
    pub(super) poly_words: Option<Spanned<usize>>,
    /// Whether all axes of a spline block follow one parameter; on Sinumerik, whether there is UPATH.
    pub(super) shared_parameter: Option<bool>,
    /// The fewest blocks of a B-spline.
    #[schemars(with = "Option<usize>")]
    pub(super) bspline_min_blocks: Option<Spanned<usize>>,
    /// Whether the first control point of a B-spline is that of the block before, "g1", or stands in a block of its own too,
    /// "repeat".
    #[schemars(with = "Option<String>")]
    pub(super) first_point: Option<Spanned<String>>,
    /// Start condition of splines through points: BAUTO, BNAT, BTAN.
    #[schemars(with = "Option<String>")]
    pub(super) begin: Option<Spanned<String>>,
    /// End condition: EAUTO, ENAT, ETAN.
    #[schemars(with = "Option<String>")]
    pub(super) end: Option<Spanned<String>>,
}

/// What arcs take.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ArcsFile {
    /// Whether arcs may choose another plane than X Y, by G18 and G19: only where the length of the tool stays along Z there.
    #[schemars(with = "Option<bool>")]
    pub(super) planes: Option<Spanned<bool>>,
}

/// How the direction of the tool is stated in five axes, and how the control turns it.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct OrientationFile {
    /// Decimals of a component of the direction, at most 9.
    #[schemars(with = "Option<u8>")]
    pub(super) digits: Option<Spanned<u8>>,
    /// How far the direction may be from the one that was asked for, degrees.
    #[schemars(with = "Option<f64>")]
    pub(super) tolerance: Option<Spanned<f64>>,
    /// How the control turns the tool between two directions. great-circle: in the plane of both; tilt: the rotary axes go evenly, C about Z and a tilt against Z.
    #[schemars(with = "Option<String>", extend("enum" = ["great-circle", "tilt"]))]
    pub(super) turn: Option<Spanned<String>>,
    /// Whether spline blocks take a second curve of a point of the tool: XH YH ZH of Sinumerik.
    #[schemars(with = "Option<bool>")]
    pub(super) second_curve: Option<Spanned<bool>>,
    /// How far that point is from the tip where the input does not say, mm.
    #[schemars(with = "Option<f64>")]
    pub(super) length: Option<Spanned<f64>>,
    /// Whether arcs are written as arcs while the tip is led, where the tool keeps its direction.
    #[schemars(with = "Option<bool>")]
    pub(super) arcs: Option<Spanned<bool>>,
    /// The height of the tip at which the tool may turn before it goes to the work, mm. Without it the greatest Z of the program.
    #[schemars(with = "Option<f64>")]
    pub(super) safe_height: Option<Spanned<f64>>,
    /// About which axes the angles of a tilted plane turn, each about the axes as turned so far: xyz, zyx, zxz and so on.
    #[schemars(with = "Option<String>", regex(pattern = "^[xyz]{3}$"))]
    pub(super) plane_order: Option<Spanned<String>>,
    /// How the tool comes from its home to a tilted plane. over: X and Y of the plane first, then Z, for a table that tilts; together: X, Y and Z at once, for a head that tilts.
    #[schemars(with = "Option<String>", extend("enum" = ["over", "together"]))]
    pub(super) plane_approach: Option<Spanned<String>>,
}

/// The lines round a program. {name}, {tool}, {register} and {rpm} are filled in.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ProgramFile {
    /// Before the first step; {name}, {number}, and {linear}: the linear axes, separated by commas; {axes}: every axis of the machine at zero, a line with {i} once for each.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) header: Option<Vec<Spanned<String>>>,
    /// Whether comments behind the header say what to set up.
    pub(super) setup: Option<bool>,
    /// Behind the first retraction, or behind the header where nothing retracts: what may turn axes, as the end of a plane that is left over.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) start: Option<Vec<Spanned<String>>>,
    /// The retraction in machine coordinates before a tool change and at the end; {home}: the axis and its home, or one axis as it stands.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) home: Option<Vec<Spanned<String>>>,
    /// A tool call; {tool}, and {register} where its length may be that of another register than the number of the tool.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) tool: Option<Vec<Spanned<String>>>,
    /// The spindle's start; {rpm}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) spindle: Option<Vec<Spanned<String>>>,
    /// Tool and spindle in one, where a control wants them so; {tool}, {register}, {rpm}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) tool_spindle: Option<Vec<Spanned<String>>>,
    /// The coolant's start.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) coolant: Option<Vec<Spanned<String>>>,
    /// The coolant's end, between moves.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) coolant_stop: Option<Vec<Spanned<String>>>,
    /// The spindle's stop, between moves.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) spindle_stop: Option<Vec<Spanned<String>>>,
    /// A stop of the program until the operator goes on.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) stop: Option<Vec<Spanned<String>>>,
    /// A stop where the operator asked for it.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) optional_stop: Option<Vec<Spanned<String>>>,
    /// A dwell of {seconds}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) dwell: Option<Vec<Spanned<String>>>,
    /// What leads the tip of the tool in five axes; {tool}, {register}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) tip_control: Option<Vec<Spanned<String>>>,
    /// What ends that; a line with {home} stands for Z, X and Y, each with its home, before the others.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) tip_control_end: Option<Vec<Spanned<String>>>,
    /// What ends the length of a tool: at the end, where Z is at home and X and Y at theirs, and nowhere else.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) length_end: Option<Vec<Spanned<String>>>,
    /// Whether that may move an axis by the length.
    pub(super) length_end_moves: Option<bool>,
    /// What tilts the plane in which positions count and turns the tool square to it; {first}, {second}, {third}: the angles in the order of plane_order, in one line; {tool}, {register}. Without it the tip of a tilted tool is led.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) plane: Option<Vec<Spanned<String>>>,
    /// What ends that.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) plane_end: Option<Vec<Spanned<String>>>,
    /// A work offset; {words}: the axis words. A line with {i} stands once for each axis, {i} counting from 1.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) shift: Option<Vec<Spanned<String>>>,
    /// Behind lines that went round on an axis that wraps, in steps: counts it below 360 degrees again; {axis}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) unwind: Option<Vec<Spanned<String>>>,
    /// After the last step; {name}, {axes}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) footer: Option<Vec<Spanned<String>>>,
    /// Whether sections that are alike but for a work offset are written once and called.
    pub(super) subprograms: Option<bool>,
    /// The call of a subprogram; {label}.
    #[schemars(with = "Option<String>")]
    pub(super) call: Option<Spanned<String>>,
    /// The first line of a subprogram; {label}. Subprograms stand behind the footer.
    #[schemars(with = "Option<String>")]
    pub(super) begin: Option<Spanned<String>>,
    /// The last line of a subprogram; {label}.
    #[schemars(with = "Option<String>")]
    pub(super) end: Option<Spanned<String>>,
    /// The last lines of the text, behind subprograms; {name}.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) close: Option<Vec<Spanned<String>>>,
}

/// The JSON Schema of a machine file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(File)
}
