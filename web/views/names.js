// @ts-check
// The names of fields in words: with their part, gear and unit, in lists and in the sentences of the service.

import { unit } from "../state/numbers.js";
import { lastOf, partOf, schemaAt } from "../state/schema.js";

/** @import { Changes } from "../state/changes.js" */
/** @import { Api, Schema } from "../state/schema.js" */

export class Names {
  /**
   * `shown` are the fields of the form by their pointers; `changes` knows which of them stand for both gears.
   *
   * @param {Api} api
   * @param {Map<string, { schema: Schema }>} shown
   * @param {Changes} changes
   */
  constructor(api, shown, changes) {
    this.api = api;
    this.shown = shown;
    this.changes = changes;
  }

  /** @param {string} pointer */
  #schemaOf(pointer) {
    return this.shown.get(pointer)?.schema ?? schemaAt(this.api, pointer);
  }

  /**
   * What the field at a pointer is called.
   *
   * @param {string} pointer
   * @returns {string}
   */
  titleOf(pointer) {
    const place = pointer.replace(/\/\d+$/, "");
    return this.#schemaOf(place)?.title ?? lastOf(place).replace(/_/g, " ");
  }

  /**
   * What the field at a pointer is called, and of which part and gear it is.
   *
   * @param {string} pointer
   */
  named(pointer) {
    const member = /^\/pair\/(driving|driven)\//.exec(pointer)?.[1];
    const place = /\/(\d+)\//.exec(pointer)?.[1];
    const title = this.titleOf(pointer);
    const details = [partOf(this.api, pointer, title), place ? String(Number(place) + 1) : ""].filter(Boolean);
    const words = title + details.map((each) => ` (${each})`).join("");
    return member && !this.isAlike(pointer) ? `${words}, ${member} gear` : words;
  }

  /**
   * What the service says of fields by their pointers, in the words of the form.
   *
   * @param {string} detail
   */
  inWords(detail) {
    return detail
      .replace(
        /\/(?:pair|population|resolution|output_torques_n_m|force_table|dynamics|face_load)[\w/]*/g,
        (pointer) => `“${this.named(pointer)}”`,
      )
      .replace(
        /\b(three_dimensional_projected|three_dimensional|projected_decomposition|load_distribution)\b/g,
        (method) => method.replace(/_/g, " "),
      );
  }

  /**
   * What the field at a pointer is called, with its gear and its unit.
   *
   * @param {string} pointer
   */
  titled(pointer) {
    const printed = this.unitOf(pointer);
    return `${this.named(pointer)}${printed ? ` (${printed})` : ""}`;
  }

  /** @param {string} pointer */
  unitOf(pointer) {
    const schema = this.#schemaOf(pointer);
    return unit(schema?.["x-unit"] ?? schema?.items?.["x-unit"]);
  }

  /**
   * Whether the field at a pointer stands for both gears.
   *
   * @param {string} pointer
   */
  isAlike(pointer) {
    return this.changes.isLocked(lastOf(pointer));
  }
}
