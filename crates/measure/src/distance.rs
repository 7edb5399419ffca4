//! Two-sided distance between the surfaces of two meshes, measured by sampling.

use meshlod_mesh::{FaceId, Mesh};
use meshlod_spatial::ClosestPoint;
use rayon::prelude::*;
use thiserror::Error;

use crate::prepared::{PreparedSurface, SurfaceError};
use crate::sample::samples;

/// Options for measuring the distance between two meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct DistanceOptions {
    /// Number of sample points on each surface, spread evenly by area.
    ///
    /// Half a million give the mean distance to within about 0.1 %.
    pub samples: usize,
    /// Seed of the random numbers that place the sample points.
    pub seed: u64,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { samples: 500_000, seed: 0 }
    }
}

/// Distance measured between two surfaces A and B, in both directions, in model units.
///
/// Mean and RMS are taken over the samples. The maximum is a lower bound of the true one, and exact
/// if that is attained at a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Distance {
    /// Distance from points on A to the surface B.
    pub forward: OneSidedDistance,
    /// Distance from points on B to the surface A.
    pub backward: OneSidedDistance,
    /// Length of the diagonal of A's bounding box, in model units.
    pub diagonal: f64,
}

/// Distance measured from points on one surface to another surface, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct OneSidedDistance {
    /// Mean distance of the sample points from the other surface, in model units.
    pub mean: f64,
    /// Root mean square distance of the sample points from the other surface, in model units.
    pub rms: f64,
    /// Maximum distance of the sample points and of the vertices used by faces, in model units.
    pub max: f64,
    /// Location of the maximum distance, on both surfaces.
    pub place: Place,
}

/// Point on one surface and the closest point on the other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Place {
    /// Point on the surface that is measured from.
    pub from: [f64; 3],
    /// Closest point on the other surface.
    pub to: [f64; 3],
    /// Face of the other surface on which the closest point lies.
    pub face: FaceId,
}

/// Reason why the distance between two meshes cannot be measured.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeasureError {
    /// The first of the two meshes cannot be measured.
    #[error("the first mesh: {0}")]
    First(SurfaceError),
    /// The second of the two meshes cannot be measured.
    #[error("the second mesh: {0}")]
    Second(SurfaceError),
    /// The requested number of sample points is 0.
    #[error("the number of samples must be at least 1, not 0")]
    NoSamples,
}

impl Distance {
    /// Returns the mean distance: the average of both directions.
    pub fn mean(&self) -> f64 {
        (self.forward.mean + self.backward.mean) * 0.5
    }

    /// Returns the root mean square distance, combined from both directions.
    pub fn rms(&self) -> f64 {
        ((self.forward.rms.powi(2) + self.backward.rms.powi(2)) * 0.5).sqrt()
    }

    /// Returns the maximum distance in either direction, a lower bound of the Hausdorff distance.
    pub fn max(&self) -> f64 {
        self.forward.max.max(self.backward.max)
    }

    /// Converts a length in model units to a percentage of the diagonal of A's bounding box.
    pub fn percent(&self, length: f64) -> f64 {
        100.0 * length / self.diagonal
    }
}

/// Measures the distance between the surfaces of two meshes, in both directions.
///
/// Each sample and each used vertex is compared with the exact closest point of the other mesh. The
/// result is the same to the bit for any number of threads.
///
/// Cost: O((samples + vertices + faces) log faces); in parallel.
///
/// # Errors
/// A mesh that is invalid or has zero area; no samples.
///
/// # References
/// [CRS98]; differs: samples in strata of equal area, not by face or by grid.
pub fn distance(a: &Mesh, b: &Mesh, options: &DistanceOptions) -> Result<Distance, MeasureError> {
    let a = PreparedSurface::new(a).map_err(MeasureError::First)?;
    let b = PreparedSurface::new(b).map_err(MeasureError::Second)?;
    surface_distance(&a, &b, options)
}

