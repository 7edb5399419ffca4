// Numbers in bits, and exact quotients. Native integer division is slow where it is emulated, and the
// quotients here are small: estimate in f32, then correct.

@group(1) @binding(1) var<storage, read> words: array<u32>;

// Low word of two words, shifted right by less than 32.
fn funnel(low: u32, high: u32, by: u32) -> u32 {
    return (low >> by) | ((high << 1u) << (31u - by));
}

// Low bits of a word, at most 32.
fn low_bits(number: u32, width: u32) -> u32 {
    return number & ((2u << (max(width, 1u) - 1u)) - 1u) & select(0u, ~0u, width > 0u);
}

// Two words from a bit on.
fn two_words(at: u32) -> vec2u {
    let word = at >> 5u;
    let by = at & 31u;
    let middle = words[word + 1u];
    return vec2u(funnel(words[word], middle, by), funnel(middle, words[word + 2u], by));
}

// Quotient rounded down and remainder, for a divisor of at most 2^20 and |number| < 2^31 whose quotient
// is below 2^22: the estimate is off by one at most.
fn near_quotient(number: i32, divisor: i32) -> vec2i {
    let estimate = i32(floor(f32(number) / f32(divisor)));
    let rest = number - estimate * divisor;
    let off = select(0, 1, rest >= divisor) - select(0, 1, rest < 0);
    return vec2i(estimate + off, rest - off * divisor);
}
