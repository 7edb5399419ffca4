//! Charts of errors as inline SVG, with logarithmic axes.

use maud::{Markup, html};
use meshlod::Method;

use crate::page::figures::ROUNDING_PERCENT;
use crate::page::key::{class, key, shape};

/// Chart of the errors of simplified meshes against their number of faces or the time.
pub struct Chart {
    /// Alternative text of the chart for screen readers.
    pub alt: String,
    /// Caption below the chart.
    pub caption: &'static str,
    pub across: Across,
    pub series: Vec<Series>,
}

/// Quantity on the horizontal axis of a chart.
#[derive(Clone, Copy)]
pub enum Across {
    Faces,
    Seconds,
}

/// Data points of one method: a positive horizontal coordinate, and the error in percent.
pub struct Series {
    pub method: Method,
    pub points: Vec<[f64; 2]>,
}

/// Width and height in SVG units.
const SIZE: [f64; 2] = [440.0, 330.0];
/// Left, right, top and bottom of the plot area.
const PLOT: [f64; 4] = [58.0, 428.0, 12.0, 288.0];

/// Draws a line for each method, or a mark if there is only one level.
pub fn chart(chart: &Chart) -> Markup {
    let axes = Axes::of(chart);
    html! {
        figure.chart {
            svg viewBox=(format!("0 0 {} {}", SIZE[0], SIZE[1])) role="img" aria-label=(chart.alt) {
                (axes.grid(chart.across))
                @for series in &chart.series { (axes.line(series)) }
            }
            figcaption {
                p {
                    @for series in &chart.series {
                        span.series { (key(series.method)) (series.method.name()) } " "
                    }
                }
                p { (chart.caption) " Both axes are logarithmic." }
            }
        }
    }
}

/// Axis ranges as decimal logarithms: minimum and maximum.
struct Axes([[f64; 2]; 2]);

/// Margin between the outermost points and the sides, in decades.
const MARGIN: f64 = 0.08;
/// Smallest span of an axis, in decades, so that differences of a few percent do not look large.
const LEAST_SPAN: f64 = 0.7;

impl Axes {
    fn of(chart: &Chart) -> Self {
        let mut sides = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for place in chart.series.iter().flat_map(logarithms) {
            for (side, at) in sides.iter_mut().zip(place) {
                *side = [side[0].min(at - MARGIN), side[1].max(at + MARGIN)];
            }
        }
        Self(sides.map(|[low, high]| {
            if low > high {
                return [0.0, 1.0];
            }
            let missing = (LEAST_SPAN - (high - low)).max(0.0);
            [low - missing / 2.0, high + missing / 2.0]
        }))
    }

    fn x(&self, logarithm: f64) -> f64 {
        let [low, high] = self.0[0];
        PLOT[0] + (logarithm - low) / (high - low) * (PLOT[1] - PLOT[0])
    }

    fn y(&self, logarithm: f64) -> f64 {
        let [low, high] = self.0[1];
        PLOT[3] - (logarithm - low) / (high - low) * (PLOT[3] - PLOT[2])
    }

    /// Draws grid lines at round numbers with their labels.
    fn grid(&self, across: Across) -> Markup {
        html! {
            @for error in round_numbers(self.0[1]) {
                @let y = short(self.y(error.log10()));
                line.rule x1=(PLOT[0]) x2=(PLOT[1]) y1=(y) y2=(y) {}
                text x=(PLOT[0] - 8.0) y=(y) dy="0.32em" text-anchor="end" { (error) "%" }
            }
            line.tick x1=(PLOT[0]) x2=(PLOT[1]) y1=(PLOT[3]) y2=(PLOT[3]) {}
            @for number in round_numbers(self.0[0]) {
                @let x = short(self.x(number.log10()));
                line.tick x1=(x) x2=(x) y1=(PLOT[3]) y2=(PLOT[3] + 5.0) {}
                text x=(x) y=(PLOT[3] + 19.0) text-anchor="middle" { (across.text(number)) }
            }
            text x=(PLOT[1]) y=(PLOT[3] + 37.0) text-anchor="end" { (across.name()) }
        }
    }

    fn line(&self, series: &Series) -> Markup {
        let places: Vec<[String; 2]> =
            logarithms(series).map(|[x, y]| [short(self.x(x)), short(self.y(y))]).collect();
        let path: Vec<String> = places.iter().map(|place| place.join(",")).collect();
        html! {
            g class=(format!("series {}", class(series.method))) {
                title { (series.method.name()) }
                polyline points=(path.join(" ")) {}
                @for [x, y] in &places {
                    path d=(shape(series.method)) transform=(format!("translate({x} {y})")) {}
                }
            }
        }
    }
}

impl Across {
    fn name(self) -> &'static str {
        match self {
            Self::Faces => "faces",
            Self::Seconds => "time",
        }
    }

    fn text(self, number: f64) -> String {
        match self {
            Self::Seconds if number < 1.0 => format!("{} ms", 1000.0 * number),
            Self::Seconds => format!("{number} s"),
            Self::Faces if number < 1000.0 => number.to_string(),
            Self::Faces => format!("{}k", number / 1000.0),
        }
    }
}

/// Iterates over 1, 2, 5, 10, … between two logarithms; only powers of ten on a long range.
fn round_numbers([low, high]: [f64; 2]) -> impl Iterator<Item = f64> {
    let steps: &[u32] = if high - low < 2.5 { &[1, 2, 5] } else { &[1] };
    let decades = low.floor() as i32..=high.ceil() as i32;
    decades
        .flat_map(move |decade| steps.iter().map(move |step| format!("{step}e{decade}")))
        // Parsed from text, since a product would give 0.30000000000000004.
        .filter_map(|text| text.parse().ok())
        .filter(move |number: &f64| (low..=high).contains(&number.log10()))
}

/// Iterates over the points as logarithms, with rounding errors raised to a floor.
fn logarithms(series: &Series) -> impl Iterator<Item = [f64; 2]> {
    series.points.iter().map(|[x, error]| [x.log10(), error.max(ROUNDING_PERCENT).log10()])
}

/// Formats a length to a tenth of a unit, which is finer than a screen.
fn short(length: f64) -> String {
    format!("{length:.1}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_not_too_many() {
        assert_eq!(round_numbers([-2.1, -1.2]).collect::<Vec<_>>(), [0.01, 0.02, 0.05]);
        assert_eq!(round_numbers([2.9, 6.5]).collect::<Vec<_>>(), [1e3, 1e4, 1e5, 1e6]);
        assert_eq!(Across::Seconds.text(0.02), "20 ms");
    }

    #[test]
    fn equal_points_leave_room_around_them() {
        let series = vec![Series { method: Method::Qem, points: vec![[100.0, 0.1]; 2] }];
        let axes =
            Axes::of(&Chart { alt: String::new(), caption: "", across: Across::Faces, series });
        assert!((axes.x(2.0) - (PLOT[0] + PLOT[1]) / 2.0).abs() < 1e-9);
        assert!((axes.y(-1.0) - (PLOT[2] + PLOT[3]) / 2.0).abs() < 1e-9);
    }
}
