//! Mapping between PLY vertex properties and attribute layers, in both directions.

use std::collections::{HashMap, HashSet};

use meshlod_mesh::{Layer, LayerKind};

use super::face_values::is_label;
use super::header::{Property, Shape};
use super::scalar::Scalar;

/// Other names of the set that is written as "s t".
const OTHER_UVS: [&[&str]; 4] =
    [&["u", "v"], &["texture_u", "texture_v"], &["texture_s", "texture_t"], &["tex_u", "tex_v"]];

/// Other names of "red green blue alpha".
pub(super) const OTHER_COLORS: [&[&str]; 2] =
    [&["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"], &["r", "g", "b", "a"]];

/// Attribute layer and the properties it is read from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LayerColumns {
    pub kind: LayerKind,
    pub name: String,
    /// One column per component; never empty.
    pub columns: Vec<Column>,
}

/// Source of one component of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column {
    /// Index among the properties of the element.
    pub property: usize,
    /// Type of the numbers in the file.
    pub kind: Scalar,
    /// Divisor for the numbers in the file.
    pub unit: f64,
}

/// Finds the attribute layers among the properties of a vertex, in the order of the file.
///
/// Incomplete sets and unknown names become [`LayerKind::Other`], or [`LayerKind::Label`] for
/// integer labels; lists and the coordinates are skipped.
pub(super) fn columns(properties: &[Property]) -> Vec<LayerColumns> {
    let mut free = free_numbers(properties);
    let mut layers: Vec<LayerColumns> = Vec::new();
    for property in properties {
        if let Some((kind, names)) = known_set(&property.name)
            && layers.iter().all(|layer| layer.kind != kind)
            && let Some(mut columns) = take(&mut free, &names)
        {
            if let LayerKind::Color(set) = kind {
                let other = OTHER_COLORS.iter().find(|other| other[0] == names[0]);
                let alpha = other.map_or_else(|| numbered("alpha", set), |own| own[3].to_owned());
                columns.extend(take(&mut free, &[alpha]).unwrap_or_default());
                columns.iter_mut().for_each(|c| c.unit = greatest(&properties[c.property]));
            }
            let name = columns.iter().map(|c| properties[c.property].name.as_str());
            let name = name.collect::<Vec<_>>().join(" ");
            layers.push(LayerColumns { kind, name, columns });
        }
    }
    for property in properties {
        let names = run_from(&property.name, &free);
        if let Some(columns) = take(&mut free, &names) {
            let name = match names.len() {
                1 => property.name.clone(),
                _ => property.name[..property.name.len() - "_0".len()].to_owned(),
            };
            let is_label =
                columns.iter().all(|column| names_something(&properties[column.property]));
            let kind = if is_label { LayerKind::Label } else { LayerKind::Other };
            layers.push(LayerColumns { kind, name, columns });
        }
    }
    layers.sort_by_key(|layer| layer.columns[0].property);
    layers
}

/// Collects the scalar properties by name, without the coordinates.
fn free_numbers<'p>(properties: &'p [Property]) -> HashMap<&'p str, Column> {
    let column = |(property, p): (usize, &'p Property)| match p.shape {
        Shape::One(kind) if !is_coordinate(&p.name) => {
            Some((p.name.as_str(), Column { property, kind, unit: 1.0 }))
        }
        _ => None,
    };
    properties.iter().enumerate().filter_map(column).collect()
}

fn is_coordinate(name: &str) -> bool {
    matches!(name, "x" | "y" | "z")
}

/// Removes all these names from `free` and returns their columns; `None` if one is missing.
fn take(free: &mut HashMap<&str, Column>, names: &[String]) -> Option<Vec<Column>> {
    let columns: Vec<Column> =
        names.iter().map(|name| free.get(name.as_str()).copied()).collect::<Option<_>>()?;
    for name in names {
        free.remove(name.as_str());
    }
    Some(columns)
}

