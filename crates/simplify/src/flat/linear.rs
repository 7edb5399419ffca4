//! Whether attributes are linear over faces.

use glam::{DMat3, DVec2, DVec3};
use meshlod_mesh::{AttributeBounds, FaceId, Layer, LayerKind, Mesh, Side, WedgeId};

use crate::flat::regions::Region;

/// Part of the bounds of attributes that may be off: values between corners are off by as much again.
const PART: f64 = 0.5;

/// Attributes of a mesh, with how far each may be off.
#[derive(Debug)]
pub(super) struct Linear<'m> {
    mesh: &'m Mesh,
    layers: Vec<(&'m Layer, f64)>,
}

impl<'m> Linear<'m> {
    pub(super) fn new(mesh: &'m Mesh) -> Self {
        let bounds = AttributeBounds::default();
        let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
        Self { mesh, layers: layers.map(|layer| (layer, PART * bound(layer, &bounds))).collect() }
    }

    /// Returns true if attributes differ at an end of two sides that lie on each other.
    pub(super) fn is_seam(&self, side: Side, twin: Side) -> bool {
        let [here, there] = [side, twin].map(|side| self.wedges(side));
        // Ends of a side and its twin are the other way round.
        let differs = |layer: &Layer, a, b| layer.of(a) != layer.of(b);
        self.layers.iter().any(|(layer, _)| {
            differs(layer, here[0], there[1]) || differs(layer, here[1], there[0])
        })
    }

    /// Returns true if there is no seam between two faces, and what the first one has continues in
    /// the other.
    pub(super) fn is_linear_across(&self, side: Side, twin: Side) -> bool {
        self.is_linear_beyond(side, side, twin)
    }

    /// Returns true if there is no seam between two faces, and what a third one has, given by a side,
    /// continues in the second.
    pub(super) fn is_linear_beyond(&self, from: Side, side: Side, twin: Side) -> bool {
        let [here, there] = [from, twin].map(|side| self.wedges(side));
        let continues = |&(layer, most): &(&Layer, f64)| {
            self.continues(layer, most, (from, here), (twin, there))
        };
        !self.is_seam(side, twin) && self.layers.iter().all(continues)
    }

    /// Returns true if the values at the far corner of a face are those that the other one predicts.
    fn continues(
        &self,
        layer: &Layer,
        most: f64,
        (side, here): (Side, [WedgeId; 3]),
        (twin, there): (Side, [WedgeId; 3]),
    ) -> bool {
        let far = there[2];
        if !layer.kind.is_blended() || layer.kind.is_direction() {
            return here.iter().all(|&wedge| is_within(layer, [wedge, far], most));
        }
        let corners = self.mesh.triangle(self.mesh.faces[side.face().index()]);
        let [a, b, c] = [0, 1, 2].map(|k| corners[(side.corner() + k) % 3]);
        let other = self.mesh.triangle(self.mesh.faces[twin.face().index()]);
        let Some(weights) = weights([a, b, c], other[(twin.corner() + 2) % 3]) else {
            return false;
        };
        // What is far away is predicted as badly as the corners are known.
        let most = most * weights.iter().map(|w| w.abs()).sum::<f64>();
        let values = here.map(|wedge| layer.of(wedge));
        (0..layer.width).all(|k| {
            let predicted: f64 = (0..3).map(|i| weights[i] * f64::from(values[i][k])).sum();
            (predicted - f64::from(layer.of(far)[k])).abs() <= most
        })
    }

    /// Returns true if all attributes are linear over a region.
    pub(super) fn is_linear_over(&self, region: &Region) -> bool {
        if self.layers.is_empty() {
            return true;
        }
        let plane = Plane::new(region.normal);
        let mut wedges: Vec<(WedgeId, DVec2)> = Vec::with_capacity(3 * region.faces.len());
        for &face in &region.faces {
            let corners = self.mesh.triangle(self.mesh.faces[face as usize]);
            let own = self.mesh.corner_wedges(face as usize);
            wedges.extend(own.into_iter().zip(corners.map(|corner| plane.place(corner))));
        }
        wedges.sort_unstable_by_key(|&(wedge, _)| wedge);
        wedges.dedup_by_key(|&mut (wedge, _)| wedge);
        let fit = Fit::new(&wedges);
        self.layers.iter().all(|&(layer, most)| fit.is_linear(layer, most, &wedges))
    }

