//! Reading of a level table from files that anybody may have written.

use meshlod_mesh::{Labels, Layer, LayerKind};

use crate::levels::{Chain, ChainKind, Differences, DirectionGrid, Level, LevelTable};
use crate::recording::level_files::{
    ChainWord, DIFFERENCES, FILE, LayerEntry, LevelEntry, LevelsFile, MATERIALS, SILHOUETTES,
    TRIANGLES, VERTICES,
};
use crate::recording::{FARTHEST, RecordingError, Source};
use crate::select::InstanceLevel;

/// Reads the level table of a model.
///
/// # Errors
/// Files that are missing or damaged, do not fit together, name what is not there, or hold what is
/// not finite; chains in another order than [`write_levels`](super::write_levels) gives them.
pub fn read_levels(source: &mut Source<'_>) -> Result<LevelTable, RecordingError> {
    let file: LevelsFile = source.json(FILE)?;
    if !(2..=16).contains(&file.direction_side) {
        return Err(RecordingError::value(FILE, "direction_side", "it must be between 2 and 16"));
    }
    let directions = DirectionGrid::new(file.direction_side);
    let chains = chains(&file, directions.len())?;
    let positions = source.array::<f32>(VERTICES, &[None, Some(3)])?.values;
    check_finite(VERTICES, &positions, 3)?;
    let positions: Vec<[f32; 3]> = positions.as_chunks().0.to_vec();
    let corners = source.array::<u32>(TRIANGLES, &[None, Some(3)])?.values;
    if let Some(at) = corners.iter().position(|&v| v as usize >= positions.len()) {
        let reason = format!("vertex {} is not one of {}", corners[at], positions.len());
        return Err(RecordingError::value(TRIANGLES, format!("triangle {}", at / 3), reason));
    }
    let triangles: Vec<[u32; 3]> = corners.as_chunks().0.to_vec();
    let levels = levels(&file, &chains, triangles.len())?;
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
        directions,
        differences,
        radius,
        half_extent,
    })
}

/// Returns the chains, which must be the whole one, those of both sides, and one for each
/// direction, without gaps between their levels.
fn chains(file: &LevelsFile, directions: usize) -> Result<Vec<Chain>, RecordingError> {
    let all = "they must be whole, left-coarsened, right-coarsened, and one facing each direction";
    if file.chains.len() != 3 + directions {
        return Err(RecordingError::value(FILE, "chains", all));
    }
    let mut next = 0;
    let mut chains: Vec<Chain> = Vec::new();
    for (i, entry) in file.chains.iter().enumerate() {
        let wrong = |reason| Err(RecordingError::value(FILE, format!("chain {i}"), reason));
        let (word, kind) = match i {
            0 => (ChainWord::Whole, ChainKind::Whole),
            1 => (ChainWord::LeftCoarsened, ChainKind::LeftCoarsened),
            2 => (ChainWord::RightCoarsened, ChainKind::RightCoarsened),
            _ => (ChainWord::Facing, ChainKind::Facing(i - 3)),
        };
        if entry.kind != word {
            return wrong(all);
        }
        if entry.first_level != next || entry.levels > file.levels.len() - next {
            return wrong("its levels must follow those of the chain before, and be there");
        }
        next += entry.levels;
        let depth = chains.first().map_or(entry.levels, |whole| whole.levels.len());
        if depth == 0 || (word == ChainWord::Facing && entry.levels != depth) {
            return wrong("it must have as many levels as the whole chain, and at least one");
        }
        chains.push(Chain { kind, levels: entry.first_level..next });
    }
    if next != file.levels.len() || next > InstanceLevel::MOST {
        let reason = "there must be at most 65535, each in a chain";
        return Err(RecordingError::value(FILE, "levels", reason));
    }
    Ok(chains)
}

fn levels(
    file: &LevelsFile,
    chains: &[Chain],
    triangles: usize,
) -> Result<Vec<Level>, RecordingError> {
    let chain_of =
        chains.iter().enumerate().flat_map(|(i, chain)| chain.levels.clone().map(move |_| i));
    let level = |(i, (entry, chain)): (usize, (&LevelEntry, usize))| {
        let LevelEntry { first_triangle, triangles: count, error } = *entry;
        let end = first_triangle.checked_add(count).filter(|&end| end <= triangles);
        let wrong = |reason| Err(RecordingError::value(FILE, format!("level {i}"), reason));
        match end {
            None => wrong(format!("its triangles are not among the {triangles}")),
            Some(_) if !(0.0..=FARTHEST).contains(&error) => {
                wrong("its error must be 0 or more".into())
            }
            Some(end) => Ok(Level { chain, triangles: first_triangle..end, error }),
        }
    };
    file.levels.iter().zip(chain_of).enumerate().map(level).collect()
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

/// Checks that all values are finite; `width` of them are an entry.
fn check_finite(file: &str, values: &[f32], width: usize) -> Result<(), RecordingError> {
    match values.iter().position(|x| !(x.abs() <= FARTHEST)) {
        None => Ok(()),
        Some(at) => {
            let place = format!("entry {}", at / width);
            Err(RecordingError::value(file, place, "its values must be finite and within 1e7"))
        }
    }
}
