//! Levels of wedges, against an independent simplification.

use std::collections::HashMap;

use meshlod_fixtures::{charted, seam_strip, textured_box, voxel_figure};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind};
use meshlod_samples as samples;
use meshlod_simplify::{Options, Simplifier, Target};

use super::*;
use crate::filter::Filter;
use crate::repair::{LevelStrips, StripEffort};
use crate::skip::SkipStrip;
use crate::stripify::{StripOptions, stripify};
use crate::strips::Strips;
use crate::verify::{Difference, difference};

/// A vertex of the mesh with the bits of its attribute values.
type Corner = (VertexId, Vec<u32>);

fn values<'a>(layers: impl Iterator<Item = (&'a Layer, WedgeId)>) -> Vec<u32> {
    layers.flat_map(|(layer, wedge)| layer.of(wedge)).map(|x| x.to_bits()).collect()
}

fn corner_of(mesh: &Mesh, tree: &MergeTree, vertex: VertexId) -> Corner {
    let wedge = tree.wedges(mesh)[vertex.index()];
    let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    (wedge.vertex, values(layers.map(|layer| (layer, wedge.source(layer.kind)))))
}

/// Gives each corner an id, the same to the same corners.
#[derive(Default)]
struct Names(HashMap<Corner, VertexId>);

impl Names {
    fn of(&mut self, corner: Corner) -> VertexId {
        let next = VertexId::new(self.0.len());
        *self.0.entry(corner).or_insert(next)
    }

    fn strips(&mut self, mesh: &Mesh, tree: &MergeTree, strips: &Strips) -> Strips {
        let mut named = Strips::default();
        for strip in strips.iter() {
            named.push(strip.iter().map(|&v| self.of(corner_of(mesh, tree, v))));
        }
        named
    }

    fn level(&mut self, simplifier: &Simplifier<'_>) -> Vec<[VertexId; 3]> {
        let (level, surface) = (simplifier.level(), simplifier.surface());
        let alive = (0..surface.face_count()).map(FaceId::new).filter(|&f| surface.is_alive(f));
        // Both list the faces in one order.
        let face = |(place, face): (usize, FaceId)| {
            let vertices = surface.face(face);
            [0, 1, 2].map(|k| {
                let layer = |attributes| {
                    let Attributes { corners, layers, .. }: &Attributes = attributes;
                    values(layers.iter().map(|layer| (layer, corners[place][k])))
                };
                self.of((vertices[k], level.attributes.as_ref().map(layer).unwrap_or_default()))
            })
        };
        alive.enumerate().map(face).collect()
    }
}

/// Checks every kind of display strips against the wedges that a second simplification leaves.
fn draws_every_level(mesh: &Mesh) {
    let tree = MergeTree::record(mesh, Target::Faces(0)).unwrap();
    let strips = stripify(tree.faces(), &StripOptions::default());
    let mut skip = SkipStrip::new(tree.clone(), strips.clone());
    let mut live = LevelStrips::new(tree.clone(), &strips, StripEffort::Quick);
    let options = MergeTree::options(&Options::default());
    let mut simplifier = Simplifier::new(mesh, &options).unwrap();
    for ratio in [1.0, 0.8, 0.5, 0.3, 0.1, 0.02, 0.0] {
        let faces = Target::Ratio(ratio).faces_of(mesh.faces.len());
        let report = simplifier.run(Target::Faces(faces), &mut ()).unwrap();
        let made = tree.contractions_to(faces);
        assert_eq!(tree.faces_left(made), report.output_faces);
        skip.set_level(made);
        live.set_level(made);
        let [none, stss, dtff] =
            [Filter::None, Filter::Stss, Filter::Dtff].map(|filter| skip.display(filter));
        let repaired = skip.repaired(StripEffort::Quick);
        assert!(none.vertices().len() >= stss.vertices().len());
        assert!(stss.vertices().len() >= dtff.vertices().len());
        let level = tree.level(made);
        let mut names = Names::default();
        let expected = names.level(&simplifier);
        assert_eq!(level.len(), report.output_faces);
        for strips in [none, stss, dtff, repaired, live.strips()] {
            assert_eq!(difference(&strips, &level), Difference::default(), "{ratio}");
            let named = names.strips(mesh, &tree, &strips);
            assert_eq!(difference(&named, &expected), Difference::default(), "{ratio}");
        }
    }
}

