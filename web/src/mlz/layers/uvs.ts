/** Texture coordinates: a chart mostly keeps angles, and goes on as beyond the last edge. */

import { NONE, next, previous } from "../block_shape.ts";
import { Energy, nearest } from "./coder.ts";
import type { LayerJob } from "./job.ts";

/** Kinds of surroundings. */
const [NOTHING, NEIGHBOURS, FACE, FACES] = [0, 1, 2, 3];

/** Decodes the texture coordinates of all entries. */
export function decodeUvs(job: LayerJob): void {
    const { entries, layer, coder, numbers } = job;
    const { most } = layer;
    const energy = new Energy(entries.length);
    const charts = new Charts(job);
    let last = [most[0] * 0.5, most[1] * 0.5];
    for (let entry = 0; entry < entries.length; entry++) {
        const [kind, u, v] = charts.predict(entry, last, energy);
        let magnitude = energy.around();
        for (let k = 0; k < 2; k++) {
            const context = (kind * 8 + Energy.level(magnitude)) * 2 + k;
            const residual = coder.residual(layer.residuals + context);
            numbers[2 * entry + k] = nearest(k === 0 ? u : v, most[k]) + residual;
            const size = Math.abs(residual);
            energy.add(entry, size);
            magnitude = 0.5 * magnitude + size;
        }
        last = [numbers[2 * entry], numbers[2 * entry + 1]];
        charts.turn(entry);
    }
}

/** Charts of a block, as far as they are known. */
class Charts {
    /** −1 if the latest chart is mirrored. */
    private sign = 1;
    private readonly trust: number;
    /** What a face predicts, and its weight. */
    private readonly found = [0, 0, 0];
    private readonly frame = [0, 0];
    private readonly there = [0, 0];

    constructor(private readonly job: LayerJob) {
        this.trust = job.layer.mode / 8;
    }

    /** Returns the kind of an entry's surroundings and what they predict. */
    predict(entry: number, last: readonly number[], energy: Energy): [number, number, number] {
        const { entries, numbers } = this.job;
        const { found } = this;
        let [u, v, weight, faces] = [0, 0, 0, 0];
        let [sumU, sumV, neighbours] = [0, 0, 0];
        energy.clear();
        for (const corner of entries.around(entry)) {
            const a = entries.before(next(corner), entry);
            const b = entries.before(previous(corner), entry);
            for (const other of [a, b]) {
                if (other < 0) continue;
                sumU += numbers[2 * other];
                sumV += numbers[2 * other + 1];
                neighbours++;
                energy.see(other);
            }
            if (a < 0 || b < 0 || !this.across(corner, entry, a, b)) continue;
            u += found[2] * found[0];
            v += found[2] * found[1];
            weight += found[2];
            faces++;
        }
        if (faces > 0) return [faces === 1 ? FACE : FACES, u / weight, v / weight];
        if (neighbours > 0) return [NEIGHBOURS, sumU / neighbours, sumV / neighbours];
        return [NOTHING, last[0], last[1]];
    }

    /** Predicts a corner from the edge across; false if that has no length. */
    private across(corner: number, entry: number, a: number, b: number): boolean {
        const { shape, entries, numbers } = this.job;
        const { frame, there, trust, found } = this;
        const [cornerA, cornerB] = [next(corner), previous(corner)];
        if (!shape.frame(cornerA, cornerB, corner, frame)) return false;
        const [ua, va] = [numbers[2 * a], numbers[2 * a + 1]];
        const [ub, vb] = [numbers[2 * b], numbers[2 * b + 1]];
        const [eu, ev] = [ub - ua, vb - va];
        let [upU, upV] = [this.sign * -ev, this.sign * eu];
        const beyond = this.beyond(cornerA, cornerB);
        const other = beyond === NONE ? -1 : entries.before(beyond, entry);
        if (other >= 0 && shape.frame(cornerB, cornerA, beyond, there)) {
            const [ud, vd] = [numbers[2 * other], numbers[2 * other + 1]];
            const acrossU = (ud - ub + there[0] * eu) / -there[1];
            const acrossV = (vd - vb + there[0] * ev) / -there[1];
            const side = eu * (vd - va) - ev * (ud - ua) < 0 ? 1 : -1;
            upU = (1 - trust) * (-ev * side) + trust * acrossU;
            upV = (1 - trust) * (eu * side) + trust * acrossV;
        }
        const [x, y] = frame;
        const far = x * x + (1 - x) * (1 - x) + 2 * y * y;
        found[0] = ua + x * eu + y * upU;
        found[1] = va + x * ev + y * upV;
        found[2] = 1 / (0.25 + far);
        return true;
    }

    /** Returns the corner beyond an edge if its face is in the same chart, or `NONE`. */
    private beyond(a: number, b: number): number {
        const { shape, entries } = this.job;
        const twin = shape.faces.twins[a];
        if (twin === NONE) return NONE;
        const { ofCorner } = entries;
        const isSame = ofCorner[twin] === ofCorner[b] && ofCorner[next(twin)] === ofCorner[a];
        return isSame ? previous(twin) : NONE;
    }

    /** Notes which way round the chart of the latest entry lies. */
    turn(entry: number): void {
        const { entries, numbers } = this.job;
        for (const corner of entries.around(entry)) {
            const a = entries.before(next(corner), entry);
            const b = entries.before(previous(corner), entry);
            if (a < 0 || b < 0) continue;
            const way = (to: number, k: number) => numbers[2 * to + k] - numbers[2 * a + k];
            const area = way(b, 0) * way(entry, 1) - way(b, 1) * way(entry, 0);
            if (area !== 0) this.sign = Math.sign(area);
        }
    }
}
