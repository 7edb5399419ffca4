//! Wedges of every encoding against those of the explicit one, which stores them with its triangles.

use std::collections::BTreeMap;

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use meshlod_samples as samples;
use meshlod_simplify::{Method, Options};

use super::attributes::{corner_values, meshes};
use super::walks::{Dice, cone, query, soup, split_nodes};
use crate::forest::NONE;
use crate::implicit::Order;
use crate::{
    Cut, Explicit, ExplicitCut, Focus, Forest, Level, Model, Query, SlotMesh, Tolerance,
    UpdateLimits,
};

/// Gives a mesh up to three wedges a vertex and up to three materials, both at random, so that
/// seams run anywhere and end anywhere.
fn with_random_wedges(mesh: &Mesh, seed: u64) -> Mesh {
    let mut dice = Dice(seed);
    let mut below = |count: usize| (dice.roll() * count as f64) as usize;
    let wedges = mesh.positions.len() * 3;
    let corners =
        mesh.faces.iter().map(|face| face.map(|v| WedgeId::new(3 * v.index() + below(3))));
    let corners: Vec<_> = corners.collect();
    let of_face = mesh.faces.iter().map(|_| below(6).saturating_sub(3) as u32).collect();
    let values = (0..2 * wedges).map(|_| below(1000) as f32).collect();
    let layer = Layer { kind: LayerKind::Uv(0), name: String::new(), width: 2, values };
    let names = ["red", "green", "blue"].map(String::from).to_vec();
    Mesh {
        attributes: Some(Attributes { corners, wedge_count: wedges, layers: vec![layer] }),
        materials: Some(Labels { names, of_face }),
        ..mesh.clone()
    }
}

/// Returns meshes with seams, manifold or not, whose splits are fans or not.
fn all_sorts() -> Vec<(String, Mesh)> {
    let mut all: Vec<_> =
        meshes().into_iter().map(|(name, mesh)| (name.to_owned(), mesh)).collect();
    for (name, mesh) in [("cone", cone(200)), ("moebius", fixtures::moebius(60))] {
        all.push((format!("{name} in charts"), fixtures::charted(&mesh)));
        all.push((format!("{name} at random"), with_random_wedges(&mesh, 9)));
    }
    let sphere = samples::sphere(400);
    all.push(("sphere at random".to_owned(), with_random_wedges(&sphere, 2)));
    all.extend((0..12).map(|seed| (format!("soup {seed}"), with_random_wedges(&soup(seed), seed))));
    // Vertices without faces take part in no level.
    let mut sparse = with_random_wedges(&fixtures::two_objects(), 4);
    sparse.positions.extend([[9.0; 3]; 5]);
    all.push(("sparse".to_owned(), sparse));
    all
}

/// Returns the corners of each face by node and wedge of the forest, in a canonical order.
type Corners = Vec<[[u32; 2]; 3]>;

fn canonical(faces: impl Iterator<Item = [[u32; 2]; 3]>) -> Corners {
    let mut faces: Corners = faces.collect();
    for face in &mut faces {
        let least = (0..3).min_by_key(|&k| face[k]).unwrap();
        face.rotate_left(least);
    }
    faces.sort_unstable();
    faces
}

fn of_explicit(level: &Level) -> Corners {
    let wedges = &level.wedges.as_ref().unwrap().corners;
    let nodes = level.faces.iter().map(|face| face.map(|v| level.nodes[v as usize]));
    canonical(nodes.zip(wedges).map(|(nodes, wedges)| [0, 1, 2].map(|k| [nodes[k], wedges[k]])))
}

/// A model with the forest that it was made of.
struct Named<'f> {
    forest: &'f Forest,
    order: &'f Order,
    model: &'f Model,
}

impl Named<'_> {
    /// Returns the forest's node and wedge of a corner of the model.
    fn of(&self, node: u32, wedge: u32) -> [u32; 2] {
        let local = wedge - self.model.implicit().wedges_of(node).start;
        let place = self.order.nodes[node as usize];
        [place, self.forest.wedges.as_ref().unwrap().first[place as usize] + local]
    }

    fn level(&self, level: &Level) -> Corners {
        let wedges = &level.wedges.as_ref().unwrap().corners;
        canonical(level.faces.iter().zip(wedges).map(|(face, wedges)| {
            [0, 1, 2].map(|k| self.of(level.nodes[face[k] as usize], wedges[k]))
        }))
    }

    /// Compares a level of the extractor with the explicit cut of the same updates.
    fn is_a_cut(&self, explicit: &Explicit, level: &Level) -> bool {
        let split = split_nodes(level, self.model.implicit(), self.order);
        let cut = explicit.cut_of(&split);
        cut.is_some_and(|cut| self.level(level) == of_explicit(&cut))
    }
}

/// Wedges of a cut's slots, known from its patches alone.
struct Slots(BTreeMap<u32, [[u32; 2]; 3]>);

impl Slots {
    fn new(cut: &Cut<'_>, named: &Named<'_>) -> Self {
        let corners = |(slot, nodes): (u32, [u32; 3])| {
            let wedges = cut.wedges(slot).unwrap();
            (slot, [0, 1, 2].map(|k| named.of(nodes[k], wedges[k])))
        };
        Self(cut.triangles().map(corners).collect())
    }

