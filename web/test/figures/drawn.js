// What is drawn: buffers as the GPU has them, and which triangles cover a pixel by arithmetic.

/** Vertices are rounded to so many parts of a pixel before triangles are filled. */
const PARTS = 16;

/** Returns the index and the positions that the last call of WebGL drew from. */
export function readBack(gl) {
    const program = gl.getParameter(gl.CURRENT_PROGRAM);
    const location = gl.getAttribLocation(program, "position");
    const position = gl.getVertexAttrib(location, gl.VERTEX_ATTRIB_ARRAY_BUFFER_BINDING);
    const size = gl.getBufferParameter(gl.ELEMENT_ARRAY_BUFFER, gl.BUFFER_SIZE);
    const index = new Uint32Array(size / 4);
    gl.getBufferSubData(gl.ELEMENT_ARRAY_BUFFER, 0, index);
    gl.bindBuffer(gl.COPY_READ_BUFFER, position);
    const length = gl.getBufferParameter(gl.COPY_READ_BUFFER, gl.BUFFER_SIZE);
    const positions = new Float32Array(length / 4);
    gl.getBufferSubData(gl.COPY_READ_BUFFER, 0, positions);
    gl.bindBuffer(gl.COPY_READ_BUFFER, null);
    return { index, positions };
}

/**
 * Counts the triangles that cover the middle of each pixel: those that face the camera, those that
 * face away, and of the first those that still do with vertices rounded as GPUs round them.
 *
 * Homogeneous coordinates throughout, so that triangles which reach behind the camera count, too.
 */
export function coverage(pixels, { index, ranges, positions }, { matrix, width, height }) {
    const window = windowPoints(positions, matrix, width, height);
    const counts = pixels.map(() => ({ front: 0, back: 0, rounded: 0 }));
    for (const { start, count } of ranges) {
        for (let at = start; at < start + count; at += 3) {
            const corners = [0, 1, 2].map((k) => {
                const from = 3 * index[at + k];
                return [window[from], window[from + 1], window[from + 2]];
            });
            const determinant = dot(corners[0], cross(corners[1], corners[2]));
            if (determinant === 0) continue;
            pixels.forEach((pixel, i) => {
                const middle = [(pixel % width) + 0.5, Math.floor(pixel / width) + 0.5, 1];
                if (!covers(corners, middle)) return;
                if (determinant < 0) counts[i].back++;
                else counts[i].front++;
                if (determinant > 0 && covers(corners.map(rounded), middle)) counts[i].rounded++;
            });
        }
    }
    return counts;
}

/** Returns x, y and the depth of each vertex, the first two in pixels times the depth. */
function windowPoints(positions, matrix, width, height) {
    const points = new Float64Array(positions.length);
    const row = (k, x, y, z) =>
        matrix[k] * x + matrix[k + 4] * y + matrix[k + 8] * z + matrix[k + 12];
    for (let at = 0; at < positions.length; at += 3) {
        const [x, y, z] = [positions[at], positions[at + 1], positions[at + 2]];
        const depth = row(3, x, y, z);
        points[at] = 0.5 * width * (row(0, x, y, z) + depth);
        points[at + 1] = 0.5 * height * (row(1, x, y, z) + depth);
        points[at + 2] = depth;
    }
    return points;
}

/** Returns true if a point is in a triangle, before the camera. */
function covers([a, b, c], point) {
    const determinant = dot(a, cross(b, c));
    return [cross(b, c), cross(c, a), cross(a, b)].every(
        (side) => dot(side, point) / determinant >= 0,
    );
}

function rounded([x, y, depth]) {
    if (depth <= 0) return [x, y, depth];
    return [x, y]
        .map((along) => (Math.round((along / depth) * PARTS) / PARTS) * depth)
        .concat(depth);
}

function cross(a, b) {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function dot(a, b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
