//! Poses of a single mesh: morphed, bent by a skin, moved by its node.

use glam::{DMat4, DVec3};
use meshlod_io::gltf::{Animator, Pose, parse_target_name};
use meshlod_mesh::{Layer, LayerKind, WedgeId};

use crate::scene::place::length_scale;

/// Attribute layers by which a mesh is posed.
#[derive(Clone, Debug, Default)]
pub(super) struct PoseLayers {
    /// Joints and their weights, four of each.
    influences: Vec<[usize; 2]>,
    /// Number of a morph target, and the layer of its offsets.
    targets: Vec<(usize, usize)>,
}

/// A mesh as one node shows it at a moment.
#[derive(Clone, Debug)]
pub(super) struct MeshPose {
    /// From where the mesh is placed to its own space.
    back: DMat4,
    /// From its own space to the scene, by the node.
    world: DMat4,
    /// Such matrices by each joint of the node's skin.
    joints: Option<Vec<DMat4>>,
    /// Weights of morph targets.
    weights: Vec<f64>,
}

/// Part by which a length may grow before a pose counts as enlarged.
const SAME: f64 = 1e-6;

impl PoseLayers {
    pub(super) fn of(layers: &[Layer]) -> Self {
        let at = |kind| layers.iter().position(|layer| layer.kind == kind && layer.width == 4);
        let influences = (0..=u8::MAX)
            .map_while(|set| Some([at(LayerKind::Joints(set))?, at(LayerKind::Weights(set))?]));
        let target = |(index, layer): (usize, &Layer)| {
            let (target, attribute) = parse_target_name(&layer.name)?;
            let is_offset = layer.kind == LayerKind::Other && attribute == "POSITION";
            (is_offset && layer.width == 3).then_some((target, index))
        };
        Self {
            influences: influences.collect(),
            targets: layers.iter().enumerate().filter_map(target).collect(),
        }
    }

    /// Returns the layers of these that a mesh has.
    pub(super) fn of_mesh(&self, has: impl Fn(usize) -> bool) -> Self {
        let Self { influences, targets } = self.clone();
        let influences = influences.into_iter().filter(|[joints, _]| has(*joints));
        let targets = targets.into_iter().filter(|(_, offsets)| has(*offsets));
        Self { influences: influences.collect(), targets: targets.collect() }
    }

    /// Returns true if a node can change the shape of a mesh that has these layers.
    pub(super) fn deforms(&self, animator: &Animator, node: usize) -> bool {
        self.bends(animator, node) || !self.targets.is_empty()
    }

    fn bends(&self, animator: &Animator, node: usize) -> bool {
        animator.skin(node).is_some() && !self.influences.is_empty()
    }

    /// Returns the greatest joint that has a weight in a wedge.
    pub(super) fn greatest_joint(&self, layers: &[Layer], wedge: WedgeId) -> Option<usize> {
        let influences = self.influences(layers, wedge);
        influences.filter(|(_, weight)| *weight > 0.0).map(|(joint, _)| joint).max()
    }

    /// Iterates over the joints of a wedge and their weights; negative ones count as none.
    fn influences<'l>(
        &'l self,
        layers: &'l [Layer],
        wedge: WedgeId,
    ) -> impl Iterator<Item = (usize, f64)> + 'l {
        self.influences.iter().flat_map(move |&[joints, weights]| {
            let weights =
                layers[weights].of(wedge).iter().map(|&weight| f64::from(weight.max(0.0)));
            layers[joints].of(wedge).iter().map(|&joint| joint as usize).zip(weights)
        })
    }
}

impl MeshPose {
    /// Poses a mesh with the given layers as a node shows it. `copy` puts one of several copies into
    /// the node's space, and `back` takes positions into the mesh's own space.
    pub(super) fn new(
        animator: &Animator,
        pose: &Pose,
        (node, copy): (usize, DMat4),
        (layers, back): (&PoseLayers, DMat4),
    ) -> Self {
        let world = |node: usize| DMat4::from_cols_array_2d(&pose.worlds[node]);
        let skin = animator.skin(node).filter(|_| layers.bends(animator, node));
        let joints = skin.map(|skin| {
            let pairs = skin.joints.iter().zip(&skin.inverse_bind);
            pairs.map(|(&joint, bind)| world(joint) * DMat4::from_cols_array_2d(bind)).collect()
        });
        let weights = match layers.targets.is_empty() {
            true => Vec::new(),
            false => pose.weights.get(node).cloned().unwrap_or_default(),
        };
        Self { back, world: world(node) * copy, joints, weights }
    }

    /// Returns true if the mesh does not just move as it is, or if it is enlarged.
    pub(super) fn changes_shape(&self) -> bool {
        let is_morphed = self.weights.iter().any(|&weight| weight != 0.0);
        is_morphed || self.joints.is_some() || self.stretch() > 1.0 + SAME
    }

    /// Returns the greatest factor by which its node lengthens what is placed.
    pub(super) fn stretch(&self) -> f64 {
        length_scale(&(self.world * self.back).to_cols_array_2d())
    }

    /// Returns where a wedge is, given where the mesh is placed. Weights of joints count by their
    /// share, as in renderers; a wedge without weight moves with the node.
    pub(super) fn place(
        &self,
        position: [f64; 3],
        (roles, layers): (&PoseLayers, &[Layer]),
        wedge: WedgeId,
    ) -> DVec3 {
        let mut own = self.back.transform_point3(position.into());
        for &(target, offsets) in &roles.targets {
            let weight = self.weights.get(target).copied().unwrap_or(0.0);
            if weight != 0.0 {
                let [x, y, z] = [0, 1, 2].map(|k| f64::from(layers[offsets].of(wedge)[k]));
                own += weight * DVec3::new(x, y, z);
            }
        }
        let Some(joints) = &self.joints else { return self.world.transform_point3(own) };
        let (mut sum, mut all) = (DVec3::ZERO, 0.0);
        for (joint, weight) in roles.influences(layers, wedge).filter(|(_, weight)| *weight > 0.0) {
            let Some(matrix) = joints.get(joint) else { continue };
            sum += weight * matrix.transform_point3(own);
            all += weight;
        }
        if all > 0.0 { sum / all } else { self.world.transform_point3(own) }
    }
}
