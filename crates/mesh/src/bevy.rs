//! Meshes of Bevy, from plain arrays and back.

use bevy_mesh::{
    Indices, Mesh as BevyMesh, MeshVertexAttribute, PrimitiveTopology,
    VertexAttributeValues as Values,
};
use thiserror::Error;

use crate::{ArraysError, Layer, LayerKind, MeshArrays, Point, strip_triangles};

/// Reason why a mesh of Bevy cannot become plain arrays, or arrays a mesh of Bevy.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum BevyMeshError {
    /// The data are in the render world alone.
    #[error("the mesh is in the render world only; asset_usage must include MAIN_WORLD")]
    NotInMainWorld,
    /// The mesh has points or lines instead of triangles.
    #[error("the mesh is a {0:?}, not a list or strip of triangles")]
    NotTriangles(PrimitiveTopology),
    /// The number of indices of a list is not a multiple of three.
    #[error("a list of triangles needs a multiple of three indices, not {0}")]
    BadIndexCount(usize),
    /// There are no positions.
    #[error("the mesh has no positions")]
    NoPositions,
    /// An attribute is compressed, or a custom one that does not have single precision.
    #[error(
        "{name}: {format} is not read; remove the attribute, or convert the mesh before compressing it"
    )]
    BadFormat {
        /// Name of the attribute.
        name: &'static str,
        /// Format of its values.
        format: String,
    },
    /// Bevy has no attribute of this kind.
    #[error(
        "{0}: Bevy has no such attribute; remove the layer, or insert it as a custom attribute"
    )]
    NoAttribute(String),
    /// Bevy has one attribute of each kind, but there are two layers.
    #[error("{0}: a second layer of this kind; remove one")]
    SecondLayer(String),
    /// A layer has another number of values for each point than the attribute of Bevy.
    #[error("{name}: {width} values for each point do not fit the attribute of Bevy")]
    BadWidth {
        /// Name of the layer.
        name: String,
        /// Number of values for each point.
        width: usize,
    },
    /// A number does not fit into single precision, or a joint not into 16 bits.
    #[error("{name}: row {row} does not fit: {value}")]
    OutOfRange {
        /// Name of the array.
        name: String,
        /// Row of the point.
        row: usize,
        /// Value that does not fit.
        value: f64,
    },
    /// The arrays are not a mesh.
    #[error(transparent)]
    Arrays(#[from] ArraysError),
}

/// Attributes of Bevy that have a type here.
const ATTRIBUTES: [(MeshVertexAttribute, LayerKind); 7] = [
    (BevyMesh::ATTRIBUTE_NORMAL, LayerKind::Normal),
    (BevyMesh::ATTRIBUTE_UV_0, LayerKind::Uv(0)),
    (BevyMesh::ATTRIBUTE_UV_1, LayerKind::Uv(1)),
    (BevyMesh::ATTRIBUTE_TANGENT, LayerKind::Tangent),
    (BevyMesh::ATTRIBUTE_COLOR, LayerKind::Color(0)),
    (BevyMesh::ATTRIBUTE_JOINT_INDEX, LayerKind::Joints(0)),
    (BevyMesh::ATTRIBUTE_JOINT_WEIGHT, LayerKind::Weights(0)),
];

/// Copies the mesh. Custom attributes of single precision become layers of the kind
/// [`LayerKind::Other`], and others are errors; morph targets stay behind.
///
/// Indices are as they were: [`Mesh::from_arrays`](crate::Mesh::from_arrays) checks them.
impl TryFrom<&BevyMesh> for MeshArrays {
    type Error = BevyMeshError;

