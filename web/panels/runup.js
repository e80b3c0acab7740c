// @ts-check
// The motion of the gears over speed: both branches beside those of kept designs, a waterfall of orders with their
// resonances named, and one speed that is looked at, turned and heard.

import { looks } from "../draw/looks.js";
import {
  button,
  debounced,
  dress,
  h,
  inLine,
  labelled,
  note,
  region,
  s,
  table,
  tableRow,
  unseen,
} from "../draw/dom.js";
import { figure, roomIn, ticks } from "../draw/figure.js";
import { Tones } from "../draw/sound.js";
import { Panel } from "./panel.js";
import { motionAt } from "../state/motion.js";
import { fixed, number } from "../state/numbers.js";
import { wordsOf } from "../state/orders.js";

/** @import { Attributes, Figure, Frame } from "../draw/figure.js" */
/** @import { Curve, Dynamics, NamedDesign, NamedOrder, RunUpBranch } from "../state/documents.js" */

/**
 * What is drawn over speed: name, unit, and how a branch tells it.
 *
 * @type {Record<string, [words: string, unit: string, read: (branch: RunUpBranch) => number[]]>}
 */
const OVER_SPEED = {
  p_p: ["dynamic STE, peak-to-peak", "µm", (branch) => branch.dynamic_transmission_error_um.peak_to_peak],
  rms: ["dynamic STE, rms", "µm", (branch) => branch.dynamic_transmission_error_um.rms],
  factor: ["dynamic load factor", "1", (branch) => branch.dynamic_load_factor],
};
/** @typedef {"up" | "down"} Way */

/** @type {Record<Way, string>} */
const BRANCHES = { up: "running up", down: "running down" };
const HEIGHT = 290;
/** So many orders are drawn; a run-up tells many more. */
const MOST_RIDGES = 16;
/** A row of the waterfall, and how many rows its highest ridge may cover, in px. */
const [ROW, RISE] = [24, 2.4];
const FRAME = { left: 74, right: 20, top: 44, bottom: 44 };
/** The gears turn by so many mesh periods in a second at the highest speed. */
const SLOW_MOTION = 1.5;
const REST = 60;
/** The warning that tells a better natural frequency than that of the run-up. */
const BETTER_FREQUENCY = "rim_inertia_on_hub";

/** @type {(value: number) => string} */
const rpm = (value) => `${Math.round(value).toLocaleString("en")} rpm`;

/** @type {(named: NamedOrder[], label: string) => string} */
const inWords = (named, label) => {
  const known = named.find((order) => order.label === label);
  return known ? wordsOf(known) : label;
};

const WAYS = /** @type {Way[]} */ (Object.keys(BRANCHES));

/** @typedef {{ label: string, order: number, words: string, amplitude: number[] }} Ridge */

/**
 * What a run-up needs of the page: `ask` puts one into the design, `asked` says whether it has one, `refused` why that
 * is not computed, `focus` shows its fields, `designs` gives what is shown, the live one first, and `stage` turns the
 * drawing.
 *
 * @typedef {object} Page
 * @property {() => void} ask
 * @property {() => boolean} asked
 * @property {() => string | null} refused
 * @property {() => void} focus
 * @property {() => NamedDesign[]} designs
 * @property {{ turn: (by: number) => void, move: (factorAt: (position: number) => number) => void, rest: () => void }}
 *   stage
 */

/** The run-up of the designs that are shown. */
export class RunUp extends Panel {
  /** @type {number} */
  #speed = NaN;
  /** @type {Way} */
  #branch = "up";
  #playing = false;
  /** @type {ReturnType<typeof motionAt> | null} */
  #motion = null;
  /** @type {((speed: number) => void)[]} */
  #cursors = [];

