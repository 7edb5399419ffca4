//! Seed files, made by our writers and by hand, so that mutations start near the grammar.

use meshlod_codec::{
    CompressionTarget, Lattice, Reconstruction, Scheme, Transport, TransportOptions,
    TransportQuantization, compress,
};
use meshlod_fixtures as fixtures;
use meshlod_io::gltf::Skeleton;
use meshlod_io::{Precision, Scene, Weld, gltf, obj, off, ply, smf, stl};
use meshlod_mesh::{AttributeBounds, Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use meshlod_samples as samples;
use meshlod_simplify::{self as simplify, History, Options, Progressive, Simplifier};

use crate::draco;
use crate::models;

/// Makes the seeds of a target.
pub fn seeds(target: &str) -> Vec<Vec<u8>> {
    let meshes = [fixtures::cube(), fixtures::seam_strip(), fixtures::two_objects()];
    match target {
        "check" => return few_faces(),
        "draco" => return draco::seeds(),
        "mlod" => return models::seeds(),
        "mlq" => return compressed(),
        "mlz" => return transports(),
        // Random bytes are such meshes.
        "simplify" => return Vec::new(),
        "mtl" => return vec![std::fs::read(fixtures::own_file("full.mtl")).expect("our own file")],
        "skeleton" => return skeletons(),
        _ => {}
    }
    let by_hand: &[&str] = match target {
        "ply" => &PLY,
        "obj" => &OBJ,
        "stl" => &STL,
        "off" => &OFF,
        "smf" => &SMF,
        "progressive" => &[],
        _ => &GLTF,
    };
    let written = meshes.iter().map(|mesh| write(target, mesh));
    let small = if target == "gltf" { small_gltf(&meshes) } else { Vec::new() };
    written.chain(small).chain(by_hand.iter().map(|text| text.as_bytes().to_vec())).collect()
}

/// Makes skeletons of the documents written by hand.
fn skeletons() -> Vec<Vec<u8>> {
    let read = |text: &&str| gltf::read(text.as_bytes(), &mut |_| None, Weld::Exact).ok();
    let of = |scene: Scene| Skeleton::of(&scene, vec![true; scene.meshes.len()]).ok();
    GLTF.iter().filter_map(read).filter_map(of).map(|skeleton| skeleton.document).collect()
}

fn write(target: &str, mesh: &Mesh) -> Vec<u8> {
    let scene = Scene::from_mesh("seed", mesh.clone());
    let mut out = Vec::new();
    match target {
        "ply" => ply::write(mesh, Precision::F64, &mut out),
        "obj" => obj::write(&scene, Precision::F32, &mut out, &["seed.mtl".to_owned()]),
        "stl" => stl::write(mesh, &mut out),
        "off" => off::write(mesh, Precision::F32, &mut out),
        "smf" => smf::write(mesh, Precision::F32, &mut out),
        "progressive" => {
            out = sequence(mesh);
            Ok(())
        }
        _ => {
            out = gltf::write_glb(&scene, &[]).expect("a fixture fits");
            Ok(())
        }
    }
    .expect("writing to memory succeeds");
    out
}

/// Meshes as glTF with integer components, with and without compressed streams, and with every
/// filter.
fn small_gltf(meshes: &[Mesh]) -> Vec<Vec<u8>> {
    let write = |mesh: &Mesh, meshopt: bool| {
        let scene = Scene::from_mesh("seed", mesh.clone());
        let how = gltf::Compression { meshopt, ..gltf::Compression::default() };
        gltf::write_compressed_glb(&scene, &[], &how).expect("a fixture fits").0
    };
    let mut all: Vec<Vec<u8>> =
        meshes.iter().flat_map(|mesh| [write(mesh, false), write(mesh, true)]).collect();
    all.push(FILTERED.as_bytes().to_vec());
    all
}

/// Meshes of one block and of several, on a grid and on a lattice, with attributes and labels and
/// without.
fn transports() -> Vec<Vec<u8>> {
    let lattice = Lattice::new(-6).expect("an exponent");
    let meshes = [
        fixtures::cube(),
        fixtures::hourglass(),
        fixtures::moebius(20),
        samples::knot(90),
        fixtures::seam_strip(),
        fixtures::two_objects(),
        with_every_layer(fixtures::grid(4)),
    ];
    let write = |mesh: &Mesh, quantization| {
        let bare = TransportOptions::default();
        let options = TransportOptions { quantization, block_faces: 16, ..bare };
        let resources: &[u8] = if mesh.materials.is_some() { b"materials" } else { b"" };
        let done = Transport::encode_with_resources(mesh, resources, &options);
        done.expect("a fixture fits").bytes
    };
    let grids = [TransportQuantization::Bits(5), TransportQuantization::Lattice(lattice)];
    let written =
        meshes.iter().flat_map(|mesh| grids.map(|quantization| write(mesh, quantization)));
    // Files whose faces are coded step by step.
    let kept = ["knot-v1.mlz", "terrain-v1.mlz", "quad-v2.mlz"].map(fixtures::own_file);
    let kept = kept.map(|path| std::fs::read(path).expect("our own file"));
    written.chain(kept).collect()
}

/// Gives a mesh layers of all kinds, and materials and objects.
fn with_every_layer(mut mesh: Mesh) -> Mesh {
    let kinds = [
        (LayerKind::Normal, 3),
        (LayerKind::Uv(0), 2),
        (LayerKind::Tangent, 4),
        (LayerKind::Color(0), 3),
        (LayerKind::Joints(0), 4),
        (LayerKind::Weights(0), 4),
        (LayerKind::Other, 2),
    ];
    let corners: Vec<_> = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let count = mesh.positions.len();
    let layer = |(kind, width): (LayerKind, usize)| {
        let value = |at: usize| (at * 7 % 11) as f32 / 11.0;
        let values = (0..width * count).map(value).collect();
        Layer { kind, name: format!("{kind:?}"), width, values }
    };
    let layers = kinds.map(layer).into();
    mesh.attributes = Some(Attributes { corners, wedge_count: count, layers });
    let of_face: Vec<u32> = (0..mesh.faces.len() as u32).map(|face| face / 5 % 2).collect();
    let labels = |name: &str| {
        let names = [1, 2].map(|k| format!("{name} {k}")).into();
        Some(Labels { names, of_face: of_face.clone() })
    };
    (mesh.materials, mesh.objects) = (labels("material"), labels("object"));
    mesh
}

/// A progressive mesh of all possible contractions.
fn sequence(mesh: &Mesh) -> Vec<u8> {
    let mut history = History::default();
    let mut simplifier = Simplifier::new(mesh, &Options::default()).expect("a fixture is a mesh");
    simplifier.run(simplify::Target::Faces(0), &mut history).expect("a target");
    Progressive::new(simplifier, history).expect("every contraction is recorded").to_bytes()
}

/// Small meshes compressed by every scheme.
fn compressed() -> Vec<Vec<u8>> {
    let meshes = [
        fixtures::cube(),
        fixtures::seam_strip(),
        fixtures::hourglass(),
        fixtures::grid(9),
        samples::torus(300),
        with_every_layer(fixtures::grid(4)),
    ];
    let schemes = [
        Scheme::Parts(Reconstruction::Centred),
        Scheme::Parts(Reconstruction::Truncated),
        Scheme::Blocks,
        Scheme::Lattice,
    ];
    let bounds = AttributeBounds::default();
    let by = |mesh: &Mesh, scheme| compress(mesh, scheme, CompressionTarget::Bits(8), &bounds);
    let done = meshes.iter().flat_map(|mesh| schemes.map(|scheme| by(mesh, scheme)));
    let compressed = done.map(|done| done.expect("a mesh").compressed);
    let each = compressed.flat_map(|compressed| {
        // A strip for each face, where there are parts.
        let faces = compressed.stored().expect("undamaged").faces;
        let stripped = compressed.clone().with_strips(faces).ok();
        stripped.into_iter().chain([compressed])
    });
    each.map(|compressed| compressed.with_resources(b"materials".to_vec()).to_bytes()).collect()
}

/// Small meshes in the input format of the target `check`, with its options for attributes and
/// holes.
fn few_faces() -> Vec<Vec<u8>> {
    let meshes = [
        fixtures::cube(),
        fixtures::fan(),
        fixtures::grid(2),
        fixtures::hourglass(),
        fixtures::moebius(4),
        fixtures::two_objects(),
    ];
    let bytes = |mesh: &Mesh, extras: u8| {
        let coordinates = mesh.positions.as_flattened().iter().map(|&x| (x * 4.0) as i8 as u8);
        let corners = mesh.faces.as_flattened().iter().map(|v| v.0 as u8);
        let header = [mesh.positions.len() as u8 - 3, extras];
        header.into_iter().chain(coordinates).chain(corners).collect()
    };
    let extras = [0, 1, 4, 5, 0x1f, 0xff];
    meshes.iter().flat_map(|mesh| extras.map(|extras| bytes(mesh, extras))).collect()
}

const PLY: [&str; 4] = [
    "ply\nformat ascii 1.0\ncomment TextureFile a.png\nobj_info i\ncomment TextureFile b.png\nx\n\
     element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
     property ushort intensity\nelement edge 1\nproperty int a\nelement face 2\n\
     property list uchar int vertex_indices\nproperty list uchar float texcoord\n\
     property int texnumber\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
     property short label\nend_header\n0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1 0 4\n7\n\
     3 0 1 2 6 0 0 1 0 1 1 0 255 0 0 -1\n3 0 2 3 6 .5 .5 1 0 0 1 1 0 0 255 2\n",
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\n\
     property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
     property float nx\nproperty float ny\nproperty float nz\nelement face 2\n\
     property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
     0 0 0 255 0 0 0 0 1\n1 0 0 0 255 0 0 0 1\n1 1 0 0 0 255 0 0 1\n0 1 0 9 9 9 0 0 1\n\
     4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 1 2 6 0 0 1 0 1 1\n",
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
     property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
     0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n",
    "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
     property float z\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n\
     ????????????????????????????????????\u{3}\0\0\0\0\0\0\0\u{1}\0\0\0\u{2}",
];

const OBJ: [&str; 2] = [
    "# c\nmtllib a.mtl\no first\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0.5 0.2 0\n\
     v 0 1e0 0\nvt 0 0\nvt 1 0.5 0\nvn 0 0 1\ng part one\nusemtl red\ns 1\n\
     f 1/1/1 2/2/1 3/1/1 4/2/1 5/1/1\nf -1//-1 -2//-1 -3//-1\nf 1 2 \\\n3\nl 1 2\np 1\n",
    "newmtl red\nKd 1 0 0\nd 0.5\nmap_Kd -s 1 1 1 a.png\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
];

const STL: [&str; 2] = [
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
     endfacet\nendsolid a\nsolid b\nendsolid b\n",
    "solid\n facet normal 0 0 0\n  outer loop\n   vertex 0 0 1e-3\n   vertex +1. 0 0\n   \
     vertex 0 -1E2 0\n  endloop\n endfacet\nendsolid\n",
];

const OFF: [&str; 4] = [
    "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0 # c\n0 1 0\n4 0 1 2 3\n3 0 1 2 255 0 0\n",
    "COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n0 1 0 0 0 1 1\n3 0 1 2\n",
    "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
    "STCNOFF 3 1 0\n0 0 0 0 0 1 1 0 0 1 0 0\n1 0 0 0 0 1 1 0 0 1 0 0\n\
     0 1 0 0 0 1 1 0 0 1 0 0\n3 0 1 2\n",
];

const SMF: [&str; 2] = [
    "#$SMF 1.0\n#$vertices 4\nbegin\ntrans 1 0 0\nscale 2 2 2\nrot x 90\nv 0 0 0\nv 1 0 0\n\
     v 0 1 0\nv 0 0 1\nend\nbind c vertex\nc 1 0 0\nc 0 1 0\nc 0 0 1\nc 1 1 1\nt 1 2 3\nf 1 2 3 4\n",
    "bind n face\nbind r vertex\nv 0 0 0\nv 1 0 0\nv 0 1 0\nn 0 0 1\nr 0 0\nr 1 0\nr 0 1\nf -1 -2 -3\n",
];

/// A triangle in streams of version 1 with each filter, and one in index streams.
const FILTERED: &str = r#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_meshopt_compression","KHR_mesh_quantization"],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"COLOR_0":2,"TEXCOORD_0":3},"indices":4}]}],"nodes":[{"mesh":0}],
"accessors":[{"bufferView":1,"componentType":5122,"normalized":true,"count":4,"type":"VEC3"},{"bufferView":0,"componentType":5122,"normalized":true,"count":4,"type":"VEC3"},{"bufferView":2,"componentType":5123,"normalized":true,"count":4,"type":"VEC4"},{"bufferView":3,"componentType":5126,"count":4,"type":"VEC2"},{"bufferView":4,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":1,"byteLength":32,"extensions":{"KHR_meshopt_compression":{"buffer":0,"byteOffset":0,"byteLength":27,"byteStride":8,"count":4,"mode":"ATTRIBUTES","filter":"OCTAHEDRAL"}}},
{"buffer":1,"byteLength":32,"extensions":{"KHR_meshopt_compression":{"buffer":0,"byteOffset":0,"byteLength":27,"byteStride":8,"count":4,"mode":"ATTRIBUTES","filter":"QUATERNION"}}},
{"buffer":1,"byteLength":32,"extensions":{"KHR_meshopt_compression":{"buffer":0,"byteOffset":0,"byteLength":27,"byteStride":8,"count":4,"mode":"ATTRIBUTES","filter":"COLOR"}}},
{"buffer":1,"byteLength":32,"extensions":{"KHR_meshopt_compression":{"buffer":0,"byteOffset":0,"byteLength":27,"byteStride":8,"count":4,"mode":"ATTRIBUTES","filter":"EXPONENTIAL"}}},
{"buffer":1,"byteLength":6,"extensions":{"KHR_meshopt_compression":{"buffer":0,"byteOffset":27,"byteLength":8,"byteStride":2,"count":3,"mode":"INDICES"}}}],
"buffers":[{"byteLength":35,"uri":"data:;base64,oaqqAAAAAAAAAAAAAAAAAAAKABQA/wEAAgAB0QAEBAAAAAA="},{"byteLength":64}]}"#;

const GLTF: [&str; 2] = [
    r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"children":[1],"translation":[1,0,0],"scale":[2,2,2]},{"rotation":[0,0,0,1],"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0},{"attributes":{"POSITION":0},"mode":5}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"baseColorTexture":{"index":0}}}],
"textures":[{"source":0}],"images":[{"uri":"a.png"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0],
"sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}}},
{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],
"buffers":[{"byteLength":39,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC"}]}"#,
    r#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"extensionsUsed":["KHR_mesh_quantization","MSFT_lod"],
"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"extensions":{"MSFT_lod":{"ids":[1]}}},{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"targets":[{"POSITION":0}]}]}],
"accessors":[{"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"},{"bufferView":0,"byteOffset":0,"componentType":5123,"normalized":true,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":12,"byteStride":4}],
"buffers":[{"byteLength":12,"uri":"data:;base64,AAAAAEAAAAAAQAAA"}]}"#,
];
