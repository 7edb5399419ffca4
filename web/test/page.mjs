// In Chromium: the viewer of `meshlod serve` and of pages by `meshlod page` shows models.
// Usage: node test/page.mjs MESHLOD FOLDER [CHROMIUM]; the folder has .mlod, .mlz and .mlq files.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

const [meshlod, folder, chromium = "/usr/bin/chromium"] = process.argv.slice(2);
const SIZE = { width: 480, height: 360 };
const work = mkdtempSync(join(tmpdir(), "page-"));
const server = spawn(meshlod, ["serve", folder, "--port", "0", "--json"]);
const browser = await puppeteer.launch({
    executablePath: chromium,
    args: ["--no-sandbox", "--enable-unsafe-swiftshader"],
    defaultViewport: SIZE,
});

/** Returns the part of the picture's middle that differs from its background. */
function coverage(page) {
    return page.evaluate(async () => {
        const canvas = document.getElementById("view");
        const copy = new OffscreenCanvas(120, 90).getContext("2d");
        // The page draws, and before the frame ends its picture is taken.
        document.getElementById("pixels").dispatchEvent(new Event("input"));
        await new Promise((resolve) =>
            requestAnimationFrame(() => {
                copy.drawImage(canvas, 0, 0, 120, 90);
                resolve();
            }),
        );
        const { data } = copy.getImageData(0, 0, 120, 90);
        return data.filter((value, i) => i % 4 === 3 && value > 128).length / (120 * 90);
    });
}

async function visit(url, inFrame) {
    const page = await browser.newPage();
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    await page.goto(url);
    const frame = inFrame ? await (await page.waitForSelector("iframe")).contentFrame() : page;
    return { page, frame, errors };
}

/** Waits until all is shown, and looks at the picture. */
async function look({ frame, errors }, name) {
    const isOver = "['shown', 'failed'].includes(document.documentElement.dataset.state)";
    // The coarsest level is all that is asked for before the first picture.
    for (let [faces, before] = ["", null]; faces !== before;) {
        before = faces;
        await new Promise((resolve) => setTimeout(resolve, 500));
        await frame.waitForFunction(isOver, { timeout: 60_000 });
        faces = await frame.evaluate("document.documentElement.dataset.faces");
    }
    const told = await frame.$eval("#error", (line) => (line.hidden ? "" : line.textContent));
    assert.equal(told, "", name);
    const figures = await frame.$eval("#figures", (line) => line.textContent);
    const covered = await coverage(frame);
    console.log(`${name}: ${figures}; ${(100 * covered).toFixed(0)} % covered`);
    assert.ok(covered > 0.03, `${name} is drawn`);
    assert.deepEqual(errors, [], name);
    return Number(await frame.evaluate("document.documentElement.dataset.faces"));
}

/** Turns, moves and zooms by every way there is, towards the model. */
async function handle({ page }) {
    await page.mouse.move(240, 150);
    await page.mouse.down();
    await page.mouse.move(280, 170, { steps: 3 });
    await page.mouse.up();
    await page.focus("#view");
    for (const key of ["ArrowLeft", "ArrowUp", "+", "+", "+"]) await page.keyboard.press(key);
    await page.mouse.wheel({ deltaY: -300 });
    await page.focus("#pixels");
    await page.keyboard.press("Home");
}

async function served() {
    const [line] = await once(server.stderr, "data");
    const url = /http:\S+/.exec(String(line))[0];
    const visitor = await visit(url);
    const { page } = visitor;
    await look(visitor, "the first file");
    const paths = await page.$$eval("#files a", (links) => links.map((link) => link.dataset.path));
    assert.ok(paths.length > 3, String(paths));
    for (const path of paths) {
        // Two at once: the second is shown.
        await page.evaluate((hash) => (location.hash = hash), encodeURIComponent(path));
        await page.waitForFunction(
            `document.title.startsWith(${JSON.stringify(path.split("/").pop())})`,
        );
        const faces = await look(visitor, path);
        if (!path.endsWith(".mlod")) continue;
        await handle(visitor);
        await page.waitForFunction(`document.documentElement.dataset.faces !== "${faces}"`);
        assert.ok((await look(visitor, `${path}, from near`)) > faces, "closer is finer");
    }
    await page.evaluate(() => (location.hash = "missing.mlod"));
    await page.waitForSelector("#error:not([hidden])");
    assert.match(await page.$eval("#error", (line) => line.textContent), /404/);
    assert.ok((await coverage(page)) > 0.03, "the picture stays");
    await page.close();
    return paths.find((path) => path.endsWith(".mlod"));
}

async function inFiles(model) {
    const html = join(work, "model.html");
    const made = spawnSync(meshlod, ["page", join(folder, model), html, "--json"]);
    assert.equal(made.status, 0, String(made.stderr));
    const figures = JSON.parse(made.stdout);
    assert.ok(figures.viewer_bytes <= 150_000);
    const visitor = await visit(pathToFileURL(html).href);
    const faces = await look(visitor, "a page");
    await handle(visitor);
    await visitor.page.waitForFunction(`document.documentElement.dataset.faces > ${faces}`);
    await visitor.page.close();
    // As notebooks show it: in a frame that is nobody's origin.
    const outer = join(work, "outer.html");
    writeFileSync(outer, `<iframe sandbox="allow-scripts" src="model.html"></iframe>`);
    await look(await visit(pathToFileURL(outer).href, true), "a page in a frame");
}

try {
    await inFiles(await served());
    const over = once(server, "exit");
    let json = "";
    server.stdout.on("data", (text) => (json += text));
    server.kill("SIGINT");
    assert.deepEqual(await over, [0, null]);
    console.log(json.replace(/\s+/g, " "));
    assert.ok(JSON.parse(json).requests > 10);
} finally {
    server.kill();
    await browser.close();
    rmSync(work, { recursive: true });
}
