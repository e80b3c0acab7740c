// @ts-check
// The form of a submission, made from the schema: every field with its unit, bounds, default and words.

import { around, button, h } from "../draw/dom.js";
import { Beginnings } from "../state/beginnings.js";
import { Changes } from "../state/changes.js";
import { HELIX, MEMBERS } from "../state/design.js";
import { isSolid, kindOfTeeth, offers } from "../state/dimensions.js";
import { number } from "../state/numbers.js";
import { insteadOf } from "../state/schema.js";
import { clearFault, sayFault } from "./faults.js";
import { Fields, shapeOf } from "./fields.js";
import { materialTool } from "./limits.js";
import { Names } from "./names.js";
import { Sections } from "./sections.js";

/** @import { Design } from "../state/design.js" */
/** @import { FieldError, Limits, Results } from "../state/documents.js" */
/** @import { Api, Kind } from "../state/schema.js" */
/** @import { Field } from "./fields.js" */

/** @typedef {{ pointer: string, kind: Kind, title: string }} Offered */

export class Form {
  /**
   * `notify` says what else a change has changed; `limits` are those of the service, and `results` the last that there
   * are.
   *
   * @param {HTMLElement} place
   * @param {Api} api
   * @param {Design} design
   * @param {{ notify: (words: string) => void, limits: Limits, results: () => Results | undefined }} page
   */
  constructor(place, api, design, { notify, limits, results }) {
    this.place = place;
    this.api = api;
    this.design = design;
    this.beginnings = new Beginnings(api, design, { limits, results });
    this.changes = new Changes(api, design, notify);
    const tools = new Map(MEMBERS.map((member) => [`/pair/${member}/material`, materialTool(member, design)]));
    this.fields = new Fields(api, design, { changes: this.changes, beginnings: this.beginnings, tools });
    this.names = new Names(api, this.fields.shown, this.changes);
    const renew = () => this.render();
    this.sections = new Sections(api, design, { changes: this.changes, fields: this.fields, renew });
    place.addEventListener("submit", (event) => event.preventDefault());
    this.render();
  }

  /**
   * @param {string} selector
   * @returns {NodeListOf<HTMLDetailsElement>}
   */
  #details(selector) {
    return this.place.querySelectorAll(selector);
  }

  /** Makes the form anew from the design, keeping the place of the cursor and what was open. */
  render() {
    const open = new Set([...this.#details("details[open]")].map((each) => each.dataset.pointer));
    const known = this.place.childElementCount > 0;
    const focused = document.activeElement?.id;
    this.fields.shown.clear();
    this.changes.learn();
    this.place.replaceChildren(...this.sections.all());
    this.shape = shapeOf(this.design.submission);
    for (const each of this.#details("details")) if (known) each.open = open.has(each.dataset.pointer);
    this.#showDimensions();
    if (focused && document.activeElement?.id !== focused) document.getElementById(focused)?.focus();
  }

  /** Shows the values of the design in the fields that are there; makes the form anew where other fields are needed. */
  refresh() {
    this.changes.remember();
    if (shapeOf(this.design.submission) !== this.shape) return this.render();
    for (const { show } of this.fields.shown.values()) show();
    this.#showDimensions();
  }

  /**
   * Shows what is wrong at the fields. A section that is closed says so at its head: to open it would close the one
   * that is worked in.
   *
   * @param {FieldError[]} errors
   */
  showErrors(errors = []) {
    for (const field of this.fields.shown.values()) clearFault(field);
    for (const each of this.place.querySelectorAll(".section.wrong")) each.classList.remove("wrong");
    for (const error of errors) {
      const field = this.fields.nearest(error.pointer);
      if (field) sayFault(field, error, this.design, (detail) => this.names.inWords(detail));
    }
  }

  /**
   * Opens every section, or leaves one of them open at a time.
   *
   * @param {boolean} all
   */
  unfold(all) {
    this.sections.unfolded = all;
    for (const section of this.#details(".section")) {
      section.name = all ? "" : "section";
      if (all) section.open = true;
    }
  }

  /**
   * The numbers, words and flags of the form: `{ pointer, title, kind }`.
   *
   * @returns {Offered[]}
   */
  offered() {
    // What both gears have alike cannot be changed by one field, and what stands in place of another not beside it.
    /** @type {(field: Field) => boolean} */
    const stands = ({ pointer }) => {
      const holder = pointer.slice(0, pointer.lastIndexOf("/") + 1);
      return (
        this.design.get(pointer) !== undefined ||
        !insteadOf(this.api, pointer).some((other) => this.design.get(holder + other) !== undefined)
      );
    };
    return [...this.fields.shown.values()].flatMap((field) => {
      const { pointer, kind } = field;
      const isOffered = kind && ["number", "choice", "flag"].includes(kind.kind) && !this.names.isAlike(pointer);
      return isOffered && stands(field) ? [{ pointer, kind, title: this.names.titled(pointer) }] : [];
    });
  }

  /**
   * Brings the field of a pointer into view.
   *
   * @param {string} pointer
   */
  focus(pointer) {
    const field = this.fields.nearest(pointer);
    if (!field) return;
    for (const parent of around(field.element)) parent.open = true;
    /** @type {HTMLElement | null} */
    const input = field.element.querySelector("input, select, textarea");
    input?.scrollIntoView({ block: "center" });
    input?.focus({ preventScroll: true });
  }

  /** Fields that the method does not know are marked, and what was typed for another helix angle is offered anew. */
  #showDimensions() {
    if (this.sections.kindOfTeeth) this.sections.kindOfTeeth.value = kindOfTeeth(this.design.get(HELIX));
    this.place.dataset.dimensions = isSolid(this.design.get("/method")) ? "3" : "2";
    for (const old of this.place.querySelectorAll(".field-offer")) old.remove();
    for (const { pointer, value, angle } of offers(this.design)) {
      const words = `Typed for a helix angle of ${number(angle)}°; ${number(value, 7)} mm has the same teeth at ${number(this.design.get(HELIX) ?? 0)}°. `;
      /** @type {(name: string, work: () => void) => HTMLButtonElement} */
      const mend = (name, work) => button(name, work, { className: "mend" });
      this.fields.nearest(pointer)?.element.append(
        h(
          "p",
          { className: "field-offer", role: "status" },
          words,
          mend(`Use ${number(value, 7)} mm`, () => this.design.set(pointer, value, "mend")),
          " ",
          mend("Keep what was typed", () => this.design.confirm(pointer)),
        ),
      );
    }
  }
}
