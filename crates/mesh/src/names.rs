//! Enums that are written and read by the names of their variants.

use std::fmt;

/// Error for a name that no variant of an enum has; prints as the list of known names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownName {
    /// Name that was given.
    pub name: String,
    /// Plural noun for the variants, such as `methods`.
    pub nouns: &'static str,
    /// All names, in the order of the variants.
    pub known: Vec<&'static str>,
}

impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the {} are {}", self.nouns, self.known.join(", "))
    }
}

impl std::error::Error for UnknownName {}

/// Implements `Display` and `FromStr` for an enum that has a list `ALL` and a method `name`.
///
/// ```
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// enum Axis { X, Y }
/// impl Axis {
///     const ALL: [Self; 2] = [Self::X, Self::Y];
///     fn name(self) -> &'static str {
///         if self == Self::X { "x" } else { "y" }
///     }
/// }
/// meshlod_mesh::by_name!(Axis, "axes");
///
/// assert_eq!("y".parse(), Ok(Axis::Y));
/// assert_eq!(Axis::X.to_string(), "x");
/// assert_eq!("z".parse::<Axis>().unwrap_err().to_string(), "the axes are x, y");
/// ```
#[macro_export]
macro_rules! by_name {
    ($type:ty, $nouns:literal) => {
        impl ::std::fmt::Display for $type {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl ::std::str::FromStr for $type {
            type Err = $crate::UnknownName;

            fn from_str(name: &str) -> ::std::result::Result<Self, Self::Err> {
                let found = Self::ALL.into_iter().find(|known| known.name() == name);
                found.ok_or_else(|| $crate::UnknownName {
                    name: name.to_owned(),
                    nouns: $nouns,
                    known: Self::ALL.map(Self::name).to_vec(),
                })
            }
        }
    };
}
