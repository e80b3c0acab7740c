// @ts-check
// Orders as words: what a label of the spectrum means to someone who does not know its letters.

/** @import { NamedOrder } from "./documents.js" */

const TIMES = ["", "", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"];

/** @type {(name: string, n: number) => string} */
const multiple = (name, n) => (n === 1 ? name : `${name}, ${TIMES[n] ?? `${n}th`} order`);

/**
 * What a named order is: "mesh", "holes, second order", "mesh less holes".
 *
 * @type {(order: NamedOrder) => string}
 */
export function wordsOf({ kind, gears = [], mesh_harmonic, multiple: times, label }) {
  const [k, n] = [mesh_harmonic ?? 0, times ?? 0];
  const of = gears.length === 1 && /N[12]/.test(label) ? ` of the ${gears[0]} gear` : "";
  if (kind === "mesh") return multiple("mesh", k);
  const cause =
    kind === "holes" || kind === "hole_sideband"
      ? `holes${of}`
      : `revolution${gears.length === 1 ? ` of the ${gears[0]} gear` : ""}`;
  if (kind === "holes" || kind === "revolution") return multiple(cause, n);
  const often = Math.abs(n) === 1 ? "" : `${Math.abs(n)} times `;
  return `${multiple("mesh", k)}${k > 1 ? "," : ""} ${n < 0 ? "less" : "plus"} ${often}${cause}`;
}
