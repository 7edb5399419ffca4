//! Levels of a whole scene, taken apart into its meshes.

use std::collections::BTreeMap;

use glam::DMat4;
use meshlod_io::{Scene, transform};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId};

use super::head::{MeshEntry, Slot};
use super::place::slots_of_labels;

/// Puts the faces of a level into the empty meshes of its scene; `None` if they do not fit. `rounded`
/// tells that attributes have been rounded.
///
/// Cost: linear.
pub(super) fn split(
    level: &Mesh,
    entries: &[Option<MeshEntry>],
    slots: &[Slot],
    rounded: bool,
    scene: &mut Scene,
) -> Option<()> {
    let placed: Vec<usize> = (0..entries.len()).filter(|&m| entries[m].is_some()).collect();
    let (owners, firsts) = owners_of_objects(level, entries)?;
    let mut faces = vec![Vec::new(); entries.len()];
    for face in 0..level.faces.len() {
        let owner = match &level.objects {
            Some(objects) => *owners.get(objects.of(face) as usize)?,
            None => *placed.first().filter(|_| placed.len() == 1)?,
        };
        faces[owner].push(face as u32);
    }
    let mut select = Selector::new(level);
    for (index, entry) in entries.iter().enumerate() {
        let Some(entry) = entry else { continue };
        let into = scene.meshes.get_mut(index)?;
        let mut mesh = select.faces(&faces[index]);
        mesh.attributes = select.attributes(&faces[index], &entry.layers)?;
        let labels = level.materials.as_ref();
        let label = |face: &u32| labels.map(|labels| labels.of(*face as usize) as usize);
        let of_slots: BTreeMap<Slot, u32> =
            slots_of_labels(&into.materials).into_iter().zip(0..).collect();
        let of_face: Option<Vec<u32>> = faces[index]
            .iter()
            .map(|face| {
                let slot = label(face).and_then(|label| slots.get(label).copied());
                of_slots.get(&slot.unwrap_or_default()).copied()
            })
            .collect();
        let names = into.mesh.materials.take().map_or_else(Vec::new, |labels| labels.names);
        mesh.materials = Some(Labels { names, of_face: of_face? });
        if let (Some(objects), Some(count)) = (&level.objects, entry.objects) {
            let first = firsts[index];
            let names = objects.names[first as usize..(first + count) as usize].to_vec();
            let of_face = faces[index].iter().map(|&face| objects.of(face as usize) - first);
            mesh.objects = Some(Labels { names, of_face: of_face.collect() });
        }
        let back = DMat4::from_cols_array_2d(&entry.placement).inverse();
        if !back.is_finite() {
            return None;
        }
        if entry.placement != DMat4::IDENTITY.to_cols_array_2d() {
            transform(&mut mesh, &back.to_cols_array_2d());
        }
        if rounded {
            mend_weights(&mut mesh);
        }
        into.mesh = mesh;
    }
    Some(())
}

/// Returns the mesh of each object of a level, and the first object of each mesh; `None` if there
/// are more objects or fewer than the meshes have.
fn owners_of_objects(
    level: &Mesh,
    entries: &[Option<MeshEntry>],
) -> Option<(Vec<usize>, Vec<u32>)> {
    let Some(objects) = &level.objects else { return Some((Vec::new(), vec![0; entries.len()])) };
    let (mut owners, mut firsts) = (Vec::new(), vec![0; entries.len()]);
    for (index, entry) in entries.iter().enumerate() {
        let Some(entry) = entry else { continue };
        firsts[index] = owners.len() as u32;
        let end = owners.len().checked_add(entry.objects.unwrap_or(1) as usize)?;
        if end > objects.names.len() {
            return None;
        }
        owners.resize(end, index);
    }
    (owners.len() == objects.names.len()).then_some((owners, firsts))
}

/// Copies parts of a mesh, each vertex and wedge once a part.
struct Selector<'m> {
    mesh: &'m Mesh,
    vertices: Renumbering,
    wedges: Renumbering,
}

impl<'m> Selector<'m> {
    fn new(mesh: &'m Mesh) -> Self {
        let wedges = mesh.attributes.as_ref().map_or(0, |attributes| attributes.wedge_count);
        let [vertices, wedges] = [mesh.positions.len(), wedges].map(Renumbering::new);
        Self { mesh, vertices, wedges }
    }

