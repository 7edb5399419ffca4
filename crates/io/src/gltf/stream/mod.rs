//! Triangles of a glTF document that is larger than memory.
//!
//! | file | holds |
//! |---|---|
//! | `head` | JSON, and where the buffers are |
//! | `survey` | layers and primitives of a mesh, without their values |
//! | `open` | what is shown: vertices, runs of triangles and their places |
//! | `rows` | elements of accessors, some at a time |

mod head;
mod open;
mod rows;
mod survey;

use meshlod_mesh::{Layer, LayerKind};

use crate::error::ParseError;
use crate::gltf::document::accessor::Values;
use crate::gltf::document::buffers::Buffers;
use crate::gltf::read::mesh::{Replaced, flip_v, make_finite, triangles};
use crate::scene::flatten::Placement;
use crate::scene::normals::unit_within;
pub(crate) use head::StreamHead;
use rows::AccessorRows;

/// Triangles that a glTF document shows, which are read from its files some at a time.
///
/// They are those of the scene that [`read`](super::read()) makes, merged as by
/// [`Scene::flatten`](crate::Scene::flatten) and in the same order. Vertices are in pools, in the
/// space of their mesh: [`GltfStream::vertices`] reads them, and [`GltfStream::place`] moves corners.
/// Normals without a length are 0.
#[derive(Debug)]
pub struct GltfStream {
    buffers: Buffers,
    layers: Vec<Layer>,
    pools: Vec<Pool>,
    placements: Vec<Placement>,
    runs: Vec<GltfRun>,
    /// Largest deviation of a normal's length from 1 that counts as rounding.
    rounding: f64,
}

/// Triangles of a primitive, shown once.
#[derive(Clone, Copy, Debug)]
pub struct GltfRun {
    /// Pool of its vertices.
    pub pool: usize,
    /// Number of steps: triangles, with those of strips and fans that have no area.
    pub steps: usize,
    /// Material label of the scene's faces.
    pub material: u32,
    mode: u32,
    indices: Option<AccessorRows>,
    placement: usize,
}

/// Vertices with their values.
#[derive(Debug)]
struct Pool {
    count: usize,
    positions: AccessorRows,
    /// Values of each layer; `None` where the primitive lacks it.
    values: Vec<Option<AccessorRows>>,
}

/// Number of vertices with odd values.
#[derive(Clone, Copy, Debug, Default)]
struct Odd {
    replaced: Replaced,
    /// Normals that were scaled.
    scaled: usize,
    /// Normals without a length.
    bare: usize,
}

impl GltfStream {
    /// Returns the layers of corners, without values.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Returns the number of pools.
    pub fn pools(&self) -> usize {
        self.pools.len()
    }

    /// Returns the number of vertices of a pool.
    pub fn vertices_of(&self, pool: usize) -> usize {
        self.pools[pool].count
    }

    /// Returns the runs of triangles, in order.
    pub fn runs(&self) -> &[GltfRun] {
        &self.runs
    }

    /// Appends some vertices of a pool, which must be there, and their values of all layers.
    ///
    /// # Errors
    /// The accessor or buffer, and the reason: a file that cannot be read, or has changed.
    pub fn vertices(
        &self,
        pool: usize,
        (first, count): (usize, usize),
        places: &mut Vec<[f64; 3]>,
        values: &mut Vec<f32>,
    ) -> Result<(), ParseError> {
        self.read(pool, (first, count), places, values).map(drop)
    }

