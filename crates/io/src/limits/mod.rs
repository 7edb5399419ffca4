//! Parts of a scene that a format cannot hold.

use std::collections::BTreeSet;

use meshlod_mesh::{FaceLayerKind, LayerKind, Mesh};

use crate::format::Format;
use crate::format::facts::{Comments, Holds, VertexSharing};
use crate::gltf::write::new_document::limits::new_document_limits;
use crate::notes::Note;
use crate::scene::Scene;
use crate::scene::material::Material;

mod layers;
mod rounding;

impl Scene {
    /// Lists the parts of the scene that a file of this format lacks or holds in another form;
    /// empty if nothing is lost.
    ///
    /// Rounding of coordinates is listed if the format has only 32 bits and they do not keep the
    /// shape. STL's lack of shared vertices is not listed, since its readers weld them. Cost:
    /// linear in the number of corners.
    pub fn limits_of(&self, format: Format) -> Vec<Note> {
        let stores = format.stores();
        let mut notes = match stores.holds {
            Holds::Document if self.source.is_some() => Vec::new(),
            Holds::Document => {
                let own = vec![self.unused_vertices(), self.face_scalar_limits()];
                [new_document_limits(self), own, self.obj_limits()].concat()
            }
            Holds::Library => {
                let scalars = vec![self.face_scalar_limits()];
                let parts = [self.graph_limits(), self.mtl_limits(), scalars].concat();
                [parts, self.layer_limits(stores)].concat()
            }
            Holds::Properties => {
                [self.graph_limits(), self.obj_limits(), crate::ply::limits(self)].concat()
            }
            Holds::MeshAlone => self.lone_mesh_limits(format),
        };
        if let Some((most, count)) = self.unavoidable_rounding(format) {
            let why = format!(" by up to {most:.1e}: the format has 32-bit coordinates");
            let note = Note::changed(count, "vertex rounded", "vertices rounded").detailed(&why);
            notes.push(note.remedied(".ply, .obj and .off have 64 bits"));
        }
        notes.retain(|note| note.count > 0);
        notes
    }

    /// Reports whether a file of this format keeps the vertices that no face uses.
    pub fn keeps_unused_vertices(&self, format: Format) -> bool {
        match format.stores().vertices {
            VertexSharing::Indexed => true,
            VertexSharing::PerPrimitive => self.source.is_some(),
            VertexSharing::PerCorner => false,
        }
    }

    /// Lists the parts that the [flattened](Self::flatten) scene lacks, where materials and objects
    /// are only names. PLY comments are not listed.
    pub fn mesh_limits(&self) -> Vec<Note> {
        let plain = Material::default();
        // A material that no library defines is grey and has no lines.
        let has_look = |material: &&Material| match self.source {
            Some(_) => Material { name: String::new(), ..(*material).clone() } != plain,
            None => !material.mtl.is_empty() || material.images().next().is_some(),
        };
        let looks = self.materials.iter().filter(has_look);
        let names: Vec<&str> = looks.map(|material| &*material.name).collect();
        let images = self.images.iter().map(|image| &*image.name);
        let mut notes = self.graph_limits();
        notes.push(Note::left_out(names.len(), "material's look", "materials' looks").named(names));
        notes.push(Note::left_out(self.images.len(), "texture", "textures").named(images));
        notes.retain(|note| note.count > 0);
        notes
    }

    /// Lists the parts lost if a file of this format is written without its material library and
    /// images.
    pub fn lone_file_limits(&self, format: Format) -> Vec<Note> {
        let looks = crate::obj::mtl::defined(self);
        let of_colors = self.materials.iter().filter_map(|material| material.base_color_image);
        let (looks, images): (_, BTreeSet<usize>) = match format.stores().holds {
            Holds::Library => (looks, self.materials.iter().flat_map(Material::images).collect()),
            Holds::Properties => (Vec::new(), of_colors.collect()),
            Holds::Document | Holds::MeshAlone => return Vec::new(),
        };
        // Images that were not found are noted by the reader.
        let images = images.iter().filter_map(|&image| self.images.get(image));
        let images: Vec<&str> =
            images.filter(|image| !image.bytes.is_empty()).map(|image| &*image.name).collect();
        let remedy = "write to a file to get what belongs beside it";
        let mut notes = vec![
            Note::left_out(looks.len(), "material's look", "materials' looks").named(looks),
            Note::left_out(images.len(), "texture", "textures").named(images),
        ];
        notes.retain(|note| note.count > 0);
        notes.into_iter().map(|note| note.remedied(remedy)).collect()
    }

    /// Lists the parts lost if meshes are written to glTF as a whole, as strips and compressed
    /// meshes are: the names of their objects.
    pub fn whole_mesh_limits(&self) -> Vec<Note> {
        let names = if self.source.is_some() { Vec::new() } else { self.object_names() };
        let note = Note::left_out(names.len(), "name of an object", "names of objects");
        vec![note.named(names)]
    }

