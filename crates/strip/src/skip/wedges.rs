//! Wedges that triangle strips draw: those of a mesh, and those that contractions make.

use meshlod_mesh::{FaceId, Labels, LayerKind, Mesh, VertexId, WedgeId};
use rustc_hash::FxHashMap;

/// A vertex of triangle strips with its attributes, given by where they are in the mesh.
///
/// It is a wedge of the mesh, or one that lies at another vertex of it: where two wedges of a
/// removed vertex are in one chart and only one has a counterpart at the vertex that stays, the
/// other keeps its normal and takes its remaining attributes from there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripWedge {
    /// Vertex of the mesh at which it lies.
    pub vertex: VertexId,
    /// Wedge of the mesh that has its normal and tangent.
    pub shading: WedgeId,
    /// Wedge of the mesh that has its other attributes.
    pub texture: WedgeId,
    /// A face of the mesh at which it began; all its faces have that one's material and object.
    pub face: FaceId,
}

impl StripWedge {
    /// Returns the wedge of the mesh that has its values in a layer of this kind.
    #[inline]
    pub fn source(&self, kind: LayerKind) -> WedgeId {
        match kind {
            LayerKind::Normal | LayerKind::Tangent => self.shading,
            _ => self.texture,
        }
    }
}

/// Wedges of a mesh, split further where the material or the object changes, as
/// [`Surface`](meshlod_simplify::Surface) splits them.
pub(super) struct MeshWedges {
    pub(super) wedges: Vec<StripWedge>,
    /// Wedges of each face, by index into `wedges`.
    pub(super) corners: Vec<[VertexId; 3]>,
}

impl MeshWedges {
    /// Collects the wedges of a mesh; `None` if its vertices will do.
    pub(super) fn new(mesh: &Mesh) -> Option<Self> {
        let has_several =
            |labels: &Option<Labels>| labels.as_ref().is_some_and(|labels| labels.names.len() > 1);
        let has_labels = has_several(&mesh.materials) || has_several(&mesh.objects);
        if mesh.attributes.is_none() && !has_labels {
            return None;
        }
        let this = Self::collect(mesh);
        let is_split = mesh.attributes.is_some() || this.wedges.len() > mesh.positions.len();
        is_split.then_some(this)
    }

    /// Collects the wedges of a mesh, one a vertex if it has no attributes.
    pub(super) fn collect(mesh: &Mesh) -> Self {
        let labels = |face: usize| {
            [&mesh.materials, &mesh.objects].map(|labels| labels.as_ref().map(|l| l.of(face)))
        };
        let highest = |corners: &Vec<[WedgeId; 3]>| corners.iter().flatten().max().copied();
        let count = match &mesh.attributes {
            // Without layers, `wedge_count` may be any number.
            Some(attributes) => highest(&attributes.corners).map_or(0, |wedge| wedge.index() + 1),
            None => mesh.positions.len(),
        };
        let mut this = Self::unused(count);
        // The first labels to use a wedge keep it, the others get copies.
        let mut owner = vec![None; count];
        let mut copies = FxHashMap::default();
        for (face, vertices) in mesh.faces.iter().enumerate() {
            let labels = labels(face);
            let wedges = mesh.corner_wedges(face);
            let corner = |k: usize| {
                let own = wedges[k];
                let wedge = StripWedge {
                    vertex: vertices[k],
                    shading: own,
                    texture: own,
                    face: FaceId::new(face),
                };
                match owner[own.index()] {
                    None => {
                        owner[own.index()] = Some(labels);
                        this.wedges[own.index()] = wedge;
                        VertexId(own.0)
                    }
                    Some(first) if first == labels => VertexId(own.0),
                    Some(_) => *copies.entry((own, labels)).or_insert_with(|| {
                        this.wedges.push(wedge);
                        VertexId::new(this.wedges.len() - 1)
                    }),
                }
            };
            let corners = [0, 1, 2].map(corner);
            this.corners.push(corners);
        }
        this
    }

    /// Begins with wedges that no face uses.
    fn unused(count: usize) -> Self {
        let wedge = |i| StripWedge {
            vertex: VertexId(0),
            shading: WedgeId::new(i),
            texture: WedgeId::new(i),
            face: FaceId(0),
        };
        Self { wedges: (0..count).map(wedge).collect(), corners: Vec::new() }
    }
}
