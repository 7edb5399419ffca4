/**
 * Positions of a block: each is predicted from its gate, and how far off it may be on each axis.
 *
 * All is in single precision, each operation rounded by itself, in the order of the page of the
 * format.
 */

import { must } from "../error.ts";
import { ENDS, NO_GATE } from "./gates.ts";
import type { Gates } from "./gates.ts";
import type { Models } from "./models.ts";
import type { Symbols } from "./symbols.ts";

const f = Math.fround;
/** Number of cells along an axis. */
export const MAX_CELLS = 1 << 21;
const FLOOR = f(0.15);
const GAIN = f(0.1);
const LEAST_TREND = f(0.05);
/** At this magnitude numbers of single precision are integers. */
const WHOLE = 1.5 * 2 ** 23;
const WIDEST = 75;

const single = new Float32Array(1);
const bits = new Int32Array(single.buffer);

/** Decodes the positions of the vertices of one block after the other. */
export class Places {
    /** Three coordinates of each vertex, in cells. */
    readonly cells: Float32Array;
    /** Latest trends along the surface and across it, and those before. */
    private readonly now = new Float32Array(2);
    private readonly latest = new Float32Array(2);
    private outside = 0;
    /** The gate's vertices, and what is predicted from them. */
    private readonly ends = new Float32Array(3 * ENDS);
    private readonly mean = new Float32Array(3);
    private readonly normal = new Float32Array(3);
    private readonly expected = new Float32Array(2);
    /** The gate's edge, and the ways from its start to both apexes. */
    private readonly edge = new Float32Array(3);
    private readonly spoke = new Float32Array(3);
    private readonly older = new Float32Array(3);
    private inverse = 0;
    /** First coded axis; mean and variance of each coded axis, and how those depend on others. */
    private axis = 0;
    private readonly means = new Float32Array(3);
    private readonly variances = new Float32Array(3);
    private readonly depends = new Float32Array(3);

    constructor(
        vertices: number,
        private readonly models: Models,
    ) {
        this.cells = new Float32Array(3 * vertices);
    }

    /** Decodes all vertices but the first. */
    decode(gates: Gates, symbols: Symbols, first: readonly number[]): Float32Array {
        this.now.fill(1);
        this.latest.fill(1);
        this.outside = 0;
        this.cells.set(first);
        for (let v = 1; v < gates.length; v++) {
            const kind = gates.kinds[v];
            if (kind >= NO_GATE) {
                this.predictCorner(v, kind - NO_GATE);
                this.take(v, symbols);
            } else {
                this.predict(gates, v, kind);
                this.take(v, symbols);
                this.learn(v);
            }
        }
        return this.cells.subarray(0, 3 * gates.length);
    }

    /** Throws damage if a vertex was out of range. */
    end(): void {
        must(this.outside >= 0 && this.outside < MAX_CELLS, "a vertex is outside the grid");
    }

    /** Predicts a corner of a face without a gate at an earlier vertex. */
    private predictCorner(v: number, corner: number): void {
        const from = 3 * (v - Math.max(corner, 1));
        const { start } = this.models;
        for (let k = 0; k < 3; k++) this.means[k] = this.cells[from + k];
        this.variances.fill(corner === 0 ? f(64 * start) : start);
        this.depends.fill(0);
        this.axis = 0;
    }

    private predict(gates: Gates, v: number, kind: number): void {
        const { ends, cells } = this;
        for (let i = 0; i < ENDS; i++) {
            const from = 3 * gates.ends[ENDS * v + i];
            for (let k = 0; k < 3; k++) ends[3 * i + k] = cells[from + k];
        }
        const weights = this.models.gates[kind];
        const { mean, now } = this;
        let sides = 0;
        let spokes = 0;
        let rims = 0;
        const { edge: e, spoke: s, older } = this;
        for (let k = 0; k < 3; k++) {
            const a = ends[k];
            const b = ends[3 + k];
            const o = ends[6 + k];
            const q = ends[9 + k];
            const edge = f(b - a);
            const spoke = f(o - a);
            const rim = f(o - b);
            const corner = f(b - spoke);
            const first = f(f(f(corner - o) * weights[0]) + f(edge * weights[1]));
            const far = f(f(ends[15 + k] - b) + rim);
            const near = f(f(ends[12 + k] - a) + spoke);
            const second = f(f(far * weights[3]) + f(near * weights[4]));
            const third = f(f(corner - f(f(a + a) - q)) * weights[2]);
            mean[k] = f(corner + f(f(first + second) + third));
            sides = f(sides + f(edge * edge));
            spokes = f(spokes + f(spoke * spoke));
            rims = f(rims + f(rim * rim));
            e[k] = edge;
            s[k] = spoke;
            older[k] = f(q - a);
        }
        const squared = f(f(f(sides + spokes) + rims) + 1);
        const { normal } = this;
        for (let k = 0; k < 3; k++) {
            const i = (k + 1) % 3;
            const j = (k + 2) % 3;
            const near = f(f(e[i] * s[j]) - f(e[j] * s[i]));
            normal[k] = f(near + f(f(s[i] * older[j]) - f(s[j] * older[i])));
        }
        const along = f(f(f(weights[5] * squared) * now[0]) + FLOOR);
        const wide = f(f(f(weights[6] * squared) * now[1]) + FLOOR);
        this.condition(along, wide < along ? wide : along);
    }

