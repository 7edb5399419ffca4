// Blocks: two vertices share a number along each axis; a matrix for each 32 vertices places the cells.

struct Block {
    // Sides of a cell, and the middle of the first one.
    u: vec3f,
    // Bit at which the numbers start.
    start: u32,
    v: vec3f,
    // Bits of a pair along each axis, a byte each.
    widths: u32,
    w: vec3f,
    first: vec3f,
}

@group(1) @binding(2) var<storage, read> blocks: array<Block>;

// Cells that a vertex can tell apart where two share `width` bits: the root of 2^width, rounded down.
fn numbers(width: u32) -> u32 {
    return select(0x80000000u, 0xb504f333u, (width & 1u) == 1u) >> (31u - (width >> 1u));
}

// Number of one vertex of a pair, which has at most 31 bits.
fn own(both: u32, width: u32, second: bool) -> f32 {
    let parts = near_quotient(i32(both), i32(numbers(width)));
    return f32(select(parts.y, parts.x, second));
}

fn decoded(vertex: u32) -> vec3f {
    let at = vertex >> 5u;
    let block = blocks[at];
    let widths = vec3u(block.widths & 63u, (block.widths >> 8u) & 63u, block.widths >> 16u);
    let pair = (vertex & 31u) >> 1u;
    let start = block.start + pair * (widths.x + widths.y + widths.z);
    let second = (vertex & 1u) == 1u;
    var cell: vec3f;
    if IS_WIDE {
        cell = wide_cell(start, widths, second);
    } else {
        // At most 31 bits each and 64 in all.
        let xyz = two_words(start);
        let yz = vec2u(funnel(xyz.x, xyz.y, widths.x), xyz.y >> widths.x);
        let z = funnel(yz.x, yz.y, widths.y);
        cell = vec3f(
            own(low_bits(xyz.x, widths.x), widths.x, second),
            own(low_bits(yz.x, widths.y), widths.y, second),
            own(low_bits(z, widths.z), widths.z, second),
        );
    }
    return block.u * cell.x + block.v * cell.y + block.w * cell.z + block.first;
}

// Cell from numbers of any width up to 56 bits.
fn wide_cell(start: u32, widths: vec3u, second: bool) -> vec3f {
    var at = start;
    var cell: vec3f;
    for (var axis = 0u; axis < 3u; axis++) {
        cell[axis] = f32(wide_own(two_words(at), widths[axis], second));
        at += widths[axis];
    }
    return cell;
}

// Number of one vertex of a pair, by long division bit by bit.
fn wide_own(both: vec2u, width: u32, second: bool) -> u32 {
    let divisor = numbers(width);
    var quotient = 0u;
    var rest = 0u;
    for (var bit = i32(width) - 1; bit >= 0; bit--) {
        let digit = (both[bit >> 5u] >> (u32(bit) & 31u)) & 1u;
        rest = (rest << 1u) | digit;
        let fits = rest >= divisor;
        rest -= select(0u, divisor, fits);
        quotient = (quotient << 1u) | select(0u, 1u, fits);
    }
    return select(rest, quotient, second);
}

@vertex
fn bare(@builtin(vertex_index) vertex: u32) -> Fragment {
    return seen_at(decoded(vertex), vec3f(0.0), vertex >> 5u);
}

@vertex
fn with_normals(@location(0) vertex: u32, @location(1) normal: vec2f) -> Fragment {
    return seen_at(decoded(vertex), unfolded(normal), vertex >> 5u);
}
