//! Tiles of crumbs: a face that is alone in its cell, and too small for the grid of the tile.

mod common;

use common::Kernel;
use meshlod_io::Scene;
use meshlod_mesh::{Bounds, Mesh, VertexId};
use meshlod_samples::terrain;
use meshlod_tiles::folder::Folder;
use meshlod_tiles::plan::{Look, Plan, TileOptions};
use meshlod_tiles::source::SceneSource;
use meshlod_tiles::task::run_task;

#[test]
fn tiles_without_faces_are_done() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = Folder::new(temporary.path());
    folder.make().unwrap();
    let one = |i: usize| std::array::from_fn(|k| if i == k { 1.0 } else { 0.0 });
    let options = TileOptions {
        most_faces: 160,
        meshopt: true,
        skirts: false,
        placement: [0, 1, 2, 3].map(one),
        is_z_up: false,
    };
    let Mesh { mut positions, mut faces, .. } = terrain(2_000);
    let [low, high] = [Bounds::of(&positions).min, Bounds::of(&positions).max];
    let (first, extent) = (positions.len(), high[0] - low[0]);
    for [x, y] in [[0.7, 0.7], [0.700_001_5, 0.7], [0.7, 0.700_001_5]] {
        positions.push([low[0] + x * extent, low[1] + y * extent, low[2] + 0.7 * extent]);
    }
    faces.push([0, 1, 2].map(|corner| VertexId::new(first + corner)));
    let source = SceneSource::new(Scene::from_mesh("terrain", Mesh::new(positions, faces)));
    let look = Look::default();
    let plan = Plan::new(&source, &look, &options, &folder.scratch()).unwrap();
    let plan = Plan { errors: vec![2e3; usize::from(plan.tree.depth()) + 1], ..plan };
    let mut empty = 0;
    for task in 0..plan.tasks.len() {
        let made = run_task((&plan, &look), &folder, task, &Kernel).unwrap();
        empty += usize::from(made.faces == 0);
        let found = folder.record(&plan, task).unwrap().expect("a tile that is done has a record");
        assert!(found.bounds.iter().flatten().all(|x| x.is_finite()), "{}", made.cell);
    }
    assert!(empty > 0, "no tile is without faces");
}
