// A client of 3D Tiles in a browser without a screen, and all that it complains of.

import { chromium } from 'playwright-core';
import { serve } from './server.mjs';

// OpenGL in software.
const GL = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

// Longest wait for a page or for tiles, in milliseconds.
const PATIENCE = 120_000;

// Warned of by 3DTilesRendererJS of every tileset that is not of version 1.0.
const USUAL = /^TilesRenderer: tiles versions at 1\.1 or higher have limited support/;

// Starts a browser for tilesets in folders.
export async function browse(folders) {
    const site = await serve(folders);
    const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
    const browser = await chromium.launch({ executablePath, args: GL });
    const close = () => Promise.all([browser.close(), site.server.close()]);
    return { open: (name, of) => open(site, browser, name, of), close };
}

// Opens tileset number `of` in the client whose page is called NAME.html.
async function open(site, browser, name, of) {
    site.sent.clear();
    site.missing.length = 0;
    const page = await browser.newPage({ viewport: { width: 512, height: 512 } });
    page.setDefaultTimeout(PATIENCE);
    const faults = [];
    page.on('console', (message) => {
        const counts = ['error', 'warning'].includes(message.type());
        if (counts && !USUAL.test(message.text())) faults.push(message.text());
    });
    page.on('pageerror', (error) => faults.push(error.message));
    page.on('requestfailed', (request) => {
        // A client may give up a tile that is no longer in view.
        const reason = request.failure()?.errorText;
        if (reason !== 'net::ERR_ABORTED') faults.push(`${request.url()}: ${reason}`);
    });
    await page.goto(`${site.url}/${name}.html`);
    await page.waitForFunction(() => window.judge);
    await page.evaluate((url) => window.judge.open(url), `/tiles/${of}/tileset.json`);
    return {
        // Looks at the model, until all is loaded: `from` is how far the camera is from the middle,
        // in radii, and `pixels` the error that may be seen. Without `draws` 3DTilesRendererJS draws
        // a single frame, as large models take software seconds.
        async look(from, pixels, draws = true) {
            const view = { from, pixels, draws };
            const seen = await page.evaluate((view) => window.judge.look(view), view);
            const bytes = [...site.sent.values()].reduce((sum, bytes) => sum + bytes, 0);
            return { ...seen, files: site.sent.size, bytes };
        },
        faults: () => [...faults, ...site.missing.map((path) => `${path}: not found`)],
        shot: (path) => page.screenshot({ path }),
        close: () => page.close(),
    };
}
