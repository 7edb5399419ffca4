//! Vertices of all levels of a model, with normals.

use glam::DVec3;
use meshlod::mesh::Bounds;
use meshlod::multires::{Hierarchy, Query, QueryError, UpdateLimits};

use crate::mesh::{VertexAttributes, fractions};

/// Vertices of all levels of a model, as a [`GpuCut`](super::GpuCut) uploads them.
#[derive(Clone, Debug)]
pub struct CutVertices {
    pub(super) origin: [f64; 3],
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) attributes: Vec<VertexAttributes>,
}

impl CutVertices {
    /// Computes positions and normals: those of the finest level by the areas of its faces, and
    /// those of a coarser vertex by what it stands for.
    ///
    /// Cost: that of refining to the finest level, once.
    ///
    /// # Errors
    /// Never for a certified model.
    pub fn new(model: &Hierarchy) -> Result<Self, QueryError> {
        let count = model.node_count() as u32;
        let places: Vec<DVec3> = (0..count).map(|node| model.position(node).into()).collect();
        let bounds = Bounds::of(places.iter().map(|place| place.as_ref()));
        let origin = match bounds.is_empty() {
            true => DVec3::ZERO,
            false => (DVec3::from(bounds.min) + DVec3::from(bounds.max)) / 2.0,
        };
        let attributes = normals(model, &places)?
            .into_iter()
            .map(|normal| VertexAttributes {
                normal: fractions(normal.normalize_or_zero().as_vec3().into()),
                color: [255; 4],
                uv: [0.0; 2],
            })
            .collect();
        let positions = places.iter().map(|&place| (place - origin).as_vec3().into()).collect();
        Ok(Self { origin: origin.into(), positions, attributes })
    }

    /// Returns the box of all positions, in model units.
    pub fn bounds(&self) -> Bounds {
        let place = |p: &[f32; 3]| [0, 1, 2].map(|k| f64::from(p[k]) + self.origin[k]);
        let places: Vec<_> = self.positions.iter().map(place).collect();
        Bounds::of(&places)
    }
}

/// Sums the normals of all faces of the finest level that a node stands for.
fn normals(model: &Hierarchy, places: &[DVec3]) -> Result<Vec<DVec3>, QueryError> {
    let mut finest = model.cut();
    finest.update(&Query::uniform(0.0), &UpdateLimits::default())?;
    let mut sums = vec![DVec3::ZERO; places.len()];
    for (_, nodes) in finest.triangles() {
        let [a, b, c] = nodes.map(|node| places[node as usize]);
        let normal = (b - a).cross(c - a);
        nodes.iter().for_each(|&node| sums[node as usize] += normal);
    }
    // Children have higher numbers than their parent.
    for node in (0..places.len() as u32).rev() {
        if let Some([a, b]) = model.children_of(node) {
            sums[node as usize] = sums[a as usize] + sums[b as usize];
        }
    }
    Ok(sums)
}
