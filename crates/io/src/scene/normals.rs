//! Normalization of normals on reading: error bounds and rendering rely on unit length.

use glam::DVec3;
use meshlod_mesh::{Layer, LayerKind, Mesh, WedgeId};

use super::Scene;
use crate::notes::Note;

/// Largest deviation from length 1 that counts as rounding.
const ROUNDING: f64 = 1e-3;

/// Largest deviation from length 1 that counts as rounding of byte components.
const ROUNDING_OF_BYTES: f64 = 2e-2;

/// Scales all normals in use to unit length. Zero normals become the mean normal of the adjacent
/// faces. Notes the number of both.
///
/// Cost: linear; a single pass if all normals are unit.
pub(crate) fn make_unit(scene: &mut Scene) {
    let rounding = rounding(scene);
    let (mut scaled, mut computed) = (0, 0);
    let source = scene.source.as_ref();
    for (index, mesh) in scene.meshes.iter_mut().enumerate() {
        let bare = source.map_or_else(Vec::new, |source| source.lacks_normals(index));
        let counts = make_mesh_unit(&mut mesh.mesh, rounding, &bare);
        scaled += counts.scaled;
        computed += counts.computed;
    }
    let notes = [
        scaled_note(scaled),
        Note::changed(
            computed,
            "normal without a length computed from the faces around it",
            "normals without a length computed from the faces around them",
        ),
    ];
    scene.notes.extend(notes.into_iter().filter(|note| note.count > 0));
}

/// Returns the largest deviation of a normal's length from 1 that counts as rounding.
pub(crate) fn rounding(scene: &Scene) -> f64 {
    let quantized = scene.source.as_ref().is_some_and(|source| source.is_quantized());
    if quantized { ROUNDING_OF_BYTES } else { ROUNDING }
}

/// Notes how many normals were scaled.
pub(crate) fn scaled_note(count: usize) -> Note {
    Note::changed(count, "normal scaled to unit length", "normals scaled to unit length")
}

/// Computes the normals of length 0 at the corners of these faces from the faces around them.
///
/// Cost: linear.
pub(crate) fn compute_missing(mesh: &mut Mesh, is_meant: impl Fn(usize) -> bool) {
    let Some(mut attributes) = mesh.attributes.take() else { return };
    let marks = wedges_of_faces(&attributes.corners, attributes.wedge_count, is_meant);
    for layer in attributes.layers.iter_mut().filter(|layer| layer.kind == LayerKind::Normal) {
        let normals = layer.values.as_chunks::<3>().0.iter().zip(&marks).enumerate();
        let missing = normals.filter(|&(_, (normal, &marked))| marked && *normal == [0.0; 3]);
        let missing: Vec<usize> = missing.map(|(wedge, _)| wedge).collect();
        put_face_normals(mesh, &attributes.corners, &missing, layer);
    }
    mesh.attributes = Some(attributes);
}

/// Returns a normal scaled to unit length, unless it differs from that by rounding only; `None` if
/// it has no length.
pub(crate) fn unit(normal: [f32; 3]) -> Option<[f32; 3]> {
    unit_within(normal, ROUNDING)
}

pub(crate) fn unit_within(normal: [f32; 3], rounding: f64) -> Option<[f32; 3]> {
    let squared: f32 = normal.iter().map(|x| x * x).sum();
    if (f64::from(squared) - 1.0).abs() <= 2.0 * rounding {
        return Some(normal);
    }
    let exact = DVec3::from(normal.map(f64::from));
    exact.try_normalize().map(|unit| unit.to_array().map(|x| x as f32))
}

#[derive(Default)]
struct Counts {
    scaled: usize,
    computed: usize,
}

/// Normalizes the normals of a mesh and counts the changes, except for faces whose material label
/// is marked in `bare`, whose normals are not from the file.
fn make_mesh_unit(mesh: &mut Mesh, rounding: f64, bare: &[bool]) -> Counts {
    let Some(mut attributes) = mesh.attributes.take() else { return Counts::default() };
    let mut counts = Counts::default();
    for layer in attributes.layers.iter_mut().filter(|layer| layer.kind == LayerKind::Normal) {
        let mut missing = vec![];
        for (wedge, normal) in layer.values.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            match unit_within(*normal, rounding) {
                Some(unit) if unit == *normal => {}
                Some(unit) => {
                    *normal = unit;
                    counts.scaled += 1;
                }
                None => missing.push(wedge),
            }
        }
        if missing.is_empty() {
            continue;
        }
        let has_normals = |face: usize| {
            let label = mesh.materials.as_ref().and_then(|labels| labels.of_face.get(face));
            label.and_then(|&label| bare.get(label as usize)) != Some(&true)
        };
        let is_of_file = wedges_of_faces(&attributes.corners, attributes.wedge_count, has_normals);
        for wedge in put_face_normals(mesh, &attributes.corners, &missing, layer) {
            counts.computed += usize::from(is_of_file[wedge.index()]);
        }
    }
    mesh.attributes = Some(attributes);
    counts
}

