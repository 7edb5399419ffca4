/** The header of a file of contractions, with the index of its chunks and resources. */

import { MlodError } from "../error.ts";
import { isUnit } from "../frame.ts";
import type { Frame } from "../frame.ts";
import { crc32 } from "./crc32.ts";

/** A piece of the file with its checksum. */
export interface Section {
    name: string;
    at: number;
    length: number;
    checksum: number;
}

/** A chunk of updates. */
export interface ChunkEntry extends Section {
    /** Number of its first update, and how many it has. */
    first: number;
    updates: number;
    /** Number of faces that its updates create. */
    faces: number;
    /** Corners of its area, in units, and its greatest error. */
    min: [number, number, number];
    max: [number, number, number];
    error: number;
}

/** Bytes between the chunks. */
export interface ResourceEntry extends Section {
    /** Number of chunks before it. */
    after: number;
}

/** How errors were found. */
export type ErrorKind = "estimates" | "bounds" | "measured";

/** What the front of a file says. */
export interface Header {
    frame: Frame;
    /** Side of a cell of the lattice, in units. */
    cell: number;
    /** Greatest coordinate of a cell. */
    mostCells: number;
    errorKind: ErrorKind;
    isLossless: boolean;
    hasWedges: boolean;
    hasStages: boolean;
    /** Diagonal of the finest mesh, and the greatest distance that rounding moved a vertex. */
    diagonal: number;
    rounding: number;
    roots: number;
    baseFaces: number;
    base: Section;
    chunks: ChunkEntry[];
    resources: ResourceEntry[];
    /** Number of updates in all chunks. */
    updates: number;
    /** Length of the whole file. */
    length: number;
}

export const MAGIC = "meshlodm";
export const VERSION = 1;
/** Length of the header without its index. */
export const FIXED_LENGTH = 88;
const CHUNK_LENGTH = 44;
const RESOURCE_LENGTH = 12;
const MOST_UPDATES = 2 ** 29;
const FLAGS = {
    lossless: 1,
    wedges: 2,
    oldResources: 4,
    resources: 8,
    stages: 16,
    old: 96,
    predicted: 128,
};

/** Throws an error about the header. */
function bad(why: string): never {
    throw new MlodError("the header", why);
}

/** Returns the first bytes as text, to tell formats apart. */
export function magicOf(bytes: Uint8Array): string {
    return String.fromCharCode(...bytes.subarray(0, 8));
}

/**
 * Returns how many bytes of a file the header takes, as far as its first bytes tell: with fewer,
 * ask
 * again once these are there.
 *
 * @throws MlodError for a file of another format or version
 */
export function headerLength(bytes: Uint8Array): number {
    if (bytes.length < FIXED_LENGTH) return FIXED_LENGTH;
    const view = viewOf(bytes);
    if (magicOf(bytes) !== MAGIC) bad(`it does not start with "${MAGIC}"`);
    const version = view.getUint32(8, true);
    if (version !== VERSION) bad(`version ${version} is not supported, only ${VERSION}`);
    const chunks = FIXED_LENGTH + CHUNK_LENGTH * view.getUint32(36, true);
    const flags = bytes[19];
    if (flags & FLAGS.resources) {
        if (bytes.length < chunks + 4) return chunks + 4;
        return chunks + 4 + RESOURCE_LENGTH * view.getUint32(chunks, true);
    }
    return chunks + (flags & FLAGS.oldResources ? 16 : 0);
}

/**
 * Decodes a header, given at least as many bytes as it takes.
 *
 * @throws MlodError if it is damaged
 */
