//! Line charts as SVG: alone, or side by side with one legend.

use std::ops::Range;

use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

use super::numbers::significant;

/// How a line looks: in greyscale print and to colour-blind eyes dashes tell lines apart, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// sRGB; no two styles in a chart have the same.
    pub color: [u8; 3],
    /// Lengths of dashes and gaps in pixels; empty for a full line.
    pub dashes: &'static str,
}

/// A line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Its look.
    pub style: Style,
    /// Points from left to right; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
}

/// A point with an error bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// Position.
    pub x: f64,
    /// Value.
    pub y: f64,
    /// Half the length of the bar.
    pub error: f64,
}

/// Dots of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Dots {
    /// Name in the legend; where it is empty they are not named there.
    pub name: String,
    /// sRGB.
    pub color: [u8; 3],
    /// Those that are not finite are left out.
    pub points: Vec<Dot>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// What it shows; positive where it is logarithmic.
    pub range: Range<f64>,
    /// Whether it is logarithmic.
    pub log: bool,
}

/// One chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Above it.
    pub title: String,
    /// Horizontal.
    pub x: Axis,
    /// Vertical.
    pub y: Axis,
    /// Lines.
    pub lines: Vec<Line>,
    /// Dots, over the lines.
    pub dots: Vec<Dots>,
}

/// Size of a panel in pixels.
const SIZE: (u32, u32) = (480, 410);
/// Width of the legend beside them.
const LEGEND_WIDTH: u32 = 230;
const FONT: &str = "sans-serif";
const TEXT: u32 = 15;
/// What cannot be drawn, which does not happen in a string.
pub type PlotError = DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>;

/// The `panels` side by side, as the content of an .svg file.
///
/// # Errors
/// If the library cannot draw a panel, for instance because a range is empty.
pub fn svg(panels: &[Panel]) -> Result<String, PlotError> {
    let mut content = String::new();
    {
        let count = panels.len().max(1);
        let width = SIZE.0 * count as u32;
        let root = SVGBackend::with_string(&mut content, (width + LEGEND_WIDTH, SIZE.1)).into_drawing_area();
        root.fill(&WHITE)?;
        let (charts, legend) = root.split_horizontally(width);
        for (area, panel) in charts.split_evenly((1, count)).iter().zip(panels) {
            draw(area, panel)?;
        }
        draw_legend(&legend, panels)?;
        root.present()?;
    }
    Ok(dashed(content, panels))
}

/// One panel without a legend, as an `<svg>` element that scales to where it stands.
///
/// # Errors
/// If the library cannot draw it, for instance because a range is empty.
pub fn chart(panel: &Panel) -> Result<String, PlotError> {
    let mut content = String::new();
    {
        let root = SVGBackend::with_string(&mut content, SIZE).into_drawing_area();
        draw(&root, panel)?;
        root.present()?;
    }
    Ok(dashed(content, std::slice::from_ref(panel)))
}

/// The drawing library has no dashes of its own. Each colour is one line's, and gets that line's dashes.
fn dashed(mut content: String, panels: &[Panel]) -> String {
    let mut styles: Vec<Style> = panels.iter().flat_map(|p| &p.lines).map(|line| line.style).collect();
    styles.sort_by_key(|style| style.color);
    styles.dedup();
    for Style { color: [r, g, b], dashes } in styles.into_iter().filter(|style| !style.dashes.is_empty()) {
        let stroke = format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"");
        content = content.replace(&stroke, &format!("{stroke} stroke-dasharray=\"{dashes}\""));
    }
    content
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw(area: &Area, panel: &Panel) -> Result<(), PlotError> {
    let (x, y) = (panel.x.range.clone(), panel.y.range.clone());
    match (panel.x.log, panel.y.log) {
        (true, true) => draw_on(area, panel, x.log_scale(), y.log_scale()),
        (true, false) => draw_on(area, panel, x.log_scale(), y),
        (false, true) => draw_on(area, panel, x, y.log_scale()),
        (false, false) => draw_on(area, panel, x, y),
    }
}

