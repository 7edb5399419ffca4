// Takes the picture of the viewer in the project's README.
// Usage: node test/picture.mjs MESHLOD FOLDER NAME OUT.jpg [CHROMIUM]; NAME is the model that is shown.

import { spawn } from "node:child_process";
import { once } from "node:events";
import puppeteer from "puppeteer-core";

const [meshlod, folder, name, out, chromium = "/usr/bin/chromium"] = process.argv.slice(2);
const server = spawn(meshlod, ["serve", folder, "--port", "0", "--json"]);
const browser = await puppeteer.launch({
    executablePath: chromium,
    args: ["--no-sandbox", "--enable-unsafe-swiftshader"],
    defaultViewport: { width: 960, height: 540 },
});
try {
    const [line] = await once(server.stderr, "data");
    const page = await browser.newPage();
    await page.goto(`${/http:\S+/.exec(String(line))[0]}#${name}`);
    await page.waitForFunction(
        `document.title.startsWith("${name}") && document.documentElement.dataset.state === "shown"`,
    );
    await page.focus("#view");
    for (const key of ["ArrowRight", "ArrowRight", "ArrowUp", "+"]) await page.keyboard.press(key);
    // Until two pictures in a row have as many faces.
    for (let [before, faces] = ["", "0"]; before !== faces;) {
        before = faces;
        await new Promise((resolve) => setTimeout(resolve, 2000));
        faces = await page.evaluate("document.documentElement.dataset.faces");
    }
    await page.screenshot({ path: out, type: "jpeg", quality: 80 });
} finally {
    server.kill();
    await browser.close();
}
