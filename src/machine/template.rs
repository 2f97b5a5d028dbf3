//! Lines of header and footer with places to fill in: `TOOL CALL {tool} Z S{rpm}`.
//!
//! A template is written with values and matched against a line again, so that free text round a program can be read
//! back without a parser of its own.

/// One line with `{name}`, `{tool}` or `{rpm}` in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template(pub String);

impl Template {
    /// The line with each `{variable}` replaced.
    pub fn fill(&self, values: &[(&str, &str)]) -> String {
        let mut line = self.0.clone();
        for (name, value) in values {
            line = line.replace(&format!("{{{name}}}"), value);
        }
        line
    }

    /// The fixed texts before the first variable and behind the last; without variables both are the whole.
    pub fn outline(&self) -> (&str, &str) {
        let line = self.0.as_str();
        (&line[..line.find('{').unwrap_or(line.len())], &line[line.rfind('}').map_or(0, |at| at + 1)..])
    }

    /// The values of the variables where `line` is this template filled in; none where it is not.
    ///
    /// A value is what stands up to the next fixed text; it is not empty. A variable that stands twice has one value.
    pub fn matched<'l>(&self, line: &'l str) -> Option<Vec<(String, &'l str)>> {
        // Most lines are ruled out by their end.
        if !line.ends_with(self.outline().1) {
            return None;
        }
        let mut values: Vec<(String, &str)> = Vec::new();
        let (mut template, mut line) = (self.0.as_str(), line);
        while let Some(open) = template.find('{') {
            let close = open + template[open..].find('}')?;
            line = line.strip_prefix(&template[..open])?;
            let after = &template[close + 1..];
            let fixed = &after[..after.find('{').unwrap_or(after.len())];
            let length = if fixed.is_empty() { line.len() } else { line.find(fixed)? };
            if length == 0 {
                return None;
            }
            let (name, value) = (&template[open + 1..close], &line[..length]);
            if values.iter().any(|(known, other)| known == name && *other != value) {
                return None;
            }
            values.push((name.to_owned(), value));
            line = &line[length..];
            template = after;
        }
        (line == template).then_some(values)
    }

    /// The variables in it.
    pub fn variables(&self) -> impl Iterator<Item = &str> {
        self.0.split('{').skip(1).filter_map(|part| part.split('}').next())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_read_back() {
        let template = Template("TOOL CALL {tool} Z S{rpm}".into());
        let line = template.fill(&[("tool", "4"), ("rpm", "3000")]);
        assert_eq!(line, "TOOL CALL 4 Z S3000");
        assert_eq!(template.matched(&line).unwrap(), [("tool".into(), "4"), ("rpm".into(), "3000")]);
    }

    #[test]
    fn other_lines_do_not_match() {
        let template = Template("T{tool} M6".into());
        for line in ["T M6", "T1 M5", "T1 M6 D1", "XT1 M6"] {
            assert_eq!(template.matched(line), None, "{line}");
        }
        assert_eq!(Template("M30".into()).matched("M30"), Some(vec![]));
        // From the label of one subprogram to the end of another is none of them.
        let call = Template("CALL BLOCK FLUTE{label} TO FLUTE{label}_END".into());
        assert_eq!(call.matched("CALL BLOCK FLUTE1 TO FLUTE1_END").unwrap()[0].1, "1");
        assert_eq!(call.matched("CALL BLOCK FLUTE1 TO FLUTE2_END"), None);
    }
}
