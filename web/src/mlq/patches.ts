/** Faces in patches, each of which grows across its open edges. */

import { must, within } from "../error.ts";
import { BitCursor, Bits, bitsFor } from "../packed/reader.ts";
import type { ByteReader } from "../packed/reader.ts";
import type { Rows } from "./rows.ts";

/** Meanings of codes. */
const [OWN, NEXT, PREVIOUS, NOTHING, FOREIGN, KNOWN] = [0, 1, 2, 3, 4, 5];
/** By ones, for 0, 1 and 2 ends of the gate in foreign rows, and without a gate. */
const CODES = [
    [OWN, PREVIOUS, NEXT, NOTHING, FOREIGN, KNOWN],
    [FOREIGN, OWN, PREVIOUS, NEXT, NOTHING, KNOWN],
    [NOTHING, OWN, FOREIGN, PREVIOUS, NEXT, KNOWN],
    [OWN, FOREIGN, KNOWN],
] as const;
const NO_GATE = 3;
const NONE = -1;

/** Faces as nodes, and where the faces of each patch end. */
export interface PatchFaces {
    faces: Uint32Array;
    counts: number[];
}

/** Reads the faces of all patches, each of which has a number of rows. */
export function readPatches(rows: Rows, rowsPerPatch: number, reader: ByteReader): PatchFaces {
    const length = reader.u32();
    const count = Math.ceil(rows.length / rowsPerPatch);
    reader.must(8 * count <= reader.left, `too few bytes for ${count} patches`);
    const heads = Array.from({ length: count }, () => [reader.u32(), reader.u32()] as const);
    heads.forEach(([start, faces], patch) => {
        const end = patch + 1 < count ? heads[patch + 1][0] : length;
        const isRoom = end <= length && faces <= 8 * Math.max(end - start, 0);
        reader.must(isRoom, `patch ${patch} has too few bits for its faces`);
    });
    const bits = new Bits(reader.take(length));
    const counts = heads.map(([, faces]) => faces);
    const faces = new Uint32Array(3 * counts.reduce((sum, count) => sum + count, 0));
    reader.must(rows.nodes <= faces.length, "there are more nodes than corners of faces");
    let at = 0;
    heads.forEach(([start, count], patch) => {
        const first = patch * rowsPerPatch;
        const end = Math.min(first + rowsPerPatch, rows.length);
        const to = faces.subarray(at, at + 3 * count);
        within(`patch ${patch}`, () =>
            new PatchReader(rows, first, end, new BitCursor(bits, 8 * start)).read(to),
        );
        at += 3 * count;
    });
    return { faces, counts };
}

/** Open edges of a patch, in the order in which they opened; nodes as the patch numbers them. */
class Front {
    readonly from: number[] = [];
    readonly to: number[] = [];
    private readonly isOpen: boolean[] = [];
    private passed = 0;
    /** Last gate that opened from each node, and last to it, or `NONE`. */
    readonly lastFrom: number[] = [];
    readonly lastTo: number[] = [];

    /** Adds a node; returns its number. */
    meet(): number {
        this.lastTo.push(NONE);
        return this.lastFrom.push(NONE) - 1;
    }

    /** Closes the gate that has waited longest, and returns it; `NONE` if none is open. */
    pass(): number {
        while (this.passed < this.from.length) {
            const gate = this.passed++;
            if (!this.isOpen[gate]) continue;
            this.close(gate);
            return gate;
        }
        return NONE;
    }

    /** Adds a side of a face: closes the gate that it matches, or opens one. */
    side(from: number, to: number): void {
        for (const gate of [this.lastFrom[from], this.lastTo[to]]) {
            if (gate !== NONE && this.from[gate] === from && this.to[gate] === to)
                return this.close(gate);
        }
        const gate = this.from.push(to) - 1;
        this.to.push(from);
        this.isOpen.push(true);
        this.lastFrom[to] = gate;
        this.lastTo[from] = gate;
    }

    private close(gate: number): void {
        this.isOpen[gate] = false;
        const [from, to] = [this.from[gate], this.to[gate]];
        if (this.lastFrom[from] === gate) this.lastFrom[from] = NONE;
        if (this.lastTo[to] === gate) this.lastTo[to] = NONE;
    }
}

