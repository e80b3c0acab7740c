// @ts-check
// Where the flanks carry, and how much: the largest pressure of the period over face and diameter. A job tells it, so
// it is asked for by a press.

import { button, h, note, s } from "../draw/dom.js";
import { cssOf, scaleOf } from "../draw/face.js";
import { figure } from "../draw/figure.js";
import { checked, hasEnded, isAborted, json, patiently, ProblemError, request, solved } from "../state/api.js";
import { MEMBERS, same } from "../state/design.js";
import { fixed, number, timeOf } from "../state/numbers.js";
import { begin, tellsOf } from "../state/work.js";

/** @import { ContactPattern, GearName, NamedDesign, Submission } from "../state/documents.js" */

const HATCH = "sharp-edge";
const SHOW = "Show the flanks";
/** Of which design somebody waits for the flanks, so that a reload asks for them again. */
const AWAITED = "meshwright-flanks";

/** The flanks of the live design in `place`; `live` waits for it and gives it, or null where it cannot be computed. */
export class Pattern {
  /** @type {Submission | null} */
  #shown = null;
  /**
   * Stops what is asked for; null while nothing is.
   *
   * @type {AbortController | null}
   */
  #asking = null;

  /**
   * @param {HTMLElement} place
   * @param {{ live: () => Promise<NamedDesign | null> }} parts
   */
  constructor(place, { live }) {
    this.live = live;
    this.legend = h("p", { className: "legend" });
    this.button = button(SHOW, () => (this.#asking ? this.#asking.abort() : this.#ask()));
    this.state = h("p", { className: "note", role: "status" });
    this.flanks = h("div", { className: "columns" });
    this.element = h(
      "figure",
      { className: "chart", id: "chart-pattern", hidden: true, aria: { label: "Contact pattern" } },
      h("figcaption", {}, h("strong", {}, "Contact pattern"), " largest pressure of the period in MPa", this.legend),
      this.button,
      this.state,
      this.flanks,
    );
    place.append(this.element);
  }

  /**
   * The design is another one: what is seen of the one before goes away.
   *
   * @param {NamedDesign} design
   */
  show({ results, submission }) {
    this.element.hidden = !results.curves[0].face;
    if (this.#shown && same(this.#shown, submission)) return;
    if (this.#shown) this.#asking?.abort();
    this.#shown = null;
    this.button.hidden = false;
    this.state.textContent = "";
    for (const part of [this.legend, this.flanks]) part.replaceChildren();
    if (!this.element.hidden && !this.#asking && sessionStorage.getItem(AWAITED) === JSON.stringify(submission))
      this.#ask();
  }

  /**
   * Asks for the flanks: of a job, and then of a request that computes them, which waits for them for as long as they
   * take.
   */
  async #ask() {
    const asking = (this.#asking = new AbortController());
    const { signal } = asking;
    const work = begin("Contact pattern", () => asking.abort());
    const hear = tellsOf(work);
    this.button.textContent = "Stop";
    /** @type {number | undefined} */
    let tick;
    /** @type {{ id: string, status: string } | undefined} */
    let job;
    const live = await this.live();
    const mine = () => this.#shown === live?.submission;
    try {
      if (!live)
        throw new ProblemError({ detail: "There are no numbers of this design. Ask again once they stand above." });
      this.#shown = live.submission;
      sessionStorage.setItem(AWAITED, JSON.stringify(live.submission));
      // Every position is solved again, by the whole method.
      const { estimate } = await checked({ ...live.asked, method: "three_dimensional" }, { signal });
      const begun = performance.now();
      work.tell({ name: `${live.name}, contact pattern`, seconds: estimate.seconds });
      const clock = () => {
        const left = 1000 * estimate.seconds - (performance.now() - begun);
        if (mine())
          this.state.textContent = `It is computed at every position${left > 0 ? `, about ${timeOf(left)} more` : `, longer than the ${timeOf(1000 * estimate.seconds)} that were expected`}.`;
      };
      clock();
      tick = setInterval(clock, 1000);
      /** @type {(event: string, data: any) => void} */
      const told = (event, data) => {
        if (event === "status") job = data;
        hear(event, data);
      };
      const { id } = await solved(live.asked, { told, signal });
      const [{ output_torque_n_m: torque }] = live.results.curves;
      const pattern = await patiently(() =>
        json(`v1/jobs/${id}/results/contact-pattern.json?torque=${torque}`, { signal }),
      );
      if (!mine()) return;
      this.#draw(pattern);
      this.button.hidden = true;
    } catch (error) {
      if (isAborted(error)) {
        if (job && !hasEnded(job.status)) request(`v1/jobs/${job.id}/cancel`, { method: "POST" }).catch(() => {});
      } else if (!(error instanceof ProblemError)) throw error;
      if (!live || mine()) this.state.textContent = error instanceof ProblemError ? error.reason : "Stopped.";
    } finally {
      work.end();
      clearInterval(tick);
      if (this.#asking === asking) {
        this.#asking = null;
        this.button.textContent = SHOW;
        sessionStorage.removeItem(AWAITED);
      }
    }
  }

  /** @param {ContactPattern} pattern */
  #draw(pattern) {
    const [{ largest_pressure_mpa: most, output_torque_n_m: torque, ...curve }] = pattern.curves;
    this.legend.replaceChildren(scaleOf(most, "MPa"));
    const sharp = MEMBERS.some((gear) => curve[gear].pressure_mpa.flat().includes(null));
    this.state.textContent = `At ${number(torque)} N m, from the form diameter to the tip. Empty: nothing touches.${sharp ? " Hatched: a sharp tip edge carries, where the pressure has no limit." : ""}`;
    this.flanks.replaceChildren(...MEMBERS.map((gear) => flankOf(gear, pattern, curve[gear].pressure_mpa, most)));
  }
}

/**
 * The edges of cells whose middles are these.
 *
 * @type {(middles: number[]) => number[]}
 */
const edgesOf = (middles) =>
  middles.map((middle, i) => middle - (i ? middle - middles[i - 1] : middles[1] - middle) / 2);

/**
 * The flank of a gear over face and diameter.
 *
 * @type {(gear: GearName, pattern: ContactPattern, pressures: (number | null)[][], most: number) => HTMLElement}
 */
function flankOf(
  gear,
  { z_mm: z, [gear]: { diameter_mm: diameters, form_diameter_mm: form, tip_diameter_mm: tip } },
  pressures,
  most,
) {
  const [x, y] = [edgesOf(z), edgesOf(diameters)];
  const [width, height] = [z[1] - z[0], diameters[1] - diameters[0]];
  const touched = pressures.flatMap((row, i) =>
    row.flatMap((pressure, j) => (pressure === 0 ? [] : [{ pressure, i, j }])),
  );
  const cells = touched.map(({ pressure, i, j }) => ({
    x: x[j],
    y: y[i],
    width,
    height,
    color: pressure === null ? `url(#${HATCH}-${gear})` : cssOf(pressure / most),
  }));
  const known = touched.flatMap(({ pressure, i, j }) => (pressure === null ? [] : [{ pressure, i, j }]));
  const edges = touched.length - known.length;
  const top = known.length ? known.reduce((best, each) => (each.pressure > best.pressure ? each : best)) : null;
  const told = top
    ? `at most ${fixed(top.pressure, 0)} MPa, at z = ${fixed(z[top.j], 1)} mm and a diameter of ${fixed(diameters[top.i], 1)} mm`
    : "no pressure that has a limit";
  const words = `The ${gear} flank carries over ${fixed((100 * touched.length) / (z.length * diameters.length), 0)} % of what is drawn, ${told}${edges ? `; a sharp tip edge carries on ${fixed((100 * edges) / touched.length, 0)} % of it` : ""}.`;
  const svg = figure({
    title: `${gear} flank`,
    x: "z in mm",
    y: "diameter in mm",
    cells,
    label: words,
    xRange: [x[0], x[x.length - 1] + width],
    yRange: [form, tip],
    height: 260,
  });
  svg.prepend(
    s(
      "defs",
      {},
      s(
        "pattern",
        { id: `${HATCH}-${gear}`, width: 4, height: 4, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
        s("rect", { width: 4, height: 4, class: "hatch-ground" }),
        s("line", { x1: 0, x2: 0, y1: 0, y2: 4, class: "hatch" }),
      ),
    ),
  );
  return h("div", { className: "flank" }, note(`The ${gear} flank`), svg);
}
