//! Quadric error metrics [GH97]: the cost of an edge is the least weighted squared distance to the
//! planes of all faces merged into its ends.
//!
//! Our choices: planes are weighted by area. Boundary edges, seams and contacts add constraint
//! planes perpendicular to their faces. Quadrics are stored relative to their vertices, and the
//! optimum is pulled a little towards the middle of the edge, so that flat regions and straight
//! edges need no special case. And memory fades: the quadric of a vertex is mostly the surface as
//! it is, and a little of what it was. Memory is what costs quadrics their accuracy [LT98] [Hop99].
//! Forgetting all of it would mean summing every ring anew, while forgetting most of it needs only
//! the faces that a contraction gathers anyway.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Side, Twin, VertexId};

use crate::engine::policy::{Memory, Placement, Priority};
use crate::engine::prepared_surface::PreparedSurface;
use crate::methods::attribute_metric::AttributeMetric;
use crate::methods::quadric::Quadric;
use crate::options::Options;
use crate::refusal::Refusal;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::feature_edges::is_feature;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Flags, Placed, Surface};

/// Strength of the pull of the optimum towards the middle of the edge. Of 1e-9 … 1e-3, 1e-5 gave
/// the least mean error on bunny, horse, igea and dragon at 10 % and 1 %; up to 1e-4 all are within
/// 2 %.
const PULL: f64 = 1e-5;

/// Weight of the squared edge length against squared distance. Enough to take short edges first
/// where all costs are rounding errors: otherwise a flat of a million faces grows hubs and takes
/// fifty times as long. 1e-6 already shows in the error of bunny at 1 %.
pub(super) const SHORT_FIRST: f64 = 1e-9;

/// Fraction of the summed quadrics that a new vertex keeps; the rest comes from its current faces.
/// Mean error in % of the diagonal at 1 % of the faces:
///
/// | memory | bunny | horse | igea | dragon | armadillo | lucy |
/// |---|---|---|---|---|---|---|
/// | 1 | .1434 | .0827 | .0412 | .0299 | .1149 | .1370 |
/// | 0.5 | .1258 | .0758 | .0367 | .0275 | | |
/// | 0.1 | .1227 | .0720 | .0357 | .0268 | .0954 | .1165 |
/// | 0 | .1179 | .0724 | .0357 | | | |
///
/// Forgetting everything gains nothing more, but would lose what the vertices of a flat know of its
/// rim.
pub(crate) const MEMORY: f64 = 0.1;

/// Default weight of a boundary edge's constraint plane, relative to the square of its length as an
/// area.
pub(crate) const BOUNDARY_WEIGHT: f64 = 2.0;

/// Weight of the constraint plane of a seam or a contact, relative to the square of its length as
/// an area.
const FEATURE_WEIGHT: f64 = 1.0;

/// Weight of a constraint plane against planes of weight 1. The paper asks for a large penalty and
/// names no figure.
const PENALTY: f64 = 1000.0;

/// Weights of planes, and how long they are remembered.
#[derive(Clone, Copy)]
pub(crate) struct Recipe {
    /// True if planes weigh as much as their faces' areas, and constraint planes as squared
    /// lengths; false if all weigh the same.
    by_area: bool,
    boundary_weight: f64,
    feature_weight: f64,
    /// Fraction of the summed quadrics that a new vertex keeps.
    memory: f64,
}

impl Recipe {
    /// Our own quadrics.
    pub(crate) const OURS: Self = Self {
        by_area: true,
        boundary_weight: BOUNDARY_WEIGHT,
        feature_weight: FEATURE_WEIGHT,
        memory: MEMORY,
    };

    /// Quadrics as first published [GH97]: planes of equal weight, a large penalty on boundaries,
    /// and nothing is forgotten. Seams, which the paper does not have, are treated like boundaries.
    pub(crate) const PLAIN: Self =
        Self { by_area: false, boundary_weight: PENALTY, feature_weight: PENALTY, memory: 1.0 };

    /// Returns the recipe with another weight of boundaries, if one is given.
    fn weighing(self, boundary: Option<f64>) -> Self {
        Self { boundary_weight: boundary.unwrap_or(self.boundary_weight), ..self }
    }
}

/// Quadrics of all vertices, and the attribute term.
pub(crate) struct Quadrics<A = ()> {
    quadrics: Vec<Quadric>,
    recipe: Recipe,
    attributes: A,
}

