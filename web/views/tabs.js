// @ts-check
// The questions that the results answer, one tab each, and the tabs of the design's data, its jobs and its files. Where
// there is room for it the geometry stands under the drawing.

import { byId, within } from "../draw/dom.js";

/**
 * A panel under a tab: it is renewed when the tab is chosen, and told when the tab is left.
 *
 * @typedef {{ refresh?: () => unknown, leave?: () => void }} TabPanel
 */

/** Panels beside which the drawing keeps its size; tables take a part of its room. */
const BESIDE_DRAWING = ["curves", "run-up"];

/**
 * The ids of the panels of a tab.
 *
 * @type {(tab: HTMLElement) => string[]}
 */
const panelsOf = (tab) => (tab.getAttribute("aria-controls") ?? "").split(" ");

export class Tabs {
  #tabs = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[role=tab]")]);
  #large = matchMedia("(min-width: 150rem) and (min-height: 60rem)");
  #chosen = this.#tabs[0];

  /**
   * @param {{
   *   panels: () => Record<string, TabPanel>,
   *   onLay: () => void,
   *   onQuestion: (question: string) => void,
   * }} page
   */
  constructor({ panels, onLay, onQuestion }) {
    this.panels = panels;
    this.onLay = onLay;
    this.onQuestion = onQuestion;
    this.#large.addEventListener("change", () => this.lay());
    for (const each of this.#tabs) {
      each.addEventListener("click", () => this.#choose(each));
      each.addEventListener("keydown", (event) => this.#press(event, each));
    }
    this.lay();
  }

  /** True if the geometry stands under the drawing. */
  get isLarge() {
    return this.#large.matches;
  }

  /** The name of the chosen tab. */
  get question() {
    return this.#chosen.id.replace("tab-", "");
  }

  /**
   * True if the panel of this id is under the chosen tab.
   *
   * @param {string} id
   */
  shows(id) {
    return panelsOf(this.#chosen).includes(id);
  }

  /** Renews the panels of the chosen tab. */
  refresh() {
    for (const id of panelsOf(this.#chosen)) this.panels()[id]?.refresh?.();
  }

  /**
   * @param {KeyboardEvent} event
   * @param {HTMLElement} tab
   */
  #press(event, tab) {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (!by) return;
    const seen = this.#tabs.filter(({ hidden }) => !hidden);
    const next = seen[(seen.indexOf(tab) + by + seen.length) % seen.length];
    next.focus();
    this.#choose(next);
  }

  /** Lays the page out for the room that there is. */
  lay() {
    const [sheet, own] = [byId("geometry"), byId("tab-data")];
    own.hidden = this.#large.matches;
    if (this.#large.matches) {
      if (this.shows("geometry")) this.#choose(this.#tabs[0]);
      within(document, ".drawing-panel", HTMLElement).append(sheet);
      sheet.setAttribute("role", "region");
      sheet.hidden = false;
    } else {
      byId("study").after(sheet);
      sheet.setAttribute("role", "tabpanel");
      sheet.hidden = !this.shows("geometry");
    }
    this.onLay();
  }

  /**
   * Shows the panel of this id under its first tab.
   *
   * @param {string} id
   */
  show(id) {
    const tab = this.#tabs.find((each) => panelsOf(each).includes(id));
    if (!tab) return;
    this.#choose(tab);
    byId(id).scrollIntoView({ block: "nearest" });
  }

  /** @param {HTMLElement} chosen */
  #choose(chosen) {
    const before = panelsOf(this.#chosen);
    const now = panelsOf(chosen);
    for (const other of this.#tabs) {
      other.setAttribute("aria-selected", String(other === chosen));
      other.tabIndex = other === chosen ? 0 : -1;
      if (!other.hidden) for (const id of panelsOf(other)) byId(id).hidden = !now.includes(id);
    }
    for (const id of now) byId(id).setAttribute("aria-labelledby", chosen.id);
    for (const id of before) if (!now.includes(id)) this.panels()[id]?.leave?.();
    this.#chosen = chosen;
    document.body.classList.toggle("tabled", !now.some((id) => BESIDE_DRAWING.includes(id)));
    this.onQuestion(this.question);
    this.refresh();
  }
}
