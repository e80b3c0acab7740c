// @ts-check
// A choice of one field of the design among many.

import { h } from "../draw/dom.js";
import { inUnit, quantities } from "../state/quantities.js";

/**
 * The part of the form that the field at a pointer stands in.
 *
 * @type {(pointer: string) => string}
 */
function partOf(pointer) {
  const [, place, member] = /^\/(pair\/(driving|driven)?)?/.exec(pointer) ?? [];
  return member ? `${member === "driving" ? "Driving" : "Driven"} gear` : place ? "Pair" : "Load and method";
}

/**
 * The options of `select`: `none`, which is no field, and `fields` `{ pointer, title }` under the parts of the form.
 * What is chosen stays where it is offered; whether it was says the answer.
 *
 * @type {(select: HTMLSelectElement, none: string, fields: { pointer: string, title: string }[]) => boolean}
 */
export function offer(select, none, fields) {
  const chosen = select.value;
  const groups = ["Pair", "Driving gear", "Driven gear", "Load and method"].map((label) =>
    h(
      "optgroup",
      { label },
      ...fields
        .filter(({ pointer }) => partOf(pointer) === label)
        .map(({ pointer, title }) => h("option", { value: pointer }, title)),
    ),
  );
  select.replaceChildren(h("option", { value: "" }, none), ...groups.filter((group) => group.children.length));
  const stays = fields.some(({ pointer }) => pointer === chosen);
  select.value = stays ? chosen : "";
  return stays || chosen === "";
}

/**
 * Options for all of them, that of the name `chosen` selected.
 *
 * @type {(chosen: string) => HTMLOptionElement[]}
 */
export const options = (chosen) =>
  quantities().map((quantity) =>
    h("option", { value: quantity.name, selected: quantity.name === chosen }, inUnit(quantity)),
  );
