/**
 * Levels of detail that stream: `.mlod` files, read in a browser.
 *
 * `open` shows a file while it comes; `decode` and `Cut` are its parts for those who have the
 * bytes.
 */

export { MlodError } from "./error.ts";
export { completeChunks, decode } from "./decode.ts";
export type { Vector } from "./frame.ts";
export { NONE } from "./model.ts";
export type { Model } from "./model.ts";
export { headerLength, readHeader } from "./file/header.ts";
export type { ChunkEntry, ErrorKind, Header, ResourceEntry, Section } from "./file/header.ts";
export { Cut } from "./cut/cut.ts";
export type { CutChange, Limits } from "./cut/meter.ts";
export type { Camera, Focus, Query, Tolerance } from "./cut/query.ts";
export { FieldCut } from "./field/field_cut.ts";
export { FieldModel } from "./field/field_model.ts";
export { decodeField } from "./field/height_field.ts";
export type { HeightField } from "./field/height_field.ts";
export { readHead, unpackResource } from "./scene/head.ts";
export type { SceneHead, SceneMesh, ScenePart, Slot } from "./scene/head.ts";
export { Geometry } from "./load/geometry.ts";
export type { GeometryPatch, PartRange, Slots, Vertices } from "./load/geometry.ts";
export { verticesOf, fieldVerticesOf } from "./load/vertices.ts";
export { open } from "./load/stream.ts";
export type { MlodStream, StreamListener, StreamOptions } from "./load/stream.ts";
export type { FileInfo, LayerInfo, Progress, SceneInfo, StreamLimits } from "./load/messages.ts";
export type { Access } from "./load/source.ts";
export { workerOf } from "./load/worker_url.ts";
