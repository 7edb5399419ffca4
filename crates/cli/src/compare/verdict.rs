//! Verdict of a comparison: which method came closest at a size and what that costs, which was
//! fastest, and by how much.

use meshlod::Method;
use meshlod::measure::Distance;
use serde_json::{Value, json};

use crate::compare::comparison::ComparisonResult;
use crate::options::parse::LevelSize;
use crate::page::chain::Level;
use crate::page::figures::{digits, seconds};

/// Relative difference up to which two figures count as equal: a distance from 100,000 samples is
/// repeated within 0.2 %, and a time on an idle machine within one.
const EQUAL: f64 = 0.01;

/// Distance in percent of the diagonal below which methods are as exact as rounding lets them be.
const EXACT: f64 = 1e-7;

/// Ranking of the methods by their levels of one size.
pub struct Verdict {
    size: LevelSize,
    /// RMS distances in percent of the diagonal.
    closest: Option<Contest>,
    /// Times in seconds.
    fastest: Option<Contest>,
}

/// Figures of methods, the smallest first; there is at least one.
struct Contest(Vec<(Method, f64)>);

impl ComparisonResult {
    /// Iterates over the verdicts on all sizes that some method came to, with their indices.
    pub fn verdicts(&self, sizes: &[LevelSize]) -> impl Iterator<Item = (usize, Verdict)> {
        self.sizes(sizes).map(|(index, &size)| (index, Verdict::of(self, index, size)))
    }
}

impl Verdict {
    /// Compares the levels of one size. Only those that reached it compete, since any method is near
    /// the input if it has done nothing.
    pub fn of(outcome: &ComparisonResult, index: usize, size: LevelSize) -> Self {
        let figures = |figure: fn(&Level) -> Option<f64>| {
            let reached = outcome.at(index).filter(|(_, level)| level.report.reached);
            let figures = reached.filter_map(|(entry, level)| {
                Some((entry.chain.method, figure(level)?)).filter(|(_, figure)| figure.is_finite())
            });
            Contest::of(figures.collect())
        };
        Self {
            size,
            closest: figures(|level| level.percent(Distance::rms)),
            fastest: figures(|level| Some(level.time.as_secs_f64())),
        }
    }

    /// Returns the methods that won, with their figures, as JSON; `null` where none reached the size,
    /// or several are exact.
    pub fn json(&self) -> Value {
        let json = |contest: Option<&Contest>, unit: &str| {
            contest.map(|Contest(order)| json!({ "method": order[0].0, unit: order[0].1 }))
        };
        json!({
            "size": self.size.to_string(),
            "closest": json(self.closest.as_ref().filter(|of| of.exact() < 2), "rms_percent"),
            "fastest": json(self.fastest.as_ref(), "simplify_seconds"),
            "sentence": self.sentence(),
        })
    }

    /// Says in one sentence which method came closest and which was fastest.
    pub fn sentence(&self) -> String {
        let size = self.size;
        let (Some(closest), Some(fastest)) = (&self.closest, &self.fastest) else {
            return match &self.fastest {
                None => format!("At {size}, no method reached the size."),
                Some(_) => format!("At {size}, no distance could be measured."),
            };
        };
        if let ([(method, rms)], [(_, time)]) = (&closest.0[..], &fastest.0[..]) {
            let (rms, time) = (digits(*rms), seconds(*time));
            return format!(
                "At {size}, {} has an RMS error of {rms}% and takes {time}.",
                named(*method)
            );
        }
        let both = closest.exact() < 2 && closest.0[0].0 == fastest.0[0].0;
        // Of a method that is also fastest, the second half says how fast it is.
        let cost = if both { String::new() } else { closest.cost(fastest) };
        let [closest, fastest] = [closest.closest(), fastest.fastest(both)];
        format!("At {size}, {closest}{cost}, and {fastest}.")
    }
}

impl Contest {
    /// Sorts figures of methods; equal ones keep the order of [`Method::ALL`]. `None` without any.
    fn of(mut figures: Vec<(Method, f64)>) -> Option<Self> {
        figures.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        (!figures.is_empty()).then_some(Self(figures))
    }

    /// Returns the method to compare the winner with: the default if it is there and did not win,
    /// else the second.
    fn rival(&self) -> Option<(Method, f64)> {
        let rest = &self.0[1..];
        rest.iter().find(|(method, _)| is_default(*method)).or(rest.first()).copied()
    }

    /// Counts the methods whose distance is nothing but rounding.
    fn exact(&self) -> usize {
        self.0.iter().filter(|(_, rms)| *rms < EXACT).count()
    }

    fn closest(&self) -> String {
        let (method, rms) = self.0[0];
        let exact = self.exact();
        if exact > 1 {
            let who = if exact == self.0.len() { "all".into() } else { exact.to_string() };
            return format!("{who} methods keep the shape up to rounding");
        }
        let text = format!("{} is closest with an RMS error of {}%", named(method), digits(rms));
        match self.rival() {
            None => text,
            Some((rival, other)) if is_equal(rms, other) => {
                format!("{text}, hardly less than {}", named(rival))
            }
            Some((rival, other)) => {
                let less = 100.0 * (1.0 - rms / other);
                format!("{text}, {less:.0}% less than {}", named(rival))
            }
        }
    }

