//! Meshes and facts of the program's own files: `.mlod`, `.mlq` and `.mlz`.

use std::path::Path;

use meshlod::codec::{Compressed, TransportFile};
use meshlod::io::Weld;
use meshlod::multires::{ModelFile, Query};
use meshlod::{ReadOptions, Scene, decompress_model};
use serde_json::{Value, json};

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::model_file;
use crate::text::model_scene;
use crate::text::numbers::{count, value};

/// A file format of our own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OwnFormat {
    /// All levels of a mesh, `.mlod`.
    Levels,
    /// A mesh in few bytes that is ready for random access, `.mlq`.
    Resident,
    /// A mesh in few bytes that is sent, `.mlz`.
    Sent,
}

impl OwnFormat {
    /// Returns the format of a path by its suffix; `None` for the formats of other programs.
    pub fn of_path(path: &Path) -> Option<Self> {
        let suffix = path.extension()?.to_str()?;
        let all = [("mlod", Self::Levels), ("mlq", Self::Resident), ("mlz", Self::Sent)];
        let found = all.into_iter().find(|(own, _)| suffix.eq_ignore_ascii_case(own));
        found.map(|(_, format)| format)
    }
}

/// Reads the scene of a file of our own; of all levels, the finest one that it holds.
pub fn read(
    path: &Path,
    format: OwnFormat,
    options: &ReadOptions,
    session: &Session,
) -> Result<Scene, Failure> {
    if matches!(options.weld, Weld::Within(_)) {
        let reason = "--weld: vertices of this file were joined when it was made; weld the mesh \
            that it was made from";
        return Err(Failure::at(path, reason));
    }
    let (mesh, model) = match format {
        OwnFormat::Resident | OwnFormat::Sent => {
            let decoded = decompress_model(&files::read_all(path)?);
            decoded.map_err(|error| Failure::at(path, error))?
        }
        OwnFormat::Levels => {
            let file = model_file::open(path, session)?;
            let taken = file.extract(&Query::finest());
            let taken = taken.map_err(|error| Failure::at(path, error))?;
            (taken.level.mesh(), model_scene::read(path, &file, session)?)
        }
    };
    model.into_scene(files::stem(path), mesh).map_err(|error| Failure::at(path, error))
}

/// Facts about how a file of our own stores its mesh: for programs, and as lines for people.
pub struct StoredForm {
    pub json: Value,
    pub rows: Vec<[String; 2]>,
}

/// Reads how a file of our own, of which the mesh has been read, stores it.
pub fn stored(path: &Path, format: OwnFormat, session: &Session) -> Result<StoredForm, Failure> {
    let wrong = |error| Failure::at(path, error);
    match format {
        OwnFormat::Levels => {
            stored_levels(&model_file::open_again(path, session)?).map_err(|e| Failure::at(path, e))
        }
        OwnFormat::Resident | OwnFormat::Sent => {
            let bytes = files::read_all(path)?;
            // As in reading, the content decides, not the suffix.
            match bytes.starts_with(&TransportFile::MAGIC) {
                true => TransportFile::open(&bytes).map(|file| stored_sent(&file)).map_err(wrong),
                false => Compressed::from_bytes(&bytes).map(|c| stored_resident(&c)).map_err(wrong),
            }
        }
    }
}

fn stored_levels(
    file: &ModelFile<std::fs::File>,
) -> Result<StoredForm, meshlod::multires::FileError> {
    Ok(match file {
        ModelFile::Contractions(archive) => {
            let kind = model_file::error_kind(archive);
            let rounding = model_file::rounding(archive);
            let chunk_bytes: u64 = archive.chunk_lengths().iter().sum();
            StoredForm {
                json: json!({
                    "kind": "levels",
                    "updates": archive.update_count(),
                    "base_faces": archive.base_faces(),
                    "chunks": archive.chunk_count(),
                    "complete_chunks": archive.complete_chunks(),
                    "chunk_bytes": chunk_bytes,
                    "errors": kind,
                    "lossless": archive.is_lossless(),
                    "rounding": rounding,
                }),
                rows: vec![
                    row("coarsest faces", archive.base_faces()),
                    row("updates", archive.update_count()),
                    row("chunks", archive.chunk_count()),
                    row("chunk bytes", chunk_bytes as usize),
                    ["errors".into(), kind.into()],
                    ["rounding".into(), value(rounding)],
                ],
            }
        }
        ModelFile::HeightField(field, parts) => {
            let rounded = field.fit().rounded;
            StoredForm {
                json: json!({
                    "kind": "height field",
                    "parts": parts.all,
                    "complete_parts": parts.complete,
                    "rounding": rounded,
                }),
                rows: vec![
                    row("parts", parts.all as usize),
                    row("present", parts.complete as usize),
                    ["rounding".into(), value(rounded)],
                ],
            }
        }
    })
}

fn stored_resident(file: &Compressed) -> StoredForm {
    let sizes = file.sizes();
    let layers = file.layers();
    let mut rows = vec![
        row("patches", file.patches()),
        row("position bytes", sizes.positions),
        row("face bytes", sizes.connectivity),
    ];
    rows.extend(layers.iter().map(|layer| row(&format!("{} bytes", layer.name), layer.bytes)));
    rows.push(row("label bytes", sizes.labels));
    rows.push(row("scene bytes", sizes.resources));
    let layers = layers.iter().map(
        |layer| json!({ "name": layer.name, "bytes": layer.bytes, "max_error": layer.max_error }),
    );
    let json = json!({
        "kind": "resident",
        "patches": file.patches(),
        "blocks": file.blocks(),
        "position_bytes": sizes.positions,
        "face_bytes": sizes.connectivity,
        "attribute_bytes": sizes.attributes,
        "label_bytes": sizes.labels,
        "scene_bytes": sizes.resources,
        "layers": layers.collect::<Value>(),
    });
    StoredForm { json, rows }
}

fn stored_sent(file: &TransportFile<'_>) -> StoredForm {
    let scene = file.resources().map_or(0, <[u8]>::len);
    StoredForm {
        json: json!({
            "kind": "sent",
            "blocks": file.blocks(),
            "cell": file.cell(),
            "scene_bytes": scene,
        }),
        rows: vec![
            row("blocks", file.blocks()),
            ["cell".into(), value(file.cell())],
            row("scene bytes", scene),
        ],
    }
}

fn row(name: &str, number: usize) -> [String; 2] {
    [name.to_owned(), count(number)]
}
