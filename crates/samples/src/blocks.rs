//! Hard surfaces on a lattice: flats at right angles, each divided into many squares.

use std::collections::HashMap;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

use crate::grid::split;
use crate::random::Random;

/// Squares along the side of a block of `voxels`.
const SQUARES: i32 = 8;

/// Number of boxes of `boxes`.
const BOXES: usize = 200;

/// Number of steps of `stairs`.
const STEPS: i32 = 12;

/// Squares from one tunnel of `tunnels` to the next.
const TILE: i32 = 5;

/// Largest width of a tunnel, in squares. At least one square is between it and the next.
const WIDEST: i32 = 3;

/// Thickness of the slab of `tunnels`, in squares.
const THICKNESS: i32 = 2;

/// Builds a cube of side 1, each of its sides divided into squares.
///
/// Closed. The face count is 12 times a square number.
pub fn cube(faces: usize) -> Mesh {
    let squares = squares_of(faces, 6);
    placed(&surface([1; 3], squares, |_| true), |at| at / f64::from(squares) - 0.5)
}

/// Builds 200 boxes of random sizes at random places, many of which intersect.
///
/// Each is closed. The face count is 2,400 times a square number.
pub fn boxes(faces: usize, seed: u64) -> Mesh {
    let squares = squares_of(faces, 6 * BOXES);
    let one = surface([1; 3], squares, |_| true);
    let mut random = Random::new(seed);
    let mut all = Mesh::default();
    for _ in 0..BOXES {
        let mut vector = |least: f64, most: f64| {
            DVec3::from_array([(); 3].map(|()| least + (most - least) * random.unit()))
        };
        let (size, from) = (vector(0.05, 0.4), vector(-1.0, 0.6));
        let first = all.positions.len();
        all.positions.extend(placed(&one, |at| from + size * at / f64::from(squares)).positions);
        let moved = |face: &[VertexId; 3]| face.map(|v| VertexId::new(first + v.index()));
        all.faces.extend(one.faces.iter().map(moved));
    }
    all
}

/// Builds a flight of twelve stairs.
///
/// Closed. The face count is 828 times a square number.
pub fn stairs(faces: usize) -> Mesh {
    let width = STEPS / 2;
    let sides = 2 * (STEPS * (STEPS + 1) / 2) + 4 * STEPS * width;
    let squares = squares_of(faces, sides as usize);
    let solid = surface([STEPS, STEPS, width], squares, |[x, y, _]| y <= x);
    let unit = 2.0 / f64::from(STEPS * squares);
    placed(&solid, |at| at * unit - DVec3::new(1.0, 1.0, 0.5))
}

/// Builds a solid of random blocks, about half of which are there, each side of one divided into
/// eight by eight squares.
///
/// Closed, but not a manifold: where two blocks touch along an edge alone, it has four faces. The
/// face count is within a fifth of `faces` from 50,000 on.
pub fn voxels(faces: usize, seed: u64) -> Mesh {
    // Half of the blocks are there, and half of their sides are free; so is the rim.
    let of_block = f64::from(2 * SQUARES * SQUARES) * 1.5;
    let blocks = (faces as f64 / of_block).cbrt().round().max(2.0) as i32;
    let count = (blocks * blocks * blocks) as usize;
    let mut random = Random::new(seed);
    let is_there: Vec<bool> = (0..count).map(|_| random.unit() < 0.5).collect();
    let solid = |[x, y, z]: [i32; 3]| is_there[((z * blocks + y) * blocks + x) as usize];
    let unit = 2.0 / f64::from(blocks * SQUARES);
    placed(&surface([blocks; 3], SQUARES, solid), |at| at * unit - 1.0)
}

