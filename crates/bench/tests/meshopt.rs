//! The codecs of `EXT_meshopt_compression` against meshoptimizer's own: each decodes what the other
//! encodes.

use meshlod::io::meshopt::{
    Filter, Layout, Mode, decode, encode_attributes, encode_exponential, encode_octahedral,
    encode_triangles,
};
use meshlod_fixtures::shared_mesh;

fn layout(mode: Mode, count: usize, stride: usize) -> Layout {
    Layout { mode, filter: Filter::None, count, stride }
}

/// Returns reproducible pseudo-random numbers.
fn chance(count: usize) -> impl Iterator<Item = u32> {
    let mut state = 0x9e37_79b9u32;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state
    })
    .take(count)
}

/// Builds elements of which some bytes rarely change, some change slowly, and some are random.
fn elements<const N: usize>(count: usize) -> Vec<[u8; N]> {
    let element = |(i, noise): (usize, u32)| {
        std::array::from_fn(|k| match k % 4 {
            0 => (i * (k + 1) / 3) as u8,
            1 => noise as u8 & 3,
            2 => noise as u8,
            _ => 7,
        })
    };
    chance(count).enumerate().map(element).collect()
}

/// Builds the triangles of a grid, with a random one now and then.
fn triangles() -> Vec<[u32; 3]> {
    let n = 60;
    let cell = |i: u32| {
        let v = i / n * (n + 1) + i % n;
        [[v, v + 1, v + n + 1], [v + n + 1, v + 1, v + n + 2]]
    };
    let mut triangles: Vec<[u32; 3]> = (0..n * n).flat_map(cell).collect();
    let count = triangles.len();
    for noise in chance(200) {
        triangles[noise as usize % count] = [noise % 3721, noise / 7 % 3721, noise / 99 % 3721];
    }
    triangles
}

fn attributes_pass<const N: usize>(count: usize)
where
    [u8; N]: Default + Clone,
{
    let elements = elements::<N>(count);
    let bytes = elements.as_flattened();
    let back = meshopt::decode_vertex_buffer::<[u8; N]>(&encode_attributes(bytes, N), count);
    assert_eq!(back.unwrap(), elements, "{N} bytes, {count} times, read by the peer");
    for (version, level) in [(0, 2), (1, 0), (1, 2), (1, 3)] {
        let theirs = meshopt::encode_vertex_buffer_level(&elements, level, Some(version)).unwrap();
        assert_eq!(theirs[0], 0xa0 + version as u8);
        let ours = decode(&theirs, &layout(Mode::Attributes, count, N));
        assert_eq!(ours.as_deref(), Ok(bytes), "{N} bytes, {count} times, version {version}");
    }
}

#[test]
fn attributes_are_read_by_either() {
    for count in [1, 15, 16, 17, 255, 256, 1000] {
        attributes_pass::<4>(count);
        attributes_pass::<8>(count);
        attributes_pass::<12>(count);
        attributes_pass::<32>(count);
    }
}

/// Splits indices into triangles, each rotated to begin with its lowest index.
fn sorted(indices: &[u32]) -> Vec<[u32; 3]> {
    let turned = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    indices.as_chunks().0.iter().filter_map(turned).collect()
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect()
}

#[test]
fn indices_are_read_by_either() {
    let triangles = triangles();
    let indices = triangles.as_flattened();
    let back: Vec<u32> =
        meshopt::decode_index_buffer(&encode_triangles(&triangles), indices.len()).unwrap();
    assert_eq!(sorted(&back), sorted(indices));
    let theirs = meshopt::encode_index_buffer(indices, 3721).unwrap();
    let ours = decode(&theirs, &layout(Mode::Triangles, indices.len(), 4)).unwrap();
    assert_eq!(sorted(&words(&ours)), sorted(indices));
    let theirs = meshopt::encode_index_sequence(indices, 3721).unwrap();
    let ours = decode(&theirs, &layout(Mode::Indices, indices.len(), 4)).unwrap();
    assert_eq!(words(&ours), indices);
}

/// Splits bytes into elements of four numbers.
fn fours(bytes: &[u8]) -> Vec<[i16; 4]> {
    let number = |&b: &[u8; 2]| i16::from_le_bytes(b);
    let numbers: Vec<i16> = bytes.as_chunks().0.iter().map(number).collect();
    numbers.as_chunks().0.to_vec()
}

