//! DXF, the ASCII form: what a drawing holds in its section ENTITIES. `grammar/dxf.ebnf` has the form.
//!
//! A file is pairs of lines, a group code and a value; a pair with code 0 begins an entity, and what follows belongs to it:
//!
//! ```text
//!   0
//! SPLINE
//!  70          flags: 1 closed, 2 periodic, 4 rational, 8 planar
//!      12
//!  71          degree
//!       3
//!  72          number of knots, 73 of control points, 74 of fit points
//!      10
//!  40          a knot; 41 a weight; 10, 20, 30 a control point
//! 0.0
//! ```
//!
//! (Autodesk, *DXF Reference*, R2018.) SPLINE, LINE and ELLIPSE stand in the coordinates of the drawing; ARC, CIRCLE,
//! LWPOLYLINE and the plane POLYLINE in those of their normal (codes 210, 220, 230), whose axes follow from it by the
//! arbitrary axis algorithm.
//!
//! `$INSUNITS` says how long a unit is. Where it says nothing, `$MEASUREMENT` 1 is taken for millimetres; its 0 says
//! no more than that hatches are English, so that the job has to say what a unit is.
//!
//! Colour, line type, width and thickness shape no path. Layers do not choose: what stands on several is told of.

mod entities;
mod tags;

use super::{LeftOut, MOST_ERRORS, Read, Unit};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceId, Span};
use entities::Polyline;
use std::collections::BTreeMap;
use tags::{Group, Groups};

/// `$INSUNITS`: the length of a unit, mm.
const UNITS: &[(&str, f64)] = &[
    ("1", 25.4),
    ("2", 304.8),
    ("3", 1_609_344.0),
    ("4", 1.0),
    ("5", 10.0),
    ("6", 1000.0),
    ("7", 1.0e6),
    ("8", 25.4e-6),
    ("9", 25.4e-3),
    ("10", 914.4),
    ("11", 1.0e-7),
    ("12", 1.0e-6),
    ("13", 1.0e-3),
    ("14", 100.0),
    ("15", 1.0e4),
    ("16", 1.0e5),
];

/// Reads a file.
pub(super) fn read(text: &str, id: SourceId) -> Result<Read, Diagnostics> {
    let mut reader = Reader {
        read: Read {
            curves: Vec::new(),
            unit: Unit::Unknown("this drawing does not say its units".to_owned(), None),
            left_out: LeftOut::default(),
            warnings: Diagnostics::new(),
        },
        errors: Diagnostics::new(),
        section: "",
        entities: false,
        open: None,
        layers: BTreeMap::new(),
    };
    let mut groups = Groups::new(text, id);
    let mut ended = false;
    while let Some(group) = groups.next()? {
        if group.name == "EOF" {
            ended = true;
            break;
        }
        // What the last entity lacks is not its own fault then.
        if groups.is_over() {
            break;
        }
        if let Err(error) = reader.group(&group) {
            reader.errors.push(error);
            if MOST_ERRORS <= reader.errors.0.len() {
                break;
            }
        }
    }
    if !ended && reader.errors.0.len() < MOST_ERRORS {
        let end = Span::new(id, text.trim_end().len()..text.trim_end().len());
        let message = "the file ends before its EOF: a part of it is missing";
        reader.errors.push(Diagnostic::error("file-truncated", message).at(end, ""));
    }
    if !reader.entities && reader.errors.0.is_empty() {
        let first = Span::new(id, 0..0);
        let message = "this drawing has no section ENTITIES";
        reader.errors.push(Diagnostic::error("entities-missing", message).at(first, ""));
    }
    reader.errors.into_result()?;
    let mut read = reader.read;
    if 1 < reader.layers.len() {
        let names: Vec<String> =
            reader.layers.iter().map(|(name, (count, _))| format!("{name} ({count})")).collect();
        let message = format!("curves of {} layers are run alike: {}", names.len(), names.join(", "));
        let mut warning = Diagnostic::warning("layers-alike", message);
        if let Some((_, span)) = reader.layers.values().min_by_key(|(_, span)| span.start) {
            warning = warning.at(*span, "");
        }
        read.warnings.push(warning.hint("where some of them are no path, export the layer that is one"));
    }
    Ok(read)
}

struct Reader<'t> {
    read: Read,
    errors: Diagnostics,
    section: &'t str,
    /// Whether there was a section ENTITIES.
    entities: bool,
    /// A POLYLINE whose vertices follow.
    open: Option<Polyline>,
    /// How many curves each layer has, and where the first stands.
    layers: BTreeMap<&'t str, (usize, Span)>,
}

