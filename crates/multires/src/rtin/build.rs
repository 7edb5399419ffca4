//! Computes errors and radii from the finest vertices up, each passing its own on to its
//! dependencies.

use super::field::{GridPlacement, HeightField};
use super::grid::{Extent, Grid, GridPoint, RightTriangle};
use super::{GridVertex, Rtin};
use crate::length16::Length16;
use crate::query::SLACK;
use glam::DVec3;
use meshlod_mesh::Frame;

impl Rtin {
    /// Builds all levels of a height field, measuring each triangle of each level against all
    /// vertices under it.
    ///
    /// Cost: O(n log n).
    pub fn new(field: &HeightField) -> Self {
        let mut this = Self::without_errors(field);
        for depth in (0..this.grid.depth()).rev() {
            for place in this.grid.inserted_at(depth) {
                this.finish(place);
            }
        }
        this
    }

    fn without_errors(field: &HeightField) -> Self {
        let frame = Frame::of_diagonal(&field.bounds());
        let GridPlacement { step, up, .. } = field.placement;
        let [across, along, up] = GridPlacement::axes(up);
        let first = frame.local(field.placement.point(GridPoint::default(), 0.0));
        let placement = GridPlacement {
            origin: [first[across], first[along]],
            step: step.map(|length| frame.local_length(length)),
            ..field.placement
        };
        let stored = |&height: &f64| {
            let height =
                frame.local(field.placement.point(GridPoint::default(), height))[up] as f32;
            GridVertex { height, ..GridVertex::default() }
        };
        let mut vertices: Vec<_> = field.heights.iter().map(stored).collect();
        let lost = field.heights.iter().zip(&vertices).map(|(height, vertex)| {
            let mut point = DVec3::ZERO;
            point[up] = vertex.height.into();
            (frame.model(point)[up] - height).abs()
        });
        let mut fit = field.fit;
        fit.rounded += lost.fold(0.0, f64::max);
        // The corners of the square are never inserted.
        for corner in field.grid.roots().iter().flat_map(RightTriangle::corners) {
            if field.grid.holds(corner) {
                vertices[field.grid.index(corner)].error = Length16::INFINITE;
            }
        }
        let radii = vec![Length16(0); vertices.len()];
        Self { frame, grid: field.grid, placement, vertices, radii, fit }
    }

    /// Completes a vertex once all vertices that depend on it are done, and passes its requirements
    /// on.
    fn finish(&mut self, place: GridPoint) {
        let index = self.grid.index(place);
        let asked = self.vertices[index];
        let own = self.own_error(place);
        let error = own.max(asked.error);
        self.radii[index] = self.own_radius(place);
        let radius = asked.radius.max(self.radii[index]);
        self.vertices[index] = GridVertex { error, radius, ..asked };
        let ball = self.nested_ball(place);
        for parent in self.grid.parents(place) {
            let center = self.nested_ball(parent).center;
            let around = (center.distance(ball.center) + ball.radius) * SLACK;
            let vertex = &mut self.vertices[self.grid.index(parent)];
            vertex.error = vertex.error.max(error);
            vertex.radius = vertex.radius.max(Length16::up(around));
        }
    }

    /// Returns the radius of the ball around the triangles that an insertion removes.
    pub(super) fn own_radius(&self, place: GridPoint) -> Length16 {
        let center = self.nested_ball(place).center;
        let around = self.grid.diamond(place).into_iter().flat_map(|d| d.corners());
        let there = around.filter(|&corner| self.grid.holds(corner));
        let squared = there.map(|p| center.distance_squared(self.nested_ball(p).center));
        Length16::up(squared.fold(0.0, f64::max).sqrt() * SLACK)
    }

    /// Returns the error of the triangles that an insertion removes, or infinity if one lies across
    /// the border.
    pub(super) fn own_error(&self, place: GridPoint) -> Length16 {
        let Some(diamond) = self.grid.diamond(place) else { return Length16(0) };
        let mut most = 0.0;
        for triangle in diamond.coarse() {
            match self.grid.extent(&triangle) {
                Extent::Outside => {}
                Extent::Across => return Length16::INFINITE,
                Extent::Inside => most = self.deviation(&triangle).max(most),
            }
        }
        Length16::up(most)
    }

    /// Returns the greatest vertical distance between a triangle and the vertices under it.
    fn deviation(&self, triangle: &RightTriangle) -> f64 {
        let Self { grid, vertices, .. } = self;
        let plane = Plane::of(grid, vertices, triangle);
        let rows = triangle.corners().map(|p| p.row);
        let [low, high] =
            [rows.into_iter().min(), rows.into_iter().max()].map(Option::unwrap_or_default);
        let mut most = 0f64;
        for row in low..=high {
            let [first, last] = triangle.columns(row);
            let start = GridPoint { column: first, row };
            let mut expected = plane.at(start);
            let index = grid.index(start);
            for vertex in &vertices[index..=index + (last - first) as usize] {
                most = most.max((f64::from(vertex.height) - expected).abs());
                expected += plane.across;
            }
        }
        most
    }
}

/// The plane of a triangle as a height function.
struct Plane {
    from: GridPoint,
    height: f64,
    /// Slope per column.
    across: f64,
    /// Slope per row.
    along: f64,
}

impl Plane {
    fn of(grid: &Grid, vertices: &[GridVertex], triangle: &RightTriangle) -> Self {
        let height = |p: GridPoint| f64::from(vertices[grid.index(p)].height);
        let from = triangle.apex;
        let base = height(from);
        let [[ax, ay, az], [bx, by, bz]] = triangle.ends.map(|end| {
            let along = |to: u32, from: u32| f64::from(to) - f64::from(from);
            [along(end.column, from.column), along(end.row, from.row), height(end) - base]
        });
        let area = ax * by - ay * bx;
        Self {
            from,
            height: base,
            across: (az * by - bz * ay) / area,
            along: (bz * ax - az * bx) / area,
        }
    }

    fn at(&self, place: GridPoint) -> f64 {
        let steps = |to: u32, from: u32| f64::from(to) - f64::from(from);
        self.height
            + steps(place.column, self.from.column) * self.across
            + steps(place.row, self.from.row) * self.along
    }
}
