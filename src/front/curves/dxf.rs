//! DXF, the ASCII form: what a drawing holds in its section ENTITIES, and in the blocks that are inserted there. `grammar/dxf.ebnf` has the form.
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

mod blocks;
mod entities;
mod tags;

use super::{MOST_ERRORS, Read, Unit};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceId, Span};
use blocks::{Block, Insert, Item, Whole, key};
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
        unit: Unit::Unknown("this drawing does not say its units".to_owned(), None),
        section: "",
        entities: false,
        open: None,
        items: Vec::new(),
        blocks: BTreeMap::new(),
        block: None,
    };
    let mut groups = Groups::new(text, id);
    let mut ended = false;
    let mut wrong = 0;
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
            // Of a block it counts where the block is inserted.
            wrong += usize::from(reader.block.is_none());
            reader.target().push(Item::Wrong(error));
            if MOST_ERRORS <= wrong {
                break;
            }
        }
    }
    let Reader { unit, entities, items, blocks, .. } = reader;
    let whole = Whole::of(&items, &blocks);
    let mut errors = Diagnostics(whole.errors);
    if !ended && wrong < MOST_ERRORS {
        let end = Span::new(id, text.trim_end().len()..text.trim_end().len());
        let message = "the file ends before its EOF: a part of it is missing";
        errors.push(Diagnostic::error("file-truncated", message).at(end, ""));
    }
    if !entities && errors.0.is_empty() {
        let first = Span::new(id, 0..0);
        let message = "this drawing has no section ENTITIES";
        errors.push(Diagnostic::error("entities-missing", message).at(first, ""));
    }
    errors.0.truncate(MOST_ERRORS);
    let mut warnings = errors.into_result()?;
    if 1 < whole.layers.len() {
        let names: Vec<String> =
            whole.layers.iter().map(|(name, (count, _))| format!("{name} ({count})")).collect();
        let message = format!("curves of {} layers are run alike: {}", names.len(), names.join(", "));
        let mut warning = Diagnostic::warning("layers-alike", message);
        if let Some((_, span)) = whole.layers.values().min_by_key(|(_, span)| span.start) {
            warning = warning.at(*span, "");
        }
        warnings.push(warning.hint("where some of them are no path, export the layer that is one"));
    }
    Ok(Read { curves: whole.curves, unit, left_out: whole.left_out, warnings })
}

struct Reader<'t> {
    unit: Unit,
    section: &'t str,
    /// Whether there was a section ENTITIES.
    entities: bool,
    /// A POLYLINE whose vertices follow, and its layer.
    open: Option<(Polyline, &'t str)>,
    /// What stands in the section ENTITIES.
    items: Vec<Item<'t>>,
    /// The blocks by [`key`].
    blocks: BTreeMap<String, Block<'t>>,
    /// The block that is open.
    block: Option<Block<'t>>,
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
                let ended = self.polyline_ended();
                self.section = "";
                self.block_ended();
                return ended;
            }
            "BLOCK" if self.section == "BLOCKS" => {
                let ended = self.polyline_ended();
                self.block_ended();
                self.block = Some(Block::new(group));
                return ended;
            }
            "ENDBLK" => {
                let ended = self.polyline_ended();
                if let Err(error) = ended {
                    self.target().push(Item::Wrong(error));
                }
                self.block_ended();
            }
            _ if self.section == "ENTITIES" || self.block.is_some() => return self.entity(group),
            _ => {}
        }
        Ok(())
    }

    /// Where items go to: the block that is open, or the drawing.
    fn target(&mut self) -> &mut Vec<Item<'t>> {
        match &mut self.block {
            Some(block) => &mut block.items,
            None => &mut self.items,
        }
    }

    fn block_ended(&mut self) {
        if let Some(mut block) = self.block.take() {
            if let Some(twin) = self.blocks.get_mut(&key(block.name)) {
                // Which of them an INSERT means nobody can say.
                let message = format!("the block `{}` is there twice", block.name);
                twin.items.push(Item::Wrong(Diagnostic::error("block-twice", message).at(block.span, "")));
                return;
            }
            block.items.shrink_to_fit();
            self.blocks.insert(key(block.name), block);
        }
    }

    /// The variables of the header: each is a pair 9 with its name, and pairs with its value.
    fn header(&mut self, group: &Group<'t>) {
        let value = |name: &str| {
            let at = group.tags.iter().position(|tag| tag.code == 9 && tag.value == name)?;
            group.tags.get(at + 1).filter(|tag| tag.code == 70)
        };
        let units = value("$INSUNITS").filter(|tag| tag.value != "0");
        let measurement = value("$MEASUREMENT");
        self.unit = match (units, measurement) {
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
                Some((polyline, _)) => polyline.vertex(group),
                None => Err(group.error("vertex-alone", "VERTEX outside a POLYLINE")),
            };
        }
        if group.name == "SEQEND" {
            // Attributes of an INSERT end like this too.
            if let Some((polyline, layer)) = self.open.take() {
                self.target().push(Item::Curves(polyline.curves(), layer));
            }
            return Ok(());
        }
        self.polyline_ended()?;
        let layer = group.text(8).unwrap_or("0");
        let hidden = if group.whole(67)? == Some(1) {
            Some("in paper space")
        } else if group.whole(60)? == Some(1) {
            Some("that is invisible")
        } else {
            None
        };
        if let Some(hidden) = hidden {
            self.target().push(Item::LeftOut(format!("{} {hidden}", group.name), group.head));
            if group.name == "POLYLINE" {
                self.open = Some((Polyline::ignored(group), layer));
            }
            return Ok(());
        }
        let item = match group.name {
            "LINE" => Item::Curves(vec![entities::line(group)?], layer),
            "ARC" | "CIRCLE" => Item::Curves(vec![entities::circle(group)?], layer),
            "ELLIPSE" => Item::Curves(vec![entities::ellipse(group)?], layer),
            "SPLINE" => Item::Curves(vec![entities::spline(group)?], layer),
            "LWPOLYLINE" => Item::Curves(entities::light_polyline(group)?, layer),
            "POLYLINE" => {
                let polyline = Polyline::new(group)?;
                let mesh = polyline.is_none();
                self.open = Some((polyline.unwrap_or_else(|| Polyline::ignored(group)), layer));
                if !mesh {
                    return Ok(());
                }
                Item::LeftOut("POLYLINE that is a mesh".to_owned(), group.head)
            }
            "HELIX" => {
                let message = "HELIX is a curve that is not read";
                return Err(group.error("curve-unread", message).hint("explode it to a SPLINE"));
            }
            "INSERT" => Item::Insert(Insert::new(group)?),
            other => Item::LeftOut(other.to_owned(), group.head),
        };
        self.target().push(item);
        Ok(())
    }

    /// Something else follows a POLYLINE: its SEQEND is missing.
    fn polyline_ended(&mut self) -> Result<(), Diagnostic> {
        match self.open.take() {
            Some((polyline, _)) => Err(polyline.unfinished()),
            None => Ok(()),
        }
    }
}
