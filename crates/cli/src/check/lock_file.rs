//! Lock files: lock states of vertices in the order of the input file, and ties.
//!
//! The format is described in docs/notes/locks.md.

use std::path::Path;

use meshlod::check::{LockReason, VertexLocks};
use meshlod::io::Weld;
use meshlod::mesh::{Lock, Locks, VertexId};
use meshlod::{Format, ReadOptions, Scene};
use serde_json::{Value, json};

use crate::session::failure::Failure;
use crate::session::files;

const FORMAT: &str = "meshlod-locks";
const VERSION: u64 = 1;

/// Lock flags, with the values of meshoptimizer's `vertex_lock`.
const FLAGS: [(Lock, u8, &str); 3] =
    [(Lock::Free, 0, "free"), (Lock::Locked, 1, "lock"), (Lock::Protected, 2, "protect")];

/// Correspondence between the vertex numbers of a file and the vertices of each mesh of its scene.
pub struct FileRows {
    of_meshes: Vec<Vec<VertexId>>,
    /// The scene read without welding, if reading it normally welds vertices.
    torn: Option<Scene>,
}

impl FileRows {
    /// Finds the correspondence for the file from which a scene was read with the option `weld`.
    ///
    /// # Errors
    ///
    /// Fails for vertices welded within a distance, which no row of the file corresponds to.
    pub fn of(path: &Path, scene: &Scene, weld: Weld) -> Result<Self, Failure> {
        if files::is_pipe(path) {
            return Err(Failure::usage("--locks: the input must be a file, not standard input"));
        }
        let format = Format::of_path(path).map_err(Failure::usage)?;
        let torn = match (weld, format) {
            (Weld::Within(_), _) => {
                return Err(Failure::usage(
                    "--locks refers to the vertices of the input file and does not go with --weld",
                ));
            }
            (Weld::Exact, format) if format.is_welded() => {
                Some(meshlod::read(path, &ReadOptions { weld: Weld::Off })?)
            }
            (Weld::Exact | Weld::Off, _) => None,
        };
        let of_meshes = match &torn {
            Some(torn) => {
                let rows = of_scene(torn, scene);
                rows.ok_or_else(|| Failure::at(path, "has changed while it was read"))?
            }
            None => {
                let own = scene.meshes.iter().map(|mesh| mesh.mesh.positions.len());
                own.map(|count| (0..count).map(VertexId::new).collect()).collect()
            }
        };
        Ok(Self { of_meshes, torn })
    }

    /// Returns the [`mark`] of the rows of each mesh.
    fn marks(&self, scene: &Scene) -> Vec<String> {
        let meshes = &self.torn.as_ref().unwrap_or(scene).meshes;
        meshes.iter().map(|mesh| mark(&mesh.mesh.positions)).collect()
    }
}

/// Returns for each mesh the vertex at the position of every unwelded row; `None` if a row has
/// none.
fn of_scene(torn: &Scene, scene: &Scene) -> Option<Vec<Vec<VertexId>>> {
    let positions = |mesh: usize| Some(&scene.meshes.get(mesh)?.mesh.positions[..]);
    let meshes = torn.meshes.iter().enumerate();
    let rows = meshes.map(|(i, rows)| at_places(&rows.mesh.positions, positions(i)?));
    rows.collect::<Option<Vec<_>>>().filter(|rows| rows.len() == scene.meshes.len())
}

/// Returns the vertex at the position of each row.
fn at_places(rows: &[[f64; 3]], welded: &[[f64; 3]]) -> Option<Vec<VertexId>> {
    let places: std::collections::HashMap<_, _> =
        welded.iter().enumerate().map(|(v, p)| (bits(p), VertexId::new(v))).collect();
    rows.iter().map(|row| places.get(&bits(row)).copied()).collect()
}

/// Returns bits that are equal for equal positions: -0 becomes 0.
fn bits(position: &[f64; 3]) -> [u64; 3] {
    position.map(|x| (x + 0.0).to_bits())
}

