// @ts-check
// Materials by their names: the numbers that stand for those that a design does not give.

import { json, ProblemError } from "./api.js";
import { number } from "./numbers.js";

/** @typedef {import("./documents.js").Schemas["NamedMaterial"]} NamedMaterial */

/** @type {Map<string, NamedMaterial>} */
let known = new Map();

/**
 * Takes the materials that the service knows.
 *
 * @param {NamedMaterial[]} items
 */
export function learnMaterials(items) {
  known = new Map(items.map((item) => [item.name, item]));
}

/** Fetches them, once. */
export async function fetchMaterials() {
  learnMaterials((await json("v1/materials")).items);
}

/**
 * The numbers of a material that change with its temperature: in proportion between the two nearest temperatures that
 * are printed. Throws what is wrong beyond these.
 *
 * @type {(name: string, temperature: number) => { youngs_modulus_gpa: number, expansion_per_k: number }}
 */
export function materialAt(name, temperature) {
  const material = known.get(name);
  if (!material) throw new ProblemError({ detail: "Choose a material by its name first." });
  const points = [material, ...material.at_temperatures];
  const [first, last] = [points[0].temperature_c, points[points.length - 1].temperature_c];
  const range = `from ${number(first)} to ${number(last)} °C`;
  if (temperature < first || temperature > last)
    throw new ProblemError({
      detail: `The modulus of ${name} is known ${range}. Type another one where it runs at ${number(temperature)} °C.`,
    });
  const above = Math.max(
    1,
    points.findIndex((point) => point.temperature_c >= temperature),
  );
  const [a, b = a] = [points[above - 1], points[above]];
  const part = a === b ? 0 : (temperature - a.temperature_c) / (b.temperature_c - a.temperature_c);
  /** @type {(from: number, to: number) => number} */
  const between = (from, to) => Number((from + part * (to - from)).toPrecision(4));
  return {
    youngs_modulus_gpa: between(a.youngs_modulus_gpa, b.youngs_modulus_gpa),
    // A coefficient from the first temperature to itself has no meaning: the first that is printed holds below its own.
    expansion_per_k: above === 1 ? (part > 0 ? b : a).expansion_per_k : between(a.expansion_per_k, b.expansion_per_k),
  };
}

/**
 * The publications that print the numbers of a material; nothing where it has no name.
 *
 * @type {(name: unknown) => string}
 */
export const sourceOf = (name) => known.get(String(name))?.source ?? "";

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
