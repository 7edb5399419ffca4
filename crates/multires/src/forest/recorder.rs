//! Records the contraction forest while the simplification runs.
//!
//! Everything that must be monotone along dependencies is made so here, on the way up and in
//! constant time per neighbour. An update is recorded before the updates it depends on, so each
//! vertex carries the requirements of its neighbours to the update that will contract it.

use std::collections::BTreeMap;

use glam::DVec3;
use meshlod_mesh::{Bounds, FaceId, Frame, VertexId};
use meshlod_simplify::{Neighbourhood, Observe, Placed, Simplifier, Spoke, Surface};

use crate::error_kind::ErrorKind;
use crate::forest::{BuildError, Forest, MAX_LEVELS, NONE, NonFanSplit, Stage, Update};
use crate::length16::Length16;
use crate::pack::ExactPositions;
use crate::query::SLACK;
use crate::wedges::WedgeRecorder;

/// Observer that records the contractions of a [`Simplifier`], from the first one on.
#[derive(Debug)]
pub struct Recorder {
    forest: Forest,
    /// Wedges, if the mesh has attributes, materials or objects.
    wedges: Option<WedgeRecorder>,
    /// Live node by input vertex.
    live: Vec<LiveNode>,
    /// Index among the forest's faces by input face, or [`NONE`]; empty if it has all of them.
    forest_face: Vec<u32>,
    /// Number of faces left.
    live_faces: usize,
    /// Number of edge contractions still to come of a face contraction.
    face_edges_left: u8,
    failure: Option<BuildError>,
}

/// Returns for each leaf whether a face uses it.
pub(crate) fn used_leaves(faces: &[[u32; 3]], leaves: usize) -> Vec<bool> {
    let mut is_used = vec![false; leaves];
    faces.iter().flatten().for_each(|&leaf| is_used[leaf as usize] = true);
    is_used
}

/// A live node, and what the update that contracts it has to satisfy.
#[derive(Clone, Copy, Debug)]
struct LiveNode {
    node: u32,
    /// Level of its update; 0 for a leaf.
    level: u16,
    /// Greatest error of the recorded updates that depend on the split creating this node.
    error: Length16,
    radius: Length16,
}

/// Largest ring within which wings are stored as ranks.
pub(crate) const MAX_RANKED: usize = 250;

impl Recorder {
    /// Creates a recorder for a simplifier, which must not have contracted anything yet.
    pub fn new(simplifier: &Simplifier<'_>) -> Self {
        let surface = simplifier.surface();
        let vertices = surface.vertex_count();
        let ids = (0..surface.face_count()).map(FaceId::new);
        let alive: Vec<FaceId> = ids.filter(|&face| surface.is_alive(face)).collect();
        let some = if alive.len() < surface.face_count() { surface.face_count() } else { 0 };
        let mut forest_face = vec![NONE; some];
        let numbers = alive.iter().enumerate().filter(|_| some > 0);
        numbers.for_each(|(i, face)| forest_face[face.index()] = i as u32);
        let faces: Vec<_> = alive.iter().map(|&face| surface.face(face).map(|v| v.0)).collect();
        let used = used_leaves(&faces, vertices).into_iter().enumerate().filter(|(_, used)| *used);
        let places = used.map(|(v, _)| surface.position(VertexId::new(v)).to_array());
        let frame = Frame::of_diagonal(&Bounds::of(&places.collect::<Vec<_>>()));
        let at = |v: usize| frame.local(surface.position(VertexId::new(v))).as_vec3().to_array();
        let standing = |node: usize| LiveNode {
            node: node as u32,
            level: 0,
            error: Length16(0),
            radius: Length16(0),
        };
        let mut positions = Vec::with_capacity(2 * vertices);
        positions.extend((0..vertices).map(at));
        Self {
            wedges: WedgeRecorder::new(simplifier, &alive),
            live: (0..vertices).map(standing).collect(),
            forest_face,
            live_faces: faces.len(),
            face_edges_left: 0,
            failure: None,
            forest: Forest {
                frame,
                error_kind: ErrorKind::Estimate,
                vertices,
                positions,
                exact: ExactPositions::default(),
                updates: Vec::with_capacity(vertices),
                // 7.4 nodes on the way to nothing, on terrains and scans.
                rings: Vec::with_capacity(15 * vertices / 2),
                created_by: vec![NONE; faces.len()],
                faces,
                wedges: None,
                non_fan_splits: BTreeMap::new(),
                posing: None,
            },
        }
    }

    /// Creates a recorder that also keeps the exact positions of all vertices, as
    /// [`Forest::lossless`] does.
    pub fn lossless(simplifier: &Simplifier<'_>) -> Self {
        let mut this = Self::new(simplifier);
        let surface = simplifier.surface();
        this.forest.exact = ExactPositions::lossless();
        for v in 0..this.forest.vertices as u32 {
            this.forest.exact.push(v, surface.position(VertexId(v)).into());
        }
        this
    }

