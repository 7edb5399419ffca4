/** The surface of a cut: its vertices and triangles, which splits and merges change. */

import { LAST_WING, NONE, NO_WING, OPEN, grown } from "../model.ts";
import type { Model } from "../model.ts";
import { SplitWedges } from "./split_wedges.ts";
import { MOST_SEARCHED, Star, Triangles, after, slotOf } from "./triangles.ts";

/** Lists of corners of nodes that are not there yet, and of nodes that have been split. */
const ABSENT = NONE - 1;
const SPLIT = NONE - 2;

/** Level of what created a root. */
const TOP = 0xffff;
const MOST_RANKED = 250;

/** What a node is to a cut. */
export const enum State {
    Absent,
    Active,
    Split,
}

/** The active vertices, and the triangles between them. */
export class Front {
    readonly triangles: Triangles;
    /** Faces around the vertex of the last split, or test for one. */
    readonly star = new Star();
    /** Number of active vertices. */
    active = 0;

    /** First corner of each node. */
    private heads = new Uint32Array(0);
    /** Levels of the updates that split each node and that created it. */
    private levels = new Uint16Array(0);
    private above = new Uint16Array(0);
    private readonly splitWedges: SplitWedges | null;
    /** Nodes of the faces that a split creates, and wedges of one of them. */
    private readonly created: number[] = [];
    private readonly corners: number[] = [];

    /** Starts at the base mesh. */
    constructor(readonly model: Model) {
        const { wedges, base } = model;
        this.triangles = new Triangles(wedges !== null);
        this.splitWedges = wedges && new SplitWedges(model, wedges, this.triangles, this.star);
        this.grow();
        for (let root = 0; root < model.roots; root++) this.activate(root, TOP);
        for (let at = 0; at < base.length; at += 3) {
            const face = base.subarray(at, at + 3);
            if (wedges) this.corners.splice(0, 3, ...wedges.base.subarray(at, at + 3));
            this.add(face[0], face[1], face[2]);
        }
    }

    /** Takes in updates that have been read since. */
    grow(): void {
        const { nodes, updateOf, levels } = this.model;
        this.heads = grown(this.heads, nodes, ABSENT);
        this.levels = grown(this.levels, this.heads.length);
        this.above = grown(this.above, this.heads.length);
        for (let node = 0; node < nodes; node++) {
            const update = updateOf[node];
            this.levels[node] = update === NONE ? 0 : levels[update];
        }
    }

    /** Returns what a node is to the cut. */
    state(node: number): State {
        const head = this.heads[node];
        return head === ABSENT ? State.Absent : head === SPLIT ? State.Split : State.Active;
    }

    private activate(node: number, above: number): void {
        this.heads[node] = NONE;
        this.above[node] = above;
        this.active++;
    }

    private add(a: number, b: number, c: number): void {
        const { triangles, heads } = this;
        const at = 3 * triangles.add();
        if (triangles.wedges)
            for (let k = 0; k < 3; k++) triangles.wedges[at + k] = this.corners[k];
        triangles.attach(at, a, heads);
        triangles.attach(at + 1, b, heads);
        triangles.attach(at + 2, c, heads);
    }

    /** Gathers the faces around a vertex. */
    gather(node: number): void {
        this.star.count = 0;
        this.triangles.gather(this.heads[node], this.star);
    }

    /**
     * Returns true if an update's node, which must be active, may be split; else appends what comes
     * first.
     */
    maySplit(update: number, first: number[]): boolean {
        const { model, star } = this;
        this.gather(model.parents[update]);
        const known = first.length;
        this.checkLevels(star.a, model.levels[update], first);
        // There is a neighbour that no face follows.
        if (model.flags[update] & OPEN) this.checkLevels(star.b, model.levels[update], first);
        return first.length === known;
    }

    private checkLevels(nodes: Uint32Array, level: number, first: number[]): void {
        const { levels, star } = this;
        for (let i = 0; i < star.count; i++) {
            if (levels[nodes[i]] > level) first.push(this.model.updateOf[nodes[i]]);
        }
    }

    /**
     * Splits an update's node, which must be active, if it may be; else appends what comes first.
     */
    split(update: number, first: number[]): boolean {
        const may = this.maySplit(update, first);
        if (may) this.apply(update);
        return may;
    }

    /** Applies an update right after `maySplit` has allowed it. */
    apply(update: number): void {
        const { model, star, triangles, heads, splitWedges } = this;
        const node = model.parents[update];
        const first = model.firstChild(update);
        heads[node] = SPLIT;
        this.active--;
        this.activate(first, model.levels[update]);
        this.activate(first + 1, model.levels[update]);
        const run = this.partitionStar(update);
        splitWedges?.begin(update);
        for (let i = 0; i < star.count; i++) {
            const child = i < run ? first + 1 : first;
            const corner = star.corners[i];
            if (splitWedges) {
                const wedges = triangles.wedges as Uint32Array;
                wedges[corner] = splitWedges.around(child, i, wedges[corner]);
            }
            triangles.attach(corner, child, heads);
        }
        this.addCreated();
    }

    private addCreated(): void {
        const { created, splitWedges } = this;
        for (let at = 0; at < created.length; at += 3) {
            const face = [created[at], created[at + 1], created[at + 2]];
            // In a damaged file a face may have any nodes.
            if (!face.every((node) => this.state(node) === State.Active)) continue;
            splitWedges?.created(face, at / 3, this.corners);
            this.add(face[0], face[1], face[2]);
        }
    }

