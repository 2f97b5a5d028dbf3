//! Blocks of a drawing and where they are inserted.
//!
//! A block has a base point B and curves; an INSERT puts it, scaled by S along its own axes, turned by ρ about its normal, to the
//! place I, and an array of it to I + d:
//!
//! ```text
//! p  →  I + N R(ρ) (S (p − B) + d)          d = (column · column distance, row · row distance, 0)
//! ```
//!
//! with the axes N of the normal (codes 210, 220, 230), in which I stands too. (Autodesk, *DXF Reference*, INSERT: codes 10 the
//! place, 41, 42, 43 the scales, 50 the angle in degrees, 70 and 71 columns and rows, 44 and 45 their distances, which the
//! scales do not change.) The map is affine: circles become ellipses where the scales differ, arcs run the other way where one
//! of them is negative, and nothing is lost. A block may insert others, whose maps go before its own.

use super::super::{FileCurve, LeftOut, Point};
use super::entities::Own;
use super::tags::Group;
use crate::diagnostic::Diagnostic;
use crate::geom::elementary::{cos, sin};
use crate::source::Span;
use crate::units::DEGREES;
use std::collections::BTreeMap;

/// The most blocks that a drawing inserts, each of an array counted.
const MOST: usize = 1_000_000;

/// What is said of more.
const TOO_MANY: &str = "blocks-too-many";

/// How deep blocks may stand in each other.
const DEEPEST: usize = 64;

/// What stands in a drawing or in a block.
pub(super) enum Item<'t> {
    /// The curves of an entity, and its layer.
    Curves(Vec<FileCurve>, &'t str),
    /// What is no curve, or none that counts.
    LeftOut(String, Span),
    /// A block.
    Insert(Insert<'t>),
    /// What is wrong, where it is part of the drawing.
    Wrong(Diagnostic),
}

/// A block.
pub(super) struct Block<'t> {
    /// As the file spells it.
    pub(super) name: &'t str,
    /// Where it stands.
    pub(super) span: Span,
    base: Point,
    /// Whether its curves stand in another file.
    external: bool,
    pub(super) items: Vec<Item<'t>>,
}

impl<'t> Block<'t> {
    /// A block of which nothing but its head was read; what is wrong with that counts where the block is inserted.
    pub(super) fn new(group: &Group<'t>) -> Block<'t> {
        let mut block = Block {
            name: group.text(2).unwrap_or_default(),
            span: group.head,
            base: [0.0; 3],
            external: false,
            items: Vec::new(),
        };
        let mut head = || -> Result<(), Diagnostic> {
            block.external = group.whole(70)?.unwrap_or(0) & (4 | 8) != 0;
            for (own, code) in block.base.iter_mut().zip([10, 20, 30]) {
                *own = group.float(code)?.unwrap_or(0.0);
            }
            Ok(())
        };
        if let Err(error) = head() {
            block.items.push(Item::Wrong(error));
        }
        block
    }
}

/// How a drawing knows a block: small and capital letters are one.
pub(super) fn key(name: &str) -> String {
    name.to_lowercase()
}

/// A block that is inserted.
pub(super) struct Insert<'t> {
    name: &'t str,
    layer: Option<&'t str>,
    span: Span,
    place: Point,
    scale: Point,
    /// cos ρ and sin ρ.
    turned: [f64; 2],
    own: Own,
    columns: usize,
    rows: usize,
    distances: [f64; 2],
}

impl<'t> Insert<'t> {
    pub(super) fn new(group: &Group<'t>) -> Result<Insert<'t>, Diagnostic> {
        let or = |code, otherwise| group.float(code).map(|x| x.unwrap_or(otherwise));
        let scale = [or(41, 1.0)?, or(42, 1.0)?, or(43, 1.0)?];
        if scale.contains(&0.0) {
            return Err(
                group.error("scale-zero", "INSERT has the scale 0, which leaves nothing of its block")
            );
        }
        let distances = [or(44, 0.0)?, or(45, 0.0)?];
        let count = |code, distance: f64| -> Result<usize, Diagnostic> {
            let stated = group.whole(code)?.unwrap_or(1).max(1);
            // Copies on each other are one.
            if distance == 0.0 { Ok(1) } else { Ok(usize::try_from(stated).unwrap_or(MOST)) }
        };
        let (columns, rows) = (count(70, distances[0])?, count(71, distances[1])?);
        if columns.checked_mul(rows).is_none_or(|all| MOST < all) {
            return Err(group.error(TOO_MANY, "INSERT makes more than a million blocks"));
        }
        let angle = or(50, 0.0)?;
        // Quarter turns are exact.
        let turned = match angle.rem_euclid(360.0) {
            0.0 => [1.0, 0.0],
            90.0 => [0.0, 1.0],
            180.0 => [-1.0, 0.0],
            270.0 => [0.0, -1.0],
            other => [cos(other / DEGREES), sin(other / DEGREES)],
        };
        Ok(Insert {
            name: group.text(2).unwrap_or_default(),
            layer: group.text(8).filter(|layer| *layer != "0"),
            span: group.head,
            place: group.point(10, "place")?,
            scale,
            turned,
            own: Own::of(group)?,
            columns,
            rows,
            distances,
        })
    }

    /// Where a place of the block comes to, in one of the array.
    fn map(&self, base: &Point, (column, row): (usize, usize), p: &Point) -> Point {
        let [x, y, z]: Point = std::array::from_fn(|i| self.scale[i] * (p[i] - base[i]));
        let (x, y) = (x + column as f64 * self.distances[0], y + row as f64 * self.distances[1]);
        let [c, s] = self.turned;
        let [a, b, h] = self.place;
        self.own.vector([a + c * x - s * y, b + s * x + c * y, h + z])
    }
}

/// All that a drawing holds, blocks where they are inserted.
pub(super) struct Whole<'b, 't> {
    pub(super) blocks: &'b BTreeMap<String, Block<'t>>,
    pub(super) curves: Vec<FileCurve>,
    /// How many entities with curves each layer has, and where the first stands.
    pub(super) layers: BTreeMap<&'t str, (usize, Span)>,
    pub(super) left_out: LeftOut,
    pub(super) errors: Vec<Diagnostic>,
    /// How many blocks were inserted.
    count: usize,
}

/// The maps of the blocks that an item stands in, the outermost first.
struct Placement<'p> {
    within: Option<&'p Placement<'p>>,
    name: String,
    depth: usize,
    map: &'p dyn Fn(&Point) -> Point,
}

