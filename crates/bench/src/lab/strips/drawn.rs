//! Figure 5 and table 2 of [KY05], with measurements of meshlod beside them.

use super::sent::{Levels, SentLevel};
use crate::lab::plot::{Line, Plot, page};

/// The paper's table 2, from 10 %: savings of DTFF and STSS over independent triangles, for eight.
const TABLE_2: [[f64; 2]; 10] = [
    [18.4, -72.4],
    [32.0, -11.1],
    [39.9, 14.1],
    [45.9, 29.1],
    [50.3, 40.9],
    [54.5, 48.8],
    [58.6, 55.7],
    [60.3, 58.6],
    [61.7, 61.2],
    [64.2, 64.2],
];

/// The paper's table 1: triangles + 2 · strips + swaps, in the order of the models.
const TABLE_1: [f64; 4] = [570.0, 1648.0, 10254.0, 7372.0];

/// Plots the number of vertices sent at each level, one plot per model.
pub fn figure_5(all: &[Levels]) -> String {
    let plots = all.iter().zip(TABLE_1).map(|(levels, whole)| {
        let sent = |way: usize| points(levels, |level| level.sent[way] as f64);
        let mut lines = vec![
            Line::new(
                "independent triangles",
                "#999999",
                points(levels, |l| 3.0 * l.triangles as f64),
            ),
            Line::new("STSS", "#c0392b", sent(0)),
            Line::new("DTFF", "#2471a3", sent(1)),
            Line::new("repair", "#1e8449", sent(3)),
            Line::new("the paper's strips", "#333333", vec![[100.0, whole]]),
        ];
        if levels.model() == "eight" {
            // The paper prints no numbers for the others.
            for (column, name, color) in
                [(1, "STSS, paper", "#c0392b"), (0, "DTFF, paper", "#2471a3")]
            {
                let sent = levels.levels().iter().zip(TABLE_2).map(|(level, saved)| {
                    let part = 1.0 - saved[column] / 100.0;
                    [level.percent as f64, 3.0 * level.triangles as f64 * part]
                });
                lines.push(Line::new(name, color, sent.collect()).dashed());
            }
        }
        let caption = format!("{}: vertices sent", levels.model());
        plot(caption, lines, false)
    });
    page(&plots.collect::<Vec<_>>())
}

/// Plots the percentage of vertices saved relative to independent triangles, as in table 2 of the
/// paper.
pub fn table_2(eight: &Levels) -> String {
    let ours = |way: usize| points(eight, |level| level.over_independent(way));
    let paper = |column: usize| {
        (1..).zip(TABLE_2).map(|(tenth, saved)| [10.0 * f64::from(tenth), saved[column]]).collect()
    };
    let saved = vec![
        Line::new("STSS, paper", "#c0392b", paper(1)).dashed(),
        Line::new("DTFF, paper", "#2471a3", paper(0)).dashed(),
        Line::new("STSS", "#c0392b", ours(0)),
        Line::new("DTFF", "#2471a3", ours(1)),
        Line::new("repair, quick", "#52be80", ours(2)),
        Line::new("repair", "#1e8449", ours(3)),
    ];
    page(&[plot("eight: % saved of independent triangles".into(), saved, true)])
}

fn plot(caption: String, lines: Vec<Line>, low_key: bool) -> Plot {
    Plot { caption, across: [0.0, 100.0], unit: " %", up_from: None, low_key, lines }
}

fn points(levels: &Levels, of: impl Fn(&SentLevel) -> f64) -> Vec<[f64; 2]> {
    levels.levels().iter().map(|level| [level.percent as f64, of(level)]).collect()
}
