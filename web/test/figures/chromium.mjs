// Opens the pages of this folder in Chromium, with OpenGL in software.

import { join } from "node:path";
import puppeteer from "puppeteer-core";
import { serve } from "./server.mjs";

const here = import.meta.dirname;
const web = join(here, "../..");
const { CHROMIUM = "/usr/bin/chromium", MOST_SECONDS = "300" } = process.env;

/** Starts a browser. */
export function startBrowser() {
    return puppeteer.launch({
        executablePath: CHROMIUM,
        args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader"],
        protocolTimeout: 1000 * Number(MOST_SECONDS),
    });
}

/** Opens a script of this folder over a slow network; returns what it says in the end. */
export async function resultOf(browser, { script, folder, pictures, query }) {
    const site = await serve(folder, [here, web, join(here, "node_modules")], pictures);
    const page = await browser.newPage();
    page.on("pageerror", (error) => console.error(String(error)));
    page.on("console", (message) => message.type() === "error" && console.error(message.text()));
    // Some clients look for decoders elsewhere, which nothing here needs.
    await page.setRequestInterception(true);
    page.on("request", (request) => {
        const isHere = /^(blob:|data:)/.test(request.url()) || request.url().startsWith(site.url);
        if (isHere) return void request.continue();
        const headers = { "Access-Control-Allow-Origin": "*" };
        void request.respond({ status: 200, headers, body: "" });
    });
    await page.goto(`${site.url}/page.html?${new URLSearchParams({ script, ...query })}`);
    await page.waitForFunction("window.result !== undefined", {
        timeout: 1000 * Number(MOST_SECONDS),
    });
    const result = await page.evaluate("window.result");
    await page.close();
    site.close();
    return result;
}