/// Hashes positions in order, so that a lock file recognises its mesh: 64-bit FNV-1a of the
/// coordinates' bytes, little-endian.
fn mark(positions: &[[f64; 3]]) -> String {
    let bytes = positions.iter().flat_map(bits).flat_map(u64::to_le_bytes);
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// Returns the vertex locks of all meshes of a scene as the JSON of a lock file.
pub fn to_json(path: &Path, scene: &Scene, rows: &FileRows, lockings: &[VertexLocks]) -> Value {
    let file = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let source = rows.torn.as_ref().unwrap_or(scene).source.as_ref();
    let marks = rows.marks(scene);
    let meshes = scene.meshes.iter().zip(&rows.of_meshes).zip(lockings).enumerate();
    let meshes = meshes.map(|(index, ((mesh, rows), locking))| {
        let mut json = mesh_json(rows, locking);
        json["name"] = mesh.name.clone().into();
        json["positions"] = marks[index].clone().into();
        if let Some(source) = source {
            let primitive = |rows: &meshlod::io::gltf::PrimitiveRows| {
                let (first, count) = (rows.vertices.start, rows.vertices.len());
                json!({ "accessor": rows.accessor, "first": first, "count": count })
            };
            let primitives = source.primitive_rows(index);
            json["primitives"] =
                primitives.iter().map(|rows| rows.as_ref().map(primitive)).collect();
        }
        json
    });
    json!({
        "format": FORMAT,
        "version": VERSION,
        "file": file,
        "flags": Value::Object(FLAGS.map(|(_, flag, name)| (name.to_owned(), flag.into())).into_iter().collect()),
        "meshes": meshes.collect::<Vec<_>>(),
    })
}

fn mesh_json(rows: &[VertexId], VertexLocks { locks, reasons }: &VertexLocks) -> Value {
    let flag = |lock| FLAGS.iter().find(|(of, ..)| *of == lock).map_or(0, |&(_, flag, _)| flag);
    let flags: Vec<u8> = rows.iter().map(|v| flag(locks.of(*v))).collect();
    let counts = FLAGS.map(|(_, flag, name)| {
        (name.to_owned(), flags.iter().filter(|&&of| of == flag).count().into())
    });
    let mut rows_of = vec![Vec::new(); locks.of_vertex.len()];
    for (row, v) in rows.iter().enumerate() {
        rows_of[v.index()].push(row);
    }
    let tie = |tie: &Vec<VertexId>| -> Vec<usize> {
        let mut rows: Vec<usize> =
            tie.iter().flat_map(|v| rows_of[v.index()].iter().copied()).collect();
        rows.sort_unstable();
        rows
    };
    let because = LockReason::ALL.map(|reason| {
        let rows = rows.iter().filter(|v| reasons[v.index()] == Some(reason)).count();
        (reason.name().to_owned(), rows.into())
    });
    json!({
        "vertices": rows.len(),
        "counts": Value::Object(counts.into_iter().collect()),
        "reasons": Value::Object(because.into_iter().collect()),
        "flags": flags,
        "ties": locks.ties.iter().map(tie).collect::<Vec<_>>(),
    })
}

/// Reads a lock file, and returns the vertex locks of each mesh of the scene.
///
/// # Errors
///
/// One line that names the file and the mesh, for a file of another format or of another mesh.
pub fn read(path: &Path, scene: &Scene, rows: &FileRows) -> Result<Vec<Locks>, Failure> {
    let wrong = |reason: String| Failure::at(path, reason);
    let bytes = files::read_all(path)?;
    let json: Value = serde_json::from_slice(&bytes).map_err(|error| {
        wrong(format!("{error}; --locks takes a file written by meshlod check IN --locks FILE"))
    })?;
    if json["format"] != FORMAT {
        return Err(wrong("is not a lock file; meshlod check IN --locks FILE writes one".into()));
    }
    if json["version"] != VERSION {
        let version = &json["version"];
        return Err(wrong(format!("has version {version}; this program reads version {VERSION}")));
    }
    let meshes = json["meshes"].as_array().map_or(&[][..], Vec::as_slice);
    if meshes.len() != scene.meshes.len() {
        let (found, expected) = (meshes.len(), scene.meshes.len());
        return Err(wrong(format!("has locks for {found} meshes, but the input has {expected}")));
    }
    let marks = rows.marks(scene);
    let locks = meshes.iter().zip(&rows.of_meshes).zip(&scene.meshes).zip(&marks).enumerate();
    let locks = locks.map(|(i, (((json, rows), mesh), mark))| {
        let twin = LockTarget { rows, positions: &mesh.mesh.positions, mark };
        twin.locks(json).map_err(|reason| wrong(format!("mesh {i}: {reason}")))
    });
    locks.collect()
}

/// Mesh for which locks are read.
struct LockTarget<'a> {
    rows: &'a [VertexId],
    positions: &'a [[f64; 3]],
    mark: &'a str,
}

