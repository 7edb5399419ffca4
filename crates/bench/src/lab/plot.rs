//! Line plots as small SVG files.

use std::fmt::Write;

/// A line plot with its axes and lines.
pub struct Plot {
    pub caption: String,
    /// Lowest and highest value on the horizontal axis.
    pub across: [f64; 2],
    /// Unit written after each number on the horizontal axis.
    pub unit: &'static str,
    /// Value at which the vertical axis starts, lowered if data lies below; `None` starts it at
    /// zero.
    pub up_from: Option<f64>,
    /// True to place the legend at the lower right.
    pub low_key: bool,
    pub lines: Vec<Line>,
}

/// A named line of a plot, drawn as a dot if it has a single point.
pub struct Line {
    name: &'static str,
    color: &'static str,
    dashed: bool,
    points: Vec<[f64; 2]>,
}

impl Line {
    pub fn new(name: &'static str, color: &'static str, points: Vec<[f64; 2]>) -> Self {
        Self { name, color, dashed: false, points }
    }

    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }
}

/// Size of a plot, and the rectangle of its lines: left, right, top, bottom.
const SIZE: [f64; 2] = [380.0, 300.0];
const INNER: [f64; 4] = [52.0, 358.0, 28.0, 268.0];
/// Line height of the legend.
const STEP: f64 = 15.0;

/// Lays out several plots as one SVG picture, two to a row.
pub fn page(plots: &[Plot]) -> String {
    let columns = plots.len().min(2);
    let [width, height] = [SIZE[0] * columns as f64, SIZE[1] * plots.len().div_ceil(2) as f64];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (i, plot) in plots.iter().enumerate() {
        let [x, y] = [SIZE[0] * (i % 2) as f64, SIZE[1] * (i / 2) as f64];
        let _ = writeln!(svg, "<g transform=\"translate({x} {y})\">\n{}</g>", plot.svg());
    }
    svg + "</svg>\n"
}

impl Plot {
    fn svg(&self) -> String {
        let values = || self.lines.iter().flat_map(|line| &line.points).map(|point| point[1]);
        let low = values().fold(self.up_from.unwrap_or(0.0), f64::min);
        let high = values().fold(low, f64::max);
        let step = step(high - low);
        let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
        let [left, right, top, bottom] = INNER;
        let [from, to] = self.across;
        let x = |at: f64| left + (right - left) * (at - from) / (to - from);
        let y = |value: f64| bottom - (bottom - top) * (value - low) / (high - low);
        let mut svg =
            format!("<text x=\"{left}\" y=\"16\" font-weight=\"bold\">{}</text>\n", self.caption);
        for i in 0..=((high - low) / step).round() as u32 {
            let value = low + f64::from(i) * step;
            let _ = writeln!(
                svg,
                "<path d=\"M{left} {y:.1}H{right}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{}</text>",
                left - 5.0,
                y(value) + 4.0,
                rounded(value),
                y = y(value),
            );
        }
        for i in 0..=5 {
            let at = from + (to - from) * f64::from(i) / 5.0;
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{}{}</text>",
                x(at),
                bottom + 16.0,
                rounded(at),
                self.unit
            );
        }
        for (i, line) in self.lines.iter().enumerate() {
            let places: Vec<[f64; 2]> = line.points.iter().map(|p| [x(p[0]), y(p[1])]).collect();
            svg += &line.svg(&places);
            let (key_left, key_top) = match self.low_key {
                true => {
                    (left + (right - left) * 0.55, bottom - 10.0 - STEP * self.lines.len() as f64)
                }
                false => (left + 8.0, top),
            };
            let at = key_top + 10.0 + STEP * i as f64;
            svg += &line.svg(&[[key_left, at - 4.0], [key_left + 20.0, at - 4.0]]);
            let _ =
                writeln!(svg, "<text x=\"{}\" y=\"{at}\">{}</text>", key_left + 26.0, line.name);
        }
        svg
    }
}

impl Line {
    /// Draws the line through these points of the picture.
    fn svg(&self, places: &[[f64; 2]]) -> String {
        let Self { color, .. } = self;
        if let ([[x, y]], _) | ([[x, y], _], 1) = (places, self.points.len()) {
            return format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>\n");
        }
        let dashes = if self.dashed { " stroke-dasharray=\"4 3\"" } else { "" };
        let places: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\"{dashes}/>\n",
            places.join(" ")
        )
    }
}

/// Removes floating-point noise.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// Returns a round step that divides a range into four to eight.
fn step(range: f64) -> f64 {
    let decade = 10f64.powf((range / 4.0).log10().floor());
    let times = [5.0, 2.0, 1.0].into_iter().find(|times| range / (decade * times) >= 4.0);
    decade * times.unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (range, expected) in
            [(4.0, 1.0), (9.0, 2.0), (25.0, 5.0), (137.0, 20.0), (20_000.0, 5000.0)]
        {
            assert_eq!(step(range), expected, "{range}");
        }
    }

    #[test]
    fn a_line_and_a_dot_are_drawn() {
        let lines = vec![
            Line::new("a", "#111111", vec![[10.0, 1.0], [100.0, 2.0]]).dashed(),
            Line::new("b", "#222222", vec![[100.0, 2.0]]),
        ];
        let svg = page(&[Plot {
            across: [0.0, 100.0],
            unit: "",
            up_from: None,
            low_key: true,
            caption: "c".into(),
            lines,
        }]);
        assert_eq!(svg.matches("<circle").count(), 2, "the dot and its key");
        assert_eq!(svg.matches("stroke-dasharray").count(), 2);
    }
}
