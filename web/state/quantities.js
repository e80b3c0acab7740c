// @ts-check
// The numbers of designs as the service names them: what they are called, their units, and where results and rows of
// tables have them.

import { json } from "./api.js";
import { fixed, number, unit } from "./numbers.js";

/** @import { Curve, GearName, RowCurve, TableRow } from "./documents.js" */

/**
 * Units that are printed as multiples of the service's, and what numbers are multiplied by.
 *
 * @type {Record<string, [string, number]>}
 */
const PRINTED = { "N/m": ["N/µm", 1e-6], "kg m^2": ["kg cm²", 1e4] };
/**
 * So many decimals have numbers in a unit; small ones have three digits.
 *
 * @type {Record<string, number>}
 */
const DECIMALS = { "N/µm": 2, MPa: 1, "%": 1, mm: 2 };
const SMALL = 0.1;

/** @typedef {import("./documents.js").Schemas["Quantity"]} Told */

/**
 * A quantity, with its unit and its values as they are printed. Of one that this page does not know it has the name
 * alone.
 *
 * @typedef {Pick<Told, "name" | "title" | "symbol" | "needs"> & Partial<Told> &
 *   { printed: string, factor: number }} Quantity
 */

/** @type {Map<string, Quantity>} */
let known = new Map();

/** Fetches them, once. */
export async function fetchQuantities() {
  const { items } = await json("v1/quantities");
  known = new Map(
    items.map((/** @type {Told} */ item) => {
      const [printed, factor] = PRINTED[item.unit] ?? [unit(item.unit), 1];
      return [item.name, { ...item, printed, factor }];
    }),
  );
}

export const quantities = () => [...known.values()];

/**
 * The quantity of this name; one that a later service has is called by it.
 *
 * @type {(name: string) => Quantity}
 */
export const quantityOf = (name) =>
  known.get(name) ?? {
    name: String(name),
    title: String(name),
    symbol: String(name),
    printed: "",
    factor: 1,
    needs: [],
  };

/**
 * A quantity with its unit, if it has one.
 *
 * @type {(quantity: Quantity) => string}
 */
export const inUnit = ({ title, printed }) => (printed ? `${title} in ${printed}` : title);

/**
 * What a quantity is called beside its values: those of the pair and of one gear by their titles.
 *
 * @type {(quantity: Quantity) => string}
 */
export const calledOf = ({ of, gear, title, symbol }) => (gear || of === "pair" ? title : symbol);

/**
 * What it is called in the middle of a sentence.
 *
 * @type {(quantity: Quantity) => string}
 */
export const inWords = ({ title }) => title[0].toLowerCase() + title.slice(1);

/**
 * A value of a quantity as it is printed.
 *
 * @type {(quantity: Pick<Quantity, "printed" | "factor">, value: unknown) => string}
 */
export function shown({ printed, factor }, value) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  return Math.abs(factor * value) < SMALL ? number(factor * value, 3) : fixed(factor * value, DECIMALS[printed] ?? 3);
}

/** @type {(object: any, name: string) => any} */
const at = (object, name) => name.split(".").reduce((part, step) => part?.[step], object);

/**
 * The value of a quantity in a curve; undefined where its results are of a version that told none.
 *
 * @type {(quantity: Quantity, curve: Curve) => number | null | undefined}
 */
export const inCurve = ({ name }, curve) => curve.quantities?.[name];

/**
 * The same in a row of the table of a study, whose numbers of one gear are those of `gear`; undefined where it has none
 * of it.
 *
 * @type {(quantity: Quantity, row: TableRow, curve: RowCurve, studied: GearName) => number | null | undefined}
 */
export function inRow({ name, of, gear }, row, curve, studied) {
  if (of === "pair") return gear && gear !== studied ? undefined : at(row, gear ? name.split(".")[0] : name);
  const own = at(curve, name);
  return own === undefined ? at(curve.statistics, name) : own;
}

/**
 * The worst in a row over its torques.
 *
 * @type {(quantity: Quantity, row: TableRow, studied: GearName) => number}
 */
export function worstInRow(quantity, row, studied) {
  const values = row.curves.map((curve) => inRow(quantity, row, curve, studied) ?? NaN);
  return quantity.better === "larger" ? Math.min(...values) : Math.max(...values);
}
