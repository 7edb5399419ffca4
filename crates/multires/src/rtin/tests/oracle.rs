//! The explicit MT of a field, with all triangles stored and updates found by equal hypotenuses.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::{SIZES, Sample};
use crate::length16::Length16;
use crate::query::{Ball, Criterion};
use crate::rtin::grid::{Extent, GridPoint};
use crate::rtin::{Rtin, RtinExtractor};
use crate::tests::walks::{Dice, query};

/// Corners of a triangle, the right angle first.
type Corners = [GridPoint; 3];

struct Oracle<'m> {
    model: &'m Rtin,
    /// Updates by the vertex that each inserts.
    updates: BTreeMap<GridPoint, Insertion>,
    /// The two halves of each triangle that is bisected.
    halves: BTreeMap<Corners, [Corners; 2]>,
    /// Numbers of finest triangles inside and outside the field.
    extents: BTreeMap<Corners, [usize; 2]>,
}

#[derive(Default)]
struct Insertion {
    depth: u32,
    coarse: Vec<Corners>,
    /// Vertices that created the coarse triangles.
    creators: Vec<Option<GridPoint>>,
}

impl<'m> Oracle<'m> {
    fn new(model: &'m Rtin) -> Self {
        let mut level = model.grid.roots().map(|t| (t.corners(), None)).to_vec();
        let mut this = Self {
            model,
            updates: BTreeMap::new(),
            halves: BTreeMap::new(),
            extents: BTreeMap::new(),
        };
        let mut coarser = Vec::new();
        for depth in 0..model.grid.depth() {
            for (corners, creator) in std::mem::take(&mut level) {
                let [apex, a, b] = corners;
                let at = middle(a, b);
                let update = this.updates.entry(at).or_default();
                update.depth = depth;
                update.coarse.push(corners);
                update.creators.push(creator);
                let halves = [[at, apex, a], [at, b, apex]];
                this.halves.insert(corners, halves);
                coarser.push(corners);
                level.extend(halves.map(|half| (half, Some(at))));
            }
        }
        let [right, top] = model.size().map(|count| 3 * (count - 1));
        for (corners, _) in level {
            let is_inside = corners.iter().map(|p| p.column).sum::<u32>() < right
                && corners.iter().map(|p| p.row).sum::<u32>() < top;
            this.extents.insert(corners, [is_inside.into(), (!is_inside).into()]);
        }
        for corners in coarser.into_iter().rev() {
            let [a, b] = this.halves[&corners].map(|half| this.extents[&half]);
            this.extents.insert(corners, [a[0] + b[0], a[1] + b[1]]);
        }
        this
    }

    fn is_outside(&self, corners: &Corners) -> bool {
        self.extents[corners][0] == 0
    }

    fn is_across(&self, corners: &Corners) -> bool {
        !self.extents[corners].contains(&0)
    }

    /// Returns the dependencies of an update: the vertices that created the triangles it removes,
    /// except those outside the field.
    fn needs(&self, update: &Insertion) -> Vec<GridPoint> {
        let coarse = update.coarse.iter().zip(&update.creators);
        coarse.filter(|(c, _)| !self.is_outside(c)).filter_map(|(_, &creator)| creator).collect()
    }

    /// Returns all updates, each before its dependencies.
    fn finest_first(&self) -> Vec<GridPoint> {
        let mut all: Vec<GridPoint> = self.updates.keys().copied().collect();
        all.sort_by_key(|at| Reverse(self.updates[at].depth));
        all
    }

    /// Returns the required updates with their dependencies and those forced across the border.
    fn close(&self, wanted: impl Fn(GridPoint) -> bool) -> BTreeSet<GridPoint> {
        let forced = |update: &Insertion| update.coarse.iter().any(|c| self.is_across(c));
        let seeds = self.updates.iter().filter(|&(&at, update)| forced(update) || wanted(at));
        let mut stack: Vec<GridPoint> = seeds.map(|(&at, _)| at).collect();
        let mut cut = BTreeSet::new();
        while let Some(at) = stack.pop() {
            if cut.insert(at) {
                stack.extend(self.needs(&self.updates[&at]));
            }
        }
        cut
    }

    /// Returns the triangles of a cut by indices, each from its least corner.
    fn shown(&self, cut: &BTreeSet<GridPoint>) -> Vec<[u32; 3]> {
        let mut shown: BTreeSet<Corners> = self.model.grid.roots().map(|t| t.corners()).into();
        for at in self.finest_first().iter().rev().filter(|at| cut.contains(at)) {
            for corners in self.updates[at].coarse.iter().filter(|c| !self.is_outside(c)) {
                assert!(shown.remove(corners), "what {at:?} takes away is not there");
                shown.extend(self.halves[corners]);
            }
        }
        let inside = shown.into_iter().filter(|c| !self.is_outside(c));
        let mut faces: Vec<[u32; 3]> = inside
            .map(|corners| {
                assert!(!self.is_across(&corners), "{corners:?} is across the border");
                let mut face = corners.map(|p| self.model.grid.index(p) as u32);
                let least = (0..3).min_by_key(|&k| face[k]).unwrap();
                face.rotate_left(least);
                face
            })
            .collect();
        faces.sort_unstable();
        faces
    }

