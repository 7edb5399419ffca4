//! Reading of a level table from untrusted files.

use std::ops::Range;

use meshlod::flock::levels::{
    Chain, ChainKind, Differences, DirectionGrid, FacingLevels, Level, LevelTable,
};
use meshlod::mesh::{Labels, Layer, LayerKind};

use crate::recording::level_files::{
    ChainWord, DIFFERENCES, DIRECTIONS, FILE, LayerEntry, LevelEntry, LevelsFile, MATERIALS,
    SILHOUETTES, TRIANGLES, VERTICES, cells,
};
use crate::recording::limits::FARTHEST;
use crate::recording::{RecordingError, Source};

/// Greatest deviation of a direction from its grid's.
const SLACK: f32 = 1e-3;

/// Reads the level table of a model.
///
/// # Errors
/// Files that are missing, damaged or inconsistent, indices out of range, values that are not
/// finite, and chains in another order than [`write_levels`](super::write_levels) writes.
pub fn read_levels(source: &mut Source<'_>) -> Result<LevelTable, RecordingError> {
    let file: LevelsFile = source.json(FILE)?;
    let (chains, facing) = (chains(&file)?, facing(&file)?);
    check_directions(&facing, source)?;
    let positions = source.array::<f32>(VERTICES, &[None, Some(3)])?.values;
    check_finite(VERTICES, &positions, 3)?;
    let positions: Vec<[f32; 3]> = positions.as_chunks().0.to_vec();
    let corners = source.array::<u32>(TRIANGLES, &[None, Some(3)])?.values;
    if let Some(at) = corners.iter().position(|&v| v as usize >= positions.len()) {
        let reason = format!("vertex {} is not one of {}", corners[at], positions.len());
        return Err(RecordingError::value(TRIANGLES, format!("triangle {}", at / 3), reason));
    }
    let triangles: Vec<[u32; 3]> = corners.as_chunks().0.to_vec();
    let levels = levels(&file, &chains, &facing, triangles.len())?;
    let materials = materials(&file, triangles.len(), source)?;
    let layers = layers(&file.layers, positions.len(), source)?;
    let differences = differences(chains[0].levels.len(), source)?;
    let (radius, half_extent) = LevelTable::extent_of(&positions);
    Ok(LevelTable {
        positions,
        layers,
        triangles,
        materials,
        levels,
        chains,
        facing,
        differences,
        radius,
        half_extent,
    })
}

/// Upper limit of the levels of a chain, which policies count in a byte.
const MOST_DEPTHS: usize = 255;

/// Returns the simplified chains; their levels must come first, without gaps.
fn chains(file: &LevelsFile) -> Result<[Chain; 3], RecordingError> {
    let words = [ChainWord::Whole, ChainWord::LeftCoarsened, ChainWord::RightCoarsened];
    let kinds = [ChainKind::Whole, ChainKind::LeftCoarsened, ChainKind::RightCoarsened];
    if !file.chains.iter().map(|entry| entry.kind).eq(words) {
        let reason = "they must be whole, left-coarsened, right-coarsened";
        return Err(RecordingError::value(FILE, "chains", reason));
    }
    let mut next = 0;
    let mut chains = kinds.map(|kind| Chain { kind, levels: 0..0 });
    for (i, (entry, chain)) in file.chains.iter().zip(&mut chains).enumerate() {
        let first = [entry.first_level, entry.levels];
        chain.levels = range(file, &mut next, first, || format!("chain {i}"))?;
    }
    match chains[0].levels.len() {
        1..=MOST_DEPTHS => Ok(chains),
        _ => {
            let reason = format!("it must have 1 to {MOST_DEPTHS} levels");
            Err(RecordingError::value(FILE, "chain 0", reason))
        }
    }
}

/// Returns the facing levels of all depths; they must follow the chains.
fn facing(file: &LevelsFile) -> Result<Vec<FacingLevels>, RecordingError> {
    if file.facing.len() != file.chains[0].levels {
        let reason = "there must be an entry for each level of the whole chain";
        return Err(RecordingError::value(FILE, "facing", reason));
    }
    let mut next = file.chains.iter().map(|entry| entry.levels).sum();
    let mut depths = Vec::new();
    for (depth, entry) in file.facing.iter().enumerate() {
        let place = || format!("facing {depth}");
        let levels = range(file, &mut next, [entry.first_level, entry.levels], place)?;
        let directions = DirectionGrid::new(entry.side);
        if entry.side.checked_mul(entry.side) != Some(directions.len()) {
            let reason = format!("`side` is {}, which no grid of directions has", entry.side);
            return Err(RecordingError::value(FILE, place(), reason));
        }
        if !levels.is_empty() && levels.len() != directions.len() {
            let reason = format!("it must have {} levels or none", directions.len());
            return Err(RecordingError::value(FILE, place(), reason));
        }
        depths.push(FacingLevels { directions, levels });
    }
    if next != file.levels.len() || next > LevelTable::MAX_LEVELS {
        let reason = "there must be at most 65534, each in a chain";
        return Err(RecordingError::value(FILE, "levels", reason));
    }
    Ok(depths)
}

