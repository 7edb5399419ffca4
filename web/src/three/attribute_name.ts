/** Names of attributes in three.js. */

import type { LayerKind } from "../wedges/layer.ts";

/** Returns the name by which three.js knows a layer, or null. */
export function attributeName(kind: LayerKind, set: number): string | null {
    if (kind === "uv") return set === 0 ? "uv" : `uv${set}`;
    if (kind === "normal" || kind === "tangent") return kind;
    if (set > 0) return null;
    return {
        color: "color",
        joints: "skinIndex",
        weights: "skinWeight",
        other: null,
        labels: null,
    }[kind];
}
