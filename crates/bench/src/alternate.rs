//! Timing of two programs in alternating rounds.

use cpu_time::ProcessTime;

/// CPU times of two programs on the same task, and their ratio.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    /// Median CPU time of the first program in seconds, summed over all threads.
    pub ours: f64,
    /// Median CPU time of the second program in seconds, summed over all threads.
    pub theirs: f64,
    /// Median over the rounds of the second time divided by the first: above 1 if the first program
    /// is faster.
    pub ratio: f64,
}

/// Times two programs in alternating rounds, after one round to warm up.
///
/// # Panics
/// If there are no rounds.
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

/// Returns the shortest CPU time of a task over several rounds, in seconds, summed over all
/// threads.
///
/// Infinite without rounds.
pub fn least_seconds<T>(rounds: usize, mut work: impl FnMut() -> T) -> f64 {
    (0..rounds).map(|_| seconds(&mut work)).fold(f64::INFINITY, f64::min)
}

/// Runs a task in a rayon pool of one thread.
pub fn one_core<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a pool of one thread can be built").install(work)
}

fn seconds<T>(work: &mut impl FnMut() -> T) -> f64 {
    // CPU time, because the machine may be busy with other work.
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
