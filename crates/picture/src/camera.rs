//! Perspective cameras, and fitting them to a mesh.

use glam::DVec3;
use meshlod_mesh::{Bounds, Mesh};

use crate::trigonometry::tangent;

/// Perspective camera with square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    tan_half_fov: f64,
    near: f64,
}

/// Viewing direction and framing for fitting a [`Camera`] to a mesh or a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Direction in which the camera looks, a vector of any length.
    pub direction: [f64; 3],
    /// Direction that points up in the picture, a vector of any length.
    pub up: [f64; 3],
    /// Field of view along the shorter side of the picture, in radians.
    pub fov_rad: f64,
    /// Fraction of the picture's width or height that the object fills, 0 to 1, whichever is
    /// larger.
    pub fill: f64,
    /// Aspect ratio of the picture: width divided by height.
    pub aspect: f64,
}

/// Axis of the model that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// The y axis, as in glTF and most scans.
    #[default]
    Y,
    /// The z axis, as in CAD and terrain models.
    Z,
}

impl Default for View {
    fn default() -> Self {
        Self::three_quarter(UpAxis::Y)
    }
}

impl View {
    /// Returns a view from the front, slightly from the right and above, which suits most models.
    pub fn three_quarter(up: UpAxis) -> Self {
        let (direction, up) = match up {
            UpAxis::Y => ([-0.5, -0.4, -1.0], [0.0, 1.0, 0.0]),
            UpAxis::Z => ([-0.5, 1.0, -0.4], [0.0, 0.0, 1.0]),
        };
        Self { direction, up, fov_rad: std::f64::consts::FRAC_PI_4, fill: 0.8, aspect: 1.0 }
    }
}

impl Camera {
    /// Creates a camera at `eye` that looks at `target`; `fov_rad` is the field of view along the
    /// picture's shorter side, in radians.
    ///
    /// The near plane is at a thousandth of the distance to the target.
    pub fn look_at(eye: [f64; 3], target: [f64; 3], up: [f64; 3], fov_rad: f64) -> Self {
        let (eye, target) = (DVec3::from(eye), DVec3::from(target));
        let [right, up, forward] = frame(target - eye, up.into());
        let distance = (target - eye).length();
        Self { eye, right, up, forward, tan_half_fov: half_tangent(fov_rad), near: near(distance) }
    }

