//! Tiles of sample meshes, in memory: their curves meet at every level, and levels stay closed.

mod common;

use std::collections::BTreeMap;

use common::Kernel;
use meshlod_mesh::{Connectivity, Mesh};
use meshlod_samples as samples;
use meshlod_tiles::chain::chain_sum;
use meshlod_tiles::coarser::coarser;
use meshlod_tiles::cut::Cutter;
use meshlod_tiles::lattice::Point;
use meshlod_tiles::layout::Layout;
use meshlod_tiles::merge::merge;
use meshlod_tiles::tile::TileBuilder;
use meshlod_tiles::{Cell, TileLattice, TileMesh, TileTree};

/// Points of the faces of a mesh on the lattice.
fn points(mesh: &Mesh) -> Vec<[Point; 3]> {
    let lattice = TileLattice::over(&mesh.bounds()).unwrap();
    let at: Vec<Point> = mesh.positions.iter().map(|&at| lattice.point(at)).collect();
    mesh.faces.iter().map(|face| face.map(|v| at[v.index()])).collect()
}

/// TileTree whose leaves hold the centres of at most so many triangles.
fn octree(triangles: &[[Point; 3]], most: usize) -> TileTree {
    let centres: Vec<Point> = triangles
        .iter()
        .map(|[a, b, c]| [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3))
        .collect();
    TileTree::divide(|cell| centres.iter().filter(|&&at| cell.contains(at)).count() > most)
}

fn leaves(triangles: &[[Point; 3]], tree: &TileTree) -> BTreeMap<Cell, TileMesh> {
    let mut builders: BTreeMap<usize, TileBuilder> = BTreeMap::new();
    let cutter = Cutter::new(tree);
    let none: &[f32] = &[];
    for &triangle in triangles {
        cutter.cut(triangle, &mut |leaf, piece| {
            let builder = builders
                .entry(leaf)
                .or_insert_with(|| TileBuilder::new(Layout::default().attributes(), &[]));
            builder.add_face(piece.map(|corner| (corner.at, none)), 0);
        });
    }
    let leaf = |(node, builder): (usize, TileBuilder)| {
        let cell = tree.nodes()[node].cell;
        (cell, builder.leaf(cell))
    };
    builders.into_iter().map(leaf).collect()
}

/// Makes all tiles, and calls `see` with those of each level, the finest first.
fn levels(
    mesh: &Mesh,
    most: usize,
    error: impl Fn(u8) -> f64,
    mut see: impl FnMut(u8, &BTreeMap<Cell, TileMesh>),
) {
    let triangles = points(mesh);
    let tree = octree(&triangles, most);
    let mut shown = leaves(&triangles, &tree);
    see(tree.depth(), &shown);
    for depth in (0..tree.depth()).rev() {
        let inner = tree.nodes().iter().filter(|n| n.cell.depth == depth && n.children.is_some());
        for node in inner {
            let parts: Vec<TileMesh> =
                (0..8).filter_map(|octant| shown.remove(&node.cell.child(octant))).collect();
            let merged = merge(parts, node.cell);
            assert_eq!(merged.open, 0, "{}", node.cell);
            let made = coarser(merged.tile, (node.cell, &tree), error(depth), &Kernel).unwrap();
            assert!(!made.is_unchanged, "{}", node.cell);
            shown.insert(node.cell, made.tile);
        }
        see(depth, &shown);
    }
}

/// All tiles as one mesh, joined where they meet.
fn whole(tiles: &BTreeMap<Cell, TileMesh>) -> Mesh {
    let merged = merge(tiles.values().cloned().collect(), Cell::ROOT);
    assert_eq!(merged.open, 0);
    merged.tile.mesh
}

fn sums_cancel(tiles: &BTreeMap<Cell, TileMesh>) -> bool {
    tiles.values().fold(0u128, |sum, tile| sum.wrapping_add(chain_sum(tile))) == 0
}

#[test]
fn closed_surfaces_stay_closed_at_every_level() {
    for (mesh, most) in [
        (samples::sphere(20_000), 700),
        (samples::gyroid(40_000), 1500),
        (samples::knot(20_000), 900),
        (samples::cube(12_000), 600),
    ] {
        let before = Connectivity::new(&mesh.faces, mesh.positions.len());
        let mut last = usize::MAX;
        levels(
            &mesh,
            most,
            |depth| f64::from(400 * (1 << (6 - depth.min(6)))),
            |depth, tiles| {
                assert!(sums_cancel(tiles), "depth {depth}");
                let level = whole(tiles);
                let connectivity = Connectivity::new(&level.faces, level.positions.len());
                eprintln!(
                    "depth {depth}: {} tiles, {} faces, {} boundary, {} non-manifold",
                    tiles.len(),
                    level.faces.len(),
                    connectivity.boundary_edges(),
                    connectivity.non_manifold_edges()
                );
                assert_eq!(connectivity.boundary_edges(), 0, "depth {depth}");
                assert_eq!(
                    connectivity.non_manifold_edges(),
                    before.non_manifold_edges(),
                    "depth {depth}"
                );
                assert!(level.faces.len() < last);
                last = level.faces.len();
            },
        );
    }
}