fn draw_on<X, Y>(area: &Area, panel: &Panel, x: X, y: Y) -> Result<(), PlotError>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, (FONT, TEXT))
        .margin(8)
        .margin_right(20)
        .x_label_area_size(46)
        .y_label_area_size(70)
        .build_cartesian_2d(x, y)?;
    let tick = |log: bool| move |value: &f64| if log { power(*value) } else { plain(*value) };
    chart
        .configure_mesh()
        .x_desc(&panel.x.label)
        .y_desc(&panel.y.label)
        .x_label_formatter(&tick(panel.x.log))
        .y_label_formatter(&tick(panel.y.log))
        .x_labels(if panel.x.log { 10 } else { 6 })
        .y_labels(if panel.y.log { 10 } else { 7 })
        .light_line_style(RGBColor(244, 244, 244))
        .bold_line_style(RGBColor(224, 224, 224))
        .axis_desc_style((FONT, TEXT))
        .label_style((FONT, TEXT - 2))
        .draw()?;
    // Dashes over full lines, so that both are seen where they meet.
    let (full, dashed): (Vec<_>, Vec<_>) = panel.lines.iter().partition(|line| line.style.dashes.is_empty());
    for line in full.into_iter().chain(dashed) {
        for piece in clipped(line, panel) {
            chart.draw_series(LineSeries::new(piece, line_style(line)))?;
        }
    }
    draw_dots(&mut chart, panel)
}

fn draw_dots<R, S>(
    chart: &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<R, S>>,
    panel: &Panel,
) -> Result<(), PlotError>
where
    R: Ranged<ValueType = f64>,
    S: Ranged<ValueType = f64>,
{
    let inside = |dot: &&Dot| panel.x.range.contains(&dot.x) && panel.y.range.contains(&dot.y);
    for Dots { color: [r, g, b], points, .. } in &panel.dots {
        let seen: Vec<&Dot> = points.iter().filter(inside).collect();
        let bars = seen.iter().filter(|dot| dot.error.is_finite()).map(|dot| {
            let Range { start, end } = panel.y.range;
            let ends = [dot.y - dot.error, dot.y + dot.error].map(|y| y.clamp(start, end));
            PathElement::new(ends.map(|y| (dot.x, y)).to_vec(), BLACK)
        });
        chart.draw_series(bars)?;
        let radius = if [*r, *g, *b] == [0; 3] { 2 } else { 3 };
        let fill = RGBColor(*r, *g, *b).filled();
        chart.draw_series(seen.iter().map(|dot| Circle::new((dot.x, dot.y), radius, fill)))?;
    }
    Ok(())
}

/// Names of all lines and dots, each once, in a column.
fn draw_legend(area: &Area, panels: &[Panel]) -> Result<(), PlotError> {
    let mut lines: Vec<&Line> = Vec::new();
    for line in panels.iter().flat_map(|panel| &panel.lines) {
        if !lines.iter().any(|known| known.name == line.name) {
            lines.push(line);
        }
    }
    let text = (FONT, TEXT - 1).into_text_style(area);
    let place = |row: usize| 44 + 22 * row as i32;
    for (row, line) in lines.iter().enumerate() {
        let y = place(row);
        area.draw(&PathElement::new(vec![(0, y), (36, y)], line_style(line)))?;
        area.draw_text(&line.name, &text, (44, y - 7))?;
    }
    let named = panels.iter().flat_map(|panel| &panel.dots).find(|dots| !dots.name.is_empty());
    if let Some(dots) = named {
        let y = place(lines.len());
        area.draw(&PathElement::new(vec![(18, y - 7), (18, y + 7)], BLACK))?;
        area.draw(&Circle::new((18, y), 3, BLACK.filled()))?;
        area.draw_text(&dots.name, &text, (44, y - 7))?;
    }
    Ok(())
}

fn line_style(line: &Line) -> ShapeStyle {
    let [r, g, b] = line.style.color;
    RGBColor(r, g, b).stroke_width(2)
}

