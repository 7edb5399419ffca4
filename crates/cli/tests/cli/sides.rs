//! Pictures of glTF models whose materials are seen from one side only.

use meshlod::io::{Material, Node, SceneMesh};
use meshlod::picture::Texture;
use meshlod::{Scene, WriteOptions, samples, write};

use crate::run::Run;

/// A red ball within a larger black one.
struct Outlined {
    /// The black ball shows its inner side, as outlines are made.
    is_inverted: bool,
    /// The black material is seen from both sides.
    is_double_sided: bool,
    /// The node of the black ball mirrors.
    is_mirrored: bool,
}

const OUTLINE: Outlined =
    Outlined { is_inverted: true, is_double_sided: false, is_mirrored: false };

impl Outlined {
    fn scene(&self) -> Scene {
        let ball = samples::sphere(1_000);
        let mut hull = ball.clone();
        if self.is_inverted {
            hull.faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        hull.attributes = None;
        let mesh = |mesh, material| SceneMesh {
            mesh,
            materials: vec![Some(material)],
            ..SceneMesh::default()
        };
        let node = |mesh, [x, y, z]: [f64; 3]| Node {
            mesh: Some(mesh),
            transform: [
                [x, 0.0, 0.0, 0.0],
                [0.0, y, 0.0, 0.0],
                [0.0, 0.0, z, 0.0],
                [0.0, 0.0, 0.0, 1.0],
            ],
            ..Node::default()
        };
        let side = if self.is_mirrored { -1.1 } else { 1.1 };
        Scene {
            meshes: vec![mesh(ball, 0), mesh(hull, 1)],
            nodes: vec![node(0, [1.0; 3]), node(1, [side, 1.1, 1.1])],
            roots: vec![0, 1],
            materials: vec![
                Material { base_color: [1.0, 0.0, 0.0, 1.0], ..Material::default() },
                Material {
                    base_color: [0.0, 0.0, 0.0, 1.0],
                    is_double_sided: self.is_double_sided,
                    ..Material::default()
                },
            ],
            ..Scene::default()
        }
    }

    /// Returns the pixels in the middle and at the left rim of a picture of the balls.
    fn middle_and_rim(&self) -> [[u8; 4]; 2] {
        let run = Run::new();
        write(run.path("in.glb"), &self.scene(), &WriteOptions::default()).unwrap();
        run.json(&["render", "in.glb", "out.png", "--size", "101x101", "--view", "front"]);
        let png = std::fs::read(run.path("out.png")).unwrap();
        let texture = Texture::decode(&png).unwrap();
        let (width, _, texels) = texture.levels().next().unwrap();
        let row = &texels[(50 * width) as usize..(51 * width) as usize];
        // The rim is the first pixel that is clearly darker than the background.
        let rim = row.iter().find(|texel| texel[1] < 100).unwrap();
        [row[50], *rim]
    }
}

fn is_red([red, green, ..]: [u8; 4]) -> bool {
    red > 100 && green < 80
}

fn is_black(texel: [u8; 4]) -> bool {
    texel[..3].iter().all(|&level| level < 80)
}

#[test]
fn an_outline_hull_shows_its_rim_and_not_its_back() {
    for is_mirrored in [false, true] {
        let [middle, rim] = Outlined { is_mirrored, ..OUTLINE }.middle_and_rim();
        assert!(is_red(middle) && is_black(rim), "mirrored {is_mirrored}: {middle:?} {rim:?}");
    }
}

#[test]
fn a_hull_hides_what_is_within_if_it_has_two_sides_or_faces_outwards() {
    let two_sided = Outlined { is_double_sided: true, ..OUTLINE };
    let outwards = Outlined { is_inverted: false, ..OUTLINE };
    let mirrored = Outlined { is_mirrored: true, ..outwards };
    for hull in [two_sided, outwards, mirrored] {
        let [middle, _] = hull.middle_and_rim();
        assert!(is_black(middle), "{middle:?}");
    }
}

#[test]
fn image_errors_are_those_of_what_is_seen() {
    let run = Run::new();
    write(run.path("in.glb"), &OUTLINE.scene(), &WriteOptions::default()).unwrap();
    let two_sided = Outlined { is_double_sided: true, ..OUTLINE };
    write(run.path("both.glb"), &two_sided.scene(), &WriteOptions::default()).unwrap();
    let flip = |file: &str| {
        let arguments = ["compare", file, "--out", file.split_at(2).0, "--ratio", "20%"];
        let options = ["--methods", "qem", "--samples", "1000"];
        let json = run.json(&[&arguments[..], &options].concat());
        json["methods"][0]["levels"][0]["flip"].as_f64().unwrap()
    };
    let [one, both] = ["in.glb", "both.glb"].map(flip);
    assert!(one != both, "a black ball differs less from its levels than a red one: {one}");
}
