//! Visibility of members among others, estimated from the flock's own density.
//!
//! The view is cut into tiles and each tile into slices of depth. Every member adds the part of its
//! tile that it covers to its slice. A ray is free up to a slice with the probability that it passes
//! all members in front, as if they were strewn at random within their tile: the product of what
//! each leaves free. Members larger than a tile are spread over those that they cover.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

use glam::{Mat2, Vec2, Vec3};

use crate::cell_index::cell_index;
use crate::levels::LevelTable;
use crate::select::policies::picture_gain::gains::{SIZES, pixels_of};
use crate::select::{LANES, Lanes, View};

/// Number of tiles across and down, and of slices.
const TILES: [usize; 2] = [64, 36];
const SLICES: usize = 64;

/// Last tile across and down, and last slice.
const LAST: [f32; 3] = [TILES[0] as f32 - 1.0, TILES[1] as f32 - 1.0, SLICES as f32 - 1.0];

/// Number of steps of visibility, two per octave.
pub(super) const VISIBILITIES: usize = 16;

/// Froxel of a member that is not drawn.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Largest fraction of a tile that one member can hide.
const MOST_HIDDEN: f32 = 0.95;

/// Returns the logarithm to base 2 of a visibility.
#[inline]
pub(super) fn log_visibility(visibility: usize) -> f32 {
    -0.5 * visibility as f32
}

/// Grid of tiles and slices with the octaves of light that the members of each take away.
pub(super) struct VisibilityGrid {
    /// Slice by slice within a tile, tiles row by row. While members are splatted, what they take
    /// away in the slice; then half of that and all in front.
    octaves: Vec<f32>,
    /// Area that a member covers, in square body lengths, as a mean over all directions.
    silhouette: f32,
    half_extent: Vec3,
    /// Octaves that one member of each size takes away.
    of_size: [f32; SIZES],
    /// Least size of members that cover more than a tile.
    large: usize,
    /// Tiles per tangent across and down.
    scale: [f32; 2],
    /// Depth of the first slice and slices per body length.
    depths: [f32; 2],
}

impl VisibilityGrid {
    pub(super) fn new(table: &LevelTable) -> Self {
        let count = TILES[0] * TILES[1] * SLICES;
        let views = table.differences.directions().len();
        let sum: f32 = (0..views).map(|view| table.differences.silhouette(view)).sum();
        Self {
            octaves: vec![0.0; count],
            silhouette: sum / views as f32,
            half_extent: table.half_extent.into(),
            of_size: [0.0; SIZES],
            large: SIZES,
            scale: [0.0; 2],
            depths: [0.0; 2],
        }
    }

    /// Empties the grid and fits it to a view.
    pub(super) fn start(&mut self, view: &View<'_>) {
        self.octaves.fill(0.0);
        let tangents = view.camera.tangents();
        self.scale = [0, 1].map(|axis| TILES[axis] as f32 / (2.0 * tangents[axis]));
        let [nearest, farthest] = depth_range(view);
        self.depths = [nearest, SLICES as f32 / (farthest - nearest).max(1e-3)];
        // Area of a tile in square pixels.
        let focal = view.camera.pixels_at_one();
        let tile = [0, 1].map(|axis| focal / self.scale[axis]);
        let tile_area = tile[0] * tile[1];
        for (size, of_size) in self.of_size.iter_mut().enumerate() {
            let part = self.silhouette * pixels_of(size).powi(2) / tile_area;
            *of_size = octaves_of(part);
        }
        let extent = 2.0 * self.half_extent.max_element();
        let covers_more = |size: &usize| pixels_of(*size) * extent > tile[0].min(tile[1]);
        self.large = (0..SIZES).find(covers_more).unwrap_or(SIZES);
    }

    /// Returns the froxels of eight members.
    #[inline(always)]
    pub(super) fn froxels(&self, lanes: &Lanes) -> [u32; LANES] {
        let [right, up, depth] = &lanes.seen;
        let [across, down] = self.scale;
        let [nearest, per_length] = self.depths;
        let mut froxels = [0; LANES];
        for i in 0..LANES {
            let scale = depth[i].max(1e-3).recip();
            let x = right[i] * scale * across + 0.5 * TILES[0] as f32;
            let y = up[i] * scale * down + 0.5 * TILES[1] as f32;
            let (column, row) = (cell_index(x, LAST[0]), cell_index(y, LAST[1]));
            let slice = cell_index((depth[i] - nearest) * per_length, LAST[2]);
            froxels[i] = (row * TILES[0] as u32 + column) * SLICES as u32 + slice;
        }
        froxels
    }

    /// Adds all members to the grid, and then sums up along the depths.
    pub(super) fn splat(
        &mut self,
        view: &View<'_>,
        froxels: &[u32],
        size_of: impl Fn(usize) -> usize,
    ) {
        for (member, &froxel) in froxels.iter().enumerate().filter(|(_, f)| **f != NOWHERE) {
            let size = size_of(member);
            if size < self.large {
                self.octaves[froxel as usize] += self.of_size[size];
            } else {
                let ellipse = self.ellipse(view, member, froxel);
                let octaves = &mut self.octaves;
                ellipse.tiles(|tile| octaves[tile * SLICES + ellipse.slice] += ellipse.octaves);
            }
        }
        for tile in self.octaves.chunks_exact_mut(SLICES) {
            let mut sum = 0.0;
            for slice in tile {
                let own = *slice;
                *slice = sum + 0.5 * own;
                sum += own;
            }
        }
    }

