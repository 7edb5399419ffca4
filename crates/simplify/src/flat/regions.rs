//! Faces that lie in one plane and continue each other.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, UnionFind};
use robust::{Coord3D, orient3d};

use crate::flat::linear::Linear;
use crate::flat::slivers::Slivers;

/// Part of the tolerance that a region may be high. Outlines move across that, so that both may have
/// seven tenths.
const HEIGHT: f64 = 0.7;

/// Faces in one plane that continue each other.
#[derive(Debug, Default)]
pub(super) struct Region {
    /// The faces in order.
    pub(super) faces: Vec<u32>,
    /// Normal of the plane, not of unit length.
    pub(super) normal: DVec3,
    /// Largest distance between two planes along the normal that have all faces between them.
    pub(super) height: f64,
    /// True if the faces stay as they are.
    pub(super) is_kept: bool,
}

/// All regions of a mesh.
#[derive(Debug)]
pub(super) struct Regions {
    /// Region of each face.
    pub(super) of_face: Vec<u32>,
    /// The regions, in the order of their first faces.
    pub(super) list: Vec<Region>,
}

impl Regions {
    /// Finds the regions. Those of one face are kept, and so are those that are too high.
    pub(super) fn find(
        mesh: &Mesh,
        connectivity: &Connectivity,
        linear: &Linear<'_>,
        tolerance: f64,
    ) -> Self {
        let planes = Planes { mesh, tolerance, linear };
        let mut this = Self::group(&planes, connectivity);
        for region in &mut this.list {
            region.normal = region.faces.iter().map(|&face| normal(mesh, face)).sum();
            if tolerance > 0.0 {
                region.height = height(mesh, region);
            }
            let is_low = region.height <= HEIGHT * tolerance;
            region.is_kept = region.faces.len() < 2
                || !is_low
                || region.normal == DVec3::ZERO
                || !linear.is_linear_over(region);
        }
        this
    }

    /// Returns the bound of how far the surface moves, given how far outlines do: a point is beside
    /// its region by as much, and below or above it by no more than its height.
    pub(super) fn moved(&self, outlines: f64) -> f64 {
        let filled = self.list.iter().filter(|region| !region.is_kept);
        filled.map(|region| region.height).fold(0.0, f64::max).hypot(outlines)
    }

    fn group(planes: &Planes<'_>, connectivity: &Connectivity) -> Self {
        let mesh = planes.mesh;
        let mut joined = UnionFind::new(mesh.faces.len());
        let mut slivers = Vec::new();
        for face in (0..mesh.faces.len()).map(FaceId::new) {
            if planes.is_sliver(face.0) {
                slivers.push(face.0);
                continue;
            }
            for side in (0..3).map(|k| Side::new(face, k)) {
                if let Twin::Side(twin) = connectivity.twin(side)
                    && face < twin.face()
                    && planes.continues(side, twin)
                {
                    joined.union(face.0, twin.face().0);
                }
            }
        }
        Slivers::new(planes, connectivity, slivers).join(&mut joined);
        Self::of_groups(mesh.faces.len(), &mut joined)
    }

    fn of_groups(count: usize, joined: &mut UnionFind) -> Self {
        let mut list: Vec<Region> = Vec::new();
        let mut of_root = vec![u32::MAX; count];
        let of_face = (0..count as u32).map(|face| {
            let root = joined.find(face) as usize;
            if of_root[root] == u32::MAX {
                of_root[root] = list.len() as u32;
                list.push(Region::default());
            }
            list[of_root[root] as usize].faces.push(face);
            of_root[root]
        });
        Self { of_face: of_face.collect(), list }
    }
}

/// Decides which faces continue each other.
pub(super) struct Planes<'m> {
    pub(super) mesh: &'m Mesh,
    pub(super) tolerance: f64,
    pub(super) linear: &'m Linear<'m>,
}

impl Planes<'_> {
    /// Returns true if two faces with areas that share an edge lie in one plane, face the same way,
    /// and have all else in common.
    fn continues(&self, side: Side, twin: Side) -> bool {
        let faces = [side, twin].map(|side| side.face().0);
        let [ends, of_twin] = [side, twin].map(|side| side.ends(&self.mesh.faces));
        let [normal, other] = faces.map(|face| normal(self.mesh, face));
        !self.is_sliver(faces[1])
            && ends == [of_twin[1], of_twin[0]]
            && normal.dot(other) > 0.0
            && self.is_alike(faces)
            && self.contains(faces[0], self.opposite(twin))
            && (self.tolerance == 0.0 || self.contains(faces[1], self.opposite(side)))
            && self.linear.is_linear_across(side, twin)
    }

    /// Returns true if two faces with areas lie in one plane and face the same way.
    pub(super) fn is_same_plane(&self, a: u32, b: u32) -> bool {
        let corners = self.mesh.triangle(self.mesh.faces[b as usize]);
        normal(self.mesh, a).dot(normal(self.mesh, b)) > 0.0
            && corners.iter().all(|&corner| self.contains(a, corner))
    }

    /// Returns true if a point is in the plane of a face, to the tolerance.
    pub(super) fn contains(&self, face: u32, point: DVec3) -> bool {
        let corners = self.mesh.triangle(self.mesh.faces[face as usize]);
        if self.tolerance > 0.0 {
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            return normal.dot(point - corners[0]).abs() <= self.tolerance;
        }
        let [a, b, c, d] = [corners[0], corners[1], corners[2], point]
            .map(|DVec3 { x, y, z }| Coord3D { x, y, z });
        orient3d(a, b, c, d) == 0.0
    }

    /// Returns the corner of a face that is not on one of its sides.
    pub(super) fn opposite(&self, side: Side) -> DVec3 {
        let face = self.mesh.faces[side.face().index()];
        self.mesh.triangle(face)[(side.corner() + 2) % 3]
    }

    /// Returns true if two faces have the same material, object and numbers.
    pub(super) fn is_alike(&self, [a, b]: [u32; 2]) -> bool {
        let [a, b] = [a as usize, b as usize];
        let labels = [&self.mesh.materials, &self.mesh.objects].into_iter().flatten();
        labels.into_iter().all(|labels| labels.of(a) == labels.of(b))
            && self.mesh.face_layers.iter().all(|layer| layer.values[a] == layer.values[b])
    }
}

/// Returns the normal of a face, twice its area long.
pub(super) fn normal(mesh: &Mesh, face: u32) -> DVec3 {
    let [a, b, c] = mesh.triangle(mesh.faces[face as usize]);
    (b - a).cross(c - a)
}

/// Returns how high a region is along its normal.
fn height(mesh: &Mesh, region: &Region) -> f64 {
    let normal = region.normal.normalize_or_zero();
    let first = mesh.triangle(mesh.faces[region.faces[0] as usize])[0];
    let corners = region.faces.iter().flat_map(|&face| mesh.triangle(mesh.faces[face as usize]));
    let [mut low, mut high] = [0.0f64; 2];
    for height in corners.map(|corner| normal.dot(corner - first)) {
        (low, high) = (low.min(height), high.max(height));
    }
    high - low
}
