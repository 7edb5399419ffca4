//! Content of a tile: its mesh as GLB, on the grid of its level.

use meshlod_io::gltf::{Compression, PositionGrid, write_compressed_glb};
use meshlod_io::{Node, Scene, SceneMesh, Unsupported};
use meshlod_mesh::{Mesh, VertexId};
use rustc_hash::FxHashMap;

use crate::cell::{Cell, grid_step};
use crate::lattice::Point;
use crate::plan::{Look, Plan};
use crate::skirt::skirt;
use crate::texture::{TileLook, repack};
use crate::tile::{TileMesh, point_of};

/// Column-major matrix from axes whose z is up to those of glTF, whose y is up.
const TO_Y_UP: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// Content of a tile.
#[derive(Debug)]
pub struct Content {
    /// The GLB file.
    pub glb: Vec<u8>,
    /// Number of faces, without those of skirts.
    pub faces: usize,
    /// Greatest distance by which a vertex was moved, in steps of the lattice.
    pub moved: f64,
    /// Least and greatest coordinates, in steps of the lattice.
    pub bounds: [[f64; 3]; 2],
    /// Images of the model that the tile should show and that cannot be decoded.
    pub lost_images: Vec<usize>,
}

/// Makes the content of a tile. Vertices that it shares with others are on the coarsest grid of all
/// of them, so that all place them alike.
///
/// # Errors
/// A mesh that glTF cannot hold.
pub fn content(
    (plan, look): (&Plan, &Look),
    cell: Cell,
    tile: &TileMesh,
) -> Result<Content, Unsupported> {
    let (mut mesh, moved) = on_grid(plan, cell, tile);
    let halvings = plan.tree.deepest_in(cell) - cell.depth;
    let shown = repack(look, &mut mesh, halvings.into());
    let skirts = plan.options.skirts.then(|| skirt(plan, cell, tile, &mesh)).flatten();
    // A tile of crumbs may lose all its faces, but not its place.
    let place = mesh.positions.first().copied();
    drop_degenerate(&mut mesh);
    let faces = mesh.faces.len();
    let alone = place.filter(|_| mesh.positions.is_empty());
    let hanging = skirts.iter().flat_map(|mesh| &mesh.positions);
    let all = || mesh.positions.iter().chain(hanging.clone()).chain(&alone);
    let bounds = all().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], at| {
        [0, 1].map(|side| {
            [0, 1, 2].map(|axis| match side {
                0 => f64::min(low[axis], at[axis]),
                _ => f64::max(high[axis], at[axis]),
            })
        })
    });
    let mut meshes = vec![mesh];
    meshes.extend(skirts);
    let lost_images = shown.lost.iter().copied().collect();
    let glb = encode((plan, shown), cell, meshes)?;
    Ok(Content { glb, faces, moved, bounds, lost_images })
}

/// Returns the mesh of a tile with its vertices on the grid of its level, in steps of the lattice,
/// and the greatest distance that one was moved.
fn on_grid(plan: &Plan, cell: Cell, tile: &TileMesh) -> (Mesh, f64) {
    let is_border = tile.border_vertices();
    // All planes between cells are multiples of this.
    let plane = Cell { depth: plan.tree.depth(), at: [0; 3] }.width();
    let mut mesh = tile.mesh.clone();
    let mut on_side = Vec::with_capacity(is_border.len());
    for (i, is_border) in is_border.into_iter().enumerate() {
        let point = point_of(&mesh, VertexId::new(i));
        let depth = match is_border {
            true => plan.tree.least_depth_around(point, cell),
            false => cell.depth,
        };
        let step = grid_step(depth);
        let near = match is_border {
            true => point.map(|x| off_planes(x, step, plane)),
            false => point.map(|x| nearest(x, step)),
        };
        on_side.push(!is_border && cell.sides_of(near) != 0);
        mesh.positions[i] = near.map(f64::from);
    }
    for v in open_ends(&mesh, &on_side) {
        let near = inside(point_of(&mesh, v), cell, grid_step(cell.depth));
        mesh.positions[v.index()] = near.map(f64::from);
    }
    let pairs = mesh.positions.iter().zip(&tile.mesh.positions);
    let moved = pairs.map(|(a, b)| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum());
    let moved = moved.fold(0.0, f64::max);
    (mesh, moved.sqrt())
}

/// Returns the closest number of a grid.
fn nearest(x: i32, step: i32) -> i32 {
    (x + step / 2) & !(step - 1)
}

