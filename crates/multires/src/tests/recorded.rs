//! Contractions that the end of a run shows, and facts of a forest that is not refined.

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::{Options, Simplifier, Target};

use super::walks::{METHODS, each, soup};
use crate::implicit::{Implicit, Order};
use crate::{Forest, Recorder};

/// Returns meshes as they are, with faces that are left out, and with vertices that are copied.
fn all_sorts() -> Vec<(String, Mesh)> {
    let mut odd = samples::gyroid(3_000);
    odd.positions.extend([[9.0; 3]; 3]);
    odd.faces.push([3, 3, 4].map(VertexId));
    odd.faces.insert(0, odd.faces[7]);
    let named = [
        ("terrain", samples::terrain(3_000)),
        ("odd", odd),
        ("hourglass", fixtures::hourglass()),
        ("charted", fixtures::charted(&samples::torus(900))),
    ];
    let named = named.into_iter().map(|(name, mesh)| (name.to_owned(), mesh));
    named.chain((0..6).map(|seed| (format!("soup {seed}"), soup(seed)))).collect()
}

#[test]
fn the_end_of_a_run_shows_the_contractions_of_any_run() {
    for (name, mesh) in all_sorts() {
        for method in METHODS {
            let options = Forest::options(&mesh, &Options { method, ..Options::default() });
            let start = || {
                let simplifier = Simplifier::new(&mesh, &options).unwrap();
                let recorder = Recorder::new(&simplifier);
                (simplifier, recorder)
            };
            let (mut simplifier, mut kept) = start();
            let report = simplifier.run(Target::Faces(0), &mut kept).unwrap();
            let (simplifier, mut ended) = start();
            let last = simplifier.run_out(&mut ended);
            assert_eq!(format!("{report:?}"), format!("{last:?}"), "{name} by {}", method.name());
            let [kept, ended] = [kept, ended].map(|by| format!("{:?}", by.into_forest().unwrap()));
            assert!(kept == ended, "{name} by {}", method.name());
        }
    }
}

#[test]
fn a_run_in_steps_ends_like_one_in_a_single_step() {
    let mesh = samples::gyroid(3_000);
    let options = Forest::options(&mesh, &Options::default());
    let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
    let mut steps = Recorder::new(&simplifier);
    simplifier.run(Target::Faces(2_000), &mut steps).unwrap();
    let report = simplifier.run_out(&mut steps);
    let forest = steps.into_forest().unwrap();
    assert_eq!(report.contractions.edges, forest.update_count());
    Implicit::new(&forest).unwrap().certify().unwrap();
}

/// The triangles of all cuts by contracting and by refining.
#[test]
fn contractions_make_the_triangles_of_all_cuts() {
    each(|what, _, forest| {
        let order = Order::new(forest);
        let sorted = |mut all: Vec<[u32; 3]>| {
            all.iter_mut().for_each(|nodes| nodes.sort_unstable());
            all.sort_unstable();
            all
        };
        let mut made = Vec::new();
        forest.each_triangle(|nodes| made.push(nodes.map(|n| order.index_of_node[n as usize])));
        let mut refined = Vec::new();
        Implicit::new(forest).unwrap().each_triangle(|nodes| refined.push(nodes));
        assert_eq!(sorted(made), sorted(refined), "{what}");
    });
}