/// The pieces of a line within the ranges of the axes, cut at their ends.
fn clipped(line: &Line, panel: &Panel) -> Vec<Vec<(f64, f64)>> {
    let to_axis = |value: f64, axis: &Axis| if axis.log { value.ln() } else { value };
    let from_axis = |value: f64, axis: &Axis| if axis.log { value.exp() } else { value };
    let axes = [&panel.x, &panel.y];
    let [low, high] = [0, 1]
        .map(|end| axes.map(|axis| to_axis(if end == 0 { axis.range.start } else { axis.range.end }, axis)));
    let points: Vec<[f64; 2]> =
        line.points.iter().map(|&(x, y)| [to_axis(x, axes[0]), to_axis(y, axes[1])]).collect();
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut end_before = None;
    for pair in points.windows(2) {
        let Some([a, b]) = clipped_segment(pair[0], pair[1], low, high) else { continue };
        let point = |p: [f64; 2]| (from_axis(p[0], axes[0]), from_axis(p[1], axes[1]));
        match pieces.last_mut().filter(|_| end_before == Some(a)) {
            Some(piece) => piece.push(point(b)),
            None => pieces.push(vec![point(a), point(b)]),
        }
        end_before = Some(b);
    }
    pieces
}

/// The part of a segment in a box (Liang and Barsky 1984).
fn clipped_segment(a: [f64; 2], b: [f64; 2], low: [f64; 2], high: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for i in 0..2 {
        if !a[i].is_finite() || !b[i].is_finite() {
            return None;
        }
        let way = b[i] - a[i];
        if way == 0.0 {
            if a[i] < low[i] || a[i] > high[i] {
                return None;
            }
            continue;
        }
        let ends = [(low[i] - a[i]) / way, (high[i] - a[i]) / way];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    let at = |t: f64| match t {
        0.0 => a,
        1.0 => b,
        t => [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])],
    };
    (from < to).then(|| [at(from), at(to)])
}

/// A mark of a logarithmic axis.
fn power(value: f64) -> String {
    let exponent = value.log10().round();
    if (value / 10.0_f64.powf(exponent) - 1.0).abs() > 1e-6 || (-2.0..=2.0).contains(&exponent) {
        return plain(value);
    }
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => c.to_digit(10).and_then(|d| char::from_u32('⁰' as u32 + d)).unwrap_or(c),
    };
    format!("10{}", exponent.to_string().chars().map(digit).collect::<String>())
}

/// A number as short as it can be.
fn plain(value: f64) -> String {
    // Marks are sums of steps: near 0 there may be a rounding left.
    if value.abs() < 1e-12 {
        return "0".into();
    }
    let text = significant(value);
    if text.contains('.') && !text.contains('e') {
        return text.trim_end_matches('0').trim_end_matches('.').into();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_short() {
        assert_eq!(
            [1e-3, 1e-10, 1e5, 0.01, 1.0, 50.0].map(power),
            ["10⁻³", "10⁻¹⁰", "10⁵", "0.01", "1", "50"]
        );
        assert_eq!([0.1 + 0.2, 1e-17, 250.0].map(plain), ["0.3", "0", "250"]);
    }

    #[test]
    fn lines_end_where_the_chart_does() {
        let axis = |log| Axis { label: String::new(), range: 1.0..100.0, log };
        let style = Style { color: [1, 2, 3], dashes: "8 4" };
        let points = vec![(1.0, 10.0), (10.0, 1000.0), (20.0, f64::NAN), (30.0, 2.0), (50.0, 3.0)];
        let line = Line { name: "a & b".into(), style, points };
        let panel = Panel {
            title: "title".into(),
            x: axis(true),
            y: axis(true),
            lines: vec![line.clone()],
            dots: vec![Dots {
                name: "dots".into(),
                color: [0; 3],
                points: vec![Dot { x: 2.0, y: 2.0, error: 5.0 }],
            }],
        };
        let pieces = clipped(&line, &panel);
        assert_eq!(pieces.len(), 2);
        let (x, y) = pieces[0][1];
        // On the straight line of the logarithms; a few roundings.
        assert!((x - 10.0_f64.sqrt()).abs() < 1e-12 && (y - 100.0).abs() < 1e-11, "{x} {y}");
        let alone = chart(&panel).unwrap();
        assert!(alone.starts_with("<svg") && alone.contains("viewBox") && !alone.contains("dots"), "{alone}");
        let svg = svg(&[panel.clone(), panel]).unwrap();
        assert!(svg.contains("stroke=\"#010203\" stroke-dasharray=\"8 4\""), "{svg}");
        assert!(svg.contains("a &amp; b") && svg.trim_end().ends_with("</svg>"));
    }
}