    /// Creates a camera that sees a whole bounding box and is framed according to `view`.
    ///
    /// An empty box counts as a point at the origin.
    pub fn fit(bounds: &Bounds, view: &View) -> Self {
        let corner = |i: usize| {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] }
            };
            DVec3::new(pick(0), pick(1), pick(2))
        };
        let corners = if bounds.is_empty() { 0..0 } else { 0..8 };
        Self::fit_points(corners.map(corner), view)
    }

    /// Creates a camera that sees a whole mesh and is framed according to `view`.
    ///
    /// The camera is closer than that for the bounding box, [`Camera::fit`]. Unused vertices are
    /// ignored.
    ///
    /// Cost: O(n), n = faces.
    pub fn fit_mesh(mesh: &Mesh, view: &View) -> Self {
        let points = mesh.faces.iter().flatten().map(|v| DVec3::from(mesh.positions[v.index()]));
        Self::fit_points(points, view)
    }

    /// Returns the twelve standard cameras for comparing pictures of two meshes, at the corners of
    /// an icosahedron around `mesh`.
    ///
    /// The mesh fills 80% of a square frame, with a field of view of 45°.
    ///
    /// Use the cameras of the reference mesh for both pictures.
    pub fn icosahedron_views(mesh: &Mesh) -> [Self; 12] {
        Self::cyclic_views(mesh, [1.0, GOLDEN])
    }

    /// Returns twelve more cameras around `mesh`, in addition to [`Camera::icosahedron_views`], at
    /// the corners of the icosahedron turned by a right angle.
    pub fn other_icosahedron_views(mesh: &Mesh) -> [Self; 12] {
        Self::cyclic_views(mesh, [GOLDEN, 1.0])
    }

    /// Returns cameras at the cyclic permutations of (0, ±a, ±b).
    fn cyclic_views(mesh: &Mesh, [a, b]: [f64; 2]) -> [Self; 12] {
        std::array::from_fn(|i| {
            let a = if i & 1 == 0 { a } else { -a };
            let b = if i & 2 == 0 { b } else { -b };
            let direction = match i / 4 {
                0 => [0.0, a, b],
                1 => [a, b, 0.0],
                _ => [b, 0.0, a],
            };
            Self::fit_mesh(mesh, &View { direction, ..View::default() })
        })
    }

    /// Returns the position of the camera's eye.
    pub fn eye(&self) -> [f64; 3] {
        self.eye.into()
    }

    /// Returns the direction in which the camera looks, a unit vector.
    pub fn forward(&self) -> [f64; 3] {
        self.forward.into()
    }

    /// Returns unit vectors to the right, up and into the picture.
    pub fn axes(&self) -> [[f64; 3]; 3] {
        [self.right, self.up, self.forward].map(DVec3::into)
    }

    /// Returns the tangent of half the field of view along the picture's shorter side.
    pub fn tan_half_fov(&self) -> f64 {
        self.tan_half_fov
    }

    /// Returns the distance of the near plane from the eye, along [`Camera::forward`], in model
    /// units.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// Returns this camera with its near plane at another distance, in model units, which must be
    /// above zero.
    pub fn with_near(self, near: f64) -> Self {
        Self { near: near.max(f64::MIN_POSITIVE), ..self }
    }

    /// Returns the width of a pixel at depth 1, in a picture with the given shorter side.
    pub(crate) fn pixel_width(&self, side: u32) -> f64 {
        2.0 * self.tan_half_fov / f64::from(side)
    }

    /// Fits the camera to points. Each side of the frame bounds the eye by one linear inequality
    /// per point, so four maxima give the closest eye, centred in the remaining space.
    fn fit_points(points: impl Iterator<Item = DVec3>, view: &View) -> Self {
        let [right, up, forward] = frame(view.direction.into(), view.up.into());
        let tan_half_fov = half_tangent(view.fov_rad);
        let fill = tan_half_fov * view.fill.clamp(0.01, 1.0);
        let (wide, high) = (fill * view.aspect.max(1.0), fill * (1.0 / view.aspect).max(1.0));
        let (mut sides, mut depths) = ([f64::NEG_INFINITY; 4], [f64::INFINITY, f64::NEG_INFINITY]);
        for point in points {
            let (x, y, z) = (point.dot(right), point.dot(up), point.dot(forward));
            let here = [x - wide * z, -x - wide * z, y - high * z, -y - high * z];
            sides = std::array::from_fn(|i| sides[i].max(here[i]));
            depths = [depths[0].min(z), depths[1].max(z)];
        }
        if !sides.iter().chain(&depths).all(|x| x.is_finite()) {
            (sides, depths) = ([0.0; 4], [0.0; 2]);
        }
        let by_width = -(sides[0] + sides[1]) / (2.0 * wide);
        let by_height = -(sides[2] + sides[3]) / (2.0 * high);
        let z = by_width.min(by_height).min(depths[0] - MIN_GAP * (depths[1] - depths[0]));
        // A single point has no extent to derive a distance from.
        let z = if z < depths[0] { z } else { depths[0] - 1.0 };
        let (x, y) = ((sides[0] - sides[1]) / 2.0, (sides[2] - sides[3]) / 2.0);
        let eye = right * x + up * y + forward * z;
        Self { eye, right, up, forward, tan_half_fov, near: near(depths[0] - z) }
    }

    /// Maps the camera to a grid of `width` by `height` cells: pixels or samples.
    pub(crate) fn lens(&self, width: u32, height: u32) -> Lens {
        let middle = [f64::from(width) * 0.5, f64::from(height) * 0.5];
        let focal = middle[0].min(middle[1]) / self.tan_half_fov;
        Lens { camera: *self, middle, focal }
    }
}

/// Golden ratio, (1 + √5) / 2.
const GOLDEN: f64 = 1.618033988749895;

/// Minimum distance from the eye to the fitted object, relative to the object's depth: otherwise a
/// needle pointing at the eye would touch it.
const MIN_GAP: f64 = 0.05;

/// Camera mapped to a grid of cells, pixels or samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    camera: Camera,
    /// Point where the optical axis meets the grid.
    middle: [f64; 2],
    /// Distance of the image plane, in cells.
    focal: f64,
}

impl Lens {
    /// Projects a point to homogeneous grid coordinates [x w, y w, w]; w is its depth, y points
    /// down.
    #[inline]
    pub(crate) fn project(&self, point: DVec3) -> DVec3 {
        let Camera { eye, right, up, forward, .. } = self.camera;
        let offset = point - eye;
        let depth = offset.dot(forward);
        let x = self.middle[0] * depth + self.focal * offset.dot(right);
        let y = self.middle[1] * depth - self.focal * offset.dot(up);
        DVec3::new(x, y, depth)
    }

    /// Returns the ray from the eye through a point of the grid, scaled to depth 1.
    #[inline]
    pub(crate) fn ray(&self, x: f64, y: f64) -> DVec3 {
        let [dx, dy] = self.ray_steps();
        self.camera.forward + dx * (x - self.middle[0]) + dy * (y - self.middle[1])
    }

    /// Returns the change of the ray per cell to the right and per cell down.
    #[inline]
    pub(crate) fn ray_steps(&self) -> [DVec3; 2] {
        [self.camera.right / self.focal, self.camera.up / -self.focal]
    }

    #[inline]
    pub(crate) fn eye(&self) -> DVec3 {
        self.camera.eye
    }