/// Returns the kind and all names, without alpha, of the known set that begins with a name.
fn known_set(first: &str) -> Option<(LayerKind, Vec<String>)> {
    let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    if let Some(names) = OTHER_UVS.iter().find(|names| names[0] == first) {
        return Some((LayerKind::Uv(0), owned(names)));
    }
    if let Some(names) = OTHER_COLORS.iter().find(|names| names[0] == first) {
        return Some((LayerKind::Color(0), owned(&names[..3])));
    }
    let digits = first.find(|c: char| c.is_ascii_digit()).unwrap_or(first.len());
    let (stem, number) = first.split_at(digits);
    let set = match number.trim_end_matches("_0") {
        "" => 0,
        number => number.parse().ok()?,
    };
    let kind = match stem {
        "nx" => LayerKind::Normal,
        "s" => LayerKind::Uv(set),
        "red" => LayerKind::Color(set),
        "tx" => LayerKind::Tangent,
        "joint" => LayerKind::Joints(set),
        "weight" => LayerKind::Weights(set),
        _ => return None,
    };
    let names = set_names(kind);
    // "s01" and "red0" belong to no known set.
    (names[0] == first).then_some((kind, names))
}

/// Returns the names of a known set, without alpha; empty for other layers.
pub(super) fn set_names(kind: LayerKind) -> Vec<String> {
    let several = |stems: &[&str], set| stems.iter().map(|stem| numbered(stem, set)).collect();
    let four = |stem: &str, set: u8| (0..4).map(|i| format!("{stem}{set}_{i}")).collect();
    match kind {
        LayerKind::Normal => several(&["nx", "ny", "nz"], 0),
        LayerKind::Uv(set) => several(&["s", "t"], set),
        LayerKind::Color(set) => several(&["red", "green", "blue"], set),
        LayerKind::Tangent => several(&["tx", "ty", "tz", "tw"], 0),
        LayerKind::Joints(set) => four("joint", set),
        LayerKind::Weights(set) => four("weight", set),
        LayerKind::Other | LayerKind::Label => Vec::new(),
    }
}

/// Returns the name of a component in a set; the first set has no number.
fn numbered(stem: &str, set: u8) -> String {
    match set {
        0 => stem.to_owned(),
        _ => format!("{stem}{set}"),
    }
}

/// Returns the free names `name_0 name_1` … if `first` begins such a run, else only `first`.
fn run_from(first: &str, free: &HashMap<&str, Column>) -> Vec<String> {
    let Some(base) = first.strip_suffix("_0") else { return vec![first.to_owned()] };
    let run = (0..).map(|i| format!("{base}_{i}"));
    let run: Vec<_> = run.take_while(|name| free.contains_key(name.as_str())).collect();
    if run.is_empty() { vec![first.to_owned()] } else { run }
}

/// Reports whether a property holds integer labels, which cannot be averaged.
fn names_something(property: &Property) -> bool {
    let Shape::One(kind) = property.shape else { return false };
    let name = property.name.strip_prefix("scalar_").unwrap_or(&property.name);
    let name = name.to_ascii_lowercase();
    let is_name = |end: &str| name.strip_suffix(end).is_some_and(|rest| rest.ends_with('_'));
    let ends = ["id", "index", "label", "labels", "class", "category", "instance", "segment"];
    kind.whole_range().is_some() && (is_label(&name) || ends.into_iter().any(is_name))
}

/// Returns the divisor of a colour: the maximum of an integer type, 1 for other types.
pub(super) fn greatest(property: &Property) -> f64 {
    let (Shape::One(kind) | Shape::List { item: kind, .. }) = property.shape;
    kind.whole_range().map_or(1.0, |(_, most)| most as f64)
}

/// Chooses the property names to write each layer under, one per component. All names are distinct
/// from each other and from the coordinates.
pub(super) fn names<'a>(layers: impl IntoIterator<Item = &'a Layer>) -> Vec<Vec<String>> {
    let mut used: HashSet<String> = ["x", "y", "z"].map(str::to_owned).into();
    layers
        .into_iter()
        .map(|layer| {
            let names = layer_names(layer, &used);
            used.extend(names.iter().cloned());
            names
        })
        .collect()
}

fn layer_names(layer: &Layer, used: &HashSet<String>) -> Vec<String> {
    let mut known = set_names(layer.kind);
    if let LayerKind::Color(set) = layer.kind
        && layer.width == 4
    {
        known.push(numbered("alpha", set));
    }
    if known.len() == layer.width && known.iter().all(|name| !used.contains(name)) {
        return known;
    }
    free_name(&layer.name, layer.width, used)
}

/// Chooses unused names for `width` components, as close to `name` as possible.
pub(super) fn free_name(name: &str, width: usize, used: &HashSet<String>) -> Vec<String> {
    let mut base = one_word(name);
    loop {
        let names: Vec<_> = match width {
            1 => vec![base.clone()],
            width => (0..width).map(|i| format!("{base}_{i}")).collect(),
        };
        if names.iter().all(|name| !used.contains(name)) {
            return names;
        }
        base.push('_');
    }
}

