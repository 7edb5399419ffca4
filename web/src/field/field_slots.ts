/** Triangles of a height field in slots, with a record of those that changed. */

import { NONE, grown } from "../model.ts";

/** Triangles by slot. */
export class FieldSlots {
    /** Three vertices of each slot; `NONE` in empty ones. */
    nodes = new Uint32Array(0);
    /** Height fields have no wedges. */
    readonly wedges = null;
    /** Number of slots, empty ones included. */
    slots = 0;
    /** Slots written since the mark. */
    readonly touched: number[] = [];
    /** The three vertices that each of these had at the mark. */
    readonly before: number[] = [];

    private touchedAt = new Uint32Array(0);
    private readonly holes: number[] = [];
    private mark = 1;

    get count(): number {
        return this.slots - this.holes.length;
    }

    /** Starts a new record of changes. */
    begin(): void {
        this.mark++;
        this.touched.length = 0;
        this.before.length = 0;
    }

    add(a: number, b: number, c: number): number {
        let slot = this.holes.pop();
        if (slot === undefined) {
            slot = this.slots++;
            this.nodes = grown(this.nodes, 3 * this.slots, NONE);
            this.touchedAt = grown(this.touchedAt, this.slots);
        }
        this.replace(slot, a, b, c);
        return slot;
    }

    replace(slot: number, a: number, b: number, c: number): void {
        const { nodes } = this;
        if (this.touchedAt[slot] !== this.mark) {
            this.touchedAt[slot] = this.mark;
            this.touched.push(slot);
            this.before.push(nodes[3 * slot], nodes[3 * slot + 1], nodes[3 * slot + 2]);
        }
        nodes[3 * slot] = a;
        nodes[3 * slot + 1] = b;
        nodes[3 * slot + 2] = c;
    }

    remove(slot: number): void {
        this.replace(slot, NONE, NONE, NONE);
        this.holes.push(slot);
    }
}
