//! Remarks of a program: in letters that the control takes, and in lines of the length that the machine file allows.
//!
//! What a control does with other letters differs: some skip them on reading, some end the remark, some stop. So whatever a
//! user wrote (names of operations and tools, `PPRINT`) comes through here before it stands in a program.

use super::{Machine, Text};

/// Letters with accents and typographic signs, and what stands for them in ASCII.
pub const ACCENTS: &[(&str, &str)] = &[
    ("ÀÁÂÃÅĄ", "A"),
    ("àáâãåą", "a"),
    ("Ä", "Ae"),
    ("ä", "ae"),
    ("Ö", "Oe"),
    ("ö", "oe"),
    ("Ü", "Ue"),
    ("ü", "ue"),
    ("ß", "ss"),
    ("ÇČĆ", "C"),
    ("çčć", "c"),
    ("ÈÉÊËĘĚ", "E"),
    ("èéêëęě", "e"),
    ("ÌÍÎÏ", "I"),
    ("ìíîï", "i"),
    ("ÑŃŇ", "N"),
    ("ñńň", "n"),
    ("ÒÓÔÕØ", "O"),
    ("òóôõø", "o"),
    ("ÙÚÛŮ", "U"),
    ("ùúûů", "u"),
    ("ÝŸ", "Y"),
    ("ýÿ", "y"),
    ("ŠŚ", "S"),
    ("šś", "s"),
    ("ŽŹŻ", "Z"),
    ("žźż", "z"),
    ("Ł", "L"),
    ("ł", "l"),
    ("Æ", "AE"),
    ("æ", "ae"),
    ("Œ", "OE"),
    ("œ", "oe"),
    ("°", "deg"),
    ("µμ", "u"),
    ("²", "2"),
    ("³", "3"),
    ("–—", "-"),
    ("‘’", "'"),
    ("“”", "\""),
];

/// What stands for a sign that a control does not take; one that is not here becomes a blank. Where the control does not take
/// the other one either, that becomes a blank too.
const SIGNS: &[(char, &str)] = &[
    ('%', " pct "),
    ('&', " and "),
    ('@', " at "),
    ('~', "-"),
    ('/', "-"),
    ('\\', "/"),
    ('|', "/"),
    (';', ","),
    ('!', "."),
    ('?', "."),
    ('\'', ""),
    ('"', ""),
    ('`', ""),
    ('[', "("),
    (']', ")"),
    ('{', "("),
    ('}', ")"),
    ('<', "("),
    ('>', ")"),
];

/// How often a sign may stand for another: `\` for `/` for `-`.
const MOST_STEPS: usize = 3;

/// A remark in the letters that the control takes, one blank at a time; not longer than it has to be.
pub fn taken(remark: &str, text: &Text) -> String {
    let mut out = String::with_capacity(remark.len());
    for c in remark.chars() {
        take(c, text, MOST_STEPS, &mut out);
    }
    out.split_ascii_whitespace().collect::<Vec<_>>().join(" ")
}

/// One letter as the control takes it.
fn take(c: char, text: &Text, steps: usize, out: &mut String) {
    if c.is_ascii_lowercase() {
        out.push(if text.comment_lower { c } else { c.to_ascii_uppercase() });
    } else if c.is_ascii_uppercase() || c.is_ascii_digit() || text.comment_signs.contains(c) {
        out.push(c);
    } else if let Some((_, other)) = ACCENTS.iter().find(|(letters, _)| letters.contains(c)) {
        other.chars().for_each(|c| take(c, text, steps, out));
    } else if let Some((_, other)) = SIGNS.iter().find(|(sign, _)| *sign == c && 0 < steps) {
        other.chars().for_each(|c| take(c, text, steps - 1, out));
    } else if c.is_alphabetic() && text.comment_signs.contains('_') {
        // A letter of another script: it leaves its place.
        out.push('_');
    } else {
        out.push(' ');
    }
}

