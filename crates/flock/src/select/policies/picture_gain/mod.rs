//! Levels by the gain of their triangles for the picture, under one budget for the whole flock.
//!
//! Every member falls into a cell: the direction from which it is seen, its size on the screen, and
//! its visible fraction. Members of a cell are alike, so the budget is shared out among cells, not
//! members, and the best choice costs the same for a hundred members as for a million:
//! 1. [`visibility`]: members are splatted into a grid of tiles and depths; what lies in front of a
//!    member hides it.
//! 2. [`gains`]: for every direction and size the table knows what the next finer level adds to the
//!    picture per triangle.
//! 3. [`allocation`]: the steps of all cells are taken in the order of their gains until the budget
//!    is spent [FS93].
//! 4. A member keeps its level while it is within a band around that of its cell, and faces that it
//!    turns away are left out by its facing chain.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

mod allocation;
mod gains;
mod visibility;

use glam::Vec3;
use rayon::prelude::*;

use crate::levels::{DirectionGrid, LevelTable, NEAREST_FACING};
use crate::select::policies::picture_gain::allocation::Allocation;
use crate::select::policies::picture_gain::gains::{Gains, SIZES, size_of};
use crate::select::policies::picture_gain::visibility::{NOWHERE, VISIBILITIES, VisibilityGrid};
use crate::select::view::load;
use crate::select::{InstanceLevel, LANES, Lanes, Policy, View};

/// Shares a budget of triangles out so that the picture of the whole flock changes least.
pub struct PictureGain {
    gains: Gains,
    grid: VisibilityGrid,
    allocation: Allocation,
    /// Directions of cells, the finest grid of the facing chains.
    directions: DirectionGrid,
    /// Level for every depth and direction, direction by direction.
    facing: Vec<u16>,
    /// Direction of the differences for each direction.
    view_of_facing: Vec<u8>,
    /// Depth in its chain of every level.
    depth_of: Vec<u8>,
    /// Triangles of every level.
    triangles_of: Vec<u32>,
    /// Froxel of each member, then its cell.
    places: Vec<u32>,
    /// Size and direction of each member.
    looks: Vec<MemberLook>,
}

/// How a member looks to the camera.
#[derive(Clone, Copy, Debug, Default)]
struct MemberLook {
    size: u8,
    /// Direction of the facing chains in which the eye is.
    facing: u16,
}

/// Members that one task handles.
const TASK: usize = 1 << 14;

/// Times that the budget is shared out anew where the levels cost more than expected.
const ATTEMPTS: usize = 6;

/// Number of a cell for members that are not drawn.
const NO_CELL: u32 = u32::MAX;

/// Bit of a cell's number for members that are too near for facing chains.
const NEAR: u32 = 1 << 31;

impl PictureGain {
    /// Creates the policy for a table of levels.
    pub fn new(table: &LevelTable) -> Self {
        let finest =
            table.facing.iter().map(|depth| &depth.directions).max_by_key(|grid| grid.len());
        let directions = finest.cloned().unwrap_or_else(|| DirectionGrid::new(2));
        let views = table.differences.directions();
        let axes = (0..directions.len()).map(|cell| directions.axis(cell));
        let level = |(axis, depth): (Vec3, usize)| {
            let fits = directions.is_within(&table.facing[depth].directions);
            if fits { table.facing_level(depth, axis) as u16 } else { depth as u16 }
        };
        let of_axis = |axis: Vec3| (0..table.depth()).map(move |depth| (axis, depth));
        Self {
            gains: Gains::new(table),
            grid: VisibilityGrid::new(table),
            allocation: Allocation::new(views.len() * SIZES * VISIBILITIES),
            view_of_facing: axes.clone().map(|axis| views.cell(axis) as u8).collect(),
            facing: axes.flat_map(of_axis).map(level).collect(),
            directions: directions.clone(),
            depth_of: table.levels.iter().map(|level| level.depth as u8).collect(),
            triangles_of: table.levels.iter().map(|level| level.triangles.len() as u32).collect(),
            places: Vec::new(),
            looks: Vec::new(),
        }
    }

    /// Finds the froxel, the size and the direction of every member.
    fn look(&mut self, view: &View<'_>) {
        let count = view.flock.members.len();
        self.places.resize(count, NOWHERE);
        self.looks.resize(count, MemberLook::default());
        let (grid, directions) = (&self.grid, &self.directions);
        let focal = view.camera.pixels_at_one();
        let tasks = self.places.par_chunks_mut(TASK).zip(self.looks.par_chunks_mut(TASK));
        tasks.enumerate().for_each(|(task, (places, looks))| {
            let eights = places.chunks_mut(LANES).zip(looks.chunks_mut(LANES));
            for (i, (places, looks)) in eights.enumerate() {
                let first = task * TASK + i * LANES;
                let lanes = view.lanes(first);
                let froxels = grid.froxels(&lanes);
                let facing = facing(view, directions, first, &lanes);
                for lane in 0..places.len() {
                    let size = size_of(focal * focal / lanes.distance_squared[lane]);
                    looks[lane] = MemberLook { size: size as u8, facing: facing[lane] };
                    places[lane] = if lanes.in_frustum[lane] { froxels[lane] } else { NOWHERE };
                }
                if let Some(visible) = view.visible {
                    for (place, _) in places.iter_mut().zip(&visible[first..]).filter(|(_, v)| !**v)
                    {
                        *place = NOWHERE;
                    }
                }
            }
        });
    }

