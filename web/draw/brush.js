// @ts-check
// Which mesh periods are shown: a strip of the whole true period with a window on it, drawn over, moved, or set by
// buttons.

import { dress, h, s, signButton } from "./dom.js";
import { extent, number } from "../state/numbers.js";
import { linesOf, PANELS } from "../state/series.js";

/** @import { NamedDesign } from "../state/documents.js" */

const [WIDTH, HEIGHT] = [1000, 40];
/** Shorter periods need no strip. */
const LEAST_PERIODS = 12;

export class Brush {
  #whole = 1;
  /** @type {[number, number] | null} */
  #range = null;

  /**
   * The strip in `place`; `onRange` is told the window, or null for all.
   *
   * @param {HTMLElement} place
   * @param {(range: [number, number] | null) => void} onRange
   */
  constructor(place, onRange) {
    this.place = place;
    this.onRange = onRange;
    this.path = s("path", { class: "strip" });
    this.window = s("rect", { class: "window", y: 0, height: HEIGHT });
    this.svg = s(
      "svg",
      { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", "aria-hidden": "true" },
      this.path,
      this.window,
    );
    this.words = h("output", { className: "note" });
    place.append(
      this.svg,
      h(
        "div",
        { className: "buttons" },
        signButton("◀", "Earlier mesh periods", () => this.#move(-0.5)),
        signButton("▶", "Later mesh periods", () => this.#move(0.5)),
        signButton("+", "Zoom in", () => this.#scale(0.5)),
        signButton("−", "Zoom out", () => this.#scale(2)),
        signButton("All", "All mesh periods", () => this.onRange(null)),
        this.words,
      ),
    );
    this.svg.addEventListener("pointerdown", (event) => this.#draw(event));
  }

  /**
   * Shows the transmission error of the live design, which stands first, over the longest period of all that are shown.
   *
   * @param {NamedDesign[]} designs
   */
  show(designs) {
    const [line] = linesOf(PANELS[0], designs);
    this.#whole = line.span;
    this.place.hidden = line.span < LEAST_PERIODS;
    if (this.place.hidden) return;
    const [least, most] = extent(line.values) ?? [0, 1];
    const columns = Array.from({ length: Math.min(500, line.values.length) }, () => [Infinity, -Infinity]);
    line.values.forEach((value, i) => {
      const column = columns[Math.floor((i * columns.length) / line.values.length)];
      column[0] = Math.min(column[0], value ?? Infinity);
      column[1] = Math.max(column[1], value ?? -Infinity);
    });
    /** @type {(i: number) => number} */
    const x = (i) => ((i + 0.5) * WIDTH) / columns.length;
    /** @type {(value: number) => number} */
    const y = (value) => HEIGHT - 3 - ((value - least) / (most - least || 1)) * (HEIGHT - 6);
    const upper = columns.map((column, i) => `${x(i).toFixed(1)} ${y(column[1]).toFixed(1)}`);
    const lower = columns.map((column, i) => `${x(i).toFixed(1)} ${y(column[0]).toFixed(1)}`).reverse();
    this.path.setAttribute("d", `M${[...upper, ...lower].join("L")}Z`);
    this.setRange(this.#range);
  }

  /** @param {[number, number] | null} range */
  setRange(range) {
    this.#range = range;
    const [from, to] = this.#window();
    dress(this.window, { x: (from / this.#whole) * WIDTH, width: ((to - from) / this.#whole) * WIDTH });
    this.words.textContent = range
      ? `periods ${number(from, 3)} to ${number(to, 3)} of ${number(this.#whole)}`
      : `all ${number(this.#whole)} mesh periods; draw over a curve to zoom`;
  }

  /** @returns {[number, number]} */
  #window() {
    return this.#range ?? [0, this.#whole];
  }

  /**
   * @param {number} from
   * @param {number} to
   */
  #set(from, to) {
    const width = Math.min(this.#whole, Math.max(0.1, to - from));
    const begin = Math.min(Math.max(0, from), this.#whole - width);
    this.onRange([begin, begin + width]);
  }

  /** @param {number} parts */
  #move(parts) {
    const [from, to] = this.#window();
    this.#set(from + parts * (to - from), to + parts * (to - from));
  }

  /** @param {number} factor */
  #scale(factor) {
    const [from, to] = this.#window();
    const [middle, half] = [(from + to) / 2, ((to - from) * factor) / 2];
    this.#set(middle - half, middle + half);
  }

  /**
   * A window is moved where the pointer takes it, and drawn anew elsewhere.
   *
   * @param {PointerEvent} event
   */
  #draw(event) {
    if (event.button !== 0) return;
    const box = this.svg.getBoundingClientRect();
    /** @type {(moved: PointerEvent) => number} */
    const at = (moved) => Math.min(1, Math.max(0, (moved.clientX - box.left) / box.width)) * this.#whole;
    const begun = at(event);
    const [from, to] = this.#window();
    const inside = this.#range && begun > from && begun < to;
    /** @type {(moved: PointerEvent) => void} */
    const move = (moved) => {
      const now = at(moved);
      if (inside) this.#set(from + now - begun, to + now - begun);
      else if (Math.abs(now - begun) > 0.05) this.#set(Math.min(begun, now), Math.max(begun, now));
    };
    this.svg.setPointerCapture(event.pointerId);
    this.svg.addEventListener("pointermove", move);
    const end = () => this.svg.removeEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel"]) this.svg.addEventListener(name, end, { once: true });
  }
}