/// Measures the [`distance`] between two prepared surfaces, which saves time if a surface is
/// measured more than once.
///
/// # Errors
/// No samples.
pub fn surface_distance(
    a: &PreparedSurface<'_>,
    b: &PreparedSurface<'_>,
    options: &DistanceOptions,
) -> Result<Distance, MeasureError> {
    if options.samples == 0 {
        return Err(MeasureError::NoSamples);
    }
    let (forward, backward) = (one_way(a, b, options), one_way(b, a, options));
    Ok(Distance { forward, backward, diagonal: a.diagonal })
}

/// Computes the distance from each vertex of `a`, used or not, to the surface `b`, in model units.
///
/// Returns one value per position; NaN for a position that is not finite. Cost: O(n log f), n =
/// vertices of `a`, f = faces of `b`; in parallel.
pub fn vertex_errors(a: &Mesh, b: &PreparedSurface<'_>) -> Vec<f64> {
    let chunks = a.positions.par_chunks(CHUNK);
    chunks
        .flat_map_iter(|chunk| {
            closest_to_each(chunk.iter().copied(), b).map(|(_, closest)| length(&closest))
        })
        .collect()
}

/// Points that a task processes in sequence, each answer being the hint for the next. Fixed, since
/// the rounding of the sums depends on it.
const CHUNK: usize = 2048;

fn one_way(
    from: &PreparedSurface<'_>,
    to: &PreparedSurface<'_>,
    options: &DistanceOptions,
) -> OneSidedDistance {
    let count = options.samples;
    let samples = (0..count.div_ceil(CHUNK)).into_par_iter().map(|i| {
        let range = i * CHUNK..((i + 1) * CHUNK).min(count);
        ChunkSums::of(closest_to_each(samples(from, count, options.seed, range), to))
    });
    let samples: Vec<ChunkSums> = samples.collect();
    let known = samples.iter().map(|chunk| chunk.worst.0).fold(0.0, f64::max);
    let vertices = from.vertices.par_chunks(CHUNK).map(|chunk| {
        let points = chunk.iter().map(|v| from.mesh.positions[v.index()]);
        farthest(points, to, known)
    });
    let vertices: Vec<(f64, Place)> = vertices.collect();
    // Vertices first: at equal distance, the vertex wins over a sample.
    let worst = vertices.into_iter().chain(samples.iter().map(|chunk| chunk.worst)).reduce(farther);
    let (max, place) = worst.expect("there are samples");
    let mean = samples.iter().map(|chunk| chunk.sum).sum::<f64>() / count as f64;
    let square = samples.iter().map(|chunk| chunk.sum_of_squares).sum::<f64>() / count as f64;
    OneSidedDistance { mean, rms: square.sqrt(), max, place }
}

/// Part of a distance by which another must be less not to count, whatever rounding does to both.
const CLEARLY_LESS: f64 = 1.0 - 1e-9;

/// Returns the greatest distance of the points and its place, or less if that is less than `known`,
/// which another point has.
///
/// Of all other points only that they are nearer is found out, so a search mostly ends at the first
/// face.
fn farthest(
    points: impl Iterator<Item = [f64; 3]>,
    to: &PreparedSurface<'_>,
    known: f64,
) -> (f64, Place) {
    let mut worst: (f64, Place) = (-1.0, NOWHERE);
    let mut hint = None;
    for from in points {
        let enough = worst.0.max(known) * CLEARLY_LESS;
        let near = (enough > 0.0).then(|| to.bvh.near(from, hint, [enough, f64::INFINITY]));
        let closest = near.flatten().unwrap_or_else(|| to.bvh.closest(from, hint));
        hint = Some(closest.face);
        let place = Place { from, to: closest.point, face: closest.face };
        worst = farther(worst, (length(&closest), place));
    }
    worst
}

fn closest_to_each(
    points: impl Iterator<Item = [f64; 3]>,
    to: &PreparedSurface<'_>,
) -> impl Iterator<Item = ([f64; 3], ClosestPoint)> {
    let mut hint = None;
    points.map(move |point| {
        let closest = to.bvh.closest(point, hint);
        hint = Some(closest.face);
        (point, closest)
    })
}

fn length(closest: &ClosestPoint) -> f64 {
    closest.distance_squared.sqrt()
}

