/** Attribute values from their residuals, in the order in which updates are applied. */

import { NONE } from "../model.ts";
import type { Model } from "../model.ts";
import { Front, State } from "../cut/front.ts";
import { after, before } from "../cut/triangles.ts";
import { toInt32 } from "../file/tangent_plane.ts";
import { DIFFERENCE, Family } from "./family.ts";
import { Known, SortedStar } from "./known.ts";
import type { LayerColumns } from "./known.ts";
import { Slopes, newShares } from "./slopes.ts";
import type { Wedges } from "./wedges.ts";

/** Restores the values of wedges, of one chunk after another. */
export class ValueDecoder {
    private readonly known: Known;
    private readonly front: Front;
    private readonly family: Family;
    private readonly star = new SortedStar();
    private readonly slopes = new Slopes();
    /** Shares on the ways to the first and to the second child, their difference, and aside. */
    private readonly toFirst = newShares();
    private readonly toSecond = newShares();
    private readonly apart = newShares();
    private readonly aside = newShares();
    private readonly changes = new Int32Array(64);
    private readonly asides = new Int32Array(64);
    private readonly place = new Int32Array(2);
    private readonly other = new Int32Array(2);

    constructor(
        private readonly model: Model,
        private readonly wedges: Wedges,
    ) {
        this.known = new Known(model, wedges);
        this.front = new Front(model);
        this.family = new Family(model, wedges);
        this.known.grow();
        for (let wedge = 0; wedge < wedges.count; wedge++) this.setDirections(wedge);
    }

    private setDirections(wedge: number): void {
        const { rows, columns } = this.wedges;
        for (const layer of this.known.layers) {
            const at = wedge * columns + layer.layer.start;
            this.known.setCode(wedge, layer, rows[at], rows[at + 1]);
        }
    }

    /** Restores the values of the updates from `start` on, whose places in the forest are known. */
    restore(start: number): void {
        const { model, front, known } = this;
        known.grow();
        front.grow();
        const first: number[] = [];
        for (const update of byLevel(model, start)) {
            const node = model.parents[update];
            first.length = 0;
            // What depends on a chunk that is missing has no values.
            if (node === NONE || front.state(node) !== State.Active) continue;
            if (!front.maySplit(update, first)) continue;
            this.sortStar();
            front.apply(update);
            this.family.gather(update);
            this.link();
            this.solve();
        }
        front.triangles.begin();
    }

    /** Sorts the faces around the vertex that is split, so that sums do not depend on the cut. */
    private sortStar(): void {
        const { star } = this;
        const { corners, a, b, count } = this.front.star;
        const wedges = this.front.triangles.wedges as Uint32Array;
        const { rank } = this.model;
        star.count = 0;
        for (let i = 0; i < count; i++) {
            const corner = corners[i];
            star.insert(
                rank[a[i]],
                rank[b[i]],
                wedges[corner],
                wedges[after(corner)],
                wedges[before(corner)],
            );
        }
    }

    /** Notes how the wedges of an update are related. */
    private link(): void {
        const { family, known } = this;
        for (let i = 0; i < family.count; i++) {
            const own = family.start + i;
            const sibling = family.siblings[i];
            known.parents[own] = family.parents[i];
            if (sibling === NONE) continue;
            known.siblings[own] = sibling;
            known.siblings[sibling] = own;
        }
    }

    private solve(): void {
        const { family } = this;
        // Other wedges may be predicted from those of pairs.
        family.inCodingOrder((wedge, role) => {
            const i = wedge - family.start;
            if (role === DIFFERENCE) this.solvePair(family.partners[i], family.parents[i], wedge);
        });
        for (let i = 0; i < family.count; i++) if (family.partners[i] === NONE) this.solveSingle(i);
    }

    /** Writes the way from the second wedge to the first, times a factor, onto `to`. */
    private way(to: number, from: number): [number, number, number] {
        const { positions } = this.model;
        const { nodeOf } = this.known;
        const [a, b] = [3 * nodeOf[to], 3 * nodeOf[from]];
        return [
            positions[a] - positions[b],
            positions[a + 1] - positions[b + 1],
            positions[a + 2] - positions[b + 2],
        ];
    }

    /**
     * Computes the values of a pair: those of the first child's wedge `a`, the parent's `p`, the
     * second's `b`.
     */
    private solvePair(a: number, p: number, b: number): void {
        const { known, slopes, toFirst, toSecond, apart, aside } = this;
        const [wx, wy, wz] = this.way(b, a);
        const [px, py, pz] = this.way(p, a);
        const squared = wx * wx + wy * wy + wz * wz;
        const along = wx * px + wy * py + wz * pz;
        const part = squared > 0 ? Math.min(Math.max(along / squared, 0), 1) : 0.5;
        known.fit(p, NONE, this.star, slopes);
        slopes.shares(...this.way(a, p), toFirst);
        slopes.shares(...this.way(b, p), toSecond);
        slopes.sharesAround(px - part * wx, py - part * wy, pz - part * wz, aside);
        for (let i = 0; i < slopes.count; i++) apart[i] = toSecond[i] - toFirst[i];
        for (const layer of known.layers) {
            if (layer.directions) this.solveDirections(layer, a, p, b, part);
            this.solveNumbers(layer, a, p, b, part);
        }
    }

