//! Strips of any faces.

use meshlod_mesh::VertexId;
use rayon::prelude::*;

use crate::anneal::{Annealing, Starts};
use crate::cover::Cover;
use crate::energy::Prices;
use crate::order::Order;
use crate::pieces::CacheAware;
use crate::strips::Strips;

/// How good strips shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quality {
    /// In one pass, laid side by side.
    Fast,
    /// As few vertices as that many changes tried for each face find: [`Quality::QUICK`], [`Quality::THOROUGH`].
    Best {
        /// How many, a million at most. 60 take one or two seconds for the 69 thousand faces of the bunny on one core of 2026, and
        /// twice as many twice as long.
        moves_per_face: f64,
    },
}

impl Quality {
    /// The bunny: 1.094 vertices a face.
    pub const QUICK: Self = Self::Best { moves_per_face: 60.0 };

    /// The bunny: 1.086 vertices a face.
    pub const THOROUGH: Self = Self::Best { moves_per_face: 1500.0 };
}

/// What strips are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options<'a> {
    /// How good they shall be.
    pub quality: Quality,
    /// What counts as their cost.
    pub prices: Prices,
    /// Whether strips shall be cut and ordered for a vertex cache, and for which.
    pub cache: Option<CacheAware>,
    /// A label for each face, and no strip goes from one label to another.
    pub clusters: Option<&'a [u32]>,
    /// Other seeds give other strips, about as good.
    pub seed: u64,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self {
            quality: Quality::QUICK,
            prices: Prices::default(),
            cache: None,
            clusters: None,
            seed: 0,
        }
    }
}

/// Strips that draw exactly `faces`, each as often as it is there and as it is wound.
///
/// Any faces are taken: at edges of more than two faces, or where two neighbours are not oriented alike, a strip
/// goes on as far as it can. Faces that repeat a vertex are left out. The same faces and options give the same
/// strips.
///
/// Panics unless there are as many labels as faces, where there are labels, and above a billion faces.
pub fn stripify(faces: &[[VertexId; 3]], options: &Options) -> Strips {
    let mut cover = Cover::new(faces);
    if let Some(labels) = options.clusters {
        cover.part(labels);
    }
    match options.quality {
        Quality::Fast => {
            let strips = cover.lay(faces);
            match &options.cache {
                None => strips,
                Some(cache) => cover.strips_for_cache(faces, cache),
            }
        }
        Quality::Best { moves_per_face } => {
            let order = Order::new(&cover);
            let faces = order.sorted(faces);
            let run = LEAST_RUN.max(RUN_IN_RINGS * order.widest);
            let moves_per_face = moves_per_face.min(MOST_MOVES);
            let (mut cover, strips) =
                best_try(order.sort(&cover), &faces, run, moves_per_face, options);
            match &options.cache {
                None => strips,
                Some(cache) => cover.strips_for_cache(&faces, cache),
            }
        }
    }
}

/// The best of some annealings of a cover from different seeds, with its strips. All begin with the fast strips: from
/// none at all the bunny comes to 1.097 vertices a face with 60 moves, and a regular torus, 1.001 from them, to 1.029.
fn best_try(
    mut cover: Cover,
    faces: &[[VertexId; 3]],
    run: usize,
    moves_per_cell: f64,
    options: &Options,
) -> (Cover, Strips) {
    let laid = cover.lay(faces);
    let tries = (ENOUGH_FACES / faces.len().max(1)).clamp(1, MOST_TRIES) as u64;
    let annealed = |number: u64| {
        let mut cover = cover.clone();
        let seed = options.seed.wrapping_mul(tries).wrapping_add(number);
        let annealing = Annealing { prices: options.prices, heat: HEAT, moves_per_cell, seed };
        cover.anneal(Starts::Runs(run), &annealing);
        cover.even_out(&options.prices, seed);
        let strips = cover.strips(faces);
        (cover, strips)
    };
    // What is said again is in the vertices already.
    let cost = |strips: &Strips| {
        strips.vertices().len() as f64 + (options.prices.strip - 2.0) * strips.len() as f64
    };
    let tried: Vec<_> = (0..tries).into_par_iter().map(annealed).collect();
    let best = tried.into_iter().min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)));
    best.filter(|(_, strips)| cost(strips) <= cost(&laid)).unwrap_or((cover, laid))
}

/// More for a face would never end, and gain nothing.
const MOST_MOVES: f64 = 1e6;

/// Meshes with fewer faces are annealed several times: how well one time comes out is more and more a matter of luck,
/// and there is time. fandisk.off, 13 thousand faces, 500 moves a face: from 1.069 to 1.076 vertices a face.
const ENOUGH_FACES: usize = 100_000;

/// How many times at most.
const MOST_TRIES: usize = 8;

/// How hot the annealing begins and ends, in vertices. Few moves want less heat, many want more: the bunny with 60 moves
/// a face comes to 1.0965, 1.0936, 1.0942 and 1.0940 vertices a face from .3, .65, .8 and 1, fandisk.off with 500 to
/// 1.0733, 1.0721, 1.0709 and 1.0733 from .65, .8, 1 and 1.2, the mean of eight times.
const HEAT: [f64; 2] = [0.9, 0.12];

/// How many faces are annealed together at least: half a megabyte of cells, which a core's own cache holds. The bunny,
/// 300 moves a face: 1.0944 vertices a face with half of that, 1.0924 with this, 1.0918 as a whole, in half as much
/// time again.
const LEAST_RUN: usize = 32768;

/// How wide that is at least, in faces: those at its border wait.
const RUN_IN_RINGS: usize = 12;

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{cube, fan, hourglass, mesh, moebius, tetrahedron};
    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;

    use super::*;
    use crate::verify::{Difference, difference};

    fn quick() -> Options<'static> {
        Options { quality: Quality::Best { moves_per_face: 20.0 }, ..Options::default() }
    }

    /// Meshes as they should be, and faces as they should not.
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
            for quality in [Quality::Fast, quick().quality] {
                for cache in [None, Some(CacheAware::default())] {
                    let strips = stripify(&mesh.faces, &Options { quality, cache, ..quick() });
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
            &Options { quality: Quality::Best { moves_per_face: 300.0 }, ..quick() },
        );
        assert!(strips.vertices().len() < faces.len() * 105 / 100, "{}", strips.vertices().len());
    }

    #[test]
    fn annealing_in_runs_is_the_same_for_any_number_of_threads() {
        // Long enough for several runs.
        let faces = torus(300, 200);
        let options = Options { quality: Quality::Best { moves_per_face: 1.0 }, ..quick() };
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
        let strips = stripify(&faces, &Options { quality: Quality::Fast, ..quick() });
        assert!(strips.vertices().len() < faces.len() * 110 / 100, "{}", strips.vertices().len());
    }

    #[test]
    fn no_strip_leaves_its_cluster() {
        let faces = torus(12, 12);
        let labels: Vec<u32> = (0..faces.len() as u32).map(|f| f / 24).collect();
        let strips = stripify(&faces, &Options { clusters: Some(&labels), ..quick() });
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
        assert_ne!(stripify(&faces, &quick()), stripify(&faces, &Options { seed: 1, ..quick() }));
    }

    /// A torus of `m` by `n` squares, each cut the same way: every vertex has six faces.
    fn torus(m: u32, n: u32) -> Vec<[VertexId; 3]> {
        let at = |i: u32, j: u32| VertexId(i % m * n + j % n);
        let square = |i, j| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        (0..m * n).flat_map(|s| square(s / n, s % n)).collect()
    }
}