/// Adds normals that are constant on each side of the bounding box, so that creases end within
/// the one chart of the mesh.
fn creased(mesh: &Mesh) -> Mesh {
    let charts = charted(mesh).attributes.unwrap();
    let normals = charts.layers[0].values.as_chunks::<2>().0.iter().flat_map(|uv| {
        let chart = uv[0] as usize;
        let mut normal = [0.0; 3];
        normal[chart / 2 % 3] = if chart.is_multiple_of(2) { 1.0 } else { -1.0 };
        normal
    });
    let values = normals.collect();
    let layer = Layer { kind: LayerKind::Normal, name: String::new(), width: 3, values };
    Mesh { attributes: Some(Attributes { layers: vec![layer], ..charts }), ..mesh.clone() }
}

fn two_materials(mesh: &Mesh) -> Mesh {
    let is_right = |face: &[VertexId; 3]| mesh.positions[face[0].index()][0] > 0.0;
    let of_face = mesh.faces.iter().map(|face| is_right(face).into()).collect();
    let materials = Labels { names: vec!["left".into(), "right".into()], of_face };
    Mesh { materials: Some(materials), ..mesh.clone() }
}

#[test]
fn charts_are_drawn_as_simplified() {
    [samples::sphere(800), samples::torus(800)]
        .iter()
        .map(charted)
        .for_each(|m| draws_every_level(&m));
    [seam_strip(), textured_box(6), voxel_figure(2)].iter().for_each(draws_every_level);
}

#[test]
fn creases_keep_their_normals() {
    [samples::sphere(800), samples::knot(900)]
        .iter()
        .map(creased)
        .for_each(|m| draws_every_level(&m));
    let mesh = creased(&samples::sphere(800));
    let tree = MergeTree::record(&mesh, Target::Faces(0)).unwrap();
    assert!(tree.wedges(&mesh).iter().any(|wedge| wedge.shading != wedge.texture), "some move");
}

#[test]
fn materials_are_never_mixed() {
    for mesh in [samples::sphere(600), charted(&samples::torus(600))] {
        let mesh = two_materials(&mesh);
        draws_every_level(&mesh);
        let tree = MergeTree::record(&mesh, Target::Ratio(0.2)).unwrap();
        let materials = &mesh.materials.as_ref().unwrap();
        let of = |v: VertexId| materials.of(tree.wedges(&mesh)[v.index()].face.index());
        for level in [0, tree.contractions()] {
            let is_pure = |face: &[VertexId; 3]| face.iter().all(|&v| of(v) == of(face[0]));
            assert!(tree.level(level).iter().all(is_pure));
        }
    }
}

#[test]
fn no_strip_runs_across_a_seam() {
    let mesh = seam_strip();
    let tree = MergeTree::new(&mesh);
    let strips = stripify(tree.faces(), &StripOptions::default());
    let seam = |v: &VertexId| [0, 6].contains(&tree.mesh_vertex(*v).0);
    for strip in strips.iter() {
        let mut at_seam: Vec<_> = strip.iter().filter(|v| seam(v)).map(|v| v.0 % 7).collect();
        at_seam.dedup();
        assert!(at_seam.len() <= 2, "from one side of the seam to the other, around: {strip:?}");
    }
    assert_eq!(difference(&strips, tree.faces()), Difference::default());
    let bare = MergeTree::new(&Mesh { attributes: None, ..mesh });
    assert!(bare.vertices() == 12 && tree.vertices() == 14);
}
