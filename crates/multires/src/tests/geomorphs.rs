//! Cuts that change smoothly: no step makes the surface jump, and each ends at the cut.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use meshlod_mesh::{Layer, LayerKind, Mesh};
use meshlod_simplify::{Method, Options};

use super::attributes;
use super::walks::{Dice, each, query};
use crate::{Cut, Forest, Geomorph, Implicit, Motion, Query, SlotMesh, UpdateLimits, VertexValues};

const DURATION: Duration = Duration::from_millis(100);
const STILL: Duration = Duration::ZERO;

/// Returns the faces with area, each by the positions, values and material at its corners.
fn surface(mesh: &Mesh) -> Vec<String> {
    let mut faces: Vec<String> = Vec::new();
    for (f, face) in mesh.faces.iter().enumerate() {
        let places = face.map(|v| mesh.positions[v.index()]);
        if places[0] == places[1] || places[1] == places[2] || places[2] == places[0] {
            continue;
        }
        let mut corners = [0, 1, 2].map(|k| {
            let all = mesh.attributes.iter().flat_map(|all| &all.layers);
            let wedge = |k: usize| mesh.attributes.as_ref().unwrap().corners[f][k];
            format!("{:?} {:?}", places[k], all.map(|l| l.of(wedge(k))).collect::<Vec<_>>())
        });
        let least = (0..3).min_by_key(|&k| &corners[k]).unwrap();
        corners.rotate_left(least);
        faces.push(format!("{corners:?} {:?}", mesh.materials.as_ref().map(|all| all.of(f))));
    }
    faces.sort_unstable();
    faces
}

/// Returns the triangles of a cut, each from its least node on, in rising order.
fn triangles(all: impl Iterator<Item = (u32, [u32; 3])>) -> Vec<[u32; 3]> {
    let mut all: Vec<[u32; 3]> = all.map(|(_, nodes)| nodes).collect();
    for nodes in &mut all {
        let least = (0..3).min_by_key(|&k| nodes[k]).unwrap();
        nodes.rotate_left(least);
    }
    all.sort_unstable();
    all
}

/// Returns what the last call may have moved.
fn states(morph: &Geomorph<'_>) -> BTreeMap<u32, VertexValues> {
    let mut all = BTreeMap::new();
    for node in morph.moved() {
        morph.values(node, all.entry(node).or_default());
    }
    all
}

/// Walks through random queries, most of which come while vertices are still moving.
fn walk(name: &str, mesh: &Mesh, mt: &Implicit) -> usize {
    let mut morph = Geomorph::new(mt, DURATION).unwrap();
    let (mut dice, mut moved) = (Dice(5), 0);
    for _ in 0..10 {
        let (query, before) = (query(&mut dice, mesh), surface(&morph.mesh()));
        let changes = (dice.roll() < 0.5).then(|| (80.0 * dice.roll()) as usize);
        morph.update(&query, &UpdateLimits { changes, time: None }).unwrap();
        assert!(surface(&morph.mesh()) == before, "{name}: a jump by {query:?}");
        morph.advance(DURATION.mul_f64(0.6 * dice.roll()));
        let between = surface(&morph.mesh());
        moved += usize::from(between != before && morph.moved().next().is_some());
        morph.advance(STILL);
        assert!(surface(&morph.mesh()) == between, "{name}: a jump by nothing");
    }
    let query = query(&mut dice, mesh);
    morph.update(&query, &UpdateLimits::default()).unwrap();
    assert!(!morph.advance(DURATION), "{name}: moves for too long");
    let expected = Cut::at(mt, &query).unwrap();
    assert_eq!(triangles(morph.triangles()), triangles(expected.triangles()), "{name}");
    assert_eq!(surface(&morph.mesh()), surface(&expected.level().mesh()), "{name}");
    moved
}

