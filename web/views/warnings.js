// @ts-check
// What the service warns of, with what would mend it.

import { button, byId, h } from "../draw/dom.js";
import { cured, wordsOfCure } from "../draw/face.js";
import { number } from "../state/numbers.js";

/** @import { Design } from "../state/design.js" */
/** @import { Curve, Warning } from "../state/documents.js" */
/** @import { Form } from "./form.js" */

export class Warnings {
  #button = byId("warned");
  #list = byId("warnings");
  #cure = byId("cure");

  /**
   * @param {Design} design
   * @param {() => Form | null} form
   */
  constructor(design, form) {
    this.design = design;
    this.form = form;
    this.#button.addEventListener("click", () => this.#open(this.#list.hidden));
  }

  /** @param {Warning[]} warnings */
  show(warnings) {
    this.#button.hidden = warnings.length === 0;
    this.#button.textContent = `${warnings.length} ${warnings.length === 1 ? "warning" : "warnings"}`;
    this.#list.replaceChildren(...warnings.map((warning) => this.#item(warning)));
    if (!warnings.length) this.#open(false);
  }

  /** @param {Warning} warning */
  #item({ code, detail, guide, changes = {} }) {
    const form = this.form();
    // What would mend it, by the pointers of the fields.
    const values = Object.entries(changes).map(
      ([pointer, value]) => `${form?.names.named(pointer) ?? pointer} ${number(value, 7)}`,
    );
    return h(
      "li",
      {},
      form?.names.inWords(detail) ?? detail,
      ...(guide ? [" ", h("a", { href: guide.replace(/^\//, "") }, "The guide says why")] : []),
      ...(code === "web_outside_plane_model"
        ? [" ", button("Compute it in three dimensions", () => form?.changes.compute(true))]
        : []),
      ...(values.length ? [" ", button(`Use ${values.join(", ")}`, () => form?.changes.take(changes))] : []),
    );
  }

  /** @param {boolean} open */
  #open(open) {
    this.#button.setAttribute("aria-expanded", String(open));
    this.#list.hidden = !open;
  }

  /**
   * Which lead would even the load along the face, and the button that gives it to the design.
   *
   * @param {Curve} curve
   */
  showCure({ face }) {
    const words = face && wordsOfCure(face);
    this.#cure.hidden = !words;
    if (!words || !face.cure) return this.#cure.replaceChildren();
    const { cure } = face;
    const leads = "/pair/driving/lead_modifications";
    const apply = () => this.design.set(leads, cured(this.design.get(leads), cure), "mend");
    this.#cure.replaceChildren(words, " ", button("Apply", apply));
  }
}
