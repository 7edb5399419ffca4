/** Wedges of the faces around a vertex that is split or merged. */

import { NONE } from "../model.ts";
import type { Model } from "../model.ts";
import { LOST } from "../wedges/split_record.ts";
import type { SplitRecord } from "../wedges/split_record.ts";
import type { Wedges } from "../wedges/wedges.ts";
import { after, before } from "./triangles.ts";
import type { Star, Triangles } from "./triangles.ts";

/** What updates do to wedges, one update after another. */
export class SplitWedges {
    private node = 0;
    private first = 0;
    private record: SplitRecord | undefined;

    constructor(
        private readonly model: Model,
        private readonly wedges: Wedges,
        private readonly triangles: Triangles,
        private readonly star: Star,
    ) {}

    /** Turns to an update. */
    begin(update: number): void {
        this.node = this.model.parents[update];
        this.first = this.model.firstChild(update);
        this.record = this.wedges.records.get(update);
    }

    private wedge(corner: number): number {
        return (this.triangles.wedges as Uint32Array)[corner];
    }

    private isChild(node: number): boolean {
        return node === this.first || node === this.first + 1;
    }

    /** Number of wedges before those of a child in the record. */
    private before(child: number): number {
        return child === this.first ? 0 : this.wedges.countOf(this.first);
    }

    /** Returns the wedge that a face of the star gets at a child, given the one that it had. */
    around(child: number, at: number, had: number): number {
        const { record, wedges } = this;
        if (record === undefined) return wedges.first[child];
        return record.isContinued
            ? this.below(child, had)
            : wedges.at(child, record.ofFace(this.rankOf(at)));
    }

    /** Returns how many faces of the star come before one, by the ranks of their nodes. */
    private rankOf(at: number): number {
        const { rank } = this.model;
        const { a, b, count } = this.star;
        const [ownA, ownB] = [rank[a[at]], rank[b[at]]];
        let below = 0;
        for (let i = 0; i < count; i++) {
            const other = rank[a[i]];
            if (other < ownA || (other === ownA && rank[b[i]] < ownB)) below++;
        }
        return below;
    }

    /** Returns the first wedge of a child whose parent is a wedge, or else its first. */
    private below(child: number, parent: number): number {
        const { record, wedges } = this;
        const first = wedges.first[child];
        if (record === undefined) return first;
        const local = parent - wedges.first[this.node];
        const skipped = this.before(child);
        const count = wedges.countOf(child);
        for (let i = 0; i < count; i++)
            if (record.parent(skipped + i) === local && local !== LOST) return first + i;
        return first;
    }

    /** Writes the wedges of a face that the split creates. */
    created(face: readonly number[], at: number, to: number[]): void {
        const { record, wedges } = this;
        if (record?.isContinued) return this.continuing(face, record.follows(at), to);
        for (let k = 0; k < 3; k++) {
            const node = face[k];
            if (record) to[k] = wedges.at(node, record.ofCreated(at, k));
            else to[k] = this.isChild(node) ? wedges.first[node] : this.atWing(node);
        }
    }

    /** Writes the wedges of a face that continues the one that its wing precedes, or follows. */
    private continuing(face: readonly number[], isFollowed: boolean, to: number[]): void {
        const { star, wedges } = this;
        const isWing = (node: number) => face.includes(node) && !this.isChild(node);
        const list = isFollowed ? star.b : star.a;
        let at = 0;
        while (at < star.count && !isWing(list[at])) at++;
        if (at === star.count) {
            for (let k = 0; k < 3; k++) to[k] = wedges.first[face[k]];
            return;
        }
        const corner = star.corners[at];
        const parent = this.merged(this.triangles.nodes[corner], this.wedge(corner));
        const ahead = isFollowed ? before(corner) : after(corner);
        for (let k = 0; k < 3; k++) {
            to[k] = this.isChild(face[k]) ? this.below(face[k], parent) : this.wedge(ahead);
        }
    }

    /**
     * Returns the wedge at a wing in the face that it follows around the node, or else precedes.
     */
    private atWing(node: number): number {
        const { star } = this;
        for (let i = 0; i < star.count; i++)
            if (star.a[i] === node) return this.wedge(after(star.corners[i]));
        for (let i = 0; i < star.count; i++)
            if (star.b[i] === node) return this.wedge(before(star.corners[i]));
        return this.wedges.first[node];
    }

    /** Returns the wedge of the split node that one of a child becomes when they are merged. */
    merged(child: number, wedge: number): number {
        const parent = parentOf(this.model, this.wedges, child, wedge);
        return parent === NONE ? this.wedges.first[this.node] : parent;
    }
}

/**
 * Returns the wedge of the split node that one of a child continues; `NONE` if all its faces are
 * gone there.
 */
export function parentOf(model: Model, wedges: Wedges, child: number, wedge: number): number {
    const update = model.creator(child);
    const node = model.parents[update];
    const first = model.firstChild(update);
    const record = wedges.records.get(update);
    if (record === undefined) return wedges.first[node];
    const before = child === first ? 0 : wedges.countOf(first);
    const local = record.parent(before + wedge - wedges.first[child]);
    return local === LOST ? NONE : wedges.at(node, local);
}