    /// Lists the parts that tiles of the scene lack, which have its faces, materials, images, normals,
    /// texture coordinates and colours.
    pub fn tile_limits(&self) -> Vec<Note> {
        let is_kept = |kind: LayerKind| {
            matches!(kind, LayerKind::Normal | LayerKind::Uv(_) | LayerKind::Color(_))
        };
        let all = self.meshes.iter().filter_map(|mesh| mesh.mesh.attributes.as_ref());
        let lost = all.flat_map(|own| &own.layers).filter(|layer| !is_kept(layer.kind));
        let names: BTreeSet<&str> = lost.map(|layer| &*layer.name).collect();
        let layers = Note::left_out(names.len(), "layer of vertices", "layers of vertices");
        // Putting all instances together is what tiles are for.
        let graph = self.graph_limits().into_iter().skip(1);
        let mut notes: Vec<Note> = graph.chain(self.whole_mesh_limits()).collect();
        notes.extend([layers.named(names), self.face_scalar_limits()]);
        notes.retain(|note| note.count > 0);
        notes
    }

    /// Counts the vertices that no face uses.
    fn unused_vertices(&self) -> Note {
        let unused = |mesh: &Mesh| mesh.used_vertices().iter().filter(|&&used| !used).count();
        let count = self.meshes.iter().map(|mesh| unused(&mesh.mesh)).sum();
        Note::left_out(count, "unused vertex", "unused vertices")
    }

    /// Lists the parts of a PLY file that formats without comments lack.
    pub fn ply_limits(&self) -> Vec<Note> {
        let words = |word: &'static str| {
            self.ply.remarks.iter().filter(move |line| line.starts_with(word)).count()
        };
        let [comments, infos] = ["comment", "obj_info"].map(words);
        vec![
            Note::left_out(comments, "comment", "comments"),
            Note::left_out(infos, "line obj_info", "lines obj_info"),
            self.face_scalar_limits(),
        ]
    }

    /// Counts the scalars at faces, which only PLY holds.
    pub fn face_scalar_limits(&self) -> Note {
        let layers = self.meshes.iter().flat_map(|mesh| &mesh.mesh.face_layers);
        let scalars = layers.filter(|layer| layer.kind == FaceLayerKind::Other);
        let names: BTreeSet<&str> = scalars.map(|layer| &*layer.name).collect();
        Note::left_out(names.len(), "property of faces", "properties of faces").named(names)
    }

    /// Lists the parts of an OBJ file that other formats lack.
    pub fn obj_limits(&self) -> Vec<Note> {
        let groups = self.meshes.iter().filter_map(|mesh| mesh.mesh.smoothing());
        let groups = groups.flat_map(|layer| &layer.values).map(|&group| group as u32);
        let groups: BTreeSet<u32> = groups.filter(|&group| group > 0).collect();
        let names = groups.iter().map(u32::to_string);
        let note = Note::left_out(groups.len(), "smoothing group", "smoothing groups");
        vec![note.named(names)]
    }

    /// Lists the parts that formats without nodes lack.
    fn graph_limits(&self) -> Vec<Note> {
        let instances = self.instances();
        let mut shown = vec![false; self.meshes.len()];
        instances.iter().for_each(|instance| shown[instance.mesh] = true);
        let hidden = shown.iter().filter(|&&shown| !shown).count();
        let count = |array| self.source.as_ref().map_or(0, |source| source.count(array));
        let lights = self.source.as_ref().map_or(0, |source| source.lights());
        let images = self.source.as_ref().map_or_else(Vec::new, |source| source.extension_images());
        let mut notes = vec![
            merged_instances(instances.len()),
            Note::left_out(hidden, "mesh that no node shows", "meshes that no node shows"),
            Note::left_out(count("skins"), "skin", "skins"),
            Note::left_out(count("animations"), "animation", "animations"),
            Note::left_out(count("cameras"), "camera", "cameras"),
            Note::left_out(lights, "light", "lights"),
            Note::left_out(
                images.len(),
                "texture that only an extension of glTF names",
                "textures that only extensions of glTF name",
            )
            .named(images),
        ];
        notes.extend(self.source.iter().flat_map(|source| source.unheld_parts()));
        notes
    }

    fn mtl_limits(&self) -> Vec<Note> {
        let Some(source) = &self.source else { return Vec::new() };
        let richer = source.richer_materials();
        vec![
            Note::left_out(
                richer.len(),
                "material's properties that MTL lacks",
                "materials' properties that MTL lacks",
            )
            .named(richer),
        ]
    }

    /// Lists the parts that a format of a single mesh lacks.
    fn lone_mesh_limits(&self, format: Format) -> Vec<Note> {
        let stores = format.stores();
        let mut own = match stores.comments {
            Comments::None => self.ply_limits(),
            Comments::Lines | Comments::Own => vec![self.face_scalar_limits()],
        };
        if !self.keeps_unused_vertices(format) {
            own.push(self.unused_vertices());
        }
        let parts = [self.graph_limits(), self.part_limits(format), own];
        [parts.concat(), self.obj_limits(), self.layer_limits(stores)].concat()
    }

    /// Reports whether the scene is written as text of several solids.
    fn is_written_as_solids(&self, format: Format) -> bool {
        self.has_solids && format.stores().has_solids
    }

    /// Lists the materials, textures and names of objects, which a single mesh lacks.
    fn part_limits(&self, format: Format) -> Vec<Note> {
        let shown: BTreeSet<usize> = self.instances().iter().map(|i| i.mesh).collect();
        let used: BTreeSet<usize> = shown
            .iter()
            .flat_map(|&mesh| self.meshes[mesh].materials.iter().flatten().copied())
            .collect();
        let materials = used.iter().filter_map(|&material| self.materials.get(material));
        let images: BTreeSet<usize> = materials.clone().flat_map(Material::images).collect();
        let images: Vec<&str> =
            images.iter().filter_map(|&i| self.images.get(i)).map(|i| &*i.name).collect();
        let objects =
            if self.is_written_as_solids(format) { Vec::new() } else { self.object_names() };
        let named = materials.filter(|m| !m.name.is_empty()).map(|m| &*m.name);
        vec![
            Note::left_out(used.len(), "material", "materials").named(named),
            Note::left_out(images.len(), "texture", "textures").named(images),
            Note::left_out(objects.len(), "name of an object", "names of objects").named(objects),
        ]
    }

    pub(crate) fn object_names(&self) -> Vec<String> {
        let labels = self.meshes.iter().filter_map(|mesh| mesh.mesh.objects.as_ref());
        labels.flat_map(|labels| &labels.names).filter(|name| !name.is_empty()).cloned().collect()
    }
}

