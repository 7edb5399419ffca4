//! Memoryless simplification [LT98]: the cost of an edge is the sum of squared volumes that its
//! vertex, placed to conserve the volume, sweeps over the current faces around.
//!
//! Every plane of a vertex's star passes through the vertex. The cost of an edge therefore follows
//! from six numbers and a vector per end, as cheaply as with quadrics, and these are updated by the
//! change of each face alone. Only the position itself is computed from all the faces around,
//! exactly.

use glam::DVec3;
use meshlod_mesh::{FaceId, VertexId};

use crate::engine::Algorithm;
use crate::engine::policy::{Candidates, Memory, Placement, Priority};
use crate::engine::prepared_surface::PreparedSurface;
use crate::methods::qem::SHORT_FIRST;
use crate::methods::quadric::{Quadric, Symmetric};
use crate::methods::volume::{VolumePlane, along_normal, old_faces};
use crate::options::Options;
use crate::refusal::Refusal;
use crate::run::Run;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::feature_edges::feature_edges;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Flags, Placed, Surface};

/// Strength of the pull of the optimum towards the middle of the edge, which decides on flat
/// regions. Mean error of horse-97k at 10 % and 1 %: 1e-6 .00718, .0569; 1e-5 .00715, .0573; 1e-4
/// .00726, .0575; 1e-3 .00764, .0580. Of igea: .00437, .0307; .00437, .0308; .00443, .0310; .00486,
/// .0317.
const PULL: f64 = 1e-5;

/// Weight of a squared area at a feature edge against a squared volume over the squared length of
/// the edge. Both come as products of vectors, without their factors of a half and a sixth. It is
/// also the default weight of boundaries.
const FEATURE_WEIGHT: f64 = 9.0;

/// Smallest sine of the angle between a direction and a plane at which their intersection is used
/// [LT98].
const COMPATIBLE: f64 = 0.017;

/// A sum of vectors is rounding error if its square is less than this fraction of the sum of their
/// squares.
const CANCELLED: f64 = 1e-12;

/// Starts the method on edges, or on faces and edges.
pub(super) fn start<C: Candidates + 'static>(
    candidates: C,
    options: &Options,
    ready: PreparedSurface,
) -> Box<dyn Run> {
    let memoryless = Memoryless::new(options.boundary_weight);
    let memory = Stars::new(&ready.surface);
    Algorithm { candidates, memory, priority: memoryless, placement: memoryless }.start(ready)
}

/// Sums over the faces around a vertex, relative to it.
#[derive(Clone, Copy, Debug, Default)]
struct Star {
    /// Sum of n n', n a face's normal of twice its area.
    squares: Symmetric,
    /// Sum of n.
    normal: DVec3,
}

impl Star {
    #[inline]
    fn add(&mut self, normal: DVec3) {
        self.squares = self.squares + Symmetric::outer(normal);
        self.normal += normal;
    }

    #[inline]
    fn remove(&mut self, normal: DVec3) {
        self.squares = self.squares + Symmetric::outer(normal) * -1.0;
        self.normal -= normal;
    }
}

/// Sums over the star of every vertex.
struct Stars(Vec<Star>);

impl Stars {
    pub(crate) fn new(surface: &Surface) -> Self {
        let mut stars = vec![Star::default(); surface.vertex_count()];
        for f in (0..surface.face_count()).map(FaceId::new).filter(|&f| surface.is_alive(f)) {
            let normal = surface.area_normal(f);
            surface.face(f).iter().for_each(|v| stars[v.index()].add(normal));
        }
        Self(stars)
    }
}

impl Memory for Stars {
    const KNOWS_RING: bool = true;

    fn merge(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let mut joined = Star::default();
        for spoke in neighbourhood.spokes() {
            let ends = [spoke.a, spoke.b].map(|place| &neighbourhood.ring()[place as usize]);
            let normal = |from: DVec3| (ends[0].position - from).cross(ends[1].position - from);
            let old = normal(surface.position(neighbourhood.contracted()[spoke.owner()]));
            let new = normal(placed.position);
            joined.add(new);
            for r in ends {
                let star = &mut self.0[r.id.index()];
                star.remove(old);
                star.add(new);
            }
        }
        for removed in neighbourhood.removed_faces() {
            if let Some(apex) = removed.apex() {
                self.0[neighbourhood.ring()[apex].id.index()]
                    .remove(surface.area_normal(removed.face));
            }
        }
        self.0[neighbourhood.contracted()[placed.kept].index()] = joined;
    }
}

