// @ts-check
// The tabs of the results. Where there is room for it the geometry stands under the drawing.

import { byId, within } from "../draw/dom.js";

/**
 * What stands under a tab: it is renewed when it is chosen, and told when it is left.
 *
 * @typedef {{ refresh?: () => unknown, leave?: () => void }} TabPanel
 */

export class Tabs {
  #tabs = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[role=tab]")]);
  #large = matchMedia("(min-width: 150rem) and (min-height: 60rem)");
  /** The panel that is shown. */
  current = "curves";

  /** @param {{ panels: () => Record<string, TabPanel>, onLay: (large: boolean) => void }} page */
  constructor({ panels, onLay }) {
    this.panels = panels;
    this.onLay = onLay;
    this.#large.addEventListener("change", () => this.lay());
    for (const each of this.#tabs) {
      each.addEventListener("click", () => this.#choose(each));
      each.addEventListener("keydown", (event) => this.#press(event, each));
    }
    this.lay();
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
    const [sheet, own] = [byId("geometry"), byId("tab-geometry")];
    own.hidden = this.#large.matches;
    if (this.#large.matches) {
      if (this.current === "geometry") this.#choose(this.#tabs[0]);
      within(document, ".drawing-panel", HTMLElement).append(sheet);
      sheet.setAttribute("role", "region");
      sheet.hidden = false;
    } else {
      byId("curves").after(sheet);
      sheet.setAttribute("role", "tabpanel");
      sheet.hidden = this.current !== "geometry";
    }
    this.onLay(this.#large.matches);
  }

  /**
   * Shows the panel of this name.
   *
   * @param {string} name
   */
  show(name) {
    this.#choose(byId(`tab-${name}`));
  }

  /** @param {HTMLElement} chosen */
  #choose(chosen) {
    const nameOf = (/** @type {HTMLElement} */ tab) => tab.getAttribute("aria-controls") ?? "";
    for (const other of this.#tabs) {
      other.setAttribute("aria-selected", String(other === chosen));
      other.tabIndex = other === chosen ? 0 : -1;
      if (!other.hidden) byId(nameOf(other)).hidden = other !== chosen;
    }
    this.panels()[this.current]?.leave?.();
    this.current = nameOf(chosen);
    // Tables want the room that curves leave to the drawing.
    document.body.classList.toggle("tabled", !["curves", "run-up"].includes(this.current));
    this.panels()[this.current]?.refresh?.();
  }
}
