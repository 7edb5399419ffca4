/** The checksum of zstandard frames: the low half of XXH64 of their content. */

const P1 = 0x9e3779b185ebca87n;
const P2 = 0xc2b2ae3d27d4eb4fn;
const P3 = 0x165667b19e3779f9n;
const P4 = 0x85ebca77c2b2ae63n;
const P5 = 0x27d4eb2f165667c5n;

const wrap = (x: bigint) => BigInt.asUintN(64, x);
const turn = (x: bigint, by: bigint) => wrap((x << by) | (x >> (64n - by)));
const round = (lane: bigint, word: bigint) => wrap(turn(wrap(lane + word * P2), 31n) * P1);

/** Returns the low 32 bits of the hash of bytes. */
export function xxh64(bytes: Uint8Array): number {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let at = 0;
    let hash = P5;
    if (bytes.length >= 32) {
        const lanes = [wrap(P1 + P2), P2, 0n, wrap(-P1)];
        for (; at + 32 <= bytes.length; at += 32) {
            for (let k = 0; k < 4; k++) {
                lanes[k] = round(lanes[k], view.getBigUint64(at + 8 * k, true));
            }
        }
        hash = [1n, 7n, 12n, 18n].reduce((sum, by, k) => sum + turn(lanes[k], by), 0n);
        for (const lane of lanes) hash = wrap((wrap(hash) ^ round(0n, lane)) * P1 + P4);
    }
    return finish(wrap(hash + BigInt(bytes.length)), view, at);
}

/** Adds the bytes that are left, and mixes all bits. */
function finish(hash: bigint, view: DataView, at: number): number {
    for (; at + 8 <= view.byteLength; at += 8) {
        hash ^= round(0n, view.getBigUint64(at, true));
        hash = wrap(turn(hash, 27n) * P1 + P4);
    }
    if (at + 4 <= view.byteLength) {
        hash ^= wrap(BigInt(view.getUint32(at, true)) * P1);
        hash = wrap(turn(hash, 23n) * P2 + P3);
        at += 4;
    }
    for (; at < view.byteLength; at++) {
        hash ^= wrap(BigInt(view.getUint8(at)) * P5);
        hash = wrap(turn(hash, 11n) * P1);
    }
    hash = wrap((hash ^ (hash >> 33n)) * P2);
    hash = wrap((hash ^ (hash >> 29n)) * P3);
    return Number(BigInt.asUintN(32, hash ^ (hash >> 32n)));
}
