/** Meshes of `.mlz` and `.mlq`, compared with what Rust decodes from the same files. */

import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { decodeMlq } from "../src/mlq/index.ts";
import { decodeMlz } from "../src/mlz/index.ts";
import type { MeshLayer, PackedMesh } from "../src/packed/mesh.ts";
import { conformanceFolder } from "./files.ts";

const DECODERS = { mlq: decodeMlq, mlz: decodeMlz };
type Format = keyof typeof DECODERS;

/** Folder of compressed files, each with an OBJ of what Rust decodes from it. */
const folder = join(conformanceFolder() ?? "", "packed");

function files(format: Format): string[] {
    const names = conformanceFolder() !== null && existsSync(folder) ? readdirSync(folder) : [];
    return names.filter((name) => name.endsWith(`.${format}`));
}

function bytesOf(name: string): Uint8Array<ArrayBuffer> {
    return new Uint8Array(readFileSync(join(folder, name)));
}

/** What an OBJ holds: numbers of each kind of line, and the corners of faces. */
interface Obj {
    v: number[][];
    vt: number[][];
    vn: number[][];
    corners: number[][];
    /** Material of each face that has one. */
    materials: string[];
}

function readObj(path: string): Obj {
    const obj: Obj = { v: [], vt: [], vn: [], corners: [], materials: [] };
    let material: string | null = null;
    for (const line of readFileSync(path, "utf8").split("\n")) {
        const [word, ...rest] = line.trim().split(/\s+/);
        if (word === "v" || word === "vt" || word === "vn") obj[word].push(rest.map(Number));
        if (word === "usemtl") material = rest.join(" ");
        if (word === "f" && material !== null) obj.materials.push(material);
        if (word === "f")
            for (const corner of rest) obj.corners.push(corner.split("/").map(Number));
    }
    return obj;
}

/** Compares the values of all corners with lines of an OBJ. */
function compareLayer(
    { layers, corners }: NonNullable<PackedMesh["wedges"]>,
    kind: MeshLayer["kind"],
    wanted: (corner: number) => number[],
    lines: number,
): void {
    const layer = layers.find((layer) => layer.kind === kind && layer.set === 0);
    assert.equal(layer !== undefined, lines > 0, kind);
    if (!layer) return;
    corners.forEach((wedge, corner) => {
        const own = layer.values.subarray(layer.width * wedge, layer.width * (wedge + 1));
        const line = wanted(corner).slice(0, layer.width).map(Math.fround);
        line.forEach((x, k) => {
            if (x !== own[k]) assert.fail(`${kind} of corner ${corner}: ${own[k]}, not ${x}`);
        });
    });
}

/** Returns a mesh with its faces object by object, as an OBJ has them. */
function byObject(mesh: PackedMesh): PackedMesh {
    const { faces, wedges, materials, objects } = mesh;
    if (!objects) return mesh;
    const { ofFace } = objects;
    const order = [...ofFace.keys()].sort((a, b) => ofFace[a] - ofFace[b]);
    const sorted = (of: Uint32Array, width: number) =>
        of.map((_, i) => of[width * order[Math.floor(i / width)] + (i % width)]);
    return {
        ...mesh,
        faces: sorted(faces, 3),
        wedges: wedges && { ...wedges, corners: sorted(wedges.corners, 3) },
        materials: materials && { ...materials, ofFace: sorted(materials.ofFace, 1) },
    };
}

function compare(decoded: PackedMesh, obj: Obj): void {
    const mesh = byObject(decoded);
    assert.equal(mesh.positions.length, 3 * obj.v.length, "vertices");
    assert.equal(mesh.faces.length, obj.corners.length, "corners");
    // An OBJ of a scene has its vertices in the order of its faces.
    const lineOf = new Map<number, number>();
    mesh.faces.forEach((vertex, corner) => {
        const line = obj.corners[corner][0] - 1;
        if ((lineOf.get(vertex) ?? line) !== line) assert.fail(`corner ${corner}`);
        lineOf.set(vertex, line);
    });
    assert.equal(new Set(lineOf.values()).size, obj.v.length, "vertices of faces");
    for (const [vertex, line] of lineOf) {
        for (let k = 0; k < 3; k++) {
            const [own, wanted] = [mesh.positions[3 * vertex + k], obj.v[line][k]];
            if (own !== wanted) assert.fail(`vertex ${vertex}: ${own}, not ${wanted}`);
        }
    }
    const { materials } = mesh;
    const names = materials ? [...materials.ofFace].map((label) => materials.names[label]) : [];
    assert.deepEqual(names, obj.materials, "materials");
    if (!mesh.wedges) return assert.equal(obj.vt.length + obj.vn.length, 0);
    compareLayer(mesh.wedges, "uv", (at) => obj.vt[obj.corners[at][1] - 1], obj.vt.length);
    // An OBJ has the colours of vertices behind their coordinates.
    const colors = obj.v[0].length > 3 ? obj.v.length : 0;
    compareLayer(mesh.wedges, "color", (at) => obj.v[obj.corners[at][0] - 1].slice(3), colors);
    compareLayer(mesh.wedges, "normal", (at) => obj.vn[obj.corners[at][2] - 1], obj.vn.length);
}

const skip = conformanceFolder() === null;
test("compressed files of every scheme are there", { skip }, () => {
    assert.ok(files("mlz").length >= 3 && files("mlq").length >= 12);
});

for (const format of Object.keys(DECODERS) as Format[]) {
    for (const name of files(format)) {
        test(`${name} is the mesh that Rust decodes`, () => {
            compare(DECODERS[format](bytesOf(name)), readObj(join(folder, `${name}.obj`)));
        });
    }
}
