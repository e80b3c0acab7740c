// What the service would tell: its contract and its examples, as they are committed.

import { readFileSync } from "node:fs";

const read = (name) => JSON.parse(readFileSync(new URL(`../../../api/${name}`, import.meta.url), "utf8"));

export const api = read("openapi.json");

/** The submission of an example. */
export const example = (name) => read(`examples/${name}.json`);
