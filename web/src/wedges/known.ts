/** Values of wedges that are known already, and predictions from those around and above. */

import { toInt32 } from "../file/tangent_plane.ts";
import { NONE, grown } from "../model.ts";
import type { Model } from "../model.ts";
import type { Layer } from "./layer.ts";
import { OctahedralPlane, project, unfold } from "./octahedral.ts";
import type { Slopes } from "./slopes.ts";
import type { Wedges } from "./wedges.ts";

/** Number of ancestors, weight of the first, and of each relative to the one before. */
const ANCESTORS = 6;
const ABOVE = 1 / 32;
const FADE = 0.5;
/** Weights of steps between wedges around, and to the first child. */
const ALONG = 0.25;
const OWN = 8;
const MOST_AROUND = 64;

/**
 * Faces around a vertex that is split, sorted by the ranks of their nodes and then by wedges: the
 * wedge
 * of the vertex, and those at the nodes after and before it.
 */
export class SortedStar {
    count = 0;
    readonly own: number[] = [];
    readonly after: number[] = [];
    readonly before: number[] = [];
    private readonly ranksAfter: number[] = [];
    private readonly ranksBefore: number[] = [];

    /** Inserts a face where it belongs. */
    insert(a: number, b: number, own: number, after: number, before: number): void {
        let at = this.count++;
        for (; at > 0 && this.isAbove(at - 1, a, b, own, after, before); at--)
            this.move(at - 1, at);
        this.ranksAfter[at] = a;
        this.ranksBefore[at] = b;
        this.own[at] = own;
        this.after[at] = after;
        this.before[at] = before;
    }

    private isAbove(i: number, a: number, b: number, own: number, after: number, before: number) {
        if (this.ranksAfter[i] !== a) return this.ranksAfter[i] > a;
        if (this.ranksBefore[i] !== b) return this.ranksBefore[i] > b;
        if (this.after[i] !== after) return this.after[i] > after;
        if (this.before[i] !== before) return this.before[i] > before;
        return this.own[i] > own;
    }

    private move(from: number, to: number): void {
        this.ranksAfter[to] = this.ranksAfter[from];
        this.ranksBefore[to] = this.ranksBefore[from];
        this.own[to] = this.own[from];
        this.after[to] = this.after[from];
        this.before[to] = this.before[from];
    }
}

/** A layer as it is predicted. */
export interface LayerColumns {
    layer: Layer;
    /** The square of codes, and the number among the layers of directions; null for others. */
    directions: { plane: OctahedralPlane; number: number } | null;
    leeways: number[];
}

/** Values and relations of wedges, as far as they are known. */
export class Known {
    readonly layers: LayerColumns[];
    /** Wedge at the node above, and wedge of the other child with the same parent; or `NONE`. */
    parents = new Uint32Array(0);
    siblings = new Uint32Array(0);
    nodeOf = new Uint32Array(0);
    private directions = new Float64Array(0);
    private readonly directionLayers: number;
    /** Number of the normals among the layers of directions, or −1. */
    readonly normals: number;
    private readonly sums = new Float64Array(64);

    constructor(
        readonly model: Model,
        readonly wedges: Wedges,
    ) {
        let number = 0;
        const columnsOf = (layer: Layer): LayerColumns => {
            const bits = layer.directionBits;
            const directions =
                bits === null
                    ? null
                    : { plane: new OctahedralPlane(2 ** bits - 1), number: number++ };
            const leeways = Array.from({ length: layer.columns }, (_, column) =>
                layer.leeway(column),
            );
            return { layer, directions, leeways };
        };
        const all = wedges.layers.map(columnsOf);
        const isTangent = ({ layer }: LayerColumns) => layer.kind === "tangent";
        this.layers = [...all.filter((layer) => !isTangent(layer)), ...all.filter(isTangent)];
        this.normals =
            this.layers.find(({ layer }) => layer.kind === "normal")?.directions?.number ?? -1;
        this.directionLayers = number;
    }

    /** Takes in wedges that have been read since. */
    grow(): void {
        const { wedges, model } = this;
        const before = this.nodeOf.length;
        this.parents = grown(this.parents, wedges.count, NONE);
        this.siblings = grown(this.siblings, wedges.count, NONE);
        this.nodeOf = grown(this.nodeOf, wedges.count);
        this.directions = grown(this.directions, 3 * wedges.count * this.directionLayers);
        if (before === this.nodeOf.length && before === 0) return;
        for (let node = 0; node < model.nodes; node++) {
            this.nodeOf.fill(node, wedges.first[node], wedges.first[node + 1]);
        }
    }

    /** Replaces the code of a direction. */
    setCode(wedge: number, { layer, directions }: LayerColumns, x: number, y: number): void {
        if (!directions) return;
        const { rows, columns } = this.wedges;
        const at = wedge * columns + layer.start;
        rows[at] = x;
        rows[at + 1] = y;
        const { last } = directions.plane;
        // Only damaged files are out of range.
        const clamp = (x: number) => Math.min(Math.max(x, 0), last);
        unfold(
            clamp(x),
            clamp(y),
            last,
            this.directions,
            this.directionAt(wedge, directions.number),
        );
    }

    private directionAt(wedge: number, number: number): number {
        return 3 * (wedge * this.directionLayers + number);
    }

    /**
     * Fits slopes to the steps around a wedge that is split, and above it; with a child, to that,
     * too.
     */
    fit(wedge: number, child: number, star: SortedStar, slopes: Slopes): void {
        slopes.clear();
        const own = this.add(wedge, slopes);
        if (child !== NONE) slopes.addStep(this.add(child, slopes), own, OWN, false);
        this.addAround(wedge, star, slopes);
        this.addAbove(wedge, slopes);
        slopes.fit();
    }