    /** Conditions each axis on those before. */
    private condition(along: number, across: number): void {
        const { normal, means, mean, variances, depends } = this;
        const x = normal[0];
        const y = normal[1];
        const z = normal[2];
        const squared = f(f(f(x * x) + f(y * y)) + f(z * z));
        const inverse = squared > 0 ? f(1 / squared) : 0;
        const ax = Math.abs(x);
        const ay = Math.abs(y);
        const az = Math.abs(z);
        // The axis of the greatest component is last.
        this.axis = ay > Math.max(ax, az) ? 2 : ax > az ? 1 : 0;
        const i = this.axis;
        const j = (i + 1) % 3;
        const l = (i + 2) % 3;
        const u = normal[i];
        const v = normal[j];
        const w = normal[l];
        const uu = f(f(u * u) * inverse);
        const vv = f(f(v * v) * inverse);
        const ww = f(f(w * w) * inverse);
        const thin = squared > 0 ? f(1 - f(across / along)) : 0;
        const rest = f(1 - f(thin * uu));
        const byRest = f(1 / rest);
        const byLast = f(1 / f(across + f(f(along - across) * ww)));
        const third = f(f(f(f(across - along) * byLast) * inverse) * w);
        depends[0] = f(f(f(f(-thin * u) * v) * inverse) * byRest);
        depends[1] = f(third * u);
        depends[2] = f(third * v);
        variances[0] = f(along * rest);
        variances[1] = f(f(along * f(1 - f(thin * f(uu + vv)))) * byRest);
        variances[2] = f(f(along * across) * byLast);
        means[0] = inside(mean[i]);
        means[1] = inside(mean[j]);
        means[2] = inside(mean[l]);
        this.inverse = inverse;
        this.expected[0] = along;
        this.expected[1] = across;
    }

    /** Decodes a vertex axis by axis. */
    private take(vertex: number, symbols: Symbols): void {
        const { means, depends, cells, axis } = this;
        const first = this.cell(symbols, 0, means[0]);
        const du = f(first - means[0]);
        const second = this.cell(symbols, 1, f(means[1] + f(depends[0] * du)));
        const dv = f(second - means[1]);
        const off = f(f(depends[1] * du) + f(depends[2] * dv));
        const third = this.cell(symbols, 2, f(means[2] + off));
        cells[3 * vertex + axis] = first;
        cells[3 * vertex + ((axis + 1) % 3)] = second;
        cells[3 * vertex + ((axis + 2) % 3)] = third;
    }

    private cell(symbols: Symbols, turn: number, mean: number): number {
        const nearest = f(inside(mean) + WHOLE) - WHOLE;
        single[0] = this.variances[turn];
        const octaves = Math.min(Math.max((bits[0] >> 22) - 246, 0), WIDEST);
        const lowBits = Math.max((octaves >> 2) - 3, 0);
        const table = this.models.residuals[octaves - 4 * lowBits];
        const cell = (nearest + symbols.residual(table, lowBits)) | 0;
        this.outside |= cell;
        return cell & (MAX_CELLS - 1);
    }

    /** Changes the trends by how far a vertex is from where it was predicted. */
    private learn(vertex: number): void {
        const { cells, mean, normal, now, latest, expected } = this;
        let height = 0;
        let all = 0;
        for (let k = 0; k < 3; k++) {
            const way = f(cells[3 * vertex + k] - mean[k]);
            height = f(height + f(way * normal[k]));
            all = f(all + f(way * way));
        }
        const across = f(f(height * height) * this.inverse);
        for (let k = 0; k < 2; k++) {
            const squared = k === 0 ? f(0.5 * f(all - across)) : across;
            const ratio = f(f(f(squared + FLOOR) / expected[k]) - 1);
            const beyond = ratio < 3 ? ratio : 3;
            const trend = f(latest[k] + f(f(latest[k] * beyond) * GAIN));
            const atLeast = trend > LEAST_TREND ? trend : LEAST_TREND;
            now[k] = latest[k];
            latest[k] = atLeast < 20 ? atLeast : 20;
        }
    }
}

function inside(x: number): number {
    const least = x > 0 ? x : 0;
    return least < MAX_CELLS ? least : MAX_CELLS;
}
