//! Reordering for the GPU's vertex cache: neighbouring triangles in sequence, vertices in the order
//! of first use.
//!
//! This order also helps index codecs.

/// Number of recently used vertices that are scored. The index codec remembers 16 edges and 16
/// vertices.
const CACHE: usize = 16;

/// Sorts triangles for the vertex cache and renumbers their vertices by first use; returns the old
/// number of each new vertex.
///
/// Greedy, after Forsyth: the next triangle is the one whose vertices were used most recently and
/// have the fewest triangles left. Cost: O(n).
pub(crate) fn arrange(triangles: &mut [[u32; 3]], vertex_count: usize) -> Vec<u32> {
    let order = Greedy::new(triangles, vertex_count).run();
    let sorted: Vec<[u32; 3]> = order.iter().map(|&t| triangles[t as usize]).collect();
    triangles.copy_from_slice(&sorted);
    number_by_use(triangles, vertex_count)
}

/// Renumbers vertices by first use and returns the old number of each new one.
fn number_by_use(triangles: &mut [[u32; 3]], vertex_count: usize) -> Vec<u32> {
    let mut new = vec![u32::MAX; vertex_count];
    let mut old = Vec::with_capacity(vertex_count);
    for vertex in triangles.as_flattened_mut() {
        let number = &mut new[*vertex as usize];
        if *number == u32::MAX {
            *number = old.len() as u32;
            old.push(*vertex);
        }
        *vertex = *number;
    }
    old
}

struct Greedy<'a> {
    triangles: &'a [[u32; 3]],
    /// Start of each vertex's triangles in `around`.
    first: Vec<u32>,
    /// Number of unsorted triangles of each vertex; `around` lists those first.
    left: Vec<u32>,
    around: Vec<u32>,
    done: Vec<bool>,
    /// Recently used vertices, newest first.
    cache: Vec<u32>,
}

impl<'a> Greedy<'a> {
    fn new(triangles: &'a [[u32; 3]], vertex_count: usize) -> Self {
        let mut left = vec![0u32; vertex_count];
        for &vertex in triangles.as_flattened() {
            left[vertex as usize] += 1;
        }
        let mut sum = 0;
        let first: Vec<u32> = left
            .iter()
            .map(|count| {
                sum += count;
                sum - count
            })
            .collect();
        let mut around = vec![0; 3 * triangles.len()];
        let mut at = first.clone();
        for (t, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                around[at[vertex as usize] as usize] = t as u32;
                at[vertex as usize] += 1;
            }
        }
        let done = vec![false; triangles.len()];
        Self { triangles, first, left, around, done, cache: Vec::with_capacity(CACHE + 3) }
    }

    fn run(mut self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.triangles.len());
        // If no neighbour is left, continue with the first unsorted triangle.
        for start in 0..self.triangles.len() as u32 {
            let mut next = (!self.done[start as usize]).then_some(start);
            while let Some(triangle) = next {
                self.take(triangle);
                order.push(triangle);
                next = self.best();
            }
        }
        order
    }

    fn take(&mut self, triangle: u32) {
        self.done[triangle as usize] = true;
        let corners = self.triangles[triangle as usize];
        for vertex in corners {
            let (first, left) =
                (self.first[vertex as usize] as usize, &mut self.left[vertex as usize]);
            let around = &mut self.around[first..first + *left as usize];
            if let Some(at) = around.iter().position(|&t| t == triangle) {
                around.swap(at, *left as usize - 1);
                *left -= 1;
            }
        }
        self.cache.retain(|vertex| !corners.contains(vertex));
        self.cache.splice(..0, corners);
        self.cache.truncate(CACHE);
    }

    fn around(&self, vertex: u32) -> &[u32] {
        let first = self.first[vertex as usize] as usize;
        &self.around[first..first + self.left[vertex as usize] as usize]
    }

    /// Returns the best triangle at a recently used vertex; of equals, the first in the input.
    fn best(&self) -> Option<u32> {
        let near = self.cache.iter().flat_map(|&vertex| self.around(vertex));
        let score = |&t: &u32| -> f32 {
            self.triangles[t as usize].iter().map(|&vertex| self.score(vertex)).sum()
        };
        near.map(|t| (score(t), *t))
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))
            .map(|(_, t)| t)
    }

    fn score(&self, vertex: u32) -> f32 {
        let age = self.cache.iter().position(|&cached| cached == vertex);
        let recent = match age {
            None => 0.0,
            Some(0..3) => 1.0,
            Some(age) => (1.0 - (age - 3) as f32 / (CACHE - 3) as f32).powf(1.5),
        };
        recent + 2.0 / (self.left[vertex as usize] as f32).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshopt::encode_triangles;

    #[test]
    fn a_shuffled_grid_comes_in_one_byte_a_triangle() {
        let n = 40u32;
        let at = |x: u32, y: u32| y * (n + 1) + x;
        let mut triangles: Vec<[u32; 3]> = (0..n * n)
            .map(|i| i * 787 % (n * n))
            .flat_map(|i| {
                let (x, y) = (i % n, i / n);
                let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
                [[a, b, c], [c, b, d]]
            })
            .collect();
        let mut before = triangles.clone();
        let old = arrange(&mut triangles, ((n + 1) * (n + 1)) as usize);
        assert_eq!(old.len(), before.iter().flatten().max().map_or(0, |&v| v as usize + 1));
        let mut after: Vec<[u32; 3]> =
            triangles.iter().map(|t| t.map(|v| old[v as usize])).collect();
        before.sort_unstable();
        after.sort_unstable();
        assert_eq!(before, after);
        let bytes = encode_triangles(&triangles).len();
        assert!(bytes < triangles.len() * 5 / 4, "{bytes} bytes, {} triangles", triangles.len());
    }

    #[test]
    fn triangles_that_repeat_a_vertex_or_each_other_all_come_through() {
        let mut triangles = [[0, 0, 0], [1, 2, 1], [1, 2, 1], [4, 0, 2]];
        let old = arrange(&mut triangles, 5);
        let mut back = triangles.map(|t| t.map(|v| old[v as usize]));
        back.sort_unstable();
        assert_eq!(back, [[0, 0, 0], [1, 2, 1], [1, 2, 1], [4, 0, 2]]);
        assert!(arrange(&mut [], 3).is_empty());
    }
}