/// Builds a slab with tunnels through it, which are one to three squares wide and in a grid, though
/// not exactly.
///
/// Closed, of genus k² for k × k tunnels. The face count is within a tenth of `faces` from 5,000 on.
pub fn tunnels(faces: usize, seed: u64) -> Mesh {
    // Both sides of a tile less those of a tunnel, 25 and 14 / 3 squares in the mean, and four walls.
    let of_tile = 2.0 * (2.0 * (25.0 - 14.0 / 3.0) + 4.0 * 2.0 * f64::from(THICKNESS));
    let count = (faces as f64 / of_tile).sqrt().round().max(1.0) as i32;
    let side = TILE * count + 1;
    let mut random = Random::new(seed);
    let tunnels: Vec<[i32; 3]> = (0..count * count)
        .map(|_| {
            let width = random.whole(1, WIDEST as usize) as i32;
            let [x, z] = [(); 2].map(|()| random.whole(0, (TILE - 1 - width) as usize) as i32);
            [x, z, width]
        })
        .collect();
    let is_solid = |[x, _, z]: [i32; 3]| {
        let [column, row] = [x, z].map(|at| (at - 1).div_euclid(TILE));
        if column < 0 || row < 0 {
            return true;
        }
        let [left, top, width] = tunnels[(row * count + column) as usize];
        let is_within = |at: i32, first: i32| (first..first + width).contains(&(at - 1));
        !(is_within(x - TILE * column, left) && is_within(z - TILE * row, top))
    };
    let unit = 2.0 / f64::from(side);
    let middle = DVec3::new(1.0, f64::from(THICKNESS) * unit / 2.0, 1.0);
    placed(&surface([side, THICKNESS, side], 1, is_solid), |at| at * unit - middle)
}

/// Returns into how many squares a side is divided along an edge, for a number of faces.
fn squares_of(faces: usize, sides: usize) -> i32 {
    (faces as f64 / (2 * sides) as f64).sqrt().round().max(1.0) as i32
}

/// Moves the vertices of a mesh.
pub(crate) fn placed(mesh: &Mesh, place: impl Fn(DVec3) -> DVec3) -> Mesh {
    let positions = mesh.positions.iter().map(|&at| place(at.into()).into()).collect();
    Mesh { positions, ..mesh.clone() }
}

/// Builds the surface of a solid of unit blocks, of which there are `size` in each direction at
/// most, with coordinates in squares.
fn surface(size: [i32; 3], squares: i32, is_solid: impl Fn([i32; 3]) -> bool) -> Mesh {
    let mut lattice = Lattice::default();
    let is_there =
        |at: [i32; 3]| (0..3).all(|axis| (0..size[axis]).contains(&at[axis])) && is_solid(at);
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in (0..size[0]).filter(|&x| is_there([x, y, z])) {
                for (axis, is_upper) in [0, 1, 2].into_iter().flat_map(|a| [(a, false), (a, true)])
                {
                    let mut beside = [x, y, z];
                    beside[axis] += if is_upper { 1 } else { -1 };
                    if !is_there(beside) {
                        lattice.push_side(
                            [x, y, z].map(|at| at * squares),
                            axis,
                            is_upper,
                            squares,
                        );
                    }
                }
            }
        }
    }
    lattice.mesh
}

/// Mesh with one vertex at each point of a lattice.
#[derive(Default)]
struct Lattice {
    mesh: Mesh,
    vertices: HashMap<[i32; 3], VertexId>,
}

impl Lattice {
    /// Appends a side of the block at `corner`, divided into squares.
    fn push_side(&mut self, corner: [i32; 3], axis: usize, is_upper: bool, squares: i32) {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let mut at = corner;
        at[axis] += if is_upper { squares } else { 0 };
        for (row, column) in (0..squares).flat_map(|row| (0..squares).map(move |c| (row, c))) {
            let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[right, up]| {
                let mut point = at;
                point[u] += column + right;
                point[v] += row + up;
                self.vertex(point)
            });
            if !is_upper {
                quad.reverse();
            }
            self.mesh.faces.extend(split(quad));
        }
    }

    fn vertex(&mut self, at: [i32; 3]) -> VertexId {
        let Self { mesh, vertices } = self;
        *vertices.entry(at).or_insert_with(|| {
            mesh.positions.push(at.map(f64::from));
            VertexId::new(mesh.positions.len() - 1)
        })
    }
}
