//! Distances of components from the rest of the surface, measured as far as they matter.

use std::ops::Range;

use glam::Vec3;
use meshlod_spatial::{NearestPart, PartBvh, PartSearch, Within};

/// Largest number of faces of a component that are all sampled.
const ALL_SAMPLED: usize = 24;

/// Number of faces that are sampled of a component that has more.
const SAMPLED_FACES: usize = 12;

/// Weights of a face's centre and of each of its corners in the mean square distance. For a
/// quadratic function they give the exact mean.
const AT_CENTRE: f32 = 0.75;
const AT_CORNER: f32 = 1.0 / 12.0;

/// Component nearest to a point that has not been measured.
const UNKNOWN: u32 = u32::MAX;

/// Square distances of a component from what remains without it, in the frame's units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    pub(crate) mean: f32,
    pub(crate) greatest: f32,
}

/// Sample points on components, and how far they are from the rest.
///
/// Distances only grow, as components vanish, and that of a point changes only when the component
/// nearest to it has vanished. So what was measured is a lower bound, and few points are measured
/// again.
#[derive(Default)]
pub(crate) struct ComponentSamples {
    /// Points of all components, one component after the other.
    points: Vec<ComponentSample>,
    /// End of the points of each component.
    ends: Vec<usize>,
    search: PartSearch,
}

/// A point on the surface of a component.
#[derive(Clone, Copy, Debug)]
struct ComponentSample {
    place: Vec3,
    weight: f32,
    /// Square of its distance when last measured; zero before.
    squared: f32,
    /// Component that was nearest then, or [`UNKNOWN`].
    nearest: u32,
}

impl ComponentSamples {
    /// Samples the next component at the centres and corners of some of its faces. `slots` is
    /// memory for each vertex, at first [`u32::MAX`].
    pub(crate) fn add(
        &mut self,
        faces: &[[u32; 3]],
        place: impl Fn(u32) -> Vec3,
        slots: &mut [u32],
    ) {
        let step = if faces.len() > ALL_SAMPLED { faces.len().div_ceil(SAMPLED_FACES) } else { 1 };
        let some = faces.iter().step_by(step);
        // `map` over an array is not inlined.
        let corners = |&[a, b, c]: &[u32; 3]| [place(a), place(b), place(c)];
        let mut add = |place: Vec3, weight: f32| {
            self.points.push(ComponentSample { place, weight, squared: 0.0, nearest: UNKNOWN });
        };
        for face in some.clone() {
            let corners @ [a, b, c] = corners(face);
            add((a + b + c) / 3.0, AT_CENTRE * area(corners));
        }
        for face in some {
            let weight = AT_CORNER * area(corners(face));
            for &v in face {
                let slot = &mut slots[v as usize];
                match self.points.get_mut(*slot as usize) {
                    Some(known) => known.weight += weight,
                    None => {
                        *slot = self.points.len() as u32;
                        let (squared, nearest) = (0.0, UNKNOWN);
                        self.points.push(ComponentSample {
                            place: place(v),
                            weight,
                            squared,
                            nearest,
                        });
                    }
                }
            }
        }
        self.ends.push(self.points.len());
    }

    /// Measures how far a component is from the rest of `surface`, without its other coat. Stops,
    /// and returns a lower bound of the mean square distance, once that is beyond what matters.
    pub(crate) fn measure(
        &mut self,
        [component, coat]: [u32; 2],
        surface: &PartBvh,
        is_beyond: impl Fn(f32) -> bool,
    ) -> Result<Apart, f32> {
        let own = self.of(component);
        let points = &mut self.points[own];
        let weights = points.iter().map(|point| point.weight).sum::<f32>().max(f32::MIN_POSITIVE);
        let mean = |points: &[ComponentSample]| {
            points.iter().map(|point| point.weight * point.squared).sum::<f32>() / weights
        };
        let mut least = mean(points);
        // A point measured before, which has a part near it.
        let mut known: Option<ComponentSample> = None;
        for i in 0..points.len() {
            let ComponentSample { place, weight, squared, nearest } = points[i];
            if nearest != UNKNOWN && surface.is_left(nearest) {
                known = Some(points[i]);
                continue;
            }
            if is_beyond(least) {
                return Err(least);
            }
            let most = known.map_or(f32::INFINITY, |known| known.most_at(place));
            let mut found = surface.nearest(
                place,
                [component, coat],
                Within { enough: squared, most },
                &mut self.search,
            );
            if found.part == UNKNOWN && most < f32::INFINITY {
                found = surface.nearest(place, [component, coat], Within::ANY, &mut self.search);
            }
            let NearestPart { distance_squared, part } = found;
            // What the tree calls touching may be nearer than before.
            let farther = distance_squared.max(squared);
            (points[i].squared, points[i].nearest) = (farther, part);
            known = Some(points[i]).filter(|point| point.nearest != UNKNOWN);
            least += weight * (farther - squared) / weights;
        }
        let greatest = points.iter().map(|point| point.squared).fold(0.0, f32::max);
        Ok(Apart { mean: mean(points), greatest })
    }

    fn of(&self, component: u32) -> Range<usize> {
        let at = component as usize;
        at.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[at]
    }
}

impl ComponentSample {
    /// Returns the square of the most that a place can be from what is nearest to this point.
    fn most_at(&self, place: Vec3) -> f32 {
        // More than rounding.
        let most = (self.squared.sqrt() + self.place.distance(place)) * 1.0001;
        most * most + f32::MIN_POSITIVE
    }
}

/// Returns the area of a triangle.
pub(crate) fn area([a, b, c]: [Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use meshlod_spatial::PartBvhBuilder;

    use super::*;

    #[test]
    fn only_points_whose_nearest_part_has_vanished_are_measured_again() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let heights = [0.0, 1.0, -2.0, 5.0];
        let places: Vec<Vec3> =
            heights.iter().flat_map(|z| corners.map(|corner| corner + z * Vec3::Z)).collect();
        let (mut builder, mut samples) = (PartBvhBuilder::default(), ComponentSamples::default());
        let mut slots = vec![u32::MAX; places.len()];
        for first in [0, 3, 6, 9] {
            let face = [first, first + 1, first + 2];
            builder.add([face.map(|v| places[v as usize])].into_iter());
            samples.add(&[face], |v| places[v as usize], &mut slots);
        }
        let mut surface = builder.build();
        let mut mean = |surface: &PartBvh, limit: f32| {
            samples
                .measure([0, 0], surface, |mean| mean > limit)
                .map(|apart| (apart.mean, apart.greatest))
        };
        // The first point has three quarters of the weight.
        let first = mean(&surface, 0.5).unwrap_err();
        assert!((first - 0.75).abs() < 1e-6, "{first}");
        let near = |found: Result<(f32, f32), f32>, squared: f32| {
            let (mean, greatest) = found.unwrap();
            assert!((mean - squared).abs() < 1e-5 && (greatest - squared).abs() < 1e-5, "{mean}");
        };
        near(mean(&surface, f32::INFINITY), 1.0);
        surface.remove(3);
        near(mean(&surface, 0.0), 1.0);
        surface.remove(1);
        assert_eq!(mean(&surface, 0.5).map(|_| ()).unwrap_err(), 1.0);
        near(mean(&surface, f32::INFINITY), 4.0);
    }
}