impl<'t> Reader<'t> {
    fn group(&mut self, group: &Group<'t>) -> Result<(), Diagnostic> {
        match group.name {
            "SECTION" => {
                self.section = group.text(2).unwrap_or_default();
                self.entities |= self.section == "ENTITIES";
                if self.section == "HEADER" {
                    self.header(group);
                }
            }
            "ENDSEC" => {
                self.section = "";
                return self.polyline_ended();
            }
            _ if self.section == "ENTITIES" => return self.entity(group),
            _ => {}
        }
        Ok(())
    }

    /// The variables of the header: each is a pair 9 with its name, and pairs with its value.
    fn header(&mut self, group: &Group<'t>) {
        let value = |name: &str| {
            let at = group.tags.iter().position(|tag| tag.code == 9 && tag.value == name)?;
            group.tags.get(at + 1).filter(|tag| tag.code == 70)
        };
        let units = value("$INSUNITS").filter(|tag| tag.value != "0");
        let measurement = value("$MEASUREMENT");
        self.read.unit = match (units, measurement) {
            (Some(tag), _) => match UNITS.iter().find(|(code, _)| *code == tag.value) {
                Some((_, mm)) => Unit::Stated(*mm),
                None => {
                    let message = format!("$INSUNITS is {}, which is no unit that is known", tag.value);
                    Unit::Unknown(message, Some(tag.span))
                }
            },
            (None, Some(tag)) if tag.value == "1" => Unit::Stated(1.0),
            (None, Some(tag)) => {
                let message =
                    "this drawing has no $INSUNITS; $MEASUREMENT alone does not say what its unit is";
                Unit::Unknown(message.to_owned(), Some(tag.span))
            }
            (None, None) => return,
        };
    }

    fn entity(&mut self, group: &Group<'t>) -> Result<(), Diagnostic> {
        if group.name == "VERTEX" {
            return match &mut self.open {
                Some(polyline) => polyline.vertex(group),
                None => Err(group.error("vertex-alone", "VERTEX outside a POLYLINE")),
            };
        }
        if group.name == "SEQEND" {
            // Attributes of an INSERT end like this too.
            if let Some(polyline) = self.open.take() {
                self.read.curves.extend(polyline.curves());
            }
            return Ok(());
        }
        self.polyline_ended()?;
        let hidden = if group.whole(67)? == Some(1) {
            Some("in paper space")
        } else if group.whole(60)? == Some(1) {
            Some("that is invisible")
        } else {
            None
        };
        if let Some(hidden) = hidden {
            self.read.left_out.add(&format!("{} {hidden}", group.name), group.head);
            if group.name == "POLYLINE" {
                self.open = Some(Polyline::ignored(group));
            }
            return Ok(());
        }
        match group.name {
            "LINE" => self.read.curves.push(entities::line(group)?),
            "ARC" | "CIRCLE" => self.read.curves.push(entities::circle(group)?),
            "ELLIPSE" => self.read.curves.push(entities::ellipse(group)?),
            "SPLINE" => self.read.curves.push(entities::spline(group)?),
            "LWPOLYLINE" => self.read.curves.extend(entities::light_polyline(group)?),
            "POLYLINE" => match Polyline::new(group)? {
                Some(polyline) => self.open = Some(polyline),
                None => {
                    self.read.left_out.add("POLYLINE that is a mesh", group.head);
                    self.open = Some(Polyline::ignored(group));
                    return Ok(());
                }
            },
            "HELIX" => {
                let message = "HELIX is a curve that is not read";
                return Err(group.error("curve-unread", message).hint("explode it to a SPLINE"));
            }
            "INSERT" => {
                self.read.left_out.add("INSERT, and with it the curves of its block,", group.head);
                return Ok(());
            }
            other => {
                self.read.left_out.add(other, group.head);
                return Ok(());
            }
        }
        let layer = group.text(8).unwrap_or("0");
        self.layers.entry(layer).or_insert((0, group.head)).0 += 1;
        Ok(())
    }

    /// Something else follows a POLYLINE: its SEQEND is missing.
    fn polyline_ended(&mut self) -> Result<(), Diagnostic> {
        match self.open.take() {
            Some(polyline) => Err(polyline.unfinished()),
            None => Ok(()),
        }
    }
}
