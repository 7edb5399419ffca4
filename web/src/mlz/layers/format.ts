/** What the header says of attributes, materials and objects. */

import { readLayerCoding } from "../../packed/layer_coding.ts";
import type { LayerCoding } from "../../packed/layer_coding.ts";
import { BitReader } from "../../packed/reader.ts";
import type { ByteReader } from "../../packed/reader.ts";
import { residualTable } from "../tables.ts";
import type { ResidualTable } from "../tables.ts";

/** Mode of a layer of directions that do not follow the surface. */
export const BY_NEIGHBOURS = 128;
const MOST_NUMBER = 2 ** 26;
const MOST_VALUES = 1023;

/** Numbers of contexts: of wedges, of entries, of labels; of residuals of directions and others. */
const WEDGE_BITS = 33;
export const ENTRY_BITS = 3;
const LABEL_BITS = 3;
const DIRECTION_RESIDUALS = 96;
const OTHER_RESIDUALS = 64;

/** How the values of a layer are predicted. */
export type Predictor = "normals" | "tangents" | "uvs" | "values";

const MODES: Record<Predictor, readonly number[]> = {
    normals: [0, 1, 2, 12, 13, 14, 24, 25, 26, BY_NEIGHBOURS],
    tangents: [0, 4, 8, BY_NEIGHBOURS],
    uvs: [0, 2, 4, 6, 8],
    values: [0, 1, 2, 3],
};

/** A layer of a file. */
export interface LayerFormat {
    coding: LayerCoding;
    predictor: Predictor;
    mode: number;
    /** Greatest integer of each component. */
    most: number[];
    /** Its first contexts of bits and of residuals. */
    bits: number;
    residuals: number;
}

/** Distribution of the residuals of a context. */
export interface ResidualModel {
    table: ResidualTable;
    lowBits: number;
}

/** What blocks have besides positions and faces, and the tables by which it is coded. */
export interface LayersFormat {
    layers: LayerFormat[];
    /** Names of materials, and of objects, with their first contexts. */
    labels: { names: string[] | null; bits: number }[];
    /** For each context of bits the slots of a 0, of 4096. */
    chances: Uint16Array;
    models: ResidualModel[];
}

/** Reads what the header says of layers. */
export function readLayersFormat(reader: ByteReader): LayersFormat {
    const count = reader.u8();
    const layers: LayerFormat[] = [];
    let bits = count > 0 ? WEDGE_BITS : 0;
    let residuals = 0;
    for (let i = 0; i < count; i++) {
        const layer = readLayer(reader, bits, residuals);
        layers.push(layer);
        const { predictor } = layer;
        bits += ENTRY_BITS + (predictor === "values" ? 4 : predictor === "tangents" ? 3 : 0);
        const isDirection = layer.coding.directionBits !== null;
        residuals += isDirection ? DIRECTION_RESIDUALS : OTHER_RESIDUALS;
    }
    const width = layers.reduce((sum, { coding }) => sum + coding.width, 0);
    reader.must(width <= MOST_VALUES, `a wedge has more than ${MOST_VALUES} values`);
    const labels = [0, 1].map((kind) => ({
        names: reader.names(),
        bits: bits + kind * LABEL_BITS,
    }));
    return { layers, labels, ...readTables(reader, bits + 2 * LABEL_BITS, residuals) };
}

function readLayer(reader: ByteReader, bits: number, residuals: number): LayerFormat {
    const coding = readLayerCoding(reader);
    const mode = reader.u8();
    const { directionBits, components, kind } = coding;
    const most = Array.from({ length: components }, () =>
        directionBits === null ? reader.u32() : 2 ** directionBits - 1,
    );
    const isSmall = most.every((number) => number <= MOST_NUMBER);
    reader.must(isSmall, "a layer has integers of more than 26 bits");
    const names: Partial<Record<typeof kind, Predictor>> = {
        normal: "normals",
        tangent: "tangents",
        uv: "uvs",
    };
    const predictor = names[kind] ?? "values";
    reader.must(MODES[predictor].includes(mode), `a layer has the unknown mode ${mode}`);
    return { coding, predictor, mode, most, bits, residuals };
}

/** Reads the codes of all contexts. */
function readTables(reader: ByteReader, bits: number, residuals: number) {
    const source = new BitReader(reader);
    const chances = new Uint16Array(bits);
    for (let i = 0; i < bits; i++) chances[i] = chanceOf(source.take(1) ? source.take(5) : 0);
    const known = new Map<number, ResidualModel>();
    const models: ResidualModel[] = [];
    for (let i = 0; i < residuals; i++) {
        const code = source.take(1) ? source.take(9) : 0;
        let model = known.get(code);
        if (!model) known.set(code, (model = modelOf(code & 63, code >> 6)));
        models.push(model);
    }
    return { chances, models };
}

/** Returns the slots of a 0 that a code stands for. */
function chanceOf(code: number): number {
    const halvings = 1 + ((code & 15) >> 1);
    const rare = Math.max((code & 1 ? 2896 : 4096) >> halvings, 8);
    return code < 16 ? 4096 - rare : rare;
}

function modelOf(width: number, freedom: number): ResidualModel {
    const lowBits = Math.max((width >> 2) - 3, 0);
    return { table: residualTable(width - 4 * lowBits, (freedom << 5) | 16), lowBits };
}
