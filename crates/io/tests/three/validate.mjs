// Validates every glTF file of a folder with the validator of Khronos: node validate.mjs FOLDER.
// Ends with 1 on any error. Of arrays in meshopt streams the validator checks the outlines alone.

import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { validateBytes } from 'gltf-validator';

const folder = process.argv[2];
const options = {
    maxIssues: 0, // no limit
    externalResourceFunction: async (uri) =>
        new Uint8Array(readFileSync(join(folder, decodeURIComponent(uri)))),
};

const files = readdirSync(folder).filter((name) => /\.(glb|gltf)$/.test(name)).sort();
if (files.length === 0) {
    console.error(`${folder}: no files to validate`);
    process.exitCode = 1;
}
for (const name of files) {
    const bytes = new Uint8Array(readFileSync(join(folder, name)));
    const { issues } = await validateBytes(bytes, options);
    const { numErrors, numWarnings } = issues;
    console.log(`${name}: ${numErrors} errors, ${numWarnings} warnings`);
    if (numErrors > 0) process.exitCode = 1;
    const errors = issues.messages.filter(({ severity }) => severity === 0);
    errors.slice(0, 5).forEach(({ pointer, message }) => console.error(`  ${pointer}: ${message}`));
}
