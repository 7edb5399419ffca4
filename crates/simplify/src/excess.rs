//! Places where a level is farther from its input than an error bound allows.

use meshlod_mesh::FaceId;

/// A face of a level, or of its input, that has a point farther from the other surface than allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// Face with such a point.
    pub face: ExcessFace,
    /// Greatest distance found on the face, relative to the one allowed: above 1.
    pub ratio: f64,
}

/// Face of one of two surfaces that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExcessFace {
    /// Face of [`Simplifier::level`](crate::Simplifier::level).
    OfLevel(FaceId),
    /// Face of [`Simplifier::input`](crate::Simplifier::input).
    OfInput(FaceId),
}
