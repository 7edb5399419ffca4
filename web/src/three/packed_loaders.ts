/** Loaders of `.mlz` and `.mlq` files for three.js, which fetch their decoders with the first file. */

import { FileLoader, Loader } from "three";
import type { BufferGeometry } from "three";
import type { PackedMesh } from "../packed/mesh.ts";

/** Loads a whole file, and decodes it as a geometry. */
abstract class PackedLoader extends Loader<BufferGeometry> {
    /** Returns the decoder of the format. */
    protected abstract decoder(): Promise<(file: Uint8Array) => PackedMesh>;

    override load(
        url: string,
        onLoad: (geometry: BufferGeometry) => void,
        onProgress?: (event: ProgressEvent) => void,
        onError?: (error: unknown) => void,
    ): void {
        const report = onError ?? ((error) => console.error(error));
        const files = new FileLoader(this.manager);
        files.setPath(this.path);
        files.setResponseType("arraybuffer");
        files.setRequestHeader(this.requestHeader);
        files.setWithCredentials(this.withCredentials);
        const parse = (file: string | ArrayBuffer) => {
            this.parse(file as ArrayBuffer)
                .then(onLoad)
                .catch((error: unknown) => {
                    report(error);
                    this.manager.itemError(url);
                });
        };
        files.load(url, parse, onProgress, report);
    }

    /** Decodes a file in memory. */
    async parse(file: ArrayBuffer): Promise<BufferGeometry> {
        const [decode, { geometryOf }] = await Promise.all([
            this.decoder(),
            import("./packed_geometry.ts"),
        ]);
        return geometryOf(decode(new Uint8Array(file)));
    }
}

/** Loads `.mlz` files, which are made for transmission. */
export class MlzLoader extends PackedLoader {
    protected override async decoder() {
        return (await import("../mlz/index.ts")).decodeMlz;
    }
}

/** Loads `.mlq` files, which are made to be drawn from; here they are decoded as a whole. */
export class MlqLoader extends PackedLoader {
    protected override async decoder() {
        return (await import("../mlq/index.ts")).decodeMlq;
    }
}
