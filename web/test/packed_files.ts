/** A quad of two faces with texture coordinates, as `compress --bits 6` writes it. */

import { crc32 } from "../src/file/crc32.ts";
import { readMlzHeader } from "../src/mlz/header.ts";
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
    view.setUint32(12, crc32(file.subarray(20, header)), true);
}
