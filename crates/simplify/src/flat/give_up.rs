//! Regions that stay as they are, where they cannot be filled.

use meshlod_mesh::Mesh;

use crate::flat::regions::Regions;

/// Number of times that only those regions stay as they are that cannot be filled. A region that stays
/// holds its outline, and the ones beside it may fail in turn. So the ones around it stay, too, from
/// then on, twice as far each time.
const ALONE: usize = 6;

/// How often regions turned out to stay as they are.
#[derive(Debug, Default)]
pub(super) struct GivenUp {
    times: usize,
}

impl GivenUp {
    /// Keeps regions as they are, and those around them if others have failed often.
    pub(super) fn give_up(&mut self, mesh: &Mesh, regions: &mut Regions, failed: Vec<usize>) {
        let steps = match self.times.checked_sub(ALONE) {
            None => 0,
            Some(often) => 1usize << often.min(32),
        };
        self.times += 1;
        let mut around = Vec::new();
        if steps > 0 {
            around = within(mesh, regions, &failed, steps);
        }
        for r in failed.into_iter().chain(around) {
            regions.list[r].is_kept = true;
        }
    }
}

/// Returns the regions to be filled that are no more than some steps from others, each over a vertex
/// that two have.
fn within(mesh: &Mesh, regions: &Regions, from: &[usize], steps: usize) -> Vec<usize> {
    let mut at: Vec<(u32, u32)> = Vec::with_capacity(3 * mesh.faces.len());
    for (face, &region) in mesh.faces.iter().zip(&regions.of_face) {
        if !regions.list[region as usize].is_kept {
            at.extend(face.map(|v| (v.0, region)));
        }
    }
    at.sort_unstable();
    at.dedup();
    let first = |v: u32| at.partition_point(|&(at, _)| at < v);
    let mut is_found = vec![false; regions.list.len()];
    let mut is_done = vec![false; mesh.positions.len()];
    let (mut all, mut front) = (Vec::new(), from.to_vec());
    front.iter().for_each(|&r| is_found[r] = true);
    for _ in 0..steps {
        let mut next = Vec::new();
        let faces = front.iter().flat_map(|&r| &regions.list[r].faces);
        for v in faces.flat_map(|&face| mesh.faces[face as usize]) {
            if std::mem::replace(&mut is_done[v.index()], true) {
                continue;
            }
            for &(_, r) in at[first(v.0)..].iter().take_while(|(at, _)| *at == v.0) {
                if !std::mem::replace(&mut is_found[r as usize], true) {
                    next.push(r as usize);
                }
            }
        }
        if next.is_empty() {
            break;
        }
        all.extend_from_slice(&next);
        front = next;
    }
    all
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::mesh;

    use super::*;
    use crate::flat::regions::Region;

    #[test]
    fn regions_around_stay_twice_as_far_each_time() {
        // A strip of faces, each a region of its own.
        let count = 64;
        let places: Vec<[f64; 3]> =
            (0..count + 2).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
        let faces: Vec<[u32; 3]> = (0..count).map(|i| [i, i + 1, i + 2]).collect();
        let strip = mesh(&places, &faces);
        let of = |face: u32| Region { faces: vec![face], ..Region::default() };
        let list = (0..count).map(of).collect();
        let mut regions = Regions { of_face: (0..count).collect(), list };
        let mut given_up = GivenUp::default();
        let mut kept = Vec::new();
        for _ in 0..ALONE + 5 {
            let free = regions.list.iter().position(|region| !region.is_kept);
            given_up.give_up(&strip, &mut regions, free.into_iter().collect());
            kept.push(regions.list.iter().filter(|region| region.is_kept).count());
        }
        // Two faces to each side have a vertex of one.
        assert_eq!(kept, [1, 2, 3, 4, 5, 6, 9, 14, 23, 40, 64]);
    }
}