/// Least swept volume as priority and as placement, for edges and for faces.
#[derive(Clone, Copy)]
struct Memoryless {
    /// Weight of a squared area under a boundary.
    boundary: f64,
}

impl Memoryless {
    pub(crate) fn new(boundary_weight: Option<f64>) -> Self {
        Self { boundary: boundary_weight.unwrap_or(FEATURE_WEIGHT) }
    }
}

impl Priority<Stars> for Memoryless {
    #[inline]
    fn cost(
        &self,
        surface: &Surface,
        memory: &Stars,
        of: &Contracted,
        freedom: Freedom,
    ) -> Option<f64> {
        if of.iter().any(|&v| surface.flags(v).any(Flags::FEATURE)) {
            return cost_at_feature(surface, of, self.boundary);
        }
        let origin = surface.position(of[0]);
        let offset = |v: VertexId| surface.position(v) - origin;
        let Star { mut squares, mut normal } = memory.0[of[0].index()];
        let (mut linear, mut constant, mut level) = (DVec3::ZERO, 0.0, 0.0);
        // The faces shared by two of the vertices count twice. Removing them would need a look at
        // each, and gave worse results: mean error of horse-97k .00719, .0593 instead of .00715,
        // .0573.
        for &v in &of[1..] {
            let (star, d) = (&memory.0[v.index()], offset(v));
            let square = star.squares.apply(d);
            squares = squares + star.squares;
            normal += star.normal;
            linear -= square;
            constant += square.dot(d);
            level += star.normal.dot(d);
        }
        let swept = Quadric::new(squares, linear, constant);
        let x = match freedom.kept() {
            Some(kept) => offset(of[kept]),
            None => swept.optimum_on(normal, level, middle(surface, of), PULL),
        };
        Some(swept.at(x) + SHORT_FIRST * swept.mean_of(offset(of[1]).length_squared()))
    }
}

/// Returns the mean of the contracted vertices, relative to the first.
#[inline]
fn middle(surface: &Surface, of: &Contracted) -> DVec3 {
    let origin = surface.position(of[0]);
    of.iter().map(|&v| surface.position(v) - origin).sum::<DVec3>() / of.len() as f64
}

/// Returns the cost of an edge with an end on a feature edge, computed from all the faces around.
/// Few edges have one.
fn cost_at_feature(surface: &Surface, of: &Contracted, boundary: f64) -> Option<f64> {
    let mut neighbourhood = Neighbourhood::default();
    neighbourhood.gather(surface, *of).ok()?;
    let choice = choose(surface, &neighbourhood, boundary);
    let length = surface.position(of[0]).distance_squared(surface.position(of[1]));
    Some(choice.swept.at(choice.offset) + SHORT_FIRST * choice.swept.mean_of(length))
}

impl Placement<Stars> for Memoryless {
    fn place(
        &self,
        surface: &Surface,
        _: &Stars,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        place_with(surface, neighbourhood, self.boundary)
    }
}

/// Places a gathered contraction, using the current faces around. Where these nearly cancel, as in
/// folds, the position that conserves the volume can be far outside of them.
pub(crate) fn place(surface: &Surface, neighbourhood: &Neighbourhood) -> Result<Placed, Refusal> {
    place_with(surface, neighbourhood, FEATURE_WEIGHT)
}

fn place_with(
    surface: &Surface,
    neighbourhood: &Neighbourhood,
    boundary: f64,
) -> Result<Placed, Refusal> {
    let SweptPlacement { offset, swept, middle } = choose(surface, neighbourhood, boundary);
    let error_estimate = swept.distance(swept.at(offset));
    let origin = surface.position(neighbourhood.contracted()[0]);
    match neighbourhood.freedom() {
        Freedom::At(kept) => {
            let position = surface.position(neighbourhood.contracted()[kept]);
            Ok(Placed { position, kept, error_estimate })
        }
        Freedom::AlongNormal(kept) => {
            let position = along_normal(surface, neighbourhood, kept)?;
            Ok(Placed { position, kept, error_estimate })
        }
        Freedom::Free if offset.distance(middle) > neighbourhood.radius(origin + middle) => {
            Err(Refusal::Volume)
        }
        Freedom::Free => Ok(Placed { position: origin + offset, kept: 0, error_estimate }),
    }
}