    fn follow(&mut self, cut: &Cut<'_>, named: &Named<'_>) {
        for patch in cut.patches() {
            self.0.remove(&patch.slot);
            if let Some(nodes) = patch.new {
                let wedges = cut.wedges(patch.slot).unwrap();
                self.0.insert(patch.slot, [0, 1, 2].map(|k| named.of(nodes[k], wedges[k])));
            }
        }
    }
}

fn follow_the_oracle(what: &str, mesh: &Mesh, forest: &Forest) {
    let (order, explicit) = (Order::new(forest), Explicit::new(forest));
    let model = Model::new(forest).unwrap();
    model.implicit().certify().unwrap();
    let named = Named { forest, order: &order, model: &model };
    let (mut oracle, mut cut) = (ExplicitCut::new(&explicit), model.cut());
    let (mut extractor, mut slots) = (model.extractor(), Slots::new(&cut, &named));
    let mut dice = Dice(17);
    for _ in 0..12 {
        let query = query(&mut dice, mesh);
        let level = explicit.extract(&query).unwrap();
        let expected = of_explicit(&level);
        oracle.update(&query).unwrap();
        // Two lists of corners would fill screens.
        assert!(of_explicit(&oracle.level()) == expected, "{what} {query:?}");
        cut.update(&query, &UpdateLimits::default()).unwrap();
        assert!(named.level(&cut.level()) == expected, "{what} {query:?}");
        assert!(corner_values(&cut.level().mesh()) == corner_values(&level.mesh()), "{what}");
        slots.follow(&cut, &named);
        assert!(canonical(slots.0.values().copied()) == expected, "{what} {query:?}");
        let exact = named.level(extractor.exact(&query).unwrap());
        assert!(exact == expected, "{what} {query:?}");
        let most = (dice.roll() * mesh.faces.len() as f64) as usize;
        let best = extractor.at_most(most, &query).unwrap();
        assert!(named.is_a_cut(&explicit, best), "{what} within {most} by {query:?}");
        match (&query.focus, &query.tolerance) {
            (Focus::Everything, Tolerance::Pixels { camera, pixels }) => {
                let slope = pixels * camera.pixel();
                let mut saturated = model.clone();
                saturated.saturate([slope / 2.0, slope * 2.0]).unwrap();
                let mut saturated = saturated.extractor();
                let larger = saturated.saturated(&query).unwrap();
                assert!(named.is_a_cut(&explicit, larger), "{what} saturated {query:?}");
            }
            (Focus::Everything, Tolerance::Uniform(most)) => {
                let fast = named.level(extractor.uniform(*most).unwrap());
                assert!(fast == expected, "{what} {query:?}");
            }
            _ => {}
        }
    }
}

const METHODS: [Method; 5] = [
    Method::LindstromTurk,
    Method::Qem,
    Method::QemEndpoint,
    Method::LeeJang,
    Method::LindstromTurkFaces,
];

#[test]
fn all_encodings_have_the_same_wedges() {
    for (name, mesh) in all_sorts() {
        for method in METHODS {
            let options = Options { method, ..Options::default() };
            let forest = Forest::new(&mesh, &options).unwrap();
            follow_the_oracle(&format!("{name} by {}", method.name()), &mesh, &forest);
        }
    }
}

#[test]
fn the_finest_explicit_level_has_the_attributes_of_the_input() {
    for (name, mesh) in meshes() {
        let forest = Forest::lossless(&mesh, &Options::default()).unwrap();
        let level = Explicit::new(&forest).extract(&Query::uniform(0.0)).unwrap().mesh();
        level.validate().unwrap();
        assert_eq!(corner_values(&level), corner_values(&mesh), "{name}");
    }
}

#[test]
fn wedges_know_their_nodes_and_what_they_become() {
    for (name, mesh) in all_sorts() {
        let forest = Forest::new(&mesh, &Options::default()).unwrap();
        let (order, model) = (Order::new(&forest), Model::new(&forest).unwrap());
        let named = Named { forest: &forest, order: &order, model: &model };
        let (mt, all) = (model.implicit(), forest.wedges.as_ref().unwrap());
        for node in 0..mt.node_count() as u32 {
            assert!(mt.wedges_of(node).all(|wedge| mt.node_of(wedge) == node), "{name}");
            for (wedge, parent) in mt.merged_wedges(node) {
                assert_eq!(mt.material_of(wedge), mt.material_of(parent), "{name}");
                let [_, child] = named.of(mt.node_of(wedge), wedge);
                let [_, above] = named.of(node, parent);
                // A wedge that loses its faces where all have one wedge is in no record.
                let is_lost = all.parents[child as usize] == NONE && mt.wedges_of(node).len() == 1;
                assert!(is_lost || all.parents[child as usize] == above, "{name}");
            }
        }
        let ends = (0..mt.node_count() as u32).map(|node| mt.wedges_of(node).len());
        assert_eq!(ends.sum::<usize>(), mt.wedge_count(), "{name}");
    }
}
