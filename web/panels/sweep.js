// @ts-check
// The peak-to-peak transmission error over the torque, and where it is least: a study over the torque, which is found
// again as others are.

import { asking, button, h, inLine, measured, note } from "../draw/dom.js";
import { figure, roomIn } from "../draw/figure.js";
import { given, numeric, put } from "../draw/inputs.js";
import { StudyPanel } from "./panel.js";
import { ProblemError } from "../state/api.js";
import { apart, nameOf, withValue } from "../state/design.js";
import { markInRow } from "../state/marks.js";
import { fixed, number } from "../state/numbers.js";

/** @import { Dot, Figure } from "../draw/figure.js" */
/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, StudyResults } from "../state/documents.js" */
/** @import { Form } from "../views/form.js" */
/** @typedef {Dot & { mark?: { word: string, detail: string } }} SweptDot a torque, with the mark of its number */

const MOST_TORQUES = 24;
const TORQUE = "/output_torques_n_m";
const PEAK_TO_PEAK = "transmission_error_um.peak_to_peak";

/**
 * The sweep of a design.
 *
 * @augments {StudyPanel<StudyResults>}
 */
export class Sweep extends StudyPanel {
  /**
   * The sweep of `design` in `place`; `form` names fields.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {Form} form
   */
  constructor(place, design, form) {
    super(place, design, {
      id: "sweep",
      words: "Sweep",
      inWords: (detail) => form.names.inWords(detail),
      ignored: [TORQUE],
    });
    this.ends = ["from", "to"].map((end) => numeric({ id: `sweep-${end}`, ariaLabel: `Torque ${end}` }));
    for (const input of this.ends)
      input.addEventListener("input", () => {
        input.dataset.typed = "yes";
      });
    const [from, to] = this.ends;
    place.replaceChildren(
      h("h3", {}, "Transmission error over torque"),
      note("At which torque is the transmission error flattest? A tip relief suits one torque; this shows which."),
      asking(
        () => void this.start(),
        inLine(measured("Torque from", from, "N m"), measured("to", to, "N m"), this.run, this.cancel),
      ),
      this.state,
      this.outdated,
      this.out,
    );
    this.refresh();
  }

  /** Shows from a tenth to twice the torque of the design, until others are typed. */
  refresh() {
    const torque = this.design.get(`${TORQUE}/0`) ?? 100;
    for (const [i, part] of [0.1, 2].entries()) {
      const input = this.ends[i];
      if (!input.dataset.typed || !input.value) put(input, number(torque * part, 2));
    }
  }

  /** @returns {AskedStudy} */
  asked() {
    const [low = 0, high = 0] = this.ends.map(given);
    if (!(low > 0 && high > low))
      throw new ProblemError({ detail: "The torques have to be positive, the second larger than the first." });
    this.say("Computing");
    const torques = Array.from({ length: MOST_TORQUES }, (_, i) =>
      Number((low + ((high - low) * i) / (MOST_TORQUES - 1)).toPrecision(6)),
    );
    const { curves: base } = apart(this.design.submission);
    return {
      base,
      keep: "statistics",
      axes: [{ path: TORQUE, values: torques.map((torque) => [torque]) }],
      name: `${nameOf(base)}, torque sweep`,
    };
  }

  /**
   * @param {string} id
   * @param {AskedStudy} study
   */
  resume(id, study) {
    const values = study.axes?.[0].values ?? [];
    for (const [i, input] of this.ends.entries()) {
      input.value = String(values.at(-i));
      input.dataset.typed = "yes";
    }
    return super.resume(id, study);
  }

  /** @type {StudyPanel<StudyResults>["progress"]} */
  progress(done, total, left) {
    return `${done} of ${total} torques${left(done, total)}`;
  }

  /** @param {StudyResults} found */
  ended({ rows, status }) {
    return status === "dismissed"
      ? `Cancelled after ${rows.filter(({ curves }) => curves?.length).length} torques.`
      : this.inWords(rows.find(({ problem }) => problem)?.problem?.detail ?? "");
  }

  /** @param {StudyResults} found */
  show({ rows, status }) {
    const points = rows
      .flatMap((row) =>
        row.curves.map((curve) => ({
          x: curve.output_torque_n_m,
          y: curve.statistics?.transmission_error_um.peak_to_peak ?? NaN,
          label: `${number(curve.output_torque_n_m)} N m`,
          mark: markInRow(PEAK_TO_PEAK, row),
        })),
      )
      .filter(({ y }) => Number.isFinite(y))
      .sort((a, b) => a.x - b.x);
    const least = status === "successful" && points.length ? this.#leastOf(points) : [];
    this.out.replaceChildren(...least, ...(points.length ? [pictureOf(points, roomIn(this.out))] : []));
  }

  /**
   * Gives the design the torque, or opens the one that was swept.
   *
   * @param {number} torque
   */
  #open(torque) {
    if (!this.about || this.isOf(this.design.submission)) return this.design.set(TORQUE, [torque], "mend");
    this.design.replace(withValue(this.about.base, TORQUE, [torque]), "open");
  }

  /**
   * The least of the points in words; its point is larger than the others, unless a warning limits what they say.
   *
   * @param {SweptDot[]} points
   */
  #leastOf(points) {
    const least = points.reduce((best, point) => (point.y < best.y ? point : best));
    const told = `${fixed(least.y, 3)} µm at ${number(least.x)} N m`;
    const use = button(`Show ${number(least.x)} N m`, () => this.#open(least.x));
    const atEnd = least === points[0] || least === points.at(-1);
    const words = atEnd ? "The least lies at an end of the sweep; a wider one may find less." : "";
    const mark = points.map((point) => point.mark).find(Boolean);
    if (mark) {
      const said = `Smallest number of these torques: ${told}, which is not called the least: `;
      return [h("p", {}, said, h("span", { className: "mark" }, mark.word), ` ${mark.detail} `, use)];
    }
    least.strong = true;
    least.label = `least: ${told}`;
    return [h("p", {}, `Least peak-to-peak of these torques: ${told}. ${words} `, use)];
  }
}

/** @type {(points: Dot[], width: number) => Figure} */
const pictureOf = (points, width) =>
  figure({
    points,
    lines: [{ x: points.map((point) => point.x), y: points.map((point) => point.y) }],
    x: "output torque in N m",
    y: "STE peak-to-peak in µm",
    title: "Peak-to-peak transmission error over the torque",
    width,
  });
