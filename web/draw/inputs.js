// @ts-check
// What is typed into a control, as a value of the design, and back.

import { h } from "./dom.js";
import { ProblemError } from "../state/api.js";
import { numberOf, unreadable, wordsOf } from "../state/typed.js";

/** @import { Properties } from "./dom.js" */
/** @import { Kind } from "../state/schema.js" */

/**
 * The numbers that the page itself has written into a control: they have decimal points.
 *
 * @type {WeakMap<object, Set<string>>}
 */
const written = new WeakMap();

/**
 * Writes numbers into a control.
 *
 * @type {(input: { value: string }, text: string) => void}
 */
export function put(input, text) {
  input.value = text;
  written.set(input, new Set(wordsOf(text)));
}

/** @type {(input: object, word: string) => number | string} */
const numberIn = (input, word) => (written.get(input)?.has(word) ? Number(word) : numberOf(word));

/**
 * The number in a control of a panel, undefined where there is none; throws what is wrong with it.
 *
 * @type {(input: { value: string }) => number | undefined}
 */
export function given(input) {
  const value = input.value.trim() === "" ? undefined : numberIn(input, input.value);
  if (typeof value === "string") throw new ProblemError({ detail: unreadable(value) });
  return value;
}

/**
 * The numbers in a control of a panel; throws what is wrong with one of them.
 *
 * @type {(input: { value: string }) => number[]}
 */
export function allGiven(input) {
  return wordsOf(input.value)
    .map((word) => numberIn(input, word))
    .map((value) => {
      if (typeof value === "string") throw new ProblemError({ detail: unreadable(value) });
      return value;
    });
}

/**
 * A control for a number, with the mark that its user writes: a browser drops the comma of `type="number"`.
 *
 * @type {(properties: Properties<HTMLInputElement>) => HTMLInputElement}
 */
export const numeric = (properties) =>
  h("input", { type: "text", inputMode: "decimal", className: "number", autocomplete: "off", ...properties });

/**
 * The value in a control; undefined where there is none, and what is no number as it stands, which is refused.
 *
 * @param {{ value: string }} input
 * @param {Pick<Kind, "kind">} kind
 * @returns {unknown}
 */
export function read(input, kind) {
  const text = input.value.trim();
  if (text === "") return undefined;
  if (kind.kind === "numbers") return wordsOf(text).map((word) => numberIn(input, word));
  if (kind.kind === "texts")
    return text
      .split(",")
      .map((word) => word.trim())
      .filter(Boolean);
  return kind.kind === "number" ? numberIn(input, text) : text;
}

/** @type {(kind: Kind) => string} */
const firstOf = ({ schema: { enum: words = [] } }) =>
  words.some((word) => word === null) ? "" : String(words[0] ?? "");

/**
 * Shows a value in a control; where there is none, what it is then.
 *
 * @param {HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement} input
 * @param {Kind} kind
 * @param {any} value that of the field, which the schema describes
 */
export function write(input, kind, value) {
  if (input instanceof HTMLInputElement && kind.kind === "flag") input.checked = value ?? kind.schema.default ?? false;
  else if (kind.kind === "choice") input.value = value ?? kind.schema.default ?? firstOf(kind);
  else if (value === undefined || value === null) input.value = "";
  else if (typeof value === "number") put(input, String(value));
  else if (Array.isArray(value) && value.every((each) => typeof each === "number")) put(input, value.join(", "));
  else if (Array.isArray(value)) input.value = value.join(", ");
  else input.value = typeof value === "object" ? JSON.stringify(value) : String(value);
}