  /**
   * The run-up in `place`.
   *
   * @param {HTMLElement} place
   * @param {Page} page
   */
  constructor(place, { ask, asked, refused, focus, designs, stage }) {
    super(place);
    this.asked = asked;
    this.refused = refused;
    /**
     * The live design, once it has a run-up.
     *
     * @type {NamedDesign}
     */
    this.live = /** @type {any} */ (null);
    this.designs = designs;
    this.stage = stage;
    this.tones = new Tones();
    /** @type {(id: string, options: Record<string, string>) => HTMLSelectElement} */
    const select = (id, options) =>
      h(
        "select",
        { id, on: { change: () => this.refresh() } },
        ...Object.entries(options).map(([value, words]) => h("option", { value }, words)),
      );
    this.quantity = select(
      "run-up-quantity",
      Object.fromEntries(
        Object.entries(OVER_SPEED).map(([name, [words, unit]]) => [name, unit === "1" ? words : `${words} in ${unit}`]),
      ),
    );
    this.torque = select("run-up-torque", {});
    this.way = select("run-up-branch", BRANCHES);
    this.slider = h("input", {
      type: "range",
      id: "speed",
      min: 0,
      step: 1,
      value: 0,
      on: { input: (event) => this.#look(this.#dynamics.driving_speed_rpm[Number(event.target.value)]) },
    });
    this.said = h("output", { htmlFor: "speed" });
    this.readout = h("p", { className: "note", id: "speed-readout" });
    this.turning = button("Turn at this speed", () => this.#play(!this.#playing), { id: "run-up-turn" });
    this.hear = button("Hear the excitation", () => this.#listen(!this.tones.on), { id: "run-up-hear" });
    for (const each of [this.turning, this.hear]) each.setAttribute("aria-pressed", "false");
    this.picture = h("div", { className: "speeds" });
    this.waterfall = h("div", { className: "speeds" });
    this.ridges = note();
    this.resonances = region("Resonances");
    this.body = h(
      "div",
      { hidden: true },
      inLine(
        ...labelled("Look at", this.quantity),
        ...labelled("at", this.torque),
        h("span", { className: "unit" }, "N m,"),
        h("label", { htmlFor: this.way.id, className: "visually-hidden" }, "Branch"),
        this.way,
        button("Speeds and inertias", focus, { id: "run-up-fields" }),
      ),
      this.picture,
      h("div", { className: "position" }, h("label", { htmlFor: "speed" }, "Speed"), this.slider, this.said),
      this.readout,
      h("div", { className: "buttons wrap" }, this.turning, this.hear),
      note(
        "What is heard is the excitation: the orders of the dynamic transmission error as pure tones. It is not the noise of a gearbox, which its housing makes.",
      ),
      this.ridges,
      this.waterfall,
      this.resonances,
    );
    this.none = h(
      "div",
      { hidden: true },
      h(
        "p",
        {},
        "This design has no run-up yet: the motion of the gears over speed, on one torsional degree of freedom with backlash.",
      ),
      button(
        "Run it up",
        () => {
          ask();
          this.refresh();
        },
        { id: "run-up-ask" },
      ),
    );
    this.wrong = h("p", { hidden: true, role: "status", className: "field-error" });
    this.coming = h(
      "p",
      { hidden: true, role: "status" },
      "The run-up is being computed: the forces at every position first, then the motion at every speed. Above stands how far it is.",
    );
    place.replaceChildren(
      note(
        "Solid running up, dashed running down; thick where the flanks part. ",
        h("a", { href: "guides/will-it-rattle-or-whine" }, "Will it rattle or whine?"),
      ),
      this.none,
      this.wrong,
      this.coming,
      this.body,
    );
    this.later = debounced(REST, () => this.#move());
    let width = 0;
    new ResizeObserver(() => {
      const now = Math.round(place.clientWidth);
      if (now && now !== width) this.refresh();
      width = now;
    }).observe(place);
  }

  /** Shows the run-ups of the designs as they are now. */
  refresh() {
    const designs = this.designs();
    const [live] = designs;
    const there = Boolean(live?.results.curves[0].dynamics);
    this.body.hidden = !there;
    const refused = this.asked() ? this.refused() : null;
    this.wrong.hidden = there || refused === null;
    this.wrong.textContent = `No run-up: ${refused ?? ""}`;
    this.coming.hidden = !live || there || !this.asked() || refused !== null;
    this.none.hidden = !live || there || this.asked();
    if (!there) return this.leave();
    if (this.place.hidden) return;
    this.live = live;
    this.#offer(
      this.torque,
      live.results.curves.map(({ output_torque_n_m: torque }) => [String(torque), number(torque, 6)]),
    );
    /** @returns {Dynamics} */
    const dynamics = this.#dynamics;
    this.#offer(
      this.way,
      WAYS.filter((name) => dynamics[name]).map((name) => [name, BRANCHES[name]]),
    );
    this.#branch = this.way.value === "down" ? "down" : "up";
    const speeds = dynamics.driving_speed_rpm;
    this.slider.max = String(speeds.length - 1);
    if (!(this.#speed >= speeds[0] && this.#speed <= speeds[speeds.length - 1])) this.#speed = this.#loudest();
    this.#motion = null;
    this.#draw(designs);
    this.#look(this.#speed);
  }

  leave() {
    this.#play(false);
    this.#listen(false);
  }

  get #curve() {
    return (
      this.live.results.curves.find((curve) => String(curve.output_torque_n_m) === this.torque.value) ??
      this.live.results.curves[0]
    );
  }

  get #dynamics() {
    return /** @type {Dynamics} */ (this.#curve.dynamics);
  }

  get #run() {
    return /** @type {RunUpBranch} */ (this.#dynamics[this.#branch]);
  }

  /**
   * The options of a select, keeping what was chosen where it is still there.
   *
   * @param {HTMLSelectElement} select
   * @param {[value: string, words: string][]} options
   */
  #offer(select, options) {
    const before = select.value;
    select.replaceChildren(...options.map(([value, words]) => h("option", { value }, words)));
    if (options.some(([value]) => String(value) === before)) select.value = before;
  }

  #loudest() {
    const values = this.#run.dynamic_transmission_error_um.peak_to_peak;
    return this.#dynamics.driving_speed_rpm[values.indexOf(Math.max(...values))];
  }

  /** @param {number} speed */
  #index(speed) {
    const speeds = this.#dynamics.driving_speed_rpm;
    if (speeds.length < 2) return 0;
    const step = (speeds[speeds.length - 1] - speeds[0]) / (speeds.length - 1);
    return Math.min(speeds.length - 1, Math.max(0, Math.round((speed - speeds[0]) / step)));
  }

