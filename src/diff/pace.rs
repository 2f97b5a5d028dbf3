//! F along two paths that meet.
//!
//! Joints of one path need not be those of the other to the last micrometre, so that on some way between two blocks the one has the
//! next F already. That is no difference; another F in a block of that length is one. So the feeds are taken in their order:
//!
//! 1. Where a block of the one is a block of the other, number for number, both have one F.
//! 2. Elsewhere the paths may differ in F on a way of at most [`SLACK`] tolerances without a break, and then only if the cuts on
//!    that way can be paired in order, none left out, so that the feeds of each pair are the same.
//!
//! The first holds every F of two programs of the same blocks. By the second every F of the one is an F of the other, in the same
//! order, whatever the blocks are and however short: only where it begins and ends is known to [`SLACK`] tolerances.
//!
//! What moves nothing has no F.

use super::path::Run;
use super::side::Part;
use super::walk::same_number;
use crate::geom::bezier::Bezier;
use crate::geom::follow::Meeting;

/// How many tolerances apart along the path both may change F: both ends of a block may be one off in each program.
const SLACK: f64 = 4.0;

/// Where F differs, and the feeds there.
pub(super) struct Differs {
    /// The piece of each path.
    pub(super) at: [usize; 2],
    pub(super) feeds: [Option<f64>; 2],
}

/// A way on which F differs.
struct Slip {
    at: [usize; 2],
    length: f64,
    told: bool,
}

/// The feeds of two paths, in the order in which these meet.
pub(super) struct Paces<'r, 's, 'a> {
    runs: [&'r Run<'s, 'a>; 2],
    digits: [Option<u8>; 2],
    slack: f64,
    /// The parts that had one F last, from which on all is still to be paired. None where the paths have parted before.
    paired: Option<[usize; 2]>,
    /// The parts that met last.
    met: [usize; 2],
    slip: Option<Slip>,
    /// Whether lines have times that cannot be compared line by line.
    pub(super) uneven: bool,
}

/// Whether two parts have one F, or lines one time.
enum Pace {
    Same,
    Differs,
    /// The times of the whole paths can be compared only.
    Uneven,
}

impl<'r, 's, 'a> Paces<'r, 's, 'a> {
    pub(super) fn new(
        runs: [&'r Run<'s, 'a>; 2],
        digits: [Option<u8>; 2],
        tolerance: f64,
    ) -> Paces<'r, 's, 'a> {
        let slack = SLACK * tolerance;
        Paces { runs, digits, slack, paired: Some([0; 2]), met: [0; 2], slip: None, uneven: false }
    }

    /// Takes what meets next; where F differs, and that is known now.
    pub(super) fn meet(&mut self, meeting: &Meeting) -> Option<Differs> {
        self.met = [0, 1].map(|k| self.runs[k].part_of(meeting.at[k]));
        if meeting.length == 0.0 {
            return None;
        }
        let pace = self.pace(meeting);
        self.uneven |= matches!(pace, Pace::Uneven);
        match pace {
            Pace::Differs => {
                let slip = self.slip.get_or_insert(Slip { at: meeting.at, length: 0.0, told: false });
                slip.length += meeting.length;
                if slip.told || !(meeting.alike || self.slack < slip.length) {
                    return None;
                }
                slip.told = true;
                let at = if meeting.alike { meeting.at } else { slip.at };
                Some(self.differs(at))
            }
            Pace::Same | Pace::Uneven => {
                let found = self.settle();
                self.paired = Some(self.met);
                found
            }
        }
    }

    /// The paths part: nothing is known of F there.
    pub(super) fn part(&mut self) {
        (self.paired, self.slip) = (None, None);
    }

    /// At the end of both.
    pub(super) fn end(&mut self) -> Option<Differs> {
        self.settle()
    }

    /// Pairs what stands between the parts that had one F last and those that met last; where F differs.
    fn settle(&mut self) -> Option<Differs> {
        let slip = self.slip.take();
        let from = self.paired?;
        if slip.is_some_and(|slip| slip.told) || from == self.met {
            return None;
        }
        self.unpaired(from, self.met).map(|parts| {
            let at = [0, 1].map(|k| self.runs[k].first_of(parts[k]));
            self.differs(at)
        })
    }

    /// Two parts that no pairing in order gets past; none where one pairs all parts from `from` to `to`, each part with some
    /// of the other that follow each other, or one.
    fn unpaired(&self, from: [usize; 2], to: [usize; 2]) -> Option<[usize; 2]> {
        let width = to[1] - from[1] + 1;
        // Which of the second path's parts can be paired with this one of the first, when all before are paired.
        let mut before = vec![false; width];
        let mut last = from;
        for i in from[0]..=to[0] {
            let mut row = vec![false; width];
            for k in 0..width {
                let begun = i == from[0] && k == 0;
                let reached = begun || before[k] || (0 < k && (row[k - 1] || before[k - 1]));
                row[k] = reached && self.same_feed([i, from[1] + k]);
                if row[k] {
                    last = [i, from[1] + k];
                }
            }
            before = row;
        }
        // The next ones behind the last pair are those that do not fit.
        let next = [0, 1].map(|k| (last[k] + 1).min(to[k]));
        (!before[width - 1]).then_some(next)
    }

    fn same_feed(&self, [i, j]: [usize; 2]) -> bool {
        let (own, other) = (&self.runs[0].parts[i], &self.runs[1].parts[j]);
        let is_free = |part: &Part<'_>| part.rate(0).is_some() || !moves(part);
        same(own.feed, other.feed, self.digits) || is_free(own) || is_free(other)
    }

    fn pace(&self, meeting: &Meeting) -> Pace {
        let ((own, i), (other, j)) = (self.runs[0].find(meeting.at[0]), self.runs[1].find(meeting.at[1]));
        let is_same = match (own.rate(i), other.rate(j)) {
            (Some(own), Some(other)) if meeting.alike => same_number(own, other, self.digits),
            (None, None) => same(own.feed, other.feed, self.digits),
            (Some(_), Some(_)) | (Some(_), None) | (None, Some(_)) => return Pace::Uneven,
        };
        if is_same { Pace::Same } else { Pace::Differs }
    }

    fn differs(&self, at: [usize; 2]) -> Differs {
        let feed = |k: usize| {
            let (part, piece) = self.runs[k].find(at[k]);
            part.rate(piece).or(part.feed)
        };
        Differs { at, feeds: [feed(0), feed(1)] }
    }
}

fn same(own: Option<f64>, other: Option<f64>, digits: [Option<u8>; 2]) -> bool {
    match (own, other) {
        (Some(own), Some(other)) => same_number(own, other, digits),
        (None, None) => true,
        (Some(_), None) | (None, Some(_)) => false,
    }
}

/// Whether a part moves anything.
fn moves(part: &Part<'_>) -> bool {
    let still = |piece: Bezier| piece.control_points().iter().all(|p| *p == piece.points[0]);
    !part.pieces().all(still)
}
