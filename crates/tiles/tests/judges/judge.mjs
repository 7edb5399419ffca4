// Opens tilesets in 3DTilesRendererJS and CesiumJS: node judge.mjs [--shots FOLDER] TILESET...,
// where TILESET is a folder. Each client looks from afar, from near, and at everything there is.
// Ends with 1 if one complains, if a request fails, or if tiles are not shown.

import { mkdirSync, readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { browse } from './client.mjs';

const CLIENTS = ['three', 'cesium'];

// Distance from the middle in radii, and error in pixels. From `all` every leaf is shown.
const VIEWS = { far: [20, 1], near: [1.2, 1], all: [2.2, 0] };

// Least part of the picture that the model covers in a view.
const COVERS = { far: 1e-4, near: 0.05, all: 0.05 };

// Number of tiles without children, through all files of a tileset.
function leaves(folder, name = 'tileset.json') {
    const count = ({ content, children = [] }) => {
        if (content?.uri.endsWith('.json')) return leaves(folder, content.uri);
        return children.length === 0 ? 1 : children.reduce((sum, tile) => sum + count(tile), 0);
    };
    return count(JSON.parse(readFileSync(join(folder, name), 'utf8')).root);
}

async function judge(client, folder, shots) {
    const [seen, faults] = [{}, []];
    for (const [view, [from, pixels]] of Object.entries(VIEWS)) {
        seen[view] = await client.look(from, pixels);
        const { tiles, faces, files, bytes, part } = seen[view];
        const covers = `${(100 * part).toFixed(1)} % covered`;
        console.log(`  ${view}: ${tiles} tiles, ${faces} faces, ${files} files, ${bytes} bytes, ${covers}`);
        if (part < COVERS[view]) faults.push(`${view}: the picture is empty`);
        if (shots) await client.shot(`${shots}-${view}.png`);
    }
    if (seen.near.bytes <= seen.far.bytes) faults.push('nothing is refined from near');
    const all = leaves(folder);
    if (seen.all.tiles !== all) faults.push(`${seen.all.tiles} of ${all} leaves are shown`);
    return faults;
}

const [option, into, ...others] = process.argv.slice(2);
const folders = option === '--shots' ? others : process.argv.slice(2);
if (option === '--shots') mkdirSync(into, { recursive: true });
if (folders.length === 0) {
    console.error('usage: node judge.mjs [--shots FOLDER] TILESET...');
    process.exit(2);
}
const browser = await browse(folders);
for (const [of, folder] of folders.entries()) {
    for (const name of CLIENTS) {
        console.log(`${folder} in ${name}`);
        const client = await browser.open(name, of);
        const shots = option === '--shots' ? join(into, `${basename(folder)}-${name}`) : undefined;
        const seen = await judge(client, folder, shots).catch(({ message }) => [message]);
        const faults = new Set([...client.faults(), ...seen]);
        for (const fault of faults) console.log(`  WRONG: ${fault}`);
        if (faults.size > 0) process.exitCode = 1;
        await client.close();
    }
}
await browser.close();
