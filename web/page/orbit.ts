/** A camera that goes around a point, and never rolls. */

import type { Vector } from "../src/frame.ts";
import type { Camera } from "../src/cut/query.ts";
import { add, cross, dot, unit } from "./vector.ts";

/** Vertical field of view, in radians. */
const FOV = Math.PI / 4;
const STEEPEST = 0.499 * Math.PI;

/** Axis of a model that points up. */
export type Up = "y" | "z";

/** What is around a model. */
export interface Ball {
    center: Vector;
    /** Diameter, in model units. */
    diagonal: number;
}

/** Camera around a target, in model units. */
export class Orbit {
    up: Up = "y";
    private yaw = 0;
    private pitch = 0;
    private distance = 1;
    private target: Vector = [0, 0, 0];
    private ball: Ball = { center: [0, 0, 0], diagonal: 1 };

    /** Shows all of a model, from the front and slightly from above. */
    frame(ball: Ball, aspect: number): void {
        const diagonal = ball.diagonal > 0 ? ball.diagonal : 1;
        this.ball = { center: ball.center, diagonal };
        [this.yaw, this.pitch, this.target] = [0.5, 0.3, ball.center];
        const half = Math.atan(Math.tan(FOV / 2) * Math.min(1, aspect));
        this.distance = (0.5 * diagonal) / Math.sin(half);
    }

    /** Turns by angles, in radians. */
    turn(yaw: number, pitch: number): void {
        this.yaw += yaw;
        this.pitch = Math.min(STEEPEST, Math.max(-STEEPEST, this.pitch + pitch));
    }

    /** Changes the distance by a factor. */
    zoom(factor: number): void {
        const { diagonal } = this.ball;
        this.distance = Math.min(50 * diagonal, Math.max(1e-4 * diagonal, this.distance * factor));
    }

    /** Moves along the picture, by parts of its height. */
    pan(right: number, up: number): void {
        const height = 2 * Math.tan(FOV / 2) * this.distance;
        const [x, y] = this.axes();
        this.target = add(add(this.target, x, right * height), y, up * height);
    }

    /** Returns the axes of the picture: to the right, up, and towards the viewer. */
    private axes(): [Vector, Vector, Vector] {
        const [yaw, pitch] = [this.yaw, this.pitch];
        const back = this.upright([
            Math.cos(pitch) * Math.sin(yaw),
            Math.sin(pitch),
            Math.cos(pitch) * Math.cos(yaw),
        ]);
        const right = unit(cross(this.upward, back));
        return [right, cross(back, right), back];
    }

    /** The direction that points up in the model. */
    get upward(): Vector {
        return this.upright([0, 1, 0]);
    }

    private upright([x, y, z]: Vector): Vector {
        return this.up === "y" ? [x, y, z] : [x, -z, y];
    }

    /** Returns the camera, of a picture with this number of pixels. */
    camera(width: number, height: number): Camera {
        const [, up, back] = this.axes();
        const eye = add(this.target, back, this.distance);
        return { eye, look: this.target, up, fov: FOV, viewport: [width, height] };
    }

    /**
     * Returns the matrix, by columns, that takes points from the middle of the model to clip space.
     */
    matrix(aspect: number): Float32Array {
        const [x, y, back] = this.axes();
        const eye = add(add(this.target, back, this.distance), this.ball.center, -1);
        const radius = 0.75 * this.ball.diagonal;
        const away = Math.hypot(...eye);
        const far = (away + radius) * 1.01;
        const near = Math.max(away - radius, 1e-4 * radius, 5e-4 * far);
        const scale = 1 / Math.tan(FOV / 2);
        const depth: [number, number] = [
            (far + near) / (near - far),
            (2 * far * near) / (near - far),
        ];
        const rows: [Vector, number][] = [
            [x, scale / aspect],
            [y, scale],
        ];
        const matrix = new Float32Array(16);
        rows.forEach(([axis, by], row) => {
            for (let k = 0; k < 3; k++) matrix[4 * k + row] = by * axis[k];
            matrix[12 + row] = -by * dot(axis, eye);
        });
        for (let k = 0; k < 3; k++) {
            matrix[4 * k + 2] = depth[0] * back[k];
            matrix[4 * k + 3] = -back[k];
        }
        matrix[14] = -depth[0] * dot(back, eye) + depth[1];
        matrix[15] = dot(back, eye);
        return matrix;
    }
}
