// The peak-to-peak transmission error over the torque, and where it is least.

import { hasEnded, request } from "./api.js";
import { apart } from "./design.js";
import { h, fixed, number, timeLeft } from "./dom.js";
import { figure } from "./figure.js";
import { resultsOf } from "./preview.js";
import { Question } from "./question.js";

const MOST_TORQUES = 24;

/** The sweep of `design` in `place`; `limits` tells how many positions a preview may have, `positionsOf` how many a torque has. What has more is computed by jobs. */
export function sweep(place, design, limits, positionsOf) {
  const from = h("input", { type: "number", id: "sweep-from", step: "any", min: 0 });
  const to = h("input", { type: "number", id: "sweep-to", step: "any", min: 0 });
  const question = new Question(design, { id: "sweep", words: "Sweep", ignored: ["/output_torques_n_m"] });
  const out = h("div", { className: "out" });
  /** The last job that computed torques, where a preview does not. */
  let job = null;
  for (const input of [from, to]) input.addEventListener("input", () => { input.dataset.typed = "yes"; });
  const form = h("form", { className: "line", on: { submit: (event) => { event.preventDefault(); start(); } } },
    h("label", { htmlFor: "sweep-from" }, "Torque from"), from, h("span", { className: "unit" }, "N m"),
    h("label", { htmlFor: "sweep-to" }, "to"), to, h("span", { className: "unit" }, "N m"), question.run, question.cancel);
  place.replaceChildren(h("p", { className: "note" }, "At which torque is the transmission error flattest? A tip relief suits one torque; this shows which."), form, question.state, question.of.element, out);

  /** From a tenth of the design's torque to twice as much, until somebody types other ones. */
  const suggest = () => {
    const torque = design.get("/output_torques_n_m/0") ?? 100;
    if (!from.dataset.typed || !from.value) from.value = number(torque / 10, 2);
    if (!to.dataset.typed || !to.value) to.value = number(torque * 2, 2);
  };

  function start() {
    const [low, high] = [Number(from.value), Number(to.value)];
    if (!(low > 0 && high > low)) return question.refuse("The torques have to be positive, the second larger than the first.");
    job = null;
    out.replaceChildren();
    question.say("Computing");
    return question.ask(async (cancelling) => {
      const [stop, points] = [new AbortController(), []];
      cancelling(() => stop.abort());
      try {
        await fill(points, low, high, stop.signal);
        question.say("");
        out.replaceChildren(...shown(points));
      } catch (error) {
        if (error.name !== "AbortError") throw error;
        question.say(`Cancelled after ${points.length} torques.`);
        if (job && !hasEnded(job.status)) request(`v1/jobs/${job.id}/cancel`, { method: "POST" }).catch(() => {});
      }
    });
  }

  /** Adds the points of a sweep, which are seen as they come: as many torques in one request as a preview may have, and the rest in further ones. */
  async function fill(points, low, high, signal) {
    const begun = performance.now();
    const torques = Array.from({ length: MOST_TORQUES }, (_, i) => Number((low + ((high - low) * i) / (MOST_TORQUES - 1)).toPrecision(6)));
    const each = Math.max(1, Math.floor(limits.previews.positions / Math.max(1, positionsOf())));
    const { curves: submission } = apart(design.submission);
    for (let i = 0; i < torques.length; i += each) {
      if (points.length) {
        question.say(`${i} of ${torques.length} torques${timeLeft(begun, i, torques.length)}`);
        out.replaceChildren(pictureOf(points));
      }
      const results = await resultsOf({ ...submission, output_torques_n_m: torques.slice(i, i + each) }, { signal, told: (event, data) => { if (event === "status") job = data; } });
      for (const curve of results.curves) points.push({ x: curve.output_torque_n_m, y: curve.statistics.transmission_error_um.peak_to_peak, label: `${number(curve.output_torque_n_m)} N m` });
    }
  }

  const pictureOf = (points) => figure({ points, lines: [{ x: points.map((point) => point.x), y: points.map((point) => point.y) }], x: "output torque in N m", y: "STE peak-to-peak in µm", title: "Peak-to-peak transmission error over the torque" });

  function shown(points) {
    const least = points.reduce((best, point) => (point.y < best.y ? point : best));
    least.strong = true;
    least.label = `least: ${fixed(least.y, 3)} µm at ${number(least.x)} N m`;
    const use = h("button", { type: "button", on: { click: () => design.set("/output_torques_n_m", [least.x], "mend") } }, `Show ${number(least.x)} N m`);
    const atEnd = least === points[0] || least === points.at(-1);
    const words = atEnd ? "The least lies at an end of the sweep; a wider one may find less." : "";
    return [h("p", {}, `Least peak-to-peak of these torques: ${fixed(least.y, 3)} µm at ${number(least.x)} N m. ${words} `, use), pictureOf(points)];
  }

  suggest();
  return { refresh: suggest };
}
