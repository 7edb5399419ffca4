/** Exact positions: of each coordinate, its distance from a prediction in representable numbers. */

import { must } from "../error.ts";
import type { Model } from "../model.ts";
import type { Streams } from "./streams.ts";

const MAGNITUDE = (1n << 63n) - 1n;
const SIGN = 1n << 63n;

const double = new Float64Array(1);
const bits = new BigUint64Array(double.buffer);

/** Reads the exact positions of nodes, in order, where their lattice positions are known. */
export function readExact(
    model: Model,
    nodes: Uint32Array,
    isKnown: (i: number) => boolean,
    input: Streams,
): void {
    const exact = model.exact;
    if (!exact) return;
    const axes = [0, 1, 2].map(() => {
        const zeros = input.take(1)[0];
        must(zeros < 64, "exact positions have too few bits");
        return { zeros: BigInt(zeros), deltas: input.signedLong(nodes.length) };
    });
    const { origin, unit } = model.frame;
    nodes.forEach((node, i) => {
        if (!isKnown(i)) return;
        for (let k = 0; k < 3; k++) {
            const { zeros, deltas } = axes[k];
            const cell = model.positions[3 * node + k];
            const guess = cell * unit + origin[k];
            const x = fromOrdinal(BigInt.asIntN(64, ordinal(guess, zeros) + deltas[i]), zeros);
            must(Number.isFinite(x), "one of its exact positions is not finite");
            const off = Math.abs((x - origin[k]) / unit - cell);
            const most = 0.5 * model.header.cell + 2 ** -23 * Math.abs(cell);
            must(off <= most, "one of its exact positions is outside the cell of its vertex");
            exact[3 * node + k] = x;
        }
    });
}

/** Returns the place of a number among those without the last bits. */
function ordinal(x: number, zeros: bigint): bigint {
    double[0] = x;
    const magnitude = (bits[0] & MAGNITUDE) >> zeros;
    return bits[0] & SIGN ? -1n - magnitude : magnitude;
}

function fromOrdinal(rank: bigint, zeros: bigint): number {
    const magnitude = rank < 0n ? -1n - rank : rank;
    if (magnitude > MAGNITUDE >> zeros) return NaN;
    bits[0] = (magnitude << zeros) | (rank < 0n ? SIGN : 0n);
    return double[0];
}
