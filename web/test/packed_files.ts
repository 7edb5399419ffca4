/** Quads of two faces with texture coordinates, as `compress --bits 6` writes them. */

import { crc32 } from "../src/file/crc32.ts";
import { headerSumOf, readMlzHeader } from "../src/mlz/header.ts";
import { ByteReader } from "../src/packed/reader.ts";

const MLZ =
    "bWVzaGxvZHoCAAAATuAT/EpsRKwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAQBEEQBEGQPwAAAAIAAAAEAAAA" +
    "AQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA" +
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACaMxUTFRMVExUTFRMVExUTFRMVExUT" +
    "FRMVExUTFRMVExUTFRMVExUTLE5OTk5OTuBOTk5OTk5O704AAAAAAAAAAAAAAAAAAAAAAAAAAADL/+IDAQEA" +
    "AgAAAAAAAAAAAgB1dvT/AAAAAAAAAAAAABAAAAAQAAAAAAAAAAAAACVKAAAAAHA+AHA+APB+4ABA4IEDAAAA" +
    "AAAAAAAAAAIAAAAACQAAAADlHQQANw9j3/KrDIjuafLArIY=";

/** Returns the quad as `.mlz`. */
export function quadMlz(): Uint8Array<ArrayBuffer> {
    return new Uint8Array(Buffer.from(MLZ, "base64"));
}

/** Returns the number of bytes before the blocks of a file that is whole. */
export function mlzHeaderLength(file: Uint8Array): number {
    const reader = new ByteReader(file);
    readMlzHeader(file, reader);
    return reader.at;
}

/** Makes the checksums of a file right again after it has been changed. */
export function sealMlz(file: Uint8Array, header: number): void {
    const view = new DataView(file.buffer, file.byteOffset);
    view.setUint32(16, crc32(file.subarray(header)), true);
    view.setUint32(12, headerSumOf(file, header), true);
}

/** The quad as `.mlq` in each scheme. */
const MLQ = {
    parts:
        "bWVzaGxvZHEBAAAAAAABACsAAAAAAAAARCHYCRIAAAAAAAAA83Q6ZjUAAAAAAAAAwD1I+W5lONEBBAAA" +
        "AAEAAAAAhIA7AISAOwCEADsEAAAAAAAAAAAAAAAA/v4AAP7+/gAAAgAAAAAAAAACAAAAAAAAAAAAAQAC" +
        "AAAAAAAAAAACAHV29P8AAAAAAAAAAA0NAKABAA0AAAAAAAAAAAAAAABAAAgAACAABAA=",
    strips:
        "bWVzaGxvZHEBAAAAAAQBACsAAAAAAAAARCHYCQwAAAAAAAAAGFMKtjUAAAAAAAAAwD1I+cBwowMBBAAA" +
        "AAEAAAAAhIA7AISAOwCEADsEAAAAAAAAAAAAAAAA/v4AAP7+/gAABAAAAAIAAQMAAAAAAQACAAAAAAAA" +
        "AAACAHV29P8AAAAAAAAAAA0NAKABAA0AAAAAAAAAAAAAAABAAAgAACAABAA=",
    blocks:
        "bWVzaGxvZHEBAAAAAgABAFQAAAAAAAAAl69NBA8AAAAAAAAAhpdPMTUAAAAAAAAAMxwTfoI8D9oEAAAA" +
        "BAAAAAAAAAAAAOA/AAAAAAAA4D8AAAAAAADQP3XXMYRWaEk/CAQCgUAgcD8gEAsACwAoABcAAAAAAAAA" +
        "AAcHCICqsCKJmbwWIM+C8kceAAADAAAAAAAAAAIAAAAAdwABAAIAAAAAAAAAAAIAdXb0/wAAAAAAAAAA" +
        "DQ0AoAEADQAAAAAAAAAAAAAAAEAAAAABIAAAgA==",
    lattice:
        "bWVzaGxvZHEBAAAAAQABAEgAAAAAAAAAVCi2Qw8AAAAAAAAAhpdPMTUAAAAAAAAAMxwTfh08JcH6////" +
        "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAABAAAAAUAAABAAAAAQAAAACAAAAAAAAAAQCAEAAADECCEMKhK" +
        "YQt21Uo/hAADAAAAAAAAAAIAAAAAdwABAAIAAAAAAAAAAAIAdXb0/wAAAAAAAAAADQ0AoAEADQAAAAAA" +
        "AAAAAAAAAEAAAAABIAAAgA==",
};
export type Scheme = keyof typeof MLQ;
export const SCHEMES = Object.keys(MLQ) as Scheme[];

/** Returns the quad as `.mlq`. */
export function quadMlq(scheme: Scheme): Uint8Array<ArrayBuffer> {
    return new Uint8Array(Buffer.from(MLQ[scheme], "base64"));
}

/** Makes the checksums of a `.mlq` file with three sections right again. */
export function sealMlq(file: Uint8Array): void {
    const view = new DataView(file.buffer, file.byteOffset);
    let at = 56;
    for (let sum = 16; sum < 52; sum += 12) {
        const end = at + Number(view.getBigUint64(sum, true));
        view.setUint32(sum + 8, crc32(file.subarray(at, end)), true);
        at = end;
    }
    view.setUint32(52, crc32(file.subarray(0, 52)), true);
}
