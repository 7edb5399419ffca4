//! Parsers of command-line values, whose error messages say what is expected.

use std::fmt;

pub use meshlod::Bound;
use meshlod::{Format, Method, Target};

use crate::text::numbers::{count, plural};

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
    let ratio = match text.strip_suffix('%') {
        Some(percent) => number(percent)? / 100.0,
        None => number(text)?,
    };
    match ratio {
        _ if (0.0..=1.0).contains(&ratio) => Ok(ratio),
        _ if text.ends_with('%') => Err("it must be between 0% and 100%".into()),
        _ => Err(format!("it must be between 0 and 1; did you mean {text}%?")),
    }
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
    match text.parse() {
        Ok(faces) => Ok(LevelSize::Faces(faces)),
        Err(_) => ratio(text).map(LevelSize::Ratio),
    }
}

/// Parses a finite length of at least 0.
pub fn length(text: &str) -> Result<f64, String> {
    match number(text)? {
        length if length >= 0.0 => Ok(length),
        _ => Err("it must be at least 0".into()),
    }
}

/// Parses a weight of at least 0.
pub fn weight(text: &str) -> Result<f64, String> {
    length(text)
}

/// Parses a whole number of at least 0.
pub fn whole(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "it must be a whole number of at least 0".into())
}

/// Parses a whole number of at least 1.
pub fn positive(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err("it must be a whole number of at least 1".into()),
    }
}

/// Parses the value of `--threads`.
pub fn threads(text: &str) -> Result<usize, String> {
    at_most(MAX_THREADS, text)
}

/// Parses the value of `--samples`.
pub fn samples(text: &str) -> Result<usize, String> {
    at_most(MAX_SAMPLES, text)
}

/// Parses a picture size in pixels: `640x480`.
pub fn pixels(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').map(|(width, height)| (width.parse(), height.parse()));
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

/// Parses a finite number.
pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("{text:?} is not a number")),
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
