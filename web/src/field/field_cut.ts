/** A cut of right triangles that follows a sequence of queries, changed diamond by diamond. */

import { Criterion } from "../cut/criterion.ts";
import { Meter } from "../cut/meter.ts";
import type { CutChange, Limits } from "../cut/meter.ts";
import type { Query } from "../cut/query.ts";
import { Schedule, above, below } from "../cut/schedule.ts";
import { FieldFront } from "./field_front.ts";
import type { FieldModel } from "./field_model.ts";
import type { FieldSlots } from "./field_slots.ts";
import type { GridPoint } from "./grid.ts";

const SCHEDULED = 1;
/** Its nested ball is required, so what depends on the vertex has been inspected. */
const OPENED = 2;

/** A mesh of a height field that follows queries, as `Cut` does for contractions. */
export class FieldCut {
    private readonly front: FieldFront;
    private readonly schedule = new Schedule();
    private readonly flags: Uint8Array;
    private readonly uninspected: number[] = [];
    private nextUninspected = 0;
    private toInsert: number[] = [];
    private readonly toRemove: number[] = [];
    private criterion!: Criterion;

    constructor(readonly model: FieldModel) {
        this.front = new FieldFront(model);
        this.schedule.grow(model.nodes);
        this.flags = new Uint8Array(model.nodes);
    }

    get triangles(): FieldSlots {
        return this.front.triangles;
    }

    /** Number of vertices. */
    get vertices(): number {
        return this.front.active;
    }

    /**
     * Refines and coarsens the cut until it satisfies a query, or a limit is reached; the next call
     * goes on from there.
     *
     * @throws RangeError if the query is invalid; the cut is unchanged
     */
    update(query: Query, limits: Limits = {}): CutChange {
        const criterion = new Criterion(query, this.model.frame);
        this.criterion = criterion;
        this.front.triangles.begin();
        const meter = new Meter(limits);
        if (this.schedule.goesOn(criterion))
            this.toInsert = this.toInsert.filter((index) => this.requires(index));
        else this.restart();
        this.inspectPending(meter);
        this.insert(meter);
        this.remove(meter);
        const waiting = this.toInsert.length + this.toRemove.length + this.schedule.due.length;
        meter.change.done = waiting === 0 && this.nextUninspected === this.uninspected.length;
        return meter.change;
    }

    private requires(index: number, radius = this.model.ownRadius(index)): boolean {
        const { model } = this;
        const [x, y, z] = model.center(model.grid.place(index));
        return this.criterion.requires(x, y, z, radius, model.error(index));
    }

    private restart(): void {
        this.schedule.clear();
        this.flags.fill(0);
        this.toInsert.length = 0;
        this.toRemove.length = 0;
        this.uninspected.length = this.nextUninspected = 0;
        this.uninspected.push(...this.front.first);
    }

    private inspectPending(meter: Meter): void {
        const { schedule, uninspected } = this;
        while (schedule.due.length > 0) {
            this.inspectDue(schedule.due.pop() as number);
            if (!meter.mayInspectMore()) return;
        }
        while (this.nextUninspected < uninspected.length) {
            const index = uninspected[this.nextUninspected++];
            // It may depend on two vertices.
            if (this.flags[index] !== 0) continue;
            this.inspect(index);
            if (!meter.mayInspectMore()) return;
        }
        uninspected.length = this.nextUninspected = 0;
    }

    private inspectDue(index: number): void {
        const { model, schedule, flags } = this;
        if (schedule.addAgain(index, model.positions)) return;
        flags[index] &= ~SCHEDULED;
        const { grid } = model;
        const isBelow = () =>
            grid.parents(grid.place(index)).some((parent) => flags[grid.index(parent)] & OPENED);
        if (this.front.has(index) || isBelow()) this.inspect(index);
        else flags[index] &= ~OPENED;
    }

    private inspect(index: number): void {
        const { model, front, flags } = this;
        const place = model.grid.place(index);
        if (model.isForced(index)) {
            flags[index] |= OPENED;
            return this.queueDependents(place);
        }
        const isRequired = this.requires(index);
        const isOpen = this.requires(index, model.nestedRadius(index));
        const isIn = front.has(index);
        if (isIn && !isRequired) this.toRemove.push(index);
        if (!isIn && isRequired) this.toInsert.push(index);
        const isScheduled = this.reschedule(index, place, isRequired, isOpen);
        const wasOpen = (flags[index] & OPENED) !== 0;
        flags[index] = (isScheduled ? SCHEDULED : 0) | (isOpen ? OPENED : 0);
        // What depends on a vertex of the cut may be in it, too.
        if (!wasOpen && (isOpen || isIn)) this.queueDependents(place);
    }

    private reschedule(
        index: number,
        place: GridPoint,
        isRequired: boolean,
        isOpen: boolean,
    ): boolean {
        const { model, criterion } = this;
        const own = criterion.reach(model.ownRadius(index), model.error(index));
        const nested = criterion.reach(model.nestedRadius(index), model.error(index));
        let [from, to] = [-Infinity, Infinity];
        if (!Number.isNaN(own) && !Number.isNaN(nested)) {
            // The schedule has the centre in single precision.
            const off = distance(model.center(place), model.positions, 3 * index);
            if (isRequired) to = below(own - off);
            else from = above(isOpen ? own + off : nested + off);
            if (!isRequired && isOpen) to = below(nested - off);
        }
        return this.schedule.add(index, model.positions, from, to);
    }

    private queueDependents(place: GridPoint): void {
        const { grid } = this.model;
        for (const dependent of grid.dependents(place)) this.uninspected.push(dependent);
    }

    /** Inserts the queued vertices, after those they depend on. */
    private insert(meter: Meter): void {
        const stack: number[] = [];
        while (this.toInsert.length > 0) {
            const index = this.toInsert.pop() as number;
            stack.push(index);
            while (stack.length > 0) {
                if (!meter.mayChangeMore()) {
                    this.toInsert.push(index);
                    return;
                }
                this.advance(stack[stack.length - 1], stack, meter);
            }
        }
    }

    private advance(next: number, stack: number[], meter: Meter): void {
        const { front } = this;
        const { grid } = this.model;
        if (!front.has(next)) {
            const place = grid.place(next);
            const missing = grid
                .parents(place)
                .map((parent) => grid.index(parent))
                .filter((parent) => !front.has(parent));
            if (missing.length > 0) return void stack.push(...missing);
            front.insert(place);
            meter.change.splits++;
            // What was only forced may go as soon as no vertex depends on it.
            if (stack.length > 1 && !this.requires(next)) this.toRemove.push(next);
        }
        stack.pop();
    }

    /**
     * Removes vertices that are neither required nor depended on, and then those that become free.
     */
    private remove(meter: Meter): void {
        const { front, model } = this;
        const { grid } = model;
        while (this.toRemove.length > 0 && meter.mayChangeMore()) {
            const index = this.toRemove.pop() as number;
            const place = grid.place(index);
            if (model.isForced(index) || !front.has(index) || this.requires(index)) continue;
            if (grid.dependents(place).some((dependent) => front.has(dependent))) continue;
            front.remove(place);
            meter.change.merges++;
            for (const parent of grid.parents(place)) this.toRemove.push(grid.index(parent));
        }
    }
}

function distance(
    [x, y, z]: readonly [number, number, number],
    positions: Float32Array,
    at: number,
): number {
    const [dx, dy, dz] = [x - positions[at], y - positions[at + 1], z - positions[at + 2]];
    return Math.sqrt(dx * dx + dy * dy + dz * dz);
}
