//! Files of other programs that we neither read nor write, and the way from and to them.

use std::path::Path;

/// Files of other programs.
struct Foreign {
    suffixes: &'static [&'static str],
    /// Way to a file that we read.
    read: &'static str,
    /// File to write in its place.
    write: &'static str,
}

const NO_MESH: &str = "name a mesh, such as .glb";

const FILES: [Foreign; 14] = [
    Foreign {
        suffixes: &["fbx"],
        read: "open it in Blender and export .glb, or convert it with FBX2glTF",
        write: "write .glb, which engines import, or from which Blender exports .fbx",
    },
    Foreign {
        suffixes: &["blend"],
        read: "export .glb from Blender",
        write: "write .glb, which Blender imports",
    },
    Foreign {
        suffixes: &["usd", "usda", "usdc", "usdz"],
        read: "open it in Blender, which imports USD, and export .glb",
        write: "write .glb, from which Blender exports USD",
    },
    Foreign {
        suffixes: &["3mf", "amf"],
        read: "export .stl from a slicer, such as PrusaSlicer",
        write: "write .stl, which slicers import",
    },
    Foreign {
        suffixes: &["step", "stp", "iges", "igs", "brep", "sldprt", "3dm", "x_t"],
        read: "it holds CAD surfaces, so open it in FreeCAD or its own program and export .stl or .obj",
        write: "write .stl or .obj, which CAD programs import as meshes",
    },
    Foreign {
        suffixes: &["dae", "3ds", "x", "lwo", "ac"],
        read: "convert it with assimp: assimp export IN out.glb",
        write: "write .glb, and convert that with assimp",
    },
    Foreign {
        suffixes: &["max", "ma", "mb", "c4d", "ztl", "uasset", "prefab", "unitypackage"],
        read: "export .glb or .obj from its program",
        write: "write .glb, which its program imports",
    },
    Foreign {
        suffixes: &["x3d", "wrl", "vrml", "ctm", "u3d"],
        read: "open it in MeshLab and export .ply",
        write: "write .ply, from which MeshLab exports others",
    },
    Foreign {
        suffixes: &["vtk", "vtp", "vtu", "msh", "inp"],
        read: "extract its surface in ParaView and save .ply or .stl",
        write: "write .ply or .stl, which ParaView reads",
    },
    Foreign {
        suffixes: &["las", "laz", "e57", "pts", "xyz", "pcd", "splat", "spz", "ksplat"],
        read: "it holds points without faces, so make a surface of them, for example in CloudCompare or \
               MeshLab, and save .ply",
        write: "write .ply, which programs for points read",
    },
    Foreign {
        suffixes: &["zip", "gz", "7z", "rar", "tar", "zst"],
        read: "unpack it first",
        write: "write .mlz or .glb, and pack that",
    },
    Foreign {
        suffixes: &["mtl", "bin"],
        read: "name the .obj or .gltf that it belongs to",
        write: "name an .obj or .gltf, beside which it is written",
    },
    Foreign {
        suffixes: &["png", "jpg", "jpeg", "webp", "ktx2", "dds", "tga", "exr"],
        read: "a picture has no faces, so name the mesh that it belongs to",
        write: "pictures are made by meshlod render, as .png",
    },
    Foreign {
        suffixes: &["json", "toml", "csv"],
        read: "a recipe is run by meshlod run, and a mesh has another suffix",
        write: NO_MESH,
    },
];

/// Says what to do with a file that is not read.
pub fn way_from(path: &Path) -> Option<String> {
    foreign(path).map(|(suffix, file)| format!(".{suffix} is not read: {}", file.read))
}

/// Says what to write in place of a file that is not written.
pub fn way_to(path: &Path) -> Option<String> {
    foreign(path).map(|(suffix, file)| format!(".{suffix} is not written: {}", file.write))
}

fn foreign(path: &Path) -> Option<(String, &'static Foreign)> {
    let suffix = path.extension()?.to_str()?.to_ascii_lowercase();
    let file = FILES.iter().find(|file| file.suffixes.contains(&&*suffix))?;
    Some((suffix, file))
}

#[cfg(test)]
mod tests {
    use meshlod::FileKind;

    use super::*;

    #[test]
    fn what_is_foreign_is_not_read() {
        for suffix in FILES.iter().flat_map(|file| file.suffixes) {
            let path = format!("a.{suffix}");
            assert!(FileKind::of_path(Path::new(&path)).is_err(), "{path}");
        }
        assert!(way_from(Path::new("A.FBX")).unwrap().starts_with(".fbx is not read: open"));
        assert_eq!(way_to(Path::new("a.ply")), None);
    }
}
