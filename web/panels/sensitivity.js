// @ts-check
// The sensitivity of a design as bars around its own value: torque, center distance and misalignment at their limits,
// by one small study.

import { asking, h, inLine, labelled, measured, note, region, s, table, tableRow, unseen } from "../draw/dom.js";
import { given, numeric, put } from "../draw/inputs.js";
import { options } from "./offer.js";
import { offerTold, StudyPanel } from "./panel.js";
import { ProblemError } from "../state/api.js";
import { apart, nameOf } from "../state/design.js";
import { isSolid } from "../state/dimensions.js";
import { fixed } from "../state/numbers.js";
import { inUnit, quantityOf, shown, worstInRow } from "../state/quantities.js";
import { barsOf, js7, studyOf } from "../state/sensitivity.js";

/** @import { Design } from "../state/design.js" */
/** @import { NamedDesign, StudyResults } from "../state/documents.js" */
/** @import { Quantity } from "../state/quantities.js" */
/** @import { Bar } from "../state/sensitivity.js" */
/** @import { Form } from "../views/form.js" */

/** The quantity of the first bars. */
const SHOWN = "transmission_error_um.peak_to_peak";
/** The limits that are offered: of the torque in percent, of misalignment in um. */
const [PERCENT, MISALIGNED] = [20, 10];
/** Width and height of a bar, in px. */
const [WIDTH, HEIGHT] = [260, 18];

/**
 * The sensitivity of a design.
 *
 * @augments {StudyPanel<StudyResults>}
 */
export class Sensitivity extends StudyPanel {
  /** @type {NamedDesign | null} */
  #base = null;

  /**
   * The sensitivity of `design` in `place`; `form` names fields, and `live` waits for the design as it is computed and
   * gives it, or null where it cannot be.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {Form} form
   * @param {() => Promise<NamedDesign | null>} live
   */
  constructor(place, design, form, live) {
    super(place, design, {
      id: "sensitivity",
      words: "Show the bars",
      inWords: (detail) => form.names.inWords(detail),
    });
    this.live = live;
    this.torque = numeric({ id: "sensitivity-torque", value: String(PERCENT) });
    this.distance = numeric({ id: "sensitivity-distance" });
    this.misalignment = numeric({ id: "sensitivity-misalignment", value: String(MISALIGNED) });
    this.distance.addEventListener("input", () => {
      this.distance.dataset.typed = "yes";
    });
    this.quantity = h(
      "select",
      { id: "sensitivity-quantity", on: { change: () => this.last && this.show(this.last.found) } },
      ...options(SHOWN),
    );
    this.picker = inLine(...labelled("Look at", this.quantity));
    this.inPlane = note(
      "Misalignment changes nothing that a method in the plane sees: choose a method in three dimensions for its bars.",
    );
    place.replaceChildren(
      h("h3", {}, "Sensitivity"),
      asking(
        () => void this.start(),
        inLine(
          measured("Torque ±", this.torque, "%"),
          measured("center distance ±", this.distance, "mm"),
          measured("misalignment ±", this.misalignment, "µm"),
          this.run,
          this.cancel,
        ),
      ),
      this.inPlane,
      this.state,
      this.outdated,
      this.picker,
      this.out,
    );
    this.clear();
    this.refresh();
    design.onChange(() => this.refresh());
  }

  clear() {
    super.clear();
    this.picker.hidden = true;
  }

  async start() {
    this.clear();
    this.#base = await this.live();
    return super.start();
  }

  asked() {
    const base = this.#base;
    if (!base)
      throw new ProblemError({ detail: "There are no numbers of this design. Ask again once they stand above." });
    const limits = {
      torque: given(this.torque) ?? 0,
      distance: given(this.distance) ?? 0,
      misalignment: given(this.misalignment) ?? 0,
    };
    if (!Object.values(limits).some((each) => each > 0))
      throw new ProblemError({ detail: "One of the limits has to be above 0." });
    const { curves, further } = apart(base.asked);
    const asked = { ...curves, ...(further.stress ? { stress: further.stress } : {}) };
    return studyOf(asked, limits, `${nameOf(base.submission)}, sensitivity`);
  }

  /** @param {StudyResults} results */
  show(results) {
    offerTold(this.quantity, results);
    const looked = quantityOf(this.quantity.value);
    const { value, bars } = barsOf(results.rows, (row) => worstInRow(looked, row, results.gear));
    this.picker.hidden = value === null;
    this.out.replaceChildren(...(value === null ? [] : [region("Sensitivity", tableOf(looked, value, bars))]));
  }

  /** The limit of the center distance follows it until somebody types another one. */
  refresh() {
    const { pair, method } = this.design.submission;
    const { distance } = this;
    if (!distance.dataset.typed || !distance.value) put(distance, String(js7(pair.center_distance_mm)));
    this.inPlane.hidden = isSolid(method);
    this.misalignment.disabled = !isSolid(method);
  }
}

/**
 * The table of bars.
 *
 * @param {Quantity} quantity
 * @param {number} value that of the design as it is
 * @param {Bar[]} bars
 */
function tableOf(quantity, value, bars) {
  const all = [value, ...bars.flatMap(({ low, high }) => [low ?? value, high ?? value])];
  const [least, most] = [Math.min(...all), Math.max(...all)];
  /** @type {(at: number) => number} */
  const px = (at) => (most > least ? 4 + ((WIDTH - 8) * (at - least)) / (most - least) : WIDTH / 2);
  /** @type {(at: number | null, y: number, name: string) => SVGElement[]} */
  const half = (at, y, name) =>
    at === null
      ? []
      : [
          s("rect", {
            x: Math.min(px(at), px(value)),
            y,
            width: Math.max(1, Math.abs(px(at) - px(value))),
            height: HEIGHT / 2 - 2,
            class: name,
          }),
        ];
  /** @type {(bar: Bar) => HTMLTableRowElement} */
  const row = ({ name, by, low, high, wrong }) => {
    const bar = s(
      "svg",
      { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, "aria-hidden": "true" },
      ...half(low, 1, "less"),
      ...half(high, HEIGHT / 2 + 1, "more"),
      s("line", { x1: px(value), x2: px(value), y1: 0, y2: HEIGHT, stroke: "currentColor", "stroke-width": 1.5 }),
    );
    const largest = Math.max(...[low, high].map((each) => Math.abs((each ?? value) - value)));
    const change = value ? `${fixed((100 * largest) / Math.abs(value), 0)} %` : "–";
    const named = `${name[0].toUpperCase()}${name.slice(1)} ${by}`;
    return tableRow(named, shown(quantity, low), bar, shown(quantity, high), wrong ?? change);
  };
  const names = [
    "What changes",
    h("span", { className: "less" }, "less"),
    unseen("Bar"),
    h("span", { className: "more" }, "more"),
    "at most",
  ];
  const found = table(names, bars.map(row), `${inUnit(quantity)}: ${shown(quantity, value)} as it is`);
  found.className = "sensitivities";
  return found;
}
