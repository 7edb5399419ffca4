//! Builds triangle strips for any list of faces.

use meshlod_mesh::VertexId;
use rayon::prelude::*;

use crate::anneal::{Annealing, Starts};
use crate::cache_runs::CacheAware;
use crate::energy::Prices;
use crate::order::Order;
use crate::path_cover::PathCover;
use crate::strips::Strips;

/// Quality of triangle strips, traded for the time to build them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum StripQuality {
    /// Greedy strips, built in one pass.
    Fast,
    /// Strips of the fewest vertices, by annealing: see [`StripQuality::QUICK`] and
    /// [`StripQuality::THOROUGH`].
    Best {
        /// Number of annealing moves tried per face, at most a million.
        ///
        /// 60 take one or two seconds for the 69 thousand faces of the bunny on one core of 2026;
        /// the time is proportional.
        moves_per_face: f64,
    },
}

impl StripQuality {
    /// Annealing with 60 moves per face, which gives 1.094 vertices per face on the Stanford bunny.
    pub const QUICK: Self = Self::Best { moves_per_face: 60.0 };

    /// Annealing with 1500 moves per face, which gives 1.086 vertices per face on the Stanford
    /// bunny.
    pub const THOROUGH: Self = Self::Best { moves_per_face: 1500.0 };
}

/// Options of [`stripify`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct StripOptions<'a> {
    /// Quality of the strips, traded for the time to build them.
    pub quality: StripQuality,
    /// Prices of strips and swaps, the sum of which annealing minimises.
    pub prices: Prices,
    /// Vertex cache to cut and order the strips for; `None` to ignore caching.
    pub cache: Option<CacheAware>,
    /// Cluster label of each face; no strip crosses from one cluster to another. Not part of what
    /// serde writes and reads.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub clusters: Option<&'a [u32]>,
    /// Seed of the random numbers; other seeds give other strips of about the same quality.
    pub seed: u64,
}

impl Default for StripOptions<'_> {
    fn default() -> Self {
        Self {
            quality: StripQuality::QUICK,
            prices: Prices::default(),
            cache: None,
            clusters: None,
            seed: 0,
        }
    }
}

/// Builds triangle strips that draw exactly `faces`, with their winding and multiplicity.
///
/// Any faces are accepted: at edges with more than two faces, or between faces of opposite
/// orientation, strips go on as far as they can. Faces that repeat a vertex are left out. The
/// result is deterministic.
///
/// # Panics
/// If there are labels, but not one per face; above a billion faces.
pub fn stripify(faces: &[[VertexId; 3]], options: &StripOptions) -> Strips {
    let mut cover = PathCover::new(faces);
    if let Some(labels) = options.clusters {
        cover.split_by_labels(labels);
    }
    match options.quality {
        StripQuality::Fast => {
            let strips = cover.cover_greedily(faces);
            match &options.cache {
                None => strips,
                Some(cache) => cover.strips_for_cache(faces, cache),
            }
        }
        StripQuality::Best { moves_per_face } => {
            let order = Order::new(&cover);
            let faces = order.sorted(faces);
            let run = MIN_RUN.max(RUN_RINGS * order.widest);
            let moves_per_face = moves_per_face.min(MAX_MOVES);
            let (mut cover, strips) =
                best_try(order.sort(&cover), &faces, run, moves_per_face, options);
            match &options.cache {
                None => strips,
                Some(cache) => cover.strips_for_cache(&faces, cache),
            }
        }
    }
}

/// Anneals a cover from several seeds and returns the best, with its strips. All start from the
/// greedy strips: from no links at all the bunny reaches 1.097 vertices per face with 60 moves, and
/// a regular torus 1.029 instead of 1.001.
fn best_try(
    mut cover: PathCover,
    faces: &[[VertexId; 3]],
    run: usize,
    moves_per_node: f64,
    options: &StripOptions,
) -> (PathCover, Strips) {
    let laid = cover.cover_greedily(faces);
    let tries = (SINGLE_TRY_FACES / faces.len().max(1)).clamp(1, MAX_TRIES) as u64;
    let annealed = |number: u64| {
        let mut cover = cover.clone();
        let seed = options.seed.wrapping_mul(tries).wrapping_add(number);
        let annealing = Annealing { prices: options.prices, heat: HEAT, moves_per_node, seed };
        cover.anneal(Starts::Runs(run), &annealing);
        cover.fix_parity(&options.prices, seed);
        let strips = cover.strips(faces);
        (cover, strips)
    };
    // A repeated vertex is already counted among the vertices.
    let cost = |strips: &Strips| {
        strips.vertices().len() as f64 + (options.prices.strip - 2.0) * strips.len() as f64
    };
    let tried: Vec<_> = (0..tries).into_par_iter().map(annealed).collect();
    let best = tried.into_iter().min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)));
    best.filter(|(_, strips)| cost(strips) <= cost(&laid)).unwrap_or((cover, laid))
}

/// Upper limit of the moves per face; more bring no gain.
const MAX_MOVES: f64 = 1e6;

/// Meshes with fewer faces are annealed several times, because a single run depends more on luck,
/// and there is time. fandisk.off, 13 thousand faces, 500 moves per face: from 1.069 to 1.076
/// vertices per face.
const SINGLE_TRY_FACES: usize = 100_000;

/// Largest number of annealing runs.
const MAX_TRIES: usize = 8;