/// Returns the closest number of a grid that is on a plane between cells only where `x` is. An open
/// edge has both ends on sides of its tile where it crosses two of them, and must not get into a
/// third.
fn off_planes(x: i32, step: i32, plane: i32) -> i32 {
    match nearest(x, step) {
        near if near % plane == 0 && plane > step => near + step * (x - near).signum(),
        near => near,
    }
}

/// Returns those of some vertices that are ends of open edges.
fn open_ends(mesh: &Mesh, of: &[bool]) -> Vec<VertexId> {
    let mut sums: FxHashMap<[VertexId; 2], i32> = FxHashMap::default();
    for &[a, b, c] in mesh.faces.iter().filter(|face| face.iter().any(|v| of[v.index()])) {
        let edges = [[a, b], [b, c], [c, a]].into_iter();
        for [from, to] in edges.filter(|edge| edge.iter().any(|v| of[v.index()])) {
            let sum = if from < to { 1 } else { -1 };
            *sums.entry([from.min(to), from.max(to)]).or_default() += sum;
        }
    }
    let open = sums.into_iter().filter(|(_, sum)| *sum != 0).flat_map(|(edge, _)| edge);
    let mut ends: Vec<VertexId> = open.filter(|v| of[v.index()]).collect();
    ends.sort_unstable();
    ends.dedup();
    ends
}

/// Moves a point on a side of a cell inside. Of open edges, only those that tiles share are in sides.
fn inside(point: Point, cell: Cell, step: i32) -> Point {
    let (low, high) = (cell.low(), cell.high());
    [0, 1, 2].map(|axis| match point[axis] {
        at if at <= low[axis] => low[axis] + step,
        at if at >= high[axis] => high[axis] - step,
        at => at,
    })
}

/// Removes faces with two corners at one place.
fn drop_degenerate(mesh: &mut Mesh) {
    let is_sound = |face: &[VertexId; 3]| {
        let [a, b, c] = face.map(|v| mesh.positions[v.index()]);
        a != b && b != c && c != a
    };
    let keep: Vec<bool> = mesh.faces.iter().map(is_sound).collect();
    if keep.iter().all(|&keep| keep) {
        return;
    }
    let kept = |i: &mut usize| {
        *i += 1;
        keep[*i - 1]
    };
    let mut at = 0;
    mesh.faces.retain(|_| kept(&mut at));
    if let Some(attributes) = &mut mesh.attributes {
        let mut at = 0;
        attributes.corners.retain(|_| kept(&mut at));
    }
    if let Some(labels) = &mut mesh.materials {
        let mut at = 0;
        labels.of_face.retain(|_| kept(&mut at));
    }
    mesh.compact();
}

/// Encodes meshes in steps of the lattice as a GLB about the middle of the cell, in model units.
fn encode(
    (plan, shown): (&Plan, TileLook),
    cell: Cell,
    meshes: Vec<Mesh>,
) -> Result<Vec<u8>, Unsupported> {
    let (step, middle) = (plan.lattice.step, cell.middle());
    let transform = match plan.options.is_z_up {
        true => TO_Y_UP,
        false => Node::default().transform,
    };
    let local = |mut mesh: Mesh| {
        for at in &mut mesh.positions {
            *at = [0, 1, 2].map(|axis| (at[axis] - f64::from(middle[axis])) * step);
        }
        mesh
    };
    let labels = plan.labels.len();
    let names = ["surface", "skirt"].into_iter();
    let meshes: Vec<SceneMesh> = names
        .zip(meshes)
        .map(|(name, mesh)| SceneMesh {
            name: name.to_owned(),
            mesh: local(mesh),
            materials: if labels == 0 { vec![None] } else { (0..labels).map(Some).collect() },
        })
        .collect();
    let nodes =
        (0..meshes.len()).map(|mesh| Node { mesh: Some(mesh), transform, ..Node::default() });
    let scene = Scene {
        nodes: nodes.collect(),
        roots: (0..meshes.len()).collect(),
        meshes,
        materials: shown.materials,
        images: shown.images,
        ..Scene::default()
    };
    let grid = f64::from(grid_step(cell.depth));
    // Half of the numbers that the cell leaves over are on each side of it.
    let margin = (f64::from(1 << 16) * grid - f64::from(cell.width())) / 2.0;
    let margin = (margin / grid).floor() * grid;
    let origin = [-(f64::from(cell.width()) / 2.0 + margin) * step; 3];
    let compression = Compression {
        grid: Some(PositionGrid { origin, cell: grid * step }),
        meshopt: plan.options.meshopt,
        uv_bits: 14,
        ..Compression::default()
    };
    Ok(write_compressed_glb(&scene, &[], &compression)?.0)
}
