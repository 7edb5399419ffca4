// In Chromium: a file that streams from a server is shown, without a crack, and disposed of; then with
// the package and the file at another origin, and with vertices that move.
// Usage: node test/browser.mjs FILE.mlod [CHROMIUM]; after `npm run build`.

import assert from "node:assert/strict";
import { launch, resultOf, serve } from "./chromium.mjs";

const [file, chromium] = process.argv.slice(2);
const files = { "/model.mlod": file };
const [home, other] = [await serve("/test/page.js", files), await serve("", files)];
const browser = await launch(chromium);

async function show(query) {
    home.sent.bytes = other.sent.bytes = 0;
    const { result, errors } = await resultOf(browser, `${home.address}/${query}`);
    console.log(JSON.stringify({ ...result, sent: home.sent.bytes + other.sent.bytes }));
    assert.deepEqual(errors, []);
    assert.equal(result.error, null);
    assert.ok(result.faces[1] > result.faces[0], "closer is finer");
    assert.ok(result.covered > 0.02 && result.hit, "the mesh is drawn, and rays hit it");
    // A pixel of the background inside the silhouette may be seen through a tunnel.
    assert.deepEqual(result.missed, [0, 0, 0], "pixels that a triangle covers are drawn");
    const [holes, moments] = result.moments;
    assert.ok(
        holes <= 2 * moments && result.holes.every((holes) => holes <= 2),
        "no more than tunnels",
    );
    return result;
}

try {
    await show("");
    await show(`?from=${encodeURIComponent(other.address)}`);
    const { moments, kind } = await show("?morph=500");
    assert.ok(moments[1] > 3 || kind === "height field", "pictures of vertices on their way");
} finally {
    await browser.close();
    home.close();
    other.close();
}
