//! Readers and writers of the dialects against their grammars.

use super::generate::Generator;
use super::grammar;
use super::recognise::Recogniser;
use super::terms::Terms;
use crate::support::{folder, machine};
use splinepost::dialect::DIALECTS;
use splinepost::machine::Machine;
use splinepost::source::SourceId;
use std::collections::BTreeSet;
use std::fs;

/// What a reader says of words that it does not know, or that are spelled wrongly. Such a word must not be in the grammar.
///
/// All else is about what words mean together or on one machine, which no grammar says: a move before its motion
/// (`motion-missing`), a word twice in a block (`axis-twice`), a value out of range (`feed-range`), an axis that the
/// machine does not have (`axis-unknown`).
const LEXICAL: &[&str] = &[
    "word-unreadable",  // no word at all
    "word-unknown",     // a word, but none of this control
    "block-unknown",    // Klartext: a block of another kind
    "block-unfinished", // Klartext: the text ends behind ~
    "block-skip",       // ISO: /
    "remark-open",      // ISO: a remark without its end
    "m-function",       // M in a block
    "parameter",        // Klartext: Q
    "incremental",      // Klartext: I
    "compensation",     // Klartext: RL, RR
    "degree-too-high",  // Sinumerik: more than four coefficients
    "degree-range",     // Sinumerik: SD other than 2, 3
    "splinepath",       // Sinumerik: arguments of another form
    "fgroup",           // Sinumerik: arguments that are no linear axes
];

/// The same, where a word stands alone: in a block with others `code-refused` also says that the work offset changes, and
/// Klartext has axes in the grammar that the machine does not have.
const ALONE: &[&str] = &["code-refused", "axis-unknown", "short-way-axis"];

/// The default machine of a dialect without header and footer, so that a line can stand alone.
fn bare(name: &str) -> Machine {
    let own = match name {
        "mazak" => "[feed]\nrotary = \"inverse-time\"\n[text]\nwithout_point = 1.0\n",
        "sinumerik" => "[arcs]\nplanes = true\n",
        _ => "",
    };
    machine(&format!(
        "extends = \"{name}\"\n{own}[axis.A]\nkind = \"modulo\"\n[program]\nheader = []\nstart = []\nfooter = []\nclose = []\n"
    ))
}

/// The names of what is wrong with a text.
fn errors(text: &str, machine: &Machine) -> BTreeSet<&'static str> {
    match (machine.dialect.read)(text, SourceId::INPUT, machine) {
        Ok(_) => BTreeSet::new(),
        Err(errors) => errors.0.iter().map(|d| d.id).collect(),
    }
}

#[test]
fn sentences_are_read() {
    for dialect in DIALECTS {
        let (grammar, machine) = (grammar(dialect.name), bare(dialect.name));
        let terms = Terms::of(&machine);
        let recogniser = Recogniser { grammar: &grammar, terms: &terms };
        // Digits of an exponent are not repeated: 1EX9999 is a number that nothing can hold.
        let mut generator = Generator::new(recogniser, 1, &["exponent"]);
        let mut sound = 0;
        for _ in 0..1600 {
            let line = generator.sentence("line");
            let errors = errors(&line, &machine);
            let lexical: Vec<_> = errors.iter().filter(|id| LEXICAL.contains(id)).collect();
            assert!(lexical.is_empty(), "{}: {line:?} is in the grammar, but {lexical:?}", dialect.name);
            sound += usize::from(errors.is_empty());
        }
        assert!(20 < sound, "{}: of all lines only {sound} are read", dialect.name);
        let unmet: Vec<&str> = grammar.rules[1..]
            .iter()
            .map(|rule| rule.name.as_str())
            .filter(|name| !generator.met.contains(*name))
            .collect();
        assert!(unmet.is_empty(), "{}: no line has {unmet:?}", dialect.name);
    }
}

/// Words, and what is nearly one. Lines that are something else for one control are of use to the others.
const WORDS: &str = "POLY BSPLINE ASPLINE CSPLINE UPATH SPATH BAUTO BNAT BTAN EAUTO ENAT ETAN COMPOF COMPON SOFT BRISK \
    TRAFOOF TRAORI FFWON STOPRE G1X1 G01 SD=1 SD=2 SD=3 SD=4 PL=1 PW=1 PL1 SPLINEPATH(1,X) SPLINEPATH(2,X) FGROUP(X) \
    FGROUP(A) FGROUP() K1X+1 K3A1E2 K4X+1 FMAX FAUTO R0 RL RR M3 M99 X+1 IX+1 X+Q1 X1,5 x1 g1 E1 (a) (a /G1 % %1 ; ;a * *a \
    ~ N N1 1 ? ä F=R1 F=Q1 A=DC(5) A=DC(5 X=DC(5) R1=5 R=5 FQ1 F#1 F#a #1=5 #=5 IA+5 A3=1 B3=1 C3=1 D3=1 XH=1 YH=1 \
    UH=1 PO[XH]=(1,2) XH=PO(1) ORICURVE ORIVECT ORIAXES ORIPATH TX+1 LN TURN=2";

