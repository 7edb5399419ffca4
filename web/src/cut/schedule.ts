/**
 * When updates are inspected again: not before the viewpoint may have crossed a sphere about their
 * ball.
 */

import { grown } from "../model.ts";
import type { Criterion } from "./criterion.ts";

/** The finest step is 2⁻³⁰ units of distance. */
const FINEST = 30;
const OCTAVES = 48;
/** Steps per octave, and lists of each: an entry is up to 32 steps ahead. */
const STEPS = 16;
const RING = 64;
/** Distance after which the schedule starts anew, so that short steps are not lost in the sum. */
const LONGEST_PATH = 1e3;
/** Part of the way by which an entry is early, to allow for rounding. */
const SLACK = 1e-12;

/**
 * Nodes by the length of the viewpoint's path at which they are due; each is on it once at most.
 */
export class Schedule {
    /** Nodes due now. */
    readonly due: number[] = [];
    private readonly rings: number[][] = Array.from({ length: OCTAVES * RING }, () => []);
    private readonly counts = new Uint32Array(OCTAVES);
    /** Distances between which the decision on each node does not change. */
    private least = new Float32Array(0);
    private most = new Float32Array(0);
    private viewpoint: Criterion | null = null;
    private lastKey: number[] | null = null;
    private path = 0;

    /** Makes room for nodes. */
    grow(nodes: number): void {
        this.least = grown(this.least, nodes);
        this.most = grown(this.most, nodes);
    }

    /** Takes up the next query; returns true if it goes on from the last one. */
    goesOn(criterion: Criterion): boolean {
        const key = criterion.key;
        const last = this.lastKey;
        this.lastKey = key;
        const isSame =
            last !== null && last.length === key.length && last.every((x, i) => x === key[i]);
        return this.follow(criterion.hasViewpoint ? criterion : null) || isSame;
    }

    /**
     * Moves the viewpoint, and collects what is due; returns false if everything has to be
     * inspected.
     */
    private follow(viewpoint: Criterion | null): boolean {
        const last = this.viewpoint;
        this.viewpoint = viewpoint;
        if (!last || !viewpoint || last.slope !== viewpoint.slope) return false;
        const from = this.path;
        const [x, y, z] = [last.x - viewpoint.x, last.y - viewpoint.y, last.z - viewpoint.z];
        const step = Math.sqrt(x * x + y * y + z * z);
        // Rounded up at every step, however many and short they are.
        if (step > 0) this.path = nextDouble(this.path + step * (1 + SLACK));
        if (!(this.path <= LONGEST_PATH)) return false;
        for (let octave = 0; octave < OCTAVES; octave++)
            if (this.counts[octave] > 0) this.collect(octave, from);
        return true;
    }

    /** Makes the next query inspect everything. */
    forget(): void {
        this.viewpoint = null;
        this.lastKey = null;
    }

    /** Removes all entries. */
    clear(): void {
        this.path = 0;
        this.counts.fill(0);
        this.due.length = 0;
        for (const ring of this.rings) ring.length = 0;
    }

    /**
     * Schedules a node that has just been inspected; returns false if its decision never changes.
     */
    add(node: number, positions: Float32Array, least: number, most: number): boolean {
        this.least[node] = least;
        this.most[node] = most;
        if (!this.viewpoint) return false;
        const slack = this.slack(node, positions, this.viewpoint);
        if (!(slack < Infinity)) return false;
        this.enter(node, Math.max(slack, 0));
        return true;
    }

    /** Reschedules a node and returns true, if its decision cannot have changed. */
    addAgain(node: number, positions: Float32Array): boolean {
        if (!this.viewpoint) return false;
        const slack = this.slack(node, positions, this.viewpoint);
        if (!(slack > 0)) return false;
        this.enter(node, slack);
        return true;
    }

    /** Returns the distance that the viewpoint may move before the decision can change. */
    private slack(node: number, positions: Float32Array, { x, y, z }: Criterion): number {
        const dx = x - positions[3 * node];
        const dy = y - positions[3 * node + 1];
        const dz = z - positions[3 * node + 2];
        const distance = Math.sqrt(dx * dx + dy * dy + dz * dz);
        const slack = Math.min(distance - this.least[node], this.most[node] - distance);
        return slack - SLACK * (distance + this.path);
    }

    private enter(node: number, slack: number): void {
        const steps = Math.max(Math.trunc(slack * (2 ** FINEST / STEPS)), 1);
        const log =
            steps < 2 ** 32 ? 31 - Math.clz32(steps) : 63 - Math.clz32(Math.floor(steps / 2 ** 32));
        const octave = Math.min(log, OCTAVES - 1);
        const most = (2 * STEPS) / 2 ** (FINEST - octave);
        const at = stepAt(this.path + Math.min(slack, most), octave);
        this.rings[octave * RING + (at % RING)].push(node);
        this.counts[octave]++;
    }

    /** Collects what became due since a length of the path. */
    private collect(octave: number, path: number): void {
        const to = stepAt(this.path, octave);
        // Only in the finest octave can an entry be in the step in which it was added.
        const from = stepAt(path, octave) + (octave === 0 ? 0 : 1);
        for (let at = Math.max(from, to - RING + 1); at <= to; at++) {
            const ring = this.rings[octave * RING + (at % RING)];
            this.counts[octave] -= ring.length;
            for (const node of ring) this.due.push(node);
            ring.length = 0;
        }
    }
}

function stepAt(path: number, octave: number): number {
    return Math.trunc(path * 2 ** (FINEST - octave));
}

const double = new Float64Array(1);
const halves = new Uint32Array(double.buffer);

function nextDouble(x: number): number {
    double[0] = x;
    if (++halves[0] === 0x100000000 || halves[0] === 0) halves[1]++;
    return double[0];
}

const float = new Float32Array(1);
const bits = new Int32Array(float.buffer);

/** Returns the least distance of an open interval above one, as `f32` rounded inwards. */
export function above(distance: number): number {
    return nextFloat(distance, 1);
}

/** Returns the greatest distance of an open interval below one, as `f32` rounded inwards. */
export function below(distance: number): number {
    return distance < Infinity && distance > -Infinity ? nextFloat(distance, -1) : Infinity;
}

function nextFloat(x: number, up: 1 | -1): number {
    float[0] = x;
    if (float[0] === up * Infinity || Number.isNaN(x)) return float[0];
    if (float[0] === 0) {
        bits[0] = 1;
        return up * float[0];
    }
    bits[0] += float[0] > 0 === up > 0 ? 1 : -1;
    return float[0];
}
