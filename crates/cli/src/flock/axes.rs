//! Axes of a model: which way it swims, and which way is up.

use std::fmt;

use meshlod::Mesh;
use meshlod::mesh::Bounds;

/// Coordinate axis with a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignedAxis {
    /// 0 for x, 1 for y, 2 for z.
    pub index: usize,
    pub is_negative: bool,
}

/// Direction in which a model swims, as asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Forward {
    /// To be found from the shape of the model.
    Auto,
    Along(SignedAxis),
}

/// Extent along an axis over that along the other, from which on a model is surely longer that way.
const LONGER: f64 = 1.5;

impl SignedAxis {
    const fn new(index: usize, is_negative: bool) -> Self {
        Self { index, is_negative }
    }

    /// Returns the unit vector along the axis.
    pub fn vector(self) -> [f64; 3] {
        let mut vector = [0.0; 3];
        vector[self.index] = if self.is_negative { -1.0 } else { 1.0 };
        vector
    }
}

impl fmt::Display for SignedAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", if self.is_negative { '-' } else { '+' }, ["x", "y", "z"][self.index])
    }
}

/// Parses an axis: `+z`, `-x`, `y`.
pub fn axis(text: &str) -> Result<SignedAxis, String> {
    let (is_negative, name) = match text.strip_prefix('-') {
        Some(name) => (true, name),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    match ["x", "y", "z"].iter().position(|known| known.eq_ignore_ascii_case(name)) {
        Some(index) => Ok(SignedAxis { index, is_negative }),
        None => Err("expected an axis: +x, -x, +y, -y, +z or -z".into()),
    }
}

/// Parses the value of `--forward`.
pub fn forward(text: &str) -> Result<Forward, String> {
    match text {
        "auto" => Ok(Forward::Auto),
        _ => axis(text).map(Forward::Along).map_err(|error| format!("{error}, or auto")),
    }
}

/// Guesses the way a model swims.
///
/// A model that is much longer along the other horizontal axis than along the usual one swims that
/// way, with its bulkier end first, as fish do; all others face the usual way: +z, as in glTF, or
/// what that becomes for a model with z up, -y.
pub fn guess(mesh: &Mesh, up: SignedAxis) -> SignedAxis {
    let usual =
        if up.index == 2 { SignedAxis::new(1, !up.is_negative) } else { SignedAxis::new(2, false) };
    let across = 3 - up.index - usual.index;
    let bounds = mesh.bounds();
    let extent = |axis: usize| bounds.max[axis] - bounds.min[axis];
    if extent(across) > LONGER * extent(usual.index) {
        SignedAxis::new(across, bulk(mesh, &bounds, across) < 0.0)
    } else {
        usual
    }
}

/// Returns on which side of the middle of its box the model has more surface along an axis.
fn bulk(mesh: &Mesh, bounds: &Bounds, axis: usize) -> f64 {
    let middle = bounds.center()[axis];
    let moment = |face: &[meshlod::mesh::VertexId; 3]| {
        let [a, b, c] = mesh.triangle(*face);
        (b - a).cross(c - a).length() * ((a + b + c)[axis] / 3.0 - middle)
    };
    mesh.faces.iter().map(moment).sum()
}

#[cfg(test)]
mod tests {
    use meshlod::samples;

    use super::*;

    const UP: SignedAxis = SignedAxis::new(1, false);

    #[test]
    fn axes_have_a_sign_or_none() {
        let read = ["+x", "-y", "z", "Z"].map(|text| axis(text).unwrap().to_string());
        assert_eq!(read, ["+x", "-y", "+z", "+z"]);
        assert_eq!(axis("-z").unwrap().vector(), [0.0, 0.0, -1.0]);
        for bad in ["", "+", "--x", "w", "xy", "+ x"] {
            assert!(axis(bad).is_err(), "{bad}");
        }
        assert!(forward("auto") == Ok(Forward::Auto) && forward("left").is_err());
    }

    #[test]
    fn a_fish_swims_with_its_head_first_whichever_way_it_lies() {
        let fish = samples::fish(4_000);
        assert_eq!(guess(&fish, UP).to_string(), "-x");
        let mut turned = fish.clone();
        turned.positions.iter_mut().for_each(|p| p[0] = -p[0]);
        assert_eq!(guess(&turned, UP).to_string(), "+x");
        let mut along = fish.clone();
        along.positions.iter_mut().for_each(|p| p.swap(0, 2));
        assert_eq!(guess(&along, UP).to_string(), "+z", "the convention stands");
    }

    #[test]
    fn round_models_face_the_usual_way() {
        let ball = samples::sphere(500);
        assert_eq!(guess(&ball, UP).to_string(), "+z");
        assert_eq!(guess(&ball, SignedAxis::new(2, false)).to_string(), "-y");
    }
}
