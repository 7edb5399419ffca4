//! Strips of cuts: they draw what the cut has, with its attributes and materials.

use meshlod_fixtures::{charted, grid, moebius, seam_strip, voxel_figure};
use meshlod_mesh::{Labels, Mesh, VertexId};
use meshlod_multires::{Focus, Forest, Model, Query, SlotMesh, Tolerance, UpdateLimits};
use meshlod_samples as samples;
use meshlod_simplify::Method;

use super::*;
use crate::verify::{Difference, difference};

fn model(mesh: &Mesh, method: Method) -> Model {
    let options = meshlod_simplify::Options { method, ..Default::default() };
    Model::new(&Forest::new(mesh, &options).unwrap()).unwrap()
}

fn strips_of(model: &Model, cut: &Cut<'_>) -> CutStrips {
    CutStrips::new(model.implicit(), cut, &StripOptions::default(), StripEffort::Quick)
}

/// Returns the two materials of a mesh whose border crosses charts.
fn two_materials(mesh: &Mesh) -> Mesh {
    let is_right = |face: &[VertexId; 3]| mesh.positions[face[0].index()][0] > 0.1;
    let of_face = mesh.faces.iter().map(|face| is_right(face).into()).collect();
    let materials = Labels { names: vec!["left".into(), "right".into()], of_face };
    Mesh { materials: Some(materials), ..mesh.clone() }
}

fn bare() -> Vec<Mesh> {
    vec![samples::torus(800), grid(10), moebius(30)]
}

fn dressed() -> Vec<Mesh> {
    let sphere = samples::sphere(700);
    vec![
        charted(&samples::torus(800)),
        two_materials(&charted(&sphere)),
        two_materials(&sphere),
        seam_strip(),
        voxel_figure(1),
    ]
}

