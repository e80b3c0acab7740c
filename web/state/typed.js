// @ts-check
// What somebody types, as values.

/** @import { Kind } from "./schema.js" */

/** A number with a decimal point, or with a decimal comma. */
const POINT = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const COMMA = /^[+-]?(\d*,\d+|\d+,)(e[+-]?\d+)?$/i;
/**
 * A comma before three digits may stand between thousands, or between two numbers of a list: this is read as neither.
 */
const THREE = /^[+-]?[1-9]\d{0,2},\d{3}$/;

/**
 * The number that a text says, with a decimal point or a decimal comma; the text itself where it says none.
 *
 * @type {(text: string) => number | string}
 */
export function numberOf(text) {
  const word = text.trim().replace(/\u2212/g, "-");
  if (POINT.test(word)) return Number(word);
  return COMMA.test(word) && !THREE.test(word) ? Number(word.replace(",", ".")) : text.trim();
}

/**
 * The words of a list: spaces, semicolons and commas before a space stand between them.
 *
 * @type {(text: string) => string[]}
 */
export const wordsOf = (text) => text.split(/[\s;]+|,(?=\s|$)/).filter(Boolean);

/**
 * What is wrong with a text that says no number.
 *
 * @type {(text: string) => string}
 */
export function unreadable(text) {
  const [whole, after] = text.split(",");
  if (THREE.test(text.trim()))
    return `“${text}” can be read in two ways: write ${whole}.${after}, ${whole}${after}, or with a space or a semicolon between two numbers.`;
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
 * A number so many steps on, each a tenth of its leading digit, within its bounds.
 *
 * @param {number} value
 * @param {number} steps
 * @param {Kind} kind
 */
export function stepped(value, steps, kind) {
  const { minimum = -Infinity, maximum = Infinity } = kind.schema;
  const size = kind.whole ? 1 : 10 ** Math.floor(Math.log10(Math.max(Math.abs(value), 0.1)) - 1);
  return Math.min(maximum, Math.max(minimum, Number((Math.round(value / size + steps) * size).toPrecision(8))));
}
