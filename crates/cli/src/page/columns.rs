//! The figures of a level as columns: one list for pages and for the terminal.

use meshlod::measure::Distance;

use crate::numbers::count;
use crate::page::counts::Counts;
use crate::page::descent::Level;
use crate::page::figures::{digits, drift, power_of_ten, seconds};

/// A figure that every level has, or may have.
pub struct Column {
    pub head: &'static str,
    /// By the counts of the input; `None` where there is no such thing.
    pub value: fn(&Counts, &Level) -> Option<f64>,
    /// What it is, where the head does not say.
    pub about: &'static str,
    /// As people read it.
    pub text: fn(f64) -> String,
    pub best: Option<Best>,
}

/// Which value is the best of a column.
#[derive(Clone, Copy)]
pub enum Best {
    Least,
    Greatest,
    /// Those below what rounding makes of this input are equally good.
    NearestZero {
        rounding: fn(&Counts) -> f64,
    },
}

/// A part of the volume that summing up a million faces rounds away.
const ROUNDING: f64 = 1e-12;

/// What levels are compared by.
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
        // The nearest to the truth would be, and that is in the column before.
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
        about: "Sum: change of the volume summed over all contractions with a closed ring, in cubic \
                units.",
        // Its sign is that of the column before; the report's is that of the paper.
        value: |_, level| Some(0.0 - level.report.volume.running_sum),
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

/// What the heads mean, and why one is missing: a sentence each.
pub fn legend(input: &Counts, columns: &[&Column]) -> Vec<&'static str> {
    let abouts = columns.iter().map(|column| column.about).filter(|about| !about.is_empty());
    let open = (!input.closed).then_some("The input is open and encloses no volume.");
    abouts.chain(open).collect()
}

impl Column {
    /// Those that at least one of the levels has a figure for.
    pub fn of<'l>(
        input: &Counts,
        levels: impl Iterator<Item = &'l Level> + Clone,
    ) -> Vec<&'static Self> {
        let some =
            |column: &&Self| levels.clone().any(|level| (column.value)(input, level).is_some());
        COLUMNS.iter().filter(some).collect()
    }

    /// What a level has here.
    pub fn cell(&self, input: &Counts, level: &Level) -> Option<(f64, String)> {
        (self.value)(input, level).map(|value| (value, (self.text)(value)))
    }

    /// For each of the levels, whether none has a better figure here, as far as the texts tell.
    ///
    /// Only levels that reached their size compete: any method is near the input where it has done
    /// nothing. Nobody wins where all are equal.
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
    /// What of a value counts.
    fn size(self, value: f64, input: &Counts) -> f64 {
        match self {
            Self::Least | Self::Greatest => value,
            Self::NearestZero { rounding } => value.abs().max(rounding(input)),
        }
    }
}

/// How often a contraction was refused on the way to a level.
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