    private solveDirections(
        columns: LayerColumns,
        a: number,
        p: number,
        b: number,
        part: number,
    ): void {
        const { known, slopes, place, other } = this;
        const { layer, directions, leeways } = columns;
        const { rows, columns: width } = this.wedges;
        if (!directions) return;
        const row = (wedge: number) => wedge * width + layer.start;
        const { axis, slope } = known.line(p, columns);
        const decode = (at: number): [number, number] => {
            const [along, off] = [rows[at], rows[at + 1]];
            const across = (off + toInt32(slope * along)) | 0;
            return axis === 0 ? [along, across] : [across, along];
        };
        const off = decode(row(a));
        const residual = decode(row(b));
        known.directionNear(a, p, columns, slopes, this.toFirst, place);
        known.directionNear(b, p, columns, slopes, this.toSecond, other);
        const first = [0, 0];
        const second = [0, 0];
        for (let k = 0; k < 2; k++) {
            const difference = (((other[k] - place[k]) | 0) + residual[k]) | 0;
            const middle = toInt32(part * difference);
            const step = stepOf(leeways[k], difference);
            first[k] = (((rows[row(p) + k] - Math.imul(off[k], step)) | 0) - middle) | 0;
            second[k] = (first[k] + difference) | 0;
        }
        directions.plane.code(first[0], first[1], first);
        directions.plane.code(second[0], second[1], second);
        known.setCode(a, columns, first[0], first[1]);
        known.setCode(b, columns, second[0], second[1]);
    }

    private solveNumbers(
        columns: LayerColumns,
        a: number,
        p: number,
        b: number,
        part: number,
    ): void {
        const { known, slopes, changes, asides } = this;
        const { layer, directions, leeways } = columns;
        const { rows, columns: width } = this.wedges;
        const start = directions ? 2 : 0;
        if (start === layer.columns) return;
        known.changes(columns, slopes, this.apart, changes);
        known.changes(columns, slopes, this.aside, asides);
        for (let k = start; k < layer.columns; k++) {
            const at = layer.start + k;
            const difference = (changes[k] + rows[b * width + at]) | 0;
            const off = Math.imul(rows[a * width + at], stepOf(leeways[k], difference));
            const between = (toInt32(part * difference) + asides[k]) | 0;
            const first = (((rows[p * width + at] - off) | 0) - between) | 0;
            rows[a * width + at] = first;
            rows[b * width + at] = (first + difference) | 0;
        }
    }

    /** Computes the values of a wedge of no pair. */
    private solveSingle(i: number): void {
        const { known, slopes, family, toFirst, changes, place } = this;
        const wedge = family.start + i;
        const parent = family.parents[i];
        const base = family.siblings[i] === NONE ? parent : family.siblings[i];
        if (base === NONE) return;
        known.fit(parent, family.siblings[i], this.star, slopes);
        slopes.shares(...this.way(wedge, base), toFirst);
        const { rows, columns: width } = this.wedges;
        for (const columns of known.layers) {
            const { layer, directions } = columns;
            const row = wedge * width + layer.start;
            if (directions) {
                known.directionNear(wedge, base, columns, slopes, toFirst, place);
                directions.plane.code(
                    (place[0] + rows[row]) | 0,
                    (place[1] + rows[row + 1]) | 0,
                    place,
                );
                known.setCode(wedge, columns, place[0], place[1]);
            }
            known.changes(columns, slopes, toFirst, changes);
            for (let k = directions ? 2 : 0; k < layer.columns; k++) {
                const predicted = (rows[base * width + layer.start + k] + changes[k]) | 0;
                rows[row + k] = (rows[row + k] + predicted) | 0;
            }
        }
    }
}

/** Returns the steps in which a parent is off the place between its children. */
function stepOf(leeway: number, difference: number): number {
    return 2 * Math.min(1 + Math.floor(Math.abs(difference) / 4), leeway) + 1;
}

/** Returns the updates from one on, by falling level. */
function byLevel({ levels, updates }: Model, start: number): Uint32Array {
    const counts = new Uint32Array(0x10001);
    for (let update = start; update < updates; update++) counts[0x10000 - levels[update]]++;
    for (let i = 0, sum = 0; i < counts.length; i++) {
        const count = counts[i];
        counts[i] = sum;
        sum += count;
    }
    const sorted = new Uint32Array(updates - start);
    for (let update = start; update < updates; update++)
        sorted[counts[0x10000 - levels[update]]++] = update;
    return sorted;
}
