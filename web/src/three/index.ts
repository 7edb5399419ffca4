/** Levels that stream, and compressed meshes, in three.js. */

export { MlodLoader } from "./mlod_loader.ts";
export { MlodMesh } from "./mlod_mesh.ts";
export type { MlodInstances } from "./instances.ts";
export type { MlodNodes } from "./nodes.ts";
export type { PictureSize } from "./mlod_mesh.ts";
export { MlqLoader, MlzLoader } from "./packed_loaders.ts";
