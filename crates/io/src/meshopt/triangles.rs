//! Meshopt mode 1: triangle lists, mostly one byte per triangle, which refers to a recent edge and
//! vertex.

use super::stream::{Malformed, Stream, push_varint, unzigzag, zigzag};

const HEADER: u8 = 0xe1;
/// Length of the table in the tail, and how many of its entries codes can refer to.
const TABLE: usize = 16;
const NAMED: usize = 14;
/// Limit on the age of a recent vertex that a code can refer to beside an edge: 1 to 12.
const NEAR: usize = 13;
/// Code of an edge or vertex that is stored explicitly.
const EXPLICIT: u8 = 15;

/// Ring buffer of the 16 most recent entries; age 0 is the newest.
struct Fifo<T> {
    newest: usize,
    filled: usize,
    entries: [T; 16],
}

impl<T: Copy + Default + PartialEq> Fifo<T> {
    fn new() -> Self {
        Self { newest: 0, filled: 0, entries: [T::default(); 16] }
    }

    fn push(&mut self, entry: T) {
        self.newest = (self.newest + 1) % 16;
        self.filled = (self.filled + 1).min(16);
        self.entries[self.newest] = entry;
    }

    fn get(&self, age: usize) -> Option<T> {
        (age < self.filled).then(|| self.entries[(self.newest + 16 - age) % 16])
    }

    fn age(&self, entry: T, limit: usize) -> Option<usize> {
        (0..self.filled.min(limit)).find(|&age| self.get(age) == Some(entry))
    }
}

/// State that encoder and decoder keep in step.
struct State {
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
    /// Next new index, if indices first appear in order.
    next: u32,
    /// Last explicitly stored index.
    last: u32,
}

impl State {
    fn new() -> Self {
        Self { edges: Fifo::new(), vertices: Fifo::new(), next: 0, last: 0 }
    }

    fn take_next(&mut self) -> u32 {
        self.next = self.next.wrapping_add(1);
        self.next.wrapping_sub(1)
    }