export function readHeader(bytes: Uint8Array): Header {
    const length = headerLength(bytes);
    if (bytes.length < length) bad(`the file ends at byte ${bytes.length}, within its index`);
    const view = viewOf(bytes);
    if (crc32(bytes.subarray(16, length)) !== view.getUint32(12, true)) {
        bad("its checksum does not match: the file is damaged");
    }
    const flags = bytes[19];
    const has = (flag: number) => (flags & flag) !== 0;
    if (has(FLAGS.wedges) !== has(FLAGS.predicted) || has(FLAGS.old)) bad("it has unknown flags");
    const [bits, steps] = bytes.subarray(16, 18);
    if (bits > 23 || steps < 1 || steps > 7) bad("the cell size of its lattice is out of range");
    const errorKind = (["estimates", "bounds", "measured"] as const)[bytes[18]];
    if (errorKind === undefined) bad("it has an unknown kind of errors");
    const double = (at: number) => view.getFloat64(at, true);
    const frame: Frame = { origin: [double(40), double(48), double(56)], unit: double(64) };
    if (!frame.origin.every(Number.isFinite) || !isUnit(frame.unit)) {
        bad("its origin is not finite, or its unit is no power of two");
    }
    const isLength = (x: number) => x >= 0 && x < Infinity;
    if (!isLength(double(72)) || !isLength(double(80)))
        bad("its diagonal or rounding is no length");
    const base = {
        name: "the coarsest mesh",
        at: length,
        length: view.getUint32(28, true),
        checksum: view.getUint32(32, true),
    };
    const sections = readIndex(
        view,
        base.at + base.length,
        has(FLAGS.resources),
        has(FLAGS.oldResources),
    );
    const roots = view.getUint32(20, true);
    if (sections.updates > MOST_UPDATES || roots > MOST_UPDATES) bad("it has too many updates");
    return {
        frame,
        cell: steps * 2 ** -bits,
        mostCells: Math.trunc(2 ** 24 / steps),
        errorKind,
        isLossless: has(FLAGS.lossless),
        hasWedges: has(FLAGS.wedges),
        hasStages: has(FLAGS.stages),
        diagonal: double(72),
        rounding: double(80),
        roots,
        baseFaces: view.getUint32(24, true),
        base,
        ...sections,
    };
}

/** Reads the index, and finds where its sections are. */
function readIndex(view: DataView, at: number, hasResources: boolean, hasOld: boolean) {
    const chunks: ChunkEntry[] = [];
    const resources: ResourceEntry[] = [];
    const count = view.getUint32(36, true);
    const end = FIXED_LENGTH + CHUNK_LENGTH * count;
    const waiting = hasResources
        ? readResources(view, end, count)
        : hasOld
          ? readOld(view, end, count)
          : [];
    let updates = 0;
    for (let before = 0; before <= count; before++) {
        while (waiting.length > 0 && waiting[0].after <= before) {
            const entry = waiting.shift() as ResourceEntry;
            entry.at = at;
            at += entry.length;
            resources.push(entry);
        }
        if (before === count) break;
        const chunk = readChunkEntry(view, before, at, updates);
        chunks.push(chunk);
        at += chunk.length;
        updates += chunk.updates;
    }
    return { chunks, resources: hasOld && !hasResources ? [] : resources, updates, length: at };
}

function readChunkEntry(view: DataView, number: number, at: number, first: number): ChunkEntry {
    const from = FIXED_LENGTH + CHUNK_LENGTH * number;
    const word = (k: number) => view.getUint32(from + 4 * k, true);
    const float = (k: number) => view.getFloat32(from + 16 + 4 * k, true);
    const chunk: ChunkEntry = {
        name: `chunk ${number}`,
        at,
        length: word(0),
        checksum: word(1),
        first,
        updates: word(2),
        faces: word(3),
        min: [float(0), float(1), float(2)],
        max: [float(3), float(4), float(5)],
        error: float(6),
    };
    if (![...chunk.min, ...chunk.max].every(Number.isFinite) || !(chunk.error >= 0)) {
        bad(`chunk ${number} has invalid bounds`);
    }
    return chunk;
}

function readResources(view: DataView, at: number, chunks: number): ResourceEntry[] {
    const entries = Array.from({ length: view.getUint32(at, true) }, (_, i) => {
        const from = at + 4 + RESOURCE_LENGTH * i;
        const word = (k: number) => view.getUint32(from + 4 * k, true);
        return { name: `resource ${i}`, at: 0, length: word(0), checksum: word(1), after: word(2) };
    });
    const isSorted = entries.every((entry, i) => i === 0 || entries[i - 1].after <= entry.after);
    if (!isSorted || entries.some((entry) => entry.after > chunks))
        bad("its resources are out of order");
    return entries;
}

/** Resources of an earlier version, which only take their place. */
function readOld(view: DataView, at: number, chunks: number): ResourceEntry[] {
    return [0, 1].map((i) => ({
        name: `resource ${i}`,
        at: 0,
        length: view.getUint32(at + 8 * i, true),
        checksum: view.getUint32(at + 8 * i + 4, true),
        after: i * chunks,
    }));
}

/** Throws unless bytes have the length and the checksum of their section. */
export function check(section: Section, bytes: Uint8Array): void {
    if (bytes.length !== section.length || crc32(bytes) !== section.checksum) {
        throw new MlodError(
            section.name,
            `its checksum does not match at byte ${section.at}: the file is damaged`,
        );
    }
}

function viewOf(bytes: Uint8Array): DataView {
    return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}