/// Position of the new vertex relative to the first contracted one, with the swept volume as a
/// function of the position.
struct SweptPlacement {
    offset: DVec3,
    swept: Quadric,
    /// Mean of the contracted vertices, relative to the first.
    middle: DVec3,
}

fn choose(
    surface: &Surface,
    neighbourhood: &Neighbourhood,
    boundary_weight: f64,
) -> SweptPlacement {
    let place = |i: usize| surface.position(neighbourhood.contracted()[i]);
    let (origin, along) = (place(0), place(1) - place(0));
    let middle = middle(surface, neighbourhood.contracted());
    let mut volume = VolumePlane::default();
    let mut swept = Quadric::default();
    old_faces(surface, neighbourhood, origin, |normal, corner| {
        volume.add(normal, corner);
        swept = swept + Quadric::squared_plane(normal, normal.dot(corner));
    });
    volume.add_cones(surface, neighbourhood, origin);
    let mut boundary = BoundarySums::default();
    for feature_edge in feature_edges(surface, neighbourhood.contracted()) {
        let [from, to] = feature_edge.ends.map(|v| surface.position(v) - origin);
        let edge = to - from;
        let across = Symmetric::scalar(edge.length_squared()) + Symmetric::outer(edge) * -1.0;
        let weight = if feature_edge.is_boundary { boundary_weight } else { FEATURE_WEIGHT };
        let weight = weight * along.length_squared();
        swept = swept + Quadric::squared(across * weight, from).as_constraint();
        if feature_edge.is_boundary {
            boundary.add(from, to);
        }
    }
    let offset = match neighbourhood.freedom().kept() {
        Some(kept) => place(kept) - origin,
        None => match boundary.line() {
            Some(line) => {
                let reach = neighbourhood.radius(origin + middle);
                volume.nearest_within(line.best(&volume, &swept, middle, reach), reach)
            }
            None => swept.optimum_on(volume.normal, volume.level, middle, PULL),
        },
    };
    SweptPlacement { offset, swept, middle }
}

/// Sums over the boundary edges around: of their directions, and of the products of their ends.
#[derive(Clone, Copy, Debug, Default)]
struct BoundarySums {
    directions: DVec3,
    products: DVec3,
    squares: f64,
}

/// Line of positions that preserve the area under a boundary.
struct AreaLine {
    start: DVec3,
    direction: DVec3,
}

impl BoundarySums {
    fn add(&mut self, from: DVec3, to: DVec3) {
        self.directions += to - from;
        self.products += from.cross(to);
        self.squares += from.distance_squared(to);
    }

    /// Returns the line on which the sum of the areas between the boundary and a vertex is least;
    /// `None` without a boundary, or with a complete closed one.
    fn line(&self) -> Option<AreaLine> {
        let (e, squared) = (self.directions, self.directions.length_squared());
        let start = e.cross(self.products) / squared;
        (squared > CANCELLED * self.squares).then_some(AreaLine { start, direction: e })
    }
}

impl AreaLine {
    /// Returns the position on the line that also conserves the volume, if the line crosses that
    /// plane at a sufficient angle and within `reach` of `toward`; otherwise the one with the least
    /// swept volume.
    fn best(&self, volume: &VolumePlane, swept: &Quadric, toward: DVec3, reach: f64) -> DVec3 {
        let (slope, e) = (volume.normal.dot(self.direction), self.direction);
        if slope.abs() > COMPATIBLE * volume.normal.length() * e.length() {
            let crossing = self.start + e * (volume.loss(self.start) / slope);
            if crossing.distance(toward) <= reach {
                return crossing;
            }
        }
        let t = swept.least_along(self.start, e, toward, PULL);
        if t.is_finite() { self.start + e * t } else { toward }
    }
}
