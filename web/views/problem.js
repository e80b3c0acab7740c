// @ts-check
// What is wrong with the design: above the last good curve, and at its fields.

import { button, byId, h } from "../draw/dom.js";

/** @import { FieldError, Problem } from "../state/documents.js" */
/** @import { Form } from "./form.js" */

/** So many of the fields that are wrong are told. */
const MOST = 4;

export class ProblemBox {
  #place = byId("problem");

  /** @param {() => Form | null} form */
  constructor(form) {
    this.form = form;
  }

  get isShown() {
    return !this.#place.hidden;
  }

  /** Nothing is wrong. */
  hide() {
    this.form()?.showErrors([]);
    this.#place.hidden = true;
    this.#place.replaceChildren();
  }

  /**
   * `behind` says that curves of an earlier design are shown, and `back` goes back to it, where there is one to go back
   * to.
   *
   * @param {Problem} problem
   * @param {{ behind: boolean, back: (() => void) | null }} shown
   */
  show({ code, title = "", detail = "", errors = [] }, { behind, back }) {
    const form = this.form();
    form?.showErrors(errors);
    this.#place.hidden = false;
    const entries = errors.slice(0, MOST).map((error) => {
      const focus = () => form?.focus(error.pointer);
      return h(
        "li",
        {},
        form?.names.inWords(error.detail) ?? error.detail,
        " ",
        button("Show the field", focus, { className: "mend" }),
      );
    });
    const kept = ". Curves and numbers are those of the last design that could be computed; nothing is exported. ";
    this.#place.replaceChildren(
      h("p", {}, h("strong", {}, title), behind ? kept : null, behind && back ? button("Go back to it", back) : null),
      entries.length ? h("ul", {}, ...entries) : h("p", {}, detail),
      ...this.#dimensions(new Set(errors.map((error) => error.code))),
      ...(code === "unauthorized" ? [button("Give a key", () => byId("key-button").click())] : []),
    );
  }

  /**
   * What mends a design that has an extent along the axis and a method that knows none, or the other way round.
   *
   * @param {Set<FieldError["code"]>} codes
   */
  #dimensions(codes) {
    /** @type {(inSolid: boolean, words: string) => HTMLElement} */
    const turn = (inSolid, words) => button(words, () => this.form()?.changes.compute(inSolid));
    /** @type {(solid: string, plane: string) => HTMLElement[]} */
    const both = (solid, plane) => [h("p", {}, turn(true, solid), " ", turn(false, plane))];
    if (codes.has("needs_three_dimensions"))
      return both("Compute it in three dimensions", "Leave out what has an extent along the axis");
    if (codes.has("not_in_three_dimensions"))
      return both("Leave out what three dimensions do not know", "Compute it in the plane");
    return [];
  }
}
