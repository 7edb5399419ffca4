//! Graphs of the last frames.

use egui::{Color32, RichText, Ui, vec2};
use egui_plot::{GridMark, Line, Plot, PlotPoints};

use super::app::SchoolApp;
use crate::SchoolFrame;
use crate::viewer::theme;

/// Height of the graphs without their titles, in points.
const HEIGHT: f32 = 118.0;
/// Colour of what is compared with.
const OTHER: Color32 = Color32::from_rgb(120, 126, 136);
const THIRD: Color32 = Color32::from_rgb(232, 178, 92);

/// Curve of a graph: its name, its colour, and its value in a frame.
struct Curve {
    name: &'static str,
    color: Color32,
    value: fn(&SchoolFrame) -> f64,
}

struct Graph {
    title: &'static str,
    curves: &'static [Curve],
    /// Values that are always in sight.
    include: &'static [f64],
}

const GRAPHS: [Graph; 4] = [
    Graph {
        title: "Faces",
        curves: &[
            Curve { name: "full detail", color: OTHER, value: |f| f.full_triangles as f64 },
            Curve { name: "drawn", color: theme::ACCENT, value: |f| f.triangles as f64 },
        ],
        include: &[0.0],
    },
    Graph {
        title: "Milliseconds",
        curves: &[
            Curve { name: "frame", color: OTHER, value: |f| f.frame_ms },
            Curve { name: "simulation", color: THIRD, value: |f| f.simulate_ms },
            Curve { name: "selection", color: theme::ACCENT, value: |f| f.select_ms },
        ],
        include: &[0.0],
    },
    Graph {
        title: "Speed over the leader's",
        curves: &[Curve {
            name: "mean",
            color: theme::ACCENT,
            value: |f| f64::from(f.relative_speed),
        }],
        include: &[0.8, 1.2],
    },
    Graph {
        title: "Heading agreement",
        curves: &[Curve { name: "mean", color: theme::ACCENT, value: |f| f64::from(f.agreement) }],
        include: &[0.0, 1.05],
    },
];

/// Shows all graphs side by side.
pub(crate) fn show(app: &SchoolApp, ui: &mut Ui) {
    let Some(show) = &app.show else { return };
    let frames: Vec<SchoolFrame> = show.history().frames().skip(1).copied().collect();
    ui.columns(GRAPHS.len(), |columns| {
        for (ui, graph) in columns.iter_mut().zip(&GRAPHS) {
            titled(ui, graph, &frames);
        }
    });
}

fn titled(ui: &mut Ui, graph: &Graph, frames: &[SchoolFrame]) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        ui.label(RichText::new(graph.title).size(12.0).strong().color(theme::STRONG));
        for curve in graph.curves {
            let value = frames.last().map(|frame| short((curve.value)(frame)));
            let text = format!("{} {}", curve.name, value.unwrap_or_default());
            ui.label(RichText::new(text).size(11.0).color(curve.color));
        }
    });
    let width = ui.available_width();
    let plot = Plot::new(graph.title)
        .height(HEIGHT)
        .width(width)
        .show_x(false)
        .show_axes([false, true])
        .show_grid([false, true])
        .y_axis_min_width(34.0)
        .y_axis_formatter(|mark: GridMark, _| short(mark.value))
        .set_margin_fraction(vec2(0.0, 0.06))
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false);
    let plot = graph.include.iter().fold(plot, |plot, &y| plot.include_y(y));
    plot.show(ui, |plot| {
        for curve in graph.curves {
            let at = |(i, frame): (usize, &SchoolFrame)| [i as f64, (curve.value)(frame)];
            let points: PlotPoints<'_> = frames.iter().enumerate().map(at).collect();
            plot.line(Line::new(curve.name, points).color(curve.color).width(1.5));
        }
    });
}

/// Formats a number with about three digits.
fn short(value: f64) -> String {
    match value.abs() {
        1e6.. => format!("{:.2} M", value / 1e6),
        1e4.. => format!("{:.0} k", value / 1e3),
        1e3.. => format!("{:.1} k", value / 1e3),
        100.0.. => format!("{value:.0}"),
        10.0.. => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let all = [0.0, 0.987, 16.66, 250.0, 3_984.0, 12_400.0, 8_000_000.0].map(short);
        assert_eq!(all, ["0.00", "0.99", "16.7", "250", "4.0 k", "12 k", "8.00 M"]);
    }
}
