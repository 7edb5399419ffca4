//! Two pieces of work by turns.

use cpu_time::ProcessTime;

/// What two pieces of work took, by turns.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    /// Median seconds of the first, of all its threads.
    pub ours: f64,
    /// Median seconds of the second likewise.
    pub theirs: f64,
    /// Median over the rounds of second ÷ first: how many times as fast the first is.
    pub ratio: f64,
}

/// Does both by turns, `rounds` times after one that does not count.
///
/// Panics without rounds.
pub fn alternate<A, B>(
    rounds: usize,
    mut ours: impl FnMut() -> A,
    mut theirs: impl FnMut() -> B,
) -> Ratio {
    ours();
    theirs();
    let (mut a, mut b, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds {
        let (first, second) = (seconds(&mut ours), seconds(&mut theirs));
        a.push(first);
        b.push(second);
        ratios.push(second / first);
    }
    Ratio { ours: median(a), theirs: median(b), ratio: median(ratios) }
}

/// The least seconds that the work takes, of all its threads, in some rounds.
///
/// Infinite without rounds.
pub fn least_seconds<T>(rounds: usize, mut work: impl FnMut() -> T) -> f64 {
    (0..rounds).map(|_| seconds(&mut work)).fold(f64::INFINITY, f64::min)
}

/// Does the work on one core: rayon's threads are one while it runs.
pub fn one_core<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("one thread can be had").install(work)
}

fn seconds<T>(work: &mut impl FnMut() -> T) -> f64 {
    // Not by the wall clock: others are at work here too.
    let start = ProcessTime::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 9.0]), 3.0);
    }

    #[test]
    fn each_is_done_once_more_than_the_rounds() {
        let (mut a, mut b) = (0, 0);
        alternate(3, || a += 1, || b += 1);
        assert_eq!((a, b), (4, 4));
    }
}