    fn try_from(mesh: &BevyMesh) -> Result<Self, BevyMeshError> {
        let attributes = mesh.try_attributes().map_err(|_| BevyMeshError::NotInMainWorld)?;
        let mut arrays = Self::default();
        let mut has_positions = false;
        for (attribute, values) in attributes {
            match values {
                Values::Float32x3(points) if attribute.id == BevyMesh::ATTRIBUTE_POSITION.id => {
                    arrays.positions = points.iter().map(|point| point.to_f64()).collect();
                    has_positions = true;
                }
                _ => arrays.layers.push(layer_of(attribute, values)?),
            }
        }
        if !has_positions {
            return Err(BevyMeshError::NoPositions);
        }
        arrays.faces = faces_of(mesh, arrays.positions.len())?;
        Ok(arrays)
    }
}

/// Returns the faces, of points in order where the mesh has no indices.
fn faces_of(mesh: &BevyMesh, points: usize) -> Result<Vec<[u32; 3]>, BevyMeshError> {
    let indices = mesh.try_indices_option().map_err(|_| BevyMeshError::NotInMainWorld)?;
    let (indices, restart): (Vec<u32>, u32) = match indices {
        Some(Indices::U16(indices)) => {
            (indices.iter().copied().map(u32::from).collect(), u16::MAX.into())
        }
        Some(Indices::U32(indices)) => (indices.clone(), u32::MAX),
        None => ((0..points).map(|i| i as u32).collect(), u32::MAX),
    };
    match mesh.primitive_topology() {
        PrimitiveTopology::TriangleStrip => {
            Ok(indices.split(|&i| i == restart).flat_map(strip_triangles).collect())
        }
        PrimitiveTopology::TriangleList => match indices.as_chunks() {
            (faces, []) => Ok(faces.to_vec()),
            _ => Err(BevyMeshError::BadIndexCount(indices.len())),
        },
        other => Err(BevyMeshError::NotTriangles(other)),
    }
}

fn layer_of(attribute: &MeshVertexAttribute, values: &Values) -> Result<Layer, BevyMeshError> {
    let standard = ATTRIBUTES.iter().find(|(known, _)| known.id == attribute.id);
    let kind = standard.map_or(LayerKind::Other, |&(_, kind)| kind);
    let name = if standard.is_some() { kind.to_string() } else { attribute.name.to_owned() };
    let is_fraction = matches!(kind, LayerKind::Color(_) | LayerKind::Weights(_));
    let (width, mut values) = match (kind, values) {
        (LayerKind::Other, Values::Float32(values)) => (1, values.clone()),
        (LayerKind::Other | LayerKind::Uv(_), Values::Float32x2(v)) => (2, v.as_flattened().into()),
        (LayerKind::Other | LayerKind::Normal, Values::Float32x3(v)) => {
            (3, v.as_flattened().into())
        }
        (LayerKind::Joints(_), Values::Uint16x4(v)) => {
            (4, v.as_flattened().iter().map(|&joint| f32::from(joint)).collect())
        }
        (_, Values::Unorm8x4(v)) if is_fraction => {
            (4, v.as_flattened().iter().map(|&x| f32::from(x) / 255.0).collect())
        }
        (_, Values::Unorm16x4(v)) if is_fraction => {
            (4, v.as_flattened().iter().map(|&x| f32::from(x) / 65535.0).collect())
        }
        (LayerKind::Other | LayerKind::Tangent, Values::Float32x4(v)) => {
            (4, v.as_flattened().into())
        }
        (_, Values::Float32x4(v)) if is_fraction => (4, v.as_flattened().into()),
        _ => {
            let format = format!("{:?}", attribute.format);
            return Err(BevyMeshError::BadFormat { name: attribute.name, format });
        }
    };
    flip_uvs(kind, &mut values);
    Ok(Layer { kind, name, width, values })
}

/// Moves the arrays into a list of triangles with default usage. Colours get an alpha of 1 if they
/// have none.
impl TryFrom<MeshArrays> for BevyMesh {
    type Error = BevyMeshError;

