//! Progressive meshes [Hop96]: the energy is the squared distance of surface samples.
//!
//! The cost of an edge is the increase of the squared distances of the samples around it when it is
//! contracted, with its vertex at the best position, plus a small spring energy of the new edges.
//! The position is found as in the paper: project the samples, move the vertex to fit them, repeat.
//!
//! Our choices: a sample pulls along its face's normal instead of straight towards itself, which
//! converges in two rounds instead of many. Only the best of the three starts is followed. Springs
//! enter the energy but exert no pull.

use std::cell::RefCell;

use glam::DVec3;

use crate::engine::Algorithm;
use crate::engine::candidates::EdgeCandidates;
use crate::engine::policy::{Placement, Priority};
use crate::engine::prepared_surface::PreparedSurface;
use crate::methods::fan::{Fan, Nearest};
use crate::methods::quadric::Symmetric;
use crate::methods::samples::Samples;
use crate::refusal::Refusal;
use crate::run::Run;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// Weight of the squared lengths of the edges around the new vertex against squared distances.
/// bunny, mean error in % of the diagonal at 10 % and 1 %, and flips refused: 1e-3 .0157 .096 100,
/// 1e-4 .0145 .089 800, 1e-5 .0144 .087 3000. It keeps flat regions in order.
const SPRING: f64 = 1e-5;

/// Number of times the vertex is moved to fit the samples. bunny at 1 %: 3 rounds .0901, 2 .0889.
const ROUNDS: usize = 2;

/// Strength of the pull to the current position against the samples. With less, the vertex drifts
/// along the surface, where samples exert no pull: bunny at 10 % has a maximum of .88 % with 1e-3,
/// .34 with 1e-2, .29 with 1e-1, and a mean of .0148, .0150, .0157.
const HOLD: f64 = 1e-2;

/// Starts the method.
pub(super) fn start(ready: PreparedSurface) -> Box<dyn Run> {
    Algorithm {
        candidates: EdgeCandidates,
        memory: Samples::new(&ready.surface, &ready.connectivity),
        priority: Energy,
        placement: Energy,
    }
    .start(ready)
}

/// Energy of surface samples [Hop96], as priority and as placement.
struct Energy;

impl Priority<Samples> for Energy {
    fn cost(
        &self,
        surface: &Surface,
        samples: &Samples,
        of: &Contracted,
        _: Freedom,
    ) -> Option<f64> {
        SCRATCH.with_borrow_mut(|PmScratch { neighbourhood, fit }| {
            neighbourhood.gather(surface, *of).ok()?;
            Some(fit.solve(surface, samples, neighbourhood)?.cost)
        })
    }
}

impl Placement<Samples> for Energy {
    fn place(
        &self,
        surface: &Surface,
        samples: &Samples,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        let best =
            SCRATCH.with_borrow_mut(|scratch| scratch.fit.solve(surface, samples, neighbourhood));
        let best = best.ok_or(Refusal::LastFaces)?;
        // Samples measure the total distance moved; the part that the engine adds is subtracted.
        let before = surface.moved(neighbourhood.contracted()).powi(2);
        let error_estimate = (best.worst - before).max(0.0).sqrt();
        Ok(Placed { position: best.position, kept: best.kept, error_estimate })
    }
}

thread_local! {
    static SCRATCH: RefCell<PmScratch> = RefCell::default();
}

/// Scratch space of a thread.
#[derive(Default)]
struct PmScratch {
    neighbourhood: Neighbourhood,
    fit: SampleFit,
}

/// Fit of one contraction to its samples, relative to the first contracted vertex.
#[derive(Default)]
struct SampleFit {
    fan: Fan,
    points: Vec<Point>,
}

/// Sample position.
struct Point {
    place: DVec3,
    on_rim: bool,
}

/// Best position found for the new vertex.
struct FittedPlace {
    position: DVec3,
    kept: usize,
    cost: f64,
    /// Greatest squared distance of a sample there.
    worst: f64,
}

/// Energy and pull of the samples at a position.
#[derive(Clone, Copy)]
struct Evaluation {
    place: DVec3,
    /// Sum of squared distances, plus the springs.
    energy: f64,
    /// Greatest squared distance.
    worst: f64,
    /// Position that fits the samples better.
    better: DVec3,
}