    fn read(
        &self,
        pool: usize,
        (first, count): (usize, usize),
        places: &mut Vec<[f64; 3]>,
        values: &mut Vec<f32>,
    ) -> Result<Odd, ParseError> {
        let pool = &self.pools[pool];
        let points = pool.positions.points(&self.buffers, first, count)?;
        places.extend(points.as_chunks::<3>().0.iter().map(|point| point.map(f64::from)));
        let width: usize = self.layers.iter().map(|layer| layer.width).sum();
        let base = values.len();
        values.resize(base + width * count, 0.0);
        let (mut odd, mut at) = (Odd::default(), 0);
        for (layer, rows) in self.layers.iter().zip(&pool.values) {
            let own = match rows {
                Some(rows) => self.layer_values(layer.kind, rows, (first, count), &mut odd)?,
                None => Values { width: layer.width, values: Vec::new() },
            };
            // What is missing is white and opaque, or 0.
            let fill = if matches!(layer.kind, LayerKind::Color(_)) { 1.0 } else { 0.0 };
            for (row, into) in values[base..].chunks_exact_mut(width).enumerate() {
                let into = &mut into[at..at + layer.width];
                let found = own.values.get(row * own.width..(row + 1) * own.width);
                let (there, rest) = into.split_at_mut(found.map_or(0, <[f32]>::len));
                there.copy_from_slice(found.unwrap_or_default());
                rest.fill(fill);
            }
            at += layer.width;
        }
        Ok(odd)
    }

    /// Reads values of a layer as scenes have them.
    fn layer_values(
        &self,
        kind: LayerKind,
        rows: &AccessorRows,
        (first, count): (usize, usize),
        odd: &mut Odd,
    ) -> Result<Values, ParseError> {
        let values = rows.floats(&self.buffers, first, count)?;
        let mut values = Values { width: rows.width, values };
        odd.replaced.add(make_finite(kind, &mut values));
        match kind {
            LayerKind::Uv(_) => flip_v(&mut values.values),
            LayerKind::Normal => {
                for normal in values.values.as_chunks_mut::<3>().0 {
                    let unit = unit_within(*normal, self.rounding);
                    odd.bare += usize::from(unit.is_none());
                    odd.scaled += usize::from(unit.is_some_and(|unit| unit != *normal));
                    *normal = unit.unwrap_or_default();
                }
            }
            _ => {}
        }
        Ok(values)
    }

    /// Appends the triangles of some steps of a run, which must be there, by the vertices of its pool.
    ///
    /// # Errors
    /// The accessor or buffer, and the reason: an index that is too large, or a file that cannot be
    /// read.
    pub fn faces(
        &self,
        run: usize,
        (first, count): (usize, usize),
        faces: &mut Vec<[u32; 3]>,
    ) -> Result<(), ParseError> {
        let run = &self.runs[run];
        let mut corners = Vec::new();
        match run.mode {
            4 => self.corners(run, (3 * first, 3 * count), &mut corners)?,
            5 => {
                self.corners(run, (first, count + 2), &mut corners)?;
                if first % 2 == 1 {
                    // Every other triangle of a strip turns: one without area makes the first do.
                    corners.insert(0, corners[0]);
                }
            }
            _ => {
                self.corners(run, (0, 1), &mut corners)?;
                self.corners(run, (first + 1, count + 1), &mut corners)?;
            }
        }
        let mirrors = self.placements[run.placement].mirrors;
        let turned = |[a, b, c]: [u32; 3]| if mirrors { [a, c, b] } else { [a, b, c] };
        faces.extend(triangles(run.mode, &corners).map(turned));
        Ok(())
    }

    /// Appends some corners of a run.
    fn corners(
        &self,
        run: &GltfRun,
        (first, count): (usize, usize),
        corners: &mut Vec<u32>,
    ) -> Result<(), ParseError> {
        let limit = self.pools[run.pool].count;
        match &run.indices {
            Some(rows) => corners.extend(rows.indices(&self.buffers, first, count, limit)?),
            None => corners.extend(first as u32..(first + count) as u32),
        }
        Ok(())
    }

    /// Moves a corner of a run from its mesh to where it is shown.
    #[inline]
    pub fn place(&self, run: usize, place: [f64; 3], values: &mut [f32]) -> [f64; 3] {
        let placement = &self.placements[self.runs[run].placement];
        let mut at = 0;
        for layer in &self.layers {
            placement.turn(layer.kind, layer.width, &mut values[at..at + layer.width]);
            at += layer.width;
        }
        placement.point(place)
    }
}
