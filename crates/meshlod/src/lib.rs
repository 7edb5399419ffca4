//! **meshlod** is level of detail for triangle meshes: read any common mesh, get a much smaller one
//! that is close, know how close, look at it, write it with all that came with it.
//!
//! # Words
//! - A **vertex** is a point of the surface, a **face** a triangle, a **corner** one of its three.
//! - A **wedge** is a vertex with one set of attributes (what a GPU calls a vertex). A **seam** is
//!   an edge whose two faces use different wedges: the surface is whole there, the texture is not.
//! - A **boundary edge** has one face, a **non-manifold edge** three or more.
//! - A **contraction** makes one vertex of two or three. A **refusal** is why one may not happen.
//! - A **level** is a mesh coarser than the input, a **chain** a list of levels.
//! - An **error** is a length in model units. `error_estimate` is the algorithm's own word;
//!   a measured one comes from [`measure`]. They are never mixed.
//!
//! # A tour
//! A [`Mesh`] is positions, faces, and what hangs on them. [`mesh`] has the type, its
//! [`Connectivity`](mesh::Connectivity), and procedural samples of any size:
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
//! [`simplify`](simplify()) makes it coarser: to a number of faces, to a part of them, or as far as
//! an error allows. The report says what was reached, and if it was not, why.
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
//! [`measure`] says how far two meshes are apart, both ways, and what became of area and volume:
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
//! [`picture`] draws it, with the same pixels on every machine:
//!
//! ```
//! # let level = meshlod::samples::knot(2_000);
//! use meshlod::picture::{Camera, Style, View, Wireframe, render};
//!
//! let camera = Camera::fit_mesh(&level, &View::default());
//! let style = Style { size: [200, 200], wireframe: Some(Wireframe::default()), ..Style::default() };
//! assert!(render(&level, &camera, &style)?.png().starts_with(b"\x89PNG"));
//! # Ok::<(), meshlod::picture::PictureError>(())
//! ```
//!
//! Files hold more than a mesh. [`read`] gives a [`Scene`]: nodes, meshes, materials, images, and of
//! glTF all the rest. [`simplify_scene`] shares one target among its meshes, so that detail stays
//! where the world shows it; [`write()`] puts the coarser geometry in the place of the old one and
//! keeps everything else.
//!
//! ```
//! use meshlod::{Options, ReadOptions, Target, WriteOptions, read, simplify_scene, write};
//! # use meshlod::{Scene, samples};
//! # let folder = tempfile::tempdir()?;
//! # let [path, out] = ["fish.ply", "fish.glb"].map(|name| folder.path().join(name));
//! # write(&path, &Scene::from_mesh("fish", samples::fish(4_000)), &WriteOptions::default())?;
//!
//! let mut scene = read(&path, &ReadOptions::default())?;
//! simplify_scene(&mut scene, Target::Ratio(0.25), &Options::default())?;
//! write(&out, &scene, &WriteOptions::default())?;
//! assert!(read(&out, &ReadOptions::default())?.flatten().faces.len() <= 1_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A chain of levels comes from one run, each level from the one before; GLB holds it whole:
//!
//! ```
//! use meshlod::io::{gltf::Level, write_lods};
//! use meshlod::{Options, Scene, SceneSimplifier, Target, samples};
//! # let folder = tempfile::tempdir()?;
//! # let out = folder.path().join("torus.glb");
//!
//! let scene = Scene::from_mesh("torus", samples::torus(4_000));
//! let mut simplifier = SceneSimplifier::new(&scene, &Options::default())?;
//! let mut levels = Vec::new();
//! for (ratio, screen_coverage) in [(0.5, 0.4), (0.1, 0.1)] {
//!     simplifier.run(Target::Ratio(ratio), &mut ())?;
//!     levels.push(Level { meshes: simplifier.level(), screen_coverage });
//! }
//! write_lods(&out, &scene, &levels)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`strip`] draws it as triangle strips, one set of them at every level: vertices are shown by what they have become,
//! and strips are mended where the level changed.
//!
//! ```
//! # let knot = meshlod::samples::knot(2_000);
//! use meshlod::Target;
//! use meshlod::strip::{Difference, Effort, MergeTree, Options, SkipStrip, difference, stripify};
//!
//! let tree = MergeTree::record(&knot, Target::Ratio(0.1))?;
//! let strips = stripify(tree.faces(), &Options::default());
//! let mut skip = SkipStrip::new(tree, strips);
//! skip.set_level(skip.tree().contractions_to(500));
//!
//! let (strips, level) = (skip.repaired(Effort::Quick), skip.tree().level(skip.level()));
//! assert_eq!(difference(&strips, &level), Difference::default());
//! assert!(strips.vertices().len() < 700, "three a triangle would be 1500");
//! # Ok::<(), meshlod::SimplifyError>(())
//! ```
//!
//! [`spatial`] has what the others search with: the exact closest point of a surface.
//!
//! # What always holds
//! No input crashes it: what is wrong with a file is said in one line that names the place. Same
//! input, same options, same bytes out, for any number of threads. After every contraction a
//! surface is as manifold, as closed and as oriented as before. Files are written whole or not at
//! all.
#![forbid(unsafe_code)]

mod contacts;
mod exact_volume;
mod fuse;
mod locks;
mod materials;
mod place;
mod repair;
mod scene;

pub use meshlod_check as check;
pub use meshlod_codec as codec;
pub use meshlod_io as io;
pub use meshlod_measure as measure;
pub use meshlod_mesh as mesh;
pub use meshlod_multires as multires;
pub use meshlod_picture as picture;
pub use meshlod_samples as samples;
#[doc(inline)]
pub use meshlod_simplify as simplify;
pub use meshlod_spatial as spatial;
pub use meshlod_strip as strip;

pub use contacts::scene_locks;
pub use exact_volume::{conserve_volumes, digits_of};
pub use fuse::fuse_scene;
pub use locks::join_locks;
pub use materials::{UnreadImage, materials_of};
pub use meshlod_io::{Format, IoError, ReadOptions, Scene, WriteOptions, read, write};
pub use meshlod_mesh::Mesh;
pub use meshlod_simplify::{Method, Options, Report, SimplifyError, Target, simplify};
pub use place::world_bounds;
pub use repair::repair_scene;
pub use scene::{SceneError, SceneSimplifier, simplify_scene};
