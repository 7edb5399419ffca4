//! Triangle strips of a view-dependent cut.

use meshlod_mesh::VertexId;
use meshlod_multires::{Cut, Implicit};
use thiserror::Error;

use crate::repair::{LiveStrips, StripEffort};
use crate::stripify::{StripOptions, stripify};
use crate::strips::Strips;

/// Triangle strips that follow a cut of a multiresolution model built by half-edge contractions.
///
/// They draw exactly the cut's triangles. Vertices are nodes of the finest level, so one vertex
/// buffer, filled from [`Implicit::position`], serves all cuts. For models whose points move, feed
/// the [patches](Cut::patches) of a cut to [`LiveStrips`] directly.
#[derive(Clone, Debug)]
pub struct CutStrips {
    /// Leaf at the position of each node.
    leaves: Vec<VertexId>,
    live: LiveStrips,
}

/// Error: the multiresolution model was not built by half-edge contractions, so vertices move.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "node {0} is at the position of neither child; build the model from half-edge contractions, for example with qem-endpoint"
)]
pub struct PointsMove(pub u32);

impl CutStrips {
    /// Builds triangle strips for the current cut of the model `mt`.
    ///
    /// Cost: one [`stripify`], plus linear in the model.
    /// # Errors
    /// If the model was not built by half-edge contractions.
    pub fn new(
        mt: &Implicit,
        cut: &Cut<'_>,
        options: &StripOptions,
        effort: StripEffort,
    ) -> Result<Self, PointsMove> {
        let leaves = leaves(mt)?;
        let triangles = cut.triangles().map(|(place, nodes)| (place, shown(&leaves, nodes)));
        let triangles: Vec<_> = triangles.collect();
        let faces: Vec<_> = triangles.iter().map(|&(_, face)| face).collect();
        let live = LiveStrips::new(triangles, &stripify(&faces, options), effort);
        Ok(Self { leaves, live })
    }

    /// Follows the last update of the cut, and returns the number of triangles added, removed or
    /// changed.
    ///
    /// No update of the cut may be skipped.
    ///
    /// Cost: proportional to the change.
    pub fn update(&mut self, cut: &Cut<'_>) -> usize {
        let Self { leaves, live } = self;
        live.update(
            cut.patches().map(|patch| (patch.slot, patch.new.map(|nodes| shown(leaves, nodes)))),
        )
    }

    /// Returns the current triangle strips, which draw exactly the cut's triangles.
    ///
    /// Cost: linear in their length.
    pub fn strips(&self) -> Strips {
        self.live.strips()
    }

    /// Returns the vertex at which a node of the model is drawn, which is a node of the finest
    /// level.
    pub fn vertex(&self, node: u32) -> VertexId {
        self.leaves[node as usize]
    }
}

fn shown(leaves: &[VertexId], nodes: [u32; 3]) -> [VertexId; 3] {
    nodes.map(|node| leaves[node as usize])
}

/// Finds for each node the leaf at its position.
fn leaves(mt: &Implicit) -> Result<Vec<VertexId>, PointsMove> {
    let mut leaves: Vec<_> = (0..mt.node_count()).map(VertexId::new).collect();
    // Children have higher numbers.
    for node in (0..mt.node_count() as u32).rev() {
        let Some(children) = mt.children_of(node) else { continue };
        let place = mt.position(node);
        let at_place = children.into_iter().find(|&child| mt.position(child) == place);
        leaves[node as usize] = leaves[at_place.ok_or(PointsMove(node))? as usize];
    }
    Ok(leaves)
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{grid, moebius};
    use meshlod_mesh::Mesh;
    use meshlod_multires::{Focus, Forest, Model, Query, Tolerance, UpdateLimits};
    use meshlod_samples as samples;
    use meshlod_simplify::Method;

    use super::*;
    use crate::verify::{Difference, difference};

    fn model(mesh: &Mesh, method: Method) -> Model {
        let options = meshlod_simplify::Options { method, ..Default::default() };
        Model::new(&Forest::new(mesh, &options).unwrap()).unwrap()
    }

    /// Moves a fully detailed sphere across the model.
    fn follows(mesh: &Mesh) {
        let model = model(mesh, Method::QemEndpoint);
        let mut cut = model.cut();
        let options = StripOptions::default();
        let mut strips =
            CutStrips::new(model.implicit(), &cut, &options, StripEffort::Quick).unwrap();
        let bounds = mesh.bounds();
        for step in [0, 3, 10, 11, 12, 4, 0, 7] {
            let center = std::array::from_fn(|k| {
                bounds.min[k] + (bounds.max[k] - bounds.min[k]) * f64::from(step) / 12.0
            });
            let focus = Focus::Sphere { center, radius: 0.25 * bounds.diagonal() };
            let query = Query { focus, tolerance: Tolerance::Uniform(0.0) };
            cut.update(&query, &UpdateLimits::default()).unwrap();
            assert!(strips.update(&cut) <= cut.patches().count());
            let faces: Vec<_> =
                cut.triangles().map(|(_, nodes)| nodes.map(|node| strips.vertex(node))).collect();
            assert_eq!(difference(&strips.strips(), &faces), Difference::default(), "{step}");
        }
    }

    #[test]
    fn every_cut_is_drawn() {
        [samples::torus(800), grid(10), moebius(30)].iter().for_each(follows);
    }

    #[test]
    fn vertices_are_where_their_nodes_are() {
        let model = model(&samples::sphere(400), Method::QemEndpoint);
        let mt = model.implicit();
        let strips =
            CutStrips::new(mt, &model.cut(), &StripOptions::default(), StripEffort::Quick).unwrap();
        for node in 0..mt.node_count() as u32 {
            let leaf = strips.vertex(node).0;
            assert_eq!(mt.position(leaf), mt.position(node));
            assert_eq!(mt.children_of(leaf), None);
        }
    }

    #[test]
    fn where_points_move_it_is_said() {
        let model = model(&samples::sphere(400), Method::Qem);
        let made = CutStrips::new(
            model.implicit(),
            &model.cut(),
            &StripOptions::default(),
            StripEffort::Quick,
        );
        assert!(made.is_err());
    }
}
