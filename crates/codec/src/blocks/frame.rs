//! Orientation of a block: a normal and an angle about it, in a few bits.

use glam::DVec3;

/// Quantized orthonormal frame: two axes along the surface, and its normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Frame {
    /// Point of the normal on the upper half of the octahedron, seen from its tip.
    pub(super) normal: [u32; 2],
    /// Rotation of the other two axes about the normal.
    pub(super) angle: u32,
}

/// Bits of each of the normal's two numbers. Half a step lifts the end of a block by a fraction of
/// a cell.
pub(super) const NORMAL_BITS: u32 = 8;
/// Bits of the angle. Half a step makes a block a fortieth wider.
pub(super) const ANGLE_BITS: u32 = 5;

const NORMALS: u32 = 1 << NORMAL_BITS;
const ANGLES: u32 = 1 << ANGLE_BITS;
/// Tangent of 22.5°. Angles cover a quarter turn, beyond which the axes only change places.
const TAN_HALF: f64 = 0.414_213_562_373_095_05;

impl Frame {
    /// Returns the unrotated frame whose normal is closest to a direction.
    pub(super) fn towards(normal: DVec3) -> Self {
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let sum = (normal.x.abs() + normal.y.abs() + normal.z).max(f64::MIN_POSITIVE);
        let [x, y] = [normal.x / sum, normal.y / sum];
        let code = |x: f64| {
            let code = ((x + 1.0) * 0.5 * f64::from(NORMALS - 1)).round();
            (code.max(0.0) as u32).min(NORMALS - 1)
        };
        Self { normal: [code(x + y), code(x - y)], angle: ANGLES / 2 }
    }

    /// Returns the axes. Uses only sums, products, quotients and roots, which are the same on every
    /// machine.
    pub(super) fn axes(self) -> [DVec3; 3] {
        let [a, b] = self.normal.map(|code| f64::from(2 * code) / f64::from(NORMALS - 1) - 1.0);
        let [x, y] = [(a + b) * 0.5, (a - b) * 0.5];
        let z = (1.0 - x.abs() - y.abs()).max(0.0);
        let length = (x * x + y * y + z * z).sqrt();
        let n = DVec3::new(x / length, y / length, z / length);
        // An orthogonal pair without a special case for small components.
        let along = 1.0 / (1.0 + n.z);
        let u = DVec3::new(1.0 - n.x * n.x * along, -n.x * n.y * along, -n.x);
        let v = DVec3::new(-n.x * n.y * along, 1.0 - n.y * n.y * along, -n.y);
        let t = (f64::from(self.angle) / f64::from(ANGLES / 2) - 1.0) * TAN_HALF;
        let (cos, sin) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
        [u * cos + v * sin, v * cos - u * sin, n]
    }

    /// Returns all frames with this normal.
    pub(super) fn turned(self) -> impl Iterator<Item = Self> {
        (0..ANGLES).map(move |angle| Self { angle, ..self })
    }

    /// Returns the frames whose normal is `step` codes away.
    pub(super) fn tilted(self, step: i32) -> impl Iterator<Item = Self> {
        let by = [[-1, 0], [1, 0], [0, -1], [0, 1], [-1, -1], [1, 1], [-1, 1], [1, -1]];
        by.into_iter().filter_map(move |[a, b]| {
            let code =
                |code: u32, by: i32| code.checked_add_signed(by * step).filter(|&c| c < NORMALS);
            Some(Self { normal: [code(self.normal[0], a)?, code(self.normal[1], b)?], ..self })
        })
    }
}