/// Applies our filter to elements.
fn filtered(bytes: &[u8], filter: Filter, stride: usize) -> Vec<u8> {
    let layout = Layout { mode: Mode::Attributes, filter, count: bytes.len() / stride, stride };
    decode(&encode_attributes(bytes, stride), &layout).unwrap()
}

/// Asserts that numbers differ by at most one.
fn assert_near(ours: &[[i16; 4]], theirs: &[[i16; 4]], what: &str) {
    for (a, b) in ours.iter().zip(theirs) {
        let off = (0..4).map(|k| (i32::from(a[k]) - i32::from(b[k])).abs()).max();
        assert!(off <= Some(1), "{what}: {a:?} for {b:?}");
    }
}

#[test]
fn filters_do_as_the_peers_do() {
    let unit = |noise: u32| -> [f32; 4] {
        let v = [0, 8, 16, 24].map(|s| (noise >> s & 255) as f32 - 127.5);
        let length = v.iter().map(|x| x * x).sum::<f32>().sqrt();
        v.map(|x| x / length)
    };
    let units: Vec<[f32; 4]> = chance(1000).map(unit).collect();
    for bits in [9, 12, 16] {
        let theirs = meshopt::encode_filter_oct::<i16>(&units, bits);
        let mut back = theirs.clone();
        meshopt::decode_filter_oct(&mut back);
        let bytes: Vec<u8> = theirs.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_near(&fours(&filtered(&bytes, Filter::Octahedral, 8)), &back, "octahedral");
        let mut ours = fours(&encode_octahedral(&units, bits as u32));
        meshopt::decode_filter_oct(&mut ours);
        let exact = filtered(&encode_octahedral(&units, bits as u32), Filter::Octahedral, 8);
        assert_near(&ours, &fours(&exact), "our octahedral");

        let theirs = meshopt::encode_filter_quat(&units, bits);
        let mut back = theirs.clone();
        meshopt::decode_filter_quat(&mut back);
        let bytes: Vec<u8> = theirs.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_near(&fours(&filtered(&bytes, Filter::Quaternion, 8)), &back, "quaternion");

        let colors: Vec<[f32; 4]> = units.iter().map(|u| u.map(f32::abs)).collect();
        let theirs = meshopt::encode_filter_color::<u16>(&colors, bits);
        let mut back = theirs.clone();
        meshopt::decode_filter_color(&mut back);
        let bytes: Vec<u8> = theirs.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        let back: Vec<[i16; 4]> = back.iter().map(|e| e.map(|x| x as i16)).collect();
        assert_near(&fours(&filtered(&bytes, Filter::Color, 8)), &back, "colour");
    }
    let floats = units.as_flattened();
    let bytes = encode_exponential(floats, 1e-4).unwrap();
    let mut back: Vec<[u32; 1]> = words(&bytes).into_iter().map(|word| [word]).collect();
    meshopt::decode_filter_exp(&mut back);
    assert_eq!(words(&filtered(&bytes, Filter::Exponential, 4)), back.as_flattened());
}

#[test]
fn streams_of_a_real_mesh_are_no_larger_than_the_peers() {
    let Some(path) = shared_mesh("bunny.ply") else {
        return println!("skipped: bunny.ply is not available");
    };
    let mesh = meshlod::io::read(&path, &Default::default()).unwrap().into_mesh();
    let triangles: Vec<[u32; 3]> = mesh.faces.iter().map(|face| face.map(|v| v.0)).collect();
    let count = mesh.positions.len();
    let ordered = meshopt::optimize_vertex_cache(triangles.as_flattened(), count);
    let mut remap = vec![None; count];
    let mut next = 0..;
    let fetched: Vec<u32> = (ordered.iter())
        .map(|&v| *remap[v as usize].get_or_insert_with(|| next.next().unwrap_or_default()))
        .collect();
    let ours = encode_triangles(fetched.as_chunks().0).len();
    let theirs = meshopt::encode_index_buffer(&fetched, count).unwrap().len();
    println!("bunny: {ours} bytes of indices, meshoptimizer's {theirs}");
    assert!(ours <= theirs + theirs / 200, "{ours} bytes, the peer's {theirs}");
}
