use meshlod_fixtures::{fan, grid, shared_mesh};
use meshlod_io::{Material, Node, ReadOptions, SceneMesh, read};
use meshlod_measure::{DistanceOptions, distance};
use meshlod_mesh::{Borders, Lock, Locks, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::{Options, Topology};

use super::*;

/// A node that shows a mesh at a size.
fn node(mesh: usize, size: f64) -> Node {
    let mut node = Node { mesh: Some(mesh), ..Node::default() };
    (0..3).for_each(|axis| node.transform[axis][axis] = size);
    node
}

fn scene(meshes: Vec<Mesh>, nodes: Vec<Node>) -> Scene {
    let meshes = meshes.into_iter().map(|mesh| SceneMesh { mesh, ..SceneMesh::default() });
    let roots = (0..nodes.len()).collect();
    Scene { meshes: meshes.collect(), nodes, roots, ..Scene::default() }
}

fn faces(meshes: &[Mesh]) -> Vec<usize> {
    meshes.iter().map(|mesh| mesh.faces.len()).collect()
}

fn conditioned<'s>(scene: &'s Scene, options: &Options) -> ConditionedScene<'s> {
    ConditionedScene::new(scene, options, Borders::Stitch).unwrap()
}

fn run(scene: &Scene, target: Target) -> (Vec<Mesh>, Report) {
    let conditioned = conditioned(scene, &Options::default());
    let mut simplifier = SceneSimplifier::new(&conditioned).unwrap();
    let mut report = simplifier.run(target, &mut ()).unwrap();
    (simplifier.settled_level(&mut report.volume), report)
}

#[test]
fn one_mesh_is_simplified_as_by_itself() {
    let knot = samples::knot(2_000);
    let (level, report) = run(&Scene::from_mesh("", knot.clone()), Target::Ratio(0.2));
    let alone = meshlod_simplify::contract_to(&knot, Target::Ratio(0.2), &Options::default());
    let (mesh, alone_report) = alone.unwrap();
    assert_eq!(report, alone_report);
    assert!(level == [mesh]);
}

#[test]
fn the_larger_copy_keeps_more() {
    let ball = samples::sphere(2_000);
    let twins = scene(vec![ball.clone(), ball], vec![node(0, 1.0), node(1, 3.0)]);
    let (level, report) = run(&twins, Target::Ratio(0.25));
    let [small, large] = faces(&level)[..] else { panic!("two meshes") };
    assert!(report.reached && small + large == report.output_faces);
    assert!(large > 2 * small, "{small} and {large}");
}

#[test]
fn what_is_seen_from_its_front_only_keeps_its_back() {
    let mut cards = grid(1);
    for i in 1..20 {
        let (mut card, start) = (grid(1), cards.positions.len() as u32);
        card.positions.iter_mut().for_each(|at| at[2] = f64::from(i));
        cards.positions.extend(card.positions);
        cards.faces.extend(card.faces.iter().map(|face| face.map(|v| VertexId(v.0 + start))));
    }
    let backs = cards.faces.clone().into_iter().map(|[a, b, c]| [c, b, a]);
    cards.faces.extend(backs);
    for is_double_sided in [false, true] {
        let mut cards = scene(vec![cards.clone()], vec![node(0, 1.0)]);
        cards.materials = vec![Material { is_double_sided, ..Material::default() }];
        cards.meshes[0].materials = vec![Some(0)];
        let (level, _) = run(&cards, Target::Ratio(0.5));
        let is_front = |face: &&[VertexId; 3]| {
            let [a, b, c] = face.map(|v| level[0].positions[v.index()]);
            (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])
        };
        let fronts = level[0].faces.iter().filter(is_front).count();
        assert_eq!(level[0].faces.len(), 40);
        assert_eq!(fronts == 20, !is_double_sided, "{fronts} of 40 faces are fronts");
    }
}

#[test]
fn meshes_of_one_kind_and_size_share_evenly() {
    let ball = samples::sphere(2_000);
    let twins = scene(vec![ball.clone(), ball], vec![node(0, 2.0), node(1, -2.0)]);
    let [a, b] = faces(&run(&twins, Target::Faces(800)).0)[..] else { panic!("two meshes") };
    // Many costs on a ball are equal, and of equal ones the first mesh takes all.
    assert!(a.abs_diff(b) <= 80 && (797..=800).contains(&(a + b)), "{a} and {b}");
}

#[test]
fn copies_count_as_often_as_they_are_shown() {
    let ball = samples::sphere(1_000);
    let input = ball.faces.len();
    let trio = scene(vec![ball], vec![node(0, 1.0), node(0, 2.0), node(0, 0.5)]);
    let (level, report) = run(&trio, Target::Faces(900));
    assert_eq!((report.input_faces, report.output_faces), (3 * input, 3 * level[0].faces.len()));
    assert!(report.reached && level[0].faces.len() <= 300);
}

#[test]
fn a_bound_holds_in_the_world() {
    let ball = samples::sphere(5_000);
    let bound = 0.03;
    let (level, report) =
        run(&scene(vec![ball.clone()], vec![node(0, 10.0)]), Target::Error(bound));
    let (same, _) = run(&scene(vec![ball], vec![node(0, 1.0)]), Target::Error(bound / 10.0));
    assert_eq!(level, same);
    assert!(
        report.reached && report.error_estimate <= bound && report.error_estimate > bound / 2.0
    );
}

