//! Meshing of a closed level set by marching tetrahedra.
//!
//! Every cube of a lattice is cut into six tetrahedra around its diagonal, and neighbouring cubes
//! cut their common face alike. The signs at the corners of a tetrahedron alone decide its surface:
//! one triangle or one quad. So neighbours agree, and the result is a closed 2-manifold for *any*
//! signs, which marching cubes does not guarantee.

use std::convert::Infallible;
use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

use crate::grid::split;

/// Builds the surface around the region where `field` is negative, in the cube [-1, 1]³ of `cells`
/// cells per side.
///
/// `field` must not be negative on the border of the cube, or the surface ends there.
/// Cost: O(cells³) calls of `field`, and O(cells²) memory besides the mesh.
pub(crate) fn polygonize(cells: usize, field: impl Fn(DVec3) -> f64) -> Mesh {
    let mut mesh = Mesh::default();
    let lattice = FieldLattice { cells, value: |_: [usize; 3], place| field(place), field: &field };
    let _ = march(&lattice, true, |slab| {
        mesh.positions.extend(&slab.places);
        mesh.faces.extend(slab.faces.iter().map(|face| face.map(VertexId)));
        ControlFlow::<Infallible>::Continue(())
    });
    mesh
}

/// Lattice over the cube [-1, 1]³, and the field on it.
pub(crate) struct FieldLattice<V, F> {
    /// Number of cells per side.
    pub cells: usize,
    /// Value of the field at a point of the lattice, by its numbers and its place.
    pub value: V,
    /// Value of the field at any place.
    pub field: F,
}

/// Vertices and faces between two layers of the lattice, but for the vertices of the slab before.
#[derive(Default)]
pub(crate) struct Slab {
    /// Number of vertices.
    pub vertices: u32,
    /// Their places, where these are wanted.
    pub places: Vec<[f64; 3]>,
    /// Faces; vertices are numbered from slab to slab.
    pub faces: Vec<[u32; 3]>,
}

/// Builds the surface of [`polygonize`] slab by slab, until `take` breaks off.
pub(crate) fn march<V, F, B>(
    lattice: &FieldLattice<V, F>,
    wants_places: bool,
    mut take: impl FnMut(&Slab) -> ControlFlow<B>,
) -> ControlFlow<B>
where
    V: Fn([usize; 3], DVec3) -> f64,
    F: Fn(DVec3) -> f64,
{
    let (below, above) = (Layer::default(), Layer::sampled(lattice, 0));
    let (first, slab) = (0, Slab::default());
    let mut march = March { lattice, wants_places, below, above, first, slab };
    for z in 0..lattice.cells {
        march.below = std::mem::replace(&mut march.above, Layer::sampled(lattice, z + 1));
        for y in 0..lattice.cells {
            for x in 0..lattice.cells {
                march.cube([x, y, z]);
            }
        }
        take(&march.slab)?;
        march.first += march.slab.vertices;
        march.slab.vertices = 0;
        march.slab.places.clear();
        march.slab.faces.clear();
    }
    ControlFlow::Continue(())
}

/// Least distance of a vertex from a lattice point, as a fraction of its edge, so that no face
/// degenerates where the surface passes through a lattice point.
const LEAST_FRACTION: f64 = 0.04;
/// Number of bisections: 2⁻¹² of a cell is far below what the mesh resolves.
const BISECTIONS: usize = 12;
/// Marks an edge without a vertex.
const NONE: u32 = u32::MAX;

/// One layer of lattice points: their values, and the vertices on the seven edges that start at
/// each, by the direction of the edge as one bit per axis.
#[derive(Default)]
struct Layer {
    values: Vec<f64>,
    vertices: Vec<[u32; 8]>,
}

impl Layer {
    fn sampled<V: Fn([usize; 3], DVec3) -> f64, F>(lattice: &FieldLattice<V, F>, z: usize) -> Self {
        let side = lattice.cells + 1;
        let points = (0..side * side).map(|i| [i % side, i / side, z]);
        let values = points.map(|point| (lattice.value)(point, place(lattice.cells, point)));
        Self { values: values.collect(), vertices: vec![[NONE; 8]; side * side] }
    }
}

/// Returns the position of a lattice point.
fn place(cells: usize, point: [usize; 3]) -> DVec3 {
    DVec3::from(point.map(|i| coordinate(cells, i)))
}

/// Returns the coordinate of a lattice point on an axis.
pub(crate) fn coordinate(cells: usize, i: usize) -> f64 {
    2.0 * i as f64 / cells as f64 - 1.0
}

/// Permutations of the axes, even ones first. A tetrahedron runs from the lowest corner of a cube
/// to the highest, one axis after the other; even permutations give positive volumes.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// A corner of a cube: one bit per axis, counted from the lowest corner.
type CubeCorner = usize;

