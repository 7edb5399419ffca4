/** A chunk of updates: one stream for each of their fields. */

import { must, within } from "../error.ts";
import { EXACT, FUSED, LAST_WING, NONE, NON_FAN, OPEN, RECORDED } from "../model.ts";
import type { Model } from "../model.ts";
import { readChunkWedges } from "../wedges/chunk_wedges.ts";
import { isFinitePlace } from "./base.ts";
import { readExact } from "./exact.ts";
import { check } from "./header.ts";
import type { ChunkEntry } from "./header.ts";
import { radiusCode } from "./lengths.ts";
import { readStages } from "./stages.ts";
import { Streams } from "./streams.ts";
import { TangentPlane } from "./tangent_plane.ts";

const MOST_LEVELS = 1 << 15;
const MOST_RANK = 250;
const GREATEST_ERROR = 511;

/** The streams of a chunk that each update has a number in. */
interface Fields {
    gaps: Uint32Array;
    flags: Uint8Array;
    wings: [Uint8Array, Uint8Array];
    errors: Uint32Array;
    /** Errors minus the least one. */
    errorSteps: Uint32Array;
    levels: Uint32Array;
    /** Places of d and of h in turn. */
    offsets: Int32Array[];
    radii: Int32Array;
}

/**
 * Decodes a chunk behind all others of the model. Chunks come in the order of the file; what
 * depends
 * on one that was left out is no part of any cut.
 *
 * @throws MlodError if the chunk is damaged; the model is of no use then
 */
export function readChunk(model: Model, chunk: ChunkEntry, bytes: Uint8Array): void {
    check(chunk, bytes);
    within(chunk.name, () => {
        const input = new Streams(bytes);
        const fields = readFields(input, chunk.updates);
        const start = model.updates;
        model.reserve(start + chunk.updates);
        model.begin(chunk);
        placeUpdates(model, chunk, fields);
        readNonFans(model, chunk, fields.flags, input);
        if (model.header.isLossless) readExactChildren(model, start, fields.flags, input);
        if (model.header.hasStages) model.stages.set(readStages(fields.errorSteps, input), start);
        if (model.wedges) readChunkWedges(model, start, fields.flags, sizesOf(fields), input);
        input.end();
    });
}

function readFields(input: Streams, count: number): Fields {
    const gaps = input.numbers(count);
    const flags = input.take(count);
    const wings: [Uint8Array, Uint8Array] = [input.take(count), input.take(count)];
    const [least, steps] = input.numbers(2);
    const leastLevels = input.numbers(steps);
    const errorSteps = input.numbers(count);
    const levels = input.numbers(count);
    const errors = new Uint32Array(count);
    for (let i = 0; i < count; i++) {
        must(errorSteps[i] < steps, "an error is out of range");
        errors[i] = Math.min(errorSteps[i] + least, 0xffffffff);
        levels[i] = Math.min(levels[i] + leastLevels[errorSteps[i]], 0xffffffff);
    }
    const offsets = Array.from({ length: 6 }, () => input.signed(count));
    return { gaps, flags, wings, errors, errorSteps, levels, offsets, radii: input.signed(count) };
}

/** Adds the updates to the model, and the positions of their children. */
function placeUpdates(model: Model, chunk: ChunkEntry, fields: Fields): void {
    const { gaps, flags } = fields;
    const known =
        OPEN |
        FUSED |
        NON_FAN |
        (model.header.isLossless ? EXACT[0] | EXACT[1] : 0) |
        (model.wedges ? RECORDED : 0);
    const plane = new TangentPlane(model);
    let next = 0;
    for (let i = 0; i < chunk.updates; i++) {
        const at = (why: string) => `its update ${i}: ${why}`;
        must((flags[i] & ~known) === 0, at("it has flags unknown to this program"));
        const inFile = gaps[i] + next;
        must(
            inFile < model.roots + 2 * (chunk.first + i),
            at("it splits a node that does not exist yet"),
        );
        next = inFile + 1;
        must(fields.levels[i] < 0x10000, at("its level is out of range"));
        must(fields.errors[i] <= GREATEST_ERROR, at("its error is out of range"));
        const parent = parentHere(model, inFile);
        const update = model.updates++;
        model.parents[update] = parent;
        model.levels[update] = fields.levels[i];
        model.flags[update] = flags[i];
        model.wings[2 * update] = fields.wings[0][i];
        model.wings[2 * update + 1] = fields.wings[1][i];
        model.errors[update] = fields.errors[i];
        const why = parent === NONE ? null : placeChildren(model, update, plane, fields, i);
        must(why === null, at(why ?? ""));
    }
}

/** Returns the node of the model that an update splits; none below a chunk that is missing. */
function parentHere(model: Model, inFile: number): number {
    const node = model.nodeHere(inFile);
    if (node === NONE || node < model.roots) return node;
    return model.parents[model.creator(node)] === NONE ? NONE : node;
}

