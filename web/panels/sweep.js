// @ts-check
// The peak-to-peak transmission error over the torque, and where it is least: a study over the torque, which is found
// again as others are.

import { button, h, note } from "../draw/dom.js";
import { figure } from "../draw/figure.js";
import { given, numeric, put } from "../draw/inputs.js";
import { Question } from "./question.js";
import { ProblemError } from "../state/api.js";
import { apart, nameOf } from "../state/design.js";
import { fixed, number } from "../state/numbers.js";

/** @import { Dot, Figure } from "../draw/figure.js" */
/** @import { Watching } from "./question.js" */
/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, StudyResults } from "../state/documents.js" */

const MOST_TORQUES = 24;
/** Points are fetched so often at most while a sweep runs, in milliseconds. */
const PAUSE = 400;
const TORQUE = "/output_torques_n_m";

/**
 * The sweep of `design` in `place`.
 *
 * @param {HTMLElement} place
 * @param {Design} design
 */
export function sweep(place, design) {
  const [from, to] = ["from", "to"].map((end) => numeric({ id: `sweep-${end}` }));
  const question = new Question(design, { id: "sweep", words: "Sweep", ignored: [TORQUE] });
  const out = h("div", { className: "out" });
  for (const input of [from, to])
    input.addEventListener("input", () => {
      input.dataset.typed = "yes";
    });
  const form = h(
    "form",
    {
      className: "line",
      on: {
        submit: (event) => {
          event.preventDefault();
          start();
        },
      },
    },
    h("label", { htmlFor: "sweep-from" }, "Torque from"),
    from,
    h("span", { className: "unit" }, "N m"),
    h("label", { htmlFor: "sweep-to" }, "to"),
    to,
    h("span", { className: "unit" }, "N m"),
    question.run,
    question.cancel,
  );
  place.replaceChildren(
    h("h3", {}, "Transmission error over torque"),
    note("At which torque is the transmission error flattest? A tip relief suits one torque; this shows which."),
    form,
    question.state,
    question.of.element,
    out,
  );

  /** From a tenth of the design's torque to twice as much, until somebody types other ones. */
  const suggest = () => {
    const torque = design.get(`${TORQUE}/0`) ?? 100;
    if (!from.dataset.typed || !from.value) put(from, number(torque / 10, 2));
    if (!to.dataset.typed || !to.value) put(to, number(torque * 2, 2));
  };

  /** @type {Watching<StudyResults>} */
  const how = {
    part: "/results",
    pause: PAUSE,
    show: ({ rows, status }) => {
      const points = rows
        .flatMap((row) =>
          row.curves.map((curve) => ({
            x: curve.output_torque_n_m,
            y: curve.statistics?.transmission_error_um.peak_to_peak ?? NaN,
            label: `${number(curve.output_torque_n_m)} N m`,
          })),
        )
        .filter(({ y }) => Number.isFinite(y))
        .sort((a, b) => a.x - b.x);
      out.replaceChildren(...(points.length ? shown(points, status) : []));
    },
    progress: (done, total, left) => `${done} of ${total} torques${left(done, total)}`,
    ended: ({ rows, status }) =>
      status === "dismissed"
        ? `Cancelled after ${rows.filter(({ curves }) => curves?.length).length} torques.`
        : (rows.find(({ problem }) => problem)?.problem?.detail ?? ""),
  };

  function start() {
    out.replaceChildren();
    return question.study(() => {
      const [low = 0, high = 0] = [given(from), given(to)];
      if (!(low > 0 && high > low))
        throw new ProblemError({ detail: "The torques have to be positive, the second larger than the first." });
      question.say("Computing");
      const torques = Array.from({ length: MOST_TORQUES }, (_, i) =>
        Number((low + ((high - low) * i) / (MOST_TORQUES - 1)).toPrecision(6)),
      );
      const { curves: base } = apart(design.submission);
      return {
        base,
        keep: "statistics",
        axes: [{ path: TORQUE, values: torques.map((torque) => [torque]) }],
        name: `${nameOf(base)}, torque sweep`,
      };
    }, how);
  }

  /**
   * Shows a sweep that was asked for before.
   *
   * @param {string} id
   * @param {AskedStudy} study
   */
  function resume(id, { base, axes }) {
    const values = axes?.[0].values ?? [];
    [from.value, to.value] = [String(values[0]), String(values.at(-1))];
    for (const input of [from, to]) input.dataset.typed = "yes";
    out.replaceChildren();
    return question.resume(id, base, how);
  }

  /** @type {(points: Dot[]) => Figure} */
  const pictureOf = (points) =>
    figure({
      points,
      lines: [{ x: points.map((point) => point.x), y: points.map((point) => point.y) }],
      x: "output torque in N m",
      y: "STE peak-to-peak in µm",
      title: "Peak-to-peak transmission error over the torque",
    });

  /**
   * @param {Dot[]} points
   * @param {string} status
   */
  function shown(points, status) {
    if (status !== "successful") return [pictureOf(points)];
    const least = points.reduce((best, point) => (point.y < best.y ? point : best));
    least.strong = true;
    least.label = `least: ${fixed(least.y, 3)} µm at ${number(least.x)} N m`;
    const use = button(`Show ${number(least.x)} N m`, () => design.set(TORQUE, [least.x], "mend"));
    const atEnd = least === points[0] || least === points.at(-1);
    const words = atEnd ? "The least lies at an end of the sweep; a wider one may find less." : "";
    return [
      h(
        "p",
        {},
        `Least peak-to-peak of these torques: ${fixed(least.y, 3)} µm at ${number(least.x)} N m. ${words} `,
        use,
      ),
      pictureOf(points),
    ];
  }

  suggest();
  return { refresh: suggest, resume };
}
