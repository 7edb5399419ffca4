/** The wedges of a chunk: how many, which faces have them, their labels and residuals. */

import { must } from "../error.ts";
import { NumberModels } from "../file/number_models.ts";
import { RangeDecoder } from "../file/range_coder.ts";
import type { Streams } from "../file/streams.ts";
import { NONE, RECORDED } from "../model.ts";
import type { Model } from "../model.ts";
import { Family } from "./family.ts";
import { ResidualModels } from "./residuals.ts";
import { LOST, SplitRecord } from "./split_record.ts";
import type { Wedges } from "./wedges.ts";

/** Greatest number of faces that an update creates. */
const MOST_CREATED = 2;

/**
 * Reads the wedges of the updates from `start` on, given their flags and the classes of their
 * sizes.
 */
export function readChunkWedges(
    model: Model,
    start: number,
    flags: Uint8Array,
    sizes: Uint8Array,
    input: Streams,
): void {
    const wedges = model.wedges as Wedges;
    const before = wedges.count;
    const recorded: number[] = [];
    flags.forEach((flag, i) => flag & RECORDED && recorded.push(start + i));
    appendNodes(wedges, start, flags, recorded, input);
    readRecords(model, wedges, recorded, input);
    const family = new Family(model, wedges);
    if (wedges.pairs.length > 2) readLabels(wedges, family, start, flags.length, input);
    else checkFamilies(family, start, flags.length);
    wedges.checkLabels(before);
    const decoder = new RangeDecoder(input.coded((wedges.count - before) * wedges.columns));
    const models = new ResidualModels(wedges.layers);
    const { rows, columns } = wedges;
    for (let i = 0; i < flags.length; i++) {
        family.gather(start + i);
        family.inCodingOrder((wedge, role) =>
            models.decode(decoder, role, sizes[i], rows, wedge * columns),
        );
    }
    must(decoder.isAtEnd, "it has more attribute values than wedges");
}

function appendNodes(
    wedges: Wedges,
    start: number,
    flags: Uint8Array,
    recorded: number[],
    input: Streams,
): void {
    const listed = input.numbers(2 * recorded.length);
    const counts = new Uint32Array(2 * flags.length).fill(1);
    recorded.forEach((update, i) => {
        counts[2 * (update - start)] = listed[2 * i];
        counts[2 * (update - start) + 1] = listed[2 * i + 1];
    });
    wedges.append(counts);
}

function readRecords(model: Model, wedges: Wedges, recorded: number[], input: Streams): void {
    const lengths = input.numbers(recorded.length);
    const faces = recorded.map((update) => model.createdCount(update));
    const counts = recorded.map((update) => {
        const first = model.firstChild(update);
        return [wedges.countOf(first), wedges.countOf(first + 1)];
    });
    let all = 0;
    lengths.forEach(
        (more, i) => (all += lengths[i] = more + counts[i][0] + counts[i][1] + faces[i]),
    );
    must(all < 2 ** 32, "a record is too long");
    const decoder = new RangeDecoder(input.coded(all));
    const models = new NumberModels();
    recorded.forEach((update, i) => {
        const [first, second] = counts[i];
        const numbers = readRecord(decoder, models, lengths[i], first, second);
        wedges.records.set(update, new SplitRecord(numbers, first + second, faces[i]));
    });
    must(decoder.isAtEnd, "it has longer records than updates");
}

/** Decodes a record of which the children have `first` and `second` wedges. */
function readRecord(
    decoder: RangeDecoder,
    models: NumberModels,
    length: number,
    first: number,
    second: number,
): Uint16Array {
    const parents = first + second;
    const others = length > parents + MOST_CREATED ? 1 : 2;
    const shape = 4 * (Math.min(first, 4) - 1) + Math.min(second, 4) - 1;
    const record = new Uint16Array(length);
    let [last, other] = [0, 0];
    for (let at = 0; at < length; at++) {
        const size = 16 * Math.min(last, 2) + shape;
        const near = 4 * Math.min(last, 3) + Math.min(other, 3);
        const number = models.decode(decoder, at < parents ? 0 : others, size, near);
        must(number >= 0 && number <= LOST, "a wedge is out of range");
        record[at] = number;
        other = last;
        last = number;
    }
    return record;
}

/** Reads the pairs of wedges without a parent; others have their parent's. */
function readLabels(
    wedges: Wedges,
    family: Family,
    start: number,
    count: number,
    input: Streams,
): void {
    const each = (visit: (i: number) => void) => {
        for (let update = start; update < start + count; update++) {
            family.gather(update);
            for (let i = 0; i < family.count; i++) visit(i);
        }
    };
    let lost = 0;
    each((i) => {
        checkParent(family, i);
        lost += Number(family.lost[i]);
    });
    const labels = input.numbers(lost);
    let next = 0;
    each((i) => {
        const label = family.lost[i] ? labels[next++] : wedges.labels[family.parents[i]];
        wedges.labels[family.start + i] = label;
    });
}

function checkFamilies(family: Family, start: number, count: number): void {
    for (let update = start; update < start + count; update++) {
        family.gather(update);
        for (let i = 0; i < family.count; i++) checkParent(family, i);
    }
}

function checkParent(family: Family, i: number): void {
    const parent = family.parents[i];
    must(parent !== NONE && parent < family.start + i, "a wedge is out of range");
}