struct March<'a, V, F> {
    lattice: &'a FieldLattice<V, F>,
    wants_places: bool,
    below: Layer,
    above: Layer,
    /// Number of vertices before the slab.
    first: u32,
    slab: Slab,
}

impl<V, F: Fn(DVec3) -> f64> March<'_, V, F> {
    fn cube(&mut self, cube: [usize; 3]) {
        let inside: [bool; 8] = std::array::from_fn(|corner| self.value(cube, corner) < 0.0);
        if inside == [inside[0]; 8] {
            return;
        }
        for (i, [first, second, _]) in ORDERS.into_iter().enumerate() {
            let mut tetrahedron = [0, 1 << first, (1 << first) | (1 << second), 7];
            if i >= 3 {
                tetrahedron.swap(1, 2);
            }
            self.tetrahedron(cube, tetrahedron, &inside);
        }
    }

    /// Adds the surface inside a tetrahedron of positive volume.
    fn tetrahedron(&mut self, cube: [usize; 3], corners: [CubeCorner; 4], inside: &[bool; 8]) {
        let ([a, b, c, d], count) = inside_first(corners, inside);
        let mut vertex = |from, to| self.vertex(cube, from, to);
        match count {
            1 => {
                let face = [vertex(a, b), vertex(a, c), vertex(a, d)];
                self.slab.faces.push(face);
            }
            2 => {
                let quad = [vertex(a, c), vertex(a, d), vertex(b, d), vertex(b, c)];
                self.slab.faces.extend(split(quad));
            }
            3 => {
                let face = [vertex(a, d), vertex(b, d), vertex(c, d)];
                self.slab.faces.push(face);
            }
            _ => {}
        }
    }

    /// Returns the vertex on an edge whose ends are on different sides of the surface.
    fn vertex(&mut self, cube: [usize; 3], from: CubeCorner, to: CubeCorner) -> u32 {
        let (low, high) = (from & to, from | to);
        let (slot, direction) = (self.slot(cube, low), low ^ high);
        let layer = if low & 4 == 0 { &self.below } else { &self.above };
        let known = layer.vertices[slot][direction];
        if known != NONE {
            return known;
        }
        let id = self.first + self.slab.vertices;
        self.slab.vertices += 1;
        if self.wants_places {
            self.slab.places.push(self.crossing(cube, low, high).into());
        }
        let layer = if low & 4 == 0 { &mut self.below } else { &mut self.above };
        layer.vertices[slot][direction] = id;
        id
    }

    /// Finds the sign change of the field between two lattice points.
    fn crossing(&self, cube: [usize; 3], low: CubeCorner, high: CubeCorner) -> DVec3 {
        let [start, end] = [low, high].map(|corner| place(self.lattice.cells, at(cube, corner)));
        let starts_inside = self.value(cube, low) < 0.0;
        let (mut near, mut far) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (near + far);
            if ((self.lattice.field)(start.lerp(end, middle)) < 0.0) == starts_inside {
                near = middle;
            } else {
                far = middle;
            }
        }
        start.lerp(end, (0.5 * (near + far)).clamp(LEAST_FRACTION, 1.0 - LEAST_FRACTION))
    }

    fn value(&self, cube: [usize; 3], corner: CubeCorner) -> f64 {
        let layer = if corner & 4 == 0 { &self.below } else { &self.above };
        layer.values[self.slot(cube, corner)]
    }

    /// Returns the index of a corner in its layer.
    fn slot(&self, cube: [usize; 3], corner: CubeCorner) -> usize {
        let [x, y, _] = at(cube, corner);
        y * (self.lattice.cells + 1) + x
    }
}

/// Returns the lattice point at a corner of a cube.
fn at([x, y, z]: [usize; 3], corner: CubeCorner) -> [usize; 3] {
    [x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)]
}

/// Sorts the corners inside the surface first, keeping the volume positive; returns their number
/// too.
fn inside_first(corners: [CubeCorner; 4], inside: &[bool; 8]) -> ([CubeCorner; 4], usize) {
    let mut sorted = corners;
    let mut swaps = 0;
    // Bubble sort: three rounds sort four corners.
    for _ in 0..3 {
        for i in 0..3 {
            if !inside[sorted[i]] && inside[sorted[i + 1]] {
                sorted.swap(i, i + 1);
                swaps += 1;
            }
        }
    }
    let count = sorted.iter().filter(|&&corner| inside[corner]).count();
    if swaps % 2 == 1 {
        // One more swap, between corners on one side, restores the sign of the volume.
        if count >= 2 { sorted.swap(0, 1) } else { sorted.swap(2, 3) }
    }
    (sorted, count)
}
