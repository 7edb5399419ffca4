/** The chunks of a file that are in memory, and the cut that follows queries in them. */

import { Criterion } from "../cut/criterion.ts";
import { Cut } from "../cut/cut.ts";
import type { Query } from "../cut/query.ts";
import { Decoder } from "../decode.ts";
import type { ChunkEntry, Header } from "../file/header.ts";

/** Memory of an update with its nodes and, on an average, its wedges, in bytes. */
const BYTES_PER_UPDATE = 120;

/** Levels that grow as chunks come. */
export class Levels {
    cut: Cut;
    /** Bytes of the chunks that are in memory, by their numbers. */
    private readonly loaded = new Map<number, Uint8Array>();
    private decoder: Decoder;
    private last = -1;

    /**
     * @param memory greatest number of bytes that decoded levels may take
     * @throws MlodError if the base mesh is damaged
     */
    constructor(
        private readonly header: Header,
        private readonly base: Uint8Array,
        private readonly memory: number,
    ) {
        this.decoder = new Decoder(header, base);
        this.cut = new Cut(this.decoder.model);
    }

    /** Number of chunks in memory. */
    get count(): number {
        return this.loaded.size;
    }

    /** Number of the first chunk behind all that are in memory. */
    get reached(): number {
        return this.last + 1;
    }

    /**
     * Returns the numbers of the chunks that a query needs and that are not in memory, in order.
     */
    wanted(query: Query): number[] {
        return this.fitting(query).filter((number) => !this.loaded.has(number));
    }

    /** Tells the cut what the next query wants that is missing between chunks that are there. */
    noteGaps(query: Query): void {
        const { chunks, frame } = this.header;
        const hasGaps = this.count < this.reached;
        const criterion = new Criterion(query, frame);
        const isGap = (chunk: ChunkEntry, number: number) =>
            number < this.last && !this.loaded.has(number) && criterion.mayRequire(chunk);
        this.cut.gaps = hasGaps ? chunks.filter(isGap) : [];
    }

    /** Returns the numbers of the chunks that a query needs; of too many, the coarse ones. */
    private fitting(query: Query): number[] {
        const criterion = new Criterion(query, this.header.frame);
        const { chunks } = this.header;
        let memory = 0;
        return [...chunks.keys()].filter(
            (number) =>
                criterion.mayRequire(chunks[number]) &&
                (memory += BYTES_PER_UPDATE * chunks[number].updates) <= this.memory,
        );
    }

    /** Returns the bytes that chunks take once they are decoded. */
    private memoryOf(numbers: Iterable<number>): number {
        let sum = 0;
        for (const number of numbers) sum += BYTES_PER_UPDATE * this.header.chunks[number].updates;
        return sum;
    }

    /**
     * Adds chunks that have been fetched. If that takes too much memory, chunks that the query does
     * not need go.
     *
     * @returns true if the cut is another one, which starts from the base mesh
     * @throws MlodError if a chunk is damaged; nothing is added
     */
    add(chunks: readonly (readonly [number, Uint8Array])[], query: Query): boolean {
        const isBehind = chunks.every(([number]) => number > this.last);
        const before = [...this.loaded.keys()];
        const isTooMuch =
            this.memoryOf([...before, ...chunks.map(([number]) => number)]) > this.memory;
        if (isTooMuch) this.evict(query);
        if (!isBehind || this.loaded.size < before.length) {
            const decoder = this.decoderOf([...this.loaded, ...chunks]);
            this.keep(chunks, decoder);
            return true;
        }
        try {
            this.decoder.add(chunks.map(([number, bytes]) => [this.entry(number), bytes] as const));
        } catch (error) {
            this.keep([], this.decoderOf([...this.loaded]));
            throw error;
        }
        this.keep(chunks, this.decoder);
        return false;
    }

    private entry(number: number): ChunkEntry {
        return this.header.chunks[number];
    }

    /** Notes that chunks have been decoded; with another decoder the cut starts anew. */
    private keep(chunks: readonly (readonly [number, Uint8Array])[], decoder: Decoder): void {
        for (const [number, bytes] of chunks) this.loaded.set(number, bytes);
        this.last = Math.max(-1, ...this.loaded.keys());
        if (decoder === this.decoder) return this.cut.grow();
        this.decoder = decoder;
        this.cut = new Cut(decoder.model);
    }

    /** Decodes the base mesh and chunks, in the order of the file. */
    private decoderOf(chunks: (readonly [number, Uint8Array])[]): Decoder {
        const decoder = new Decoder(this.header, this.base);
        chunks.sort(([a], [b]) => a - b);
        decoder.add(chunks.map(([number, bytes]) => [this.entry(number), bytes] as const));
        return decoder;
    }

    /** Forgets the chunks that a query does not need, or for which it has no room. */
    private evict(query: Query): void {
        const kept = new Set(this.fitting(query));
        for (const number of [...this.loaded.keys()])
            if (!kept.has(number)) this.loaded.delete(number);
    }
}
