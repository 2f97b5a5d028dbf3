//! All tests that need more than one module, in one binary.
//!
//! | module | what it holds |
//! |---|---|
//! | `apt` | CL data of CAM systems, from their text to proved programs |
//! | `cases` | small inputs that went wrong once, and the right value of each |
//! | `golden` | inputs and every machine's output, side by side, as bytes |
//! | `files` | curve files: DXF, IGES, STEP |
//! | `errors` | bad inputs and their rendered diagnostics |
//! | `paper` | the table of the paper, row by row |
//! | `roundtrip` | what is written reads back to the same text |
//! | `robust` | nothing panics |
//! | `diagnostics` | the registry of diagnostics: ids in step with the source, the page, what shows each |
//! | `diff` | two programs beside each other, and every change found where it is |
//! | `damage` | a program changed in any word is refused |
//! | `grammar` | `grammar/*.ebnf` in step with readers, writers and keys |
//! | `oracle` | programs evaluated from their text alone, by the manuals' formulas |
//! | `exact` | conversions against exact rational arithmetic |
//! | `fits` | few cubics, against the best there are |
//! | `lines` | runs of lines as splines |
//! | `runs` | runs of every kind: a fit is proved, or lines stay |
//! | `feeds` | two programs beside each other: every changed F, and planes by their angle |
//! | `machine` | golden programs run as on a machine, with what a careful machinist would not let pass |
//! | `misfit` | arcs whose end is not on their circle |
//! | `plot` | pages and sheets, and what they show |
//! | `simulate` | the tables of `docs/simulation.md` |
//! | `readme` | the README's commands |
//! | `schema` | keys and JSON Schemas |
//! | `cases` | small inputs, each with its right value |
//! | `cli` | exit codes, files, streams |
//! | `tidy` | documents, fixtures and rules in step with the code |

mod apt;
mod cases;
mod cli;
mod damage;
mod diagnostics;
mod diff;
mod errors;
mod exact;
mod feeds;
mod files;
mod fits;
mod golden;
mod grammar;
mod lines;
mod machine;
mod misfit;
mod oracle;
mod paper;
mod plot;
mod process;
mod readme;
mod robust;
mod roundtrip;
mod runs;
mod schema;
mod simulate;
mod support;
mod tidy;
mod translate;
