/** Directions on the unfolded octahedron, and the plane around its square of codes. */

type Writable = { [at: number]: number };

/** Writes the direction of a code whose greatest coordinate is `last`. */
export function unfold(i: number, j: number, last: number, to: Writable, at: number): void {
    let x = (i / last) * 2 - 1;
    let y = (j / last) * 2 - 1;
    const z = 1 - Math.abs(x) - Math.abs(y);
    const over = Math.max(-z, 0);
    x -= x < 0 || Object.is(x, -0) ? -over : over;
    y -= y < 0 || Object.is(y, -0) ? -over : over;
    const scale = 1 / Math.sqrt(x * x + y * y + z * z);
    to[at] = x * scale;
    to[at + 1] = y * scale;
    to[at + 2] = z * scale;
}

/** Writes the place of a direction of any length but 0 in the plane of codes. */
export function project(x: number, y: number, z: number, last: number, to: Writable): void {
    const sum = Math.abs(x) + Math.abs(y) + Math.abs(z);
    x /= sum;
    y /= sum;
    z /= sum;
    let u = x;
    let v = y;
    if (!(z >= 0)) {
        u = withSign(1 - Math.abs(y), x);
        v = withSign(1 - Math.abs(x), y);
    }
    to[0] = ((u + 1) / 2) * last;
    to[1] = ((v + 1) / 2) * last;
}

function withSign(x: number, sign: number): number {
    return (sign < 0 || Object.is(sign, -0)) === (x < 0 || Object.is(x, -0)) ? x : -x;
}

/**
 * The square of codes, and all places around it; crossing an edge turns it by half about the
 * middle.
 */
export class OctahedralPlane {
    constructor(readonly last: number) {}

    /** Writes the place of a code that is nearest to another place. */
    near(x: number, y: number, toX: number, toY: number, out: Writable): void {
        const { last } = this;
        const quarter = Math.floor(last / 4);
        const isInside = Math.min(toX, toY) >= quarter && Math.max(toX, toY) <= last - quarter;
        out[0] = x;
        out[1] = y;
        let best = squared(toX - x, toY - y);
        if (isInside && best <= quarter * quarter) return;
        const consider = (u: number, v: number) => {
            const away = squared(toX - u, toY - v);
            if (away >= best) return;
            best = away;
            out[0] = u;
            out[1] = v;
        };
        consider(-x, last - y);
        consider(2 * last - x, last - y);
        consider(last - x, -y);
        consider(last - x, 2 * last - y);
        consider(x - last, y - last);
        consider(x - last, y + last);
        consider(x + last, y - last);
        consider(x + last, y + last);
    }

    /** Writes the code at a place. */
    code(x: number, y: number, out: Writable): void {
        const { last } = this;
        x = Math.min(Math.max(x, -2 * last), 3 * last);
        y = Math.min(Math.max(y, -2 * last), 3 * last);
        for (let turn = 0; turn < 6; turn++) {
            if (x < 0) [x, y] = [-x, last - y];
            else if (x > last) [x, y] = [2 * last - x, last - y];
            else if (y < 0) [x, y] = [last - x, -y];
            else if (y > last) [x, y] = [last - x, 2 * last - y];
            else if ((x === 0 || x === last) && 2 * y > last) y = last - y;
            else if ((y === 0 || y === last) && 2 * x > last) x = last - x;
            else break;
        }
        out[0] = Math.min(Math.max(x, 0), last);
        out[1] = Math.min(Math.max(y, 0), last);
    }
}

/** Exact for places of codes; only damaged files have others. */
function squared(x: number, y: number): number {
    return x * x + y * y;
}
