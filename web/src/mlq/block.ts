/** What both schemes of blocks have in common. */

import type { ByteReader } from "../packed/reader.ts";

/** Vertices of a block, blocks of a group, and bits of a word. */
export const BLOCK = 32;
export const GROUP = 32;
export const WORD = 32;

/** Numbers of headers: the least one, and the bits of what is above it. */
export interface HeaderField {
    least: number;
    bits: number;
}

/** Returns a field, none of whose numbers is above 255. */
export function checkField(least: number, bits: number, reader: ByteReader): HeaderField {
    const isField = bits <= 8 && least + (1 << bits) <= 256;
    reader.must(isField, "a field of headers has numbers above 255");
    return { least, bits };
}