impl<A> Quadrics<A> {
    /// Builds the quadrics of a prepared surface, with the options' weight of boundaries.
    pub(crate) fn new(
        recipe: Recipe,
        options: &Options,
        ready: &PreparedSurface,
        attributes: A,
    ) -> Self {
        let recipe = recipe.weighing(options.boundary_weight);
        let PreparedSurface { surface, connectivity, .. } = ready;
        let mut quadrics = vec![Quadric::default(); surface.vertex_count()];
        for face in (0..surface.face_count()).map(FaceId::new).filter(|&f| surface.is_alive(f)) {
            add_face(&mut quadrics, surface, (face, connectivity), recipe);
        }
        Self { quadrics, recipe, attributes }
    }

    /// Returns the sum of the contracted vertices' quadrics, relative to the first.
    #[inline]
    fn sum(&self, surface: &Surface, contracted: &Contracted) -> Quadric {
        let origin = surface.position(contracted[0]);
        let mut sum = self.quadrics[contracted[0].index()];
        for &v in &contracted[1..] {
            sum = sum + self.quadrics[v.index()].seen_from(origin - surface.position(v));
        }
        sum
    }
}

impl<A: AttributeMetric> Memory for Quadrics<A> {
    fn merge(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let origin = surface.position(neighbourhood.contracted()[0]);
        let sum = self.sum(surface, neighbourhood.contracted());
        let mut merged = sum.seen_from(placed.position - origin);
        // Constraint planes cannot be rebuilt from the faces around, so vertices on feature edges
        // keep everything.
        let on_feature = |&v: &VertexId| surface.flags(v).any(Flags::FEATURE);
        let memory = self.recipe.memory;
        if memory < 1.0 && !neighbourhood.contracted().iter().any(on_feature) {
            merged = merged * memory + star(neighbourhood, placed.position) * (1.0 - memory);
        }
        self.quadrics[neighbourhood.contracted()[placed.kept].index()] = merged;
        self.attributes.merge(surface, neighbourhood, placed);
    }

    fn renew(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        self.attributes.renew(surface, neighbourhood, placed);
    }
}

/// Returns the quadric of the surviving faces with their vertex at `position`, relative to it.
fn star(neighbourhood: &Neighbourhood, position: DVec3) -> Quadric {
    let at = |place: u32| neighbourhood.ring()[place as usize].position - position;
    neighbourhood
        .spokes()
        .iter()
        .fold(Quadric::default(), |sum, spoke| sum + Quadric::face(at(spoke.a).cross(at(spoke.b))))
}

fn add_face(
    quadrics: &mut [Quadric],
    surface: &Surface,
    (face, connectivity): (FaceId, &Connectivity),
    recipe: Recipe,
) {
    let area_normal = surface.area_normal(face);
    let Some(normal) = area_normal.try_normalize() else { return };
    let plane = match recipe.by_area {
        true => Quadric::face(area_normal),
        false => Quadric::plane(normal, 1.0),
    };
    let corners = surface.face(face);
    for v in corners {
        quadrics[v.index()] = quadrics[v.index()] + plane;
    }
    for k in 0..3 {
        let weight = match connectivity.twin(Side::new(face, k)) {
            Twin::Boundary => recipe.boundary_weight,
            Twin::Side(twin) if is_feature(surface, Side::new(face, k), twin) => {
                recipe.feature_weight
            }
            _ => continue,
        };
        let ends = [corners[k], corners[(k + 1) % 3]];
        let along = surface.position(ends[1]) - surface.position(ends[0]);
        if let Some(across) = along.cross(normal).try_normalize() {
            let weight = if recipe.by_area { weight * along.length_squared() } else { weight };
            let constraint = Quadric::plane(across, weight).as_constraint();
            for v in ends {
                quadrics[v.index()] = quadrics[v.index()] + constraint;
            }
        }
    }
}

/// Position chosen by a placement rule, with its cost.
pub(crate) struct CostedPlacement {
    /// Offset from the first contracted vertex.
    offset: DVec3,
    kept: usize,
    cost: f64,
}

/// Placement at the optimum of the summed quadric; priority and placement in one.
#[derive(Clone, Copy)]
pub(crate) struct Optimal;

/// Placement at the better end of the edge, so that no vertex moves; priority and placement in one.
#[derive(Clone, Copy)]
pub(crate) struct Endpoint;

/// Placement at the optimum itself where there is one, else at the best of both ends and the
/// middle [GH97]; priority and placement in one.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

/// Sum of the quadrics of a candidate, for placement rules.
pub(crate) struct EdgeSum<'a, A> {
    /// Geometric quadric, relative to the first contracted vertex.
    geometry: Quadric,
    attributes: &'a A,
    surface: &'a Surface,
    of: &'a Contracted,
}