/// Moves a fully detailed sphere across the model; `check` sees every cut before and after its
/// strips follow.
fn walk(
    mesh: &Mesh,
    method: Method,
    mut check: impl FnMut(&Model, &Cut<'_>, &mut CutStrips, usize),
) {
    let model = model(mesh, method);
    let mut cut = model.cut();
    let mut strips = strips_of(&model, &cut);
    let bounds = mesh.bounds();
    for step in [0, 3, 10, 11, 12, 4, 0, 7] {
        let center = std::array::from_fn(|k| {
            bounds.min[k] + (bounds.max[k] - bounds.min[k]) * f64::from(step) / 12.0
        });
        let focus = Focus::Sphere { center, radius: 0.25 * bounds.diagonal() };
        let query = Query { focus, tolerance: Tolerance::Uniform(0.0) };
        cut.update(&query, &UpdateLimits::default()).unwrap();
        let changed = strips.update(&cut);
        assert!(changed <= cut.patches().count());
        check(&model, &cut, &mut strips, changed);
    }
}

const METHODS: [Method; 3] = [Method::QemEndpoint, Method::LindstromTurk, Method::LeeJang];

#[test]
fn every_cut_is_drawn() {
    for mesh in bare().iter().chain(&dressed()) {
        for method in METHODS {
            walk(mesh, method, |model, cut, strips, _| {
                let corners = |(slot, nodes)| cut.wedges(slot).unwrap_or(nodes);
                let faces = cut.triangles().map(|t| corners(t).map(|i| strips.vertex(i)));
                let faces: Vec<_> = faces.collect();
                assert_eq!(difference(&strips.strips(), &faces), Difference::default());
                assert_eq!(strips.difference(model.implicit(), cut), Difference::default());
            });
        }
    }
}

#[test]
fn a_set_of_strips_has_one_material() {
    for mesh in
        [two_materials(&samples::sphere(700)), two_materials(&charted(&samples::torus(800)))]
    {
        walk(&mesh, Method::Qem, |model, _, strips, _| {
            let mt = model.implicit();
            let sets = strips.strips_by_material(mt);
            assert_eq!(sets.len(), 2);
            for (material, set) in (0..).zip(&sets) {
                assert!(!set.is_empty());
                assert!(set.vertices().iter().all(|v| mt.material_of(v.0) == Some(material)));
            }
            let sent: usize = sets.iter().map(|set| set.vertices().len()).sum();
            assert_eq!(sent, strips.strips().vertices().len());
        });
    }
}

#[test]
fn index_buffers_follow_cuts() {
    for mesh in [samples::torus(800), two_materials(&charted(&samples::sphere(700)))] {
        let mut indices: Option<StripIndices> = None;
        walk(&mesh, Method::LindstromTurk, |model, _, strips, _| {
            let mt = model.implicit();
            match &mut indices {
                Some(indices) => strips.update_indices(mt, indices),
                None => indices = Some(strips.indices(mt)),
            }
            let indices = indices.as_ref().unwrap();
            let sets = strips.strips_by_material(mt);
            assert_eq!(sets.len(), indices.sets());
            for (set, strips) in sets.iter().enumerate() {
                let mut read = Strips::default();
                for strip in indices.indices(set).split(|&index| index == Strips::RESTART) {
                    read.push(strip.iter().copied().map(VertexId));
                }
                let faces: Vec<_> = strips.triangles().collect();
                assert_eq!(difference(&read, &faces), Difference::default());
                assert_eq!(read.vertices().len(), strips.vertices().len());
            }
        });
    }
}

#[test]
fn vertices_are_where_their_nodes_are() {
    let model = model(&samples::sphere(400), Method::QemEndpoint);
    let mt = model.implicit();
    let strips = strips_of(&model, &model.cut());
    for node in 0..mt.node_count() as u32 {
        let leaf = strips.vertex(node).0;
        assert_eq!(mt.position(leaf), mt.position(node));
        assert_eq!(mt.children_of(leaf), None);
    }
}

#[test]
fn a_vertex_that_stays_leaves_its_triangles_alone() {
    for mesh in [samples::torus(800), charted(&samples::torus(800))] {
        let changes = |method| {
            let (mut patches, mut changed) = (0, 0);
            walk(&mesh, method, |_, cut, _, count| {
                patches += cut.patches().count();
                changed += count;
            });
            (patches, changed)
        };
        let (patches, changed) = changes(Method::QemEndpoint);
        assert!(changed < patches * 9 / 10, "{changed} of {patches}");
        let (patches, changed) = changes(Method::LindstromTurk);
        assert!(changed <= patches);
    }
}

#[test]
fn wrong_wedges_at_right_vertices_are_seen() {
    let model = model(&charted(&samples::torus(800)), Method::QemEndpoint);
    let mt = model.implicit();
    let cut = Cut::at(mt, &Query::uniform(0.0)).unwrap();
    let corners = |(slot, _)| cut.wedges(slot).unwrap();
    let at_seam = |wedge: &u32| mt.wedges_of(mt.node_of(*wedge)).len() > 1;
    let wedge = cut.triangles().flat_map(corners).find(at_seam).unwrap();
    let others = mt.wedges_of(mt.node_of(wedge));
    let other = others.into_iter().find(|&other| other != wedge).unwrap();
    let mut vertices = vertices::vertices(mt);
    vertices.swap(wedge as usize, other as usize);
    let options = (&StripOptions::default(), StripEffort::Quick);
    let strips = CutStrips::with_vertices(vertices, true, &cut, options);
    let Difference { missing, extra } = strips.difference(mt, &cut);
    assert!(missing > 0 && missing == extra, "{missing}, {extra}");
}

#[test]
fn an_update_that_is_skipped_is_seen() {
    let model = model(&charted(&samples::torus(800)), Method::LindstromTurk);
    let mut cut = model.cut();
    let strips = strips_of(&model, &cut);
    assert_eq!(strips.difference(model.implicit(), &cut), Difference::default());
    cut.update(&Query::uniform(0.0), &UpdateLimits::default()).unwrap();
    assert_ne!(strips.difference(model.implicit(), &cut), Difference::default());
}
