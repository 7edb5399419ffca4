/**
 * The script of the viewer's page, and of its worker: pages made of one file have no second address
 * from which a worker could come, so a worker runs the same script.
 */

import { startPage } from "./app.ts";

if (typeof document === "undefined") void import("../src/worker.ts");
else startPage();