    /// Ends the recording and returns the forest of contractions.
    /// # Errors
    /// What made the record unusable on the way.
    pub fn into_forest(self) -> Result<Forest, BuildError> {
        let wedges = self.wedges.map(WedgeRecorder::finish);
        let forest = Forest { wedges, ..self.forest };
        self.failure.map_or(Ok(forest.with_stages()), Err)
    }

    fn is_complete(&mut self, surface: &Surface) -> bool {
        if surface.live_faces() != self.live_faces {
            self.failure.get_or_insert(BuildError::NotFromStart);
        }
        self.failure.is_none()
    }

    /// Records an update, and passes its requirements on to its ring.
    fn record(
        &mut self,
        hood: &Neighbourhood,
        placed: &Placed,
        run: Option<&Run>,
        open_end: Option<usize>,
    ) {
        let owner = run.map_or(1 - placed.kept, |run| run.owner);
        let [first, second] = [1 - owner, owner].map(|i| hood.contracted()[i]);
        let both = [self.live[first.index()], self.live[second.index()]];
        let ring = || hood.ring().iter().map(|r| r.id);
        let below = ring().map(|v| self.live[v.index()].level).max().unwrap_or(0);
        let level = below.max(both[0].level).max(both[1].level) + 1;
        if level == MAX_LEVELS {
            self.failure = Some(BuildError::TooDeep);
            return;
        }
        let Ok(start) = u32::try_from(self.forest.rings.len()) else {
            self.failure = Some(BuildError::TooLarge);
            return;
        };
        let radius = self.radius(hood, placed, &both);
        let Self { forest, live, .. } = self;
        let own = Length16::up(forest.frame.local_length(placed.error_estimate));
        let error = own.max(both[0].error).max(both[1].error);
        forest.rings.extend(ring().map(|v| live[v.index()].node));
        if let Some(end) = open_end {
            forest.rings[start as usize..].swap(end, hood.ring().len() - 1);
        }
        let wing = |place: Option<usize>| {
            place.map_or(NONE, |place| live[hood.ring()[place].id.index()].node)
        };
        let update = Update {
            children: both.map(|s| s.node),
            wings: run.map_or([NONE; 2], |run| run.wings.map(wing)),
            ring: start,
            level,
            error,
            radius,
            stage: Stage::default(),
            is_open: open_end.is_some(),
            children_swappable: run.is_some_and(|run| run.other_end().holds_its_faces(hood)),
            fused_with_child: self.face_edges_left == 1
                && both[0].node as usize + 1 == forest.positions.len(),
        };
        let node = forest.positions.len() as u32;
        forest.add(update, placed.position);
        for v in ring() {
            let standing = &mut live[v.index()];
            standing.error = standing.error.max(error);
        }
        let kept = hood.contracted()[placed.kept];
        live[kept.index()] = LiveNode { node, level, error, radius };
        for removed in hood.removed_faces() {
            let face = self.forest_face.get(removed.face.index());
            let face = face.map_or(removed.face.index(), |&face| face as usize);
            forest.created_by[face] = node - forest.vertices as u32;
        }
    }

    /// Returns the radius of the update's ball: about the new node, around its ring and the balls
    /// of both children, and around exact positions where they are known.
    fn radius(&self, hood: &Neighbourhood, placed: &Placed, both: &[LiveNode; 2]) -> Length16 {
        let center = self.forest.frame.local(placed.position).as_vec3().as_dvec3();
        let reach = |node: u32| center.distance_squared(self.forest.exact_stored(node));
        let ring = hood.ring().iter().map(|r| reach(self.live[r.id.index()].node));
        let ring = ring.fold(0.0, f64::max).sqrt();
        let balls = both.iter().map(|s| reach(s.node).sqrt() + s.radius.get());
        Length16::up(balls.fold(ring, f64::max) * SLACK)
    }

    /// Keeps the faces of a split that wings cannot describe.
    fn record_non_fan(&mut self, surface: &Surface, hood: &Neighbourhood, owner: usize) {
        let Self { forest, live, .. } = self;
        let node = |v: VertexId| live[v.index()].node;
        let own = hood.spokes().iter().filter(|spoke| spoke.owner() == owner);
        let around =
            own.map(|spoke| [spoke.a, spoke.b].map(|at| node(hood.ring()[at as usize].id)));
        let non_fan = NonFanSplit {
            second: around.collect(),
            created_faces: hood
                .removed_faces()
                .iter()
                .map(|d| surface.face(d.face).map(node))
                .collect(),
        };
        forest.non_fan_splits.insert(forest.updates.len() as u32, non_fan);
    }
}

