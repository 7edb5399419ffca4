/** The plane in which the vectors of an update mostly lie, predicted from the updates above it. */

import type { Model } from "../model.ts";

const LEAST_SINE = 0.3;

/** Predicts planes, one after the other. */
export class TangentPlane {
    /** Axes of the three places of an encoded vector. */
    readonly axes = new Int32Array(3);
    private readonly normal = new Float64Array(3);
    /** The second child minus the first, in the three updates above. */
    private readonly families = new Float64Array(9);

    constructor(private readonly model: Model) {}

    /** Predicts the plane at a node. */
    predict(node: number): void {
        this.gather(node);
        const [ax, ay, az, bx, by, bz, cx, cy, cz] = this.families;
        let x = ay * bz - az * by;
        let y = az * bx - ax * bz;
        let z = ax * by - ay * bx;
        const u = ay * cz - az * cy;
        const v = az * cx - ax * cz;
        const w = ax * cy - ay * cx;
        const a = Math.sqrt(ax * ax + ay * ay + az * az);
        const b = Math.sqrt(bx * bx + by * by + bz * bz);
        const c = Math.sqrt(cx * cx + cy * cy + cz * cz);
        const first = Math.sqrt(x * x + y * y + z * z);
        const second = Math.sqrt(u * u + v * v + w * w);
        if (!(first >= LEAST_SINE * a * b) && second * b > first * c) {
            x = u;
            y = v;
            z = w;
        }
        if (x === 0 && y === 0 && z === 0) z = 1;
        this.orient(x, y, z);
    }

    private gather(node: number): void {
        const { model, families } = this;
        const { positions, roots } = model;
        families.fill(0);
        for (let k = 0; k < 9 && node >= roots; k += 3) {
            const update = model.creator(node);
            const at = 3 * model.firstChild(update);
            for (let i = 0; i < 3; i++) families[k + i] = positions[at + 3 + i] - positions[at + i];
            node = model.parents[update];
        }
    }

    private orient(x: number, y: number, z: number): void {
        const { normal, axes } = this;
        let longest = 0;
        let most = Math.abs(x);
        if (Math.abs(y) > most) {
            longest = 1;
            most = Math.abs(y);
        }
        if (Math.abs(z) > most) longest = 2;
        normal[0] = x;
        normal[1] = y;
        normal[2] = z;
        axes[0] = (longest + 1) % 3;
        axes[1] = (longest + 2) % 3;
        axes[2] = longest;
    }

    /** Returns the third place of the vector in the plane that has the first two. */
    inPlane(u: number, v: number): number {
        const { normal, axes } = this;
        const across = normal[axes[0]] * u + normal[axes[1]] * v;
        return toInt32(-across / normal[axes[2]]);
    }
}

/** Rounds to the nearest integer, halves away from 0, within those of 32 bits; NaN is 0. */
export function toInt32(x: number): number {
    const whole = Math.trunc(x);
    const rounded = Math.abs(x - whole) >= 0.5 ? whole + Math.sign(x) : whole;
    if (rounded >= 0x7fffffff) return 0x7fffffff;
    return rounded > -0x80000000 ? rounded | 0 : rounded <= -0x80000000 ? -0x80000000 : 0;
}
