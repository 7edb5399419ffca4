//! Writes the forest down while the engine contracts.
//!
//! What must hold along every dependency is made to hold here, on the way up, in constant time a
//! neighbour: an update comes after all that need it, so each vertex carries what those around it
//! ask of the update that will contract it.

use std::collections::BTreeMap;

use meshlod_mesh::{Bounds, FaceId, VertexId};
use meshlod_simplify::{Neighbourhood, Observe, Placed, Simplifier, Spoke, Surface};

use crate::bounds::ErrorKind;
use crate::forest::{BuildError, Forest, MAX_LEVELS, NONE, NonFanSplit, Update};
use crate::frame::{Frame, Length16};
use crate::pack::ExactPositions;
use crate::query::SLACK;

/// An observer of a [`Simplifier`], there from its first contraction on.
#[derive(Debug)]
pub struct Recorder {
    forest: Forest,
    /// By vertex of the input: what stands there now.
    now: Vec<LiveNode>,
    /// By face of the input: its place among the forest's faces, or [`NONE`].
    place: Vec<u32>,
    /// How many faces are left.
    live_faces: usize,
    /// The next edges are those of a face: how many are to come.
    of_face: u8,
    trouble: Option<BuildError>,
}

/// A node that stands, and what is asked of the update that will contract it.
#[derive(Clone, Copy, Debug)]
struct LiveNode {
    node: u32,
    /// Its update's; 0 for a leaf.
    level: u16,
    /// The greatest error of the updates that will need it to be split.
    error: Length16,
    radius: Length16,
}

/// Wings are stored as ranks among so many at most.
pub(crate) const MAX_RANKED: usize = 250;

impl Recorder {
    /// Ready to observe; nothing must have been contracted yet.
    pub fn new(simplifier: &Simplifier<'_>) -> Self {
        let surface = simplifier.surface();
        let vertices = surface.vertex_count();
        let ids = (0..surface.face_count()).map(FaceId::new);
        let alive: Vec<FaceId> = ids.filter(|&face| surface.is_alive(face)).collect();
        let mut place = vec![NONE; surface.face_count()];
        alive.iter().enumerate().for_each(|(i, face)| place[face.index()] = i as u32);
        let faces: Vec<_> = alive.iter().map(|&face| surface.face(face).map(|v| v.0)).collect();
        let corners = faces.iter().flatten().map(|&v| surface.position(VertexId(v)).to_array());
        let frame = Frame::new(&Bounds::of(&corners.collect::<Vec<_>>()));
        let at = |v: usize| frame.store(surface.position(VertexId::new(v))).to_array();
        let standing = |node: usize| LiveNode {
            node: node as u32,
            level: 0,
            error: Length16(0),
            radius: Length16(0),
        };
        let mut positions = Vec::with_capacity(2 * vertices);
        positions.extend((0..vertices).map(at));
        Self {
            now: (0..vertices).map(standing).collect(),
            place,
            live_faces: faces.len(),
            of_face: 0,
            trouble: None,
            forest: Forest {
                frame,
                error_kind: ErrorKind::Estimate,
                vertices,
                positions,
                exact: ExactPositions::default(),
                updates: Vec::with_capacity(vertices),
                rings: Vec::with_capacity(7 * vertices),
                created_by: vec![NONE; faces.len()],
                faces,
                non_fan_splits: BTreeMap::new(),
            },
        }
    }

    /// The same, which keeps the positions of all vertices to the bit ([`Forest::lossless`]).
    pub fn lossless(simplifier: &Simplifier<'_>) -> Self {
        let mut this = Self::new(simplifier);
        let surface = simplifier.surface();
        this.forest.exact = ExactPositions::lossless();
        for v in 0..this.forest.vertices as u32 {
            this.forest.exact.push(v, surface.position(VertexId(v)).into());
        }
        this
    }

    /// What was recorded.
    /// # Errors
    /// What has made it useless on the way.
    pub fn into_forest(self) -> Result<Forest, BuildError> {
        self.trouble.map_or(Ok(self.forest), Err)
    }

