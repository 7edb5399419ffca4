//! The closest point of the finest surface, found by queries around a point.

use glam::DVec3;
use meshlod_mesh::Bounds;

use crate::level::Level;
use crate::query::{Focus, Query, QueryError};

/// Radius of the first query, as a fraction of the diagonal. It grows fourfold each time.
const FIRST: f64 = 1e-4;
const GROWTH: f64 = 4.0;

/// Returns the point of the finest surface that is closest to a point in model units; `None` if the
/// surface is empty.
///
/// `extract` answers queries, and `bounds` holds the surface. Queries ask for a ball of growing
/// radius without error, until a triangle is within: no other is closer than the closest of these.
///
/// Cost: that of a query for a ball of up to four times the distance beyond that of the bounds.
pub(crate) fn closest_point<E: From<QueryError>>(
    point: [f64; 3],
    bounds: &Bounds,
    mut extract: impl FnMut(&Query<'_>) -> Result<Level, E>,
) -> Result<Option<[f64; 3]>, E> {
    Focus::Point(point).validate()?;
    let at = DVec3::from(point);
    let [min, max] = [bounds.min, bounds.max].map(DVec3::from);
    if bounds.is_empty() {
        return Ok(None);
    }
    let away = at.distance(at.clamp(min, max));
    let (diagonal, farthest) = (bounds.diagonal(), at.distance(min).max(at.distance(max)));
    let mut reach = if diagonal > 0.0 { FIRST * diagonal } else { 1.0 };
    loop {
        // Positions are rounded, so the surface may be a little outside of the bounds.
        let radius = away * (1.0 + 1e-9) + reach;
        if !radius.is_finite() {
            return Ok(None);
        }
        let focus = Focus::Sphere { center: point, radius };
        let query = Query { focus, ..Query::finest() };
        let near = extract(&query)?.within(&query.focus)?;
        if let Some(closest) = near.closest_point(point) {
            return Ok(Some(closest));
        }
        if radius > 2.0 * (farthest + diagonal) {
            return Ok(None);
        }
        reach *= GROWTH;
    }
}
