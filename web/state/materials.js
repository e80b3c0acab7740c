// @ts-check
// Materials by their names: the numbers that stand for those that a design does not give.

import { json } from "./api.js";

/** @typedef {import("./documents.js").Schemas["NamedMaterial"]} NamedMaterial */

/** @type {Map<string, NamedMaterial>} */
let known = new Map();

/** Fetches them, once. */
export async function fetchMaterials() {
  const { items } = await json("v1/materials");
  known = new Map(items.map((/** @type {NamedMaterial} */ item) => [item.name, item]));
}

/**
 * The number `field` of the material of this name; undefined where there is none.
 *
 * @type {(name: unknown, field: string) => number | undefined}
 */
export function numberOfMaterial(name, field) {
  /** @type {Record<string, unknown> | undefined} */
  const material = known.get(String(name));
  const value = material?.[field];
  return typeof value === "number" ? value : undefined;
}

/** @type {(words: string) => string} */
const letters = (words) => words.toLowerCase().replace(/[^a-z0-9]/g, "");

/**
 * The name of the material that words tell; undefined where they tell none.
 *
 * @type {(words: string) => string | undefined}
 */
export const materialIn = (words) => [...known.keys()].find((name) => letters(words).includes(letters(name)));
