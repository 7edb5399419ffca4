/** Checksums of sections: CRC-32 (IEEE), four bytes at a time. */

const TABLES = makeTables();

/** Returns the checksum of bytes. */
export function crc32(bytes: Uint8Array): number {
    const [t0, t1, t2, t3] = TABLES;
    let crc = -1;
    let at = 0;
    for (const end = bytes.length - 3; at < end; at += 4) {
        crc ^= bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) | (bytes[at + 3] << 24);
        crc = t3[crc & 255] ^ t2[(crc >>> 8) & 255] ^ t1[(crc >>> 16) & 255] ^ t0[crc >>> 24];
    }
    for (; at < bytes.length; at++) crc = t0[(crc ^ bytes[at]) & 255] ^ (crc >>> 8);
    return ~crc >>> 0;
}

function makeTables(): [Int32Array, Int32Array, Int32Array, Int32Array] {
    const t0 = new Int32Array(256);
    for (let n = 0; n < 256; n++) {
        let crc = n;
        for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
        t0[n] = crc;
    }
    const after = (table: Int32Array) => table.map((crc) => t0[crc & 255] ^ (crc >>> 8));
    const t1 = after(t0);
    const t2 = after(t1);
    return [t0, t1, t2, after(t2)];
}
