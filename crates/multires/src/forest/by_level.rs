//! Counting sort of updates by level.

/// Returns the indices `0..count` sorted by the number that `number` gives each, in a stable order.
///
/// Cost: linear.
pub(crate) fn by_level(count: usize, number: impl Fn(u32) -> u16) -> Vec<u32> {
    let numbers: Vec<u16> = (0..count as u32).map(number).collect();
    let mut starts = vec![0u32; numbers.iter().max().map_or(0, |&most| usize::from(most) + 2)];
    numbers.iter().for_each(|&number| starts[usize::from(number) + 1] += 1);
    (1..starts.len()).for_each(|number| starts[number] += starts[number - 1]);
    let mut sorted = vec![0; numbers.len()];
    for (update, &number) in numbers.iter().enumerate() {
        let start = &mut starts[usize::from(number)];
        sorted[*start as usize] = update as u32;
        *start += 1;
    }
    sorted
}
