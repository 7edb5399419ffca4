//! Export of the current surface as a mesh.

use meshlod_mesh::{Mesh, VertexId};
use rayon::prelude::*;

use crate::kernel::attributes::AttributeStore;
use crate::kernel::contraction_log::InputNames;
use crate::kernel::mesh::vertex::NO_VERTEX;
use crate::kernel::setup::vertex_order::{is_face, numbers};

/// Returns the faces that are left with the vertices they use, in the input's order, and the id of
/// each input vertex there; [`NO_VERTEX`] if no face uses it. `split` are the faces with copies of
/// vertices, if there are any.
pub(crate) fn level(
    names: InputNames<'_>,
    attributes: &impl AttributeStore,
    split: Option<&[[u32; 3]]>,
) -> (Mesh, Vec<u32>) {
    let InputNames { mesh, order, store, .. } = names;
    let live = store.live_vertices();
    let of_input = |i: usize| match split {
        Some(split) => split[i],
        None => order.face(&mesh.faces[i]),
    };
    let faces = live_faces(mesh.faces.len(), of_input, &live);
    let mut ids = vec![NO_VERTEX; names.count()];
    let mut level = Mesh::default();
    for (_, corners) in &faces {
        for &v in corners {
            ids[names.input(v).index()] = v;
        }
    }
    for (input, id) in ids.iter_mut().enumerate().filter(|(_, id)| **id != NO_VERTEX) {
        let place = store.all[*id as usize].place();
        level.positions.push(names.position(VertexId::new(input), place));
        *id = level.positions.len() as u32 - 1;
    }
    let corner = |v: u32| VertexId(ids[names.input(v).index()]);
    level.faces = faces.iter().map(|&(_, [a, b, c])| [corner(a), corner(b), corner(c)]).collect();
    let kept: Vec<u32> = faces.iter().map(|&(face, _)| face).collect();
    level.attributes = attributes.attributes(kept.iter().map(|&i| (i, of_input(i as usize))));
    level.materials = mesh.materials.as_ref().map(|labels| labels.select(&kept));
    level.face_layers = mesh.select_face_layers(&kept);
    level.objects = mesh.objects.as_ref().map(|labels| labels.select(&kept));
    (level, ids)
}

/// Returns all vertices and faces of the input in their current state. A removed face repeats a
/// vertex.
pub(crate) fn workspace(
    names: InputNames<'_>,
    attributes: &impl AttributeStore,
    split: Option<&[[u32; 3]]>,
) -> Mesh {
    let InputNames { mesh, order, store, .. } = names;
    let live = store.live_vertices();
    let now = |v: u32| names.input(live[v as usize]);
    let now = |[a, b, c]: [u32; 3]| [now(a), now(b), now(c)];
    let of_input = (0..mesh.positions.len() as u32).map(|v| order.id(VertexId(v)));
    let all = of_input.chain((store.own() as u32..).take(store.spare));
    let place = |v: u32| names.position(names.input(v), store.all[v as usize].place());
    let faces = numbers(mesh, order, split);
    Mesh {
        positions: all.map(place).collect(),
        faces: faces.clone().map(now).collect(),
        attributes: attributes.all_attributes(faces),
        materials: mesh.materials.clone(),
        objects: mesh.objects.clone(),
        face_layers: mesh.face_layers.clone(),
    }
}

/// Returns the faces whose corners are still three different vertices, with their current corners.
pub(crate) fn live_faces(
    count: usize,
    face: impl Fn(usize) -> [u32; 3] + Sync,
    live: &[u32],
) -> Vec<(u32, [u32; 3])> {
    let heir = |v: u32| live[v as usize];
    let now = |i: usize| {
        let [a, b, c] = face(i);
        (i as u32, [heir(a), heir(b), heir(c)])
    };
    (0..count).into_par_iter().map(now).filter(|(_, face)| is_face(*face)).collect()
}