    /// Returns the wedges at the ends of a side and opposite it.
    fn wedges(&self, side: Side) -> [WedgeId; 3] {
        let wedges = self.mesh.corner_wedges(FaceId::index(side.face()));
        [0, 1, 2].map(|k| wedges[(side.corner() + k) % 3])
    }
}

/// Returns how far values of a layer may be off.
fn bound(layer: &Layer, bounds: &AttributeBounds) -> f64 {
    match layer.kind {
        LayerKind::Normal | LayerKind::Tangent => bounds.direction_rad,
        LayerKind::Uv(_) => bounds.uv,
        LayerKind::Color(_) => bounds.color,
        LayerKind::Weights(_) | LayerKind::Joints(_) | LayerKind::Label => 0.0,
        LayerKind::Other => {
            let finite = layer.values.iter().copied().filter(|value| value.is_finite());
            let [low, high] = finite.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            });
            bounds.other * f64::from(high - low).max(0.0)
        }
    }
}

fn is_within(layer: &Layer, [a, b]: [WedgeId; 2], most: f64) -> bool {
    let pairs = layer.of(a).iter().zip(layer.of(b));
    pairs.into_iter().all(|(&a, &b)| f64::from((a - b).abs()) <= most)
}

/// Returns the barycentric coordinates of a point in the plane of a triangle; `None` without area.
fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> Option<[f64; 3]> {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let part = |p: DVec3, q: DVec3| (p - point).cross(q - point).dot(normal) / area;
    (area > 0.0).then(|| [part(b, c), part(c, a), part(a, b)])
}

/// Two axes along a plane: those of space that it is least steep to, in the order that makes faces
/// counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    axes: [usize; 2],
}

impl Plane {
    pub(super) fn new(normal: DVec3) -> Self {
        let (steep, next) = match normal.abs() {
            n if n.z >= n.x && n.z >= n.y => (2, [0, 1]),
            n if n.y >= n.x => (1, [2, 0]),
            _ => (0, [1, 2]),
        };
        Self { axes: if normal[steep] > 0.0 { next } else { [next[1], next[0]] } }
    }

    /// Returns the place of a point, with two of its coordinates as they are.
    pub(super) fn place(&self, point: DVec3) -> DVec2 {
        DVec2::new(point[self.axes[0]], point[self.axes[1]])
    }
}

/// Linear functions that come nearest to values at places.
struct Fit {
    middle: DVec2,
    /// Size of the region, which coordinates are relative to.
    size: f64,
    inverse: Option<DMat3>,
}

impl Fit {
    fn new(wedges: &[(WedgeId, DVec2)]) -> Self {
        let count = wedges.len() as f64;
        let middle = wedges.iter().map(|&(_, place)| place).sum::<DVec2>() / count;
        let size = wedges.iter().map(|&(_, place)| (place - middle).abs().max_element());
        let size = size.fold(0.0, f64::max);
        let mut this = Self { middle, size, inverse: None };
        let mut sums = DMat3::ZERO;
        for &(_, place) in wedges {
            let row = this.row(place);
            sums += DMat3::from_cols(row.x * row, row.y * row, row.z * row);
        }
        let inverse = sums.inverse();
        this.inverse = inverse.is_finite().then_some(inverse);
        this
    }

    fn row(&self, place: DVec2) -> DVec3 {
        let at = (place - self.middle) / self.size;
        DVec3::new(1.0, at.x, at.y)
    }

    fn is_linear(&self, layer: &Layer, most: f64, wedges: &[(WedgeId, DVec2)]) -> bool {
        if !layer.kind.is_blended() || layer.kind.is_direction() {
            return wedges.iter().all(|&(wedge, _)| is_within(layer, [wedges[0].0, wedge], most));
        }
        let Some(inverse) = self.inverse else { return false };
        (0..layer.width).all(|k| {
            let value = |wedge| f64::from(layer.of(wedge)[k]);
            let sums: DVec3 = wedges.iter().map(|&(w, place)| value(w) * self.row(place)).sum();
            let found = inverse * sums;
            wedges.iter().all(|&(w, place)| (found.dot(self.row(place)) - value(w)).abs() <= most)
        })
    }
}