    fn is_in_step(&mut self, surface: &Surface) -> bool {
        if surface.live_faces() != self.live_faces {
            self.trouble.get_or_insert(BuildError::NotFromStart);
        }
        self.trouble.is_none()
    }

    /// The numbers of an update, and what it asks of those around.
    fn record(
        &mut self,
        hood: &Neighbourhood,
        placed: &Placed,
        run: Option<&Run>,
        open_end: Option<usize>,
    ) {
        let owner = run.map_or(1 - placed.kept, |run| run.owner);
        let [first, second] = [1 - owner, owner].map(|i| hood.contracted()[i]);
        let both = [self.now[first.index()], self.now[second.index()]];
        let ring = || hood.ring().iter().map(|r| r.id);
        let below = ring().map(|v| self.now[v.index()].level).max().unwrap_or(0);
        let level = below.max(both[0].level).max(both[1].level) + 1;
        if level == MAX_LEVELS {
            self.trouble = Some(BuildError::TooDeep);
            return;
        }
        let Ok(start) = u32::try_from(self.forest.rings.len()) else {
            self.trouble = Some(BuildError::TooLarge);
            return;
        };
        let radius = self.radius(hood, placed, &both);
        let Self { forest, now, .. } = self;
        let position = forest.frame.store(placed.position);
        let own = Length16::up(forest.frame.length(placed.error_estimate));
        let error = own.max(both[0].error).max(both[1].error);
        forest.rings.extend(ring().map(|v| now[v.index()].node));
        if let Some(end) = open_end {
            forest.rings[start as usize..].swap(end, hood.ring().len() - 1);
        }
        let wing = |place: Option<usize>| {
            place.map_or(NONE, |place| now[hood.ring()[place].id.index()].node)
        };
        let update = Update {
            children: both.map(|s| s.node),
            wings: run.map_or([NONE; 2], |run| run.wings.map(wing)),
            ring: start,
            level,
            error,
            radius,
            is_open: open_end.is_some(),
            children_swappable: run.is_some_and(|run| run.turned().takes_all(hood)),
            fused_with_child: self.of_face == 1
                && both[0].node as usize + 1 == forest.positions.len(),
        };
        let node = forest.positions.len() as u32;
        forest.updates.push(update);
        forest.positions.push(position.into());
        if update.fused_with_child {
            // One update of two contractions is needed as a whole.
            let inner = forest.updates.len() - 2;
            (forest.updates[inner].error, forest.updates[inner].radius) = (error, radius);
        }
        for v in ring() {
            let standing = &mut now[v.index()];
            standing.error = standing.error.max(error);
        }
        let kept = hood.contracted()[placed.kept];
        now[kept.index()] = LiveNode { node, level, error, radius };
        for dying in hood.dying() {
            forest.created_by[self.place[dying.face.index()] as usize] =
                node - forest.vertices as u32;
        }
    }

    /// Of a ball about the new node, around its ring and what became one, with the balls of that; around
    /// vertices of the input where they are kept to the bit, not where they are rounded to.
    fn radius(&self, hood: &Neighbourhood, placed: &Placed, both: &[LiveNode; 2]) -> Length16 {
        let center = self.forest.frame.store(placed.position).as_dvec3();
        let reach = |node: u32| center.distance_squared(self.forest.exact_stored(node));
        let ring = hood.ring().iter().map(|r| reach(self.now[r.id.index()].node));
        let ring = ring.fold(0.0, f64::max).sqrt();
        let balls = both.iter().map(|s| reach(s.node).sqrt() + s.radius.get());
        Length16::up(balls.fold(ring, f64::max) * SLACK)
    }

    /// Keeps what wings cannot tell.
    fn write_out(&mut self, surface: &Surface, hood: &Neighbourhood, owner: usize) {
        let Self { forest, now, .. } = self;
        let node = |v: VertexId| now[v.index()].node;
        let own = hood.spokes().iter().filter(|spoke| spoke.owner() == owner);
        let around =
            own.map(|spoke| [spoke.a, spoke.b].map(|at| node(hood.ring()[at as usize].id)));
        let non_fan = NonFanSplit {
            second: around.collect(),
            created_faces: hood.dying().iter().map(|d| surface.face(d.face).map(node)).collect(),
        };
        forest.non_fan_splits.insert(forest.updates.len() as u32, non_fan);
    }
}