    /// Returns the distance from a triangle to the vertices under it, by barycentric coordinates.
    fn deviation(&self, corners: &Corners) -> f64 {
        let grid = self.model.grid;
        let height = |p: GridPoint| f64::from(self.model.vertices[grid.index(p)].height);
        let turn = |a: GridPoint, b: GridPoint, c: GridPoint| {
            let [[ax, ay], [bx, by]] = [b, c].map(|p| {
                [f64::from(p.column) - f64::from(a.column), f64::from(p.row) - f64::from(a.row)]
            });
            ax * by - ay * bx
        };
        let [a, b, c] = *corners;
        let under = (0..grid.count()).map(|index| grid.place(index)).filter_map(|p| {
            let parts = [turn(p, b, c), turn(a, p, c), turn(a, b, p)];
            let weights = parts.map(|part| part / turn(a, b, c));
            let flat: f64 = weights.iter().zip(corners).map(|(w, &p)| w * height(p)).sum();
            weights.iter().all(|&w| w >= 0.0).then(|| (flat - height(p)).abs())
        });
        under.fold(0.0, f64::max)
    }
}

#[test]
fn grid_arithmetic_matches_bisected_triangles() {
    for size in SIZES {
        let model = Sample::new(size).model();
        let grid = model.grid;
        let oracle = Oracle::new(&model);
        for (&at, update) in &oracle.updates {
            let diamond = grid.diamond(at).unwrap();
            let mut coarse: Vec<Corners> = diamond.coarse().map(|t| t.corners()).collect();
            let mut expected = update.coarse.clone();
            coarse.sort_unstable();
            expected.sort_unstable();
            assert_eq!(coarse, expected, "around {at:?} of {size:?}");
            for triangle in diamond.coarse() {
                assert!(triangle.turn() > 0);
                let extent = match oracle.extents[&triangle.corners()] {
                    [0, _] => Extent::Outside,
                    [_, 0] => Extent::Inside,
                    _ => Extent::Across,
                };
                assert_eq!(grid.extent(&triangle), extent, "{triangle:?} of {size:?}");
            }
            if grid.holds(at) {
                assert_eq!(grid.depth_of(at), update.depth);
                let mut parents: Vec<GridPoint> = grid.parents(at).collect();
                let mut needs = oracle.needs(update);
                // The corners of the square are never created.
                parents.retain(|parent| grid.diamond(*parent).is_some());
                needs.retain(|&need| grid.holds(need));
                parents.sort_unstable();
                needs.sort_unstable();
                assert_eq!(parents, needs, "what {at:?} of {size:?} needs");
            }
        }
        for depth in 0..grid.depth() {
            let inserted: Vec<GridPoint> = grid.inserted_at(depth).collect();
            let at_depth = oracle.updates.iter().filter(|(_, update)| update.depth == depth);
            let mut expected: Vec<GridPoint> = at_depth.map(|(&at, _)| at).collect();
            expected.retain(|&at| grid.holds(at));
            expected.sort_by_key(|at| (at.row, at.column));
            assert_eq!(inserted, expected);
        }
    }
}

#[test]
fn errors_are_the_greatest_distances_below() {
    for size in SIZES {
        let model = Sample::new(size).model();
        let oracle = Oracle::new(&model);
        let forced = oracle.close(|_| false);
        let mut errors: BTreeMap<GridPoint, f64> = BTreeMap::new();
        for at in oracle.finest_first() {
            let update = &oracle.updates[&at];
            let coarse = || update.coarse.iter().filter(|c| !oracle.is_outside(c));
            let inside = coarse().filter(|c| !oracle.is_across(c));
            let own = inside.map(|c| oracle.deviation(c)).fold(0.0, f64::max);
            let error = errors.get(&at).copied().unwrap_or(0.0).max(own);
            errors.insert(at, error);
            for need in oracle.needs(update) {
                let above = errors.entry(need).or_default();
                *above = above.max(error);
            }
            if !model.grid.holds(at) {
                continue;
            }
            let found = model.vertices[model.grid.index(at)].error;
            let expected =
                if forced.contains(&at) { Length16::INFINITE } else { Length16::up(error) };
            assert_eq!(found, expected, "{at:?} of {size:?}");
            let ball = model.own_ball(at);
            let corners = coarse().flatten().filter(|&&p| model.grid.holds(p));
            let mut reach = corners.map(|&p| ball.center.distance(model.nested_ball(p).center));
            assert!(reach.all(|reach| reach <= ball.radius), "{at:?} of {size:?}");
        }
    }
}

#[test]
fn levels_are_cuts_of_the_explicit_mt() {
    let mut steps = 0;
    for size in SIZES {
        let sample = Sample::new(size);
        let (mesh, model) = (sample.mesh(), sample.model());
        let oracle = Oracle::new(&model);
        let mut extractor = RtinExtractor::new(&model);
        let mut dice = Dice(u64::from(size[0] * 100 + size[1]));
        for _ in 0..150 {
            let query = query(&mut dice, &mesh);
            let criterion = Criterion::new(&query, model.frame()).unwrap();
            let requires = |at: GridPoint, ball: &dyn Fn(GridPoint) -> Ball| {
                model.grid.holds(at) && criterion.requires(&ball(at))
            };
            let smallest = oracle.close(|at| requires(at, &|at| model.own_ball(at)));
            let found = extractor.exact(&query).unwrap().canonical();
            assert_eq!(found, oracle.shown(&smallest), "{size:?}, {query:?}");
            let nested = oracle.close(|at| requires(at, &|at| model.nested_ball(at)));
            let more = extractor.saturated(&query).unwrap().canonical();
            assert_eq!(more, oracle.shown(&nested), "{size:?}, {query:?}");
            assert!(smallest.is_subset(&nested) && found.len() <= more.len());
            steps += 1;
        }
    }
    assert!(steps >= 1000);
}

fn middle(a: GridPoint, b: GridPoint) -> GridPoint {
    GridPoint { column: a.column.midpoint(b.column), row: a.row.midpoint(b.row) }
}
