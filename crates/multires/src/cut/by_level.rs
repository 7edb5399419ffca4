//! Updates in the order of their levels.

use crate::implicit::Implicit;

/// All updates in the order of some number that has to do with their levels; what is alike in the order
/// of the model.
///
/// Cost: linear.
pub(super) fn by_level(mt: &Implicit, number: impl Fn(u32) -> u16) -> Vec<u32> {
    let updates = 0..mt.update_count() as u32;
    let numbers: Vec<u16> = updates.map(number).collect();
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
