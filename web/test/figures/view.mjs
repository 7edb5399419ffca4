// Where the camera is.

import { readFileSync } from "node:fs";

const { SPAN = "0.9" } = process.env;

/** Looks at the middle of a file of contractions, obliquely from above, from SPAN diagonals. */
export function viewOf(path) {
    const head = readFileSync(path).subarray(0, 80);
    const center = [40, 48, 56].map((at) => head.readDoubleLE(at));
    const away = [0.35, 0.45, 0.75].map((x) => x * Number(SPAN) * head.readDoubleLE(72));
    return { center: center.join(","), away: away.join(",") };
}