/// A remark in lines of the length that the machine file allows. A line ends behind a comma, so that nothing in an enumeration
/// is torn; what is longer than a line is cut between words, though not between a name and its number.
pub fn wrapped(text: &str, machine: &Machine) -> Vec<String> {
    let most = machine.text.comment_length;
    let mut lines = vec![String::new()];
    for item in text.split_inclusive(", ").map(|item| item.trim_end_matches(' ')) {
        if put(&mut lines, item, most) {
            continue;
        }
        if item.len() <= most {
            lines.push(item.to_owned());
            continue;
        }
        for words in together(item) {
            if put(&mut lines, words, most) {
                continue;
            }
            // A word that is longer than a line has no better place to be cut; a remark of the machine is ASCII.
            let mut rest = words;
            while most < rest.len()
                && let Some((line, more)) = rest.split_at_checked(most)
            {
                lines.push(line.to_owned());
                rest = more;
            }
            lines.push(rest.to_owned());
        }
    }
    lines.retain(|line| !line.is_empty());
    if lines.is_empty() {
        lines.push(String::new());
    }
    lines
}

/// Puts a text behind the last line, where it fits.
fn put(lines: &mut [String], text: &str, most: usize) -> bool {
    let Some(last) = lines.last_mut() else { return false };
    let blank = usize::from(!last.is_empty());
    if most < last.len() + blank + text.len() {
        return false;
    }
    if !last.is_empty() {
        last.push(' ');
    }
    last.push_str(text);
    true
}

/// The words of a text; a number stays with the word before it that is none: `X -8`, `TOOL 5`.
fn together(text: &str) -> Vec<&str> {
    let is_number = |word: &str| {
        let digits = word.trim_start_matches(['-', '+', '.']);
        digits.starts_with(|c: char| c.is_ascii_digit())
    };
    let mut groups = Vec::new();
    let (mut start, mut at, mut before) = (0, 0, None::<&str>);
    for word in text.split(' ') {
        if let Some(before) = before
            && (!is_number(word) || is_number(before))
        {
            groups.push(&text[start..at - 1]); // behind a blank
            start = at;
        }
        before = Some(word);
        at += word.len() + 1;
    }
    groups.push(&text[start..]);
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(name: &str, length: usize) -> Machine {
        let mut machine = Machine::built_in(name).unwrap();
        machine.text.comment_length = length;
        machine
    }

    #[test]
    fn a_control_gets_letters_that_it_takes() {
        let mazak = machine("mazak", 48).text;
        for (remark, expected) in [
            ("Größe 10° (grob)", "GROESSE 10DEG GROB"),
            ("pocket ((inner) outer)", "POCKET INNER OUTER"),
            ("don't stop! $5 50%", "DONT STOP. 5 50 PCT"),
            ("C:\\parts\\a;b", "C:/PARTS/A,B"),
            ("中 A", "_ A"),
            ("  a\t\u{7}b  ", "A B"),
            ("BALL 6, R=3.0 +0.1_x #2", "BALL 6, R=3.0 +0.1_X #2"),
        ] {
            assert_eq!(taken(remark, &mazak), expected, "{remark}");
        }
        // A `~` at its end would join a block of Klartext with the next, and Sinumerik takes small letters.
        assert_eq!(taken("Größe ~", &machine("heidenhain", 72).text), "GROESSE -");
        assert_eq!(taken("Größe (grob) ~", &machine("sinumerik", 72).text), "Groesse (grob) -");
    }

    #[test]
    fn what_is_taken_stays() {
        for name in ["mazak", "heidenhain", "sinumerik"] {
            let text = machine(name, 48).text;
            let all: String = (' '..='\u{17f}').chain(['中', '“', '—', '€']).collect();
            let once = taken(&all, &text);
            assert_eq!(taken(&once, &text), once, "{name}");
            assert!(once.is_ascii() && !once.contains(['~', '%', '$']), "{name}: {once}");
        }
    }

    #[test]
    fn lines_end_between_the_items_of_a_list() {
        let machine = machine("mazak", 34);
        assert_eq!(
            wrapped("FASTEST AT FEED: X 900, Y 900, Z 900, A 12", &machine),
            ["FASTEST AT FEED: X 900, Y 900,", "Z 900, A 12"]
        );
        // An item longer than a line is cut between words, but no number stands alone.
        assert_eq!(
            wrapped("THIS IS TOOL NUMBER 1 FOR THE TOOL 123456", &machine),
            ["THIS IS TOOL NUMBER 1 FOR THE", "TOOL 123456"]
        );
        assert_eq!(
            wrapped(&"X".repeat(70), &machine).iter().map(String::len).collect::<Vec<_>>(),
            [34, 34, 2]
        );
        assert_eq!(wrapped("", &machine), [""]);
    }
}
