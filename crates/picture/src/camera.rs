//! Where the eye is, and how it finds its place.

use glam::DVec3;
use meshlod_mesh::{Bounds, Mesh};

use crate::trigonometry::tangent;

/// A perspective camera with square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    tan_half_fov: f64,
    near: f64,
}

/// How [`Camera::fit`] looks at its object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where to look, of any length.
    pub direction: [f64; 3],
    /// What shall be up in the picture, of any length.
    pub up: [f64; 3],
    /// The angle that the shorter side of the picture sees, in radians.
    pub fov_rad: f64,
    /// How much of the frame the object fills, 0 to 1: of its width or its height, whichever is
    /// reached first.
    pub fill: f64,
    /// Width by height of the picture.
    pub aspect: f64,
}

/// The axis that points up in the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// As in glTF and most scans.
    #[default]
    Y,
    /// As in CAD and terrains.
    Z,
}

impl Default for View {
    fn default() -> Self {
        Self::three_quarter(UpAxis::Y)
    }
}

impl View {
    /// From the front, a little from the right and above: a good first look at anything.
    pub fn three_quarter(up: UpAxis) -> Self {
        let (direction, up) = match up {
            UpAxis::Y => ([-0.5, -0.4, -1.0], [0.0, 1.0, 0.0]),
            UpAxis::Z => ([-0.5, 1.0, -0.4], [0.0, 0.0, 1.0]),
        };
        Self { direction, up, fov_rad: std::f64::consts::FRAC_PI_4, fill: 0.8, aspect: 1.0 }
    }
}

impl Camera {
    /// A camera at `eye` that looks at `target`; `fov_rad` is what the picture's shorter side sees.
    ///
    /// What is nearer than a thousandth of the way to the target is not shown.
    pub fn look_at(eye: [f64; 3], target: [f64; 3], up: [f64; 3], fov_rad: f64) -> Self {
        let (eye, target) = (DVec3::from(eye), DVec3::from(target));
        let [right, up, forward] = frame(target - eye, up.into());
        let distance = (target - eye).length();
        Self { eye, right, up, forward, tan_half_fov: half_tangent(fov_rad), near: near(distance) }
    }

    /// A camera that sees a whole box, as large as `view.fill` lets it be. An empty box counts as
    /// a point at the origin.
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

    /// A camera that sees a whole mesh, as large as `view.fill` lets it be: closer than
    /// [`Camera::fit`] of its box. Vertices that no face uses do not count.
    ///
    /// Cost: O(n), n = faces.
    pub fn fit_mesh(mesh: &Mesh, view: &View) -> Self {
        let points = mesh.faces.iter().flatten().map(|v| DVec3::from(mesh.positions[v.index()]));
        Self::fit_points(points, view)
    }

    /// The twelve views in which pictures of two meshes are compared: from the corners of an
    /// icosahedron, the mesh filling 80% of a square frame, 45°.
    ///
    /// Use the cameras of the reference mesh for both pictures.
    pub fn icosahedron_views(mesh: &Mesh) -> [Self; 12] {
        Self::cyclic_views(mesh, [1.0, GOLDEN])
    }

    /// Twelve more, from the corners of the icosahedron that is the first one turned by a right
    /// angle: together they look from 24 sides.
    pub fn other_icosahedron_views(mesh: &Mesh) -> [Self; 12] {
        Self::cyclic_views(mesh, [GOLDEN, 1.0])
    }

    /// Views from (0, ±a, ±b) and its turns of the coordinates.
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

    /// Where the eye is.
    pub fn eye(&self) -> [f64; 3] {
        self.eye.into()
    }

    /// Where it looks: a unit vector.
    pub fn forward(&self) -> [f64; 3] {
        self.forward.into()
    }

    /// The depth along [`Camera::forward`] before which nothing is shown, in model units.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// The same camera with another near plane, which must be above zero.
    pub fn with_near(self, near: f64) -> Self {
        Self { near: near.max(f64::MIN_POSITIVE), ..self }
    }

    /// The width of a pixel at a depth of 1, in a picture of that shorter side.
    pub(crate) fn pixel_width(&self, side: u32) -> f64 {
        2.0 * self.tan_half_fov / f64::from(side)
    }

    /// Every side of the frame bounds the eye by one linear inequality per point, so that four
    /// maxima give the closest eye, in the middle of what is left free.
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
        let z = by_width.min(by_height).min(depths[0] - LEAST_GAP * (depths[1] - depths[0]));
        // A single point has no size to go by.
        let z = if z < depths[0] { z } else { depths[0] - 1.0 };
        let (x, y) = ((sides[0] - sides[1]) / 2.0, (sides[2] - sides[3]) / 2.0);
        let eye = right * x + up * y + forward * z;
        Self { eye, right, up, forward, tan_half_fov, near: near(depths[0] - z) }
    }

    /// The camera over a grid of `width` by `height` cells: pixels or samples.
    pub(crate) fn lens(&self, width: u32, height: u32) -> Lens {
        let middle = [f64::from(width) * 0.5, f64::from(height) * 0.5];
        let focal = middle[0].min(middle[1]) / self.tan_half_fov;
        Lens { camera: *self, middle, focal }
    }
}

/// The golden ratio, (1 + √5) / 2.
const GOLDEN: f64 = 1.618033988749895;

/// How far the eye stays before what it fits into the frame, by how deep that is: a needle that
/// points at the eye would else touch it.
const LEAST_GAP: f64 = 0.05;

/// A camera over a grid of cells, pixels or samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    camera: Camera,
    /// Where the optical axis meets the grid.
    middle: [f64; 2],
    /// Distance of the picture plane, in cells.
    focal: f64,
}

impl Lens {
    /// Homogeneous grid coordinates [x w, y w, w] of a point; w is its depth, y goes down.
    #[inline]
    pub(crate) fn project(&self, point: DVec3) -> DVec3 {
        let Camera { eye, right, up, forward, .. } = self.camera;
        let offset = point - eye;
        let depth = offset.dot(forward);
        let x = self.middle[0] * depth + self.focal * offset.dot(right);
        let y = self.middle[1] * depth - self.focal * offset.dot(up);
        DVec3::new(x, y, depth)
    }

    /// The way from the eye through a place of the grid, 1 deep.
    #[inline]
    pub(crate) fn ray(&self, x: f64, y: f64) -> DVec3 {
        let [dx, dy] = self.ray_steps();
        self.camera.forward + dx * (x - self.middle[0]) + dy * (y - self.middle[1])
    }

    /// What a step of one cell, to the right and down, adds to the ray.
    #[inline]
    pub(crate) fn ray_steps(&self) -> [DVec3; 2] {
        [self.camera.right / self.focal, self.camera.up / -self.focal]
    }

    #[inline]
    pub(crate) fn eye(&self) -> DVec3 {
        self.camera.eye
    }

    /// Unit vectors to the right, up and into the picture.
    pub(crate) fn axes(&self) -> [DVec3; 3] {
        [self.camera.right, self.camera.up, self.camera.forward]
    }

    pub(crate) fn near(&self) -> f64 {
        self.camera.near
    }
}

/// Right, up, forward as unit vectors; another "up" is taken where the wanted one lies along the
/// direction.
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

/// Between 1° and 150° whatever is asked for.
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

    /// Least and greatest x and y of the box's corners in a frame of 1000 by 1000 / aspect.
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
