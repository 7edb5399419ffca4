//! Cracks in pictures with a transparent background.

use meshlod::picture::Picture;

/// Counts background pixels inside the silhouette: those that cannot be reached from the rim of the
/// picture over background pixels.
pub fn cracks(picture: &Picture) -> usize {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let is_open = |at: usize| picture.rgba()[4 * at + 3] == 0;
    let is_rim = |at: usize| {
        let (x, y) = (at % width, at / width);
        x == 0 || y == 0 || x + 1 == width || y + 1 == height
    };
    let mut stack: Vec<usize> =
        (0..width * height).filter(|&at| is_rim(at) && is_open(at)).collect();
    let mut reached = vec![false; width * height];
    stack.iter().for_each(|&at| reached[at] = true);
    while let Some(at) = stack.pop() {
        for step in [1, width] {
            for next in [at.wrapping_sub(step), at + step] {
                // From one rim to the other is a step, too: both are outside.
                if next < width * height && !reached[next] && is_open(next) {
                    reached[next] = true;
                    stack.push(next);
                }
            }
        }
    }
    (0..width * height).filter(|&at| is_open(at) && !reached[at]).count()
}
