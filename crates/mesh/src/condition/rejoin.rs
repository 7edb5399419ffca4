//! Copies that have not moved become one vertex again.

use std::collections::HashMap;

use crate::condition::carry::Change;
use crate::condition::suspects::is_whole;
use crate::{Mesh, UnionFind, VertexId, merge_equal_wedges};

/// Bits of a position; -0 counts as 0.
type Key = [u64; 3];

fn key(position: [f64; 3]) -> Key {
    position.map(|x| (x + 0.0).to_bits())
}

/// Places at which vertices have been split.
#[derive(Clone, Debug)]
pub(super) struct Joints {
    index: HashMap<Key, u32>,
    /// For each place the vertices there in order: vertices with equal numbers were one.
    joints: Vec<Vec<u32>>,
}

impl Joints {
    /// Finds the places of all vertices that have been split, in the mesh after the change.
    pub(super) fn new(mesh: &Mesh, change: &Change) -> Self {
        let mut this = Self { index: HashMap::new(), joints: Vec::new() };
        for of in &change.copies {
            let next = this.joints.len() as u32;
            let place = *this.index.entry(key(mesh.positions[of.index()])).or_insert(next);
            if place == next {
                this.joints.push(Vec::new());
            }
        }
        if this.joints.is_empty() {
            return this;
        }
        let mut joined = UnionFind::new(mesh.positions.len());
        for [before, now] in &change.parted {
            joined.union(before.0, now.0);
        }
        let mut is_used = vec![false; mesh.positions.len()];
        for face in mesh.faces.iter().filter(|face| is_whole(**face)) {
            face.iter().for_each(|v| is_used[v.index()] = true);
        }
        for (v, position) in mesh.positions.iter().enumerate().filter(|&(v, _)| is_used[v]) {
            if let Some(&place) = this.index.get(&key(*position)) {
                this.joints[place as usize].push(joined.find(v as u32));
            }
        }
        this
    }

    /// Makes one vertex of those that were one, where they have not moved.
    pub(super) fn rejoin(&self, level: &mut Mesh) {
        let mut here: Vec<Vec<u32>> = vec![Vec::new(); self.joints.len()];
        for (v, position) in level.positions.iter().enumerate() {
            if let Some(&place) = self.index.get(&key(*position)) {
                here[place as usize].push(v as u32);
            }
        }
        let mut into: Vec<u32> = (0..level.positions.len() as u32).collect();
        for (were, now) in self.joints.iter().zip(&here) {
            join_at(were, now, &mut into);
        }
        keep_faces_whole(level, &mut into);
        if into.iter().enumerate().all(|(v, &to)| v == to as usize) {
            return;
        }
        for v in level.faces.as_flattened_mut() {
            v.0 = into[v.index()];
        }
        merge_equal_wedges(level);
        level.compact();
    }
}

/// Joins the vertices that are at one place now, given the numbers of all that were there.
fn join_at(were: &[u32], now: &[u32], into: &mut [u32]) {
    let is_one = were.iter().all(|number| *number == were[0]);
    if !is_one && were.len() != now.len() {
        return;
    }
    let mut first: HashMap<u32, u32> = HashMap::new();
    for (i, &v) in now.iter().enumerate() {
        let number = if is_one { were[0] } else { were[i] };
        into[v as usize] = *first.entry(number).or_insert(v);
    }
}

/// Takes back the joins of corners of one face.
fn keep_faces_whole(level: &Mesh, into: &mut [u32]) {
    let mut is_apart = vec![false; into.len()];
    for face in level.faces.iter().filter(|face| is_whole(**face)) {
        let now = face.map(|v| VertexId(into[v.index()]));
        if !is_whole(now) {
            now.iter().for_each(|v| is_apart[v.index()] = true);
        }
    }
    for (v, to) in into.iter_mut().enumerate() {
        if is_apart[*to as usize] {
            *to = v as u32;
        }
    }
}
