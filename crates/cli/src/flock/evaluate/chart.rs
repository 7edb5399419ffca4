//! Curves of arms as inline SVG.

use maud::{Markup, html};

/// Chart of a few curves.
pub struct CurveChart<'a> {
    pub alt: &'a str,
    pub caption: String,
    pub curves: Vec<Curve>,
    /// Names of the axes, across and up.
    pub axes: [&'a str; 2],
    /// Whether each axis is logarithmic.
    pub logarithmic: [bool; 2],
}

/// Curve with its name.
pub struct Curve {
    pub name: String,
    pub points: Vec<[f64; 2]>,
}

/// Width and height in SVG units, and left, right, top and bottom of the plot area.
const SIZE: [f64; 2] = [440.0, 330.0];
const PLOT: [f64; 4] = [64.0, 428.0, 12.0, 288.0];

/// Draws the curves; their colours repeat after nine.
pub fn chart(chart: &CurveChart<'_>) -> Markup {
    let ranges = [0, 1].map(|axis| range(chart, axis));
    let x = |value: f64| place(ranges[0], chart.logarithmic[0], value, [PLOT[0], PLOT[1]]);
    let y = |value: f64| place(ranges[1], chart.logarithmic[1], value, [PLOT[3], PLOT[2]]);
    html! {
        figure.chart {
            svg viewBox=(format!("0 0 {} {}", SIZE[0], SIZE[1])) role="img" aria-label=(chart.alt) {
                @for value in ticks(ranges[1], chart.logarithmic[1]) {
                    @let at = format!("{:.1}", y(value));
                    line.rule x1=(PLOT[0]) x2=(PLOT[1]) y1=(at) y2=(at) {}
                    text x=(PLOT[0] - 8.0) y=(at) dy="0.32em" text-anchor="end" { (short(value)) }
                }
                line.tick x1=(PLOT[0]) x2=(PLOT[1]) y1=(PLOT[3]) y2=(PLOT[3]) {}
                @for value in ticks(ranges[0], chart.logarithmic[0]) {
                    @let at = format!("{:.1}", x(value));
                    line.tick x1=(at) x2=(at) y1=(PLOT[3]) y2=(PLOT[3] + 5.0) {}
                    text x=(at) y=(PLOT[3] + 19.0) text-anchor="middle" { (short(value)) }
                }
                text x=(PLOT[1]) y=(PLOT[3] + 37.0) text-anchor="end" { (chart.axes[0]) }
                text x=(PLOT[0]) y=(PLOT[2]) dy="0.6em" dx="6" { (chart.axes[1]) }
                @for (i, curve) in chart.curves.iter().enumerate() {
                    @let points: Vec<String> = curve.points.iter()
                        .map(|p| format!("{:.1},{:.1}", x(p[0]), y(p[1]))).collect();
                    g style=(format!("color: var(--m{})", i % 9)) {
                        title { (curve.name) }
                        polyline points=(points.join(" ")) fill="none" stroke="currentColor"
                            stroke-width="1.6" {}
                    }
                }
            }
            figcaption {
                p {
                    @for (i, curve) in chart.curves.iter().enumerate() {
                        span.series {
                            span style=(format!("color: var(--m{})", i % 9)) { "■ " } (curve.name)
                        } " "
                    }
                }
                p { (chart.caption) }
            }
        }
    }
}

/// Returns the least and greatest value of an axis, as logarithms if it is logarithmic.
fn range(chart: &CurveChart<'_>, axis: usize) -> [f64; 2] {
    let is_logarithmic = chart.logarithmic[axis];
    let values = chart.curves.iter().flat_map(|curve| &curve.points).map(|point| point[axis]);
    let values = values.filter(|value| value.is_finite() && (*value > 0.0 || !is_logarithmic));
    let scaled = values.map(|value| if is_logarithmic { value.log10() } else { value });
    let start = if is_logarithmic { [f64::INFINITY, f64::NEG_INFINITY] } else { [0.0, 0.0] };
    let [low, high] = scaled.fold(start, |[low, high], v| [low.min(v), high.max(v)]);
    if low < high { [low, high + 0.03 * (high - low)] } else { [0.0, 1.0] }
}

fn place([low, high]: [f64; 2], is_logarithmic: bool, value: f64, [from, to]: [f64; 2]) -> f64 {
    let value = if is_logarithmic { value.max(1e-12).log10() } else { value };
    from + ((value - low) / (high - low)).clamp(0.0, 1.0) * (to - from)
}

/// Returns round values along an axis.
fn ticks([low, high]: [f64; 2], is_logarithmic: bool) -> Vec<f64> {
    if is_logarithmic {
        let decades = low.floor() as i32..=high.ceil() as i32;
        let steps: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let values = decades.flat_map(|d| steps.iter().map(move |step| step * 10f64.powi(d)));
        return values.filter(|value| (low..=high).contains(&value.log10())).collect();
    }
    let rough = (high - low) / 5.0;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|s| s * decade).find(|s| *s >= rough);
    let step = step.unwrap_or(rough);
    (0..=6).map(|i| f64::from(i) * step).filter(|value| (low..=high).contains(value)).collect()
}

fn short(value: f64) -> String {
    match value.abs() {
        size if size >= 1e6 => format!("{}M", (value / 1e4).round() / 100.0),
        size if size >= 1e3 => format!("{}k", (value / 10.0).round() / 100.0),
        _ => format!("{}", (value * 1e4).round() / 1e4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks([0.0, 600_000.0], false).len(), 4);
        assert_eq!(ticks([-2.0, -1.0], true).len(), 4);
        assert_eq!([0.02, 12_000.0, 2.5e6].map(short), ["0.02", "12k", "2.5M"]);
    }
}
