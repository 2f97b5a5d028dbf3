//! The CAM systems: how each is recognised, and what it writes differently. One file each.

mod catia;
mod creo;
mod fusion;
mod iso;
mod nx;
mod solidworks;

/// A CAM system.
#[derive(Debug)]
pub(super) struct System {
    /// Its name, for `--from`.
    pub(super) name: &'static str,
    /// Its word table.
    pub(super) words: &'static str,
    /// Whether a text looks as if it wrote it.
    pub(super) recognise: fn(&Head) -> bool,
}

/// The beginning of a text in capitals, by which a system is recognised.
pub(super) struct Head(String);

impl Head {
    /// Of a text.
    pub(super) fn new(text: &str) -> Head {
        Head(text.to_ascii_uppercase())
    }

    /// Whether it has a line that begins so, blanks not counted.
    pub(super) fn line(&self, start: &str) -> bool {
        self.0.lines().any(|line| {
            let mut bytes = line.bytes().filter(|b| !b.is_ascii_whitespace());
            start.bytes().all(|b| bytes.next() == Some(b))
        })
    }
}

/// All systems; the first that recognises a text reads it, the last recognises none.
pub(super) const ALL: &[System] =
    &[catia::SYSTEM, creo::SYSTEM, fusion::SYSTEM, nx::SYSTEM, solidworks::SYSTEM, iso::SYSTEM];

/// The system of a name.
pub(super) fn find(name: &str) -> Option<&'static System> {
    ALL.iter().find(|system| system.name == name)
}

/// The system that a text looks like, or the plain language.
pub(super) fn detect(text: &str) -> &'static System {
    let head = Head::new(text);
    ALL.iter().find(|system| (system.recognise)(&head)).unwrap_or(&ALL[ALL.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_system_is_known_by_its_marks() {
        for (text, name) in [
            ("$$     CATIA APT VERSION 1.0\nGOTO/1,2,3", "catia"),
            ("$$*CATIA0\n", "catia"),
            ("INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/0,0,0,5),ON,(LINE/0,0,0,0,5,0)", "catia"),
            ("$$*          Pro/CLfile  Version 8.0", "creo"),
            ("TOOL PATH/A,TOOL,B\nTLDATA/MILL,10,0,1,0,0", "nx"),
            ("MSYS/0,0,0,1,0,0,0,1,0", "nx"),
            ("UNIT/MM\nTRNTYP/WORLD,0,0,0", "solidworks"),
            ("MODE/MILL\nUNITS/MM\nMOVARC/0,0,0,0,0,1,5,ANGLE,90", "fusion"),
            ("SPINDL / MAIN", "fusion"),
            ("GOTO/1,2,3", "iso"),
        ] {
            assert_eq!(detect(text).name, name, "{text}");
        }
        assert!(find("nx").is_some() && find("cimatron").is_none());
    }
}