    /// Returns some faces with their positions.
    fn faces(&mut self, faces: &[u32]) -> Mesh {
        self.vertices.begin();
        let corners = faces.iter().map(|&face| {
            self.mesh.faces[face as usize].map(|v| VertexId(self.vertices.number(v.0)))
        });
        let corners = corners.collect();
        let kept = self.vertices.kept.iter();
        Mesh::new(kept.map(|&v| self.mesh.positions[v as usize]).collect(), corners)
    }

    /// Returns some layers of the wedges of some faces, given by index and width; `None` if there
    /// are no such layers.
    fn attributes(&mut self, faces: &[u32], layers: &[[u32; 2]]) -> Option<Option<Attributes>> {
        if layers.is_empty() {
            return Some(None);
        }
        let all = self.mesh.attributes.as_ref().filter(|all| layers.len() <= all.layers.len())?;
        self.wedges.begin();
        let corners = faces
            .iter()
            .map(|&face| all.corners[face as usize].map(|w| WedgeId(self.wedges.number(w.0))));
        let corners = corners.collect();
        let layer = |&[index, width]: &[u32; 2]| {
            let layer = all.layers.get(index as usize)?;
            let width = width as usize;
            if width == 0 || width > layer.width || layer.kind.width().is_some_and(|w| w != width) {
                return None;
            }
            let values = self.wedges.kept.iter().flat_map(|&w| &layer.of(WedgeId(w))[..width]);
            let values = values.copied().collect();
            Some(Layer { kind: layer.kind, name: layer.name.clone(), width, values })
        };
        let layers = layers.iter().map(layer).collect::<Option<_>>()?;
        Some(Some(Attributes { corners, wedge_count: self.wedges.kept.len(), layers }))
    }
}

/// New numbers of elements, in the order in which they are first met.
struct Renumbering {
    round: u32,
    /// Round and new number of each element.
    numbers: Vec<(u32, u32)>,
    kept: Vec<u32>,
}

impl Renumbering {
    fn new(count: usize) -> Self {
        Self { round: 0, numbers: vec![(0, 0); count], kept: Vec::new() }
    }

    fn begin(&mut self) {
        self.round += 1;
        self.kept.clear();
    }

    fn number(&mut self, old: u32) -> u32 {
        let (round, number) = &mut self.numbers[old as usize];
        if *round != self.round {
            (*round, *number) = (self.round, self.kept.len() as u32);
            self.kept.push(old);
        }
        *number
    }
}

/// Largest change of a weight by rounding, by default.
const ROUNDING: f32 = 1.0 / 512.0;

/// Mends what rounding does to skinning weights: a sum that was one is one again, and a joint whose
/// weight has become 0 is joint 0, as glTF wants it.
fn mend_weights(mesh: &mut Mesh) {
    let Some(Attributes { wedge_count, layers, .. }) = &mut mesh.attributes else { return };
    let of_kind = |kind: fn(u8) -> LayerKind| {
        let at = |set| layers.iter().position(|layer| layer.kind == kind(set));
        (0..=u8::MAX).map_while(at).collect::<Vec<usize>>()
    };
    let (joints, weights) = (of_kind(LayerKind::Joints), of_kind(LayerKind::Weights));
    let most_off = ROUNDING * (4 * weights.len()) as f32;
    for wedge in (0..*wedge_count).map(WedgeId::new) {
        let sum: f32 = weights.iter().flat_map(|&at| layers[at].of(wedge)).sum();
        let factor = if (sum - 1.0).abs() <= most_off { 1.0 / sum } else { 1.0 };
        for (set, &at) in weights.iter().enumerate() {
            layers[at].of_mut(wedge).iter_mut().for_each(|weight| *weight *= factor);
            let is_zero: [bool; 4] = std::array::from_fn(|k| layers[at].of(wedge)[k] == 0.0);
            let Some(&joints) = joints.get(set) else { continue };
            let pairs = layers[joints].of_mut(wedge).iter_mut().zip(is_zero);
            pairs.filter(|(_, is_zero)| *is_zero).for_each(|(joint, _)| *joint = 0.0);
        }
    }
}
