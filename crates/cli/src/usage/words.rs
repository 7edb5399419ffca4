//! Words of other programs for our options, values and verbs, separated by spaces.

/// Option of ours, or other way, that stands for an option of another program.
pub enum Meant {
    /// The first of these options that the verb has.
    Option(&'static [&'static str]),
    /// The place of a file.
    Place,
    /// The option `--out`, if the verb has it, else the place of a file.
    Out,
    /// A way without an option.
    Text(&'static str),
}

use Meant::{Option, Out, Place, Text};

/// Options of other programs.
pub const OPTIONS: &[(&str, Meant)] = &[
    ("i in input", Place),
    ("o out output outfile out-file outdir out-dir report save", Out),
    (
        "ratio percent percentage factor fraction keep keep-ratio target-ratio simplify-ratio r si",
        Option(&["ratio", "levels", "faces"]),
    ),
    (
        "reduction target-reduction reduce",
        Text("--ratio is what is left: --ratio 10% for a reduction of 90%"),
    ),
    (
        "faces face-count num-faces target-faces target-count target triangles tris triangle-count \
         polygons polys polycount count n f",
        Option(&["faces", "levels"]),
    ),
    (
        "error tolerance max-error target-error threshold epsilon deviation eps simplify-error se e",
        Option(&["error"]),
    ),
    ("lods lod level steps lod-levels num-lods", Option(&["levels"])),
    ("mode algorithm algo engine strategy", Option(&["method"])),
    (
        "preserve-boundary preserve-border preserve-borders lock-border lock-borders keep-border \
         keep-borders keep-boundary slb",
        Option(&["lock-boundary"]),
    ),
    (
        "preserve-uv preserve-uvs keep-uv keep-uvs preserve-normals preserve-colors keep-attributes \
         preserve-attributes",
        Text(
            "attributes are kept anyway; --weight-uv, --weight-normal and --weight-color weigh them",
        ),
    ),
    ("preserve-topology keep-topology watertight manifold", Option(&["topology"])),
    ("merge merge-distance weld-distance merge-vertices", Option(&["weld"])),
    ("jobs cores cpus num-threads n-threads", Option(&["threads"])),
    ("silent no-progress", Option(&["quiet"])),
    ("ext extension output-format type to", Option(&["format"])),
    ("resolution width height res", Option(&["size"])),
    ("fill-holes close-holes", Option(&["holes"])),
    (
        "draco meshopt quantize quantise compress c cc",
        Text("meshlod compress writes .glb with EXT_meshopt_compression"),
    ),
    (
        "scale rotate translate center centre transform",
        Text("a mesh stays where it is: scale, turn and move it in a program such as Blender"),
    ),
    (
        "recursive recurse R",
        Text("a folder, or a pattern such as 'in/**/*.glb', has batch look in folders below, too"),
    ),
    ("overwrite y yes", Text("files that are there are replaced, so leave it out")),
    ("v", Text("-V prints the version; warnings and progress are always shown")),
    (
        "verbose debug verbosity",
        Text("warnings and progress are always shown, and --json has all figures"),
    ),
    (
        "units unit",
        Text("no unit is set: a length is in the units of the file, and 1mm is read for glTF"),
    ),
    (
        "binary ascii text",
        Text("PLY and STL are written as binary files, OBJ, OFF and SMF as text"),
    ),
];

/// Options that are verbs here.
pub const VERBS_OF_OPTIONS: &[(&str, &str)] =
    &[("repair", "fix repair"), ("check", "check validate")];

/// Values of options, in lower case, and what they are here.
pub const VALUES: &[(&str, &str, &str)] = &[
    ("layout", "unity blender", "did you mean scene?"),
    ("layout", "unreal godot bevy three three.js threejs", "did you mean files?"),
    ("layout", "babylon babylon.js", "did you mean msft?"),
    ("layout", "separate file each split", "did you mean files?"),
    ("method", "quadric quadrics qslim garland garland-heckbert qem", "did you mean qem?"),
    ("method", "lindstrom lindstrom-turk lt volume memoryless", "did you mean lindstrom-turk?"),
    ("method", "default fast auto best", "leave it out: the default is fast and near the input"),
    ("threads", "max all auto", "leave it out to use all cores"),
];

/// Words of other programs for our verbs.
pub const VERBS: &[(&str, &str)] = &[
    ("simplify", "decimate reduce optimize optimise decimation shrink"),
    ("lods", "lod chain levels"),
    ("info", "stats stat inspect describe summary identify ls cat"),
    ("check", "validate verify lint test analyze analyse"),
    ("repair", "fix clean heal weld cleanup"),
    ("convert", "export import transcode copy cp translate"),
    ("measure", "distance diff hausdorff metro error"),
    ("compress", "pack encode zip quantize quantise draco meshopt"),
    ("decompress", "unpack decode unzip"),
    ("view", "show preview display open viewer"),
    ("serve", "server http web host"),
    ("page", "html embed"),
    ("render", "screenshot picture image snapshot thumbnail draw"),
    ("sample", "generate create primitive new"),
    ("strip", "stripify tristrip strips"),
    ("extract", "query cut"),
    ("build", "multires hierarchy progressive"),
    ("batch", "bulk all"),
    ("run", "recipe script"),
    ("flock", "crowd school"),
];

/// Reports whether a word is among those of a row.
pub fn has(row: &str, word: &str) -> bool {
    row.split(' ').any(|other| other == word)
}
