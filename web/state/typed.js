// @ts-check
// What somebody types, as values.

/** @import { Kind } from "./schema.js" */

/** A number with a decimal point, or with a decimal comma. */
const POINT = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const COMMA = /^[+-]?(\d*,\d+|\d+,)(e[+-]?\d+)?$/i;
/** Thousands apart from each other by the one sign, and decimals by the other. */
const THOUSANDS = /^[+-]?[1-9]\d{0,2}(?:(?:\.\d{3})+,\d+|(?:,\d{3})+\.\d+)$/;
/** A point before three digits may be decimal, or stand between thousands. */
const THREE = /^[+-]?[1-9]\d{0,2}\.\d{3}$/;

/** Whether somebody has said that a point before three digits is decimal. */
let isDecimal = false;

/** @type {(text: string) => string} */
const plain = (text) => text.trim().replace(/\u2212/g, "-");

/**
 * The number that a text says, with a decimal point or a decimal comma; the text itself where it says none, or may say
 * two.
 *
 * @type {(text: string) => number | string}
 */
export function numberOf(text) {
  const word = plain(text);
  if (readingsOf(word)) return text.trim();
  if (POINT.test(word)) return Number(word);
  if (COMMA.test(word)) return Number(word.replace(",", "."));
  if (!THOUSANDS.test(word)) return text.trim();
  const [between, decimal] = word.lastIndexOf(",") > word.lastIndexOf(".") ? [/\./g, ","] : [/,/g, "."];
  return Number(word.replace(between, "").replace(decimal, "."));
}

/**
 * What a text may say that can be read in two ways: with a decimal point, and with one between thousands. Null where it
 * says one number or none.
 *
 * @type {(text: string) => [decimal: number, thousands: number] | null}
 */
export function readingsOf(text) {
  const word = plain(text);
  return THREE.test(word) && !isDecimal ? [Number(word), Number(word.replace(".", ""))] : null;
}

/**
 * Remembers how somebody has read a point before three digits: who has said that it is decimal is not asked again.
 *
 * @param {boolean} decimal
 */
export function chooseReading(decimal) {
  isDecimal = decimal;
}

/**
 * The words of a list: spaces, semicolons and commas before a space stand between them.
 *
 * @type {(text: string) => string[]}
 */
export const wordsOf = (text) => text.split(/[\s;]+|,(?=\s|$)/).filter(Boolean);

/**
 * What is wrong with a text that says no number, or two.
 *
 * @type {(text: string) => string}
 */
export function unreadable(text) {
  const readings = readingsOf(text);
  if (readings) return `“${text}” can be read in two ways: ${readings.join(" or ")}. Type the one that is meant.`;
  return `“${text}” is no number${text.includes(",") ? ": between two numbers stands a space or a semicolon" : ""}.`;
}

/**
 * The value of a text that may be JSON.
 *
 * @param {string} text
 * @returns {unknown}
 */
export function parsed(text) {
  if (text.trim() === "") return undefined;
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/**
 * Units of material data sheets by those of the schema, and how many of these one of them is.
 *
 * @type {Record<string, [unit: string, factor: number]>}
 */
const OTHER_UNITS = { "kg/m3": ["g/cm³", 1000], GPa: ["MPa", 0.001] };

/**
 * The value of a number beyond the bounds of its field that lies within them in another unit, and that unit. Null where
 * there is none.
 *
 * @type {(value: unknown, schema: Kind["schema"]) => { value: number, unit: string } | null}
 */
export function inOtherUnit(value, schema) {
  const [unit, factor] = OTHER_UNITS[schema["x-unit"] ?? ""] ?? [];
  const { minimum = -Infinity, maximum = Infinity } = schema;
  if (typeof value !== "number" || !unit || !factor || (value >= minimum && value <= maximum)) return null;
  const meant = Number((factor * value).toPrecision(9));
  return meant >= minimum && meant <= maximum ? { value: meant, unit } : null;
}

/** @type {(value: number | string) => number} */
const decimalsOf = (value) => /[.,](\d+)$/.exec(String(value))?.[1].length ?? 0;

/**
 * A number so many steps on, each a tenth of its leading digit, within its bounds; its further digits stay.
 *
 * @param {number} value
 * @param {number} steps
 * @param {Kind} kind
 */
export function stepped(value, steps, kind) {
  const size = kind.whole ? 1 : 10 ** Math.floor(Math.log10(Math.max(Math.abs(value), 0.1)) - 1);
  return Number(within(value + steps * size, kind).toFixed(Math.max(decimalsOf(value), decimalsOf(size))));
}

/**
 * The text of a number so many steps of its last digit on, within its bounds: with as many decimals as `text` has, in
 * which it stands.
 *
 * @param {string} text
 * @param {number} value
 * @param {number} steps
 * @param {Kind} kind
 */
export function turned(text, value, steps, kind) {
  const decimals = kind.whole ? 0 : Math.max(decimalsOf(plain(text)), decimalsOf(value));
  return within(value + steps * 10 ** -decimals, kind).toFixed(decimals);
}

/** @type {(value: number, kind: Kind) => number} */
const within = (value, { schema: { minimum = -Infinity, maximum = Infinity } }) =>
  Math.min(maximum, Math.max(minimum, value));