impl Forest {
    /// Adds an update and its new node, at a position in model units.
    fn add(&mut self, update: Update, position: DVec3) {
        let node = self.positions.len() as u32;
        let is_there = |exact: &[f64; 3]| *exact == position.to_array();
        let mut children = update.children.iter();
        let unmoved = children.find_map(|&child| self.exact.get(child).filter(is_there));
        self.positions.push(self.frame.local(position).as_vec3().into());
        if let Some(exact) = unmoved {
            self.exact.push(node, exact);
        }
        self.updates.push(update);
        if update.fused_with_child {
            // The two contractions of a face are judged as one.
            let inner = self.updates.len() - 2;
            (self.updates[inner].error, self.updates[inner].radius) = (update.error, update.radius);
        }
    }
}

impl Observe for Recorder {
    fn face(&mut self) {
        self.face_edges_left = 2;
    }

    fn before(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        if !self.is_complete(surface) {
            return;
        }
        self.live_faces -= hood.removed_faces().len();
        if let Some(wedges) = &mut self.wedges {
            wedges.before(surface, hood, |v| self.live[v.index()].node);
        }
        let fan = open_end(hood);
        let run = fan.and_then(|_| Run::of(surface, hood, placed.kept));
        if run.is_none() {
            self.record_non_fan(surface, hood, 1 - placed.kept);
        }
        self.record(hood, placed, run.as_ref(), fan.flatten());
        self.face_edges_left = self.face_edges_left.saturating_sub(1);
    }

    fn after(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let Self { forest, wedges: Some(wedges), failure: None, .. } = self else { return };
        let number = forest.updates.len() as u32 - 1;
        let is_fan = !forest.non_fan_splits.contains_key(&number);
        let children = forest.updates[number as usize].children;
        wedges.after(surface, hood, placed, (number, children, is_fan));
    }

    fn vanish(&mut self, _: &Surface, _: &[FaceId]) {
        self.failure.get_or_insert(BuildError::Vanished);
    }
}

/// Returns the ring index of the node that no face follows, at which the fan is open, or an inner
/// `None` for a closed fan. Returns an outer `None` if the remaining faces are no fan, or too many:
/// where two of them follow one node or precede it.
fn open_end(hood: &Neighbourhood) -> Option<Option<usize>> {
    let around = hood.ring().len();
    if around > MAX_RANKED || around > hood.spokes().len() + 1 {
        return None;
    }
    let (mut followed, mut preceded) = ([false; MAX_RANKED], [false; MAX_RANKED]);
    for spoke in hood.spokes() {
        let (a, b) = (&mut followed[spoke.a as usize], &mut preceded[spoke.b as usize]);
        if std::mem::replace(a, true) || std::mem::replace(b, true) {
            return None;
        }
    }
    Some(followed[..around].iter().position(|&followed| !followed))
}

/// Contiguous run of the new fan that holds exactly the faces of one end of the edge.
struct Run {
    owner: usize,
    /// Ring indices of its start and its end, counter-clockwise; `None` at the boundary.
    wings: [Option<usize>; 2],
}

impl Run {
    /// Finds the run of one end, the removed one if possible. Returns `None` if neither end has
    /// one, as next to an edge of three faces or where orientations disagree.
    fn of(surface: &Surface, hood: &Neighbourhood, kept: usize) -> Option<Self> {
        let &[v0, v1] = &hood.contracted()[..] else { return None };
        [1 - kept, kept].into_iter().find_map(|owner| {
            let ends = if owner == 1 { [v0, v1] } else { [v1, v0] };
            let run = Self { owner, wings: wings(surface, hood, ends)? };
            run.holds_its_faces(hood).then_some(run)
        })
    }

    /// Returns the run of the other end, assuming that its faces form one.
    fn other_end(&self) -> Self {
        Self { owner: 1 - self.owner, wings: [self.wings[1], self.wings[0]] }
    }

    /// Returns true if the run holds exactly the faces of its end.
    fn holds_its_faces(&self, hood: &Neighbourhood) -> bool {
        let own = hood.spokes().iter().filter(|spoke| spoke.owner() == self.owner).count();
        self.length(hood) == Some(own)
    }

    /// Returns the number of faces along the run, or `None` if it meets faces of the other end.
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

/// Returns the ring indices between which the second end's faces lie, from the orientation of the
/// removed faces.
fn wings(
    surface: &Surface,
    hood: &Neighbourhood,
    [first, second]: [VertexId; 2],
) -> Option<[Option<usize>; 2]> {
    let mut wings = [None; 2];
    for removed in hood.removed_faces() {
        let [a, b, c] = surface.face(removed.face);
        let is = |from, to| [(a, b), (b, c), (c, a)].contains(&(from, to));
        let wing = &mut wings[usize::from(!is(second, first))];
        if wing.replace(removed.apex()?).is_some() {
            return None;
        }
    }
    Some(wings)
}
