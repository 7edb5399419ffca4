/** Directions, decoded as residuals of what the surface lets expect. */

import { dot } from "../block_shape.ts";
import type { Triple } from "../block_shape.ts";
import { next, previous } from "../block_shape.ts";
import { project, unfold } from "../../wedges/octahedral.ts";
import { Energy } from "./coder.ts";
import type { LayerJob } from "./job.ts";

/** What the surface says of a direction. */
export interface Guess {
    /** Of length 1, or 0 if the surface is not asked; null if it says nothing. */
    direction: Triple | null;
    bend: number;
    isOpen: boolean;
}

const Z: Triple = [0, 0, 1];

/** Decodes the directions of all entries; `trust` is the part of neighbours' differences taken. */
export function decodeDirections(
    job: LayerJob,
    guessOf: (entry: number) => Guess,
    trust: number,
): void {
    const { entries, layer, coder, numbers } = job;
    const stride = layer.most.length;
    const greatest = layer.most[0];
    const energy = new Energy(entries.length);
    const differences = new Float64Array(3 * entries.length);
    const place = [0, 0];
    let last: number[] = [0, 0, 1];
    for (let entry = 0; entry < entries.length; entry++) {
        const guess = guessOf(entry);
        const mean = [0, 0, 0];
        let known = 0;
        energy.clear();
        for (const corner of entries.around(entry)) {
            for (const at of [next(corner), previous(corner)]) {
                const other = entries.before(at, entry);
                if (other < 0) continue;
                for (let k = 0; k < 3; k++) mean[k] += differences[3 * other + k];
                known++;
                energy.see(other);
            }
        }
        const direction = guess.direction ?? last;
        const part = trust / Math.max(known, 1);
        let whole: Triple = mean.map((x, k) => direction[k] + x * part);
        if (!(dot(whole, whole) > 0)) whole = direction.every((x) => x === 0) ? last : Z;
        project(whole[0], whole[1], whole[2], greatest, place);
        const surroundings = guess.bend * 2 + Number(guess.isOpen);
        let magnitude = energy.around();
        for (let k = 0; k < 2; k++) {
            const context = (surroundings * 8 + Energy.level(magnitude)) * 2 + k;
            const residual = coder.residual(layer.residuals + context);
            place[k] = (Math.floor(place[k] + 0.5) + residual) | 0;
            const size = Math.abs(residual);
            energy.add(entry, size);
            magnitude = 0.5 * magnitude + size;
        }
        foldIn(place, greatest);
        numbers[stride * entry] = place[0];
        numbers[stride * entry + 1] = place[1];
        last = [0, 0, 0];
        unfold(place[0], place[1], greatest, last, 0);
        for (let k = 0; k < 3; k++) differences[3 * entry + k] = last[k] - direction[k];
    }
}

/** Makes a place that may be beyond the sides of the square one within. */
function foldIn(place: number[], last: number): void {
    const clamp = (x: number) => Math.min(Math.max(x, 0), last);
    let [x, y] = place;
    if (x < 0) [x, y] = [-x, last - clamp(y)];
    else if (x > last) [x, y] = [2 * last - x, last - clamp(y)];
    else if (y < 0) [x, y] = [last - clamp(x), -y];
    else if (y > last) [x, y] = [last - clamp(x), 2 * last - y];
    place[0] = clamp(x);
    place[1] = clamp(y);
}