impl Placement<'_> {
    fn holds(&self, name: &str) -> bool {
        self.name == name || self.within.is_some_and(|outer| outer.holds(name))
    }

    fn apply(&self, p: &Point) -> Point {
        let own = (self.map)(p);
        self.within.map_or(own, |outer| outer.apply(&own))
    }
}

impl<'b, 't> Whole<'b, 't> {
    /// The items of a drawing in its blocks.
    pub(super) fn of(items: &'b [Item<'t>], blocks: &'b BTreeMap<String, Block<'t>>) -> Whole<'b, 't> {
        let mut whole = Whole {
            blocks,
            curves: Vec::new(),
            layers: BTreeMap::new(),
            left_out: LeftOut::default(),
            errors: Vec::new(),
            count: 0,
        };
        whole.add(items, None, "0");
        whole
    }

    /// Adds items under the maps of the blocks that they stand in. What stands on layer 0 of a block is on that of its insert.
    fn add(&mut self, items: &'b [Item<'t>], within: Option<&Placement<'_>>, outer: &'t str) {
        for item in items {
            match item {
                Item::Curves(curves, layer) => {
                    for (i, curve) in curves.iter().enumerate() {
                        let mut curve = curve.clone();
                        if let Some(placement) = within {
                            curve.path = curve.path.mapped(&|p: &Point| placement.apply(p));
                        }
                        if i == 0 {
                            let layer = if within.is_some() && *layer == "0" { outer } else { layer };
                            self.layers.entry(layer).or_insert((0, curve.span)).0 += 1;
                        }
                        self.curves.push(curve);
                    }
                }
                Item::LeftOut(what, span) => self.left_out.add(what, *span),
                Item::Wrong(error) => self.wrong(error.clone()),
                Item::Insert(insert) => self.insert(insert, within, outer),
            }
            if MOST < self.count.max(self.curves.len()) {
                return;
            }
        }
    }

    /// An error is told once, however often its block is inserted; that there is too much, once at all.
    fn wrong(&mut self, error: Diagnostic) {
        let known = |own: &Diagnostic| *own == error || own.id == TOO_MANY && error.id == TOO_MANY;
        if !self.errors.iter().any(known) {
            self.errors.push(error);
        }
    }

    fn insert(&mut self, insert: &'b Insert<'t>, within: Option<&Placement<'_>>, outer: &'t str) {
        let fail = |id, message: String| Diagnostic::error(id, message).at(insert.span, "");
        let name = key(insert.name);
        let Some(block) = self.blocks.get(&name) else {
            let message = format!("INSERT names the block `{}`, which this file does not have", insert.name);
            self.wrong(
                fail("block-unknown", message).hint("explode the block in the CAD system, and export again"),
            );
            return;
        };
        if block.external {
            let message = format!("the block `{}` stands in another drawing", insert.name);
            self.wrong(
                fail("block-external", message)
                    .hint("bind the external reference in the CAD system, and export again"),
            );
            return;
        }
        if within.is_some_and(|placement| placement.holds(&name)) {
            let message = format!("the block `{}` inserts itself", insert.name);
            self.wrong(
                fail("block-circular", message).hint("explode the block in the CAD system, and export again"),
            );
            return;
        }
        let depth = within.map_or(1, |placement| placement.depth + 1);
        if DEEPEST < depth {
            let message = format!("blocks stand in each other more than {DEEPEST} deep");
            self.wrong(fail(TOO_MANY, message).hint("explode them in the CAD system, and export again"));
            return;
        }
        if block.items.is_empty() {
            self.left_out.add("INSERT of a block without entities", insert.span);
        }
        let layer = insert.layer.unwrap_or(outer);
        for (row, column) in
            (0..insert.rows).flat_map(|row| (0..insert.columns).map(move |column| (row, column)))
        {
            self.count += 1;
            let map = |p: &Point| insert.map(&block.base, (column, row), p);
            let placement = Placement { within, name: name.clone(), depth, map: &map };
            self.add(&block.items, Some(&placement), layer);
            if MOST < self.count.max(self.curves.len()) {
                self.wrong(fail(
                    TOO_MANY,
                    "the blocks of this drawing make more than a million curves".to_owned(),
                ));
                return;
            }
        }
    }
}