/** Reads one patch. */
class PatchReader {
    private readonly front = new Front();
    /** Row and node of each number that the patch has given. */
    private readonly rowOf: number[] = [];
    private readonly nodeOf: number[] = [];
    /** Nodes used so far of each own row. */
    private readonly taken: Uint32Array;
    private readonly foreign: number[] = [];
    /** Likely row of the next own node. */
    private likely = 0;

    constructor(
        private readonly rows: Rows,
        private readonly first: number,
        private readonly end: number,
        private readonly bits: BitCursor,
    ) {
        this.taken = new Uint32Array(end - first);
        const count = bits.next(bits.next(5));
        must(count <= rows.length - (end - first), `it names ${count} foreign rows`);
        for (let i = 0; i < count; i++) {
            const row = bits.next(bitsFor(rows.length));
            must(row < rows.length, `there is no row ${row}`);
            this.foreign.push(row);
        }
    }

    /** Reads as many faces as there is room for. */
    read(faces: Uint32Array): void {
        const { front, nodeOf } = this;
        for (let at = 0; at < faces.length;) {
            const gate = front.pass();
            if (gate === NONE) {
                const [a, b, c] = [this.corner(), this.corner(), this.corner()];
                front.side(a, b);
                front.side(b, c);
                front.side(c, a);
                faces[at++] = nodeOf[a];
                faces[at++] = nodeOf[b];
                faces[at++] = nodeOf[c];
                continue;
            }
            const [from, to] = [front.from[gate], front.to[gate]];
            const third = this.third(from, to);
            if (third === NONE) continue;
            front.side(to, third);
            front.side(third, from);
            faces[at++] = nodeOf[from];
            faces[at++] = nodeOf[to];
            faces[at++] = nodeOf[third];
        }
    }

    private isOwn(row: number): boolean {
        return row >= this.first && row < this.end;
    }

    private code(context: number): number {
        const codes = CODES[context];
        let ones = 0;
        while (ones + 1 < codes.length && this.bits.next(1) === 1) ones++;
        return codes[ones];
    }

    /** Reads the third corner of the face at a gate, or `NONE` if there is no face. */
    private third(from: number, to: number): number {
        const { front } = this;
        const rows = [this.rowOf[to], this.rowOf[from]].filter((row) => this.isOwn(row));
        this.likely = rows.length > 0 ? rows[0] : this.first;
        const code = this.code(2 - rows.length);
        if (code === NOTHING) return NONE;
        if (code !== NEXT && code !== PREVIOUS) return this.node(code);
        const gate = code === NEXT ? front.lastFrom[to] : front.lastTo[from];
        must(gate !== NONE, "the border does not continue at a gate");
        return code === NEXT ? front.to[gate] : front.from[gate];
    }

    /** Reads a corner of a face without a gate. */
    private corner(): number {
        this.likely = this.first;
        return this.node(this.code(NO_GATE));
    }

    private node(code: number): number {
        const { bits, rows, rowOf, nodeOf } = this;
        if (code === KNOWN) {
            const number = bits.next(bitsFor(rowOf.length));
            must(number < rowOf.length, `it has no node ${number} yet`);
            return number;
        }
        const row = code === OWN ? this.ownRow() : this.foreignRow();
        const number =
            code === OWN ? this.taken[row - this.first]++ : bits.next(bitsFor(rows.size(row)));
        must(number < rows.size(row), `row ${row} has no node ${number}`);
        rowOf.push(row);
        nodeOf.push(rows.starts[row] + number);
        return this.front.meet();
    }

    private ownRow(): number {
        const count = this.end - this.first;
        if (count === 1 || this.bits.next(1) === 0) return this.likely;
        const at = this.bits.next(bitsFor(count));
        must(at < count, `it has no row ${at} of its own`);
        return this.first + at;
    }

    private foreignRow(): number {
        const at = this.bits.next(bitsFor(this.foreign.length));
        must(at < this.foreign.length, `it has no foreign row ${at}`);
        return this.foreign[at];
    }
}
