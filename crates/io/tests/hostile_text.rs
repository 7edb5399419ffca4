//! OBJ, OFF and SMF from changed, truncated or invented bytes: a mesh or an error, never a panic.

use meshlod_io::{Precision, Scene, obj, off, smf};
use meshlod_mesh::Mesh;
use proptest::prelude::*;

const OBJ: &str = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1e-3 0.5\nvt 0 0\nvt 1 1\n\
    vn 0 0 1\no one\nusemtl red\nf 1/1/1 2/2/1 3//1 4\ng two\nf -4 -2 -1 1 2 \\\n 3\nf 3 2 1\n";
const MTL: &str = "newmtl red\nKd 1 0.5 0\nd -halo 0.5\nTr 0\nmap_Kd -s 1 2 3 red.png\n";
const OFF: &str = "STCNOFF4 2 5 # c\n0 0 0 0 0 1 1 0 0 1 0 0\n1 0 0 0 0 1 255 0 0 9 1 0\n\
    1 1 0 0 0 1 1 0 0 1 1 1\n0 1 0 0 0 1 1 0 0 1 0 1\n4 0 1 2 3 0.5\n3 0 1 2\n";
const SMF: &str = "#$SMF 1.0\nbegin\ntrans 1 2 3\nrot x 45\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n\
    set vertex_correction 0\nf 1 2 3 4\nt 1 2 -1\nbind c face\nc 1 0 0\nc 9 9 9\nbind n vertex\n\
    n 0 0 1\nn 1 0 0\nn 0 1 0\nn 0 1 1\nbind r vertex\nt_scale 2 2\nr 0 0\nr 1 0\nr 0 1\nr 1 1\nend\n";

/// Edits: position, number of bytes removed, bytes inserted.
fn edits() -> impl Strategy<Value = Vec<(usize, usize, Vec<u8>)>> {
    let words: Vec<Vec<u8>> = [
        "\n",
        " ",
        "\\\n",
        "\r",
        "#",
        "/",
        "-",
        "nan",
        "1e999",
        "-1",
        "0",
        "4294967296",
        "99999999999999999999",
        "f 1 2 3 4 1\n",
        "v 1e308 -1e308 1e-308\n",
        "begin\n",
        "end\n",
        "\0",
        "\u{feff}",
        "scale 1e200 0 -1\n",
        "v 0 0 0 0 0 0 0 0\n",
        ".",
        "e",
        "o\n",
        "usemtl \n",
        "bind c vertex\n",
    ]
    .map(|word| word.as_bytes().to_vec())
    .to_vec();
    let insert = prop_oneof![prop::sample::select(words), prop::collection::vec(any::<u8>(), 0..4)];
    prop::collection::vec((0_usize..500, 0_usize..8, insert), 0..6)
}

fn edited(text: &str, edits: &[(usize, usize, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for (at, removed, inserted) in edits {
        let start = at % (bytes.len() + 1);
        let end = (start + removed).min(bytes.len());
        bytes.splice(start..end, inserted.iter().copied());
    }
    bytes
}

/// Checks that the scene is valid and survives all writers and readers.
fn check(scene: &Scene) {
    let mesh = &scene.meshes[0].mesh;
    assert_eq!(mesh.validate(), Ok(()));
    for layer in mesh.attributes.iter().flat_map(|attributes| &attributes.layers) {
        assert!(layer.values.iter().all(|x| x.is_finite()), "{layer:?}");
    }
    let mut out = Vec::new();
    obj::write(scene, Precision::F64, &mut out, &[]).unwrap();
    let again = obj::read(&out, &mut |_| None).unwrap();
    // Behind the vertices are those that colours of faces split off.
    let again = &again.meshes[0].mesh;
    assert_eq!(again.positions[..mesh.positions.len()], mesh.positions);
    let corners = |mesh: &Mesh| -> Vec<_> {
        mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect()
    };
    assert_eq!(corners(again), corners(mesh));
    out.clear();
    off::write(mesh, Precision::F64, &mut out).unwrap();
    assert_eq!(off::read(&out).unwrap().faces.len(), mesh.faces.len());
    out.clear();
    smf::write(mesh, Precision::F64, &mut out).unwrap();
    assert_eq!(smf::read(&out).unwrap().faces.len(), mesh.faces.len());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn obj_never_panics(edits in edits(), library in edits()) {
        let library = edited(MTL, &library);
        let read = obj::read(&edited(OBJ, &edits), &mut |_| Some(library.clone()));
        match read {
            Ok(scene) => check(&scene),
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }

    #[test]
    fn off_never_panics(edits in edits()) {
        match off::read(&edited(OFF, &edits)) {
            Ok(mesh) => check(&Scene::from_mesh("", mesh)),
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }

    #[test]
    fn smf_never_panics(edits in edits()) {
        match smf::read(&edited(SMF, &edits)) {
            Ok(mesh) => check(&Scene::from_mesh("", mesh)),
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }
}

#[test]
fn the_seeds_themselves_are_well() {
    check(&obj::read(OBJ.as_bytes(), &mut |_| Some(MTL.as_bytes().to_vec())).unwrap());
    check(&Scene::from_mesh("", off::read(OFF.as_bytes()).unwrap()));
    check(&Scene::from_mesh("", smf::read(SMF.as_bytes()).unwrap()));
}
