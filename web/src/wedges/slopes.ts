/** Slopes of values over places, fitted by least squares to the steps between known wedges. */

/** Weight of a slope of zero, against which all others are weighed. */
const RIDGE = 0.02;
const MOST_KNOWN = 160;

/** A symmetric matrix. The order of operations is part of the format. */
class Symmetric {
    xx = RIDGE;
    xy = 0;
    xz = 0;
    yy = RIDGE;
    yz = 0;
    zz = RIDGE;

    reset(): void {
        this.xx = this.yy = this.zz = RIDGE;
        this.xy = this.xz = this.yz = 0;
    }

    /** Adds a vector times its transpose. */
    addSquare(x: number, y: number, z: number, weight: number): void {
        const [wx, wy, wz] = [weight * x, weight * y, weight * z];
        this.xx += wx * x;
        this.xy += wx * y;
        this.xz += wx * z;
        this.yy += wy * y;
        this.yz += wy * z;
        this.zz += wz * z;
    }

    invert(): void {
        const { xx, xy, xz, yy, yz, zz } = this;
        const a = yy * zz - yz * yz;
        const b = xz * yz - xy * zz;
        const c = xy * yz - xz * yy;
        const scale = 1 / (xx * a + xy * b + xz * c);
        this.xx = scale * a;
        this.xy = scale * b;
        this.xz = scale * c;
        this.yy = scale * (xx * zz - xz * xz);
        this.yz = scale * (xy * xz - xx * yz);
        this.zz = scale * (xx * yy - xy * xy);
    }
}

/** Known wedges, and the steps between them. */
export class Slopes {
    /** Known wedges. */
    count = 0;
    readonly wedges = new Uint32Array(MOST_KNOWN);
    private readonly places = new Float64Array(3 * MOST_KNOWN);

    private steps = 0;
    private readonly directions = new Float64Array(6 * MOST_KNOWN * 3);
    private readonly scales = new Float64Array(6 * MOST_KNOWN);
    private readonly weights = new Float64Array(6 * MOST_KNOWN);
    private readonly isAround = new Uint8Array(6 * MOST_KNOWN);
    private readonly to = new Uint16Array(6 * MOST_KNOWN);
    private readonly from = new Uint16Array(6 * MOST_KNOWN);
    private readonly all = new Symmetric();
    private readonly around = new Symmetric();

    clear(): void {
        this.count = this.steps = 0;
        this.all.reset();
        this.around.reset();
    }

    /** Adds a known wedge at a place; returns its number among these. */
    addWedge(wedge: number, positions: Float32Array, node: number): number {
        const at = this.count++;
        this.wedges[at] = wedge;
        for (let k = 0; k < 3; k++) this.places[3 * at + k] = positions[3 * node + k];
        return at;
    }

    /** Adds a step between known wedges, unless they are at one place. */
    addStep(to: number, from: number, weight: number, isAround: boolean): void {
        const { places } = this;
        const x = places[3 * to] - places[3 * from];
        const y = places[3 * to + 1] - places[3 * from + 1];
        const z = places[3 * to + 2] - places[3 * from + 2];
        const scale = 1 / Math.sqrt(x * x + y * y + z * z);
        if (!(scale < Infinity)) return;
        const [dx, dy, dz] = [scale * x, scale * y, scale * z];
        this.all.addSquare(dx, dy, dz, weight);
        if (isAround) this.around.addSquare(dx, dy, dz, 1);
        const at = this.steps++;
        this.directions[3 * at] = dx;
        this.directions[3 * at + 1] = dy;
        this.directions[3 * at + 2] = dz;
        this.scales[at] = scale;
        this.weights[at] = weight;
        this.isAround[at] = isAround ? 1 : 0;
        this.to[at] = to;
        this.from[at] = from;
    }

    /** Fits the slopes to the steps added so far. */
    fit(): void {
        this.all.invert();
        this.around.invert();
    }

    /** Writes the share of each known wedge in the change along a way, by all steps. */
    shares(x: number, y: number, z: number, shares: Float64Array): void {
        this.share(this.all, false, x, y, z, shares);
    }

    /**
     * Writes the share of each known wedge in the change along a way, by the steps around alone.
     */
    sharesAround(x: number, y: number, z: number, shares: Float64Array): void {
        this.share(this.around, true, x, y, z, shares);
    }

    private share(
        m: Symmetric,
        onlyAround: boolean,
        x: number,
        y: number,
        z: number,
        shares: Float64Array,
    ): void {
        const { directions, scales, weights, isAround, to, from } = this;
        const ax = m.xx * x + m.xy * y + m.xz * z;
        const ay = m.xy * x + m.yy * y + m.yz * z;
        const az = m.xz * x + m.yz * y + m.zz * z;
        shares.fill(0, 0, this.count);
        for (let at = 0; at < this.steps; at++) {
            if (onlyAround && !isAround[at]) continue;
            const dot =
                directions[3 * at] * ax + directions[3 * at + 1] * ay + directions[3 * at + 2] * az;
            const part = (onlyAround ? scales[at] : weights[at] * scales[at]) * dot;
            shares[to[at]] += part;
            shares[from[at]] -= part;
        }
    }
}

/** Room for the shares of known wedges. */
export function newShares(): Float64Array {
    return new Float64Array(MOST_KNOWN);
}