/// Marks the wedges at the corners of these faces.
fn wedges_of_faces(
    corners: &[[WedgeId; 3]],
    wedge_count: usize,
    is_meant: impl Fn(usize) -> bool,
) -> Vec<bool> {
    let mut marks = vec![false; wedge_count];
    for (_, wedges) in corners.iter().enumerate().filter(|&(face, _)| is_meant(face)) {
        wedges.iter().for_each(|wedge| marks[wedge.index()] = true);
    }
    marks
}

/// Sets the normals of these wedges from the adjacent faces; returns the wedges that are in use.
fn put_face_normals(
    mesh: &Mesh,
    corners: &[[WedgeId; 3]],
    missing: &[usize],
    layer: &mut Layer,
) -> Vec<WedgeId> {
    let computed = face_normals(mesh, corners, missing).into_iter().map(|(wedge, normal)| {
        layer.of_mut(wedge).copy_from_slice(&normal.to_array().map(|x| x as f32));
        wedge
    });
    computed.collect()
}

/// Returns the area-weighted mean normal of the faces at each of these wedges that is in use; if it
/// is zero, the mean over all faces at its vertex, else +z.
fn face_normals(mesh: &Mesh, corners: &[[WedgeId; 3]], missing: &[usize]) -> Vec<(WedgeId, DVec3)> {
    let wedges = corners.as_flattened().iter().map(|w| w.index() + 1).max().unwrap_or(0);
    let mut at_vertex = vec![DVec3::ZERO; mesh.positions.len()];
    let mut at_wedge = vec![(DVec3::ZERO, None); wedges];
    for (face, corners) in mesh.faces.iter().zip(corners) {
        let [a, b, c] = mesh.triangle(*face);
        let normal = (b - a).cross(c - a);
        let normal = if normal.is_finite() { normal } else { DVec3::ZERO };
        for (v, w) in face.iter().zip(corners) {
            at_vertex[v.index()] += normal;
            let (sum, vertex) = &mut at_wedge[w.index()];
            *sum += normal;
            *vertex = Some(*v);
        }
    }
    let normal = |&wedge: &usize| {
        let &(sum, vertex) = at_wedge.get(wedge)?;
        let around = at_vertex[vertex?.index()];
        let normal = sum.try_normalize().or_else(|| around.try_normalize()).unwrap_or(DVec3::Z);
        Some((WedgeId::new(wedge), normal))
    };
    missing.iter().filter_map(normal).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Format, ReadOptions, read_bytes};

    fn read(normals: [&str; 4]) -> Scene {
        let [a, b, c, d] = normals;
        let text = format!(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn {a}\nvn {b}\nvn {c}\nvn {d}\n\
             f 1//1 2//2 3//3\nf 1//1 3//3 4//4\n"
        );
        let options = ReadOptions::default();
        read_bytes(text.as_bytes(), Format::Obj, &mut |_| None, &options).unwrap()
    }

    fn normals(scene: &Scene) -> Vec<[f32; 3]> {
        let layers = &scene.meshes[0].mesh.attributes.as_ref().unwrap().layers;
        layers[0].values.as_chunks().0.to_vec()
    }

    #[test]
    fn long_and_missing_normals_become_unit_and_are_counted() {
        let scene = read(["0 0 1", "0 3 4", "0 0 0", "0 1e-30 0"]);
        assert_eq!(
            normals(&scene),
            [[0.0, 0.0, 1.0], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
        );
        let notes: Vec<String> = scene.notes.iter().map(Note::to_string).collect();
        assert_eq!(
            notes,
            [
                "2 normals scaled to unit length",
                "1 normal without a length computed from the faces around it"
            ]
        );
    }

    #[test]
    fn rounding_counts_as_unit() {
        let scene = read(["0 0 0.9995", "0 0 1.0005", "0.5774 0.5774 0.5774", "1 0 0"]);
        assert_eq!(normals(&scene)[0], [0.0, 0.0, 0.9995]);
        assert!(scene.notes.is_empty());
    }

    #[test]
    fn faces_without_area_give_some_normal() {
        let text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nvn 0 0 0\nf 1//1 2//1 3//1\n";
        let options = ReadOptions::default();
        let scene = read_bytes(text.as_bytes(), Format::Obj, &mut |_| None, &options).unwrap();
        assert_eq!(normals(&scene), [[0.0, 0.0, 1.0]; 3]);
    }
}
