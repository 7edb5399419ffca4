//! Table of all levels of a model, in one vertex buffer and one index buffer.

use std::ops::Range;

use glam::Vec3;
use meshlod_mesh::{Attributes, Labels, Layer, Mesh, MeshError, VertexId, WedgeId};
use meshlod_picture::PictureError;
use meshlod_simplify::SimplifyError;
use thiserror::Error;

use crate::levels::difference::Differences;
use crate::levels::directions::DirectionGrid;
use crate::levels::model::ModelAxes;

/// Levels of one model, which a renderer binds once and draws thousands of times.
///
/// Vertices are in the frame of a member: left +x, up +y, heading +z, one body length long and
/// centred at the origin.
#[derive(Clone, Debug)]
pub struct LevelTable {
    /// Position of each vertex, in body lengths.
    pub positions: Vec<[f32; 3]>,
    /// Attribute layers, with values for every vertex; there are always normals.
    pub layers: Vec<Layer>,
    /// Vertices of each triangle, level after level, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Material of each triangle, if the model has materials.
    pub materials: Option<Labels>,
    /// Levels of all chains, chain after chain, then those of the facing chains, depth after depth.
    pub levels: Vec<Level>,
    /// Simplified chains: the whole, the left-coarsened and the right-coarsened.
    pub chains: [Chain; 3],
    /// Levels of the facing chains at each depth of the whole chain.
    pub facing: Vec<FacingLevels>,
    /// Differences between pictures of the model and of the levels of the whole chain.
    pub differences: Differences,
    /// Radius of the ball around the origin that holds all vertices, in body lengths.
    pub radius: f32,
    /// Half of the extent along each axis, in body lengths.
    pub half_extent: [f32; 3],
}

/// Level of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Chain of the level.
    pub chain: ChainKind,
    /// Place of the level in its chain, the finest first.
    pub depth: usize,
    /// Triangles of the level, a range of [`LevelTable::triangles`].
    pub triangles: Range<usize>,
    /// Greatest distance of the model's vertices from the level, in body lengths.
    pub error: f32,
}

/// Chain of simplified levels, finest first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain {
    /// How the levels of the chain are coarsened.
    pub kind: ChainKind,
    /// Levels of the chain, a range of [`LevelTable::levels`]. The first is the model itself.
    pub levels: Range<usize>,
}

/// How the levels of a chain are coarsened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainKind {
    /// Evenly.
    Whole,
    /// Mostly on the member's left side.
    LeftCoarsened,
    /// Mostly on the member's right side.
    RightCoarsened,
    /// As the whole chain, without the faces that are hidden from a cell of the grid of directions
    /// of the depth.
    Facing(usize),
}

/// Levels of all facing chains at one depth, one for each cell of a grid of directions.
#[derive(Clone, Debug, PartialEq)]
pub struct FacingLevels {
    /// Directions in the frame of a member, from it to the eye. The finer a level, the fewer cells,
    /// so that no depth takes much more room than another.
    pub directions: DirectionGrid,
    /// Levels in the order of the cells, a range of [`LevelTable::levels`]; empty where the level
    /// is so fine that even few cells would take too much room.
    pub levels: Range<usize>,
}

/// Reason why no levels can be built for a model.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// The model is not a valid mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The model has no faces, or its size is zero or out of range.
    #[error("the model has no extent")]
    NoExtent,
    /// The forward and up axes of the model do not span a plane.
    #[error("the model's forward and up axes must be two directions, not {:?} and {:?}", .0.forward, .0.up)]
    Axes(ModelAxes),
    /// The model cannot be simplified.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// A picture of the model cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// An option is out of range.
    #[error("{0}")]
    Option(String),
}

impl LevelTable {
    /// Upper limit of the levels of a table, which instances count in two bytes.
    pub const MAX_LEVELS: usize = u16::MAX as usize - 1;

    /// Returns the number of triangles of a level.
    #[inline]
    pub fn triangle_count(&self, level: usize) -> usize {
        self.levels[level].triangles.len()
    }

    /// Returns the number of levels of the whole chain, and of each facing chain.
    pub fn depth(&self) -> usize {
        self.chains[0].levels.len()
    }

    /// Returns the level of the facing chains at a depth for an eye in a direction, in the frame of
    /// the member. It holds from [`NEAREST_FACING`](crate::levels::NEAREST_FACING) body lengths on.
    pub fn facing_level(&self, depth: usize, direction: Vec3) -> usize {
        let FacingLevels { directions, levels } = &self.facing[depth];
        if levels.is_empty() { depth } else { levels.start + directions.cell(direction) }
    }

    /// Returns the chain and depth that decide how a level looks. A facing level looks like the
    /// level of the whole chain at its depth.
    pub fn appearance(&self, level: usize) -> (ChainKind, usize) {
        match self.levels[level] {
            Level { chain: ChainKind::Facing(_), depth, .. } => (ChainKind::Whole, depth),
            Level { chain, depth, .. } => (chain, depth),
        }
    }

    /// Returns the radius of the ball around the origin that holds all vertices, and half of their
    /// extent along each axis.
    pub fn extent_of(positions: &[[f32; 3]]) -> (f32, [f32; 3]) {
        let length = |p: &[f32; 3]| glam::Vec3::from(*p).length();
        let most = |axis: usize| positions.iter().map(|p| p[axis].abs()).fold(0.0, f32::max);
        (positions.iter().map(length).fold(0.0, f32::max), [0, 1, 2].map(most))
    }

    /// Returns a level as a separate mesh, with all vertices of the table.
    pub fn mesh(&self, level: usize) -> Mesh {
        let range = self.levels[level].triangles.clone();
        let triangles = &self.triangles[range.clone()];
        let kept: Vec<u32> = range.map(|triangle| triangle as u32).collect();
        Mesh {
            positions: self.positions.iter().map(|p| p.map(f64::from)).collect(),
            faces: triangles.iter().map(|t| t.map(VertexId)).collect(),
            attributes: Some(Attributes {
                corners: triangles.iter().map(|t| t.map(WedgeId)).collect(),
                wedge_count: self.positions.len(),
                layers: self.layers.clone(),
            }),
            materials: self.materials.as_ref().map(|labels| labels.select(&kept)),
            ..Mesh::default()
        }
    }
}