    fn try_from(arrays: MeshArrays) -> Result<Self, BevyMeshError> {
        arrays.validate()?;
        let mut mesh = Self::new(PrimitiveTopology::TriangleList, Default::default());
        mesh.insert_attribute(Self::ATTRIBUTE_POSITION, points_of(&arrays.positions)?);
        for layer in arrays.layers {
            let name = layer.name.clone();
            let (attribute, values) = attribute_of(layer)?;
            if mesh.contains_attribute(attribute) {
                return Err(BevyMeshError::SecondLayer(name));
            }
            mesh.insert_attribute(attribute, values);
        }
        mesh.insert_indices(Indices::U32(arrays.faces.into_flattened()));
        Ok(mesh)
    }
}

fn points_of(positions: &[[f64; 3]]) -> Result<Vec<[f32; 3]>, BevyMeshError> {
    let single = |(row, &position): (usize, &[f64; 3])| {
        let point = <[f32; 3]>::from_f64(position);
        match (0..3).find(|&k| !point[k].is_finite()) {
            Some(k) => {
                Err(BevyMeshError::OutOfRange { name: "points".into(), row, value: position[k] })
            }
            None => Ok(point),
        }
    };
    positions.iter().enumerate().map(single).collect()
}

fn attribute_of(layer: Layer) -> Result<(MeshVertexAttribute, Values), BevyMeshError> {
    let Layer { kind, name, width, mut values } = layer;
    let Some(&(attribute, _)) = ATTRIBUTES.iter().find(|&&(_, known)| known == kind) else {
        return Err(BevyMeshError::NoAttribute(name));
    };
    flip_uvs(kind, &mut values);
    let values = match (kind, width) {
        (LayerKind::Normal, 3) => Values::Float32x3(rows(&values)),
        (LayerKind::Uv(_), 2) => Values::Float32x2(rows(&values)),
        (LayerKind::Color(_), 3) => {
            let opaque = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
            Values::Float32x4(rows(&values).into_iter().map(opaque).collect())
        }
        (LayerKind::Joints(_), 4) => Values::Uint16x4(joints_of(&name, &values)?),
        (_, 4) => Values::Float32x4(rows(&values)),
        _ => return Err(BevyMeshError::BadWidth { name, width }),
    };
    Ok((attribute, values))
}

fn rows<const N: usize>(values: &[f32]) -> Vec<[f32; N]> {
    values.as_chunks().0.to_vec()
}

fn joints_of(name: &str, values: &[f32]) -> Result<Vec<[u16; 4]>, BevyMeshError> {
    let is_joint = |x: f32| (0.0..=65535.0).contains(&x) && x.fract() == 0.0;
    match values.iter().position(|&x| !is_joint(x)) {
        Some(i) => Err(BevyMeshError::OutOfRange {
            name: name.to_owned(),
            row: i / 4,
            value: values[i].into(),
        }),
        None => Ok(values.as_chunks().0.iter().map(|row| row.map(|x| x as u16)).collect()),
    }
}

/// Moves the origin of texture coordinates, lower left here and upper left in Bevy, to the other.
fn flip_uvs(kind: LayerKind, values: &mut [f32]) {
    if matches!(kind, LayerKind::Uv(_)) {
        values.as_chunks_mut::<2>().0.iter_mut().for_each(|[_, v]| *v = 1.0 - *v);
    }
}

#[cfg(test)]
mod tests {
    use bevy_mesh::{CuboidMeshBuilder, MeshBuilder, VertexFormat};

    use super::*;
    use crate::{Connectivity, Mesh};

    fn arrays(mesh: &BevyMesh) -> Result<MeshArrays, BevyMeshError> {
        mesh.try_into()
    }

