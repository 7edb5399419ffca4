//! **meshlod** is level of detail for triangle meshes: it reads any common mesh, makes a much
//! smaller one that is close to it, measures how close, draws it, and writes it with everything
//! that came with it.
//!
//! # Words
//! - A **vertex** is a point of the surface, a **face** a triangle, a **corner** one of the three
//!   of a face.
//! - A **wedge** is a vertex with one set of attributes (what a GPU calls a vertex). A **seam** is
//!   an edge whose two faces use different wedges: the surface is continuous there, the texture is
//!   not.
//! - A **boundary edge** has one face, a **non-manifold edge** three or more.
//! - A **contraction** merges two or three vertices into one. A **refusal** is the reason why one
//!   is not allowed.
//! - A **level** is a mesh coarser than the input, a **chain** a list of levels.
//! - An **error** is a length in model units. `error_estimate` is the estimate of the algorithm;
//!   measured errors come from [`measure`]. The two are never mixed.
//!
//! # A tour
//! A [`Mesh`] holds positions, faces, attributes and labels. [`mesh`] has the type and its
//! [`Connectivity`](mesh::Connectivity), [`samples`] has procedural meshes of any size:
//!
//! ```
//! use meshlod::mesh::Connectivity;
//! use meshlod::samples;
//!
//! let knot = samples::knot(20_000);
//! let connectivity = Connectivity::new(&knot.faces, knot.positions.len());
//! assert!(connectivity.is_closed() && connectivity.non_manifold_edges() == 0);
//! ```
//!
//! [`simplify`](simplify()) makes a coarser mesh: of a number of faces, of a fraction of them, or
//! as coarse as an error allows, which is then proved. The report says what was reached, and if the
//! target was not, why:
//!
//! ```
//! # let knot = meshlod::samples::knot(20_000);
//! use meshlod::{Options, Target, simplify};
//!
//! let (level, report) = simplify(&knot, Target::Ratio(0.1), &Options::default())?;
//! assert!(report.reached && level.faces.len() <= 2_000);
//! # Ok::<(), meshlod::SimplifyError>(())
//! ```
//!
//! [`measure`] has the distance between two meshes, in both directions, and their areas and
//! volumes:
//!
//! ```
//! # use meshlod::{Options, Target, simplify};
//! # let knot = meshlod::samples::knot(20_000);
//! # let (level, _) = simplify(&knot, Target::Ratio(0.1), &Options::default())?;
//! use meshlod::measure::{DistanceOptions, distance, volume};
//!
//! let options = DistanceOptions { samples: 20_000, ..Default::default() };
//! let apart = distance(&knot, &level, &options)?;
//! assert!(apart.percent(apart.max()) < 0.5, "within half a percent of the diagonal");
//! assert!((volume(&level) / volume(&knot) - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`picture`] draws a mesh, with the same pixels on every machine:
//!
//! ```
//! # let level = meshlod::samples::knot(2_000);
//! use meshlod::picture::{Camera, Style, View, Wireframe, render};
//!
//! let camera = Camera::fit_mesh(&level, &View::default());
//! let wireframe = Some(Wireframe::default());
//! let style = Style { size: [200, 200], wireframe, ..Style::default() };
//! assert!(render(&level, &camera, &style)?.png().starts_with(b"\x89PNG"));
//! # Ok::<(), meshlod::picture::PictureError>(())
//! ```
//!
//! Files hold more than a mesh. [`read`] returns a [`Scene`]: nodes, meshes, materials, images, and
//! everything else of a glTF file. [`jobs`] has what a program does with it: [`jobs::simplify()`]
//! shares one target among its meshes, so that detail stays where the scene shows it, and proves an
//! error as it will be written. [`write()`] replaces the geometry and keeps the rest:
//!
//! ```
//! use meshlod::jobs::{Aim, SimplifyRequest, simplify};
//! use meshlod::{ReadOptions, WriteOptions, read, write};
//! # use meshlod::{Scene, samples};
//! # let folder = tempfile::tempdir()?;
//! # let [path, out] = ["fish.ply", "fish.glb"].map(|name| folder.path().join(name));
//! # write(&path, &Scene::from_mesh("fish", samples::fish(4_000)), &WriteOptions::default())?;
//!
//! let scene = read(&path, &ReadOptions::default())?;
//! let request = SimplifyRequest { target: Aim::Ratio(0.25), ..SimplifyRequest::default() };
//! let (scene, _) = simplify(scene, &request, &())?;
//! write(&out, &scene, &WriteOptions::default())?;
//! assert!(read(&out, &ReadOptions::default())?.flatten().faces.len() <= 1_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A chain of levels comes from one run, each level from the previous one, with the distance from
//! which it is fine enough. A GLB file holds all of them:
//!
//! ```
//! use meshlod::io::gltf::LodLayout;
//! use meshlod::io::write_lods;
//! use meshlod::jobs::{LodsRequest, lods};
//! use meshlod::{Scene, Target, samples};
//! # let folder = tempfile::tempdir()?;
//! # let out = folder.path().join("torus.glb");
//!
//! let scene = Scene::from_mesh("torus", samples::torus(4_000));
//! let levels = [0.5, 0.1].map(Target::Ratio).to_vec();
//! let (chain, report) = lods(scene, &LodsRequest { levels, ..LodsRequest::default() }, &())?;
//! assert!(report.levels[1].screen_coverage < report.levels[0].screen_coverage);
//! write_lods(&out, &chain.scene, &chain.levels, LodLayout::default())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`build`](jobs::build) makes one `.mlod` file of *all* levels of a scene, and
//! [`extract`](jobs::extract) takes from it the scene that a query asks for: fine in one region,
//! within an error in pixels of a camera, or of at most so many faces. No level has a crack, and the
//! file proves it. Both are [`jobs`], which any program asks for: plain data in, a report out, and
//! progress on the way. [`multires`] has the model behind them, with cuts that follow a camera:
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("knot.mlod");
//! use meshlod::jobs::{
//!     BuildRequest, ErrorLimit, ExtractRequest, QueryRequest, QueryTarget, build, extract,
//! };
//! use meshlod::multires::ViewCamera;
//! use meshlod::{AnyFile, Output, ReadOptions, Scene, samples};
//!
//! let knot = Scene::from_mesh("knot", samples::knot(4_000));
//! let (bytes, _) = build(knot, &BuildRequest::default(), &())?;
//! Output::new(&path)?.write_bytes(&bytes)?;
//!
//! let (eye, look, up) = ([0.0, 0.0, 20.0], [0.0; 3], [0.0, 1.0, 0.0]);
//! let camera = Some(ViewCamera { eye, look, up, fov_rad: 0.8, viewport: [640, 480] });
//! let target = QueryTarget::Error(ErrorLimit::Pixels(1.0));
//! let query = QueryRequest { target, camera, ..QueryRequest::default() };
//! let request = ExtractRequest { query, ..ExtractRequest::default() };
//! let file = AnyFile::open(&path, &ReadOptions::default())?;
//! let (_, far_away) = extract(file.levels().unwrap(), &request, &())?;
//! assert!(far_away.faces < 2_000, "as many faces as one pixel needs");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`jobs::compress`] packs a scene in a few bytes: `.mlq` to draw from directly, `.mlz` to send.
//! [`codec`] has the schemes:
//!
//! ```
//! # let knot = meshlod::samples::knot(4_000);
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("knot.mlz");
//! use meshlod::jobs::{CompressRequest, Packing, compress};
//! use meshlod::{AnyFile, Output, ReadOptions, Scene};
//!
//! let output = Output::new(&path)?;
//! let packing = Packing::of(output.kind()).expect(".mlz is compressed");
//! let request = CompressRequest { packing, ..CompressRequest::default() };
//! let (bytes, report) = compress(Scene::from_mesh("knot", knot), &request, &())?;
//! output.write_bytes(&bytes)?;
//! assert!(report.bytes_total < 4 * report.faces);
//! let back = AnyFile::open(&path, &ReadOptions::default())?.into_scene()?;
//! assert_eq!(back.meshes[0].mesh.faces.len(), report.faces);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`jobs::check`] lists what is wrong with a mesh, and where its objects touch. [`check`] has the
//! kinds of findings, repair, and locks that keep simplification from opening a contact:
//!
//! ```
//! use meshlod::check::{RepairOptions, repair};
//! use meshlod::jobs::{CheckRequest, check};
//! use meshlod::samples;
//!
//! let mut mesh = samples::torus(1_000);
//! mesh.faces.push(mesh.faces[7]);
//! let report = check(&mesh, &CheckRequest::default(), &())?;
//! assert!(report.has_errors(), "a face is there twice");
//! let (repaired, _) = repair(&mesh, &RepairOptions::default());
//! assert!(check(&repaired, &CheckRequest::default(), &())?.is_clean());
//! # Ok::<(), meshlod::jobs::JobError>(())
//! ```
//!
//! [`strip`] draws a mesh as triangle strips, one set for all levels: each vertex is replaced by
//! the one it has been contracted into, and strips are repaired where the level changed:
//!
//! ```
//! # let knot = meshlod::samples::knot(2_000);
//! use meshlod::Target;
//! use meshlod::strip::{
//!     Difference, MergeTree, SkipStrip, StripEffort, StripOptions, difference, stripify,
//! };
//!
//! let tree = MergeTree::record(&knot, Target::Ratio(0.1))?;
//! let strips = stripify(tree.faces(), &StripOptions::default());
//! let mut skip = SkipStrip::new(tree, strips);
//! skip.set_level(skip.tree().contractions_to(500));
//!
//! let (strips, level) = (skip.repaired(StripEffort::Quick), skip.tree().level(skip.level()));
//! assert_eq!(difference(&strips, &level), Difference::default());
//! assert!(strips.vertices().len() < 700, "three a triangle would be 1500");
//! # Ok::<(), meshlod::SimplifyError>(())
//! ```
//!
//! [`flock`] chooses a level for each of thousands of members, frame by frame, under a budget of
//! triangles, and [`flock::draw`] draws them. Members that swim, and scenes with a camera, are in
//! the crate `meshlod-school`:
//!
//! ```
//! use std::sync::Arc;
//! use meshlod::flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
//! use meshlod::flock::select::{Budget, PolicyName, Selector};
//! use meshlod::flock::{Flock, FlockCamera};
//!
//! let fish = meshlod::samples::fish(2_000);
//! let options = ChainOptions { axes: ModelAxes::FISH, ..ChainOptions::default() };
//! let table = Arc::new(LevelTable::new(&fish, &Look::default(), &options)?);
//! let mut selector = Selector::new(PolicyName::Ours, table);
//! let budget = Budget { triangles: 10_000, ..Budget::default() };
//!
//! let mut flock = Flock::default();
//! for member in 0..150 {
//!     flock.members.push([0.0, 0.0, -2.0 * member as f32], [1.0, 0.0, 0.0]);
//! }
//! let camera = FlockCamera::look_at([0.0, 1.0, 5.0], [0.0; 3], 0.8, [1920, 1080])?;
//! let levels = selector.select(&flock, &camera, &budget);
//! assert_eq!(levels.len(), 150);
//! assert!(selector.triangles() <= 10_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`spatial`] has the search structures behind these: the exact closest point of a surface.
//!
//! # Settings and reports as data
//! With the feature `serde`, options can be read from a file of any format and written to one, and
//! reports can be written. What a file leaves out has its default, and a name that no option has is
//! an error. Methods and the like go by the names that they print, targets by their unit. A number
//! that is not finite is `null` in JSON:
//!
//! ```
//! # #[cfg(feature = "serde")] {
//! use meshlod::{Options, Target, samples, simplify};
//!
//! let options: Options = serde_json::from_str(r#"{ "method": "qem", "topology": "keep" }"#)?;
//! let target: Target = serde_json::from_str(r#"{ "ratio": 0.1 }"#)?;
//! let (_, report) = simplify(&samples::torus(1_000), target, &options)?;
//! assert!(serde_json::to_string(&report)?.starts_with(r#"{"method":"qem","input_faces":"#));
//!
//! let misspelt = serde_json::from_str::<Options>(r#"{ "methods": "qem" }"#);
//! assert!(misspelt.unwrap_err().to_string().starts_with("unknown field `methods`"));
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Parts of options that have no default of their own, [`multires::ViewCamera`],
//! [`multires::Ground`] and [`codec::Lattice`], are given whole. What is not plain data stays in
//! code:
//! - [`multires::Query`], which may hold a function: [`jobs::QueryRequest`] is its form as data;
//! - [`picture::SeeThroughOptions`] and [`flock::levels::ImpostorOptions`], options of pictures;
//! - what options borrow, one value a face: [`strip::StripOptions::clusters`],
//!   [`measure::BeyondOptions::faces`].
//!
//! # Features
//! All of these but `serde` are on by default. With `default-features = false` there are [`mesh`], [`simplify`](mod@simplify),
//! [`measure`] and [`spatial`], with 18 crates below this one and no C.
//!
//! | feature | adds | and needs |
//! |---|---|---|
//! | `io` | [`io`]: files and scenes, [`scene::SceneSimplifier`] | |
//! | `check` | [`check`]: findings, repair, locks, [`Constraints`] | `io` |
//! | `picture` | [`picture`]: a rasteriser, the materials of scenes | `io` |
//! | `multires` | [`multires`]: all levels in a file, [`jobs::build`], [`jobs::extract`]; compiles zstd, which is C | `check`, `picture` |
//! | `strip` | [`strip`]: triangle strips for any level | `multires` |
//! | `codec` | [`codec`]: meshes in few bytes, [`jobs::compress`] | `strip` |
//! | `flock` | [`flock`]: a level for each of thousands of members | `multires` |
//! | `samples` | [`samples`]: procedural meshes | |
//! | `draco` | glTF compressed by Draco is read | `io` |
//! | `serde` | options and reports as data, of whatever else is on | |
//!
//! Others let meshes of other crates in and out by [`mesh::MeshArrays`], and are off:
//!
//! | feature | adds |
//! |---|---|
//! | `glam`, `mint` | vectors and points of glam 0.34 and mint 0.5 are [`mesh::Point`]s, which arrays are made of |
//! | `bytemuck` | ids are plain numbers: `bytemuck::cast_slice(&mesh.faces)` is a list of indices |
//! | `bevy_mesh` | [`mesh::MeshArrays`] from a mesh of Bevy 0.20, and back |
//!
//! These versions are part of the version of meshlod. Bevy has a glam of its own, whose vectors
//! become points by way of mint or as arrays.
//!
//! # Guarantees
//! - No input makes it crash: errors in files are reported in one line with their position.
//! - The same input and options give the same bytes, for any number of threads.
//! - With [`Topology::Keep`] a surface is as manifold, as closed and as oriented as before after
//!   every contraction; with [`Topology::Free`], the default, borders that lie on each other may be
//!   sewn together, non-manifold places may come apart, and components may vanish.
//! - Files are written whole or not at all.
#![forbid(unsafe_code)]

