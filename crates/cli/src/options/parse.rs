//! Parsers of command-line values, whose error messages say what is expected.

use std::fmt;

pub use meshlod::Bound;
use meshlod::{Format, Method, Target};

pub use crate::options::number::{bytes, number, whole};
use crate::options::number::{is_end_of_thousands, metres, without_separators};
use crate::text::numbers::{count, plural, value};

/// Requested size of a simplified mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LevelSize {
    /// Number of faces.
    Faces(usize),
    /// Ratio of the number of faces of the input, from 0 to 1.
    Ratio(f64),
}

impl LevelSize {
    pub fn target(self) -> Target {
        match self {
            Self::Faces(faces) => Target::Faces(faces),
            Self::Ratio(ratio) => Target::Ratio(ratio),
        }
    }

    /// Returns the number of faces, if that is what is asked for.
    pub fn faces(&self) -> Option<usize> {
        match self {
            Self::Faces(faces) => Some(*faces),
            Self::Ratio(_) => None,
        }
    }

    /// Formats the size for use in a file name: `10` for 10%, `500-faces`.
    pub fn in_file_names(self) -> String {
        self.to_string().replace('%', "").replace(' ', "-")
    }
}

impl fmt::Display for LevelSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Faces(faces) => write!(f, "{faces} face{}", plural(*faces)),
            // Rounded so that 12.5% does not print as 12.500000000000002%.
            Self::Ratio(ratio) => write!(f, "{}%", (ratio * 1e8).round() / 1e6),
        }
    }
}

/// Suffix of a file format.
#[derive(Clone, Debug, PartialEq)]
pub struct Suffix {
    /// The suffix, without a dot.
    pub text: String,
    /// Format of a mesh; `None` for files of our own and pictures.
    pub mesh: Option<Format>,
}

/// Suffixes of files that are written, but neither read nor written through a pipe as meshes.
const OTHER_SUFFIXES: [&str; 4] = ["mlod", "mlq", "mlz", "png"];

/// Viewing direction, as the name of a side or as a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewDirection {
    /// Viewing direction from a named side of the model, in coordinates with y up.
    From([f64; 3]),
    /// Viewing direction given as a vector.
    Along([f64; 3]),
}

/// Upper limit of `--threads`: more than machines can use, fewer than would exhaust one.
const MAX_THREADS: usize = 256;

/// Upper limit of `--samples`: these fit in the memory of a common machine.
const MAX_SAMPLES: usize = 100_000_000;

/// Parses a ratio: `10%` or `0.1`.
pub fn ratio(text: &str) -> Result<f64, String> {
    let ratio = match text.trim().strip_suffix('%') {
        Some(percent) => number(percent)? / 100.0,
        None => number(text)?,
    };
    match ratio {
        _ if (0.0..=1.0).contains(&ratio) => Ok(ratio),
        _ if text.ends_with('%') => Err("it must be between 0% and 100%".into()),
        _ if (1.0..=100.0).contains(&ratio) => {
            Err(format!("it must be between 0 and 1; did you mean {}%?", text.trim()))
        }
        _ => Err("it must be between 0 and 1, or between 0% and 100%".into()),
    }
}

/// Parses a ratio of the faces; says where a number of faces belongs.
pub fn ratio_of_faces(text: &str) -> Result<f64, String> {
    ratio(text).map_err(|reason| match whole(text) {
        Ok(faces) if faces > 100 => {
            format!("it is a ratio of the faces; did you mean --faces {text}?")
        }
        Err(_) if number(text.trim_end_matches('%')).is_err() => {
            format!("{reason}; a ratio is written 10% or 0.1")
        }
        _ => reason,
    })
}

/// Parses a number of faces; says where a ratio belongs.
pub fn faces(text: &str) -> Result<usize, String> {
    whole(text).map_err(|reason| match ratio(text) {
        _ if is_end_of_thousands(text) || without_separators(text).is_some() => reason,
        Ok(_) => format!("it is a number of faces; did you mean --ratio {text}?"),
        Err(_) => reason,
    })
}

