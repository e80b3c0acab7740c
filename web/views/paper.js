// @ts-check
// What goes onto paper and into pictures: the one page of a design, and the report of the project.

import { byId, within } from "../draw/dom.js";
import { save } from "../draw/download.js";
import { fileOf, pictureOf } from "../draw/figure.js";
import { usualAt } from "../state/schema.js";
import { fileOfDesign } from "../state/tables.js";
import { nameFoot, reportOf } from "./report.js";
import { sheetOf } from "./sheet.js";

/** @import { Charts } from "../draw/charts.js" */
/** @import { NamedDesign } from "../state/documents.js" */
/** @import { Store } from "../state/store.js" */
/** @import { Form } from "./form.js" */
/** @import { Answer } from "./report.js" */

/** The paper of the page. */
export class Paper {
  /** True while the one page of the design is printed in place of the report of the project. */
  #isOnePage = false;

  /**
   * The paper of the designs of `store`. `current` waits for the design as it is and gives it, or null, which it has
   * said, where there is no report.
   *
   * @param {Store} store
   * @param {{ form: Form, charts: Charts, drawing: SVGSVGElement, current: () => Promise<NamedDesign | null> }} page
   */
  constructor(store, { form, charts, drawing, current }) {
    this.store = store;
    this.form = form;
    this.charts = charts;
    this.drawing = drawing;
    this.current = current;
    // However somebody prints, a report comes of it: of the design, or where that is not computed yet of the one
    // before, under its name.
    addEventListener("beforeprint", () => this.#lay());
    addEventListener("afterprint", () => {
      this.#isOnePage = false;
    });
  }

  /**
   * The page of a design.
   *
   * @param {NamedDesign} live
   */
  sheet(live) {
    return sheetOf({ live, drawing: this.drawing, charts: this.charts, form: this.form });
  }

  /**
   * Prints the one page of the design, or the report of the project.
   *
   * @param {boolean} isOnePage
   */
  async print(isOnePage) {
    if (!(await this.current())) return;
    this.#isOnePage = isOnePage;
    this.#lay();
    window.print();
  }

  /** @param {"svg" | "png"} kind */
  async picture(kind) {
    const live = await this.current();
    if (!live) return;
    const page = this.sheet(live);
    if (kind === "svg") save(fileOfDesign(live.name, "report.svg"), "image/svg+xml", fileOf(page));
    else save(fileOfDesign(live.name, "report.png"), "image/png", await pictureOf(page));
  }

  /** Puts onto paper what is printed, of the design that was computed last. */
  #lay() {
    const { answer, project } = this.store;
    const { live } = answer;
    if (!live) return;
    const place = byId("sheet");
    place.classList.toggle("one", this.#isOnePage);
    if (this.#isOnePage) return place.replaceChildren(this.sheet(live));
    const { author, drawing, notes } = project;
    const title = { name: project.known?.name ?? project.name, author, drawing, notes };
    nameFoot({ ...title, name: title.name || live.name });
    return place.replaceChildren(
      ...reportOf({
        title,
        live,
        designs: this.store.besideKept(live),
        drawing: this.drawing,
        charts: this.charts,
        form: this.form,
        usual: (submission, pointer) => usualAt(this.form.api, submission, pointer),
        contact: byId("pattern"),
        answers: [answerOf("Sensitivity", "sensitivity"), answerOf("As made", "population")],
      }),
    );
  }
}

/**
 * The answer of a panel.
 *
 * @type {(title: string, id: string) => Answer}
 */
const answerOf = (title, id) => ({
  title,
  place: within(byId(id), ".out", HTMLElement),
  isOutdated: !within(byId(id), ".outdated", HTMLElement).hidden,
});
