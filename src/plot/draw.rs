//! One figure to SVG.

use super::{Figure, Series, Style};
use plotters::prelude::*;

/// The size of a drawing.
pub const SIZE: (u32, u32) = (1200, 800);

/// The library puts every point on a whole number, so it draws this many times larger than what is shown.
const FINE: u32 = 5;

/// The length of a line in the legend.
const LEGEND: i32 = 24 * FINE as i32;

/// The radius of a dot.
const DOT: i32 = 4 * FINE as i32;

/// Colours that are told apart also by those who see few.
const COLORS: [RGBColor; 6] = [
    RGBColor(0, 90, 170),
    RGBColor(200, 80, 0),
    RGBColor(0, 130, 90),
    RGBColor(150, 60, 150),
    RGBColor(180, 140, 0),
    RGBColor(90, 90, 90),
];

const GREY: RGBColor = RGBColor(150, 150, 150);

/// A figure could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the figure cannot be drawn: {0}")]
pub struct DrawError(String);

/// The least and the greatest of each coordinate.
fn extent(figure: &Figure) -> [[f64; 2]; 2] {
    let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for point in figure.series.iter().flat_map(|series| &series.points) {
        if point.iter().all(|x| x.is_finite()) {
            for (own, x) in extent.iter_mut().zip(point) {
                *own = [own[0].min(*x), own[1].max(*x)];
            }
        }
    }
    extent.map(|[low, high]| {
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        // Nothing is drawn on the frame. What differs in the seventh figure only is level, and has room above and below.
        let great = low.abs().max(high.abs());
        let level = high - low <= 1e-6 * great;
        let room = if level { 0.05 * great.max(1e-9) } else { 0.04 * (high - low) };
        [low - room, high + room]
    })
}

/// Widens the narrower axis until a millimetre is as long on both.
fn equal(extent: [[f64; 2]; 2], size: (f64, f64)) -> [[f64; 2]; 2] {
    let span = extent.map(|[low, high]| high - low);
    let scale = (span[0] / size.0).max(span[1] / size.1);
    let wide = |[low, high]: [f64; 2], size: f64| {
        let middle = low.midpoint(high);
        [middle - 0.5 * scale * size, middle + 0.5 * scale * size]
    };
    [wide(extent[0], size.0), wide(extent[1], size.1)]
}

/// A tick with as many digits as its distance to the next asks for.
fn tick(x: f64, span: f64) -> String {
    // A zero is one, whatever the sums that led to it.
    if x.abs() < 1e-9 * span {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&span) {
        return format!("{x:.2e}");
    }
    let mut digits = 1;
    let mut least = 10.0;
    while span < least && digits < 6 {
        least /= 10.0;
        digits += 1;
    }
    let text = format!("{x:.digits$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The corner for the legend: the one with the fewest points near it.
fn corner(figure: &Figure, [[left, right], [bottom, top]]: [[f64; 2]; 2]) -> SeriesLabelPosition {
    let mut counts = [0usize; 4];
    let lines = figure.series.iter().flat_map(|series| series.points.windows(2));
    for w in lines {
        // Long lines pass corners between their points.
        for k in 0..=8 {
            let share = f64::from(k) / 8.0;
            let x = (w[0][0] + share * (w[1][0] - w[0][0]) - left) / (right - left);
            let y = (w[0][1] + share * (w[1][1] - w[0][1]) - bottom) / (top - bottom);
            let (low, high) = (y < 0.25, 0.75 < y);
            let (before, behind) = (x < 0.3, 0.7 < x);
            counts[0] += usize::from(behind && high);
            counts[1] += usize::from(before && high);
            counts[2] += usize::from(behind && low);
            counts[3] += usize::from(before && low);
        }
    }
    let least = (0..4).min_by_key(|i| counts[*i]);
    match least {
        Some(1) => SeriesLabelPosition::UpperLeft,
        Some(2) => SeriesLabelPosition::LowerRight,
        Some(3) => SeriesLabelPosition::LowerLeft,
        _ => SeriesLabelPosition::UpperRight,
    }
}

/// A figure as SVG.
///
/// # Errors
/// What the drawing library says.
pub fn svg(figure: &Figure) -> Result<String, DrawError> {
    let failed = |error: Box<dyn std::error::Error>| DrawError(error.to_string());
    let mut extent = extent(figure);
    if figure.equal {
        // What the title, the labels and the margins leave of the drawing shows in one that is thrown away.
        let room = draw(figure, extent, &mut String::new()).map_err(failed)?;
        extent = equal(extent, (f64::from(room.0), f64::from(room.1)));
    }
    let mut text = String::new();
    draw(figure, extent, &mut text).map_err(failed)?;
    let (width, height) = SIZE;
    let drawn = format!("width=\"{}\" height=\"{}\"", width * FINE, height * FINE);
    Ok(text.replacen(&drawn, &format!("width=\"{width}\" height=\"{height}\""), 1))
}

fn font(size: u32) -> (&'static str, u32) {
    ("sans-serif", size * FINE)
}

/// Draws a figure, and says how large the area between its axes is.
fn draw(
    figure: &Figure,
    extent: [[f64; 2]; 2],
    text: &mut String,
) -> Result<(u32, u32), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(text, (SIZE.0 * FINE, SIZE.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let [[left, right], [bottom, top]] = extent;
    let mut chart = ChartBuilder::on(&root)
        .caption(&figure.title, font(26))
        .margin(16 * FINE)
        .x_label_area_size(54 * FINE)
        .y_label_area_size(86 * FINE)
        .build_cartesian_2d(left..right, bottom..top)?;
    let room = chart.plotting_area().dim_in_pixel();
    chart
        .configure_mesh()
        .x_desc(&figure.labels[0])
        .y_desc(&figure.labels[1])
        .axis_desc_style(font(20))
        .label_style(font(17))
        .axis_style(ShapeStyle::from(&BLACK).stroke_width(FINE))
        .set_all_tick_mark_size(5 * FINE)
        .max_light_lines(4)
        .x_label_formatter(&|x| tick(*x, right - left))
        .y_label_formatter(&|y| tick(*y, top - bottom))
        .light_line_style(ShapeStyle::from(&RGBColor(242, 242, 242)).stroke_width(FINE))
        .bold_line_style(ShapeStyle::from(&RGBColor(220, 220, 220)).stroke_width(FINE))
        .draw()?;
    let mut colors = COLORS.iter().cycle();
    for series in &figure.series {
        let color = match series.style {
            Style::Thin => &GREY,
            Style::Line | Style::Dots => colors.next().unwrap_or(&BLACK),
        };
        match series.style {
            Style::Line | Style::Thin => {
                let width = if series.style == Style::Line { 2 } else { 1 };
                let style = ShapeStyle::from(color).stroke_width(width * FINE);
                let mut named = false;
                for part in parts(series) {
                    let drawn = chart.draw_series(LineSeries::new(part, style))?;
                    if !named {
                        named = true;
                        drawn
                            .label(&series.name)
                            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + LEGEND, y)], style));
                    }
                }
            }
            Style::Dots => {
                let points = series.points.iter().filter(|p| p[0].is_finite() && p[1].is_finite());
                chart
                    .draw_series(points.map(|p| Circle::new((p[0], p[1]), DOT, color.filled())))?
                    .label(&series.name)
                    .legend(move |(x, y)| Circle::new((x + LEGEND / 2, y), DOT, color.filled()));
            }
        }
    }
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.85))
        .border_style(ShapeStyle::from(&GREY).stroke_width(FINE))
        .legend_area_size(LEGEND + 6 * FINE as i32)
        .margin(10 * FINE)
        .label_font(font(18))
        .position(corner(figure, extent))
        .draw()?;
    root.present()?;
    Ok(room)
}