/// Checks the directions of the facing levels against their grids.
fn check_directions(
    facing: &[FacingLevels],
    source: &mut Source<'_>,
) -> Result<(), RecordingError> {
    let expected: Vec<f32> = facing.iter().flat_map(cells).collect();
    let found = source.array::<f32>(DIRECTIONS, &[Some(expected.len() / 4), Some(4)])?.values;
    let fits = |(found, expected): (&f32, f32)| (found - expected).abs() <= SLACK;
    match found.iter().zip(expected).position(|pair| !fits(pair)) {
        None => Ok(()),
        Some(at) => {
            let reason = "it is not that of the grid in levels.json";
            Err(RecordingError::value(DIRECTIONS, format!("direction {}", at / 4), reason))
        }
    }
}

/// Returns a range of levels that begins at `next`, and moves `next` to its end.
fn range(
    file: &LevelsFile,
    next: &mut usize,
    [first, count]: [usize; 2],
    place: impl Fn() -> String,
) -> Result<Range<usize>, RecordingError> {
    if first != *next || count > file.levels.len() - *next {
        let reason = "its levels must follow those before, and be there";
        return Err(RecordingError::value(FILE, place(), reason));
    }
    *next += count;
    Ok(first..*next)
}

fn levels(
    file: &LevelsFile,
    chains: &[Chain; 3],
    facing: &[FacingLevels],
    triangles: usize,
) -> Result<Vec<Level>, RecordingError> {
    let simplified =
        chains.iter().flat_map(|chain| (0..chain.levels.len()).map(|d| (chain.kind, d)));
    let cells = |(depth, facing): (usize, &FacingLevels)| {
        (0..facing.levels.len()).map(move |cell| (ChainKind::Facing(cell), depth))
    };
    let places = simplified.chain(facing.iter().enumerate().flat_map(cells));
    let level = |(i, (entry, (chain, depth))): (usize, (&LevelEntry, (ChainKind, usize)))| {
        let LevelEntry { first_triangle, triangles: count, error } = *entry;
        let end = first_triangle.checked_add(count).filter(|&end| end <= triangles);
        let wrong = |reason| Err(RecordingError::value(FILE, format!("level {i}"), reason));
        match end {
            None => wrong(format!("its triangles are not among the {triangles}")),
            Some(_) if !(0.0..=FARTHEST).contains(&error) => {
                wrong("its error must be 0 or more".into())
            }
            Some(end) => Ok(Level { chain, depth, triangles: first_triangle..end, error }),
        }
    };
    file.levels.iter().zip(places).enumerate().map(level).collect()
}

fn materials(
    file: &LevelsFile,
    triangles: usize,
    source: &mut Source<'_>,
) -> Result<Option<Labels>, RecordingError> {
    let Some(names) = &file.materials else { return Ok(None) };
    let of_face = source.array::<u32>(MATERIALS, &[Some(triangles)])?.values;
    match of_face.iter().position(|&material| material as usize >= names.len()) {
        None => Ok(Some(Labels { names: names.clone(), of_face })),
        Some(at) => {
            let reason = format!("material {} is not one of {}", of_face[at], names.len());
            Err(RecordingError::value(MATERIALS, format!("triangle {at}"), reason))
        }
    }
}

fn layers(
    entries: &[LayerEntry],
    vertices: usize,
    source: &mut Source<'_>,
) -> Result<Vec<Layer>, RecordingError> {
    let mut layers = Vec::new();
    for entry in entries {
        let kind = entry.kind();
        let array = source.array::<f32>(&entry.file, &[Some(vertices), kind.width()])?;
        let width = array.shape[1];
        if width == 0 {
            return Err(RecordingError::value(&entry.file, "shape", "it must have values"));
        }
        check_finite(&entry.file, &array.values, width)?;
        layers.push(Layer { kind, name: entry.name.clone(), width, values: array.values });
    }
    if !layers.iter().any(|layer| layer.kind == LayerKind::Normal) {
        return Err(RecordingError::value(FILE, "layers", "there must be normals"));
    }
    Ok(layers)
}

fn differences(depth: usize, source: &mut Source<'_>) -> Result<Differences, RecordingError> {
    let directions = Differences::grid().len();
    let shape = [directions, depth, Differences::SIZES].map(Some);
    let areas = source.array::<f32>(DIFFERENCES, &shape)?.values;
    let silhouettes = source.array::<f32>(SILHOUETTES, &shape[..1])?.values;
    check_finite(DIFFERENCES, &areas, depth * Differences::SIZES)?;
    check_finite(SILHOUETTES, &silhouettes, 1)?;
    Ok(Differences::from_arrays(depth, areas, silhouettes))
}

/// Checks that all values are finite; an entry has `width` of them.
fn check_finite(file: &str, values: &[f32], width: usize) -> Result<(), RecordingError> {
    let fits = |x: &f32| x.abs() <= FARTHEST;
    match values.iter().position(|x| !fits(x)) {
        None => Ok(()),
        Some(at) => {
            let place = format!("entry {}", at / width);
            Err(RecordingError::value(file, place, "its values must be finite and within 1e7"))
        }
    }
}
