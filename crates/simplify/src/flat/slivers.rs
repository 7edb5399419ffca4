//! Faces without area, and the regions that they are part of.
//!
//! Where a flat has vertices on its rim that the one beside it lacks, a row of such faces often fills the
//! gap: a triangulation of points on one line. Its faces belong to flats around, so that the vertices
//! between these can go.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Side, Twin, UnionFind};

use crate::flat::regions::{Planes, normal};

/// Part of the tolerance below which a face is high that has no area of its own.
const FLATNESS: f64 = 0.5;

/// Part of its longest side below which such a face is high, however large the tolerance is.
const THINNESS: f64 = 1.0 / 64.0;

/// Stands for no face.
const NONE: u32 = u32::MAX;

/// Faces without area, with the face that each is joined to.
pub(super) struct Slivers<'p> {
    planes: &'p Planes<'p>,
    connectivity: &'p Connectivity,
    /// The faces in order.
    list: Vec<u32>,
    /// A face with an area, in whose plane each is.
    home: Vec<u32>,
}

/// Sides across which a face may be joined to a flat.
#[derive(Clone, Copy, PartialEq)]
enum Across {
    /// The longest one, or both others: a straight outline stays straight.
    LongestOrBoth,
    Any,
}

impl<'p> Slivers<'p> {
    pub(super) fn new(
        planes: &'p Planes<'p>,
        connectivity: &'p Connectivity,
        list: Vec<u32>,
    ) -> Self {
        Self { planes, connectivity, home: vec![NONE; list.len()], list }
    }

    /// Joins each face to a flat beside it, or beside one that has been joined. Flats in one plane on
    /// two sides of one become one.
    ///
    /// Between two rows of points on one line there is always a face that can be joined so that the
    /// outline goes on in one direction.
    ///
    /// Cost: O(n log n), n = faces without area.
    pub(super) fn join(mut self, joined: &mut UnionFind) {
        for across in [Across::LongestOrBoth, Across::Any] {
            let mut next: Vec<usize> = (0..self.list.len()).rev().collect();
            while let Some(i) = next.pop() {
                if self.home[i] == NONE && self.settle(i, across, joined) {
                    next.extend(self.beside(i));
                }
            }
        }
        for (i, &face) in self.list.iter().enumerate().filter(|(i, _)| self.home[*i] != NONE) {
            for side in self.sides(face) {
                let Twin::Side(twin) = self.connectivity.twin(side) else { continue };
                let [home, other] = [self.home[i], self.home_of(twin.face().0)];
                if other != NONE
                    && joined.find(other) != joined.find(home)
                    && self.planes.takes(home, side, twin)
                    && self.planes.is_same_plane(home, other)
                {
                    joined.union(home, other);
                }
            }
        }
    }

    /// Joins a face to a flat, if that is possible.
    fn settle(&mut self, i: usize, across: Across, joined: &mut UnionFind) -> bool {
        let [longest, second, third] = self.sides(self.list[i]).map(|side| self.home_across(side));
        let is_ear = second != NONE && third != NONE && joined.find(second) == joined.find(third);
        let home = match across {
            _ if longest != NONE => longest,
            Across::Any if second == NONE => third,
            Across::LongestOrBoth if !is_ear => NONE,
            _ => second,
        };
        if home != NONE {
            self.home[i] = home;
            joined.union(self.list[i], home);
        }
        home != NONE
    }

    /// Returns the faces beside one that are in the list.
    fn beside(&self, i: usize) -> impl Iterator<Item = usize> {
        let twins = self.sides(self.list[i]).map(|side| match self.connectivity.twin(side) {
            Twin::Side(twin) => self.list.binary_search(&twin.face().0).ok(),
            _ => None,
        });
        twins.into_iter().flatten()
    }

    /// Returns the face that a face without area would be joined to across one of its sides.
    fn home_across(&self, side: Side) -> u32 {
        let Twin::Side(twin) = self.connectivity.twin(side) else { return NONE };
        match self.home_of(twin.face().0) {
            home if home != NONE && self.planes.takes(home, twin, side) => home,
            _ => NONE,
        }
    }

    /// Returns a face with an area in the plane of one, which may be that one.
    fn home_of(&self, face: u32) -> u32 {
        self.list.binary_search(&face).map_or(face, |i| self.home[i])
    }

    /// Returns the sides of a face, the longest first.
    fn sides(&self, face: u32) -> [Side; 3] {
        let mesh = self.planes.mesh;
        let length = |side: &Side| {
            let [a, b] = side.ends(&mesh.faces).map(|v| mesh.positions[v.index()]);
            DVec3::from(a).distance_squared(b.into())
        };
        let mut sides = [0, 1, 2].map(|k| Side::new(FaceId(face), k));
        sides.sort_by(|a, b| length(b).total_cmp(&length(a)));
        sides
    }
}

impl Planes<'_> {
    /// Returns true if a face has no area, to the tolerance.
    pub(super) fn is_sliver(&self, face: u32) -> bool {
        let twice_area = normal(self.mesh, face).length();
        if self.tolerance == 0.0 || twice_area == 0.0 {
            return twice_area == 0.0;
        }
        let [a, b, c] = self.mesh.triangle(self.mesh.faces[face as usize]);
        let longest = [a.distance(b), b.distance(c), c.distance(a)].into_iter().fold(0.0, f64::max);
        twice_area <= longest * (FLATNESS * self.tolerance).min(THINNESS * longest)
    }

    /// Returns true if a face without area continues the one with an area that it is to be joined to,
    /// across a side of the latter or of a face that has been joined to it.
    fn takes(&self, home: u32, side: Side, twin: Side) -> bool {
        let [ends, of_twin] = [side, twin].map(|side| side.ends(&self.mesh.faces));
        ends == [of_twin[1], of_twin[0]]
            && self.is_alike([home, twin.face().0])
            && self.contains(home, self.opposite(twin))
            && self.linear.is_linear_beyond(Side::new(FaceId(home), 0), side, twin)
    }
}
