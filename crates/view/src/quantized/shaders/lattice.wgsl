// Lattice: four vertices share a number. A digit of it is a cell of a box, which integer shears bend
// onto the surface; adding the middle and one product give the place, exactly as on the CPU.

struct Shear {
    // Bit at which the numbers start.
    start: u32,
    // Middle along u, v and w, relative to the middle of the mesh.
    u: i32,
    v: i32,
    w: i32,
    // Span codes, a byte each, and the flattened axis.
    spans: u32,
    slopes: u32,
    // Bends, a byte each, and the bits of a number; above 128 those of a single vertex, plus 128.
    bends: u32,
    padding: u32,
}

@group(1) @binding(2) var<storage, read> shears: array<Shear>;

fn signed_byte(bytes: u32, at: u32) -> i32 {
    return extractBits(i32(bytes), 8u * at, 8u);
}

// Mantissas and exponents of spans.
struct Spans {
    mantissas: vec3u,
    exponents: vec3u,
}

fn spans_of(codes: u32) -> Spans {
    let code = (vec3u(codes) >> vec3u(0u, 8u, 16u)) & vec3u(255u);
    let exponent = code >> vec3u(4u);
    let is_small = exponent == vec3u(0u);
    let mantissa = (code & vec3u(15u)) + select(vec3u(17u), vec3u(1u), is_small);
    return Spans(mantissa, exponent - select(vec3u(1u), vec3u(0u), is_small));
}

fn decoded(vertex: u32) -> vec3f {
    let shear = shears[vertex >> 5u];
    let spans = spans_of(shear.spans);
    let size = vec3i(spans.mantissas << spans.exponents);
    var digits: vec3i;
    if IS_WIDE {
        digits = wide_digits(shear, vec3u(size), vertex & 31u);
    } else {
        digits = near_digits(shear, spans, vertex & 31u);
    }
    let away = digits - (size >> vec3u(1u));
    let v = away.y + slope(shear.slopes, 1u, away.x);
    let u = away.x + slope(shear.slopes, 0u, v);
    let plane = slope(shear.slopes, 2u, u) + slope(shear.slopes, 3u, v);
    let w = away.z + plane + bent(shear.bends, u, v, size);
    let cell = vec3i(u + shear.u, v + shear.v, w + shear.w);
    let axis = (shear.spans >> 24u) & 3u;
    let turned = select(select(cell.zxy, cell.yzx, axis == 1u), cell, axis == 2u);
    return vec3f(turned) * scheme.scale;
}

fn slope(slopes: u32, at: u32, by: i32) -> i32 {
    return (signed_byte(slopes, at) * by) >> 6u;
}

// Height of the bent surface over its plane.
fn bent(bends: u32, u: i32, v: i32, size: vec3i) -> i32 {
    let along = signed_byte(bends, 0u) * u + signed_byte(bends, 1u) * v;
    let across = signed_byte(bends, 2u) * v;
    if IS_WIDE {
        return wide_quotient(u, along, 64u * u32(size.x)) + wide_quotient(across, v, 64u * u32(size.y));
    }
    return over(u * along, size.x) + over(across * v, size.y);
}

// Quotient by 64 times a span, rounded down.
fn over(number: i32, span: i32) -> i32 {
    return near_quotient(number >> 6u, span).x;
}

// Numbers of at most 96 bits in tuples of four. With V = M 2^E cells in the box, M at most 2^15, dividing
// by V is a shift and a long division by M in digits of 16 bits.
fn near_digits(shear: Shear, spans: Spans, at: u32) -> vec3i {
    let width = shear.bends >> 24u;
    let first = shear.start + (at >> 2u) * width;
    let pair = two_words(first);
    var number = vec3u(pair, 0u);
    if HAS_THREE_WORDS {
        let word = (first >> 5u) + 2u;
        number.z = funnel(words[word], words[word + 1u], first & 31u);
        number.z = low_bits(number.z, max(width, 64u) - 64u);
    }
    number.y = low_bits(number.y, clamp(width, 32u, 64u) - 32u);
    number.x = low_bits(number.x, min(width, 32u));

    let m = spans.mantissas.x * spans.mantissas.y * spans.mantissas.z;
    let e = spans.exponents.x + spans.exponents.y + spans.exponents.z;
    for (var turn = 0u; turn < 3u; turn++) {
        let less = quotient_by(number, m, e);
        number = select(number, less, turn < (at & 3u));
    }
    let low = number.x & ((1u << e) - 1u);
    let rest = (remainder_by(number, m, e) << e) | low;
    // Below 2^24, since four of them have 96 bits.
    let size = vec3i(spans.mantissas << spans.exponents);
    let vw = near_quotient(i32(rest), size.x);
    let w = near_quotient(vw.x, size.y);
    return vec3i(vw.y, w.y, w.x);
}

