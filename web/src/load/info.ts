/** What is known of a file once it has been opened. */

import type { FieldModel } from "../field/field_model.ts";
import type { Model } from "../model.ts";
import type { FileInfo } from "./messages.ts";

/** Returns what is known of levels by contractions. */
export function infoOf({ header, frame, wedges }: Model): FileInfo {
    return {
        kind: "contractions",
        center: [...frame.origin],
        diagonal: header.diagonal,
        length: header.length,
        chunks: header.chunks.length,
        hasScene: header.resources.length > 0,
        layers:
            wedges?.layers.map(({ kind, set, name, width }) => ({ kind, set, name, width })) ?? [],
        materials: wedges?.materials ?? null,
        pairs: wedges?.pairs ?? null,
    };
}

/** Returns what is known of a height field with a number of parts. */
export function fieldInfoOf({ frame }: FieldModel, length: number, parts: number): FileInfo {
    return {
        kind: "height field",
        center: [...frame.origin],
        diagonal: frame.unit,
        length,
        chunks: parts,
        hasScene: false,
        layers: [],
        materials: null,
        pairs: null,
    };
}
