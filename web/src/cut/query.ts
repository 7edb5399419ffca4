/** Queries: where a mesh must be fine, and how fine. */

import type { Vector } from "../frame.ts";

/** A perspective camera, in model units. */
export interface Camera {
    eye: Vector;
    /** Point that the camera looks at. */
    look: Vector;
    up: Vector;
    /** Vertical field of view, in radians. */
    fov: number;
    /** Width and height of the picture, in pixels. */
    viewport: readonly [number, number];
}

/** Region in which a tolerance must hold, in model units; null is everywhere. */
export type Focus =
    | null
    | { point: Vector }
    | { segment: readonly [Vector, Vector] }
    /** Corners of least and of greatest coordinates. */
    | { box: readonly [Vector, Vector] }
    | { sphere: { center: Vector; radius: number } }
    /** What a camera sees, without a far plane. */
    | { frustum: Camera };

/** A length in model units, or a number of pixels as seen by a camera. */
export type Tolerance = number | { pixels: number; camera: Camera };

/** A request for a mesh that is off by no more than a tolerance within a focus. */
export interface Query {
    focus: Focus;
    tolerance: Tolerance;
}

/**
 * Returns the size of a pixel in the middle of the picture, as a part of the distance from the
 * camera.
 */
export function pixelOf({ fov, viewport }: Camera): number {
    return (2 * Math.tan(0.5 * fov)) / viewport[1];
}

/** Throws a `RangeError` unless a query is valid. */
export function checkQuery({ focus, tolerance }: Query): void {
    if (typeof tolerance === "number") checkLength("the tolerance", tolerance);
    else {
        checkLength("the tolerance", tolerance.pixels);
        checkCamera(tolerance.camera);
    }
    if (focus === null) return;
    if ("point" in focus) checkFinite("the point", focus.point);
    else if ("segment" in focus) checkFinite("the segment", focus.segment.flat());
    else if ("frustum" in focus) checkCamera(focus.frustum);
    else if ("sphere" in focus) {
        checkFinite("the sphere", focus.sphere.center);
        checkLength("the radius", focus.sphere.radius);
    } else {
        const [low, high] = focus.box;
        checkFinite("the box", [...low, ...high]);
        if (low.some((x, k) => x > high[k])) throw new RangeError("the box is inside out");
    }
}

function checkCamera({ eye, look, up, fov, viewport }: Camera): void {
    checkFinite("the camera", [...eye, ...look, ...up]);
    const sees = fov > 0 && fov < Math.PI && viewport.every((side) => side > 0);
    if (!sees)
        throw new RangeError("the camera sees nothing: its field of view or its picture is empty");
}

function checkFinite(what: string, numbers: readonly number[]): void {
    if (!numbers.every(Number.isFinite))
        throw new RangeError(`a coordinate of ${what} is not finite`);
}

function checkLength(what: string, length: number): void {
    if (!(length >= 0)) throw new RangeError(`${what} must be at least 0, not ${length}`);
}
