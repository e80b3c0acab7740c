// @ts-check
// The sensitivity of a design as bars around its own value: torque, center distance and misalignment at their limits,
// by one small study.

import { asking, h, inLine, labelled, note, region, s, table, tableRow, unseen } from "../draw/dom.js";
import { given, numeric, put } from "../draw/inputs.js";
import { options } from "./offer.js";
import { Question } from "./question.js";
import { ProblemError } from "../state/api.js";
import { apart, nameOf } from "../state/design.js";
import { isSolid } from "../state/dimensions.js";
import { fixed } from "../state/numbers.js";
import { inUnit, quantityOf, shown, worstInRow } from "../state/quantities.js";
import { barsOf, js7, studyOf } from "../state/sensitivity.js";

/** @import { Watching } from "./question.js" */
/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, NamedDesign, StudyResults } from "../state/documents.js" */
/** @import { Quantity } from "../state/quantities.js" */
/** @import { Bar } from "../state/sensitivity.js" */
/** @import { Form } from "../views/form.js" */

/** Bars are fetched so often at most while the study runs, in milliseconds. */
const PAUSE = 400;
/** The quantity of the first bars. */
const SHOWN = "transmission_error_um.peak_to_peak";
/** The limits that are offered: of the torque in percent, of misalignment in um. */
const [PERCENT, MISALIGNED] = [20, 10];
/** Width and height of a bar, in px. */
const [WIDTH, HEIGHT] = [260, 18];

/**
 * The sensitivity of `design` in `place`; `form` names fields, and `live` waits for the design as it is computed and
 * gives it, or null where it cannot be.
 *
 * @param {HTMLElement} place
 * @param {Design} design
 * @param {Form} form
 * @param {() => Promise<NamedDesign | null>} live
 */
export function sensitivity(place, design, form, live) {
  const torque = numeric({ id: "sensitivity-torque", value: String(PERCENT) });
  const distance = numeric({ id: "sensitivity-distance" });
  const misalignment = numeric({ id: "sensitivity-misalignment", value: String(MISALIGNED) });
  distance.addEventListener("input", () => {
    distance.dataset.typed = "yes";
  });
  const question = new Question(design, {
    id: "sensitivity",
    words: "Show the bars",
    inWords: (detail) => form.inWords(detail),
  });
  const quantity = h(
    "select",
    { id: "sensitivity-quantity", on: { change: () => last && draw(last) } },
    ...options(SHOWN),
  );
  const picker = inLine(...labelled("Look at", quantity));
  picker.hidden = true;
  const inPlane = note(
    "Misalignment changes nothing that a method in the plane sees: choose a method in three dimensions for its bars.",
  );
  const out = h("div", { className: "out", id: "sensitivity-out" });
  place.replaceChildren(
    h("h3", {}, "Sensitivity"),
    asking(
      () => void start(),
      inLine(
        ...labelled("Torque ±", torque),
        h("span", { className: "unit" }, "%"),
        ...labelled("center distance ±", distance),
        h("span", { className: "unit" }, "mm"),
        ...labelled("misalignment ±", misalignment),
        h("span", { className: "unit" }, "µm"),
        question.run,
        question.cancel,
      ),
    ),
    inPlane,
    question.state,
    question.of.element,
    picker,
    out,
  );
  /** @type {StudyResults | null} */
  let last = null;

  /** @type {Watching<StudyResults>} */
  const how = {
    part: "/results",
    pause: PAUSE,
    show: (results) => {
      last = results;
      draw(results);
    },
    progress: (done, total, left) => `${done} of ${total} designs${left(done, total)}`,
    ended: ({ done, total, status }) => `${done} of ${total} designs, ${status}`,
  };

  function clear() {
    last = null;
    picker.hidden = true;
    out.replaceChildren();
  }

  async function start() {
    clear();
    const base = await live();
    return question.study(() => {
      if (!base)
        throw new ProblemError({ detail: "There are no numbers of this design. Ask again once they stand above." });
      const limits = {
        torque: given(torque) ?? 0,
        distance: given(distance) ?? 0,
        misalignment: given(misalignment) ?? 0,
      };
      if (!Object.values(limits).some((each) => each > 0))
        throw new ProblemError({ detail: "One of the limits has to be above 0." });
      const { curves, further } = apart(base.asked);
      const asked = { ...curves, ...(further.stress ? { stress: further.stress } : {}) };
      return studyOf(asked, limits, `${nameOf(base.submission)}, sensitivity`);
    }, how);
  }

  /**
   * Shows bars that were asked for before.
   *
   * @param {string} id
   * @param {AskedStudy} study
   */
  function resume(id, { base }) {
    clear();
    return question.resume(id, base, how);
  }

  /** @param {StudyResults} results */
  function draw({ rows, gear }) {
    const computed = rows.filter((row) => row.curves?.length);
    for (const option of quantity.options)
      option.hidden = !computed.some((row) => Number.isFinite(worstInRow(quantityOf(option.value), row, gear)));
    const looked = quantityOf(quantity.value);
    const { value, bars } = barsOf(rows, (row) => worstInRow(looked, row, gear));
    picker.hidden = value === null;
    if (value === null) return out.replaceChildren();
    return out.replaceChildren(region("Sensitivity", tableOf(looked, value, bars)));
  }

  /** The limit of the center distance follows it until somebody types another one. */
  function refresh() {
    const { pair, method } = design.submission;
    if (!distance.dataset.typed || !distance.value) put(distance, String(js7(pair.center_distance_mm)));
    inPlane.hidden = isSolid(method);
    misalignment.disabled = !isSolid(method);
  }

  refresh();
  design.onChange(refresh);
  return { refresh, resume };
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
