// @ts-check
// What is wrong with a field, said at the field, with buttons for the values that would do.

import { around, button, h } from "../draw/dom.js";
import { number, unit } from "../state/numbers.js";
import { chooseReading, inOtherUnit, readingsOf, unreadable } from "../state/typed.js";

/** @import { Design } from "../state/design.js" */
/** @import { FieldError } from "../state/documents.js" */
/** @import { Schema } from "../state/schema.js" */
/** @import { Field } from "./fields.js" */

/**
 * Takes away what was said of a field.
 *
 * @param {Field} field
 */
export function clearFault({ element, described }) {
  element.classList.remove("wrong");
  for (const old of element.querySelectorAll(":scope > .field-error")) old.remove();
  for (const input of element.querySelectorAll(":scope > .row > [aria-invalid]")) {
    input.removeAttribute("aria-invalid");
    if (described) input.setAttribute("aria-describedby", described);
    else input.removeAttribute("aria-describedby");
  }
}

/**
 * Says what is wrong with a field, and marks the section that it is in.
 *
 * @param {Field} field
 * @param {FieldError} error
 * @param {Design} design
 * @param {(detail: string) => string} inWords
 */
export function sayFault({ element, pointer, schema, described }, error, design, inWords) {
  const typed = design.get(error.pointer);
  const readings = typeof typed === "string" ? readingsOf(typed) : null;
  const other = inOtherUnit(typed, schema);
  const nearest = other?.value ?? error.nearest ?? null;
  const printed = unit(schema["x-unit"] ?? schema.items?.["x-unit"]);
  const meant = other ? `, which are ${number(typed, 8)} ${other.unit}` : "";
  const mends = (readings ?? (nearest === null ? [] : [nearest])).map((value, i) =>
    button(
      `Use ${number(value, 8)} ${printed}`.trim() + meant,
      () => {
        if (readings) chooseReading(i === 0);
        design.set(error.pointer, value, "mend");
      },
      { className: "mend" },
    ),
  );
  element.classList.add("wrong");
  const id = `error-${pointer}-${element.querySelectorAll(":scope > .field-error").length}`;
  element.append(
    h(
      "p",
      { className: "field-error", id },
      error.code === "wrong_type" && typeof typed === "string" ? unreadable(typed) : inWords(error.detail),
      ...mends.flatMap((mend) => [" ", mend]),
    ),
  );
  const input = element.querySelector(":scope > .row > input, :scope > .row > select, :scope > .row > textarea");
  input?.setAttribute("aria-invalid", "true");
  input?.setAttribute(
    "aria-describedby",
    [input.getAttribute("aria-describedby") ?? described, id].filter(Boolean).join(" "),
  );
  for (const parent of around(element)) {
    if (parent.classList.contains("section")) parent.classList.add("wrong");
    else parent.open = true;
  }
}