    /**
     * Moves the faces of the second child to the front of the star; returns how many, and notes
     * created faces.
     */
    private partitionStar(update: number): number {
        const { model, star, created } = this;
        const first = model.firstChild(update);
        created.length = 0;
        const nonFan = model.nonFans.get(update);
        const wings = model.wings;
        if (nonFan && wings[2 * update] === NO_WING && wings[2 * update + 1] === NO_WING) {
            created.push(...nonFan.created);
            return this.moveListed(nonFan.second);
        }
        const start = this.wing(wings[2 * update]);
        const end = this.wing(wings[2 * update + 1]);
        let run = 0;
        const isBackwards = start === NONE;
        const stop = isBackwards ? NONE : end;
        for (let at = isBackwards ? end : start; at !== stop; run++) {
            const list = isBackwards ? star.b : star.a;
            let found = run;
            while (found < star.count && list[found] !== at) found++;
            if (found === star.count) break;
            star.swap(run, found);
            at = isBackwards ? star.a[run] : star.b[run];
        }
        if (start !== NONE) created.push(first, start, first + 1);
        if (end !== NONE) created.push(first + 1, end, first);
        if (created.length === 0 && nonFan) created.push(...nonFan.created);
        return run;
    }

    private moveListed(second: Uint32Array): number {
        const { star } = this;
        let run = 0;
        for (let i = 0; i < star.count; i++) {
            for (let at = 0; at < second.length; at += 2) {
                if (second[at] !== star.a[i] || second[at + 1] !== star.b[i]) continue;
                star.swap(run++, i);
                break;
            }
        }
        return run;
    }

    /**
     * Returns the node of a wing, by its rank among the nodes that a face follows; `NONE` if there
     * is none.
     */
    private wing(code: number): number {
        const { star } = this;
        const { a, b, count } = star;
        if (code === NO_WING || count > MOST_RANKED) return NONE;
        if (code === LAST_WING) {
            const isFollowed = (node: number) => a.subarray(0, count).includes(node);
            for (let i = 0; i < count; i++) if (!isFollowed(b[i])) return b[i];
            return NONE;
        }
        const { rank } = this.model;
        for (let i = 0; i < count; i++) {
            let below = 0;
            for (let j = 0; j < count; j++) if (rank[a[j]] < rank[a[i]]) below++;
            if (below === code) return a[i];
        }
        return NONE;
    }

    /** Undoes an update, and the one fused to it, unless another depends on it. */
    merge(update: number): boolean {
        const { model, heads, triangles } = this;
        const first = model.firstChild(update);
        const isFused = model.isFused(update);
        const inner = isFused ? model.updateOf[first] : NONE;
        const parts = isFused
            ? [first + 1, model.firstChild(inner), model.firstChild(inner) + 1]
            : [first + 1, first];
        if (!parts.every((child) => this.state(child) === State.Active)) return false;
        const level = model.levels[update];
        const isNeeded = (node: number) => this.above[node] <= level && !parts.includes(node);
        // A vertex that cannot be merged mostly shows it at one of its first triangles.
        if (parts.some((child) => triangles.someAround(heads[child], isNeeded))) return false;
        if (isFused) this.undo(inner);
        this.undo(update);
        return true;
    }

    /** Replaces both children of an update by its node. */
    private undo(update: number): void {
        const { model, star, triangles, heads, splitWedges } = this;
        const node = model.parents[update];
        const first = model.firstChild(update);
        star.count = 0;
        splitWedges?.begin(update);
        for (const child of [first, first + 1]) {
            const start = star.count;
            triangles.gather(heads[child], star);
            heads[child] = ABSENT;
            for (let i = start; splitWedges && i < star.count; i++) {
                const wedges = triangles.wedges as Uint32Array;
                wedges[star.corners[i]] = splitWedges.merged(child, wedges[star.corners[i]]);
            }
        }
        this.active -= 2;
        this.activate(node, node < model.roots ? TOP : model.levels[model.creator(node)]);
        const isChild = (n: number) => n === first || n === first + 1;
        for (let i = 0; i < star.count; i++) {
            const a = star.a[i];
            const b = star.b[i];
            if (!isChild(a) && !isChild(b)) triangles.attach(star.corners[i], node, heads);
            // It is met from both ends; the first removes it.
            else if (!(isChild(a) && isChild(b)) && this.isFirst(i)) {
                this.remove(slotOf(star.corners[i]), isChild(a) ? b : a, [first, first + 1, node]);
            }
        }
    }

    private isFirst(place: number): boolean {
        const { corners } = this.star;
        const slot = slotOf(corners[place]);
        for (let i = 0; i < place; i++) if (slotOf(corners[i]) === slot) return false;
        return true;
    }

    /**
     * Removes a triangle that is left in the list of one vertex; the lists of some others are
     * invalid.
     */
    private remove(slot: number, wing: number, invalid: readonly number[]): void {
        const { triangles, heads } = this;
        if (triangles.unlink(slot, wing, heads, MOST_SEARCHED)) return triangles.remove(slot);
        // At a hub another triangle, from the start of its list, takes the slot.
        const other = triangles.unlinkWithout(wing, heads, invalid);
        if (other === NONE) {
            triangles.unlink(slot, wing, heads, Infinity);
            return triangles.remove(slot);
        }
        let to = 3 * slot + triangles.nodes.subarray(3 * slot, 3 * slot + 3).indexOf(wing);
        let from = other;
        if (triangles.wedges) triangles.wedges[to] = triangles.wedges[other];
        for (let k = 0; k < 2; k++) {
            to = after(to);
            from = after(from);
            triangles.replace(from, to, triangles.nodes[from], heads);
        }
        triangles.remove(slotOf(other));
    }
}