#[test]
fn levels_of_one_run_go_on_from_each_other() {
    let pair =
        scene(vec![samples::torus(1_000), samples::knot(1_000)], vec![node(0, 1.0), node(1, 1.0)]);
    let conditioned = conditioned(&pair, &Options::default());
    let mut simplifier = SceneSimplifier::new(&conditioned).unwrap();
    simplifier.run(Target::Ratio(0.5), &mut ()).unwrap();
    simplifier.run(Target::Ratio(0.1), &mut ()).unwrap();
    assert_eq!(simplifier.level(), run(&pair, Target::Ratio(0.1)).0);
}

#[test]
fn what_cannot_or_need_not_shrink_stays() {
    let mut points = Mesh::default();
    points.positions.push([1.0; 3]);
    let hidden = samples::sphere(500);
    let mixed = scene(
        vec![points.clone(), samples::torus(600), hidden.clone()],
        vec![node(0, 1.0), node(1, 1.0)],
    );
    let (level, report) = run(&mixed, Target::Faces(100));
    assert!(report.reached && report.output_faces <= 100);
    assert_eq!((&level[0], &level[2]), (&points, &hidden));
}

#[test]
fn a_budget_out_of_reach_is_reported() {
    let pair = scene(vec![fan(), fan()], vec![node(0, 1.0), node(1, 1.0)]);
    let keep = Options { topology: Topology::Keep, ..Options::default() };
    let ready = conditioned(&pair, &keep);
    let mut simplifier = SceneSimplifier::new(&ready).unwrap();
    let report = simplifier.run(Target::Faces(0), &mut ()).unwrap();
    assert!(!report.reached && report.output_faces > 0);
    assert!(report.refusals.iter().next().is_some() && report.non_manifold_vertices == 4);
}

#[test]
fn errors_name_the_mesh_where_there_are_several() {
    let mut bad = fan();
    bad.positions[1][2] = f64::NAN;
    let error = |scene: &Scene| {
        SceneSimplifier::new(&conditioned(scene, &Options::default())).err().unwrap()
    };
    let mut two = scene(vec![fan(), bad.clone()], vec![node(0, 1.0), node(1, 1.0)]);
    two.meshes[1].name = "wing".into();
    assert!(error(&two).to_string().starts_with("mesh 1 (wing): vertex v1"), "{}", error(&two));
    assert!(matches!(error(&Scene::from_mesh("", bad)), SceneError::Whole(_)));
    assert_eq!(error(&Scene::default()), SceneError::Nothing);
}

#[test]
fn lock_masks_run_over_all_meshes() {
    let pair =
        scene(vec![samples::sphere(300), samples::sphere(300)], vec![node(0, 1.0), node(1, 1.0)]);
    let count = pair.meshes[0].mesh.positions.len();
    let locks = |of_vertex: Vec<Lock>| Locks { of_vertex, ties: Vec::new() };
    let first = [vec![Lock::Locked; count], vec![Lock::Free; count]].concat();
    let options = Options { locks: locks(first), ..Options::default() };
    let ready = conditioned(&pair, &options);
    let mut simplifier = SceneSimplifier::new(&ready).unwrap();
    simplifier.run(Target::Faces(0), &mut ()).unwrap();
    let level = simplifier.level();
    assert_eq!(level[0], pair.meshes[0].mesh);
    assert!(level[1].faces.len() < 10);
    let short = Options { locks: locks(vec![Lock::Locked; count]), ..Options::default() };
    assert!(ConditionedScene::new(&pair, &short, Borders::Stitch).is_err());
}

#[test]
fn instanced_wheels_of_a_real_truck() {
    let Some(path) = shared_mesh("cesium-milk-truck.glb") else { return };
    let truck = read(&path, &ReadOptions::default()).unwrap();
    let shown = truck.flatten().faces.len();
    let (level, report) = run(&truck, Target::Ratio(0.4));
    let mut coarse = truck.clone();
    for (mesh, level) in coarse.meshes.iter_mut().zip(level) {
        mesh.mesh = level;
    }
    assert_eq!((report.input_faces, report.output_faces), (shown, coarse.flatten().faces.len()));
    assert!(report.reached);
}

#[test]
fn refused_candidates_that_look_cheap_do_not_cost_a_mesh_its_shape() {
    // Its parts differ much in how often they refuse.
    let Some(path) = shared_mesh("flight-helmet/FlightHelmet.gltf") else { return };
    let mut helmet = read(&path, &ReadOptions::default()).unwrap();
    let before = helmet.flatten();
    let (level, _) = run(&helmet, Target::Ratio(0.25));
    for (mesh, level) in helmet.meshes.iter_mut().zip(level) {
        mesh.mesh = level;
    }
    let options = DistanceOptions { samples: 20_000, ..DistanceOptions::default() };
    let apart = distance(&before, &helmet.flatten(), &options).unwrap();
    assert!(apart.percent(apart.max()) < 1.0, "{}%", apart.percent(apart.max()));
}
