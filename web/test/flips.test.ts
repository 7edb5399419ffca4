// Files with one bit flipped, as streams: the picture stays, and one event tells.

import assert from "node:assert/strict";
import { test } from "node:test";
import { MlodError } from "../src/error.ts";
import { open } from "../src/load/stream.ts";
import { Buffers } from "./buffers.ts";
import { conformanceFile, conformanceNames } from "./files.ts";
import { randomNumbers } from "./random.ts";

const FLIPS = 200;

/** What came of a stream. */
interface Outcome {
    /** Errors of the opening, and events after it. */
    refused: number;
    told: number;
}

/** Shows a file as fine as it is, and after an error as coarse as it is. */
async function show(file: Uint8Array, morph: number): Promise<Outcome> {
    let [told, done] = [0, false];
    let buffers: Buffers | null = null;
    const early: (() => void)[] = [];
    try {
        const stream = await open(file, {
            morph,
            slice: 1e9,
            onError: () => told++,
            onProgress: (progress) => (done = progress.done),
            onPatch: (patch) =>
                buffers ? buffers.apply(patch) : early.push(() => buffers?.apply(patch)),
        });
        const width = stream.info.layers.reduce((sum, layer) => sum + layer.width, 3);
        buffers = new Buffers(width);
        early.forEach((apply) => apply());
        const wait = async (isOver: () => boolean) => {
            for (let i = 0; i < 500 && !isOver(); i++)
                await new Promise((resolve) => setTimeout(resolve, 2));
        };
        stream.query({ focus: null, tolerance: 0 });
        await wait(() => told > 0);
        await wait(() => done);
        const fine = buffers.places().length;
        assert.ok(fine > 0, "the picture stays");
        // What has come still follows the camera.
        done = false;
        stream.query({ focus: null, tolerance: 1e9 });
        await wait(() => done);
        const coarse = buffers.places().length;
        assert.ok(coarse > 0 && coarse <= fine, `${coarse} of ${fine}`);
        assert.ok(buffers.values.every(Number.isFinite));
        stream.dispose();
        return { refused: 0, told };
    } catch (error) {
        assert.ok(error instanceof MlodError, String(error));
        return { refused: 1, told };
    }
}

const names = conformanceNames().filter((name) => name !== "field" && name !== "pieces");
test(
    `${FLIPS} flipped bits`,
    { skip: names.length === 0 && "the files are not there" },
    async () => {
        const random = randomNumbers(7);
        let [refused, told] = [0, 0];
        for (let flip = 0; flip < FLIPS; flip++) {
            const file = conformanceFile(names[flip % names.length]);
            const at = Math.floor(random() * file.length);
            file[at] ^= 1 << Math.floor(8 * random());
            const outcome = await show(file, flip % 2 === 0 ? 0 : 20);
            assert.equal(
                outcome.refused + outcome.told,
                1,
                `${names[flip % names.length]}, byte ${at}`,
            );
            refused += outcome.refused;
            told += outcome.told;
        }
        assert.ok(refused > 0 && told > 100, `${refused}, ${told}`);
    },
);
