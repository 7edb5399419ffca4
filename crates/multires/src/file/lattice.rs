//! Cubic lattice to which a `.mlod` file rounds positions.

use glam::{DVec3, IVec3, Vec3};

/// Cubic lattice centred on the origin of the frame. A cell is a small multiple of a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lattice {
    /// Side of a cell, in steps.
    steps: u8,
    /// Binary logarithm of the number of steps in a stored unit.
    bits: u8,
}

/// With at most this many bits, `f32` holds every multiple of a step up to two units from the
/// origin, and all recorded positions lie within one.
const MAX_BITS: u8 = 23;
/// Greatest coordinate of a lattice position, in steps.
const MAX_COORDINATE: i32 = 1 << (MAX_BITS + 1);
/// Cells of four to seven steps, so that a lattice is at most a quarter finer than required.
const STEPS: std::ops::RangeInclusive<u8> = 4..=7;

impl Lattice {
    /// Returns the coarsest lattice that moves no position by more than `most` stored units, or the
    /// finest lattice if none does.
    pub(super) fn within(most: f64) -> Self {
        let of = |bits| STEPS.rev().map(move |steps| Self { steps, bits });
        let fits = |lattice: &Self| lattice.rounding() <= most;
        let finest = Self { steps: 1, bits: MAX_BITS };
        (0..=MAX_BITS).flat_map(of).find(fits).unwrap_or(finest)
    }

    pub(super) fn from_bytes([bits, steps]: [u8; 2]) -> Option<Self> {
        (bits <= MAX_BITS && (1..=*STEPS.end()).contains(&steps)).then_some(Self { steps, bits })
    }

    pub(super) fn to_bytes(self) -> [u8; 2] {
        [self.bits, self.steps]
    }

    /// Returns the side of a cell, in stored units.
    pub(super) fn cell(self) -> f64 {
        f64::from(self.steps) * (-f64::from(self.bits)).exp2()
    }

    /// Returns the largest distance that rounding moves a position, in stored units: half the
    /// diagonal of a cell.
    pub(super) fn rounding(self) -> f64 {
        0.75f64.sqrt() * self.cell()
    }

    pub(super) fn round(self, position: Vec3) -> [i32; 3] {
        let limit = IVec3::splat(MAX_COORDINATE / i32::from(self.steps));
        let at = (position.as_dvec3() / self.cell()).round().as_ivec3();
        at.clamp(-limit, limit).into()
    }

    /// Returns the stored position of a cell, or `None` if it is out of range.
    pub(super) fn checked_position(self, at: [i64; 3]) -> Option<Vec3> {
        let limit = i64::from(MAX_COORDINATE / i32::from(self.steps));
        let near = -limit..=limit;
        at.iter().all(|x| near.contains(x)).then(|| self.position(at.map(|x| x as i32)))
    }

    /// Returns true if the point `here`, in stored units, is rounded to `place`: it is within half
    /// a cell along each axis, plus the prior rounding to single precision.
    pub(super) fn rounds_to(self, position: Vec3, here: DVec3) -> bool {
        let position = position.as_dvec3();
        let most = 0.5 * self.cell() + f64::from(f32::EPSILON) * position.abs();
        (here - position).abs().cmple(most).all()
    }

    pub(super) fn position(self, at: [i32; 3]) -> Vec3 {
        (DVec3::from(at.map(f64::from)) * self.cell()).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_exact() {
        for lattice in [Lattice::within(0.0), Lattice::within(1e-6), Lattice::within(3e-5)] {
            for at in [[1, 2, 3], [-12_345, 99_999, 0], [7, -2_396_745, 2_396_745]] {
                let position = lattice.position(at);
                let exact = DVec3::from(at.map(f64::from)) * lattice.cell();
                assert_eq!(position.as_dvec3(), exact, "{lattice:?}");
                assert_eq!(lattice.round(position), at, "{lattice:?}");
            }
        }
    }

    #[test]
    fn a_lattice_is_as_fine_as_asked() {
        let lattice = Lattice::within(1e-4);
        assert!(lattice.rounding() <= 1e-4 && 1.25 * lattice.rounding() > 1e-4);
        let position = Vec3::new(0.3, -0.49, 0.0001);
        let kept = lattice.checked_position(lattice.round(position).map(i64::from)).unwrap();
        assert!(f64::from(position.distance(kept)) <= 1e-4);
        assert_eq!(lattice.position(lattice.round(kept)), kept);
        assert_eq!(Lattice::within(0.0).to_bytes(), [MAX_BITS, 1]);
        assert_eq!(Lattice::from_bytes(lattice.to_bytes()), Some(lattice));
        assert_eq!((Lattice::from_bytes([24, 4]), Lattice::from_bytes([3, 0])), (None, None));
        assert_eq!(lattice.checked_position([i64::from(i32::MIN); 3]), None);
    }

    #[test]
    fn what_is_rounded_to_a_place_is_near_it() {
        let mut seed = 7u64;
        let mut roll = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        for lattice in [Lattice::within(0.0), Lattice::within(1e-6), Lattice::within(3e-2)] {
            for size in [1e-9, 1e-3, 0.5, 1.9] {
                let here = DVec3::new(roll() - 0.5, roll() - 0.5, roll() - 0.5) * 2.0 * size;
                // Midpoints between cells as well.
                let middle =
                    (here / lattice.cell()).floor() * lattice.cell() + 0.5 * lattice.cell();
                for here in [here, middle] {
                    let position = lattice.position(lattice.round(here.as_vec3()));
                    assert!(lattice.rounds_to(position, here), "{lattice:?} {here}");
                    for far in [DVec3::X, DVec3::NEG_Y, DVec3::Z * 1e300, DVec3::INFINITY] {
                        assert!(!lattice.rounds_to(position, here + 2.0 * lattice.cell() * far));
                    }
                    assert!(!lattice.rounds_to(position, DVec3::NAN));
                }
            }
        }
    }
}
