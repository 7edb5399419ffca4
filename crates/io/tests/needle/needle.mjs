// Opens NEEDLE_progressive in its client, in Chromium: node needle.mjs [--chromium PATH] FILE..., each
// written by `meshlod lods --layout needle`. Ends with 1 if a level or a texture is not shown where it
// should be, is not what its file has, or if the client complains.

import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { basename, dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import puppeteer from 'puppeteer-core';

const here = dirname(fileURLToPath(import.meta.url));
const NAME = 'NEEDLE_progressive';
const TYPES = { '.js': 'text/javascript', '.html': 'text/html' };
const PAGE = `<!doctype html><script type="importmap">{ "imports": {
    "three": "/node_modules/three/build/three.module.js",
    "three/": "/node_modules/three/",
    "@needle-tools/gltf-progressive": "/node_modules/@needle-tools/gltf-progressive/lib/index.js"
} }</script><body><script type="module" src="/page.js"></script>`;

// Distances of the camera in radii, from far away to near.
const RADII = [400, 100, 40, 20, 10, 6, 4, 2.2];

const args = process.argv.slice(2);
const chromium = args[0] === '--chromium' ? args.splice(0, 2)[1] : '/usr/bin/chromium';
if (args.length === 0) {
    console.error('usage: node needle.mjs [--chromium PATH] FILE...');
    process.exit(2);
}

function documentOf(path) {
    const bytes = readFileSync(path);
    if (extname(path) === '.gltf') return JSON.parse(bytes.toString('utf8'));
    return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString('utf8'));
}

// Indices of each primitive of the mesh with an id.
function indices(document, guid) {
    const mesh = document.meshes.find(({ extensions }) => extensions?.[NAME]?.guid === guid);
    return mesh.primitives.map((primitive) => document.accessors[primitive.indices].count);
}

// What the files have: by id, the primitives of each level, the document's last.
function expected(path) {
    const document = documentOf(path);
    const chains = {};
    let density = 0;
    for (const { extensions } of document.meshes) {
        const own = extensions?.[NAME];
        if (!own) continue;
        const files = own.lods.map((lod) => join(dirname(path), decodeURIComponent(lod.path)));
        const levels = files.map((file) => indices(documentOf(file), own.guid));
        chains[own.guid] = [...levels, indices(document, own.guid)];
        density = Math.max(density, ...own.lods[0].densities);
    }
    const widths = (document.textures ?? []).map(({ extensions }) => extensions?.[NAME]?.lods[0].width);
    return { chains, density, width: Math.max(0, ...widths.filter(Boolean)) };
}

// Levels of each primitive, view after view.
function levelsOf(views) {
    return views[0].primitives.map((_, i) => views.map(({ primitives }) => primitives[i].level));
}

function faultsOf({ looks }, { chains, width }) {
    const faults = [];
    const all = looks.find(({ name }) => name === 'all');
    for (const { name, primitives } of looks) {
        for (const { guid, level, primitive, indices, hasNormals, isFlat } of primitives) {
            const has = chains[guid]?.[level]?.[primitive];
            const what = `${name}: level ${level} of primitive ${primitive}`;
            if (has !== indices) faults.push(`${what} has ${indices} indices, its file ${has}`);
            if (hasNormals && isFlat) faults.push(`${what} is flat, but has normals`);
        }
    }
    const nearer = levelsOf(looks.slice(0, -1));
    for (const [i, levels] of nearer.entries()) {
        const finer = levels.every((level, k) => k === 0 || level <= levels[k - 1]);
        if (!finer || levels.at(-1) !== 0) faults.push(`primitive ${i}: levels ${levels} from far to near`);
    }
    if (!levelsOf(looks.slice(-2)).some(([near, back]) => back > near)) faults.push('back is no coarser');
    const seen = new Set(nearer.flat());
    if (seen.size < 3) faults.push(`only ${seen.size} levels are seen`);
    const widest = Math.max(0, ...Object.values(all.textures));
    if (widest !== width) faults.push(`textures are at most ${widest} pixels wide, not ${width}`);
    if (all.covered < 0.02) faults.push('the picture is empty');
    return faults;
}

let folder = '.';
let asked = [];
const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://x').pathname));
    if (path === '/') return response.writeHead(200, { 'Content-Type': 'text/html' }).end(PAGE);
    if (path === '/favicon.ico') return response.writeHead(204).end();
    const file = path.startsWith('/model/') ? join(folder, path.slice(7)) : join(here, path);
    try {
        const body = readFileSync(file);
        if (path.startsWith('/model/')) asked.push({ path, bytes: body.length });
        const type = { 'Content-Type': TYPES[extname(path)] ?? 'application/octet-stream' };
        return response.writeHead(200, type).end(body);
    } catch {
        return response.writeHead(404).end();
    }
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
const home = `http://127.0.0.1:${server.address().port}`;
const browser = await puppeteer.launch({
    executablePath: chromium,
    args: ['--no-sandbox', '--enable-unsafe-swiftshader'],
});

async function open(file) {
    const of = expected(file);
    folder = dirname(file);
    asked = [];
    const page = await browser.newPage();
    const faults = [];
    page.on('pageerror', (error) => faults.push(String(error)));
    page.on('console', (said) => {
        if (said.type() === 'error') faults.push(said.text());
    });
    // The client looks for decoders of Draco and KTX2 elsewhere; nothing here needs them.
    await page.setRequestInterception(true);
    page.on('request', (request) => {
        if (/^(blob:|data:)/.test(request.url()) || request.url().startsWith(home)) request.continue();
        else request.respond({ status: 200, headers: { 'Access-Control-Allow-Origin': '*' }, body: '' });
    });
    const model = encodeURIComponent(`/model/${encodeURIComponent(basename(file))}`);
    await page.goto(`${home}/?model=${model}&density=${1.5 * of.density}&radii=${RADII}`);
    await page.waitForFunction('window.result !== undefined', { timeout: 120_000 });
    const result = await page.evaluate('window.result');
    await page.close();
    if (result.error) return [...faults, result.error];
    for (const { name, primitives, textures } of result.looks) {
        const levels = primitives.map(({ level }) => level).join(' ');
        const widths = [...new Set(Object.values(textures))].sort((a, b) => a - b).join(' ');
        console.log(`  ${name}: levels ${levels}; textures ${widths || 'none'}`);
    }
    const bytes = asked.reduce((sum, file) => sum + file.bytes, 0);
    console.log(`  ${asked.length} files, ${bytes} bytes; ${asked[0].bytes} before the first picture`);
    return [...faults, ...faultsOf(result, of)];
}

for (const file of args) {
    console.log(file);
    for (const fault of new Set(await open(file))) {
        console.log(`  WRONG: ${fault}`);
        process.exitCode = 1;
    }
}
await browser.close();
server.close();