    /// Updates the state after a triangle on the known edge `a b`.
    fn push_on_edge(&mut self, [a, b, c]: [u32; 3], new: bool) {
        if new {
            self.vertices.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
    }

    /// Updates the state after a triangle without a known edge; codes 0 and 15 mark new vertices.
    fn push_alone(&mut self, [a, b, c]: [u32; 3], codes: [u8; 2]) {
        self.vertices.push(a);
        for (vertex, code) in [b, c].into_iter().zip(codes) {
            if matches!(code, 0 | EXPLICIT) {
                self.vertices.push(vertex);
            }
        }
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
    }
}

/// Decodes the indices of `count` triangles.
pub(super) fn decode(stream: &[u8], count: usize) -> Result<Vec<u32>, Malformed> {
    let (header, mut codes, table) = Stream::split(stream, TABLE)?;
    if header != HEADER {
        return Err(Malformed::new(
            0,
            format!("header {header:#04x}; triangle streams begin with 0xe1"),
        ));
    }
    let triangle_codes = codes.take(count)?;
    let mut data = codes;
    let mut state = State::new();
    let mut indices = Vec::with_capacity(3 * count);
    for (i, &code) in triangle_codes.iter().enumerate() {
        let triangle = match code >> 4 {
            EXPLICIT => decode_alone(&mut data, &mut state, code & 15, table)?,
            edge => decode_on_edge(&mut data, &mut state, edge, code & 15)?,
        };
        let missing = || Malformed::new(1 + i, "refers to an edge or a vertex before the first");
        indices.extend(triangle.ok_or_else(missing)?);
    }
    data.finish()?;
    Ok(indices)
}

fn decode_on_edge(
    data: &mut Stream<'_>,
    state: &mut State,
    edge: u8,
    code: u8,
) -> Result<Option<[u32; 3]>, Malformed> {
    let Some([a, b]) = state.edges.get(usize::from(edge)) else { return Ok(None) };
    let near = usize::from(code);
    let c = match code {
        0 => state.take_next(),
        _ if near < NEAR => match state.vertices.get(near) {
            Some(vertex) => vertex,
            None => return Ok(None),
        },
        13 | 14 => {
            let step = if code == 13 { u32::MAX } else { 1 };
            state.last = state.last.wrapping_add(step);
            state.last
        }
        _ => read_explicit(data, state)?,
    };
    state.push_on_edge([a, b, c], near == 0 || near >= NEAR);
    Ok(Some([a, b, c]))
}

fn decode_alone(
    data: &mut Stream<'_>,
    state: &mut State,
    code: u8,
    table: &[u8],
) -> Result<Option<[u32; 3]>, Malformed> {
    let named = usize::from(code) < NAMED;
    let pair = if named { table[usize::from(code)] } else { data.byte()? };
    let codes = [pair >> 4, pair & 15];
    if named && codes.contains(&EXPLICIT) {
        return Err(
            data.wrong(format!("table entry {pair:#04x} must not contain explicit indices"))
        );
    }
    if !named && pair == 0 {
        state.next = 0;
    }
    let a = if code == EXPLICIT { read_explicit(data, state)? } else { state.take_next() };
    let mut others = [0; 2];
    for (other, code) in others.iter_mut().zip(codes) {
        *other = match code {
            0 => state.take_next(),
            EXPLICIT => read_explicit(data, state)?,
            age => match state.vertices.get(usize::from(age) - 1) {
                Some(vertex) => vertex,
                None => return Ok(None),
            },
        };
    }
    let triangle = [a, others[0], others[1]];
    state.push_alone(triangle, codes);
    Ok(Some(triangle))
}

/// Reads an explicit index, stored as the difference from the last one.
fn read_explicit(data: &mut Stream<'_>, state: &mut State) -> Result<u32, Malformed> {
    state.last = state.last.wrapping_add(unzigzag(data.varint()?));
    Ok(state.last)
}

/// Encoded form of a triangle.
enum TriangleCode {
    /// Single code byte.
    OnEdge(u8),
    /// Pair of vertex codes, with the first index either next in order or explicit.
    Alone { pair: u8, first_is_next: bool },
}

/// Compresses a triangle list as a meshopt stream. Triangles keep their order, but their corners
/// may be rotated.
///
/// Compact if triangles follow their neighbours and vertices are numbered by first use: about one
/// byte per triangle, at most 17. Cost: O(n).
pub fn encode(triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut state = State::new();
    // Explicit indices of all triangles, and where those of each triangle end.
    let (mut data, mut ends) = (Vec::new(), Vec::with_capacity(triangles.len()));
    let mut codes = Vec::with_capacity(triangles.len());
    for &triangle in triangles {
        codes.push(encode_triangle(triangle, &mut state, &mut data));
        ends.push(data.len());
    }
    let table = table(&codes);
    let mut out = vec![HEADER];
    let name = |pair| table[..NAMED].iter().position(|&entry| entry == pair);
    out.extend(codes.iter().map(|code| match *code {
        TriangleCode::OnEdge(code) => code,
        TriangleCode::Alone { pair, first_is_next: true } => {
            0xf0 | name(pair).map_or(14, |at| at as u8)
        }
        TriangleCode::Alone { first_is_next: false, .. } => 0xff,
    }));
    let mut start = 0;
    for (code, end) in codes.iter().zip(ends) {
        if let TriangleCode::Alone { pair, first_is_next } = *code
            && !(first_is_next && name(pair).is_some())
        {
            out.push(pair);
        }
        out.extend_from_slice(&data[start..end]);
        start = end;
    }
    out.extend(table);
    out
}

/// Encodes one triangle, appending its explicit indices to `data`.
fn encode_triangle(triangle: [u32; 3], state: &mut State, data: &mut Vec<u8>) -> TriangleCode {
    let rotations = [triangle, rotated(triangle), rotated(rotated(triangle))];
    let on_edge = rotations
        .iter()
        .filter_map(|&[a, b, c]| Some((state.edges.age([a, b], 15)?, [a, b, c])))
        .min_by_key(|&(age, _)| age);
    if let Some((age, triangle)) = on_edge {
        return TriangleCode::OnEdge((age as u8) << 4 | encode_third(triangle, state, data));
    }
    let [a, b, c] =
        rotations.into_iter().find(|rotation| rotation[0] == state.next).unwrap_or(triangle);
    let first_is_next = a == state.next;
    if first_is_next {
        state.take_next();
    } else {
        write_explicit(a, state, data);
    }
    let codes = [b, c].map(|vertex| {
        if vertex == state.next {
            state.take_next();
            return 0;
        }
        match state.vertices.age(vertex, NAMED) {
            Some(age) => age as u8 + 1,
            None => {
                write_explicit(vertex, state, data);
                EXPLICIT
            }
        }
    });
    state.push_alone([a, b, c], codes);
    TriangleCode::Alone { pair: codes[0] << 4 | codes[1], first_is_next }
}

fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    [b, c, a]
}

/// Encodes the third index of a triangle on a known edge and returns its code.
fn encode_third(triangle: [u32; 3], state: &mut State, data: &mut Vec<u8>) -> u8 {
    let c = triangle[2];
    let near = state.vertices.age(c, NEAR).filter(|&age| age > 0);
    let code = match near {
        Some(age) => age as u8,
        None if c == state.next => {
            state.take_next();
            0
        }
        None if c == state.last.wrapping_sub(1) => 13,
        None if c == state.last.wrapping_add(1) => 14,
        None => EXPLICIT,
    };
    match code {
        13 | 14 => state.last = c,
        EXPLICIT => write_explicit(c, state, data),
        _ => {}
    }
    state.push_on_edge(triangle, near.is_none());
    code
}

fn write_explicit(index: u32, state: &mut State, data: &mut Vec<u8>) {
    push_varint(data, zigzag(index.wrapping_sub(state.last)));
    state.last = index;
}

/// Selects the most frequent pairs for the table. Its first entry stands for three new vertices, a
/// pair that would restart the numbering if it were stored explicitly.
fn table(codes: &[TriangleCode]) -> [u8; TABLE] {
    let mut counts = [0usize; 256];
    for code in codes {
        if let TriangleCode::Alone { pair, first_is_next: true } = *code
            && pair >> 4 != EXPLICIT
            && pair & 15 != EXPLICIT
        {
            counts[usize::from(pair)] += 1;
        }
    }
    let mut pairs: Vec<u8> = (1..=255).filter(|&pair| counts[usize::from(pair)] > 0).collect();
    pairs.sort_by_key(|&pair| std::cmp::Reverse(counts[usize::from(pair)]));
    let mut table = [0; TABLE];
    for (entry, pair) in table[1..NAMED].iter_mut().zip(pairs) {
        *entry = pair;
    }
    table
}