/// Parses a length: `0.5` in model units, or `0.1%` of the diagonal.
pub fn bound(text: &str) -> Result<Bound, String> {
    match text.strip_suffix('%') {
        Some(percent) => Ok(Bound::OfDiagonal(length(percent)? / 100.0)),
        None => Ok(Bound::Length(length(text)?)),
    }
}

/// Parses a level size: `50%` or `0.5` of the faces, or `5000` faces.
pub fn size(text: &str) -> Result<LevelSize, String> {
    match (whole(text), ratio(text)) {
        (Ok(faces), _) => Ok(LevelSize::Faces(faces)),
        (Err(reason), _) if is_end_of_thousands(text) => Err(reason),
        (_, Ok(ratio)) => Ok(LevelSize::Ratio(ratio)),
        (Err(reason), _) if without_separators(text).is_some() => Err(reason),
        (_, Err(reason)) => Err(reason),
    }
}

/// Parses a finite length of at least 0.
pub fn length(text: &str) -> Result<f64, String> {
    match number(text) {
        Ok(length) if length >= 0.0 => Ok(length),
        Ok(_) => Err("it must be at least 0".into()),
        Err(reason) => Err(unit_of_length(text).unwrap_or(reason)),
    }
}

/// Says what to give in place of a length with a unit that is not read.
fn unit_of_length(text: &str) -> Option<String> {
    if let Some(metres) = metres(text) {
        let metres = value(metres);
        return Some(format!("give it in model units; in glTF, whose unit is the metre, {metres}"));
    }
    let px = text.strip_suffix("px")?;
    number(px)
        .is_ok()
        .then(|| "a length has no pixels: give a percentage of the diagonal, such as 0.1%".into())
}

/// Parses an angle of at least 0 in degrees: `5`, `5deg` or `5°`.
pub fn degrees(text: &str) -> Result<f64, String> {
    length(text.trim_end_matches("deg").trim_end_matches('°'))
}

/// Parses a weight of at least 0.
pub fn weight(text: &str) -> Result<f64, String> {
    length(text)
}

/// Parses a whole number of at least 1.
pub fn positive(text: &str) -> Result<usize, String> {
    match whole(text) {
        Ok(number) if number > 0 => Ok(number),
        Err(reason) if without_separators(text).is_some() => Err(reason),
        _ => Err("it must be a whole number of at least 1".into()),
    }
}

/// Parses the value of `--threads`.
pub fn threads(text: &str) -> Result<usize, String> {
    at_most(MAX_THREADS, text).map_err(|reason| format!("{reason}; all cores are the default"))
}

/// Parses the value of `--samples`.
pub fn samples(text: &str) -> Result<usize, String> {
    at_most(MAX_SAMPLES, text)
}

/// Parses a picture size in pixels: `640x480`.
pub fn pixels(text: &str) -> Result<[u32; 2], String> {
    let sides =
        text.split_once(['x', 'X', '*']).map(|(width, height)| (width.parse(), height.parse()));
    let allowed = 1..=meshlod::picture::MAX_SIDE;
    match sides {
        Some((Ok(w), Ok(h))) if allowed.contains(&w) && allowed.contains(&h) => Ok([w, h]),
        _ => Err(format!(
            "expected a size like 640x480, with sides of up to {} pixels",
            allowed.end()
        )),
    }
}

/// Parses a side of the model by name, or a viewing direction `x,y,z`.
pub fn view_direction(text: &str) -> Result<ViewDirection, String> {
    const NAMED: [(&str, [f64; 3]); 6] = [
        ("front", [0.0, 0.0, -1.0]),
        ("back", [0.0, 0.0, 1.0]),
        ("left", [1.0, 0.0, 0.0]),
        ("right", [-1.0, 0.0, 0.0]),
        ("top", [0.0, -1.0, 0.0]),
        ("bottom", [0.0, 1.0, 0.0]),
    ];
    if let Some((_, direction)) = NAMED.iter().find(|(name, _)| *name == text) {
        return Ok(ViewDirection::From(*direction));
    }
    let numbers: Result<Vec<f64>, String> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if [x, y, z] != [0.0; 3] => Ok(ViewDirection::Along([x, y, z])),
        _ => Err("expected front, back, left, right, top, bottom or a direction x,y,z".into()),
    }
}

