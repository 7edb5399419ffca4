/** Loaders of `.mlz` and `.mlq` files for three.js, which fetch their decoders with the first file. */

import { FileLoader, Loader } from "three";
import type { BufferGeometry, Material, Mesh } from "three";
import type { PackedMesh } from "../packed/mesh.ts";
import { makeMaterials, plainMaterial } from "./materials.ts";
import { Pictures } from "./pictures.ts";

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
        this.read(url, (file) => this.parse(file), onProgress)
            .then(onLoad)
            .catch(onError ?? ((error: unknown) => console.error(error)));
    }

    /** Loads a file as a mesh, with the materials and images that it holds. */
    loadMesh(
        url: string,
        onProgress?: (event: ProgressEvent) => void,
    ): Promise<Mesh<BufferGeometry, Material[]>> {
        return this.read(url, (file) => this.parseMesh(file), onProgress);
    }

    private async read<T>(
        url: string,
        parse: (file: ArrayBuffer) => Promise<T>,
        onProgress?: (event: ProgressEvent) => void,
    ): Promise<T> {
        const files = new FileLoader(this.manager);
        files.setPath(this.path);
        files.setResponseType("arraybuffer");
        files.setRequestHeader(this.requestHeader);
        files.setWithCredentials(this.withCredentials);
        const file = (await files.loadAsync(url, onProgress)) as ArrayBuffer;
        try {
            return await parse(file);
        } catch (error) {
            this.manager.itemError(url);
            throw error;
        }
    }

    /** Decodes a file in memory. */
    async parse(file: ArrayBuffer): Promise<BufferGeometry> {
        const [mesh, { geometryOf }] = await Promise.all([
            this.decode(file),
            import("./packed_geometry.ts"),
        ]);
        return geometryOf(mesh);
    }

    /** Decodes a file in memory as a mesh with its materials. */
    async parseMesh(file: ArrayBuffer): Promise<Mesh<BufferGeometry, Material[]>> {
        const [mesh, { meshOf }] = await Promise.all([
            this.decode(file),
            import("./packed_mesh.ts"),
        ]);
        return meshOf(mesh, {
            make: makeMaterials,
            plain: plainMaterial,
            pictures: new Pictures(),
            manager: this.manager,
        });
    }

    private async decode(file: ArrayBuffer): Promise<PackedMesh> {
        return (await this.decoder())(new Uint8Array(file));
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