    /// Replaces the froxel of every member by its cell, and counts the members of each cell.
    fn sort_into_cells(&mut self, view: &View<'_>) {
        let Self { grid, allocation, view_of_facing, places, looks, .. } = self;
        let nearest = size_of((view.camera.pixels_at_one() / NEAREST_FACING).powi(2));
        allocation.clear();
        for (member, (place, look)) in places.iter_mut().zip(looks.iter()).enumerate() {
            if *place == NOWHERE {
                *place = NO_CELL;
                continue;
            }
            let size = usize::from(look.size);
            let visibility = grid.visibility(view, member, *place, size);
            let direction = usize::from(view_of_facing[usize::from(look.facing)]);
            let cell = (direction * SIZES + size) * VISIBILITIES + visibility;
            allocation.count(cell);
            *place = cell as u32 | if size >= nearest { NEAR } else { 0 };
        }
    }

    /// Gives every member the level of its cell, or keeps its own if that is within the band.
    /// Returns the number of triangles.
    fn assign(&self, view: &View<'_>, levels: &mut [InstanceLevel], band: Band) -> usize {
        let task = |(task, levels): (usize, &mut [InstanceLevel])| {
            let first = task * TASK;
            let depths = view.table.depth();
            let mut triangles = 0;
            for (i, level) in levels.iter_mut().enumerate() {
                let (place, look) = (self.places[first + i], self.looks[first + i]);
                if place == NO_CELL {
                    *level = InstanceLevel::HIDDEN;
                    continue;
                }
                let of_cell = self.allocation.choice((place & !NEAR) as usize);
                let finest = if band == Band::Full { of_cell.finest } else { of_cell.best };
                let depth = match level.level() {
                    Some(before) if band != Band::None => {
                        self.depth_of[before].clamp(finest, of_cell.coarsest)
                    }
                    _ => of_cell.best,
                };
                let depth = usize::from(depth);
                let drawn = match place & NEAR {
                    0 => self.facing[usize::from(look.facing) * depths + depth],
                    // The whole chain comes first.
                    _ => depth as u16,
                };
                *level = InstanceLevel::drawn(drawn.into());
                triangles += self.triangles_of[usize::from(drawn)] as usize;
            }
            triangles
        };
        levels.par_chunks_mut(TASK).enumerate().map(task).sum()
    }
}

/// Levels that a member may keep.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Band {
    /// Levels finer and coarser than the cell's.
    Full,
    /// Only coarser ones.
    Coarser,
    /// Only the level of its cell.
    None,
}

impl Policy for PictureGain {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        self.grid.start(view);
        self.look(view);
        self.grid.splat(view, &self.places, |member| usize::from(self.looks[member].size));
        self.sort_into_cells(view);
        let budget = view.budget.triangles;
        let mut target = budget;
        for attempt in 0..ATTEMPTS {
            self.allocation.share_out(&self.gains, target);
            // The last attempts give up finer levels that members would keep.
            let band = if attempt < ATTEMPTS / 2 { Band::Full } else { Band::Coarser };
            let spent = self.assign(view, levels, band);
            if spent <= budget {
                return;
            }
            // Cells ignore the levels that members keep, and the cost of each direction.
            target = (target as f64 * 0.99 * budget as f64 / spent as f64) as usize;
        }
        self.allocation.share_out(&self.gains, 0);
        self.assign(view, levels, Band::None);
    }
}

/// Returns the direction of the facing chains in which each of eight members sees the eye.
#[inline(always)]
fn facing(
    view: &View<'_>,
    directions: &DirectionGrid,
    first: usize,
    lanes: &Lanes,
) -> [u16; LANES] {
    let heading = &view.flock.members.heading;
    let [hx, hy, hz] = heading;
    let (hx, hy, hz) = (load(hx, first), load(hy, first), load(hz, first));
    let [x, y, z] = &lanes.offset;
    let (mut left, mut up, mut ahead) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        // Left is (hz, 0, -hx) made unit, up is heading × left; the eye is at minus the offset.
        // A vertical heading has its left along +x, as in `frame_of`.
        let flat = (hz[i] * hz[i] + hx[i] * hx[i]).sqrt();
        let scale = flat.max(1e-6).recip();
        let lx = if flat > 1e-6 { hz[i] * scale } else { 1.0 };
        let lz = if flat > 1e-6 { -hx[i] * scale } else { 0.0 };
        let (ux, uy, uz) = (hy[i] * lz, hz[i] * lx - hx[i] * lz, -hy[i] * lx);
        left[i] = -(x[i] * lx + z[i] * lz);
        up[i] = -(x[i] * ux + y[i] * uy + z[i] * uz);
        ahead[i] = -(x[i] * hx[i] + y[i] * hy[i] + z[i] * hz[i]);
    }
    let mut cells = [0; LANES];
    directions.cells([&left, &up, &ahead], &mut cells);
    cells
}
