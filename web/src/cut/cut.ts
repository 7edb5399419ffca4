/**
 * A cut that follows a sequence of queries, refined and coarsened only where the query has moved.
 */

import type { ChunkEntry } from "../file/header.ts";
import { ERRORS, RADII } from "../file/lengths.ts";
import { NONE, grown } from "../model.ts";
import type { Model } from "../model.ts";
import { Criterion } from "./criterion.ts";
import { Front, State } from "./front.ts";
import { Meter } from "./meter.ts";
import type { CutChange, Limits } from "./meter.ts";
import type { Query } from "./query.ts";
import { Schedule, above, below } from "./schedule.ts";
import type { Triangles } from "./triangles.ts";

/**
 * A mesh that follows queries, such as the views of a moving camera.
 *
 * Whenever an update is interrupted, the mesh is one of the model's: without cracks.
 */
export class Cut {
    private readonly front: Front;
    private readonly schedule = new Schedule();
    private scheduled = new Uint8Array(0);
    /** Nodes whose updates, with all below, are still to be inspected, from a place on. */
    private readonly uninspected: number[] = [];
    private nextUninspected = 0;
    /** Updates that the query requires, and updates that may be undone. */
    private toSplit: number[] = [];
    private readonly toMerge: number[] = [];
    private refine!: Criterion;
    /** A tighter criterion, which applied updates have to fail before they are undone. */
    private keep: Criterion | null = null;
    /**
     * Chunks that the query wants and that are missing before others that are there. What may depend
     * on them is not split.
     */
    gaps: readonly ChunkEntry[] = [];

    /**
     * Creates a cut that is the base mesh.
     *
     * @param hysteresis part by which the tolerance must exceed the error of a split before that is
     *     undone, so that a jittering query changes nothing; with 0 the answer does not depend on
     *     earlier queries
     */
    constructor(
        readonly model: Model,
        private readonly hysteresis = 0,
    ) {
        this.front = new Front(model);
        this.grow();
    }

    /** Takes in updates that the model has got since; the next query inspects everything. */
    grow(): void {
        this.front.grow();
        this.schedule.grow(this.model.nodes);
        this.scheduled = grown(this.scheduled, this.model.nodes);
        this.schedule.forget();
    }