/// Notes that several instances of meshes become one mesh.
pub fn merged_instances(count: usize) -> Note {
    let merged = if count > 1 { count } else { 0 };
    Note::changed(merged, "", "instances of meshes merged into one mesh")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReadOptions, WriteOptions, read_bytes, write_to};

    fn limits(scene: &Scene, format: Format) -> Vec<String> {
        scene.limits_of(format).iter().map(Note::to_string).collect()
    }

    fn obj(text: &str) -> Scene {
        let mut library = |name: &str| {
            (name == "a.mtl").then(|| b"newmtl red\nKd 1 0 0\nmap_Kd red.tif\n".to_vec())
        };
        read_bytes(text.as_bytes(), Format::Obj, &mut library, &ReadOptions::default()).unwrap()
    }

    const QUAD: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
        vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\nvn 0 0 1\n\
        o leaf\nusemtl red\nf 1/1/1 2/2/1 3/3/1\nf 1/5/1 3/3/1 4/4/1\n";

    #[test]
    fn what_each_format_lacks_is_named() {
        let scene = obj(QUAD);
        assert_eq!(limits(&scene, Format::Obj), [""; 0]);
        let parts = ["1 material (red)", "1 texture (red.tif)", "1 name of an object (leaf)"];
        let seam = "1 vertex split at seams of its attributes";
        let color = "1 colour of a textured material (red)";
        assert_eq!(limits(&scene, Format::Ply), [color, parts[2]]);
        assert_eq!(limits(&scene, Format::Off), [&parts[..], &[seam]].concat());
        let layers = "2 vertex attributes (normals, texture coordinates)";
        assert_eq!(limits(&scene, Format::Stl), [&parts[..], &[layers]].concat());
    }

    #[test]
    fn unused_vertices_are_noted_where_they_go() {
        let scene = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nv 6 6 6\nf 1 2 3\n");
        for (_, format) in Format::ALL {
            let mut file = Vec::new();
            write_to(&mut file, &scene, format, &WriteOptions::default()).unwrap();
            let back = read_bytes(&file, format, &mut |_| None, &ReadOptions::default()).unwrap();
            let goes = back.into_mesh().positions.len() == 3;
            let expected: &[&str] = if goes { &["2 unused vertices"] } else { &[] };
            assert_eq!(limits(&scene, format), expected, "{format:?}");
        }
    }

    #[test]
    fn a_flattened_scene_lacks_looks_and_textures() {
        let lacks =
            |scene: &Scene| scene.mesh_limits().iter().map(Note::to_string).collect::<Vec<_>>();
        assert_eq!(lacks(&obj(QUAD)), ["1 material's look (red)", "1 texture (red.tif)"]);
        let named = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\no leaf\nusemtl red\nf 1 2 3\n");
        assert_eq!(lacks(&named), [""; 0], "names are in the mesh");
    }

    #[test]
    fn a_bare_mesh_fits_everywhere() {
        let scene = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        for (_, format) in Format::ALL {
            assert_eq!(limits(&scene, format), [""; 0]);
        }
    }
}
