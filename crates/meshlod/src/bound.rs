//! Lengths in model units or relative to the size of a model.

use std::fmt;
use std::str::FromStr;

/// Length in model units, or relative to the diagonal of a model: `0.5` or `0.1%`.
///
/// It is parsed and displayed in that form, and read by serde as a number or as text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Length in model units.
    Length(f64),
    /// Fraction of the diagonal of the model: 0.001 is displayed as `0.1%`.
    OfDiagonal(f64),
}

impl Bound {
    /// Returns the length in model units, given the diagonal of the model.
    pub fn length(self, diagonal: f64) -> f64 {
        match self {
            Self::Length(length) => length,
            Self::OfDiagonal(part) => part * diagonal,
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(length) => write!(f, "{length}"),
            // Rounded so that 0.07% is not displayed as 0.07000000000000001%.
            Self::OfDiagonal(part) => write!(f, "{}%", (part * 1e14).round() / 1e12),
        }
    }
}

/// Parses a finite length of at least 0, `0.5` in model units or `0.1%` of the diagonal.
impl FromStr for Bound {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
        let length = |text: &str| match text.parse::<f64>() {
            Ok(length) if !length.is_finite() => Err("it must be finite"),
            Ok(length) if length < 0.0 => Err("it must be at least 0"),
            Ok(length) => Ok(length),
            Err(_) => Err("it must be a number"),
        };
        match text.strip_suffix('%') {
            Some(percent) => Ok(Self::OfDiagonal(length(percent)? / 100.0)),
            None => Ok(Self::Length(length(text)?)),
        }
    }
}

#[cfg(feature = "serde")]
mod forms {
    use std::fmt;

    use serde::de::{Error, Visitor};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Bound;

    impl Serialize for Bound {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            match self {
                Self::Length(length) => serializer.serialize_f64(*length),
                Self::OfDiagonal(_) => serializer.collect_str(self),
            }
        }
    }

    impl<'de> Deserialize<'de> for Bound {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            deserializer.deserialize_any(NumberOrText)
        }
    }

    struct NumberOrText;

    impl Visitor<'_> for NumberOrText {
        type Value = Bound;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a length, or a percentage of the diagonal such as \"0.1%\"")
        }

        fn visit_f64<E: Error>(self, length: f64) -> Result<Bound, E> {
            length.to_string().parse().map_err(E::custom)
        }

        fn visit_i64<E: Error>(self, length: i64) -> Result<Bound, E> {
            self.visit_f64(length as f64)
        }

        fn visit_u64<E: Error>(self, length: u64) -> Result<Bound, E> {
            self.visit_f64(length as f64)
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<Bound, E> {
            text.parse().map_err(E::custom)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_is_parsed_as_it_is_displayed() {
        for text in ["0.5", "0.1%", "0", "0%", "0.07%", "33.3%", "1000000"] {
            let bound: Bound = text.parse().unwrap();
            assert_eq!(bound.to_string(), text);
        }
        for text in ["", "%", "-1", "nan", "inf%", "1e999", "a"] {
            assert!(text.parse::<Bound>().is_err(), "{text}");
        }
        assert_eq!("0.1%".parse::<Bound>().unwrap().length(2000.0), 2.0);
    }
}
