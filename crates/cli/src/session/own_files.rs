//! How the program's own files, `.mlod`, `.mlq` and `.mlz`, store their meshes.

use meshlod::codec::{Compressed, TransportFile};
use meshlod::multires::ModelFile;
use meshlod::{AnyFile, FileBytes, FileKind};
use serde_json::{Value, json};

use crate::session::failure::Failure;
use crate::session::model_file;
use crate::text::numbers::{count, value};

/// Facts about how a file of our own stores its mesh: for programs, and as lines for people.
pub struct StoredForm {
    pub json: Value,
    pub rows: Vec<[String; 2]>,
}

/// Returns how a file of our own stores its mesh; `None` for a file of other programs.
pub fn stored(file: &AnyFile) -> Option<Result<StoredForm, Failure>> {
    if let Some(levels) = file.levels() {
        return Some(Ok(stored_levels(levels)));
    }
    let wrong = |error| Failure::at(file.path(), error);
    let bytes = file.compressed()?;
    Some(match file.kind() {
        FileKind::Sent => TransportFile::open(bytes).map(|sent| stored_sent(&sent)).map_err(wrong),
        _ => Compressed::from_bytes(bytes).map(|all| stored_resident(&all)).map_err(wrong),
    })
}

fn stored_levels(file: &ModelFile<FileBytes>) -> StoredForm {
    match file {
        ModelFile::Contractions(archive) => {
            let kind = model_file::kind_name(archive.error_kind());
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
    }
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