fn shifted(number: vec3u, by: u32) -> vec3u {
    return vec3u(funnel(number.x, number.y, by), funnel(number.y, number.z, by), number.z >> by);
}

fn quotient_by(number: vec3u, m: u32, e: u32) -> vec3u {
    let dividend = shifted(number, e);
    var z = vec2u(0u);
    if HAS_THREE_WORDS {
        z = word_quotient(0u, dividend.z, m);
    }
    let y = word_quotient(z.y, dividend.y, m);
    let x = word_quotient(y.y, dividend.x, m);
    return vec3u(x.x, y.x, z.x);
}

fn remainder_by(number: vec3u, m: u32, e: u32) -> u32 {
    let dividend = shifted(number, e);
    var rest = 0u;
    if HAS_THREE_WORDS {
        rest = word_quotient(0u, dividend.z, m).y;
    }
    rest = word_quotient(rest, dividend.y, m).y;
    return word_quotient(rest, dividend.x, m).y;
}

// Quotient and remainder of a word that a remainder stands before.
fn word_quotient(rest: u32, word: u32, m: u32) -> vec2u {
    let high = near_quotient(i32((rest << 16u) | (word >> 16u)), i32(m));
    let low = near_quotient((high.y << 16u) | i32(word & 0xffffu), i32(m));
    return vec2u((u32(high.x) << 16u) | u32(low.x), u32(low.y));
}

// Numbers of any width up to 128 bits, divided by one span after the other.
fn wide_digits(shear: Shear, size: vec3u, at: u32) -> vec3i {
    let code = shear.bends >> 24u;
    let single = code > 128u;
    let width = select(code, code - 128u, single);
    let first = shear.start + select(at >> 2u, at, single) * width;
    var number = vec4u(two_words(first), two_words(first + 64u));
    for (var word = 0u; word < 4u; word++) {
        number[word] = low_bits(number[word], clamp(width, 32u * word, 32u * word + 32u) - 32u * word);
    }
    var digits: vec3u;
    for (var turn = 0u; turn <= select(at & 3u, 0u, single); turn++) {
        for (var axis = 0u; axis < 3u; axis++) {
            digits[axis] = wide_divide(&number, size[axis]);
        }
    }
    return vec3i(digits);
}

// Divides a number by at most 2^20, in digits of 8 bits, and returns the remainder.
fn wide_divide(number: ptr<function, vec4u>, divisor: u32) -> u32 {
    var rest = 0u;
    for (var byte = 15; byte >= 0; byte--) {
        let word = u32(byte) >> 2u;
        let by = 8u * (u32(byte) & 3u);
        let dividend = (rest << 8u) | (((*number)[word] >> by) & 255u);
        let quotient = dividend / divisor;
        rest = dividend % divisor;
        (*number)[word] = ((*number)[word] & ~(255u << by)) | (quotient << by);
    }
    return rest;
}

// Product over a divisor below 2^31, rounded down, through 64 bits.
fn wide_quotient(a: i32, b: i32, divisor: u32) -> i32 {
    let negative = (a < 0) != (b < 0);
    let product = wide_product(u32(abs(a)), u32(abs(b)));
    var quotient = 0u;
    var rest = 0u;
    for (var bit = 63; bit >= 0; bit--) {
        rest = (rest << 1u) | ((product[bit >> 5u] >> (u32(bit) & 31u)) & 1u);
        let fits = rest >= divisor;
        rest -= select(0u, divisor, fits);
        quotient = (quotient << 1u) | select(0u, 1u, fits);
    }
    let down = -i32(quotient) - select(0, 1, rest > 0u);
    return select(i32(quotient), down, negative);
}

fn wide_product(a: u32, b: u32) -> vec2u {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let cross = (a >> 16u) * (b & 0xffffu) + (low >> 16u);
    let more = (a & 0xffffu) * (b >> 16u) + (cross & 0xffffu);
    let high = (a >> 16u) * (b >> 16u) + (cross >> 16u) + (more >> 16u);
    return vec2u((more << 16u) | (low & 0xffffu), high);
}

@vertex
fn bare(@builtin(vertex_index) vertex: u32) -> Fragment {
    return seen_at(decoded(vertex), vec3f(0.0), vertex >> 5u);
}

@vertex
fn with_normals(@location(0) vertex: u32, @location(1) normal: vec2f) -> Fragment {
    return seen_at(decoded(vertex), unfolded(normal), vertex >> 5u);
}