impl Observe for Recorder {
    fn face(&mut self) {
        self.of_face = 2;
    }

    fn before(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        if !self.is_in_step(surface) {
            return;
        }
        self.live_faces -= hood.dying().len();
        let fan = open_end(hood);
        let run = fan.and_then(|_| Run::of(surface, hood, placed.kept));
        if run.is_none() {
            self.write_out(surface, hood, 1 - placed.kept);
        }
        self.record(hood, placed, run.as_ref(), fan.flatten());
        self.of_face = self.of_face.saturating_sub(1);
    }

    fn vanish(&mut self, _: &Surface, _: &[FaceId]) {
        self.trouble.get_or_insert(BuildError::Vanished);
    }
}

/// The place in the ring of the one node behind which no face follows, if there is one: the fan is
/// open there. `None` where that does not describe the faces that are left, or they are too many.
fn open_end(hood: &Neighbourhood) -> Option<Option<usize>> {
    let around = hood.ring().len();
    if around > MAX_RANKED || around > hood.spokes().len() + 1 {
        return None;
    }
    let mut followed = [false; MAX_RANKED];
    for spoke in hood.spokes() {
        if std::mem::replace(&mut followed[spoke.a as usize], true) {
            return None;
        }
    }
    Some(followed[..around].iter().position(|&followed| !followed))
}

/// Which of the two ends of an edge has its faces in one run of the new fan, and between which places
/// of the ring.
struct Run {
    owner: usize,
    /// Its start and its end, counter-clockwise; none where it starts or ends on the boundary.
    wings: [Option<usize>; 2],
}

impl Run {
    /// Preferably the end that goes. None where neither has, as next to an edge of three faces or
    /// where faces look to different sides.
    fn of(surface: &Surface, hood: &Neighbourhood, kept: usize) -> Option<Self> {
        let &[v0, v1] = &hood.contracted()[..] else { return None };
        [1 - kept, kept].into_iter().find_map(|owner| {
            let ends = if owner == 1 { [v0, v1] } else { [v1, v0] };
            let run = Self { owner, wings: wings(surface, hood, ends)? };
            run.takes_all(hood).then_some(run)
        })
    }

    /// The other end's, if its faces are one run too.
    fn turned(&self) -> Self {
        Self { owner: 1 - self.owner, wings: [self.wings[1], self.wings[0]] }
    }

    /// Whether its end's faces are the run, and no others.
    fn takes_all(&self, hood: &Neighbourhood) -> bool {
        let own = hood.spokes().iter().filter(|spoke| spoke.owner() == self.owner).count();
        self.length(hood) == Some(own)
    }

    /// How many faces a walk along the run meets before it ends; none where it meets others.
    fn length(&self, hood: &Neighbourhood) -> Option<usize> {
        let [start, end] = self.wings;
        let (mut at, stop, backwards) = match (start, end) {
            (Some(start), end) => (start, end, false),
            (None, Some(end)) => (end, None, true),
            (None, None) => return None,
        };
        let mut length = 0;
        while Some(at) != stop {
            let from = |s: &&Spoke| (if backwards { s.b } else { s.a }) as usize == at;
            let mut found = hood.spokes().iter().filter(from);
            let Some(next) = found.next() else { break };
            if found.next().is_some() || next.owner() != self.owner || length > hood.spokes().len()
            {
                return None;
            }
            at = (if backwards { next.a } else { next.b }) as usize;
            length += 1;
        }
        Some(length)
    }
}

/// Where the faces of the second end start and end, by the turn of the faces that go.
fn wings(
    surface: &Surface,
    hood: &Neighbourhood,
    [first, second]: [VertexId; 2],
) -> Option<[Option<usize>; 2]> {
    let mut wings = [None; 2];
    for dying in hood.dying() {
        let [a, b, c] = surface.face(dying.face);
        let is = |from, to| [(a, b), (b, c), (c, a)].contains(&(from, to));
        let wing = &mut wings[usize::from(!is(second, first))];
        if wing.replace(dying.apex()?).is_some() {
            return None;
        }
    }
    Some(wings)
}
