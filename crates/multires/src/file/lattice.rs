//! The lattice that a file keeps places on.

use glam::{DVec3, IVec3, Vec3};

/// A cubic lattice about the middle of the frame, with cells of a few times a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lattice {
    /// A cell is so many steps.
    steps: u8,
    /// A stored unit has so many steps, as a power of two.
    bits: u8,
}

/// `f32` holds every multiple of a step within a unit or two of the middle, where everything is that was
/// recorded.
const MOST_BITS: u8 = 23;
/// How far from the middle places may be, in steps.
const FARTHEST: i32 = 1 << (MOST_BITS + 1);
/// Cells have four to seven steps: no more than a quarter finer than asked.
const STEPS: std::ops::RangeInclusive<u8> = 4..=7;

impl Lattice {
    /// The coarsest that moves no place by more than `most`, in stored units; or the finest.
    pub(super) fn within(most: f64) -> Self {
        let of = |bits| STEPS.rev().map(move |steps| Self { steps, bits });
        let fits = |lattice: &Self| lattice.rounding() <= most;
        let finest = Self { steps: 1, bits: MOST_BITS };
        (0..=MOST_BITS).flat_map(of).find(fits).unwrap_or(finest)
    }

    pub(super) fn from_bytes([bits, steps]: [u8; 2]) -> Option<Self> {
        (bits <= MOST_BITS && (1..=*STEPS.end()).contains(&steps)).then_some(Self { steps, bits })
    }

    pub(super) fn to_bytes(self) -> [u8; 2] {
        [self.bits, self.steps]
    }

    /// A cell in stored units.
    pub(super) fn cell(self) -> f64 {
        f64::from(self.steps) * (-f64::from(self.bits)).exp2()
    }

    /// By how much a place is moved at most, in stored units: half the diagonal of a cell.
    pub(super) fn rounding(self) -> f64 {
        0.75f64.sqrt() * self.cell()
    }

    pub(super) fn round(self, place: Vec3) -> [i32; 3] {
        let farthest = IVec3::splat(FARTHEST / i32::from(self.steps));
        let at = (place.as_dvec3() / self.cell()).round().as_ivec3();
        at.clamp(-farthest, farthest).into()
    }

    /// None where nothing can be.
    pub(super) fn place(self, at: [i64; 3]) -> Option<Vec3> {
        let farthest = i64::from(FARTHEST / i32::from(self.steps));
        let near = -farthest..=farthest;
        at.iter().all(|x| near.contains(x)).then(|| self.put(at.map(|x| x as i32)))
    }

    /// Whether what is here, in stored units, is rounded to that place: half a cell off along each axis at
    /// most, and what single precision takes from it before.
    pub(super) fn is_place_of(self, place: Vec3, here: DVec3) -> bool {
        let place = place.as_dvec3();
        let most = 0.5 * self.cell() + f64::from(f32::EPSILON) * place.abs();
        (here - place).abs().cmple(most).all()
    }

    pub(super) fn put(self, at: [i32; 3]) -> Vec3 {
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
                let place = lattice.put(at);
                let exact = DVec3::from(at.map(f64::from)) * lattice.cell();
                assert_eq!(place.as_dvec3(), exact, "{lattice:?}");
                assert_eq!(lattice.round(place), at, "{lattice:?}");
            }
        }
    }

    #[test]
    fn a_lattice_is_as_fine_as_asked() {
        let lattice = Lattice::within(1e-4);
        assert!(lattice.rounding() <= 1e-4 && 1.25 * lattice.rounding() > 1e-4);
        let place = Vec3::new(0.3, -0.49, 0.0001);
        let kept = lattice.place(lattice.round(place).map(i64::from)).unwrap();
        assert!(f64::from(place.distance(kept)) <= 1e-4);
        assert_eq!(lattice.put(lattice.round(kept)), kept);
        assert_eq!(Lattice::within(0.0).to_bytes(), [MOST_BITS, 1]);
        assert_eq!(Lattice::from_bytes(lattice.to_bytes()), Some(lattice));
        assert_eq!((Lattice::from_bytes([24, 4]), Lattice::from_bytes([3, 0])), (None, None));
        assert_eq!(lattice.place([i64::from(i32::MIN); 3]), None);
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
                // Middles of cells too.
                let middle =
                    (here / lattice.cell()).floor() * lattice.cell() + 0.5 * lattice.cell();
                for here in [here, middle] {
                    let place = lattice.put(lattice.round(here.as_vec3()));
                    assert!(lattice.is_place_of(place, here), "{lattice:?} {here}");
                    for far in [DVec3::X, DVec3::NEG_Y, DVec3::Z * 1e300, DVec3::INFINITY] {
                        assert!(!lattice.is_place_of(place, here + 2.0 * lattice.cell() * far));
                    }
                    assert!(!lattice.is_place_of(place, DVec3::NAN));
                }
            }
        }
    }
}
