/** The adaptive coder: bits, each with the mean of two models that learn from those before. */

const MOST_SEEN = 120;
const LEAST_PROBABILITY = 64;

/** Models of bits: the probability of a 1, of 2¹⁶, and how many bits each has seen. */
export class BitModels {
    readonly probabilities: Uint16Array;
    readonly seen: Uint8Array;

    constructor(count: number) {
        this.probabilities = new Uint16Array(count).fill(1 << 15);
        this.seen = new Uint8Array(count);
    }

    private learn(at: number, bit: number): void {
        const { probabilities, seen } = this;
        const before = probabilities[at];
        const twice = 2 * seen[at] + 3;
        if (bit) probabilities[at] = before + (((2 * (65535 - before)) / twice) | 0);
        else probabilities[at] = before - (((2 * before) / twice) | 0);
        if (seen[at] < MOST_SEEN) seen[at]++;
    }

    /** Decodes a bit by two models. */
    bit(decoder: RangeDecoder, a: number, b: number): number {
        const { probabilities } = this;
        const mean = (probabilities[a] + probabilities[b]) >> 1;
        const part = Math.min(Math.max(mean, LEAST_PROBABILITY), 65536 - LEAST_PROBABILITY);
        const bit = decoder.split(part);
        this.learn(a, bit);
        this.learn(b, bit);
        return bit;
    }
}

/** Reads the bits of a stream, and zeros behind its end. */
export class RangeDecoder {
    private at = 0;
    private range = 0xffffffff;
    private code = 0;

    constructor(private readonly bytes: Uint8Array) {
        for (let i = 0; i < 4; i++) this.next();
    }

    private next(): void {
        const byte = this.at < this.bytes.length ? this.bytes[this.at] : 0;
        this.code = ((this.code << 8) | byte) >>> 0;
        this.at++;
    }

    /** Decodes a bit of which a 1 has a part of 2¹⁶. */
    split(part: number): number {
        const split = (this.range >>> 16) * part;
        const bit = this.code < split ? 1 : 0;
        if (bit) {
            this.range = split;
        } else {
            this.code -= split;
            this.range -= split;
        }
        this.widen();
        return bit;
    }

    /** Decodes bits that are all equally likely. */
    plain(count: number): number {
        let number = 0;
        for (let i = 0; i < count; i++) {
            const half = this.range >>> 1;
            // The last number of an odd range is never written.
            const code = Math.min(this.code, 2 * half - 1);
            const bit = code >= half ? 1 : 0;
            this.code = bit ? code - half : code;
            this.range = half;
            this.widen();
            number = (number << 1) | bit;
        }
        return number >>> 0;
    }

    private widen(): void {
        while (this.range < 0x1000000) {
            this.range = (this.range << 8) >>> 0;
            this.next();
        }
    }

    /** True if no byte is left. */
    get isAtEnd(): boolean {
        return this.at >= this.bytes.length;
    }
}
