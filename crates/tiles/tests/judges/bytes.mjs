// Prints the bytes that 3DTilesRendererJS loads of tilesets: node bytes.mjs TILESET..., each a
// folder. For each as JSON: the bytes of `tileset.json` and contents for each distance of the camera
// from the middle, in radii, and each error in pixels, of pictures of 512 by 512.

import { browse } from './client.mjs';

const DISTANCES = [6, 2, 1];
const PIXELS = [16, 4, 1];

const folders = process.argv.slice(2);
const browser = await browse(folders);
const rows = [];
for (const of of folders.keys()) {
    for (const distance of DISTANCES) {
        for (const pixels of PIXELS) {
            const client = await browser.open('three', of);
            const { bytes, tiles } = await client.look(distance, pixels, false);
            const faults = client.faults();
            if (faults.length > 0) throw new Error(`${folders[of]}: ${faults[0]}`);
            rows.push({ tileset: of, distance, pixels, tiles, bytes });
            await client.close();
        }
    }
}
await browser.close();
console.log(JSON.stringify(rows));