/// Blocks of one word, of every letter and every G code.
fn blocks_of_one_word(dialect: &str) -> Vec<String> {
    let signs = ["", "1", "-1.", ".5", "=1", "=", "1=1", "=PO(1)", "=PO(1,2,3,4,5,6)", ":1", "(1)"];
    let letters = ('A'..='Z').flat_map(|letter| signs.map(|sign| format!("{letter}{sign}")));
    // G=1 is read and nobody writes it.
    let words: Vec<String> =
        letters.filter(|word| word != "G=1").chain(WORDS.split_whitespace().map(str::to_owned)).collect();
    if dialect == "heidenhain" {
        // Five of the letters are axes that this machine does not have.
        let axes = ['U', 'V', 'W', 'B', 'C'];
        let known =
            words.iter().filter(|word| !(word.starts_with(axes) && word[1..].starts_with(['1', '-', '.'])));
        let moves = known.flat_map(|word| ["L", "SPL"].map(|kind| format!("{kind} {word}")));
        let others = [
            "CC X+0",
            "CR X+1 R+5",
            "RND R1",
            "CALL LBL 1",
            "L F MAX",
            "L FQ1",
            "L IA+5",
            "FN 0: Q1=+5",
            "FN 0: Q1= 5",
        ]
        .map(str::to_owned);
        return moves.chain(words.iter().cloned()).chain(others).collect();
    }
    let codes = (0..10_000).map(|tenths| match tenths % 10 {
        0 => format!("G{}", tenths / 10),
        tenth => format!("G{}.{tenth}", tenths / 10),
    });
    // G43 needs H and a tool call before it, and the reader has one name for whatever is missing.
    words.iter().cloned().chain(codes.filter(|code| code != "G43")).collect()
}

#[test]
fn a_word_is_in_the_grammar_where_it_is_read() {
    for dialect in DIALECTS {
        let (grammar, machine) = (grammar(dialect.name), bare(dialect.name));
        let terms = Terms::alone(&machine);
        let recogniser = Recogniser { grammar: &grammar, terms: &terms };
        let mut wrong = Vec::new();
        let (mut read, mut refused) = (0, 0);
        for block in blocks_of_one_word(dialect.name) {
            // A line behind it, where it goes on.
            let text = format!("{block}\n\n");
            let errors = errors(&text, &machine);
            let lexical = errors.iter().any(|id| LEXICAL.contains(id) || ALONE.contains(id));
            match (recogniser.recognises("program", &text), lexical) {
                (true, false) => read += 1,
                (false, true) => refused += 1,
                (known, _) => {
                    wrong.push(format!("{block}: in the grammar: {known}; the reader says {errors:?}"));
                }
            }
        }
        assert!(wrong.is_empty(), "{}:\n{}", dialect.name, wrong.join("\n"));
        assert!(20 < read && 100 < refused, "{}: {read} {refused}", dialect.name);
    }
}

#[test]
fn golden_programs_are_recognised() {
    let mut wrong = Vec::new();
    let mut programs = 0;
    for case in fs::read_dir(folder("fixtures/compile")).expect("fixtures/compile").flatten() {
        for entry in fs::read_dir(case.path()).expect("a case").flatten() {
            let path = entry.path();
            if !crate::support::is_program(&path) {
                continue;
            }
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let machine = match fs::read_to_string(case.path().join(format!("{name}.machine.toml"))) {
                Ok(file) => machine(&file),
                Err(_) => Machine::built_in(&name).expect("a default machine"),
            };
            let grammar = grammar(machine.dialect.name);
            let terms = Terms::of(&machine);
            let recogniser = Recogniser { grammar: &grammar, terms: &terms };
            let text = fs::read_to_string(&path).expect("a program");
            programs += 1;
            if recogniser.recognises(grammar.root(), &text) {
                // One line more makes another text of it.
                let middle = text.match_indices('\n').nth(text.lines().count() / 2).map_or(0, |(at, _)| at);
                let damaged = format!("{}\n?{}", &text[..middle], &text[middle..]);
                assert!(!recogniser.recognises(grammar.root(), &damaged), "{}", path.display());
                continue;
            }
            let line = text.lines().find(|line| !recogniser.recognises("line", line)).unwrap_or("as a whole");
            wrong.push(format!("{} is not recognised: {line}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(DIALECTS.len() <= programs, "{programs} programs");
}

#[test]
fn what_is_not_read_is_not_recognised() {
    let lines: &[(&str, &[&str])] = &[
        (
            "sinumerik",
            &["N10 G2 X10 CR=5", "N10 X10 FOO", "PO[X]=(1,2,3,4,5,6)", "UPATHX10", "X10 / Y10", "G1 X1..5"],
        ),
        (
            "heidenhain",
            &["1 CR X+0 R+5", "1 L X+1 M3", "1 LX+1", "1 L X+1 RL", "  K3X+0", "1 L X+1 ~ ; a\nY+1"],
        ),
        ("mazak", &["G02.1 X1. Y1. R5.", "/G1 X1.", "(a", "G1 X1. Q1", "G1 x1.", "X1. ;;"]),
    ];
    assert_eq!(lines.len(), DIALECTS.len());
    for (name, lines) in lines {
        let (grammar, machine) = (grammar(name), bare(name));
        let terms = Terms::of(&machine);
        let recogniser = Recogniser { grammar: &grammar, terms: &terms };
        for line in *lines {
            assert!(!recogniser.recognises("program", line), "{name}: {line}");
            let errors = errors(line, &machine);
            assert!(
                errors.iter().any(|id| LEXICAL.contains(id) || ALONE.contains(id)),
                "{name}: {line} {errors:?}"
            );
        }
    }
}