  /** @param {NamedDesign[]} designs */
  #draw(designs) {
    const [words, unit, read] = OVER_SPEED[this.quantity.value];
    const width = roomIn(this.place, Infinity);
    const torque = this.#curve.output_torque_n_m;
    const seen = designs.filter(({ hidden }) => !hidden);
    const { series } = looks();
    const lines = seen.flatMap((each) => {
      // Kept designs may have been computed at other torques; the nearest stands beside this one.
      const curves = each.results.curves.filter(({ dynamics }) => dynamics);
      if (!curves.length) return [];
      /** @returns {Curve} */
      const curve = curves.reduce((best, other) =>
        Math.abs(other.output_torque_n_m - torque) < Math.abs(best.output_torque_n_m - torque) ? other : best,
      );
      const color = series(each.look ?? 0);
      const name =
        curve.output_torque_n_m === torque ? each.name : `${each.name}, ${number(curve.output_torque_n_m)} N m`;
      const { dynamics } = curve;
      return WAYS.flatMap((way) => {
        const branch = dynamics?.[way];
        if (!dynamics || !branch) return [];
        const y = read(branch);
        const parted = {
          color,
          x: dynamics.driving_speed_rpm,
          y: y.map((value, i) => (branch.contact_lost[i] ? value : null)),
          width: 5,
          parted: true,
        };
        return [
          { name: `${name}, ${way}`, color, dash: way === "down" ? [5, 4] : [], x: dynamics.driving_speed_rpm, y },
          ...(branch.contact_lost.includes(true) ? [parted] : []),
        ];
      });
    });
    const label = `${words} over the speed of the driving gear. ${this.#told()}`;
    const chart = figure({
      lines,
      x: "speed of the driving gear in rpm",
      y: unit === "1" ? words : `${words} in ${unit}`,
      title: words,
      label,
      width,
      height: HEIGHT,
    });
    const fall = this.#waterfallOf(width);
    this.picture.replaceChildren(chart);
    this.waterfall.replaceChildren(fall);
    this.#cursors = [chart, fall].map((svg) => this.#cursor(svg));
    this.resonances.replaceChildren(...this.#tableOf());
  }