impl LockTarget<'_> {
    fn locks(&self, json: &Value) -> Result<Locks, String> {
        let ties = match json.get("ties") {
            None => &[],
            Some(ties) => ties.as_array().ok_or("\"ties\" is not a list")?.as_slice(),
        };
        let of_vertex = self.flags(json)?;
        match json.get("positions") {
            // Flags written by other programs need no mark.
            None => (),
            Some(mark) if *mark == self.mark => (),
            Some(_) => {
                return Err(
                    "the locks are for vertices at other positions; write them again".into()
                );
            }
        }
        let ties = ties.iter().enumerate().map(|(i, tie)| self.tie(i, tie));
        let ties: Vec<Vec<VertexId>> = ties.collect::<Result<_, _>>()?;
        // Rows of the same vertex need no tie.
        let ties = ties.into_iter().filter(|tie| tie.len() > 1).collect();
        Ok(Locks { of_vertex, ties })
    }

    fn flags(&self, json: &Value) -> Result<Vec<Lock>, String> {
        let flags = json["flags"].as_array().ok_or("has no flags")?;
        if flags.len() != self.rows.len() {
            let (found, expected) = (flags.len(), self.rows.len());
            return Err(format!("has flags for {found} vertices, but the input has {expected}"));
        }
        let mut of_vertex = vec![Lock::Free; self.positions.len()];
        for (row, (flag, v)) in flags.iter().zip(self.rows).enumerate() {
            let known = FLAGS.iter().find(|(_, known, _)| flag.as_u64() == Some((*known).into()));
            let &(lock, ..) =
                known.ok_or_else(|| format!("flag {row} is {flag}; it must be 0, 1 or 2"))?;
            of_vertex[v.index()] = lock.max(of_vertex[v.index()]);
        }
        Ok(of_vertex)
    }

    /// Returns the vertices of a tie, each once.
    fn tie(&self, i: usize, tie: &Value) -> Result<Vec<VertexId>, String> {
        let members = tie.as_array().ok_or_else(|| format!("tie {i} is not a list"))?;
        if members.len() < 2 {
            return Err(format!("tie {i} has {} vertices; it needs at least 2", members.len()));
        }
        let vertex = |row: &Value| {
            let index = row.as_u64().and_then(|row| usize::try_from(row).ok());
            let vertex = index.and_then(|index| self.rows.get(index).copied());
            vertex.ok_or_else(|| format!("tie {i} names vertex {row}, which does not exist"))
        };
        let mut tie: Vec<VertexId> = members.iter().map(vertex).collect::<Result<_, _>>()?;
        let place = |v: VertexId| bits(&self.positions[v.index()]);
        if let Some(apart) = tie.iter().position(|&v| place(v) != place(tie[0])) {
            let [first, apart] = [&members[0], &members[apart]];
            return Err(format!(
                "tie {i} has vertices at different positions: {first} and {apart}"
            ));
        }
        tie.sort_unstable();
        tie.dedup();
        Ok(tie)
    }
}