#[test]
fn bare_surfaces_never_jump_and_end_at_the_cut() {
    let mut moved = 0;
    each(|name, mesh, forest| {
        moved += walk(name, mesh, &Implicit::new(forest).unwrap());
    });
    assert!(moved > 100, "{moved} of the steps moved anything");
}

#[test]
fn attributes_never_jump_and_end_at_the_cut() {
    for (name, mesh) in attributes::meshes() {
        for method in [Method::LindstromTurk, Method::Qem, Method::QemEndpoint] {
            let options = Options { method, ..Options::default() };
            let forest = Forest::lossless(&mesh, &options).unwrap();
            let moved = walk(name, &mesh, &Implicit::new(&forest).unwrap());
            assert!(moved > 0 || mesh.faces.len() < 100, "{name}: nothing moved");
        }
    }
}

#[test]
fn patches_and_moved_vertices_keep_a_copy_up_to_date() {
    let mesh = meshlod_samples::torus(900);
    let mt = Implicit::new(&super::walks::forest(&mesh, Method::LindstromTurk)).unwrap();
    let mut morph = Geomorph::new(&mt, DURATION).unwrap();
    let mut slots: Vec<Option<[u32; 3]>> = vec![];
    slots.extend((0..morph.slots() as u32).map(|slot| morph.triangle(slot)));
    let mut places: Vec<_> = (0..mt.node_count() as u32).map(|node| mt.position(node)).collect();
    let mut dice = Dice(3);
    for i in 0..60 {
        if i % 2 == 0 {
            let query = query(&mut dice, &mesh);
            morph.update(&query, &UpdateLimits::default()).unwrap();
        } else {
            morph.advance(DURATION.mul_f64(dice.roll()));
        }
        slots.resize(morph.slots(), None);
        for patch in morph.patches() {
            assert_eq!(slots[patch.slot as usize], patch.old);
            slots[patch.slot as usize] = patch.new;
        }
        states(&morph).iter().for_each(|(&node, now)| places[node as usize] = now.position);
        let faces = slots.iter().flatten().map(|nodes| nodes.map(meshlod_mesh::VertexId));
        let copy = Mesh::new(places.clone(), faces.collect());
        assert!(surface(&copy) == surface(&morph.mesh()), "step {i}");
    }
}

/// Motion of a vertex as a renderer keeps it that blends by itself.
struct Known {
    begun: Option<Duration>,
    ends: [VertexValues; 2],
}

impl Known {
    fn of(motion: Motion<'_>) -> Self {
        let end = |k: usize| VertexValues {
            position: motion.positions[k],
            values: motion.values[k].to_vec(),
        };
        Self { begun: motion.begun, ends: [end(0), end(1)] }
    }

    /// Returns the position and values by the clock, as far as `f32` tells.
    fn at(&self, clock: Duration) -> Vec<f32> {
        let passed = self.begun.map_or(DURATION, |begun| (clock - begun).min(DURATION));
        let weight = passed.as_secs_f64() / DURATION.as_secs_f64();
        let [from, to] = [0, 1].map(|k| numbers(&self.ends[k]));
        from.zip(to).map(|(a, b)| (a * (1.0 - weight) + b * weight) as f32).collect()
    }
}

fn numbers(state: &VertexValues) -> impl Iterator<Item = f64> {
    state.position.into_iter().chain(state.values.iter().map(|&value| f64::from(value)))
}