/** Decodes the positions of an update's children; returns what is wrong with the update. */
function placeChildren(
    model: Model,
    update: number,
    plane: TangentPlane,
    fields: Fields,
    i: number,
): string | null {
    const { header, positions } = model;
    const { offsets } = fields;
    const parent = model.parents[update];
    plane.predict(parent);
    const { axes } = plane;
    const dThird = (offsets[4][i] + plane.inPlane(offsets[0][i], offsets[2][i])) | 0;
    const hThird = (offsets[5][i] + plane.inPlane(offsets[1][i], offsets[3][i])) | 0;
    const at = 3 * model.firstChild(update);
    let [dx, dy, dz] = [0, 0, 0];
    for (let place = 0; place < 3; place++) {
        const axis = axes[place];
        const d = place === 2 ? dThird : offsets[2 * place][i];
        const h = place === 2 ? hThird : offsets[2 * place + 1][i];
        const sum = 2 * (h + Math.round(positions[3 * parent + axis] / header.cell)) + (d & 1);
        const first = (sum - d) / 2;
        const second = (sum + d) / 2;
        if (Math.max(Math.abs(first), Math.abs(second)) > header.mostCells)
            return "its children are out of range";
        positions[at + axis] = first * header.cell;
        positions[at + 3 + axis] = second * header.cell;
        if (
            !isFinitePlace(model, positions[at + axis], axis) ||
            !isFinitePlace(model, positions[at + 3 + axis], axis)
        ) {
            return "its children are out of range";
        }
        if (axis === 0) dx = d;
        else if (axis === 1) dy = d;
        else dz = d;
    }
    const radius =
        radiusCode(Math.sqrt(dx * dx + dy * dy + dz * dz) * header.cell) + fields.radii[i];
    if (radius < 0 || radius > 255) return "its radius is out of range";
    model.radii[update] = radius;
    return linkUpdate(model, update);
}

/** Notes which node an update splits; returns what is wrong with the update. */
function linkUpdate(model: Model, update: number): string | null {
    const { levels, errors, wings } = model;
    const parent = model.parents[update];
    const above = parent < model.roots ? NONE : model.creator(parent);
    const most = above === NONE ? MOST_LEVELS : levels[above];
    if (levels[update] === 0 || levels[update] >= most)
        return "its level is not between 0 and that of the update above it";
    if (above !== NONE && errors[above] < errors[update])
        return "its error exceeds that of the update above it";
    for (let k = 2 * update; k < 2 * update + 2; k++) {
        if (wings[k] >= MOST_RANK && wings[k] < LAST_WING)
            return "the rank of a wing is out of range";
    }
    if (model.updateOf[parent] !== NONE) return "its node is split by another update, too";
    model.updateOf[parent] = update;
    return null;
}

function readNonFans(model: Model, chunk: ChunkEntry, flags: Uint8Array, input: Streams): void {
    const start = model.updates - chunk.updates;
    const nodes = model.roots + 2 * (chunk.first + chunk.updates);
    for (let i = 0; i < chunk.updates; i++) {
        if (!(flags[i] & NON_FAN)) continue;
        const second = input.numbers(2 * input.one());
        const created = input.numbers(3 * input.one());
        const areThere =
            second.every((node) => node < nodes) && created.every((node) => node < nodes);
        must(areThere && created.length <= 6, `its update ${i}: the faces it creates are invalid`);
        const here = (node: number) => model.nodeHere(node);
        const faces: number[] = [];
        for (let at = 0; at < created.length; at += 3) {
            const [a, b, c] = created.subarray(at, at + 3);
            must(
                a !== b && b !== c && c !== a,
                `its update ${i}: the faces it creates are invalid`,
            );
            const face = [a, b, c].map(here);
            if (!face.includes(NONE)) faces.push(...face);
        }
        model.nonFans.set(start + i, {
            second: second.map(here),
            created: Uint32Array.from(faces),
        });
    }
}

/** Reads the exact positions of children, one of which continues a vertex of the finest mesh. */
function readExactChildren(model: Model, start: number, flags: Uint8Array, input: Streams): void {
    const nodes: number[] = [];
    for (let i = 0; i < flags.length; i++) {
        for (const k of [0, 1])
            if (flags[i] & EXACT[k]) nodes.push(model.firstChild(start + i) + k);
    }
    const isKnown = (i: number) => model.parents[model.creator(nodes[i])] !== NONE;
    readExact(model, Uint32Array.from(nodes), isKnown, input);
    const exact = model.exact as Float64Array;
    for (let i = 0; i < flags.length; i++) {
        const parent = model.parents[start + i];
        if (parent === NONE || Number.isNaN(exact[3 * parent])) continue;
        const child = model.firstChild(start + i);
        const isSame = (node: number) =>
            [0, 1, 2].every((k) => Object.is(exact[3 * node + k], exact[3 * parent + k]));
        must(
            isSame(child) || isSame(child + 1),
            `its update ${i}: no child continues its vertex of the finest mesh`,
        );
    }
}

/** Returns the classes of the distances of children, from their codes alone. */
function sizesOf({ offsets, flags }: Fields): Uint8Array {
    return flags.map((_, i) => {
        let sum = 0;
        for (const k of [0, 2, 4]) sum += Math.floor((offsets[k][i] * offsets[k][i]) / 4) + 1;
        return sum < 2 ** 31 ? 32 - Math.clz32(sum) : Math.floor(Math.log2(sum)) + 1;
    });
}
