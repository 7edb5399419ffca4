/** Files for tests: the one that the specification lists, and those that Rust has made. */

import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { crc32 } from "../src/file/crc32.ts";
import { readHeader } from "../src/file/header.ts";

/** Returns the file that docs/formats/mlod.md lists byte by byte. */
export function vectorFile(): Uint8Array<ArrayBuffer> {
    const page = readFileSync(join(process.cwd(), rootOf(), "docs/formats/mlod.md"), "utf8");
    const section = page.slice(page.indexOf("## A test vector"));
    const listing = section.slice(section.indexOf("```text") + 8, section.indexOf("\n```\n"));
    const digits = listing
        .split("\n")
        .map((line) => line.slice(5).replaceAll(" ", ""))
        .join("");
    return new Uint8Array(Buffer.from(digits, "hex"));
}

/** The tests run in `web` or in the root of the project. */
function rootOf(): string {
    return existsSync("docs/formats/mlod.md") ? "." : "..";
}

/** Returns the folder of files that `web_conformance` has made, or null. */
export function conformanceFolder(): string | null {
    return process.env.MLOD_CONFORMANCE ?? null;
}

/** Returns the names of the files there, without their endings. */
export function conformanceNames(): string[] {
    const folder = conformanceFolder();
    const names = folder === null ? [] : readdirSync(folder);
    return names.filter((name) => name.endsWith(".json")).map((name) => name.slice(0, -5));
}

/** Returns a file of the folder. */
export function conformanceFile(name: string): Uint8Array<ArrayBuffer> {
    return new Uint8Array(readFileSync(join(conformanceFolder() ?? "", `${name}.mlod`)));
}

/** Makes the checksums of a file right again after it has been changed. */
export function rewriteChecksums(file: Uint8Array): void {
    const view = new DataView(file.buffer, file.byteOffset);
    const seal = (length: number) => view.setUint32(12, crc32(file.subarray(16, length)), true);
    const chunks = 88 + 44 * view.getUint32(36, true);
    if (chunks > file.length) return;
    seal(chunks);
    const header = readHeader(file);
    const { base } = header;
    view.setUint32(32, crc32(file.subarray(base.at, base.at + base.length)), true);
    header.chunks.forEach((chunk, i) => {
        const bytes = file.subarray(chunk.at, chunk.at + chunk.length);
        view.setUint32(88 + 44 * i + 4, crc32(bytes), true);
    });
    seal(chunks);
}
