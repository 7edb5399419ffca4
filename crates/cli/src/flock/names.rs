//! Parsers of the values that only `flock` takes.

use meshlod::flock::select::PolicyName;

use crate::options::parse;
use crate::text::numbers::count;

/// Upper limit of `--members`.
const MAX_MEMBERS: usize = 5_000_000;

/// Upper limit of `--frames`.
const MAX_FRAMES: usize = 100_000;

/// Parses the value of `--members`.
pub fn members(text: &str) -> Result<usize, String> {
    at_most(MAX_MEMBERS, text)
}

/// Parses the value of `--frames`.
pub fn frames(text: &str) -> Result<usize, String> {
    at_most(MAX_FRAMES, text)
}

/// Parses the value of `--fps`.
pub fn fps(text: &str) -> Result<f64, String> {
    match parse::number(text)? {
        fps if (0.1..=1000.0).contains(&fps) => Ok(fps),
        _ => Err("it must be between 0.1 and 1000".into()),
    }
}

/// Parses the value of `--detail`.
pub fn detail(text: &str) -> Result<f64, String> {
    match parse::number(text)? {
        detail if (1e-6..=1e6).contains(&detail) => Ok(detail),
        _ => Err("it must be between 0.000001 and 1000000".into()),
    }
}

/// Parses the value of `--impostors`.
pub fn impostors(text: &str) -> Result<f64, String> {
    match parse::number(text)? {
        px if (0.1..=10_000.0).contains(&px) => Ok(px),
        _ => Err("it must be between 0.1 and 10000".into()),
    }
}

/// Returns the help text of `--policy`.
pub fn policies() -> String {
    format!("Policy that chooses the levels: {}", policy_names())
}

fn policy_names() -> String {
    PolicyName::ALL.map(PolicyName::name).join(", ")
}

fn at_most(most: usize, text: &str) -> Result<usize, String> {
    match parse::positive(text)? {
        number if number <= most => Ok(number),
        _ => Err(format!("it must be at most {}", count(most))),
    }
}