/// Returns the help text of `--method`.
pub fn methods() -> String {
    format!("Simplification method: {}; the verb compare shows which suits a mesh", names())
}

fn names() -> String {
    Method::ALL.map(Method::name).join(", ")
}

/// Parses a suffix, such as `ply`.
pub fn suffix(text: &str) -> Result<Suffix, String> {
    let text = &*text.trim_start_matches('.').to_ascii_lowercase();
    let meshes = Format::ALL.map(|(suffix, _)| suffix);
    match Format::of_suffix(text) {
        None if !OTHER_SUFFIXES.contains(&text) => {
            Err(format!("the formats are {}", [&meshes[..], &OTHER_SUFFIXES].concat().join(", ")))
        }
        mesh => Ok(Suffix { text: text.into(), mesh }),
    }
}

fn at_most(most: usize, text: &str) -> Result<usize, String> {
    match positive(text)? {
        number if number <= most => Ok(number),
        _ => Err(format!("it must be at most {}", count(most))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_come_with_and_without_percent() {
        assert_eq!((ratio("10%"), ratio("0.1"), ratio("1")), (Ok(0.1), Ok(0.1), Ok(1.0)));
        assert!(ratio("10").unwrap_err().contains("10%"));
        for bad in ["", "%", "-1%", "101%", "nan", "ten", "inf"] {
            assert!(ratio(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_number_for_the_other_option_is_told_which() {
        let reason = |parsed: Result<String, String>| parsed.unwrap_err();
        let ratio = |text| reason(ratio_of_faces(text).map(|ratio| ratio.to_string()));
        let faces = |text| reason(faces(text).map(|faces| faces.to_string()));
        assert!(ratio("10k").contains("--faces 10k") && ratio("5000").contains("--faces 5000"));
        assert!(ratio("10").ends_with("10%?") && ratio("1/10").contains("10% or 0.1"));
        assert!(faces("10%").contains("--ratio 10%") && faces("0.1").contains("--ratio 0.1"));
        assert!(faces("10,000").contains("10000") && faces("ten").contains("5k"));
    }

    #[test]
    fn lengths_with_units_are_told_their_number() {
        assert!(length("1mm").unwrap_err().ends_with("metre, 0.001"));
        assert!(bound("2px").unwrap_err().contains("0.1%"));
        assert_eq!((degrees("5deg"), degrees("5°"), degrees("5")), (Ok(5.0), Ok(5.0), Ok(5.0)));
    }

    #[test]
    fn bounds_are_lengths_or_parts_of_the_diagonal() {
        assert_eq!(bound("0.5").unwrap().length(20.0), 0.5);
        assert_eq!(bound("0.1%").unwrap().length(20.0), 0.02);
        assert!(bound("-0.1%").is_err() && bound("inf").is_err());
    }

    #[test]
    fn sizes_print_as_they_are_written() {
        for text in ["50%", "12.5%", "0.1%", "33.3%"] {
            assert_eq!(size(text).unwrap().to_string(), text);
        }
        assert_eq!(size("5000").unwrap().to_string(), "5000 faces");
        assert_eq!(size("1").unwrap().to_string(), "1 face");
        assert_eq!(size("0.25"), Ok(LevelSize::Ratio(0.25)));
        assert_eq!(size(" 5k"), Ok(LevelSize::Faces(5000)));
        assert_eq!(size("1.000"), Ok(LevelSize::Ratio(1.0)));
        assert!(size("000").unwrap_err().contains("commas separate"));
        assert!(size("10.000").unwrap_err().contains("10000"));
    }

    #[test]
    fn pictures_have_sides() {
        assert_eq!(pixels("640x480"), Ok([640, 480]));
        for bad in ["640", "0x9", "9x0", "640x", "99999x2", "-3x4"] {
            assert!(pixels(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn directions_have_names_or_numbers() {
        assert_eq!(view_direction("top"), Ok(ViewDirection::From([0.0, -1.0, 0.0])));
        assert_eq!(view_direction("1,-2,0.5"), Ok(ViewDirection::Along([1.0, -2.0, 0.5])));
        for bad in ["0,0,0", "1,2", "1,2,3,4", "up", "1,nan,2"] {
            assert!(view_direction(bad).is_err(), "{bad}");
        }
    }
}