/// Place of no point at all.
const NOWHERE: Place = Place { from: [f64::NAN; 3], to: [f64::NAN; 3], face: FaceId(0) };

/// Partial sums and maximum over a chunk of points.
struct ChunkSums {
    sum: f64,
    sum_of_squares: f64,
    worst: (f64, Place),
}

impl ChunkSums {
    fn of(closest: impl Iterator<Item = ([f64; 3], ClosestPoint)>) -> Self {
        let mut sums = Self { sum: 0.0, sum_of_squares: 0.0, worst: (-1.0, NOWHERE) };
        for (from, closest) in closest {
            let length = length(&closest);
            sums.sum += length;
            sums.sum_of_squares += closest.distance_squared;
            let place = Place { from, to: closest.point, face: closest.face };
            sums.worst = farther(sums.worst, (length, place));
        }
        sums
    }
}

/// Returns the farther of two; the first if they are equal.
fn farther(first: (f64, Place), second: (f64, Place)) -> (f64, Place) {
    if second.0 > first.0 { second } else { first }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{cube, moved, plane, scaled, sphere};

    fn options(samples: usize) -> DistanceOptions {
        DistanceOptions { samples, ..Default::default() }
    }

    #[test]
    fn concentric_spheres_are_their_radii_apart() {
        let (inner, outer) = (sphere(100, 1.0), sphere(80, 1.25));
        let apart = distance(&inner, &outer, &options(20_000)).unwrap();
        // A chord of angle t is r (1 - cos(t / 2)) inside; across a face two of them add up.
        let sag = |n: f64, r: f64| 2.0 * r * (1.0 - (std::f64::consts::PI / n / 2.0).cos());
        let (low, high) = (0.25 - sag(80.0, 1.25), 0.25 + sag(100.0, 1.0));
        for way in [apart.forward, apart.backward] {
            for value in [way.mean, way.rms, way.max] {
                assert!((low..=high).contains(&value), "{low} {value} {high}");
            }
        }
    }

    #[test]
    fn offset_planes_are_exact() {
        let apart = distance(&plane(7, 0.0), &plane(3, 0.125), &options(5_000)).unwrap();
        for way in [apart.forward, apart.backward] {
            assert!((way.mean - 0.125).abs() < 1e-15 && (way.rms - 0.125).abs() < 1e-15);
            assert!((way.max - 0.125).abs() < 1e-15);
        }
    }

    #[test]
    fn a_ramp_has_the_moments_of_its_height() {
        // The distance from the wide plane below is the height, uniform from 0 to 1.
        let mut ramp = plane(9, 0.0);
        ramp.positions.iter_mut().for_each(|position| position[2] = position[0]);
        let ground = moved(&scaled(&plane(1, 0.0), 8.0), -4.0);
        let way = distance(&ramp, &moved_up(ground, 4.0), &options(50_000)).unwrap().forward;
        assert!((way.mean - 0.5).abs() < 1e-3, "{way:?}");
        assert!((way.rms - (1f64 / 3.0).sqrt()).abs() < 1e-3, "{way:?}");
        assert_eq!((way.max, way.place.from[0]), (1.0, 1.0));
    }

    fn moved_up(mut mesh: Mesh, z: f64) -> Mesh {
        mesh.positions.iter_mut().for_each(|position| position[2] += z);
        mesh
    }

    #[test]
    fn a_mesh_is_no_distance_from_itself() {
        let mesh = moved(&sphere(20, 1.0), 1e6);
        let apart = distance(&mesh, &mesh, &options(5_000)).unwrap();
        assert!(apart.max() < 1e-9 && apart.mean() < 1e-9, "{apart:?}");
        assert!(
            vertex_errors(&mesh, &PreparedSurface::new(&mesh).unwrap()).iter().all(|&e| e == 0.0)
        );
    }

    #[test]
    fn a_spike_counts_from_its_own_side_only() {
        let flat = plane(10, 0.0);
        let mut spiked = flat.clone();
        let tip = 5 * 11 + 5;
        spiked.positions[tip][2] = 3.0;
        let apart = distance(&spiked, &flat, &options(5_000)).unwrap();
        assert_eq!((apart.forward.max, apart.max()), (3.0, 3.0));
        assert_eq!(apart.forward.place.from, [0.5, 0.5, 3.0]);
        assert_eq!(apart.forward.place.to, [0.5, 0.5, 0.0]);
        assert!(flat.faces[apart.forward.place.face.index()].iter().any(|v| v.index() == tip));
        assert!(apart.backward.max < 0.2, "{:?}", apart.backward);
        let errors = vertex_errors(&spiked, &PreparedSurface::new(&flat).unwrap());
        assert!(errors.iter().enumerate().all(|(v, &e)| e == if v == tip { 3.0 } else { 0.0 }));
    }

    #[test]
    fn both_ways_are_joined_as_named() {
        let place = Place { from: [0.0; 3], to: [0.0; 3], face: FaceId(0) };
        let forward = OneSidedDistance { mean: 1.0, rms: 1.0, max: 4.0, place };
        let backward = OneSidedDistance { mean: 3.0, rms: 7.0, max: 9.0, place };
        let apart = Distance { forward, backward, diagonal: 50.0 };
        assert_eq!((apart.mean(), apart.rms(), apart.max()), (2.0, 5.0, 9.0));
        assert_eq!(apart.percent(apart.max()), 18.0);
    }

    /// Searches end early at vertices that are near enough.
    #[test]
    fn the_farthest_point_is_the_farthest_of_all() {
        let mut dented = sphere(40, 1.0);
        for (i, position) in dented.positions.iter_mut().enumerate() {
            position.iter_mut().for_each(|x| *x *= 1.0 + 0.01 * ((i * 7919 % 101) as f64 / 101.0));
        }
        for other in [sphere(37, 1.0), sphere(12, 1.003), dented.clone()] {
            let all = [&dented, &other].map(|mesh| PreparedSurface::new(mesh).unwrap());
            let farthest = |from: &PreparedSurface<'_>, to: &PreparedSurface<'_>| {
                let vertices = from.vertices.iter().map(|v| from.mesh.positions[v.index()]);
                let points: Vec<_> = vertices.chain(samples(from, 3_000, 0, 0..3_000)).collect();
                let each = points.into_iter().map(|point| {
                    let closest = to.bvh.closest(point, None);
                    let place = Place { from: point, to: closest.point, face: closest.face };
                    (length(&closest), place)
                });
                each.reduce(farther).unwrap()
            };
            let found = surface_distance(&all[0], &all[1], &options(3_000)).unwrap();
            let ways = [(found.forward, [0, 1]), (found.backward, [1, 0])];
            for (way, [from, to]) in ways {
                assert_eq!((way.max, way.place), farthest(&all[from], &all[to]));
            }
        }
    }

    #[test]
    fn vertices_that_no_face_uses_are_left_out() {
        let mut mesh = cube();
        mesh.positions.push([100.0; 3]);
        assert!(distance(&mesh, &cube(), &options(100)).unwrap().max() < 1e-15);
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let (a, b) = (sphere(30, 1.0), sphere(23, 1.1));
        let measure = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| distance(&a, &b, &options(30_000))).unwrap()
        };
        assert_eq!(measure(1), measure(2));
    }

    #[test]
    fn another_seed_gives_another_but_near_mean() {
        let (a, b) = (sphere(10, 1.0), cube());
        let mean = |seed| {
            let options = DistanceOptions { samples: 20_000, seed };
            distance(&a, &b, &options).unwrap().mean()
        };
        assert_ne!(mean(1), mean(2));
        assert!((mean(1) / mean(2) - 1.0).abs() < 1e-3, "{} {}", mean(1), mean(2));
    }

    #[test]
    fn errors_say_which_mesh() {
        let error = |a: &Mesh, b: &Mesh, n| distance(a, b, &options(n)).unwrap_err().to_string();
        assert_eq!(error(&Mesh::default(), &cube(), 9), "the first mesh: the mesh has no faces");
        let flat = scaled(&cube(), 0.0);
        assert_eq!(error(&cube(), &flat, 9), "the second mesh: all faces have zero area");
        assert_eq!(error(&cube(), &cube(), 0), MeasureError::NoSamples.to_string());
    }
}