    /** Triangles by slot, with those that the last update changed. */
    get triangles(): Triangles {
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
     * The result is the smallest cut that satisfies the query. What a change costs depends on what
     * changes if only the eye of a camera that looks at everything has moved; otherwise every
     * vertex
     * is inspected as well.
     *
     * @param refined hears once the cut has been refined and before it is coarsened: triangles that
     *     the former touched are not among those that are touched in the end
     * @throws RangeError if the query is invalid; the cut is unchanged
     */
    update(query: Query, limits: Limits = {}, refined?: () => void): CutChange {
        const { frame } = this.model;
        const refine = new Criterion(query, frame);
        this.keep =
            this.hysteresis > 0 ? new Criterion(query, frame, 1 / (1 + this.hysteresis)) : null;
        this.refine = refine;
        this.front.triangles.begin();
        const meter = new Meter(limits);
        if (this.schedule.goesOn(refine)) {
            this.toSplit = this.toSplit.filter((update) => this.requires(refine, update));
        } else {
            this.restart();
        }
        this.inspectPending(meter);
        this.split(meter);
        if (refined) {
            refined();
            this.front.triangles.begin();
        }
        this.merge(meter);
        const waiting = this.toSplit.length + this.toMerge.length + this.schedule.due.length;
        meter.change.done = waiting === 0 && this.nextUninspected === this.uninspected.length;
        return meter.change;
    }

    private requires(criterion: Criterion, update: number): boolean {
        const { positions, parents, radii, errors } = this.model;
        const at = 3 * parents[update];
        const [x, y, z] = [positions[at], positions[at + 1], positions[at + 2]];
        return criterion.requires(x, y, z, RADII[radii[update]], ERRORS[errors[update]]);
    }

    private mayStay(update: number): boolean {
        return this.requires(this.keep ?? this.refine, update);
    }

    private restart(): void {
        this.schedule.clear();
        this.scheduled.fill(0);
        this.toSplit.length = 0;
        this.toMerge.length = 0;
        this.uninspected.length = this.nextUninspected = 0;
        for (let root = 0; root < this.model.roots; root++) this.uninspected.push(root);
    }

    /**
     * Inspects the updates that are due, then goes on with those not yet seen, coarse before fine.
     */
    private inspectPending(meter: Meter): void {
        const { model, schedule, uninspected } = this;
        while (schedule.due.length > 0) {
            this.inspectDue(schedule.due.pop() as number);
            if (!meter.mayInspectMore()) return;
        }
        while (this.nextUninspected < uninspected.length) {
            const node = uninspected[this.nextUninspected++];
            const update = model.updateOf[node];
            if (update === NONE) continue;
            if (this.front.state(node) === State.Split) {
                const first = model.firstChild(update);
                uninspected.push(first, first + 1);
            }
            // It may have been split and inspected since it was queued.
            if (model.isFusedWithParent(update) || this.scheduled[node]) continue;
            this.inspect(update, node);
            if (!meter.mayInspectMore()) return;
        }
        uninspected.length = this.nextUninspected = 0;
    }

    private inspectDue(node: number): void {
        const { model, schedule } = this;
        if (schedule.addAgain(node, model.positions)) return;
        this.scheduled[node] = 0;
        this.inspect(model.updateOf[node], node);
    }

    /**
     * Queues an update for a split or a merge as the query demands, and schedules its next
     * inspection.
     */
    private inspect(update: number, node: number): void {
        const state = this.front.state(node);
        const isRequired = this.requires(this.refine, update);
        const mayStay = isRequired || (this.keep !== null && this.requires(this.keep, update));
        if (state === State.Absent) return;
        if (state === State.Split && !mayStay) this.toMerge.push(update);
        if (state === State.Active && isRequired) this.toSplit.push(update);
        this.reschedule(update, node, isRequired, mayStay);
    }

    private reschedule(update: number, node: number, isRequired: boolean, mayStay: boolean): void {
        const { radii, errors, positions } = this.model;
        const radius = RADII[radii[update]];
        const error = ERRORS[errors[update]];
        const least = this.refine.reach(radius, error);
        const kept = this.keep ? this.keep.reach(radius, error) : NaN;
        const most = Number.isNaN(kept) ? least : kept;
        let [from, to] = [-Infinity, Infinity];
        if (!Number.isNaN(least)) {
            if (isRequired) to = below(least);
            else from = above(mayStay ? least : most);
            if (!isRequired && mayStay) to = below(most);
        }
        if (this.schedule.add(node, positions, from, to)) this.scheduled[node] = 1;
    }

    /** Inspects the children of a split for the first time. */
    private inspectChildren(update: number): void {
        const { model } = this;
        const first = model.firstChild(update);
        for (let node = model.isFused(update) ? first + 1 : first; node < first + 2; node++) {
            const own = model.updateOf[node];
            if (own === NONE) continue;
            if (!this.scheduled[node]) this.inspect(own, node);
            else if (this.requires(this.refine, own)) this.toSplit.push(own);
        }
    }

    /** Applies the queued updates with their dependencies. */
    private split(meter: Meter): void {
        const { model, front, toSplit } = this;
        const stack: number[] = [];
        while (toSplit.length > 0) {
            const update = toSplit.pop() as number;
            // It may have been forced already, or merged with its surroundings.
            if (front.state(model.parents[update]) !== State.Active) continue;
            // With the missing chunk everything is inspected again.
            if (this.gaps.length > 0 && this.mayLackDependencies(update)) continue;
            stack.push(update);
            while (stack.length > 0) {
                if (!meter.mayChangeMore()) {
                    toSplit.push(update);
                    return;
                }
                this.advance(stack[stack.length - 1], stack, meter);
            }
        }
    }

    /**
     * Returns false only if all dependencies of an update that the query requires are there: the area
     * of a chunk holds what depends on it, and no error of that is greater.
     */
    private mayLackDependencies(update: number): boolean {
        const { positions, parents, errors } = this.model;
        const at = 3 * parents[update];
        const error = ERRORS[errors[update]];
        return this.gaps.some(
            (gap) =>
                error <= gap.error &&
                gap.min.every((least, k) => least <= positions[at + k]) &&
                gap.max.every((most, k) => positions[at + k] <= most),
        );
    }

    /** Applies the last update of a chain, or appends those that come first. */
    private advance(next: number, stack: number[], meter: Meter): void {
        const { model, front } = this;
        const node = model.parents[next];
        const state = front.state(node);
        if (state === State.Absent) return void stack.push(model.creator(node));
        if (state === State.Split) return void stack.pop();
        if (!front.split(next, stack)) return;
        stack.pop();
        meter.change.splits++;
        // What was only forced may go as soon as no update depends on it.
        if (stack.length > 0 && !this.mayStay(next)) this.toMerge.push(next);
        if (model.isFused(next)) {
            const inner = model.updateOf[model.firstChild(next)];
            if (front.split(inner, stack)) this.inspectChildren(inner);
        }
        this.inspectChildren(next);
    }

    /**
     * Undoes updates that are neither required nor depended on, and then those that become free.
     */
    private merge(meter: Meter): void {
        const { model, front, toMerge } = this;
        while (toMerge.length > 0 && meter.mayChangeMore()) {
            const update = toMerge.pop() as number;
            const node = model.parents[update];
            if (front.state(node) !== State.Split || this.mayStay(update) || !front.merge(update))
                continue;
            meter.change.merges++;
            this.queueAbove(node);
            front.gather(node);
            const { a, b, count } = front.star;
            for (let i = 0; i < count; i++) {
                this.queueAbove(a[i]);
                this.queueAbove(b[i]);
            }
        }
    }

    /** Queues the update that created a node, or the whole that it is a part of. */
    private queueAbove(node: number): void {
        const { model, toMerge } = this;
        if (node < model.roots) return;
        const update = model.creator(node);
        toMerge.push(
            model.isFusedWithParent(update) ? model.creator(model.parents[update]) : update,
        );
    }
}
