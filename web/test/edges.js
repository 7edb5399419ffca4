/** Ends of an edge, as one number, are below 2²⁶. */
const SHIFT = 2 ** 26;

export function openEdges(index, ranges, positions) {
    const places = new Map();
    const placeOf = new Map();
    const vertices = [];
    const place = (vertex) => {
        const known = placeOf.get(vertex);
        if (known !== undefined) return known;
        const key = `${positions[3 * vertex]} ${positions[3 * vertex + 1]} ${positions[3 * vertex + 2]}`;
        let number = places.get(key);
        if (number === undefined) {
            places.set(key, (number = vertices.length));
            vertices.push(vertex);
        }
        placeOf.set(vertex, number);
        return number;
    };
    // Of an edge and its opposite one goes upwards.
    const corners = ranges.reduce((sum, { count }) => sum + count, 0);
    const [up, down] = [new Float64Array(corners), new Float64Array(corners)];
    let [ups, downs] = [0, 0];
    for (const { start, count } of ranges) {
        for (let at = start; at < start + count; at += 3) {
            const face = [0, 1, 2].map((k) => place(index[at + k]));
            for (let k = 0; k < 3; k++) {
                const [a, b] = [face[k], face[(k + 1) % 3]];
                if (a < b) up[ups++] = a * SHIFT + b;
                else if (a > b) down[downs++] = b * SHIFT + a;
            }
        }
    }
    const [upward, downward] = [up.subarray(0, ups).sort(), down.subarray(0, downs).sort()];
    const open = [];
    const ends = (key) => [vertices[Math.floor(key / SHIFT)], vertices[key % SHIFT]];
    for (let i = 0, j = 0; i < ups || j < downs;) {
        const [a, b] = [upward[i] ?? Infinity, downward[j] ?? Infinity];
        if (a <= b) i++;
        if (b <= a) j++;
        if (a < b) open.push(ends(a));
        else if (b < a) open.push(ends(b).reverse());
    }
    return open;
}

const NONE = 0xffffffff;

/** Returns the place of a vertex as a text, in the precision of GPUs. */
export function placeOf(positions, at) {
    return [0, 1, 2].map((k) => Math.fround(positions[at + k])).join(" ");
}

export function borderOf(model, { nodes, slots }) {
    const index = nodes.subarray(0, 3 * slots).filter((node) => node !== NONE);
    // Nodes at one place are told apart, as far as levels are.
    const apart = Float64Array.from({ length: 3 * model.nodes }, (_, at) => Math.floor(at / 3));
    const border = new Set();
    const point = new Float64Array(3);
    const isAdded = new Uint8Array(model.nodes);
    for (let [node] of openEdges(index, [{ start: 0, count: index.length }], apart)) {
        while (isAdded[node] === 0) {
            isAdded[node] = 1;
            model.position(node, point);
            border.add(placeOf(point, 0));
            if (node >= model.roots) node = model.parents[model.creator(node)];
        }
    }
    return border;
}
