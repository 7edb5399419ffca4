use std::collections::BTreeSet;

use super::*;
use meshlod_mesh::{Attributes, Connectivity, LayerKind, Twin, VertexId, WedgeId};

fn attributes(mesh: &Mesh) -> &Attributes {
    mesh.attributes.as_ref().expect("a fish has attributes")
}

/// Vertex and wedge of each corner.
fn corners(mesh: &Mesh) -> impl Iterator<Item = (VertexId, WedgeId)> {
    mesh.faces.iter().flatten().copied().zip(attributes(mesh).corners.iter().flatten().copied())
}

#[test]
fn it_is_one_surface_without_a_handle() {
    for faces in [0, 2_000, 4_000, 30_000] {
        let mesh = fish(faces);
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let euler = mesh.positions.len() + mesh.faces.len() - connectivity.edge_count();
        assert_eq!((euler, connectivity.is_closed()), (2, true));
    }
}

#[test]
fn a_wedge_belongs_to_one_vertex() {
    let mesh = fish(4_000);
    let mut owner = vec![None; attributes(&mesh).wedge_count];
    for (vertex, wedge) in corners(&mesh) {
        assert_eq!(*owner[wedge.index()].get_or_insert(vertex), vertex);
    }
    assert!(owner.iter().all(Option::is_some));
}

#[test]
fn charts_are_many_and_seams_few() {
    let mesh = fish(4_000);
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let wedges: Vec<_> =
        attributes(&mesh).corners.iter().map(|c| c.map(|w| VertexId(w.0))).collect();
    let flat = Connectivity::new(&wedges, attributes(&mesh).wedge_count);
    let seams = connectivity.edges().filter(|&side| flat.twin(side) == Twin::Boundary).count();
    assert!((100..800).contains(&seams), "{seams} seams");
    // The body, two sides of six fins, three rings of two eyes, the laces of mouth and tail.
    let (_, charts) = meshlod_mesh::face_components(&wedges, attributes(&mesh).wedge_count);
    assert_eq!(charts, 1 + 12 + 6 + 2);
}

#[test]
fn values_are_in_their_ranges() {
    let mesh = fish(4_000);
    let layer = |kind| attributes(&mesh).layer(kind).expect("a layer");
    for kind in [LayerKind::Uv(0), LayerKind::Color(0)] {
        assert!(layer(kind).values.iter().all(|x| (0.0..=1.0).contains(x)), "{kind:?}");
    }
    for normal in layer(LayerKind::Normal).values.chunks(3) {
        let length: f32 = normal.iter().map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-5);
    }
}

#[test]
fn no_face_of_a_chart_is_flat_or_turned_over() {
    let mesh = fish(4_000);
    let uvs = attributes(&mesh).layer(LayerKind::Uv(0)).expect("uvs");
    let mut signs = BTreeSet::new();
    for (face, corners) in attributes(&mesh).corners.iter().enumerate() {
        let [a, b, c] = corners.map(|w| [uvs.of(w)[0], uvs.of(w)[1]]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert!(area.abs() > 1e-8, "f{face} covers {area} of the texture");
        signs.insert((area > 0.0, chart_of(a)));
    }
    let both = signs.iter().filter(|(sign, chart)| *sign && signs.contains(&(false, *chart)));
    assert_eq!(both.count(), 0);
}

/// The texture's cell, or 16 for the body.
fn chart_of([u, v]: [f32; 2]) -> usize {
    if v > 0.365 { 16 } else { (u * 8.0) as usize + 8 * usize::from(v > 0.18) }
}

#[test]
fn left_and_right_mirror_each_other() {
    let mesh = fish(4_000);
    let key = |[x, y, z]: [f64; 3]| [x, y, z].map(|x| (x * 1e6).round() as i64);
    let points: BTreeSet<_> = mesh.positions.iter().map(|&p| key(p)).collect();
    let mirrored = |&&[x, y, z]: &&[f64; 3]| {
        let near = key([x, y, -z]);
        let range = -1..=1;
        range.clone().any(|i| {
            range.clone().any(|j| {
                range.clone().any(|k| points.contains(&[near[0] + i, near[1] + j, near[2] + k]))
            })
        })
    };
    assert_eq!(mesh.positions.iter().filter(mirrored).count(), mesh.positions.len());
}
