//! Levels of a model as they are drawn: with normals, groups, places and colours.

use std::sync::Arc;

use glam::DVec3;
use meshlod::mesh::{Bounds, LayerKind};
use meshlod::model::SceneLayout;
use meshlod::multires::{Hierarchy, Implicit, Query, QueryError, UpdateLimits};
use meshlod::scene::OwnedPaint;

use super::groups::Groups;
use super::places::Places;

/// Levels of a model as a [`GpuCut`](super::GpuCut) draws them and a
/// [`CutFollower`](super::CutFollower) follows them.
///
/// A vertex on the GPU is a wedge of the model, or a node if it has no wedges.
#[derive(Clone, Debug)]
pub struct CutModel {
    levels: Hierarchy,
    /// Normals of the nodes of a height field, which has no layers.
    pub(super) field_normals: Vec<DVec3>,
    origin: DVec3,
    pub(super) groups: Groups,
    pub(super) places: Places,
    bounds: Bounds,
    paint: Arc<OwnedPaint>,
    /// Whether each material is single-sided.
    single_sided: Arc<[bool]>,
}

impl CutModel {
    /// Prepares levels to be drawn in the layout of their scene; the default layout shows them
    /// untransformed, with their own materials.
    ///
    /// Levels without normals get computed ones: in the finest level by the areas of faces, at a
    /// coarser vertex the sum over the vertices that it replaces. Cost: refining to the finest
    /// level, once, and linear.
    ///
    /// # Errors
    /// Never for a certified model.
    pub fn new(levels: Hierarchy, layout: &SceneLayout) -> Result<Self, QueryError> {
        let count = levels.node_count() as u32;
        let nodes: Vec<DVec3> = (0..count).map(|node| levels.position(node).into()).collect();
        let bounds = Bounds::of(nodes.iter().map(|place| place.as_ref()));
        let origin = match bounds.is_empty() {
            true => DVec3::ZERO,
            false => DVec3::from(bounds.min) / 2.0 + DVec3::from(bounds.max) / 2.0,
        };
        let has_normals =
            |model: &Implicit| model.layers().any(|layer| layer.kind == LayerKind::Normal);
        let mut field_normals = Vec::new();
        let levels = match levels {
            Hierarchy::Contractions(model) if has_normals(&model) => model.into(),
            levels => {
                let normals = normals(&levels, &nodes)?;
                match levels {
                    Hierarchy::Contractions(model) => {
                        let unit = normals.iter().map(|n| n.normalize_or_zero().as_vec3().into());
                        model.with_normals(&unit.collect::<Vec<_>>()).into()
                    }
                    field => {
                        field_normals = normals;
                        field
                    }
                }
            }
        };
        let groups = Groups::new(&levels, layout);
        let places = Places::new(&layout.instances, groups.boxes(&levels));
        let bounds = if places.is_own() { bounds } else { places.bounds() };
        let (paint, single_sided) = (Arc::new(OwnedPaint::CLAY), Arc::default());
        Ok(Self { levels, field_normals, origin, groups, places, bounds, paint, single_sided })
    }

    /// Gives the levels the colours of their scene, and the materials that are
    /// [single-sided](meshlod::picture::Style::single_sided); without, they are of clay.
    pub fn with_paint(self, paint: Arc<OwnedPaint>, single_sided: Arc<[bool]>) -> Self {
        Self { paint, single_sided, ..self }
    }

    /// Returns the colours of the surface.
    pub(super) fn paint(&self) -> &OwnedPaint {
        &self.paint
    }

    /// Returns whether each material is single-sided.
    pub(super) fn single_sided(&self) -> &[bool] {
        &self.single_sided
    }

    /// Returns the levels, with normals.
    pub fn levels(&self) -> &Hierarchy {
        &self.levels
    }

    /// Returns the box of the vertices of all levels, wherever the scene shows them.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Returns the point that positions on the GPU are relative to.
    pub(super) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Returns the levels if they are contractions, which have layers and can move.
    pub(super) fn contractions(&self) -> Option<&Implicit> {
        match &self.levels {
            Hierarchy::Contractions(model) => Some(model),
            Hierarchy::RightTriangles(_) => None,
        }
    }
}

/// Sums, for each node, the normals of the faces of the finest level at the vertices it replaces.
fn normals(model: &Hierarchy, places: &[DVec3]) -> Result<Vec<DVec3>, QueryError> {
    let mut finest = model.cut();
    finest.update(&Query::uniform(0.0), &UpdateLimits::default())?;
    let mut sums = vec![DVec3::ZERO; places.len()];
    for (_, nodes) in finest.slot_mesh().triangles() {
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
