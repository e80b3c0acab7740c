// @ts-check
// A choice of one field of the design among many.

import { h } from "../draw/dom.js";
import { at } from "../state/design.js";
import { inUnit, quantities } from "../state/quantities.js";

/** @import { Design } from "../state/design.js" */
/** @import { Form } from "../views/form.js" */

/**
 * The part of the form that the field at a pointer stands in.
 *
 * @type {(pointer: string) => string}
 */
function partOf(pointer) {
  const [, place, member] = /^\/(pair\/(driving|driven)?)?/.exec(pointer) ?? [];
  return member ? `${member === "driving" ? "Driving" : "Driven"} gear` : place ? "Pair" : "Load and method";
}

/** A field of the design that is chosen among many, and which controls beside it are about. */
export class FieldChoice {
  /**
   * The choice number `index` of those beside each other: `words` stand before the first, and `none` is chosen where no
   * field is.
   *
   * @param {Design} design
   * @param {Form} form
   * @param {{ id: string, index: number, words: string, none: string }} how
   */
  constructor(design, form, { id, index, words, none }) {
    this.design = design;
    this.form = form;
    this.none = none;
    this.index = index;
    /** True once somebody has chosen a field: none is suggested from then on. */
    this.isChosen = false;
    this.field = h("select", {
      id,
      on: {
        change: () => {
          this.isChosen = true;
          this.suggest();
        },
      },
    });
    this.label = h("label", { htmlFor: id }, index ? "and" : words);
  }

  /** Writes into the controls what suits the field. */
  suggest() {}

  /** The field as the form has it; undefined where it has none. */
  get known() {
    return this.form.offered().find(({ pointer }) => pointer === this.field.value);
  }

  /** The value of the field in the design. */
  get value() {
    return at(this.design.submission, this.field.value);
  }

  /** The fields that have a number in the design. */
  numbers() {
    return this.form.offered().filter(({ pointer }) => typeof at(this.design.submission, pointer) === "number");
  }

  /**
   * Offers `fields` under the parts of the form. What is chosen stays where it is offered; whether it was says the
   * answer.
   *
   * @param {{ pointer: string, title: string }[]} fields
   */
  offer(fields) {
    const { field } = this;
    const chosen = field.value;
    const groups = ["Pair", "Driving gear", "Driven gear", "Load and method"].map((label) =>
      h(
        "optgroup",
        { label },
        ...fields
          .filter(({ pointer }) => partOf(pointer) === label)
          .map(({ pointer, title }) => h("option", { value: pointer }, title)),
      ),
    );
    field.replaceChildren(h("option", { value: "" }, this.none), ...groups.filter((group) => group.children.length));
    const stays = fields.some(({ pointer }) => pointer === chosen);
    field.value = stays ? chosen : "";
    return stays || chosen === "";
  }
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