    /// Returns unit vectors to the right, up and into the picture.
    pub(crate) fn axes(&self) -> [DVec3; 3] {
        [self.camera.right, self.camera.up, self.camera.forward]
    }

    pub(crate) fn near(&self) -> f64 {
        self.camera.near
    }
}

/// Builds an orthonormal frame of right, up and forward; picks another "up" if the given one is
/// parallel to the direction.
fn frame(direction: DVec3, up: DVec3) -> [DVec3; 3] {
    let forward = direction.try_normalize().unwrap_or(DVec3::NEG_Z);
    let right = [up, DVec3::Y, DVec3::Z]
        .into_iter()
        .filter_map(|up| up.try_normalize())
        .map(|up| forward.cross(up))
        .find(|right| right.length_squared() > 1e-12)
        .and_then(DVec3::try_normalize)
        .unwrap_or(DVec3::X);
    [right, right.cross(forward), forward]
}

/// Returns the tangent of half the field of view, which is clamped to 1° to 150°.
fn half_tangent(fov_rad: f64) -> f64 {
    let asked = if fov_rad.is_nan() { std::f64::consts::FRAC_PI_4 } else { fov_rad };
    tangent(asked.clamp(1f64.to_radians(), 150f64.to_radians()) * 0.5)
}

fn near(distance: f64) -> f64 {
    (distance * 1e-3).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Minimum and maximum x and y of the box's corners in a frame of 1000 by 1000 / aspect.
    fn extent(bounds: &Bounds, camera: &Camera, aspect: f64) -> [f64; 4] {
        let lens = camera.lens(1000, (1000.0 / aspect) as u32);
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for i in 0..8 {
            let side = |axis: usize| if i >> axis & 1 == 0 { bounds.min } else { bounds.max }[axis];
            let p = lens.project(DVec3::new(side(0), side(1), side(2)));
            let (x, y) = (p.x / p.z, p.y / p.z);
            extent = [extent[0].min(x), extent[1].max(x), extent[2].min(y), extent[3].max(y)];
        }
        extent
    }

    #[test]
    fn a_box_of_any_shape_fills_the_frame() {
        let boxes =
            [[1.0, 1.0, 1.0], [9.0, 0.1, 0.1], [0.0, 5.0, 0.0], [1e-6, 1e-6, 3e-6], [1e9; 3]];
        let views = [[0.0, 0.0, -1.0], [-1.0, -2.0, 0.5], [0.0, 1.0, 0.0]];
        for (size, direction) in boxes.into_iter().flat_map(|b| views.map(|v| (b, v))) {
            for aspect in [1.0, 2.0, 0.5] {
                let bounds =
                    Bounds { min: [7.0, 0.0, -2.0], max: [7.0 + size[0], size[1], size[2] - 2.0] };
                let camera = Camera::fit(&bounds, &View { direction, aspect, ..View::default() });
                let [left, right, top, bottom] = extent(&bounds, &camera, aspect);
                let (width, height) = (1000.0, 1000.0 / aspect);
                let used = ((right - left) / width).max((bottom - top) / height);
                // A line that runs away from the eye can only fill the frame by touching it.
                let line = size == [0.0, 5.0, 0.0] && direction[1] != 0.0;
                assert!(used < 0.8001 && (line || used > 0.7999), "{size:?} {direction:?}: {used}");
                let centered = (left + right - width).abs().min((top + bottom - height).abs());
                assert!(centered < 0.1, "{size:?} {direction:?} off by {centered}");
            }
        }
    }

    #[test]
    fn nothing_to_look_at_still_gives_a_camera() {
        let camera = Camera::fit(&Bounds::EMPTY, &View::default());
        assert!(camera.eye.is_finite() && camera.near > 0.0);
        let nowhere = Camera::look_at([1.0; 3], [1.0; 3], [0.0; 3], f64::NAN);
        assert!(nowhere.forward.is_finite() && nowhere.right.is_finite() && nowhere.near > 0.0);
    }

    #[test]
    fn a_ray_ends_where_its_point_is_projected() {
        let camera = Camera::look_at([1.0, 2.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], 0.7);
        let lens = camera.lens(640, 480);
        let projected = lens.project(lens.eye() + lens.ray(100.0, 50.0) * 4.0);
        assert!((projected / 4.0 - DVec3::new(100.0, 50.0, 1.0)).length() < 1e-9);
    }

    #[test]
    fn the_twelve_views_are_apart() {
        let v = |i| meshlod_mesh::VertexId(i);
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = Mesh::new(corners, vec![[v(0), v(1), v(2)], [v(0), v(3), v(1)]]);
        let views = Camera::icosahedron_views(&mesh);
        for (i, a) in views.iter().enumerate() {
            let nearest = views[i + 1..].iter().map(|b| a.forward.dot(b.forward));
            // Neighbouring corners of an icosahedron are 63.4° apart.
            assert!(nearest.fold(-1.0, f64::max) < 0.4473);
        }
    }
}
