//! Figures to one SVG sheet, or to one HTML page that needs nothing else: no script, no font, no network.

use super::Figure;
use super::draw::{DrawError, SIZE, svg};
use std::fmt::Write as _;

const STYLE: &str = "body{font-family:sans-serif;margin:2em auto;max-width:75em;padding:0 1em;color:#222}\
nav a{margin-right:1em;white-space:nowrap}figure{margin:2em 0}\
svg{width:100%;height:auto;border:1px solid #ddd}pre{background:#f6f6f6;padding:1em;overflow:auto}";

/// A text between tags.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// One HTML page.
///
/// # Errors
/// A figure cannot be drawn.
pub fn html(title: &str, figures: &[Figure], summary: &str) -> Result<String, DrawError> {
    let title = escaped(title);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<nav>\n"
    );
    // Writing to a String cannot fail.
    for figure in figures {
        let _ = writeln!(page, "<a href=\"#{}\">{}</a>", figure.id, escaped(&figure.title));
    }
    let _ = write!(page, "</nav>\n<pre>{}</pre>\n", escaped(summary));
    for figure in figures {
        let named = format!("<svg role=\"img\" aria-label=\"{}\" ", escaped(&figure.title));
        let drawing = svg(figure)?.replacen("<svg ", &named, 1);
        let _ = write!(page, "<figure id=\"{}\">\n{drawing}</figure>\n", figure.id);
    }
    page.push_str("</body>\n</html>\n");
    Ok(page)
}

/// One SVG with all figures below each other.
///
/// # Errors
/// A figure cannot be drawn.
pub fn sheet(figures: &[Figure]) -> Result<String, DrawError> {
    let (width, height) = SIZE;
    let whole = height * figures.len() as u32;
    let mut text = format!(
        "<svg width=\"{width}\" height=\"{whole}\" viewBox=\"0 0 {width} {whole}\" xmlns=\"http://www.w3.org/2000/svg\">\n"
    );
    for (i, figure) in figures.iter().enumerate() {
        let y = height * i as u32;
        text.push_str(&svg(figure)?.replacen("<svg ", &format!("<svg id=\"{}\" y=\"{y}\" ", figure.id), 1));
    }
    text.push_str("</svg>\n");
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Style;

    #[test]
    fn a_page_holds_all_that_it_shows() {
        let mut figure = Figure::new("xy", "X < Y", ["X, mm", "Y, mm"]);
        figure.add("path", Style::Line, vec![[0.0, 0.0], [1.0, 1.0]]);
        let page = html("A & B", std::slice::from_ref(&figure), "1 < 2").unwrap();
        assert!(page.contains("<h1>A &amp; B</h1>") && page.contains("<pre>1 &lt; 2</pre>"));
        assert!(page.contains("<figure id=\"xy\">") && page.contains("href=\"#xy\""));
        for outside in ["<script", "src=", "url(", "@import", "<link"] {
            assert!(!page.contains(outside), "{outside}");
        }
        let sheet = sheet(&[figure.clone(), figure]).unwrap();
        assert_eq!(sheet.matches("<svg ").count(), 3);
    }
}