    /// Says how long the closest method takes, compared with the rival that has just been named;
    /// `times` are the seconds of the methods. Empty if no rival has been.
    fn cost(&self, times: &Contest) -> String {
        let Some((rival, _)) = self.rival().filter(|_| self.exact() < 2) else {
            return String::new();
        };
        match (times.of_method(self.0[0].0), times.of_method(rival)) {
            (Some(own), Some(other)) if is_equal(own.min(other), own.max(other)) => {
                " in the same time".into()
            }
            (Some(own), Some(other)) if own > other => {
                format!(" at {} times its time", factor(own / other))
            }
            (Some(own), Some(other)) => format!(" in {:.2} of its time", own / other),
            _ => String::new(),
        }
    }

    /// Returns the figure of a method.
    fn of_method(&self, wanted: Method) -> Option<f64> {
        self.0.iter().find(|(method, _)| *method == wanted).map(|(_, figure)| *figure)
    }

    /// Says which method was fastest; `is_same` if it has just been named.
    fn fastest(&self, is_same: bool) -> String {
        let (method, time) = self.0[0];
        let subject = if is_same { "it is also".into() } else { format!("{} is", named(method)) };
        let text = format!("{subject} fastest with {}", seconds(time));
        match self.rival() {
            None => text,
            Some((rival, other)) if is_equal(time, other) => {
                format!("{text}, about as long as {} takes", named(rival))
            }
            Some((rival, other)) => {
                format!("{text}, {} times as fast as {}", factor(other / time), named(rival))
            }
        }
    }
}

/// Returns whether a method is the one that `simplify` uses unless told otherwise.
pub fn is_default(method: Method) -> bool {
    method == Method::default()
}

fn is_equal(least: f64, other: f64) -> bool {
    other - least <= EQUAL * other
}

/// Returns the name of a method, with a mark at the default.
pub fn named(method: Method) -> String {
    let default = if is_default(method) { " (default)" } else { "" };
    format!("{}{default}", method.name())
}

/// Formats a factor above one with two or three digits.
fn factor(factor: f64) -> String {
    match factor {
        _ if factor < 1.995 => format!("{factor:.2}"),
        _ if factor < 9.95 => format!("{factor:.1}"),
        _ => format!("{factor:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sentence(rms: &[(Method, f64)], seconds: &[(Method, f64)]) -> String {
        let [closest, fastest] = [rms, seconds].map(|figures| Contest::of(figures.to_vec()));
        Verdict { size: LevelSize::Ratio(0.1), closest, fastest }.sentence()
    }

    #[test]
    fn the_winner_is_compared_with_the_default_and_the_default_with_the_next() {
        let others = (Method::Qem, Method::LeeJang);
        let rms = [(others.0, 0.02), (others.1, 0.04), (Method::LindstromTurk, 0.016)];
        let seconds = [(others.0, 0.045), (others.1, 0.05), (Method::LindstromTurk, 0.09)];
        assert_eq!(
            sentence(&rms, &seconds),
            "At 10%, lindstrom-turk (default) is closest with an RMS error of 0.0160%, 20% less \
             than qem at 2.0 times its time, and qem is fastest with 45.0 ms, 2.0 times as fast as lindstrom-turk (default)."
        );
    }

    #[test]
    fn what_the_closest_method_costs_is_said_beside_the_default() {
        let default = Method::default();
        let rms = [(Method::Pm, 0.9), (default, 1.0), (Method::Qem, 1.2)];
        let at = |pm: f64| sentence(&rms, &[(Method::Qem, 1.0), (default, 2.0), (Method::Pm, pm)]);
        let start = "At 10%, pm is closest with an RMS error of 0.900%, 10% less than \
                     lindstrom-turk (default)";
        let end =
            ", and qem is fastest with 1.00 s, 2.0 times as fast as lindstrom-turk (default).";
        for (seconds, cost) in [
            (74.0, " at 37 times its time"),
            (2.01, " in the same time"),
            (1.5, " in 0.75 of its time"),
        ] {
            let text = at(seconds);
            let said = text.strip_prefix(start).and_then(|text| text.strip_suffix(end));
            assert_eq!(said, Some(cost), "{text}");
        }
    }

    #[test]
    fn what_hardly_differs_is_no_victory() {
        let equal = [(Method::Qem, 1.0), (Method::LeeJang, 1.005)];
        assert_eq!(
            sentence(&equal, &equal),
            "At 10%, qem is closest with an RMS error of 1.00%, hardly less than lee-jang, and it is \
             also fastest with 1.00 s, about as long as lee-jang takes."
        );
        // Rounding is no victory either.
        let mut exact = vec![(Method::Qem, 0.0), (Method::LeeJang, 2e-9)];
        let text = sentence(&exact, &equal);
        assert!(text.starts_with("At 10%, all methods keep the shape up to rounding, and qem is"));
        exact.push((Method::Wu, 1.0));
        assert!(sentence(&exact, &equal).contains("2 methods keep the shape up to rounding"));
    }

    #[test]
    fn one_method_alone_has_no_rival_and_none_no_verdict() {
        let one = [(Method::Qem, 1.0)];
        assert_eq!(sentence(&one, &one), "At 10%, qem has an RMS error of 1.00% and takes 1.00 s.");
        assert_eq!(sentence(&[], &[]), "At 10%, no method reached the size.");
        assert_eq!(sentence(&[], &one), "At 10%, no distance could be measured.");
    }
}