    /// Returns the visibility of a member, 0 for one that nothing hides; see [`log_visibility`].
    #[inline]
    pub(super) fn visibility(
        &self,
        view: &View<'_>,
        member: usize,
        froxel: u32,
        size: usize,
    ) -> usize {
        let octaves = if size < self.large {
            self.in_front(froxel as usize, self.of_size[size])
        } else {
            self.over_tiles(view, member, froxel)
        };
        cell_index(2.0 * octaves, VISIBILITIES as f32 - 1.0) as usize
    }

    /// Returns the octaves of light that members in front of a member take away, among them half of
    /// the others in its slice.
    #[inline]
    fn in_front(&self, froxel: usize, of_member: f32) -> f32 {
        (self.octaves[froxel] - 0.5 * of_member).max(0.0)
    }

    /// Averages the remaining light over all tiles that a member covers, in the picture or
    /// outside it.
    fn over_tiles(&self, view: &View<'_>, member: usize, froxel: u32) -> f32 {
        let ellipse = self.ellipse(view, member, froxel);
        let (mut light, mut count) = (0.0, 0.0f32);
        ellipse.tiles(|tile| {
            light += (-self.in_front(tile * SLICES + ellipse.slice, ellipse.octaves)).exp2();
            count += 1.0;
        });
        // What is outside the picture is not seen either.
        -(light / count.max(ellipse.area)).max(1e-6).log2()
    }

    /// Returns the ellipse that a large member covers.
    fn ellipse(&self, view: &View<'_>, member: usize, froxel: u32) -> Ellipse {
        let members = &view.flock.members;
        let [right, up, forward] = view.camera.axes();
        let offset = members.position(member) - view.camera.eye();
        let depth = offset.dot(forward).max(0.5 * view.table.radius);
        let scale = Vec2::from(self.scale) / depth;
        let on_screen = |v: Vec3| Vec2::new(v.dot(right), v.dot(up)) * scale;
        let frame = members.frame(member);
        let middle = on_screen(offset) + 0.5 * Vec2::new(TILES[0] as f32, TILES[1] as f32);
        let mut spread = Mat2::ZERO;
        for (axis, extent) in
            [frame.x_axis, frame.y_axis, frame.z_axis].into_iter().zip(self.half_extent.to_array())
        {
            let v = on_screen(axis * extent);
            spread += Mat2::from_cols(v * v.x, v * v.y);
        }
        let covered = self.silhouette * scale.x * scale.y;
        let area = std::f32::consts::PI * spread.determinant().max(1e-6).sqrt();
        // At least half a tile wide, or an edge-on member would fall between the tiles.
        let spread = spread + Mat2::from_diagonal(Vec2::splat(0.25));
        Ellipse {
            middle,
            reach: Vec2::new(spread.x_axis.x, spread.y_axis.y).sqrt(),
            inverse: spread.inverse(),
            area: std::f32::consts::PI * spread.determinant().max(0.0).sqrt(),
            octaves: octaves_of(covered / area),
            slice: froxel as usize % SLICES,
        }
    }
}

/// Ellipse that a member covers, in tiles.
struct Ellipse {
    middle: Vec2,
    reach: Vec2,
    inverse: Mat2,
    /// Number of tiles.
    area: f32,
    octaves: f32,
    slice: usize,
}

impl Ellipse {
    /// Visits the tiles whose middles are in the ellipse.
    fn tiles(&self, mut visit: impl FnMut(usize)) {
        let first = (self.middle - self.reach).floor();
        let last = (self.middle + self.reach).ceil();
        let range = |low: f32, high: f32, count: usize| {
            low.clamp(0.0, count as f32) as usize..high.clamp(0.0, count as f32) as usize
        };
        for y in range(first.y, last.y, TILES[1]) {
            for x in range(first.x, last.x, TILES[0]) {
                let v = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - self.middle;
                if v.dot(self.inverse * v) <= 1.0 {
                    visit(y * TILES[0] + x);
                }
            }
        }
    }
}

/// Returns the octaves of light taken away by what covers this part of a tile.
fn octaves_of(part: f32) -> f32 {
    -(1.0 - part.clamp(0.0, MOST_HIDDEN)).log2()
}

/// Members that are looked at for the range of depths.
const SAMPLED: usize = 4096;

/// Returns the least and greatest depth of members in front of the camera, from a sample of them.
fn depth_range(view: &View<'_>) -> [f32; 2] {
    let members = &view.flock.members;
    let [_, _, forward] = view.camera.axes();
    let depth = |i: usize| (members.position(i) - view.camera.eye()).dot(forward);
    let sampled = (0..members.len()).step_by(members.len().div_ceil(SAMPLED).max(1));
    let (mut least, mut greatest) = (f32::INFINITY, 0.0f32);
    for depth in sampled.map(depth).filter(|depth| *depth > 0.0) {
        (least, greatest) = (least.min(depth), greatest.max(depth));
    }
    if least < greatest { [least, greatest] } else { [0.0, greatest.max(1.0)] }
}