/// Converts a name to a single word for the header.
fn one_word(name: &str) -> String {
    let odd = |c: char| c.is_whitespace() || c.is_control();
    match name.trim() {
        "" => "layer".to_owned(),
        name => name.replace(odd, "_"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kind, name and width of what float properties of these names become.
    fn kinds(names: &str) -> Vec<(LayerKind, String, usize)> {
        let shape = Shape::One(Scalar::F32);
        let names = names.split_whitespace();
        let properties: Vec<_> = names.map(|name| Property { name: name.into(), shape }).collect();
        let layers = columns(&properties);
        layers.into_iter().map(|l| (l.kind, l.name, l.columns.len())).collect()
    }

    fn other(name: &str, width: usize) -> (LayerKind, String, usize) {
        (LayerKind::Other, name.to_owned(), width)
    }

    #[test]
    fn known_sets_are_found_in_any_order_of_their_names() {
        let found = kinds("blue x green y red z t s alpha");
        let color = (LayerKind::Color(0), "red green blue alpha".to_owned(), 4);
        assert_eq!(found, [color, (LayerKind::Uv(0), "s t".to_owned(), 2)]);
    }

    #[test]
    fn integers_that_are_names_are_labels() {
        let kind = |name: &str, kind| {
            let property = Property { name: name.into(), shape: Shape::One(kind) };
            columns(&[property])[0].kind
        };
        for name in ["label", "class", "scalar_Label", "instance_id", "semantic_class"] {
            assert_eq!(kind(name, Scalar::U8), LayerKind::Label, "{name}");
            assert_eq!(kind(name, Scalar::F32), LayerKind::Other, "{name}");
        }
        for name in ["intensity", "quality", "id_", "covid"] {
            assert_eq!(kind(name, Scalar::U8), LayerKind::Other, "{name}");
        }
    }

    #[test]
    fn other_programs_names_are_known() {
        for uvs in ["u v", "s t", "texture_u texture_v", "texture_s texture_t", "tex_u tex_v"] {
            assert_eq!(kinds(uvs), [(LayerKind::Uv(0), uvs.to_owned(), 2)]);
        }
        for colors in ["r g b", "r g b a", "diffuse_red diffuse_green diffuse_blue"] {
            let width = colors.split(' ').count();
            assert_eq!(kinds(colors), [(LayerKind::Color(0), colors.to_owned(), width)]);
        }
        assert_eq!(kinds("r g"), [other("r", 1), other("g", 1)]);
        let both = kinds("r g b red green blue");
        assert_eq!(both[0].0, LayerKind::Color(0));
        assert_eq!(both[1..], ["red", "green", "blue"].map(|name| other(name, 1)));
    }

    #[test]
    fn incomplete_sets_are_other_layers() {
        assert_eq!(
            kinds("x y z nx ny red alpha"),
            ["nx", "ny", "red", "alpha"].map(|n| other(n, 1))
        );
    }

    #[test]
    fn a_second_first_set_is_an_other_layer() {
        let found = kinds("u v s t");
        assert_eq!(found[0], (LayerKind::Uv(0), "u v".to_owned(), 2));
        assert_eq!(found[1..], [other("s", 1), other("t", 1)]);
    }

    #[test]
    fn runs_of_numbered_names_are_one_layer() {
        assert_eq!(
            kinds("f_rest_0 f_rest_1 f_rest_2 f_dc_0 scale_1"),
            [other("f_rest", 3), other("f_dc_0", 1), other("scale_1", 1)]
        );
    }

    #[test]
    fn written_names_never_come_twice() {
        let layer =
            |kind, name: &str, width| Layer { kind, name: name.into(), width, values: vec![] };
        let layers = [
            layer(LayerKind::Normal, "n", 3),
            layer(LayerKind::Normal, "n", 3),
            layer(LayerKind::Other, "x", 1),
            layer(LayerKind::Other, "two words", 1),
            layer(LayerKind::Other, "", 2),
            layer(LayerKind::Color(2), "", 4),
        ];
        let names: Vec<_> = names(&layers).iter().map(|names| names.join(" ")).collect();
        let expected = [
            "nx ny nz",
            "n_0 n_1 n_2",
            "x_",
            "two_words",
            "layer_0 layer_1",
            "red2 green2 blue2 alpha2",
        ];
        assert_eq!(names, expected);
    }
}
