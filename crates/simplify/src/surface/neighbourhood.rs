//! The faces and vertices around a candidate for contraction, gathered once and shared by all
//! policies.
//!
//! ```text
//!          vl              v0 v1   contracted
//!        / || \            vl vr   wings: apexes of the removed faces
//!   a --v0-||--v1-- b      a b …   the rest of the ring
//!        \ || /            faces v0 a vl …: spokes, they survive with v0, v1 replaced
//!          vr
//! ```

use glam::DVec3;
use meshlod_mesh::{FaceId, VertexId, WedgeId};

use crate::refusal::Refusal;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::ties;
use crate::surface::{Flags, Surface, corner_of};

/// A face that survives a contraction: one of its corners is contracted, the other two are on the
/// ring.
#[derive(Clone, Copy, Debug)]
pub struct Spoke {
    /// Id of the surviving face.
    pub face: FaceId,
    /// Index in the ring of the corner that follows the contracted one.
    pub a: u32,
    /// Index in the ring of the corner that follows `a`.
    pub b: u32,
    corner: u8,
    owner: u8,
}

impl Spoke {
    /// Returns the index of the face's corner that is contracted.
    #[inline]
    pub fn corner(&self) -> usize {
        self.corner.into()
    }

    /// Returns the index, among the contracted vertices, of the one that is a corner of this face.
    #[inline]
    pub fn owner(&self) -> usize {
        self.owner.into()
    }
}

/// A face that a contraction removes: two or all three of its corners are contracted.
#[derive(Clone, Copy, Debug)]
pub struct RemovedFace {
    /// Id of the face to be removed.
    pub face: FaceId,
    apex: u32,
}

impl RemovedFace {
    const NO_APEX: u32 = u32::MAX;

    /// Returns the index in the ring of the face's corner that is not contracted, called a wing;
    /// `None` if all three are contracted.
    #[inline]
    pub fn apex(&self) -> Option<usize> {
        (self.apex != Self::NO_APEX).then_some(self.apex as usize)
    }
}

/// A vertex of the ring: a neighbour of a contracted vertex.
#[derive(Clone, Copy, Debug)]
pub struct RingVertex {
    /// Id of the ring vertex.
    pub id: VertexId,
    /// Position of the ring vertex, in model units.
    pub position: DVec3,
    /// Bit mask of the contracted vertices to which an edge leads from here.
    pub(crate) adjacent: u8,
    /// Bit mask of the ends of the contracted edges that have this vertex as a wing.
    pub(crate) wing: u8,
}

/// The faces and vertices around a candidate for contraction; one instance is reused for all
/// candidates.
#[derive(Default)]
pub struct Neighbourhood {
    pub(crate) contracted: Contracted,
    pub(crate) freedom: Freedom,
    /// True if the contraction was decided elsewhere, which also gives the values of wedges.
    pub(crate) is_decided: bool,
    pub(crate) spokes: Vec<Spoke>,
    pub(crate) removed_faces: Vec<RemovedFace>,
    pub(crate) ring: Vec<RingVertex>,
    /// Wedges that meet along the contracted edge, at its first end and at its second.
    pub(crate) wedge_pairs: Vec<[WedgeId; 2]>,
    /// Edges that must be contracted together with this one, because their ends are tied.
    pub(crate) partners: Vec<[VertexId; 2]>,
    /// Scratch space: the faces around, with the contracted vertex at which they were found and
    /// their vertices.
    star: Vec<(FaceId, u8, [VertexId; 3])>,
}

impl Neighbourhood {
    /// Returns the vertices that the contraction merges: two for an edge, three for a face.
    pub fn contracted(&self) -> &Contracted {
        &self.contracted
    }

    /// Returns the faces around the contraction that survive it.
    pub fn spokes(&self) -> &[Spoke] {
        &self.spokes
    }

    /// Returns the faces that the contraction removes.
    pub fn removed_faces(&self) -> &[RemovedFace] {
        &self.removed_faces
    }

    /// Returns the ring: the neighbours of the contracted vertices.
    pub fn ring(&self) -> &[RingVertex] {
        &self.ring
    }

    /// Returns the distance of the farthest ring vertex from a position.
    pub(crate) fn radius(&self, from: DVec3) -> f64 {
        self.ring.iter().map(|r| r.position.distance_squared(from)).fold(0.0, f64::max).sqrt()
    }

    /// Returns true if the surviving faces form a closed ring; only then is there a volume to
    /// conserve.
    #[inline]
    pub(crate) fn is_closed(&self, surface: &Surface) -> bool {
        !self.contracted.iter().any(|&v| surface.flags(v).any(Flags::BOUNDARY))
    }

    /// Returns the freedom in placing the new vertex of the contraction.
    pub fn freedom(&self) -> Freedom {
        self.freedom
    }

    /// Gathers the faces and vertices around the contraction of `contracted`; refuses it if locks,
    /// ties or seams forbid it.
    pub(crate) fn gather(
        &mut self,
        surface: &Surface,
        contracted: Contracted,
    ) -> Result<(), Refusal> {
        self.clear(contracted);
        if surface.is_crowded(&contracted) {
            return Err(Refusal::Valence);
        }
        let Self { wedge_pairs, partners, .. } = self;
        self.freedom = freedom(surface, &contracted, wedge_pairs, partners)?;
        self.look_around(surface);
        Ok(())
    }

