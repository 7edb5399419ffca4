/** The vertices of a height field that are in a cut, and the triangles between them. */

import { NONE } from "../model.ts";
import type { FieldModel } from "./field_model.ts";
import { FieldSlots } from "./field_slots.ts";
import { Extent, halvesOf, isFinest, middle, sideOf } from "./grid.ts";
import type { GridPoint, RightTriangle } from "./grid.ts";

/**
 * A triangle is known by the vertex at its right angle, and the side on which its hypotenuse lies.
 */
export class FieldFront {
    readonly triangles = new FieldSlots();
    /** Vertices of the coarsest level, and the first one that may be inserted. */
    readonly first: number[] = [];
    /** Number of vertices. */
    active = 0;
    private readonly isIn: Uint8Array;
    /** Slots of the triangles that each vertex has created, one for each side. */
    private readonly slots: Uint32Array;

    constructor(readonly model: FieldModel) {
        const { grid } = model;
        this.isIn = new Uint8Array(grid.count);
        this.slots = new Uint32Array(4 * grid.count).fill(NONE);
        for (let index = 0; index < grid.count; index++) {
            if (!model.isForced(index)) continue;
            this.first.push(index);
            this.enter(index);
        }
        const roots = grid.roots();
        const center = middle(roots[0].ends);
        if (grid.depth > 0 && grid.holds(center)) this.first.push(grid.index(center));
        roots.forEach((root) => this.start(root));
    }

    private start(triangle: RightTriangle): void {
        const { grid } = this.model;
        const extent = grid.extent(triangle);
        if (extent === Extent.Outside) return;
        // Every triangle across the border is bisected.
        const isShown =
            extent === Extent.Inside &&
            (isFinest(triangle) || !this.has(grid.index(middle(triangle.ends))));
        if (isShown) this.add(triangle);
        else halvesOf(triangle).forEach((half) => this.start(half));
    }

    has(index: number): boolean {
        return this.isIn[index] === 1;
    }

    private enter(index: number): void {
        this.isIn[index] = 1;
        this.active++;
    }

    /** Inserts a vertex: the triangles that it bisects become their halves. */
    insert(place: GridPoint): void {
        this.enter(this.model.grid.index(place));
        for (const coarse of this.coarse(place)) {
            const slot = this.take(coarse);
            if (slot === NONE) continue;
            const [first, second] = halvesOf(coarse);
            this.write(slot, first);
            this.add(second);
        }
    }

    /** Removes a vertex that no other depends on. */
    remove(place: GridPoint): void {
        for (const coarse of this.coarse(place)) {
            const [half, other] = halvesOf(coarse);
            const first = this.take(half);
            const second = this.take(other);
            if (first === NONE || second === NONE) continue;
            this.write(first, coarse);
            this.triangles.remove(second);
        }
        this.isIn[this.model.grid.index(place)] = 0;
        this.active--;
    }

    private coarse(place: GridPoint): RightTriangle[] {
        // A triangle inside has its right angle in the field, one outside has not.
        const { grid } = this.model;
        return grid.coarse(place).filter(({ apex }) => grid.holds(apex));
    }

    private keyOf(triangle: RightTriangle): number {
        return 4 * this.model.grid.index(triangle.apex) + sideOf(triangle);
    }

    private take(triangle: RightTriangle): number {
        const key = this.keyOf(triangle);
        const slot = this.slots[key];
        this.slots[key] = NONE;
        return slot;
    }

    private add(triangle: RightTriangle): void {
        this.write(this.triangles.add(NONE, NONE, NONE), triangle);
    }

    private write(slot: number, triangle: RightTriangle): void {
        const { grid, looksDown } = this.model;
        const b = grid.index(triangle.ends[0]);
        const c = grid.index(triangle.ends[1]);
        this.triangles.replace(
            slot,
            grid.index(triangle.apex),
            looksDown ? c : b,
            looksDown ? b : c,
        );
        this.slots[this.keyOf(triangle)] = slot;
    }
}