/// First and last temperature of the annealing, in vertices. Few moves want less heat, many want
/// more: with 60 moves per face the bunny reaches 1.0965, 1.0936, 1.0942 and 1.0940 vertices per
/// face from .3, .65, .8 and 1. With 500 fandisk.off reaches 1.0733, 1.0721, 1.0709 and 1.0733 from
/// .65, .8, 1 and 1.2, the mean of eight runs.
const HEAT: [f64; 2] = [0.9, 0.12];

/// Smallest number of faces annealed together: half a megabyte of nodes, which fits the cache of a
/// core. The bunny, 300 moves per face: 1.0944 vertices per face with half of it, 1.0924 with this,
/// 1.0918 with the whole mesh at once in one and a half times the time.
const MIN_RUN: usize = 32768;

/// Smallest width of such a run in rings of faces, because the faces at its border are frozen.
const RUN_RINGS: usize = 12;

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{cube, fan, hourglass, mesh, moebius, tetrahedron};
    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;

    use super::*;
    use crate::verify::{Difference, difference};

    fn quick() -> StripOptions<'static> {
        StripOptions {
            quality: StripQuality::Best { moves_per_face: 20.0 },
            ..StripOptions::default()
        }
    }

    /// Well-formed meshes and malformed lists of faces.
    fn all_sorts() -> Vec<Mesh> {
        let soup = |seed: u32| {
            let corner = |i: u32| i.wrapping_mul(2_654_435_761).wrapping_add(seed) >> 16;
            let faces: Vec<_> =
                (0..300).map(|f| [0, 1, 2].map(|k| corner(3 * f + k) % 12)).collect();
            mesh(&[[0.0; 3]; 12], &faces)
        };
        let book = mesh(&[[0.0; 3]; 6], &[[0, 1, 2], [1, 0, 3], [1, 0, 4], [0, 1, 5], [0, 1, 2]]);
        let odd = mesh(&[[0.0; 3]; 3], &[[0, 1, 2], [2, 1, 0], [0, 0, 1], [2, 2, 2]]);
        vec![
            Mesh::default(),
            fan(),
            hourglass(),
            moebius(9),
            tetrahedron(),
            cube(),
            samples::sphere(400),
            book,
            odd,
            soup(1),
            soup(77),
        ]
    }

    #[test]
    fn exactly_the_faces_are_drawn_whatever_they_are() {
        for mesh in all_sorts() {
            for quality in [StripQuality::Fast, quick().quality] {
                for cache in [None, Some(CacheAware::default())] {
                    let strips = stripify(&mesh.faces, &StripOptions { quality, cache, ..quick() });
                    assert_eq!(difference(&strips, &mesh.faces), Difference::default());
                }
            }
        }
    }

    #[test]
    fn a_regular_torus_needs_few_more_vertices_than_faces() {
        let faces = torus(24, 32);
        let strips = stripify(
            &faces,
            &StripOptions { quality: StripQuality::Best { moves_per_face: 300.0 }, ..quick() },
        );
        assert!(strips.vertices().len() < faces.len() * 105 / 100, "{}", strips.vertices().len());
    }

    #[test]
    fn annealing_in_runs_is_the_same_for_any_number_of_threads() {
        // Enough faces for several runs.
        let faces = torus(300, 200);
        let options =
            StripOptions { quality: StripQuality::Best { moves_per_face: 1.0 }, ..quick() };
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| stripify(&faces, &options))
        };
        let alone = with(1);
        assert_eq!(difference(&alone, &faces), Difference::default());
        assert_eq!(alone, with(3));
    }

    #[test]
    fn laid_strips_follow_the_rows_of_a_torus() {
        let faces = torus(24, 32);
        let strips = stripify(&faces, &StripOptions { quality: StripQuality::Fast, ..quick() });
        assert!(strips.vertices().len() < faces.len() * 110 / 100, "{}", strips.vertices().len());
    }

    #[test]
    fn no_strip_leaves_its_cluster() {
        let faces = torus(12, 12);
        let labels: Vec<u32> = (0..faces.len() as u32).map(|f| f / 24).collect();
        let strips = stripify(&faces, &StripOptions { clusters: Some(&labels), ..quick() });
        assert_eq!(difference(&strips, &faces), Difference::default());
        let label = |triangle: [VertexId; 3]| {
            let of = |face: &[VertexId; 3]| face.iter().all(|v| triangle.contains(v));
            labels[faces.iter().position(of).unwrap()]
        };
        for strip in strips.iter() {
            let mut alone = Strips::default();
            alone.push(strip.iter().copied());
            let mut of_strip: Vec<u32> = alone.triangles().map(label).collect();
            of_strip.dedup();
            assert_eq!(of_strip.len(), 1);
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_strips() {
        let faces = samples::sphere(500).faces;
        assert_eq!(stripify(&faces, &quick()), stripify(&faces, &quick()));
        assert_ne!(
            stripify(&faces, &quick()),
            stripify(&faces, &StripOptions { seed: 1, ..quick() })
        );
    }

    /// Builds a torus of `m` by `n` squares, all cut the same way: every vertex has six faces.
    fn torus(m: u32, n: u32) -> Vec<[VertexId; 3]> {
        let at = |i: u32, j: u32| VertexId(i % m * n + j % n);
        let square = |i, j| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        (0..m * n).flat_map(|s| square(s / n, s % n)).collect()
    }
}
