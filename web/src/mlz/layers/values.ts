/** Colours, weights and all other values, predicted from those of neighbours. */

import { NONE, next, previous } from "../block_shape.ts";
import { Energy, nearest } from "./coder.ts";
import { ENTRY_BITS } from "./format.ts";
import type { LayerJob } from "./job.ts";

/** Bits of the mode: neighbours' values may be repeated; faces predict parallelograms. */
const COPIES = 1;
const PARALLELOGRAMS = 2;
const COMPONENTS = 4;

/** Decodes the values of all entries. */
export function decodeValues(job: LayerJob): void {
    const width = job.layer.most.length;
    const around = new Surroundings(job, width);
    for (let entry = 0; entry < job.entries.length; entry++) {
        around.gather(entry);
        const other = around.copied();
        if (other < 0) around.decodeRow(entry);
        else job.numbers.copyWithin(width * entry, width * other, width * (other + 1));
    }
}

/** Known values around an entry, and what they predict. */
class Surroundings {
    private readonly predicted: Float64Array;
    /** The first neighbour, and the first other one. */
    private first = -1;
    private second = -1;
    private readonly energy: Energy;
    private wasCopied = false;

    constructor(
        private readonly job: LayerJob,
        private readonly width: number,
    ) {
        this.predicted = new Float64Array(width);
        this.energy = new Energy(job.entries.length);
    }

    /** Predicts an entry by the mean of its neighbours, or of parallelograms. */
    gather(entry: number): void {
        const { job, predicted, energy } = this;
        const { entries, shape, layer } = job;
        energy.clear();
        predicted.fill(0);
        [this.first, this.second] = [-1, -1];
        let [count, faces] = [0, 0];
        for (const corner of entries.around(entry)) {
            const a = entries.before(next(corner), entry);
            const b = entries.before(previous(corner), entry);
            for (const other of [a, b]) {
                if (other < 0) continue;
                this.meet(other);
                if (faces > 0) continue;
                this.add(other, 1);
                count++;
            }
            if ((layer.mode & PARALLELOGRAMS) === 0 || a < 0 || b < 0) continue;
            const twin = shape.faces.twins[next(corner)];
            const apex = twin === NONE ? -1 : entries.before(previous(twin), entry);
            if (apex < 0) continue;
            if (faces++ === 0) predicted.fill(0);
            this.add(a, 1);
            this.add(b, 1);
            this.add(apex, -1);
        }
        const all = faces > 0 ? faces : Math.max(count, 1);
        for (let k = 0; k < this.width; k++) predicted[k] /= all;
    }

    private add(entry: number, sign: number): void {
        const { width, predicted, job } = this;
        for (let k = 0; k < width; k++) predicted[k] += sign * job.numbers[width * entry + k];
    }

    private meet(other: number): void {
        this.energy.see(other);
        if (this.first < 0) this.first = other;
        else if (this.second < 0 && other !== this.first) this.second = other;
    }

    /** Decodes whether an entry has the values of a neighbour; returns that, or −1. */
    copied(): number {
        const { coder, layer } = this.job;
        if ((layer.mode & COPIES) === 0) return -1;
        const context = layer.bits + ENTRY_BITS + Number(this.wasCopied);
        let found = -1;
        if (this.first >= 0 && coder.bit(context)) found = this.first;
        else if (this.second >= 0 && coder.bit(context + 2)) found = this.second;
        this.wasCopied = found >= 0;
        return found;
    }

    /** Decodes the numbers of an entry. */
    decodeRow(entry: number): void {
        const { width, job, energy } = this;
        const { numbers, layer, coder } = job;
        const isKnown = this.first >= 0;
        let magnitude = energy.around();
        for (let k = 0; k < width; k++) {
            const most = layer.most[k];
            const before = entry === 0 ? most >> 1 : numbers[width * (entry - 1) + k];
            const predicted = isKnown ? nearest(this.predicted[k], most) : before;
            const level = Number(isKnown) * 8 + Energy.level(magnitude);
            const context = level * COMPONENTS + Math.min(k, COMPONENTS - 1);
            const residual = coder.residual(layer.residuals + context);
            numbers[width * entry + k] = predicted + residual;
            const size = Math.abs(residual);
            energy.add(entry, size / width);
            magnitude = 0.5 * (magnitude + size);
        }
    }
}
