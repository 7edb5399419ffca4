/** How the wedges of an update's children are related to those of the node that it splits. */

import { NONE } from "../model.ts";
import type { Model } from "../model.ts";
import type { SplitRecord } from "./split_record.ts";
import { LOST } from "./split_record.ts";
import type { Wedges } from "./wedges.ts";

/** Roles of wedges in the values of an update. */
export const PARENT = 0;
export const DIFFERENCE = 1;
export const SINGLE = 2;

/** The wedges of an update's children, gathered for one update after another. */
export class Family {
    /** First wedge, and how many there are. */
    start = 0;
    count = 0;
    /** Number of wedges of the first child. */
    ofFirst = 0;
    /** True if all faces of a wedge are gone at the split node. */
    readonly lost: boolean[] = [];
    /** Parent of each wedge, or `NONE` if it is out of range. */
    readonly parents: number[] = [];
    /** First wedge of the first child with the same parent, of those of the second; or `NONE`. */
    readonly siblings: number[] = [];
    /** The other wedge of a pair, or `NONE`. */
    readonly partners: number[] = [];

    constructor(
        private readonly model: Model,
        private readonly wedges: Wedges,
    ) {}

    /** Gathers the wedges of an update. */
    gather(update: number): void {
        const { model, wedges } = this;
        const first = model.firstChild(update);
        const node = model.parents[update];
        this.start = wedges.first[first];
        this.ofFirst = wedges.countOf(first);
        this.count = wedges.first[first + 2] - this.start;
        const record = wedges.records.get(update);
        if (record === undefined && this.count === 2) {
            this.pair(node === NONE ? 0 : wedges.first[node]);
        } else {
            this.relate(node, record);
        }
    }

    /** Notes that there is one wedge at either child. */
    private pair(parent: number): void {
        const { start, lost, parents, siblings, partners } = this;
        lost[0] = lost[1] = false;
        parents[0] = parents[1] = parent;
        siblings[0] = NONE;
        siblings[1] = partners[1] = start;
        partners[0] = start + 1;
    }

    private relate(node: number, record: SplitRecord | undefined): void {
        const { wedges, start, count, ofFirst } = this;
        const firstBelow = new Map<number, number>();
        for (let i = 0; i < count; i++) {
            const local = record === undefined ? 0 : record.parent(i);
            const isLost = local === LOST;
            this.lost[i] = isLost;
            this.parents[i] = node === NONE ? 0 : this.parentAt(wedges, node, isLost ? 0 : local);
            this.partners[i] = NONE;
            this.siblings[i] = NONE;
            if (isLost) continue;
            if (i < ofFirst) {
                if (!firstBelow.has(local)) firstBelow.set(local, i);
                continue;
            }
            const sibling = firstBelow.get(local);
            if (sibling === undefined) continue;
            this.siblings[i] = start + sibling;
            if (this.partners[sibling] !== NONE) continue;
            this.partners[sibling] = start + i;
            this.partners[i] = start + sibling;
        }
    }

    private parentAt(wedges: Wedges, node: number, local: number): number {
        return local < wedges.countOf(node) ? wedges.first[node] + local : NONE;
    }

    /**
     * Visits the wedges in the order in which their residuals are coded: by pairs, then the others.
     */
    inCodingOrder(visit: (wedge: number, role: number) => void): void {
        const { start, count, ofFirst, partners } = this;
        for (let i = ofFirst; i < count; i++) {
            if (partners[i] === NONE) continue;
            visit(start + i, DIFFERENCE);
            visit(partners[i], PARENT);
        }
        for (let i = 0; i < count; i++) if (partners[i] === NONE) visit(start + i, SINGLE);
    }
}