#[test]
fn turned_vertices_and_the_clock_tell_where_all_are() {
    let mesh = meshlod_fixtures::charted(&meshlod_samples::torus(900));
    let mt = Implicit::new(&Forest::lossless(&mesh, &Options::default()).unwrap()).unwrap();
    let mut morph = Geomorph::new(&mt, DURATION).unwrap();
    let (mut known, mut dice) = (BTreeMap::new(), Dice(8));
    let (mut under_way, mut turned) = (0, 0);
    let mut state = VertexValues::default();
    for step in 0..80 {
        if step % 4 == 0 {
            let query = query(&mut dice, &mesh);
            morph.update(&query, &UpdateLimits::default()).unwrap();
        } else {
            morph.advance(DURATION.mul_f64(0.4 * dice.roll()));
            turned += morph.turned().count();
        }
        for node in morph.turned() {
            match morph.motion(node) {
                Some(motion) => known.insert(node, Known::of(motion)),
                None => known.remove(&node),
            };
        }
        let shown: BTreeSet<u32> = morph.triangles().flat_map(|(_, nodes)| nodes).collect();
        assert!(known.keys().all(|node| shown.contains(node)), "step {step}");
        for node in shown {
            morph.values(node, &mut state);
            let now: Vec<f32> = numbers(&state).map(|x| x as f32).collect();
            let Some(known) = known.get(&node) else {
                assert_eq!(state.position, mt.position(node), "step {step}: {node} is at home");
                continue;
            };
            assert_eq!(now, known.at(morph.clock()), "step {step}: {node}");
            // It goes to the vertex above it, or to itself, in the goal.
            let above = std::iter::successors(Some(node), |&node| parent(&mt, node));
            let goal = above.into_iter().find(|&node| morph.goal().shows(node)).unwrap();
            assert_eq!(known.ends[1].position, mt.position(goal), "step {step}: {node}");
            under_way += usize::from(known.begun.is_some());
        }
    }
    assert!(under_way > turned && turned > 100, "{under_way} under way, {turned} turned");
}

fn parent(mt: &Implicit, node: u32) -> Option<u32> {
    mt.creator(node).map(|update| mt.parent(update))
}

#[test]
fn without_time_to_move_the_cut_is_shown_at_once() {
    let mesh = meshlod_samples::torus(900);
    let mt = Implicit::new(&super::walks::forest(&mesh, Method::Qem)).unwrap();
    let mut morph = Geomorph::new(&mt, STILL).unwrap();
    for error in [0.0, 0.05, 0.01, 1.0, 0.002] {
        morph.update(&Query::uniform(error), &UpdateLimits::default()).unwrap();
        morph.advance(STILL);
        let expected = Cut::at(&mt, &Query::uniform(error)).unwrap();
        assert_eq!(surface(&morph.mesh()), surface(&expected.level().mesh()), "{error}");
    }
}

#[test]
fn numbers_of_joints_are_not_blended() {
    let mut mesh = meshlod_fixtures::charted(&meshlod_samples::torus(900));
    let attributes = mesh.attributes.as_mut().unwrap();
    let values = (0..4 * attributes.wedge_count).map(|i| (i % 97) as f32).collect();
    let (kind, name) = (LayerKind::Joints(0), "JOINTS_0".to_owned());
    attributes.layers.push(Layer { kind, name, width: 4, values });
    let mt = Implicit::new(&Forest::lossless(&mesh, &Options::default()).unwrap()).unwrap();
    let is_joint: Vec<bool> =
        mt.layers().flat_map(|layer| vec![layer.kind == kind; layer.width]).collect();
    let split = |values: &[f32]| -> [Vec<f32>; 2] {
        [true, false].map(|joints| {
            let all = values.iter().zip(is_joint.iter().cycle());
            all.filter(|&(_, &is_joint)| is_joint == joints).map(|(&value, _)| value).collect()
        })
    };
    let mut morph = Geomorph::new(&mt, DURATION).unwrap();
    morph.update(&Query::uniform(0.0), &UpdateLimits::default()).unwrap();
    let start = states(&morph);
    morph.advance(DURATION / 2);
    let mut blended = 0;
    for (node, now) in states(&morph) {
        let [[joints, others], [old_joints, old_others]] =
            [&now, &start[&node]].map(|values| split(&values.values));
        assert_eq!(joints, old_joints, "vertex {node}");
        blended += usize::from(others != old_others);
    }
    assert!(blended > 100, "{blended} vertices have other values half-way");
}
