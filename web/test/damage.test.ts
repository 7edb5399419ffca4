import assert from "node:assert/strict";
import { test } from "node:test";
import { Cut } from "../src/cut/cut.ts";
import { decode } from "../src/decode.ts";
import { MlodError } from "../src/error.ts";
import { readHeader } from "../src/file/header.ts";
import { rewriteChecksums, vectorFile } from "./files.ts";

test("every flipped bit is noticed, and named with its section", () => {
    const file = vectorFile();
    for (let bit = 0; bit < 8 * file.length; bit++) {
        const wrong = file.slice();
        wrong[bit >> 3] ^= 1 << (bit & 7);
        assert.throws(() => decode(wrong), MlodError, `bit ${bit}`);
    }
});

test("a file may end anywhere behind its base mesh", () => {
    const file = vectorFile();
    const { base } = readHeader(file);
    for (let length = 0; length < file.length; length++) {
        const part = file.subarray(0, length);
        if (length < base.at + base.length)
            assert.throws(() => decode(part), MlodError, `${length}`);
        else assert.equal(decode(part).updates, 0);
    }
    const longer = new Uint8Array([...file, 0]);
    assert.throws(() => decode(longer), /unexpected data after its end, at byte 569/);
});

test("files with matching checksums that mislead are refused, or are other meshes", () => {
    const file = vectorFile();
    let [refused, read] = [0, 0];
    for (let bit = 8 * 132; bit < 8 * file.length; bit += 3) {
        const wrong = file.slice();
        wrong[bit >> 3] ^= 1 << (bit & 7);
        rewriteChecksums(wrong);
        try {
            const cut = new Cut(decode(wrong));
            cut.update({ focus: null, tolerance: 0 }, { changes: 1000 });
            read++;
        } catch (error) {
            assert.ok(error instanceof MlodError, `bit ${bit}: ${String(error)}`);
            refused++;
        }
    }
    assert.ok(refused > 100 && read > 100, `${refused} ${read}`);
});

test("a count asks for no more memory than its bytes are worth", () => {
    const file = vectorFile();
    // Updates of the chunk.
    new DataView(file.buffer).setUint32(88 + 8, 1 << 28, true);
    rewriteChecksums(file);
    assert.throws(() => decode(file), /chunk 0: its content ends too early/);
});

test("files of other formats and versions are named", () => {
    const file = vectorFile();
    file[0] ^= 1;
    assert.throws(() => decode(file), /does not start with "meshlodm"/);
    file[0] ^= 1;
    file[8] = 2;
    assert.throws(() => decode(file), /version 2 is not supported/);
    assert.throws(() => decode(new Uint8Array(3)), /the file ends at byte 3/);
});
