/** The focus of a query in units, with its test against balls. */

import { toUnits } from "../frame.ts";
import type { Frame } from "../frame.ts";
import type { Camera, Focus } from "./query.ts";

type Point = [number, number, number];

/** A part of space. */
export interface Region {
    /** Returns false only if no point of the region is in a ball. */
    meetsBall(x: number, y: number, z: number, radius: number): boolean;
    /** Returns false only if no point of the region is in a box. */
    meetsBox(min: Point, max: Point): boolean;
    /** Numbers that tell the region from others. */
    key: number[];
}

/** Converts a focus to units. */
export function regionOf(focus: Focus, frame: Frame): Region {
    const point = (p: readonly [number, number, number]) => toUnits(frame, p);
    if (focus === null) return { meetsBall: () => true, meetsBox: () => true, key: [0] };
    if ("point" in focus) return sphere(point(focus.point), 0);
    if ("segment" in focus) return segment(point(focus.segment[0]), point(focus.segment[1]));
    if ("box" in focus) return box(point(focus.box[0]), point(focus.box[1]));
    if ("sphere" in focus)
        return sphere(point(focus.sphere.center), focus.sphere.radius * (1 / frame.unit));
    return frustum(focus.frustum, point(focus.frustum.eye));
}

function sphere([x, y, z]: Point, reach: number): Region {
    return {
        meetsBall: (cx, cy, cz, radius) =>
            square(cx - x, cy - y, cz - z) <= (reach + radius) * (reach + radius),
        meetsBox: (min, max) => squareToBox([x, y, z], min, max) <= reach * reach,
        key: [1, x, y, z, reach],
    };
}

function box(low: Point, high: Point): Region {
    return {
        meetsBall: (x, y, z, radius) => squareToBox([x, y, z], low, high) <= radius * radius,
        meetsBox: (min, max) => low.every((x, k) => x <= max[k] && high[k] >= min[k]),
        key: [2, ...low, ...high],
    };
}

function segment(a: Point, b: Point): Region {
    const [dx, dy, dz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    const squared = square(dx, dy, dz);
    const meetsBall = (x: number, y: number, z: number, radius: number) => {
        const along = (x - a[0]) * dx + (y - a[1]) * dy + (z - a[2]) * dz;
        const t = squared > 0 ? clamp(along / squared, 0, 1) : 0;
        return (
            square(x - (a[0] + t * dx), y - (a[1] + t * dy), z - (a[2] + t * dz)) <= radius * radius
        );
    };
    return { meetsBall, meetsBox: () => true, key: [3, ...a, ...b] };
}

/** The near plane through the eye, and the four sides. */
function frustum(camera: Camera, eye: Point): Region {
    const [forward, right, up] = axesOf(camera);
    const [width, height] = camera.viewport;
    const high = Math.tan(0.5 * camera.fov);
    const wide = (high * width) / height;
    const plane = (part: number, axis: Point, sign: number): [number, number, number, number] => {
        const normal = unit([0, 1, 2].map((k) => part * forward[k] + sign * axis[k]) as Point);
        return [...normal, normal[0] * eye[0] + normal[1] * eye[1] + normal[2] * eye[2]];
    };
    const planes = [
        plane(1, right, 0),
        plane(wide, right, 1),
        plane(wide, right, -1),
        plane(high, up, 1),
        plane(high, up, -1),
    ];
    const meetsBall = (x: number, y: number, z: number, radius: number) =>
        planes.every(([nx, ny, nz, least]) => nx * x + ny * y + nz * z + radius >= least);
    return { meetsBall, meetsBox: () => true, key: [4, ...planes.flat()] };
}

/** Returns the directions forward, right and up. */
function axesOf({ eye, look, up }: Camera): [Point, Point, Point] {
    const forward = unit([look[0] - eye[0], look[1] - eye[1], look[2] - eye[2]]);
    const right = unit(cross(forward, [...up]));
    return [forward, right, cross(right, forward)];
}

function cross(a: Point, b: Point): Point {
    return [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]];
}

function unit([x, y, z]: Point): Point {
    const scale = 1 / Math.sqrt(square(x, y, z));
    return scale > 0 && scale < Infinity ? [x * scale, y * scale, z * scale] : [0, 0, 0];
}

function square(x: number, y: number, z: number): number {
    return x * x + y * y + z * z;
}

/** Returns the square of the distance of a point from a box. */
export function squareToBox([x, y, z]: Point, min: Point, max: Point): number {
    return square(
        x - clamp(x, min[0], max[0]),
        y - clamp(y, min[1], max[1]),
        z - clamp(z, min[2], max[2]),
    );
}

function clamp(x: number, min: number, max: number): number {
    return Math.min(Math.max(x, min), max);
}
