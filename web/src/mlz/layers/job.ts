/** One layer of one block, as its predictor sees it. */

import type { BlockShape } from "../block_shape.ts";
import type { LayerCoder } from "./coder.ts";
import type { LayerFormat } from "./format.ts";
import type { LayerEntries } from "./wedges.ts";

/** A layer that is being decoded into `numbers`, entry by entry. */
export interface LayerJob {
    shape: BlockShape;
    entries: LayerEntries;
    layer: LayerFormat;
    coder: LayerCoder;
    numbers: Int32Array;
}
