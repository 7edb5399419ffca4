//! Normals expected from the faces around.

use glam::DVec3;

use super::adjacency::previous;
use super::directions::Guess;
use super::entries::LayerEntries;
use super::geometry::BlockGeometry;

/// Weight of a face at a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaceWeight {
    Area,
    Angle,
    /// Area over the squared lengths of both edges [Max99].
    Max,
}

impl FaceWeight {
    pub(super) const ALL: [Self; 3] = [Self::Area, Self::Angle, Self::Max];

    /// Returns the weight of a face's normal, which has twice its area as length.
    fn of(self, a: DVec3, b: DVec3, length: f64) -> f64 {
        match self {
            Self::Area => 1.0,
            Self::Max => 1.0 / (a.length_squared() * b.length_squared()),
            Self::Angle => angle(a, b) / length,
        }
    }
}

/// Returns the weighted normal of the faces around an entry.
pub(super) fn normal_of(
    entry: usize,
    entries: &LayerEntries,
    geometry: &BlockGeometry,
    weight: FaceWeight,
) -> Guess {
    let (mut sum, mut all, mut count) = (DVec3::ZERO, 0.0, 0);
    let mut is_open = false;
    for corner in entries.around(entry) {
        let [a, b] = geometry.edges(corner);
        let normal = a.cross(b);
        let length = normal.length();
        is_open |= geometry.faces.twin(corner).is_none();
        is_open |= geometry.faces.twin(previous(corner)).is_none();
        if length > 0.0 {
            let weight = weight.of(a, b, length);
            sum += normal * weight;
            all += length * weight;
            count += 1;
        }
    }
    let length = sum.length();
    let flatness = if all > 0.0 { length / all } else { 1.0 };
    let bend = match flatness {
        _ if count < 2 => 1,
        ..0.98 => 2,
        ..0.999 => 1,
        _ => 0,
    };
    Guess { direction: (length > 0.0).then(|| sum / length), bend, is_open }
}

/// Returns the angle between two vectors to within .0001, the same on every machine.
fn angle(a: DVec3, b: DVec3) -> f64 {
    let cosine = a.dot(b) / (a.length_squared() * b.length_squared()).sqrt();
    let c = cosine.abs().min(1.0);
    // [AS64] 4.4.45.
    let part = 1.570_728_8 - 0.212_114_4 * c + 0.074_261_0 * c * c - 0.018_729_3 * c * c * c;
    let acute = (1.0 - c).sqrt() * part;
    if cosine < 0.0 { std::f64::consts::PI - acute } else { acute }
}