    /// Gathers the faces and vertices around an edge whose contraction was decided elsewhere;
    /// nothing is refused, and the values of wedges are left to the caller.
    pub(crate) fn gather_decided(
        &mut self,
        surface: &Surface,
        edge: [VertexId; 2],
        freedom: Freedom,
    ) {
        self.clear(Contracted::edge(edge));
        self.is_decided = true;
        self.freedom = freedom;
        self.partners.clear();
        self.wedge_pairs.clear();
        if let Some(wedges) = &surface.wedges {
            wedges.pair(surface, edge, &mut self.wedge_pairs);
        }
        self.look_around(surface);
    }

    fn clear(&mut self, contracted: Contracted) {
        self.contracted = contracted;
        self.is_decided = false;
        self.spokes.clear();
        self.removed_faces.clear();
        self.ring.clear();
    }

    fn look_around(&mut self, surface: &Surface) {
        // Short loops of independent loads: most of the time here is memory latency.
        self.star.clear();
        for (owner, &v) in self.contracted.iter().enumerate() {
            let star = surface.star(v);
            self.star.extend(star.map(|face| (face, owner as u8, surface.face(face))));
        }
        for i in 0..self.star.len() {
            let (face, owner, corners) = self.star[i];
            self.add(face, owner.into(), corners);
        }
        for r in &mut self.ring {
            r.position = surface.position(r.id);
        }
    }

    #[inline]
    fn add(&mut self, face: FaceId, owner: usize, corners: [VertexId; 3]) {
        let corner = corner_of(corners, self.contracted[owner]);
        let (a, b) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
        let bit = |v: VertexId| {
            self.contracted.iter().position(|&other| other == v).map_or(0, |i| 1u8 << i)
        };
        let (bit_a, bit_b) = (bit(a), bit(b));
        let mask = 1 << owner | bit_a | bit_b;
        if bit_a | bit_b == 0 {
            let (a, b) = (self.ring_place(a, mask, 0), self.ring_place(b, mask, 0));
            self.spokes.push(Spoke { face, a, b, corner: corner as u8, owner: owner as u8 });
        } else if mask.trailing_zeros() as usize == owner {
            // Each removed face is added once, by the first of its contracted corners.
            let apex = match (bit_a, bit_b) {
                (0, _) => self.ring_place(a, mask, mask),
                (_, 0) => self.ring_place(b, mask, mask),
                _ => RemovedFace::NO_APEX,
            };
            self.removed_faces.push(RemovedFace { face, apex });
        }
    }

    /// The linear search is short because [`Surface::is_crowded`] limits the ring.
    #[inline]
    fn ring_place(&mut self, id: VertexId, adjacent: u8, wing: u8) -> u32 {
        if let Some(place) = self.ring.iter().position(|r| r.id == id) {
            self.ring[place].adjacent |= adjacent;
            self.ring[place].wing |= wing;
            return place as u32;
        }
        self.ring.push(RingVertex { id, position: DVec3::ZERO, adjacent, wing });
        self.ring.len() as u32 - 1
    }
}

/// Determines the freedom in placing the new vertex, which wedges meet along an edge, and which
/// other edges ties contract with it.
pub(crate) fn freedom(
    surface: &Surface,
    contracted: &Contracted,
    wedge_pairs: &mut Vec<[WedgeId; 2]>,
    partners: &mut Vec<[VertexId; 2]>,
) -> Result<Freedom, Refusal> {
    wedge_pairs.clear();
    partners.clear();
    let mut pinned = None;
    let mut seam = false;
    let mut tied = false;
    // A face has no edge to slide along a boundary or a tie, so it is contracted onto its corner
    // there, which may still move along the surface's normal at a boundary.
    let pins = if contracted.len() == 2 { Flags::PINNED } else { PINS_OF_FACE };
    for (i, &v) in contracted.iter().enumerate() {
        let flags = surface.flags(v);
        seam |= flags.any(Flags::SEAM);
        tied |= flags.any(Flags::TIED);
        if flags.any(pins) && pinned.replace(i).is_some() {
            return Err(match flags {
                _ if flags.any(Flags::PINNED) => Refusal::Locked,
                _ if flags.any(Flags::TIED) => Refusal::Tied,
                _ => Refusal::Boundary,
            });
        }
    }
    let by_pin = match pinned {
        None => Freedom::Free,
        Some(i) if surface.flags(contracted[i]).any(Flags::PINNED.or(Flags::TIED)) => {
            Freedom::At(i)
        }
        Some(i) => Freedom::AlongNormal(i),
    };
    let by_tie = match contracted[..] {
        [v0, v1] if tied => ties::partners(surface, [v0, v1], partners)?,
        _ => Freedom::Free,
    };
    let by_seam = match (&surface.wedges, &contracted[..]) {
        (Some(wedges), &[v0, v1]) => {
            wedges.pair(surface, [v0, v1], wedge_pairs);
            if seam { wedges.freedom(surface, [v0, v1], wedge_pairs)? } else { Freedom::Free }
        }
        (Some(wedges), corners) if seam => wedges.freedom_of_face(surface, corners, wedge_pairs)?,
        _ => Freedom::Free,
    };
    by_pin.and(by_tie).ok_or(Refusal::Tied)?.and(by_seam).ok_or(Refusal::Seam)
}

/// Flags of a corner that a face is contracted onto.
const PINS_OF_FACE: Flags = Flags::PINNED.or(Flags::BOUNDARY).or(Flags::TIED);
