/** Rows of nodes, and integers of nodes that are packed row by row. */

import { Bits } from "../packed/reader.ts";
import type { ByteReader } from "../packed/reader.ts";

/** Rows between two places that are stored. */
const STRIDE = 16;
const WIDTH_BITS = 6;
const MOST_NODES = 2 ** 32 - 1;

/** Consecutive nodes, in rows. */
export class Rows {
    /** First node of each row, and the number of all nodes. */
    readonly starts: number[] = [0];

    constructor(sizes: Iterable<number>) {
        let end = 0;
        for (const size of sizes) this.starts.push((end += size));
    }

    /** Number of rows. */
    get length(): number {
        return this.starts.length - 1;
    }

    /** Number of nodes. */
    get nodes(): number {
        return this.starts[this.length];
    }

    size(row: number): number {
        return this.starts[row + 1] - this.starts[row];
    }

    /** Reads the sizes of a number of rows. */
    static read(count: number, reader: ByteReader): Rows {
        const width = reader.u8();
        reader.must(width <= 32, "a row has more nodes than 32 bits can number");
        const bits = takeBits(count * width, reader);
        const sizes = Array.from({ length: count }, (_, row) => bits.get(row * width, width));
        const rows = new Rows(sizes);
        reader.must(rows.nodes <= MOST_NODES, "there are more nodes than 32 bits can number");
        return rows;
    }
}

/** Takes a number of bits, padded to whole bytes. */
export function takeBits(count: number, reader: ByteReader): Bits {
    return new Bits(reader.take(Math.ceil(count / 8)));
}

/** Integers of nodes, a number of components for each. */
export class PackedRows {
    private readonly widths: Uint8Array;
    private readonly heads: Bits;
    private readonly numbers: Bits;

    constructor(
        readonly rows: Rows,
        private readonly components: number,
        reader: ByteReader,
    ) {
        this.widths = reader.take(components);
        const isNarrow = this.widths.every((width) => width <= 32);
        reader.must(isNarrow, "a row has a least number of more than 32 bits");
        let head = WIDTH_BITS * components;
        for (const width of this.widths) head += width;
        this.heads = takeBits(rows.length * head, reader);
        let end = 0;
        for (let row = 0; row < rows.length; row++) {
            const [, widths] = this.head(row, head);
            reader.must(
                widths.every((width) => width <= 32),
                `row ${row} has numbers of more than 32 bits`,
            );
            if (row % STRIDE === 0)
                reader.must(reader.u64() === end, `row ${row} has a wrong start`);
            end += rows.size(row) * widths.reduce((sum, width) => sum + width, 0);
        }
        this.numbers = takeBits(end, reader);
    }

    /** Returns the least numbers of a row, and the widths of what is above them. */
    private head(row: number, bits: number): [number[], number[]] {
        let at = row * bits;
        const least: number[] = [];
        const widths: number[] = [];
        for (const width of this.widths) {
            least.push(this.heads.get(at, width));
            widths.push(this.heads.get(at + width, WIDTH_BITS));
            at += width + WIDTH_BITS;
        }
        return [least, widths];
    }

    /** Decodes all integers, node by node. */
    all(): Uint32Array {
        const { rows, components, numbers } = this;
        const all = new Uint32Array(components * rows.nodes);
        let head = WIDTH_BITS * components;
        for (const width of this.widths) head += width;
        let [at, place] = [0, 0];
        for (let row = 0; row < rows.length; row++) {
            const [least, widths] = this.head(row, head);
            for (let left = rows.size(row); left > 0; left--) {
                for (let k = 0; k < components; k++) {
                    all[place++] = least[k] + numbers.get(at, widths[k]);
                    at += widths[k];
                }
            }
        }
        return all;
    }
}