    private add(wedge: number, slopes: Slopes): number {
        return slopes.addWedge(wedge, this.model.positions, this.nodeOf[wedge]);
    }

    private addAround(wedge: number, star: SortedStar, slopes: Slopes): void {
        const { own, after, before } = star;
        const count = star.count <= MOST_AROUND ? star.count : 0;
        const first = slopes.count;
        for (let i = 0; i < count; i++) if (own[i] === wedge) this.add(after[i], slopes);
        for (let i = 0, a = first; i < count; i++) {
            if (own[i] !== wedge) continue;
            const followed = this.followed(wedge, before[i], star, count);
            const b = followed < 0 ? this.add(before[i], slopes) : first + followed;
            slopes.addStep(b, a, ALONG, true);
            slopes.addStep(a, 0, 1, false);
            if (followed < 0) slopes.addStep(b, 0, 1, false);
            a++;
        }
    }

    /** Returns the place of a wedge among those after the split one, or −1. */
    private followed(
        wedge: number,
        other: number,
        { own, after }: SortedStar,
        count: number,
    ): number {
        for (let i = 0, place = 0; i < count; i++) {
            if (own[i] !== wedge) continue;
            if (after[i] === other) return place;
            place++;
        }
        return -1;
    }

    private addAbove(wedge: number, slopes: Slopes): void {
        const { parents, siblings } = this;
        let weight = ABOVE;
        for (let i = 0, at = wedge; i < ANCESTORS; i++) {
            if (siblings[at] !== NONE) {
                const end = i === 0 ? 0 : this.add(at, slopes);
                slopes.addStep(end, this.add(siblings[at], slopes), weight, false);
                weight *= FADE;
            }
            if (parents[at] === NONE) break;
            at = parents[at];
        }
    }

    /**
     * Writes the changes of the columns of a layer that are no direction, given the shares of known
     * wedges.
     */
    changes(
        { layer, directions }: LayerColumns,
        slopes: Slopes,
        shares: Float64Array,
        to: Int32Array,
    ): void {
        // The handedness of tangents has no slope.
        if (directions) return void to.fill(0, 0, layer.columns);
        const { sums } = this;
        const { rows, columns } = this.wedges;
        sums.fill(0, 0, layer.columns);
        for (let i = 0; i < slopes.count; i++) {
            const at = slopes.wedges[i] * columns + layer.start;
            for (let k = 0; k < layer.columns; k++) sums[k] += shares[i] * rows[at + k];
        }
        for (let k = 0; k < layer.columns; k++) to[k] = toInt32(sums[k]);
    }

    /**
     * Writes the predicted place of the direction of a wedge, near to that of another, given the
     * shares
     * of known wedges on the way there.
     */
    directionNear(
        wedge: number,
        from: number,
        columns: LayerColumns,
        slopes: Slopes,
        shares: Float64Array,
        to: Int32Array,
    ): void {
        const { layer, directions } = columns;
        if (!directions) return;
        const all = this.directions;
        const start = this.directionAt(from, directions.number);
        let x = all[start];
        let y = all[start + 1];
        let z = all[start + 2];
        for (let i = 0; i < slopes.count; i++) {
            const at = this.directionAt(slopes.wedges[i], directions.number);
            const share = shares[i];
            x += share * all[at];
            y += share * all[at + 1];
            z += share * all[at + 2];
        }
        if (layer.kind === "tangent" && this.normals >= 0) {
            const at = this.directionAt(wedge, this.normals);
            const nx = all[at];
            const ny = all[at + 1];
            const nz = all[at + 2];
            const along = x * nx + y * ny + z * nz;
            x -= along * nx;
            y -= along * ny;
            z -= along * nz;
        }
        if (!(x * x + y * y + z * z > 1e-6))
            [x, y, z] = [all[start], all[start + 1], all[start + 2]];
        project(x, y, z, directions.plane.last, this.sums);
        const { rows, columns: width } = this.wedges;
        const at = from * width + layer.start;
        directions.plane.near(
            toInt32(this.sums[0]),
            toInt32(this.sums[1]),
            rows[at],
            rows[at + 1],
            to,
        );
    }

    /** Returns the line along which tangents turn about the normal: its axis, and its slope. */
    line(wedge: number, { layer, directions }: LayerColumns): Line {
        if (!directions || layer.kind !== "tangent" || this.normals < 0) return NO_LINE;
        const all = this.directions;
        const t = this.directionAt(wedge, directions.number);
        const n = this.directionAt(wedge, this.normals);
        const [x, y, z] = [all[t], all[t + 1], all[t + 2]];
        const [nx, ny, nz] = [all[n], all[n + 1], all[n + 2]];
        const { last } = directions.plane;
        const [from, to] = [
            [0, 0],
            [0, 0],
        ];
        const ax = x + STEP * (ny * z - nz * y);
        const ay = y + STEP * (nz * x - nx * z);
        const az = z + STEP * (nx * y - ny * x);
        project(ax, ay, az, last, to);
        project(x, y, z, last, from);
        const way = [to[0] - from[0], to[1] - from[1]];
        const axis = Math.abs(way[1]) > Math.abs(way[0]) ? 1 : 0;
        const slope = way[1 - axis] / way[axis];
        return { axis, slope: Number.isFinite(slope) ? slope : 0 };
    }
}

/** A line in the plane of codes. */
export interface Line {
    /** The coordinate that grows faster. */
    axis: number;
    /** Slope of the other one. */
    slope: number;
}

const NO_LINE: Line = { axis: 0, slope: 0 };
const STEP = 1 / 64;