/// The example of the package's page is compiled and run, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExample;

mod bound;
mod bounded;
mod conditioned;

#[cfg(feature = "io")]
mod files;
#[cfg(feature = "io")]
pub mod jobs;
#[cfg(feature = "multires")]
pub mod model;
#[cfg(feature = "io")]
#[doc(hidden)]
pub mod numbers;
#[cfg(feature = "io")]
pub mod scene;

pub use meshlod_measure as measure;
pub use meshlod_mesh as mesh;
#[doc(inline)]
pub use meshlod_simplify as simplify;
pub use meshlod_spatial as spatial;

#[cfg(feature = "check")]
pub use meshlod_check as check;
#[cfg(feature = "codec")]
pub use meshlod_codec as codec;
#[cfg(feature = "flock")]
pub use meshlod_flock as flock;
#[cfg(feature = "io")]
pub use meshlod_io as io;
#[cfg(feature = "multires")]
pub use meshlod_multires as multires;
#[cfg(feature = "picture")]
pub use meshlod_picture as picture;
#[cfg(feature = "samples")]
pub use meshlod_samples as samples;
#[cfg(feature = "strip")]
pub use meshlod_strip as strip;
#[cfg(feature = "tiles")]
pub use meshlod_tiles as tiles;

pub use bound::Bound;
pub use conditioned::simplify;
pub use meshlod_mesh::{Borders, Mesh};
pub use meshlod_simplify::{Method, Options, Report, SimplifyError, Target, Topology};

#[cfg(feature = "codec")]
pub use files::{AnyFile, AnyFileError, FileBytes};
#[cfg(feature = "io")]
pub use files::{FileKind, Output};
#[cfg(feature = "io")]
pub use meshlod_io::{Format, IoError, ReadOptions, Scene, WriteOptions, read, write};
#[cfg(feature = "check")]
pub use scene::{Constraints, VertexLocking};
