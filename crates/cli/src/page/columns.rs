//! Columns in tables of measurements, shared by pages and terminal.

use meshlod::measure::Distance;

use crate::page::chain::Level;
use crate::page::counts::Counts;
use crate::page::figures::{digits, drift, power_of_ten, seconds};
use crate::text::numbers::count;

/// A measurement of simplified meshes, as the column of a table.
pub struct Column {
    pub head: &'static str,
    /// Function that returns the measurement of a level, given the counts of the original mesh;
    /// `None` if it has no such measurement.
    pub value: fn(&Counts, &Level) -> Option<f64>,
    /// Explanation of the column, empty if its heading says enough.
    pub about: &'static str,
    /// Function that formats a value of the column.
    pub text: fn(f64) -> String,
    pub best: Option<Best>,
}

/// Rule by which the best value of a column is found.
#[derive(Clone, Copy)]
pub enum Best {
    Least,
    Greatest,
    /// The value nearest to zero is best; values below the rounding error of the original mesh are
    /// equally good.
    NearestZero {
        rounding: fn(&Counts) -> f64,
    },
}

/// Relative rounding error of the volume summed over a million faces.
const ROUNDING: f64 = 1e-12;

/// Columns of measurements by which simplified meshes are compared.
pub const COLUMNS: [Column; 11] = [
    Column {
        head: "Faces",
        about: "",
        value: |_, level| Some(level.report.output_faces as f64),
        text: whole,
        best: None,
    },
    Column {
        head: "Mean",
        about: "Mean, RMS, max: measured both ways, in percent of the input’s diagonal.",
        value: |_, level| level.percent(Distance::mean),
        text: digits,
        best: Some(Best::Least),
    },
    Column {
        head: "RMS",
        about: "",
        value: |_, level| level.percent(Distance::rms),
        text: digits,
        best: Some(Best::Least),
    },
    Column {
        head: "Max",
        about: "",
        value: |_, level| level.percent(Distance::max),
        text: digits,
        best: Some(Best::Least),
    },
    Column {
        head: "Estimate",
        about: "Estimate: the method’s own estimate of the maximum.",
        value: |input, level| Some(100.0 * level.report.error_estimate / input.diagonal),
        text: digits,
        // The best estimate is the one nearest to the column before.
        best: None,
    },
    Column {
        head: "Volume",
        about: "Volume: change in percent.",
        value: |input, level| level.volume_change(input),
        text: drift,
        best: Some(Best::NearestZero { rounding: |_| 100.0 * ROUNDING }),
    },
    Column {
        head: "Sum",
        about: "Sum: volume lost, summed over all contractions with a closed ring, in cubic units; \
                what the level has been repaid is not lost.",
        // Before minus after, as in the JSON.
        value: |_, level| Some(level.report.volume.lost()),
        text: power_of_ten,
        best: Some(Best::NearestZero { rounding: |input| ROUNDING * input.volume.abs() }),
    },
    Column {
        head: "Shape",
        about: "Shape: mean triangle quality, 1 if all triangles are equilateral.",
        value: |_, level| level.quality.map(|quality| quality.mean),
        text: |mean| format!("{mean:.2}"),
        best: Some(Best::Greatest),
    },
    Column {
        head: "FLIP",
        about: "FLIP: perceived difference in twelve views of 256 by 256 pixels, 0 if there is none.",
        value: |_, level| level.flip,
        text: |flip| format!("{flip:.4}"),
        best: Some(Best::Least),
    },
    Column {
        head: "Refused",
        about: "",
        value: |_, level| Some(refused(level) as f64),
        text: whole,
        best: None,
    },
    Column {
        head: "Time",
        about: "",
        value: |_, level| Some(level.time.as_secs_f64()),
        text: seconds,
        best: Some(Best::Least),
    },
];

/// Returns sentences that explain the column headings, and why a column is missing.
pub fn legend(input: &Counts, columns: &[&Column]) -> Vec<&'static str> {
    let abouts = columns.iter().map(|column| column.about).filter(|about| !about.is_empty());
    let open = (!input.closed).then_some("The input is open and encloses no volume.");
    abouts.chain(open).collect()
}

impl Column {
    /// Returns the columns that have a value for at least one level.
    pub fn of<'l>(
        input: &Counts,
        levels: impl Iterator<Item = &'l Level> + Clone,
    ) -> Vec<&'static Self> {
        let some =
            |column: &&Self| levels.clone().any(|level| (column.value)(input, level).is_some());
        COLUMNS.iter().filter(some).collect()
    }

    /// Returns the value of a level in this column, with its formatted text.
    pub fn cell(&self, input: &Counts, level: &Level) -> Option<(f64, String)> {
        (self.value)(input, level).map(|value| (value, (self.text)(value)))
    }

    /// Returns a flag per level, true if its formatted value equals the best one in this column.
    ///
    /// Only levels that reached their size compete, since any method is near the input if it has
    /// done nothing. Nobody wins if all are equal.
    pub fn winners(&self, input: &Counts, levels: &[&Level]) -> Vec<bool> {
        let Some(best) = self.best else { return vec![false; levels.len()] };
        let of = |level: &&Level| {
            let value = (self.value)(input, level).filter(|_| level.report.reached)?;
            Some(best.size(value, input))
        };
        let values: Vec<Option<f64>> = levels.iter().map(of).collect();
        let sought = values.iter().flatten().copied().reduce(match best {
            Best::Greatest => f64::max,
            Best::Least | Best::NearestZero { .. } => f64::min,
        });
        let text = |value: f64| (self.text)(value);
        let Some(sought) = sought.map(text) else { return vec![false; levels.len()] };
        let wins: Vec<bool> =
            values.iter().map(|value| value.map(text).as_ref() == Some(&sought)).collect();
        let contested = values.iter().zip(&wins).any(|(value, &win)| value.is_some() && !win);
        if contested { wins } else { vec![false; levels.len()] }
    }
}

impl Best {
    /// Returns the part of a value that counts in the comparison.
    fn size(self, value: f64, input: &Counts) -> f64 {
        match self {
            Self::Least | Self::Greatest => value,
            Self::NearestZero { rounding } => value.abs().max(rounding(input)),
        }
    }
}

/// Returns the number of contractions that were refused in making a level.
pub fn refused(level: &Level) -> u64 {
    level.report.refusals.iter().map(|(_, count)| count).sum()
}

fn whole(number: f64) -> String {
    count(number as usize)
}

#[cfg(test)]
mod tests {
    use meshlod::samples;

    use super::*;

    #[test]
    fn what_rounding_makes_is_no_merit() {
        let input = Counts::of(&samples::sphere(500));
        for head in ["Volume", "Sum"] {
            let column = COLUMNS.iter().find(|column| column.head == head).unwrap();
            let size = |value| column.best.unwrap().size(value, &input);
            assert_eq!(size(1e-14), size(-3e-13), "{head}");
            assert!(size(-1e-6) > size(1e-9), "{head}");
        }
    }
}
