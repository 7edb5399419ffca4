//! Doubts about numbers that are probably meant as percentages. They are warnings, since a number
//! may be meant as it is: a batch has one length for models of any size.

use meshlod::Scene;
use meshlod::scene::world_bounds;

use crate::options::parse::{Bound, LevelSize};
use crate::text::numbers::{count, value};

/// Part of the diagonal from which a length leaves little of a model.
const LARGE: f64 = 0.1;

/// Numbers up to this may be percentages.
const MOST_PERCENT: f64 = 100.0;

/// Faces of a model of which nobody wants so few.
const MANY_FACES: usize = 1000;

/// Doubts sizes of levels of a scene that are probably percentages, or one number with a comma.
pub fn of_sizes(levels: &[LevelSize], scene: &Scene) -> Option<String> {
    let faces = scene.meshes.iter().map(|mesh| mesh.mesh.faces.len()).sum();
    of_commas(levels).or_else(|| of_levels(levels, faces))
}

/// Doubts a length that is large for a scene, by an option that takes no percentages.
pub fn of_distance(option: &str, length: f64, scene: &Scene) -> Option<String> {
    let doubt = of_length(option, length, world_bounds(scene).diagonal())?;
    Some(doubt + ": is it in the units of the model?")
}

/// Doubts a length in model units that is large for a model.
pub fn of_bound(option: &str, bound: Bound, diagonal: f64) -> Option<String> {
    let Bound::Length(length) = bound else { return None };
    let how_large = of_length(option, length, diagonal)?;
    Some(match length <= MOST_PERCENT {
        true => format!("{how_large}; did you mean {length}%?"),
        false => format!("{how_large}; a percentage of that is written 0.1%"),
    })
}

fn of_length(option: &str, length: f64, diagonal: f64) -> Option<String> {
    if diagonal == 0.0 || length <= LARGE * diagonal {
        return None;
    }
    Some(format!(
        "{option} {length} is a length in model units, and the diagonal of the model is {}",
        value(diagonal)
    ))
}

/// Doubts a part of the diagonal that is large: it may be meant as a ratio of the faces.
pub fn of_part(option: &str, bound: Bound) -> Option<String> {
    let is_large = matches!(bound, Bound::OfDiagonal(part) if part > LARGE);
    is_large.then(|| {
        format!(
            "{option} {bound} is a distance relative to the diagonal of the model; a ratio of the \
             faces is written --ratio {bound}"
        )
    })
}

/// Doubts a first level that is the input, which a chain has anyway.
pub fn of_whole(levels: &[LevelSize]) -> Option<String> {
    let is_whole = levels.first() == Some(&LevelSize::Ratio(1.0));
    is_whole.then(|| "--levels: LOD0 is the input, so leave out 100%".into())
}

/// Doubts two sizes that may be one with a comma: `12,500`.
fn of_commas(levels: &[LevelSize]) -> Option<String> {
    let halves = |pair: &[LevelSize]| match *pair {
        [LevelSize::Faces(a), LevelSize::Faces(b @ 100..1000)] if a <= b => Some((a, b)),
        _ => None,
    };
    let (a, b) = levels.windows(2).find_map(halves)?;
    Some(format!("--levels {a},{b} are two sizes; one of {a}{b} faces is written without a comma"))
}

/// Doubts sizes of levels that are all numbers of few faces.
fn of_levels(levels: &[LevelSize], faces: usize) -> Option<String> {
    let numbers: Vec<usize> = levels.iter().filter_map(LevelSize::faces).collect();
    let most = *numbers.iter().max()?;
    if faces < MANY_FACES || most as f64 > MOST_PERCENT {
        return None;
    }
    let percentages = match most {
        // A chain of one level that has so few faces was meant as a number of levels.
        0..10 if levels.len() == 1 => "50%,25%,10%".to_owned(),
        _ => numbers.iter().map(|number| format!("{number}%")).collect::<Vec<_>>().join(","),
    };
    let written: Vec<String> = numbers.iter().map(usize::to_string).collect();
    let (written, faces) = (written.join(","), count(faces));
    Some(format!(
        "--levels {written} asks for that many of {faces} faces; percentages are written {percentages}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_doubted_where_it_is_large() {
        let doubt = |bound| of_bound("--error", bound, 0.25);
        assert!(doubt(Bound::Length(1.0)).unwrap().ends_with("did you mean 1%?"));
        assert!(doubt(Bound::Length(500.0)).unwrap().ends_with("written 0.1%"));
        for bound in [Bound::Length(0.02), Bound::OfDiagonal(0.5)] {
            assert_eq!(doubt(bound), None);
        }
        assert_eq!(of_bound("--error", Bound::Length(1.0), 0.0), None);
    }

    #[test]
    fn few_faces_are_doubted_where_many_are_there() {
        let [few, one, more] = [&[50, 25, 10][..], &[3], &[1000, 50]]
            .map(|sizes| sizes.iter().map(|&faces| LevelSize::Faces(faces)).collect::<Vec<_>>());
        assert!(of_levels(&few, 4212).unwrap().ends_with("written 50%,25%,10%"));
        assert!(of_levels(&one, 4212).unwrap().ends_with("written 50%,25%,10%"));
        assert_eq!((of_levels(&few, 200), of_levels(&more, 4212)), (None, None));
        let comma = of_commas(&[LevelSize::Faces(12), LevelSize::Faces(500)]).unwrap();
        assert!(comma.contains("one of 12500 faces") && of_commas(&more).is_none());
        assert_eq!(of_levels(&[LevelSize::Ratio(0.5)], 4212), None);
    }
}