/// The parts of a line between points that are no numbers.
fn parts(series: &Series) -> impl Iterator<Item = Vec<(f64, f64)>> + '_ {
    series
        .points
        .split(|p| !(p[0].is_finite() && p[1].is_finite()))
        .filter(|part| !part.is_empty())
        .map(|part| part.iter().map(|p| (p[0], p[1])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::elementary::{cos, sin};

    #[test]
    fn ticks_have_the_digits_that_tell_them_apart() {
        assert_eq!(tick(29.5, 30.0), "29.5");
        assert_eq!(tick(-0.0, 30.0), "0");
        assert_eq!(tick(29.9934, 0.01), "29.9934");
        assert_eq!(tick(1.25e-8, 1e-7), "1.25e-8");
    }

    #[test]
    fn a_millimetre_is_as_long_on_both_axes() {
        let [[a, b], [c, d]] = equal([[0.0, 10.0], [0.0, 1.0]], (100.0, 50.0));
        assert_eq!((b - a, d - c), (10.0, 5.0));
        assert_eq!((c + d, a), (1.0, 0.0));
    }

    #[test]
    fn a_circle_is_round() {
        let turn = |i: i32| std::f64::consts::TAU * f64::from(i) / 360.0;
        let mut figure = Figure::new("f", "a circle in a corner", ["X, mm", "Y, mm"]);
        figure.equal = true;
        let round = (0..=360).map(|i| [30.0 + 10.0 * cos(turn(i)), 10.0 * sin(turn(i))]).collect();
        figure.add("circle", Style::Line, round);
        figure.add("far away", Style::Line, vec![[-60.0, 4.0], [0.0, 4.0]]);
        let text = svg(&figure).unwrap();
        let lines = text.split("points=\"").skip(1).filter_map(|rest| rest.split('"').next());
        let points = lines.max_by_key(|points| points.len()).expect("a line");
        let place = |pair: &str| {
            let (x, y) = pair.split_once(',').expect("two numbers");
            [x, y].map(|x| x.parse::<f64>().expect("a number"))
        };
        let places: Vec<[f64; 2]> = points.split_whitespace().map(place).collect();
        let span = |axis: usize| {
            let of = || places.iter().map(|p| p[axis]);
            of().fold(f64::NEG_INFINITY, f64::max) - of().fold(f64::INFINITY, f64::min)
        };
        // Each end of both spans is on a whole number, and so is the size of the drawing's area.
        assert!((span(0) - span(1)).abs() <= 4.0 && 1000.0 < span(0), "{} {}", span(0), span(1));
    }

    #[test]
    fn the_same_figure_has_the_same_bytes() {
        let mut figure = Figure::new("f", "title & more", ["X, mm", "Y, mm"]);
        figure.add(
            "line",
            Style::Line,
            vec![[0.0, 0.0], [1.0, 2.0], [f64::NAN, 0.0], [2.0, 1.0], [3.0, 1.0]],
        );
        figure.add("nothing", Style::Line, vec![[f64::NAN; 2]]);
        figure.add("dots", Style::Dots, vec![[0.5, 0.5]]);
        assert_eq!(figure.series.len(), 2);
        let text = svg(&figure).unwrap();
        assert_eq!(text, svg(&figure).unwrap());
        assert!(text.starts_with("<svg") && text.contains("title &amp; more"), "{text}");
        // Two parts of the line, and one in the legend.
        assert_eq!(text.matches("stroke-width=\"10\"").count(), 3, "{text}");
        assert!(text.contains("<circle"));
    }
}
