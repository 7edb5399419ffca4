//! Measured distances between scenes as text.

use meshlod::measure::{Bracket, CertifiedDistance, Distance, OneSidedDistance};

use crate::text::numbers;
use crate::text::table::aligned;

/// Formats the distances in each direction and combined as a table.
pub fn to_table(distance: &Distance) -> String {
    let row = |name: &str, mean: f64, rms: f64, max: f64| {
        let cell = |length| {
            [numbers::value(length), format!("({})", numbers::percent(distance.percent(length)))]
        };
        let ([a, b], [c, d], [e, f]) = (cell(mean), cell(rms), cell(max));
        [name.into(), a, b, c, d, e, f]
    };
    let way = |name, way: &OneSidedDistance| row(name, way.mean, way.rms, way.max);
    aligned(&[
        ["", "mean", "", "RMS", "", "max", ""].map(String::from),
        way("forward", &distance.forward),
        way("backward", &distance.backward),
        row("both", distance.mean(), distance.rms(), distance.max()),
    ])
}

/// Formats the bounds of the maximum distance in each direction and combined as a table.
pub fn certified_table(distance: &CertifiedDistance) -> String {
    let row = |name: &str, way: Bracket| {
        let cell = |length| {
            [numbers::value(length), format!("({})", numbers::percent(distance.percent(length)))]
        };
        let ([a, b], [c, d]) = (cell(way.lower), cell(way.upper));
        let note = if way.reached { "" } else { "limit of the search reached" };
        [name.into(), a, b, c, d, note.into()]
    };
    let table = aligned(&[
        ["max", "at least", "", "at most", "", ""].map(String::from),
        row("forward", distance.forward),
        row("backward", distance.backward),
        row("both", distance.symmetric()),
    ]);
    format!("\n{table}")
}
