//! Verification of triangle strips against an independent simplification.

use std::cmp::Reverse;
use std::collections::{HashMap, HashSet};

use meshlod_mesh::{FaceId, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod_simplify::{Simplifier, SimplifyError, Target};
use meshlod_strip::{MergeTree, Strips, difference};

use super::{FlatScene, StrippedLevelReport};

/// Compares the triangles drawn at each level with the faces left by simplifying to it, and at full
/// size with the cleaned faces of the mesh: their vertices, attributes and materials.
pub(super) fn compare(
    input: &FlatScene,
    tree: &MergeTree,
    levels: &[Strips],
    reports: &mut [StrippedLevelReport],
) -> Result<(), SimplifyError> {
    let mut levels: Vec<_> = levels.iter().zip(reports).collect();
    levels.sort_by_key(|(_, report)| Reverse(report.triangles));
    let finest = levels.partition_point(|(_, report)| report.triangles == tree.faces().len());
    let (finest, coarser) = levels.split_at_mut(finest);
    let mesh = &input.mesh;
    for (strips, report) in finest {
        let mut names = CornerNames::default();
        let faces = names.faces(mesh, &mesh.faces);
        let whole =
            whole_faces(&mesh.faces).into_iter().map(|face| faces[face]).collect::<Vec<_>>();
        report.compared(difference(&names.strips(mesh, tree, strips), &whole));
    }
    if coarser.is_empty() {
        return Ok(());
    }
    let options = MergeTree::options(&input.options);
    let mut simplifier = Simplifier::new(mesh, &options)?;
    for (strips, report) in coarser {
        simplifier.run(Target::Faces(report.triangles), &mut ())?;
        let surface = simplifier.surface();
        let ids = (0..surface.face_count()).map(FaceId::new);
        let alive = ids.filter(|&face| surface.is_alive(face));
        let vertices: Vec<_> = alive.map(|face| surface.face(face)).collect();
        let mut names = CornerNames::default();
        // The level has its faces in the order of the surface.
        let faces = names.faces(&simplifier.level(), &vertices);
        report.compared(difference(&names.strips(mesh, tree, strips), &faces));
    }
    Ok(())
}

/// Ids for corners by what they are: a vertex with a material and the bits of attribute values.
#[derive(Default)]
struct CornerNames {
    known: HashMap<(VertexId, u32, Vec<u32>), VertexId>,
}

impl CornerNames {
    /// Returns the faces of a mesh by such ids; `vertices` are those of each face.
    fn faces(&mut self, mesh: &Mesh, vertices: &[[VertexId; 3]]) -> Vec<[VertexId; 3]> {
        let corners = mesh.attributes.as_ref().map(|attributes| &attributes.corners);
        let face = |(face, vertices): (usize, &[VertexId; 3])| {
            [0, 1, 2].map(|k| {
                let wedge = corners.map_or(WedgeId(0), |corners| corners[face][k]);
                self.name(vertices[k], face, mesh, |_| wedge)
            })
        };
        vertices.iter().enumerate().map(face).collect()
    }

    /// Returns strips of a mesh by such ids.
    fn strips(&mut self, mesh: &Mesh, tree: &MergeTree, strips: &Strips) -> Strips {
        let wedges = tree.wedges(mesh);
        let mut named = Strips::default();
        for strip in strips.iter() {
            let wedges = strip.iter().map(|v| wedges[v.index()]);
            named.push(wedges.map(|wedge| {
                self.name(wedge.vertex, wedge.face.index(), mesh, |layer| wedge.source(layer))
            }));
        }
        named
    }

    /// Returns the id of a corner of a face.
    fn name(
        &mut self,
        vertex: VertexId,
        face: usize,
        mesh: &Mesh,
        wedge: impl Fn(LayerKind) -> WedgeId,
    ) -> VertexId {
        let material = mesh.materials.as_ref().map_or(0, |materials| materials.of(face));
        let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
        let values = layers.flat_map(|layer: &Layer| layer.of(wedge(layer.kind)));
        let corner = (vertex, material, values.map(|x| x.to_bits()).collect());
        let next = VertexId::new(self.known.len());
        *self.known.entry(corner).or_insert(next)
    }
}

/// Lists the faces that are neither degenerate nor repeat an earlier one.
fn whole_faces(faces: &[[VertexId; 3]]) -> Vec<usize> {
    let mut seen = HashSet::new();
    let is_whole = |&face: &usize| {
        let [a, b, c] = faces[face];
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        a != b && b != c && c != a && turns.into_iter().min().is_some_and(|turn| seen.insert(turn))
    };
    (0..faces.len()).filter(is_whole).collect()
}
