/** A file of contractions in memory, decoded as far as it goes. */

import { readBase } from "./file/base.ts";
import { readChunk } from "./file/chunk.ts";
import { readHeader } from "./file/header.ts";
import type { ChunkEntry, Header } from "./file/header.ts";
import { MlodError } from "./error.ts";
import type { Model } from "./model.ts";
import { ValueDecoder } from "./wedges/values.ts";

/** Adds chunks to a model, and restores the attribute values that they complete. */
export class Decoder {
    readonly model: Model;
    private readonly values: ValueDecoder | null;

    /** Decodes the base mesh. */
    constructor(header: Header, base: Uint8Array) {
        this.model = readBase(header, base);
        const { wedges } = this.model;
        this.values = wedges && wedges.columns > 0 ? new ValueDecoder(this.model, wedges) : null;
    }

    /** Adds chunks, each with its bytes, in the order of the file and behind all before. */
    add(chunks: readonly (readonly [ChunkEntry, Uint8Array])[]): void {
        const start = this.model.updates;
        for (const [chunk, bytes] of chunks) readChunk(this.model, chunk, bytes);
        this.model.rankNodes();
        this.values?.restore(start);
    }
}

/** Returns the number of chunks that bytes from the start of a file hold in full. */
export function completeChunks({ chunks }: Header, length: number): number {
    return chunks.filter((chunk) => chunk.at + chunk.length <= length).length;
}

/**
 * Decodes a file, or any prefix of one that holds its base mesh.
 *
 * @param most greatest number of chunks to decode; all that are there by default
 * @throws MlodError if it is damaged, or ends before the base mesh does
 */
export function decode(file: Uint8Array, most = Infinity): Model {
    const header = readHeader(file);
    const { base } = header;
    if (file.length > header.length) {
        throw new MlodError("the file", `unexpected data after its end, at byte ${header.length}`);
    }
    if (file.length < base.at + base.length) {
        throw new MlodError(base.name, `the file ends at byte ${file.length}, before it does`);
    }
    const part = (at: number, length: number) => file.subarray(at, at + length);
    const decoder = new Decoder(header, part(base.at, base.length));
    const chunks = header.chunks.slice(0, Math.min(completeChunks(header, file.length), most));
    decoder.add(chunks.map((chunk) => [chunk, part(chunk.at, chunk.length)] as const));
    return decoder.model;
}
