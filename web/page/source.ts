/** Where the page finds its models: in itself, or in the folder that is served. */

/** A file that the server has. */
export interface ListedFile {
    path: string;
    bytes: number;
}

/** Places of the server that are no files of its folder: hidden files are not served. */
const FILES = ".meshlod/files.json";
export const FORMATS = ".meshlod/formats.js";

/** Returns the model that is in the page, or null. */
export function modelInPage(): { name: string; bytes: Uint8Array } | null {
    const script = document.getElementById("model");
    if (!script) return null;
    const text = script.textContent ?? "";
    const bytes = bytesOf(text.trim());
    script.remove();
    return { name: script.dataset.name ?? "model.mlod", bytes };
}

const STEP = 1 << 20;

/** Decodes base64, a piece at a time. */
export function bytesOf(text: string): Uint8Array {
    const padding = text.endsWith("==") ? 2 : text.endsWith("=") ? 1 : 0;
    const bytes = new Uint8Array((text.length / 4) * 3 - padding);
    for (let at = 0; at < text.length; at += STEP) {
        const piece = atob(text.slice(at, at + STEP));
        const start = (at / 4) * 3;
        for (let i = 0; i < piece.length; i++) bytes[start + i] = piece.charCodeAt(i);
    }
    return bytes;
}

/** Lists the files that the server has. */
export async function listFiles(): Promise<ListedFile[]> {
    const response = await fetch(FILES);
    if (!response.ok) throw new Error(`the server answers ${response.status}`);
    return (await response.json()) as ListedFile[];
}

/** Returns the address of a file by its path in the folder. */
export function addressOf(path: string): string {
    const parts = path.split("/").map(encodeURIComponent);
    return new URL(parts.join("/"), location.href.split("#")[0]).href;
}

/** Returns a number of bytes in words. */
export function size(bytes: number): string {
    const units = ["B", "kB", "MB", "GB"];
    let [value, unit] = [bytes, 0];
    while (value >= 999.5 && unit < 3) [value, unit] = [value / 1000, unit + 1];
    return `${unit === 0 || value >= 99.5 ? Math.round(value) : value.toPrecision(2)} ${units[unit]}`;
}
