//! Choice of sample times of animations.

/// Chooses at most `most` times, spread evenly over clips with these key times.
///
/// Each clip gets an equal share, and unused shares go to the others. A clip with a large enough
/// share gets all its key times, then the midpoints between them; other clips get evenly spread key
/// times, including the first and last. If there are more clips than times, evenly spread clips get
/// one each. Returns pairs of clip and time, in order.
pub(crate) fn choose(clips: &[Vec<f64>], most: usize) -> Vec<(usize, f64)> {
    let chosen = spread(clips.len(), most);
    let mut shares = vec![0; clips.len()];
    let keys = |clip: usize| clips[clip].len();
    let mut by_keys = chosen.clone();
    by_keys.sort_by_key(|&clip| (keys(clip), clip));
    let mut left = most;
    for (i, &clip) in by_keys.iter().enumerate() {
        let share = left / (by_keys.len() - i);
        let has_room = 2 * keys(clip) <= share + 1;
        shares[clip] = if has_room { (2 * keys(clip)).max(1) - 1 } else { share.min(keys(clip)) };
        left -= shares[clip];
    }
    let of_clip = |clip: usize| {
        let times = times(&clips[clip], shares[clip]);
        times.into_iter().map(move |time| (clip, time))
    };
    chosen.into_iter().flat_map(of_clip).collect()
}

/// Chooses at most `most` times of a clip: key times, and further times if it has fewer keys.
fn times(keys: &[f64], most: usize) -> Vec<f64> {
    if 2 * keys.len() <= most + 1 {
        let middles = keys.windows(2).flat_map(|pair| [0.5 * (pair[0] + pair[1]), pair[1]]);
        return keys.iter().take(1).copied().chain(middles).collect();
    }
    spread(keys.len(), most).into_iter().map(|key| keys[key]).collect()
}

/// Chooses `most` of `count` indices, evenly spread from the first to the last; a single one is in
/// the middle.
fn spread(count: usize, most: usize) -> Vec<usize> {
    match most {
        _ if count <= most => (0..count).collect(),
        0 => Vec::new(),
        1 => vec![count / 2],
        _ => (0..most).map(|i| i * (count - 1) / (most - 1)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clip(keys: usize) -> Vec<f64> {
        (0..keys).map(|key| key as f64).collect()
    }

    #[test]
    fn what_short_clips_leave_goes_to_long_ones() {
        let clips = [clip(83), clip(1), clip(4), clip(100)];
        let chosen = choose(&clips, 63);
        let of = |clip| chosen.iter().filter(|(of, _)| *of == clip).count();
        assert_eq!([0, 1, 2, 3].map(of), [27, 1, 7, 28]);
        assert!(chosen.contains(&(2, 1.5)) && chosen.contains(&(0, 82.0)));
        assert!(chosen.is_sorted_by(|a, b| a < b), "each once, in order");
    }

    #[test]
    fn there_are_never_more_than_asked_for() {
        for keys in [1, 2, 33, 64, 500] {
            for count in [0, 1, 3, 64, 200] {
                for most in [0, 1, 2, 63] {
                    let chosen = choose(&vec![clip(keys); count], most);
                    assert!(chosen.len() <= most, "{keys} {count} {most}");
                    assert_eq!(chosen.is_empty(), count == 0 || most == 0);
                }
            }
        }
    }
}