    fn square(topology: PrimitiveTopology) -> BevyMesh {
        let points = vec![[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        BevyMesh::new(topology, Default::default())
            .with_inserted_attribute(BevyMesh::ATTRIBUTE_POSITION, points)
    }

    #[test]
    fn a_box_is_closed_here_and_comes_back() {
        let cuboid = CuboidMeshBuilder::default().build();
        let mesh = Mesh::from_arrays(arrays(&cuboid).unwrap()).unwrap();
        assert_eq!(mesh.validate(), Ok(()));
        let kinds: Vec<_> =
            mesh.attributes.as_ref().unwrap().layers.iter().map(|layer| layer.kind).collect();
        assert_eq!(kinds, [LayerKind::Normal, LayerKind::Uv(0)]);
        assert_eq!((mesh.positions.len(), cuboid.count_vertices()), (8, 24));
        assert!(Connectivity::new(&mesh.faces, 8).is_closed());

        let back = arrays(&cuboid).unwrap();
        let again = arrays(&back.clone().try_into().unwrap()).unwrap();
        assert_eq!(again.faces, back.faces);
        assert_eq!(again.layers[0], back.layers[0]);
        let apart = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-6;
        assert!(again.layers[1].values.iter().zip(&back.layers[1].values).all(apart));
    }

    #[test]
    fn strips_and_meshes_without_indices_have_faces() {
        let strip = square(PrimitiveTopology::TriangleStrip);
        assert_eq!(arrays(&strip).unwrap().faces, [[0, 1, 2], [2, 1, 3]]);
        let restarted = [
            Indices::U16(vec![0, 1, 2, u16::MAX, 2, 1, 3]),
            Indices::U32(vec![0, 1, 2, u32::MAX, 2, 1, 3]),
        ];
        for indices in restarted {
            let strip = strip.clone().with_inserted_indices(indices);
            assert_eq!(arrays(&strip).unwrap().faces, [[0, 1, 2], [2, 1, 3]]);
        }
    }

    #[test]
    fn meshes_that_are_no_triangles_are_refused() {
        let list = square(PrimitiveTopology::TriangleList);
        assert_eq!(arrays(&list), Err(BevyMeshError::BadIndexCount(4)));
        let list = list.with_inserted_indices(Indices::U16(vec![0, 1, 9]));
        let error = Mesh::from_arrays(arrays(&list).unwrap()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "faces: row 0 refers to point 9, but there are only 4 points"
        );
        let lines = square(PrimitiveTopology::LineList);
        let lines_error = BevyMeshError::NotTriangles(PrimitiveTopology::LineList);
        assert_eq!(arrays(&lines), Err(lines_error));
        let bare = BevyMesh::new(PrimitiveTopology::TriangleList, Default::default());
        assert_eq!(arrays(&bare), Err(BevyMeshError::NoPositions));
        let mut drawn = square(PrimitiveTopology::TriangleStrip);
        drawn.take_gpu_data().unwrap();
        assert_eq!(arrays(&drawn), Err(BevyMeshError::NotInMainWorld));
    }

    #[test]
    fn fractions_may_be_whole_numbers_and_others_may_not() {
        let strip = || square(PrimitiveTopology::TriangleStrip);
        let color =
            MeshVertexAttribute { format: VertexFormat::Unorm8x4, ..BevyMesh::ATTRIBUTE_COLOR };
        let colored =
            strip().with_inserted_attribute(color, Values::Unorm8x4(vec![[255, 0, 51, 0]; 4]));
        assert_eq!(arrays(&colored).unwrap().layers[0].values[..4], [1.0, 0.0, 0.2, 0.0]);
        let weight = MeshVertexAttribute {
            format: VertexFormat::Unorm16x4,
            ..BevyMesh::ATTRIBUTE_JOINT_WEIGHT
        };
        let weighted =
            strip().with_inserted_attribute(weight, Values::Unorm16x4(vec![[65_535, 0, 0, 0]; 4]));
        assert_eq!(arrays(&weighted).unwrap().layers[0].values[..4], [1.0, 0.0, 0.0, 0.0]);
        let numbers = MeshVertexAttribute::new("Floor", 9_998, VertexFormat::Uint32);
        let numbered = strip().with_inserted_attribute(numbers, Values::Uint32(vec![1; 4]));
        let error = arrays(&numbered).unwrap_err().to_string();
        assert!(error.starts_with("Floor: Uint32 is not read; remove the attribute"), "{error}");
    }

    #[test]
    fn attributes_keep_their_values() {
        let owned = MeshVertexAttribute::new("Heat", 9_999, VertexFormat::Float32);
        let mesh = square(PrimitiveTopology::TriangleStrip)
            .with_inserted_attribute(BevyMesh::ATTRIBUTE_UV_0, vec![[0.25_f32, 0.75]; 4])
            .with_inserted_attribute(
                BevyMesh::ATTRIBUTE_JOINT_INDEX,
                Values::Uint16x4(vec![[7, 0, 65_535, 1,]; 4]),
            )
            .with_inserted_attribute(
                BevyMesh::ATTRIBUTE_JOINT_WEIGHT,
                vec![[0.5_f32, 0.5, 0., 0.]; 4],
            )
            .with_inserted_attribute(owned, vec![3.0_f32; 4]);
        let arrays = arrays(&mesh).unwrap();
        let layer = |k: usize| (arrays.layers[k].kind, &arrays.layers[k].values[..4]);
        assert_eq!(layer(0), (LayerKind::Uv(0), &[0.25, 0.25, 0.25, 0.25][..]));
        assert_eq!(arrays.layers[1].kind, LayerKind::Weights(0));
        assert_eq!(layer(2), (LayerKind::Joints(0), &[7.0, 0.0, 65_535.0, 1.0][..]));
        assert_eq!(layer(3), (LayerKind::Other, &[3.0; 4][..]));
        assert_eq!(arrays.layers[3].name, "Heat");

        let error = BevyMesh::try_from(arrays.clone()).unwrap_err();
        assert_eq!(error, BevyMeshError::NoAttribute("Heat".into()));
        let standard = MeshArrays { layers: arrays.layers[..3].to_vec(), ..arrays };
        let back = BevyMesh::try_from(standard).unwrap();
        let same = |id| assert_eq!(back.attribute(id), mesh.attribute(id));
        same(BevyMesh::ATTRIBUTE_UV_0);
        same(BevyMesh::ATTRIBUTE_JOINT_INDEX);
        same(BevyMesh::ATTRIBUTE_JOINT_WEIGHT);
    }

    #[test]
    fn numbers_that_do_not_fit_are_refused() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1e300, 0.0]];
        let huge = MeshArrays::new(&points, &[[0, 1, 2]]);
        let error = BevyMesh::try_from(huge).unwrap_err().to_string();
        assert!(error.starts_with("points: row 2 does not fit: 1"), "{error}");
        let points = points.map(|point| point.map(|x: f64| x.min(1.0)));
        let joints =
            MeshArrays::new(&points, &[[0, 1, 2]]).with(LayerKind::Joints(0), vec![0.5; 12]);
        let error = BevyMesh::try_from(joints).unwrap_err().to_string();
        assert_eq!(error, "joints0: row 0 does not fit: 0.5");
        let triangle = || MeshArrays::new(&points, &[[0, 1, 2]]);
        let refused = |arrays: MeshArrays| BevyMesh::try_from(arrays).unwrap_err().to_string();
        let short = triangle().with(LayerKind::Normal, vec![0.0; 6]);
        assert_eq!(refused(short), "normal: 6 values, but each of 3 points needs 3");
        let wide = triangle().with(LayerKind::Color(0), vec![0.0; 6]);
        assert_eq!(
            refused(wide),
            "color0: 2 values for each point do not fit the attribute of Bevy"
        );
        let gray = || vec![0.5; 9];
        let opaque = triangle().with(LayerKind::Color(0), gray());
        let expected = Values::Float32x4(vec![[0.5, 0.5, 0.5, 1.0]; 3]);
        let mesh = BevyMesh::try_from(opaque.clone()).unwrap();
        assert_eq!(mesh.attribute(BevyMesh::ATTRIBUTE_COLOR), Some(&expected));
        let twice = opaque.with(LayerKind::Color(0), gray());
        assert_eq!(refused(twice), "color0: a second layer of this kind; remove one");
        assert_eq!(
            refused(MeshArrays::new(&points, &[[0, 1, 3]])),
            "faces: row 0 refers to point 3, but there are only 3 points"
        );
    }
}
