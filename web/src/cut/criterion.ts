/**
 * The criterion of a query: whether it requires an update, judged by its ball and error in units.
 */

import type { ChunkEntry } from "../file/header.ts";
import { toUnits } from "../frame.ts";
import type { Frame } from "../frame.ts";
import { checkQuery, pixelOf } from "./query.ts";
import type { Query } from "./query.ts";
import { regionOf, squareToBox } from "./region.ts";
import type { Region } from "./region.ts";

/**
 * A query in units. It requires every ball that holds one that it requires and has no smaller
 * error.
 */
export class Criterion {
    private readonly region: Region;
    /** True if the tolerance grows with the distance from the eye: `slope` is its part of that. */
    private readonly isPerspective: boolean;
    private readonly isEverywhere: boolean;
    readonly slope: number;
    private readonly most: number;
    readonly x: number;
    readonly y: number;
    readonly z: number;

    /** @throws RangeError if the query is invalid */
    constructor(query: Query, frame: Frame, scale = 1) {
        checkQuery(query);
        const { focus, tolerance } = query;
        this.region = regionOf(focus, frame);
        this.isEverywhere = focus === null;
        this.isPerspective = typeof tolerance !== "number";
        if (typeof tolerance === "number") {
            this.most = tolerance * (1 / frame.unit) * scale;
            this.slope = 0;
            this.x = this.y = this.z = 0;
        } else {
            this.most = 0;
            this.slope = tolerance.pixels * pixelOf(tolerance.camera) * scale;
            [this.x, this.y, this.z] = toUnits(frame, tolerance.camera.eye);
        }
    }

    /** Returns true if the update of a ball is required. */
    requires(x: number, y: number, z: number, radius: number, error: number): boolean {
        return (
            this.exceeds(x, y, z, radius, error) &&
            (this.isEverywhere || this.region.meetsBall(x, y, z, radius))
        );
    }

    private exceeds(x: number, y: number, z: number, radius: number, error: number): boolean {
        if (!this.isPerspective) return error > this.most || this.most === 0;
        const { slope } = this;
        if (slope === 0) return true;
        const reach = error + slope * radius;
        const [dx, dy, dz] = [this.x - x, this.y - y, this.z - z];
        return error > 0 && slope * slope * (dx * dx + dy * dy + dz * dz) < reach * reach;
    }

    /** Returns false only if no update of a chunk is required. */
    mayRequire({ min, max, error }: ChunkEntry): boolean {
        const middle = (k: number) => 0.5 * (min[k] + max[k]);
        const [x, y, z] = [max[0] - min[0], max[1] - min[1], max[2] - min[2]];
        const radius = 0.5 * Math.sqrt(x * x + y * y + z * z);
        return (
            this.exceedsIn(min, max, error) &&
            this.region.meetsBall(middle(0), middle(1), middle(2), radius) &&
            this.region.meetsBox(min, max)
        );
    }

    private exceedsIn(
        min: [number, number, number],
        max: [number, number, number],
        error: number,
    ): boolean {
        const { slope, most } = this;
        if (!this.isPerspective) return error > most || most === 0;
        return (
            slope === 0 ||
            slope * slope * squareToBox([this.x, this.y, this.z], min, max) < error * error
        );
    }

    /** True if nothing but the place of the eye, and the slope, decide. */
    get hasViewpoint(): boolean {
        return this.isEverywhere && this.isPerspective;
    }

    /**
     * Returns the distance below which the viewpoint requires an update, or NaN if that never
     * changes.
     */
    reach(radius: number, error: number): number {
        if (!this.hasViewpoint) return NaN;
        const reach = radius + error / this.slope;
        return error > 0 && reach < Infinity ? reach : NaN;
    }

    /** Numbers that tell the query from others. */
    get key(): number[] {
        const { region, isPerspective, most, slope, x, y, z } = this;
        return [...region.key, Number(isPerspective), most, slope, x, y, z];
    }
}