impl<'a, A: AttributeMetric> EdgeSum<'a, A> {
    #[inline]
    fn new(memory: &'a Quadrics<A>, surface: &'a Surface, of: &'a Contracted) -> Self {
        let geometry = memory.sum(surface, of);
        Self { geometry, attributes: &memory.attributes, surface, of }
    }

    /// Places the new vertex at one of the contracted ones.
    #[inline]
    fn at(&self, kept: usize) -> CostedPlacement {
        let Self { geometry, surface, of, .. } = *self;
        let offset = surface.position(of[kept]) - surface.position(of[0]);
        let whole = self.attributes.staying(geometry, surface, of, kept);
        CostedPlacement { offset, kept, cost: whole.at(offset) }
    }
}

/// Rule that places the new vertex of a quadric method.
pub(crate) trait PlacementRule: Sync {
    fn choose<A: AttributeMetric>(sum: &EdgeSum<'_, A>, freedom: Freedom) -> CostedPlacement;
}

impl PlacementRule for Optimal {
    #[inline]
    fn choose<A: AttributeMetric>(sum: &EdgeSum<'_, A>, freedom: Freedom) -> CostedPlacement {
        if let Some(kept) = freedom.kept() {
            return sum.at(kept);
        }
        let EdgeSum { geometry, surface, of, .. } = *sum;
        let origin = surface.position(of[0]);
        let middle =
            of.iter().map(|&v| surface.position(v) - origin).sum::<DVec3>() / of.len() as f64;
        let whole = sum.attributes.free(geometry, surface, of);
        let offset = whole.optimum(middle, PULL);
        CostedPlacement { offset, kept: 0, cost: whole.at(offset) }
    }
}

impl PlacementRule for Endpoint {
    #[inline]
    fn choose<A: AttributeMetric>(sum: &EdgeSum<'_, A>, freedom: Freedom) -> CostedPlacement {
        match freedom.kept() {
            Some(kept) => sum.at(kept),
            None => (0..sum.of.len())
                .map(|kept| sum.at(kept))
                .min_by(|a, b| a.cost.total_cmp(&b.cost))
                .expect("a candidate has vertices"),
        }
    }
}

impl PlacementRule for Plain {
    fn choose<A: AttributeMetric>(sum: &EdgeSum<'_, A>, freedom: Freedom) -> CostedPlacement {
        if let Some(kept) = freedom.kept() {
            return sum.at(kept);
        }
        let at = |offset| CostedPlacement { offset, kept: 0, cost: sum.geometry.at(offset) };
        if let Some(offset) = sum.geometry.minimum() {
            return at(offset);
        }
        let [origin, end] = [0, 1].map(|i| sum.surface.position(sum.of[i]));
        let places = [at((end - origin) * 0.5), sum.at(0), sum.at(1)];
        let [first, others @ ..] = places;
        others.into_iter().fold(first, |best, next| if next.cost < best.cost { next } else { best })
    }
}

impl<R: PlacementRule, A: AttributeMetric> Priority<Quadrics<A>> for R {
    #[inline]
    fn cost(
        &self,
        surface: &Surface,
        memory: &Quadrics<A>,
        of: &Contracted,
        freedom: Freedom,
    ) -> Option<f64> {
        let sum = EdgeSum::new(memory, surface, of);
        let [from, to] = [of[0], of[of.len() - 1]].map(|v| surface.position(v));
        let tie_break = SHORT_FIRST * sum.geometry.mean_of(from.distance_squared(to));
        Some(R::choose(&sum, freedom).cost + tie_break)
    }
}

impl<R: PlacementRule, A: AttributeMetric> Placement<Quadrics<A>> for R {
    fn place(
        &self,
        surface: &Surface,
        memory: &Quadrics<A>,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        let sum = EdgeSum::new(memory, surface, neighbourhood.contracted());
        let choice = R::choose(&sum, neighbourhood.freedom());
        // An end keeps its position exactly.
        let origin = surface.position(neighbourhood.contracted()[0]);
        let kept = surface.position(neighbourhood.contracted()[choice.kept]);
        let position = if choice.offset == kept - origin { kept } else { origin + choice.offset };
        // The estimate is a distance, so attributes do not contribute.
        let error_estimate = sum.geometry.distance(sum.geometry.at(choice.offset));
        Ok(Placed { position, kept: choice.kept, error_estimate })
    }
}
