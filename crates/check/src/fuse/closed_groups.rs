//! Tests whether the faces left of fused components form a closed surface.

use glam::{DMat3, DVec3};
use meshlod_mesh::{Mesh, UnionFind, VertexId};
use rustc_hash::FxHashMap;

use crate::unique_positions::UniquePositions;

/// Groups of solid components that are connected through common vertex positions.
pub struct SolidGroups {
    /// Group of each face; `None` if its component is not solid.
    of_face: Vec<Option<u32>>,
    count: usize,
}

/// Sums over faces that identify a closed surface by the divergence theorem.
///
/// The area vectors of a closed surface sum to zero, and their products with the face centres to
/// the volume, equal along all axes, with zero off the diagonal. Counting sides would fail where
/// edges of one face end within those of another.
#[derive(Clone, Copy, Default)]
struct DivergenceSums {
    origin: DVec3,
    normals: DVec3,
    products: DMat3,
    area: f64,
    reach: f64,
}

/// Rounding tolerance relative to area and size.
const ROUNDING: f64 = 1e-9;

impl SolidGroups {
    /// Builds the groups from the component of each face and a flag per component, true if it is
    /// solid.
    pub fn of(mesh: &Mesh, component: &[u32], is_solid: &[bool]) -> Self {
        let unique = UniquePositions::of(&mesh.positions);
        let solid = component.iter().map(|&own| Some(own).filter(|_| is_solid[own as usize]));
        let mut of_face: Vec<Option<u32>> = solid.collect();
        let mut groups = UnionFind::new(is_solid.len());
        let mut first: FxHashMap<VertexId, u32> = FxHashMap::default();
        for (face, component) in mesh.faces.iter().zip(&of_face) {
            let Some(component) = *component else { continue };
            for v in face.map(|v| unique.representative(v)) {
                groups.union(*first.entry(v).or_insert(component), component);
            }
        }
        of_face.iter_mut().flatten().for_each(|group| *group = groups.find(*group));
        Self { of_face, count: is_solid.len() }
    }

    pub fn of_face(&self, face: usize) -> Option<usize> {
        self.of_face[face].map(|group| group as usize)
    }

    /// Returns a flag per group, true if its faces that are kept form a closed surface.
    pub fn closed(&self, mesh: &Mesh, keeps: impl Fn(usize) -> bool) -> Vec<bool> {
        let mut sums: Vec<Option<DivergenceSums>> = vec![None; self.count];
        for (f, &face) in mesh.faces.iter().enumerate().filter(|(f, _)| keeps(*f)) {
            let Some(group) = self.of_face(f) else { continue };
            let triangle = mesh.triangle(face);
            let start = || DivergenceSums { origin: triangle[0], ..DivergenceSums::default() };
            sums[group].get_or_insert_with(start).add(&triangle);
        }
        sums.into_iter().map(|sum| sum.is_none_or(|sum| sum.is_closed())).collect()
    }
}

impl DivergenceSums {
    fn add(&mut self, triangle: &[DVec3; 3]) {
        let [a, b, c] = triangle.map(|corner| corner - self.origin);
        let normal = (b - a).cross(c - a);
        let middle = (a + b + c) / 3.0;
        self.normals += normal;
        self.products += DMat3::from_cols(normal * middle.x, normal * middle.y, normal * middle.z);
        self.area += normal.length();
        self.reach = self.reach.max(middle.length());
    }

    fn is_closed(&self) -> bool {
        let volume = self.products.x_axis.x;
        let uneven = (self.products - DMat3::from_diagonal(DVec3::splat(volume))).to_cols_array();
        let rounding = ROUNDING * self.area;
        self.normals.length() <= rounding
            && uneven.iter().all(|product| product.abs() <= rounding * self.reach)
    }
}
