// Looks for cracks at random moments of a stream over a slow network: README.md.
// Usage: node cracks.mjs MODEL.mlod... MOMENTS, 50 by default, and SEED are variables.

import { readFileSync } from "node:fs";
import { basename, dirname, resolve } from "node:path";
import { Cut, decode } from "../../dist/index.js";
import { borderOf } from "../edges.js";
import { resultOf, startBrowser } from "./chromium.mjs";
import { viewOf } from "./view.mjs";

const { MOMENTS = "50", SEED = "1" } = process.env;
const browser = await startBrowser();
for (const model of process.argv.slice(2)) {
    const moments = await resultOf(browser, {
        script: "moments",
        folder: dirname(resolve(model)),
        query: {
            file: `/model/${basename(model)}`,
            ...viewOf(model),
            moments: MOMENTS,
            seed: SEED,
        },
    });
    if (process.env.VERBOSE)
        for (const moment of moments) console.error(JSON.stringify({ ...moment, ends: undefined }));
    if (moments.error) console.error(moments.error);
    const report = reportOf(moments, borderPlaces(model, moments));
    console.log(JSON.stringify({ model, ...report }));
    if (report.cracks > 0 || report.notUploaded > 0) process.exitCode = 1;
}
await browser.close();

/** Returns where levels may be open; of a closed model that was never open nothing is read. */
function borderPlaces(model, moments) {
    if (moments.every(({ open }) => open === 0)) return new Set();
    const cut = new Cut(decode(readFileSync(model)));
    cut.update({ focus: null, tolerance: 0 });
    return borderOf(cut.model, cut.triangles);
}

function reportOf(moments, border) {
    const sum = (count) => moments.reduce((all, moment) => all + count(moment), 0);
    const pixels = moments.flatMap((moment) => moment.pixels);
    const isCrack = (ends) => !ends.every((place) => border.has(place));
    return {
        moments: moments.length,
        streaming: sum(({ missing }) => Number(missing > 0)),
        faces: [
            Math.min(...moments.map(({ faces }) => faces)),
            Math.max(...moments.map(({ faces }) => faces)),
        ],
        notUploaded: sum(({ isUploaded }) => Number(!isUploaded)),
        open: sum(({ open }) => open),
        cracks: sum(({ ends }) => ends.filter(isCrack).length),
        holes: sum(({ holes }) => holes),
        // Of these pixels: seen through, covered by arithmetic but for rounding, and covered.
        through: pixels.filter(({ front }) => front === 0).length,
        rim: pixels.filter(({ front, rounded }) => front > 0 && rounded === 0).length,
        missed: pixels.filter(({ rounded }) => rounded > 0).length,
    };
}