  /** What a listener should know of the run-up. */
  #told() {
    const dynamics = this.#dynamics;
    return WAYS.flatMap((way) => {
      const branch = dynamics[way];
      if (!branch) return [];
      const values = branch.dynamic_transmission_error_um.peak_to_peak;
      const most = Math.max(...values);
      const parted = dynamics.driving_speed_rpm.filter((_, i) => branch.contact_lost[i]);
      return `${BRANCHES[way]}, at most ${fixed(most, 2)} µm peak-to-peak at ${rpm(dynamics.driving_speed_rpm[values.indexOf(most)])}; ${parted.length ? `flanks part from ${rpm(parted[0])} to ${rpm(parted[parted.length - 1])}` : "flanks never part"}.`;
    }).join(" ");
  }

  /**
   * A line in a figure at the speed that is looked at; a pointer in it looks at another.
   *
   * @param {Figure} svg
   */
  #cursor(svg) {
    const { frame } = svg;
    const now = s("line", { class: "speed-now", y1: frame.top, y2: frame.bottom });
    svg.append(now);
    svg.addEventListener("pointermove", (event) => {
      const box = svg.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * svg.viewBox.baseVal.width;
      if (x >= frame.px(frame.x[0]) && x <= frame.px(frame.x[1])) this.#look(frame.valueAt(x));
    });
    return (/** @type {number} */ speed) => dress(now, { x1: frame.px(speed), x2: frame.px(speed) });
  }

  /**
   * The orders of the run-up with their words, rising: those that move most.
   *
   * @returns {Ridge[]}
   */
  #orders() {
    const named = this.#curve.spectrum?.named ?? [];
    /** @type {(order: Ridge) => number} */
    const most = ({ amplitude }) => Math.max(...amplitude);
    return this.#run.orders
      .map(({ label, order, amplitude_um: amplitude }) => ({ label, order, words: inWords(named, label), amplitude }))
      .sort((a, b) => most(b) - most(a))
      .slice(0, MOST_RIDGES)
      .sort((a, b) => a.order - b.order);
  }

  /**
   * A ridge for each order over speed, the lowest in front, and a mark where an order resonates.
   *
   * @param {number} width
   * @returns {Figure}
   */
  #waterfallOf(width) {
    const orders = this.#orders();
    const speeds = this.#dynamics.driving_speed_rpm;
    const height = FRAME.top + ROW * orders.length + FRAME.bottom;
    // One speed stands in the middle.
    const [first, last] =
      speeds.length > 1 ? [speeds[0], speeds[speeds.length - 1]] : [0.9 * speeds[0], 1.1 * speeds[0] || 1];
    /** @type {(speed: number) => number} */
    const px = (speed) => FRAME.left + ((speed - first) / (last - first)) * (width - FRAME.left - FRAME.right);
    const most = Math.max(1e-9, ...orders.flatMap(({ amplitude }) => amplitude));
    /** @type {(i: number) => number} */
    const foot = (i) => height - FRAME.bottom - ROW * i - 4;
    /** @type {(value: number) => number} */
    const rise = (value) => (RISE * ROW * value) / most;
    const svg = s("svg", {
      viewBox: `0 0 ${width} ${height}`,
      class: "scatter waterfall",
      role: "img",
      "aria-label": `Waterfall: the amplitudes of ${orders.length} orders over speed, the highest ${number(most, 3)} µm. Resonances stand in the table below.`,
    });
    /** @type {(words: string, attributes: Attributes) => SVGTextElement} */
    const text = (words, attributes) => Object.assign(s("text", attributes), { textContent: words });
    this.ridges.textContent = `Orders over speed, ${BRANCHES[this.#branch]}; the highest ridge is ${number(most, 3)} µm. ◆ marks a resonance that its own line in the static curve makes, ◇ one that the varying stiffness makes.`;
    for (const value of ticks(first, last))
      svg.append(
        s("line", { x1: px(value), x2: px(value), y1: FRAME.top - ROW, y2: height - FRAME.bottom, class: "grid" }),
        text(number(value, 6), { x: px(value), y: height - FRAME.bottom + 16, "text-anchor": "middle" }),
      );
    svg.append(
      text("speed of the driving gear in rpm", {
        x: (FRAME.left + width - FRAME.right) / 2,
        y: height - 8,
        "text-anchor": "middle",
      }),
    );
    for (const [i, { label, amplitude }] of [...orders.entries()].reverse()) {
      const line = amplitude
        .map((value, k) => `${px(speeds[k]).toFixed(1)} ${(foot(i) - rise(value)).toFixed(1)}`)
        .join("L");
      svg.append(
        s("path", { class: "ridge-ground", d: `M${px(first)} ${foot(i)}L${line}L${px(last)} ${foot(i)}Z` }),
        s("path", { class: "ridge", d: `M${line}` }),
        text(label, { x: FRAME.left - 6, y: foot(i) + 3, "text-anchor": "end" }),
      );
    }
    for (const resonance of this.#named()) {
      const i = orders.findIndex(({ label }) => label === resonance.label);
      const mark = s("path", {
        class: `resonance ${resonance.excited}`,
        d: `M${px(resonance.driving_speed_rpm)} ${foot(i) - 5}l5 5l-5 5l-5 -5Z`,
      });
      mark.append(Object.assign(s("title"), { textContent: resonance.words }));
      svg.append(mark);
    }
    /** @type {Frame} */
    const frame = {
      x: [first, last],
      px,
      valueAt: (x) => first + ((x - FRAME.left) / (width - FRAME.left - FRAME.right)) * (last - first),
      top: FRAME.top - ROW,
      bottom: height - FRAME.bottom,
    };
    return Object.assign(svg, { frame });
  }

  /** The resonances of the orders shown, each as a sentence would name it. */
  #named() {
    const orders = this.#orders();
    return this.#dynamics.resonances.flatMap((each) => {
      const order = orders.find(({ label }) => label === each.label);
      if (!order) return [];
      const cause = each.excited === "parametric" ? ", by the varying stiffness" : "";
      return [{ ...each, what: order.words, words: `${order.words}, at ${rpm(each.driving_speed_rpm)}${cause}` }];
    });
  }

  #tableOf() {
    const rows = this.#named().map((each) =>
      tableRow(
        Math.round(each.driving_speed_rpm).toLocaleString("en"),
        each.label,
        each.what,
        each.excited === "forced" ? "its own line: forced" : "the stiffness: parametric",
        number(each.frequency_hz),
        fixed(each.amplitude_um, 2),
        button("Look", () => this.#look(each.driving_speed_rpm), { ariaLabel: `Look at ${each.words}` }),
      ),
    );
    const frequencies = this.#dynamics.natural_frequencies_hz.map((hertz) => number(hertz));
    const natural =
      frequencies.length === 1
        ? `the natural frequency is ${frequencies[0]} Hz`
        : `the natural frequencies are ${frequencies.join(", ")} Hz`;
    const caption = `Resonances: ${natural}, of ${number(this.#dynamics.equivalent_mass_kg, 3)} kg on the line of action`;
    const names = ["Speed rpm", "Order", "What it is", "Excited by", "Frequency Hz", "Amplitude µm", unseen("Actions")];
    const none = h("tr", {}, h("td", { colSpan: 7 }, "None at these speeds."));
    const found = table(names, rows.length ? rows : [none], caption);
    // A better number than that of the caption stands beside it.
    const better = this.live.results.warnings.filter(({ code }) => code === BETTER_FREQUENCY);
    return [...better.map(({ detail }) => h("p", { className: "outdated" }, detail)), found];
  }

  /**
   * Looks at a speed: the nearest that was computed.
   *
   * @param {number} speed
   */
  #look(speed) {
    const i = this.#index(speed);
    const speeds = this.#dynamics.driving_speed_rpm;
    this.#speed = speeds[i];
    this.slider.value = String(i);
    for (const move of this.#cursors) move(this.#speed);
    this.said.textContent = rpm(this.#speed);
    /** @returns {RunUpBranch} */
    const run = this.#run;
    const lost = run.contact_lost[i];
    const multiple = run.period_multiple[i] ?? 1;
    const strongest = this.#orders().reduce(
      (best, each) => (each.amplitude[i] > (best?.amplitude[i] ?? 0) ? each : best),
      /** @type {Ridge | null} */ (null),
    );
    const near = this.#named()
      .filter((each) => Math.abs(each.driving_speed_rpm - this.#speed) < 0.03 * this.#speed)
      .map(({ words }) => words);
    this.slider.setAttribute(
      "aria-valuetext",
      `${rpm(this.#speed)}, ${fixed(run.dynamic_transmission_error_um.peak_to_peak[i], 2)} micrometers peak-to-peak${lost ? ", the flanks part" : ""}`,
    );
    this.readout.replaceChildren(
      `${BRANCHES[this.#branch].replace(/^./, (letter) => letter.toUpperCase())} at ${rpm(this.#speed)}: ${fixed(run.dynamic_transmission_error_um.peak_to_peak[i], 2)} µm peak-to-peak, up to ${fixed(run.dynamic_load_factor[i], 2)} times the load`,
      strongest ? `, most at ${strongest.label} (${strongest.words}), ${number(strongest.amplitude[i], 3)} µm` : "",
      ". ",
      lost ? h("strong", { className: "parted" }, "The flanks part. ") : "",
      multiple === 0
        ? "The motion was not found to repeat. "
        : multiple > 1
          ? `It repeats after ${multiple} true periods. `
          : "",
      near.length ? `Near: ${near.join("; ")}.` : "",
    );
    this.#sound(i);
    this.later();
  }

  /** @param {number} i */
  #sound(i) {
    if (!this.tones.on) return;
    const { driving, driven } = this.live.submission.pair;
    const turns = (this.#speed * driving.tooth_count) / driven.tooth_count / 60;
    const orders = this.#orders();
    const most = Math.max(
      ...orders[0].amplitude.map((_, k) => orders.reduce((sum, { amplitude }) => sum + amplitude[k], 0)),
    );
    this.tones.play(orders.map(({ order, amplitude }) => ({ hz: order * turns, part: amplitude[i] / most })));
  }

  /** @param {boolean} on */
  #listen(on) {
    if (on === this.tones.on) return;
    if (on) this.tones.start();
    else this.tones.stop();
    this.hear.setAttribute("aria-pressed", String(on));
    if (on) this.#sound(this.#index(this.#speed));
  }

  /**
   * Turns the gears as they move at the speed, slowly; arrows are as long as the force is then, and none is there while
   * the flanks are apart.
   *
   * @param {boolean} on
   */
  #play(on) {
    if (on === this.#playing) return;
    this.#playing = on;
    this.turning.setAttribute("aria-pressed", String(on));
    if (!on) return this.stage.rest();
    this.#move();
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    let last = performance.now();
    /** @type {FrameRequestCallback} */
    const step = (now) => {
      if (!this.#playing) return;
      if (!still || now - last > 500) {
        const [top] = this.#dynamics.driving_speed_rpm.slice(-1);
        this.stage.turn(still ? 0.1 : (SLOW_MOTION * this.#speed * (now - last)) / 1000 / top);
        last = now;
      }
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
    return undefined;
  }

  /** The motion at the speed that is looked at, going on from the one before. */
  #move() {
    if (!this.#playing) return;
    const { submission, results } = this.live;
    const { force_table } = results;
    const { dynamics } = this.#curve;
    this.#motion =
      this.#speed > 0 && force_table && dynamics
        ? motionAt(
            { ...results, force_table },
            { ...this.#curve, dynamics },
            {
              rpm: this.#speed,
              teeth: submission.pair.driving.tooth_count,
              damping: submission.dynamics?.damping_ratio ?? undefined,
              from: this.#motion?.state,
            },
          )
        : null;
    const motion = this.#motion;
    this.stage.move(
      motion
        ? (position) =>
            motion.factor[Math.floor((position / motion.span) * motion.factor.length) % motion.factor.length]
        : () => 1,
    );
    if (!motion) return;
    const range = Math.max(...motion.approach) - Math.min(...motion.approach);
    this.turning.title = `In slow motion, from the force table: ${fixed(range, 2)} µm peak-to-peak`;
    this.turning.dataset.peakToPeak = String(range);
  }
}
