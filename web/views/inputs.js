// What is typed into a control, as a value of the design, and back.

import { ProblemError } from "../state/api.js";
import { h } from "../draw/dom.js";

/** A number with a decimal point, or with a decimal comma. */
const POINT = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const COMMA = /^[+-]?(\d*,\d+|\d+,)(e[+-]?\d+)?$/i;
/**
 * A comma before three digits may stand between thousands, or between two numbers of a list: this is read as neither.
 */
const THREE = /^[+-]?[1-9]\d{0,2},\d{3}$/;

/** The number that a text says, with a decimal point or a decimal comma; the text itself where it says none. */
export function numberOf(text) {
  const word = text.trim().replace(/\u2212/g, "-");
  if (POINT.test(word)) return Number(word);
  return COMMA.test(word) && !THREE.test(word) ? Number(word.replace(",", ".")) : text.trim();
}

/** The words of a list: spaces, semicolons and commas before a space stand between them. */
export const wordsOf = (text) => text.split(/[\s;]+|,(?=\s|$)/).filter(Boolean);

/** What is wrong with a text that says no number. */
export function unreadable(text) {
  const [whole, after] = text.split(",");
  if (THREE.test(text.trim()))
    return `“${text}” can be read in two ways: write ${whole}.${after}, ${whole}${after}, or with a space or a semicolon between two numbers.`;
  return `“${text}” is no number${text.includes(",") ? ": between two numbers stands a space or a semicolon" : ""}.`;
}

/** The number in a control of a panel, undefined where there is none; throws what is wrong with it. */
export function given(input) {
  const value = input.value.trim() === "" ? undefined : numberOf(input.value);
  if (typeof value === "string") throw new ProblemError({ detail: unreadable(value) });
  return value;
}

/** The numbers in a control of a panel; throws what is wrong with one of them. */
export function allGiven(input) {
  return wordsOf(input.value)
    .map(numberOf)
    .map((value) => {
      if (typeof value === "string") throw new ProblemError({ detail: unreadable(value) });
      return value;
    });
}

/** A control for a number, with the mark that its user writes: a browser drops the comma of `type="number"`. */
export const numeric = (properties) =>
  h("input", { type: "text", inputMode: "decimal", className: "number", autocomplete: "off", ...properties });

/** The value in a control; undefined where there is none, and what is no number as it stands, which is refused. */
export function read(input, kind) {
  const text = input.value.trim();
  if (text === "") return undefined;
  if (kind.kind === "numbers") return wordsOf(text).map(numberOf);
  if (kind.kind === "texts")
    return text
      .split(",")
      .map((word) => word.trim())
      .filter(Boolean);
  return kind.kind === "number" ? numberOf(text) : text;
}

/** The value of a text that may be JSON. */
export function parsed(text) {
  if (text.trim() === "") return undefined;
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** Shows a value in a control; where there is none, what it is then. */
export function write(input, kind, value) {
  if (kind.kind === "flag") input.checked = value ?? kind.schema.default ?? false;
  else if (kind.kind === "choice") input.value = value ?? kind.schema.default ?? kind.schema.enum[0];
  else if (value === undefined || value === null) input.value = "";
  else if (Array.isArray(value)) input.value = value.join(", ");
  else input.value = typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** A number so many steps on, each a tenth of its leading digit, within its bounds. */
export function stepped(value, steps, kind) {
  const { minimum = -Infinity, maximum = Infinity } = kind.schema;
  const size = kind.whole ? 1 : 10 ** Math.floor(Math.log10(Math.max(Math.abs(value), 0.1)) - 1);
  return Math.min(maximum, Math.max(minimum, Number((Math.round(value / size + steps) * size).toPrecision(8))));
}