impl SampleFit {
    /// Returns the best position for the new vertex; `None` if no face is left for the samples.
    fn solve(
        &mut self,
        surface: &Surface,
        samples: &Samples,
        neighbourhood: &Neighbourhood,
    ) -> Option<FittedPlace> {
        if neighbourhood.spokes().is_empty() {
            return None;
        }
        let [v0, v1] = [0, 1].map(|i| surface.position(neighbourhood.contracted()[i]));
        samples.fan(surface, neighbourhood, v0, &mut self.fan);
        self.points.clear();
        let mut before = 0.0;
        samples.moving(neighbourhood, |sample| {
            before += sample.squared;
            self.points.push(Point { place: sample.point - v0, on_rim: sample.on_rim() });
        });
        let (ends, kept) = ([DVec3::ZERO, v1 - v0], neighbourhood.freedom().kept());
        let view = match kept {
            Some(kept) => self.evaluate(ends[kept]),
            None => self.descend([ends[0], ends[1], ends[1] * 0.5]),
        };
        // An end keeps its position exactly.
        let position = match ends.iter().position(|&end| end == view.place) {
            Some(end) => [v0, v1][end],
            None => v0 + view.place,
        };
        Some(FittedPlace {
            position,
            kept: kept.unwrap_or(0),
            cost: (view.energy - before).max(0.0),
            worst: view.worst,
        })
    }

    /// Returns the best of these positions, moved on as long as that lowers the energy.
    fn descend(&mut self, starts: [DVec3; 3]) -> Evaluation {
        let [first, second, third] = starts.map(|start| self.evaluate(start));
        let mut best = first;
        for other in [second, third] {
            if other.energy < best.energy {
                best = other;
            }
        }
        for _ in 0..ROUNDS {
            let next = self.evaluate(best.better);
            if next.energy < best.energy {
                best = next;
            } else {
                break;
            }
        }
        best
    }

    /// Projects all samples onto the faces around `place`, and evaluates them.
    fn evaluate(&mut self, place: DVec3) -> Evaluation {
        self.fan.place(place);
        let (mut energy, mut worst) = (SPRING * self.fan.squared_lengths(), 0.0f64);
        let (mut squares, mut pull, mut weights) = (Symmetric::default(), DVec3::ZERO, 0.0);
        for point in &self.points {
            let Nearest { off, squared, weight, spoke, rim } =
                self.fan.nearest(point.place, point.on_rim);
            energy += squared;
            worst = worst.max(squared);
            weights += weight * weight;
            if rim.is_some() {
                squares = squares + Symmetric::scalar(weight * weight);
                pull += off * weight;
            } else {
                let normal = self.fan.normal(spoke);
                squares = squares + Symmetric::outer(normal * weight);
                pull += normal * (normal.dot(off) * weight);
            }
        }
        let step = (squares + Symmetric::scalar(HOLD * weights)).solve(pull);
        let better = if step.is_finite() { place + step } else { place };
        Evaluation { place, energy, worst, better }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Connectivity, FaceId, Mesh};
    use meshlod_samples as samples;
    use meshlod_spatial::closest_point;

    use super::*;
    use crate::engine::policy::Memory;

    fn start(mesh: &Mesh) -> (Surface, Samples) {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let surface = Surface::new(mesh, &connectivity);
        let samples = Samples::new(&surface, &connectivity);
        (surface, samples)
    }

    /// Sums the energy by brute force: every sample of the faces around against every new face.
    fn by_brute_force(samples: &Samples, neighbourhood: &Neighbourhood, position: DVec3) -> f64 {
        let ring = |place: u32| neighbourhood.ring()[place as usize].position;
        let mut sum = 0.0;
        samples.moving(neighbourhood, |sample| {
            let squared = |spoke: &crate::Spoke| {
                let triangle = [position, ring(spoke.a), ring(spoke.b)];
                sample.point.distance_squared(closest_point(sample.point, &triangle))
            };
            sum += neighbourhood.spokes().iter().map(squared).fold(f64::INFINITY, f64::min);
        });
        sum
    }

    #[test]
    fn the_energy_is_that_of_brute_force() {
        let mesh = samples::knot(600);
        let (mut surface, mut samples) = start(&mesh);
        let (mut neighbourhood, mut fit, mut contracted) =
            (Neighbourhood::default(), SampleFit::default(), 0);
        for face in (0..mesh.faces.len()).step_by(3).map(FaceId::new) {
            let [v0, v1, _] = surface.face(face);
            if !surface.is_alive(face)
                || neighbourhood.gather(&surface, Contracted::edge([v0, v1])).is_err()
            {
                continue;
            }
            let best = fit.solve(&surface, &samples, &neighbourhood).unwrap();
            let view = fit.evaluate(best.position - surface.position(v0));
            let distances = view.energy - SPRING * fit.fan.squared_lengths();
            let expected = by_brute_force(&samples, &neighbourhood, best.position);
            assert!((distances - expected).abs() <= 1e-9 * expected + 1e-20, "{face}");
            for end in [v0, v1] {
                let at_end = fit.evaluate(surface.position(end) - surface.position(v0));
                assert!(view.energy <= at_end.energy * (1.0 + 1e-12), "{face}");
            }
            let placed = Placed { position: best.position, kept: 0, error_estimate: 0.0 };
            samples.merge(&surface, &neighbourhood, &placed);
            surface.contract(&neighbourhood, &placed);
            contracted += 1;
        }
        assert!(contracted > 100, "{contracted}");
    }
}
