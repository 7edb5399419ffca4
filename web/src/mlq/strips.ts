/** Faces as strips of parts. */

import type { ByteReader } from "../packed/reader.ts";
import type { PatchFaces } from "./patches.ts";
import type { Rows } from "./rows.ts";

/** Reads the strips of all parts as faces. */
export function readStrips(rows: Rows, reader: ByteReader): PatchFaces {
    reader.must(4 * rows.length <= reader.left, `too few bytes for ${rows.length} parts`);
    const lengths = Array.from({ length: rows.length }, () => reader.u32());
    const faces: number[] = [];
    const counts = lengths.map((length, part) => {
        const before = faces.length;
        addPart(rows, part, length, reader, faces);
        return (faces.length - before) / 3;
    });
    reader.must(rows.nodes <= faces.length, "there are more nodes than corners of faces");
    return { faces: new Uint32Array(faces), counts };
}

function addPart(
    rows: Rows,
    part: number,
    length: number,
    reader: ByteReader,
    faces: number[],
): void {
    const [first, size] = [rows.starts[part], rows.size(part)];
    const width = size < 0x100 ? 1 : size < 0x10000 ? 2 : 4;
    reader.must(length * width <= reader.left, `part ${part} has more indices than bytes`);
    const restart = 2 ** (8 * width) - 1;
    let [a, b, place] = [0, 0, 0];
    for (let i = 0; i < length; i++) {
        const index = width === 1 ? reader.u8() : width === 2 ? reader.u16() : reader.u32();
        if (index === restart) {
            place = 0;
            continue;
        }
        reader.must(index < size, `part ${part} has no node ${index}`);
        if (place >= 2 && a !== b && b !== index && index !== a) {
            const [x, y] = place % 2 === 0 ? [a, b] : [b, a];
            faces.push(first + x, first + y, first + index);
        }
        [a, b] = [b, index];
        place++;
    }
}
