// @ts-check
// How good the pairs will be that are made by a design: members drawn from laws and classes of accuracy, and what they
// come to.

import {
  asking,
  button,
  debounced,
  h,
  inLine,
  labelled,
  measured,
  note,
  region,
  s,
  table,
  tableRow,
  unseen,
} from "../draw/dom.js";
import { figure, roomIn } from "../draw/figure.js";
import { allGiven, given, numeric, put } from "../draw/inputs.js";
import { FieldChoice, options } from "./offer.js";
import { mostOften, StudyPanel } from "./panel.js";
import { foreseen, json, ProblemError } from "../state/api.js";
import { apart, at, MEMBERS, nameOf } from "../state/design.js";
import { fixed, number, timeOf } from "../state/numbers.js";
import { inUnit, inWords, quantityOf, shown } from "../state/quantities.js";

/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, GearName, Limits, Open, Percentile, PopulationResults } from "../state/documents.js" */
/** @import { QuantityResults } from "../state/documents.js" */
/** @import { Form } from "../views/form.js" */

/** @typedef {AskedStudy & { population: NonNullable<AskedStudy["population"]> }} AskedPopulation */

/** What is looked at first; over windows, which do not tell the peak-to-peak of the true period. */
const SHOWN = "transmission_error_um.peak_to_peak";
const SHOWN_OF_WINDOW = "transmission_error_um.tooth_to_tooth";

/**
 * A member has at most so many positions in a mesh period: what many members tell settles long before one curve does.
 */
const POSITIONS = 10;

/** The same over a window, from which the orders of the mesh are estimated. */
const POSITIONS_OF_WINDOW = 20;

/**
 * The mesh periods of a window of members whose true period is too long: the tooth-to-tooth error settles within some
 * percent over as many.
 */
const WINDOW = 32;

/** Of how many torques, as parts of that of the design, a member has curves where it has room for them. */
const TORQUES = [[1], [0.6, 1], [0.6, 1, 1.4], [0.4, 0.7, 1, 1.4]];

/** What the members will take is asked for so long after the last change, in milliseconds. */
const REST = 400;

/** What the members have of their own, whatever the design gives. */
const NOT_ASKED = [
  "/output_torques_n_m",
  "/resolution",
  "/pair/driving/tooth_deviations",
  "/pair/driven/tooth_deviations",
];

const CLASSES = Array.from({ length: 11 }, (_, i) => i + 1);

/**
 * The fields that are offered first, with what they usually vary by.
 *
 * @type {[pointer: string, deviation: number][]}
 */
const FIRST = [
  ["/pair/center_distance_mm", 0.02],
  ["/pair/driving/tip_relief/amount_um", 1.5],
];

/**
 * The population of a design.
 *
 * @augments {StudyPanel<PopulationResults>}
 */
export class Population extends StudyPanel {
  part = "/results/population";
  pause = 1000;
  /** True until something of the population has come. */
  #isNew = true;

  /**
   * The population of `design` in `place`; `form` knows the fields, `limits` are those of the service, `onOpen` opens a
   * member as a design.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {Form} form
   * @param {Limits} limits
   * @param {Open} onOpen
   */
  constructor(place, design, form, limits, onOpen) {
    super(place, design, {
      id: "population",
      words: "Draw them",
      inWords: (detail) => form.names.inWords(detail),
      ignored: NOT_ASKED,
    });
    this.form = form;
    this.limits = limits;
    this.onOpen = onOpen;
    /** @type {(event: { target: HTMLInputElement }) => void} */
    const typed = ({ target }) => {
      target.dataset.typed = "yes";
    };
    this.size = h("input", { type: "number", id: "population-size", value: 200, min: 2, max: 100000, step: 1 });
    this.torques = h("input", { type: "text", id: "population-torques", spellcheck: false, on: { input: typed } });
    this.span = h("input", {
      type: "number",
      id: "population-window",
      min: 4,
      max: 20000,
      step: 1,
      placeholder: "all",
      on: { input: typed },
    });
    this.classes = MEMBERS.map((gear) =>
      h(
        "select",
        { id: `population-${gear}` },
        h("option", { value: "" }, "as designed"),
        ...CLASSES.map((each) => h("option", { value: each, selected: each === 6 }, `class ${each}`)),
      ),
    );
    this.laws = FIRST.map((_, i) => new Law(design, form, i));
    this.ahead = h("p", { className: "note", id: "population-ahead", aria: { live: "polite" } });
    const change = () => this.#draw();
    this.quantity = h("select", { id: "population-quantity", on: { change } }, ...options(SHOWN));
    this.torque = h("select", { id: "population-torque", on: { change } });
    this.picker = inLine(...labelled("Look at", this.quantity), measured("at", this.torque, "N m"));
    this.picker.hidden = true;
    this.missing = h("p", { className: "outdated", role: "status" });
    this.short = note(
      "These members are computed over a part of their true period: peak-to-peak and rms are those of that part, and less than those of the true period.",
    );
    this.foresee = debounced(REST, () => void this.#foresee());
    const asks = asking(
      () => void this.start(),
      inLine(
        ...labelled("Members", this.size),
        ...this.classes.flatMap((each, i) => labelled(`teeth of the ${MEMBERS[i]} gear`, each)),
      ),
      ...this.laws.map((each) => each.element),
      inLine(measured("Torques", this.torques, "N m"), measured("over a window of", this.span, "mesh periods")),
      this.ahead,
      inLine(this.run, this.cancel),
    );
    asks.addEventListener("input", () => this.foresee());
    place.replaceChildren(
      h("h3", {}, "As made"),
      note(
        "Every member has teeth of its own, made by the class of ISO 1328-1 in place of those that the design may give, and fields that vary by a law. How many are beyond the total pitch tolerance F_pT of their class, or were rejected by its inspection, stands with what was found. ",
        h("a", { href: "guides/how-good-will-they-be" }, "How good will they be?"),
      ),
      asks,
      this.state,
      this.outdated,
      this.missing,
      this.short,
      this.picker,
      this.out,
    );
    this.clear();
    this.refresh();
  }

  refresh() {
    for (const each of this.laws) each.refresh();
    this.#suggestWindow(false);
    this.#suggestTorques(TORQUES.length);
    this.foresee();
  }

  /**
   * So many torques about that of the design, or its own, until somebody types other ones.
   *
   * @param {number} most
   */
  #suggestTorques(most) {
    const { torques } = this;
    if (torques.dataset.typed && torques.value) return;
    const own = this.design.get("/output_torques_n_m") ?? [100];
    const about =
      own.length > 1
        ? own
        : TORQUES[Math.min(most, TORQUES.length) - 1].map((part) => Number((part * own[0]).toPrecision(3)));
    put(torques, about.slice(0, most).join(", "));
  }

  /**
   * The window of members whose true period is too long, until somebody types another one; otherwise none. True if it
   * is another one now.
   *
   * @param {boolean} isLong
   */
  #suggestWindow(isLong) {
    const { span } = this;
    const before = span.value;
    if (!span.dataset.typed) put(span, isLong ? String(WINDOW) : "");
    return span.value !== before;
  }

  /** Says what the members will take: one whose teeth all differ repeats only when every tooth has met every other. */
  async #foresee() {
    if (this.place.hidden) return;
    /** @type {GearName[]} */
    let differing = [];
    try {
      const { size: count, accuracy } = this.asked().population;
      differing = MEMBERS.filter((each) => accuracy?.[each]);
      const member = await this.#estimated(differing);
      if (!member) return;
      const { seconds, positions } = member;
      const most = Math.floor(this.limits.positions / positions);
      this.#suggestTorques(most);
      const { length } = this.asked().base.output_torques_n_m;
      this.ahead.textContent =
        length > most
          ? `A member has ${number(positions)} positions for each torque, which leaves room for ${most} of them.`
          : `${this.#overWindow()}A member has ${number(length * positions)} positions, all torques together, and takes a core ${timeOf(1000 * length * seconds)} at most, by a rough estimate: ${timeOf(1000 * length * seconds * count)} for all ${number(count)}.`;
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      // What is wrong with the design is told beside it.
      if (error.problem.code !== "too_large") this.ahead.textContent = "";
      else if (this.#suggestWindow(true)) {
        delete this.torques.dataset.typed;
        this.#suggestTorques(TORQUES.length);
        this.foresee();
      } else {
        this.#suggestTorques(1);
        const ways = await this.#waysOf(differing);
        this.ahead.textContent = `${this.inWords(error.reason)}${ways.length ? ` What fits: ${ways.join(", or ")}.` : ""}`;
      }
    }
  }

  /**
   * What a member takes under one torque whose teeth differ on these gears.
   *
   * @param {GearName[]} differing
   */
  async #estimated(differing) {
    const study = this.asked();
    study.base.output_torques_n_m = study.base.output_torques_n_m.slice(0, 1);
    for (const each of MEMBERS)
      if (!differing.includes(each) && study.population.accuracy) delete study.population.accuracy[each];
    return (await foreseen(study)).estimate?.design;
  }

  /**
   * Gears whose teeth may be as designed to make members small enough, in words: the pair repeats after fewer mesh
   * periods then.
   *
   * @param {GearName[]} differing
   */
  async #waysOf(differing) {
    const fits = await Promise.all(
      differing.map((left) =>
        this.#estimated(differing.filter((each) => each !== left)).then(
          (member) => Boolean(member),
          (error) => {
            if (!(error instanceof ProblemError)) throw error;
            return false;
          },
        ),
      ),
    );
    return differing.filter((_, i) => fits[i]).map((gear) => `teeth of the ${gear} gear as designed`);
  }

  /** What a window tells, in words; nothing without one. */
  #overWindow() {
    const { span } = this;
    return span.value
      ? `Each member is computed where its teeth differ most from one to the next, over ${number(Number(span.value))} mesh periods: tooth-to-tooth error and mesh orders are those of the true period within some percent, peak-to-peak and rms are those of the window, and orders of rotation and of holes are not told. `
      : "";
  }

  /** @returns {AskedPopulation} */
  asked() {
    const { span } = this;
    const over = span.value ? { mesh_periods: Number(span.value), places: 1 } : null;
    const most = over ? POSITIONS_OF_WINDOW : POSITIONS;
    const base = structuredClone(apart(this.design.submission).curves);
    base.output_torques_n_m = allGiven(this.torques);
    base.resolution = {
      ...base.resolution,
      positions_per_mesh_period: Math.min(most, base.resolution?.positions_per_mesh_period ?? most),
    };
    // The span of the drawing is not that of teeth that all differ.
    delete base.resolution.span_mesh_periods;
    delete base.resolution.window_starts;
    /** @type {Partial<Record<GearName, { iso_1328_class: number }>>} */
    const accuracy = {};
    MEMBERS.forEach((member, i) => {
      if (!this.classes[i].value) return;
      accuracy[member] = { iso_1328_class: Number(this.classes[i].value) };
      delete base.pair[member].tooth_deviations;
    });
    const vary = this.laws.flatMap((each) => each.read());
    return {
      base,
      keep: "statistics",
      name: `${nameOf(this.design.submission)} as made`,
      population: {
        size: Number(this.size.value),
        vary,
        accuracy: Object.keys(accuracy).length ? accuracy : null,
        ...(over && { window: over }),
      },
    };
  }

  /**
   * Members that cannot be built are known at once, and tell nothing of the time that the others take.
   *
   * @type {StudyPanel<PopulationResults>["progress"]}
   */
  progress(done, total, left) {
    const failed = this.last?.found.failed;
    return `${done} of ${total} members${failed === undefined ? "" : left(done - failed, total - failed)}`;
  }

  /** @param {PopulationResults} found */
  ended({ done, size, status }) {
    return `${done} of ${size} members, ${status}`;
  }

  clear() {
    super.clear();
    this.#isNew = true;
    this.missing.hidden = true;
    this.short.hidden = true;
  }

  /**
   * Says how many members have no results, and why most of these; of the others, how many run over a part of the true
   * period.
   *
   * @param {PopulationResults} results
   */
  #missed({ failed, size, refusals, partial }) {
    this.short.hidden = !partial;
    this.missing.hidden = !failed;
    this.missing.textContent = `${failed === size ? "None of the members can be computed" : `${failed} of ${size} members cannot be computed`}${mostOften(refusals, this.inWords)}.${failed === size ? "" : " What stands below is of the others alone."}`;
  }

  /** @param {PopulationResults} results */
  show(results) {
    const { quantity, torque } = this;
    if (this.#isNew && results.partial && quantity.value === SHOWN) quantity.value = SHOWN_OF_WINDOW;
    this.#isNew = false;
    this.#missed(results);
    const known = [
      ...new Set(results.quantities.map((each) => each.output_torque_n_m).filter((each) => each !== null)),
    ];
    if (torque.options.length !== known.length || known.some((each, i) => Number(torque.options[i].value) !== each))
      torque.replaceChildren(...known.map((each) => h("option", { value: each }, number(each))));
    const there = new Set(results.quantities.map(({ name }) => name));
    for (const option of quantity.options) option.hidden = !there.has(option.value);
    this.#draw();
  }

  #draw() {
    if (!this.last) return;
    const { found: results, address } = this.last;
    const looked = quantityOf(this.quantity.value);
    const { printed, factor } = looked;
    const words = inWords(looked);
    const all = results.quantities.filter(({ name }) => name === this.quantity.value);
    const one = all.find((each) => each.output_torque_n_m === Number(this.torque.value)) ?? all[0];
    this.picker.hidden = !one;
    if (!one) return this.out.replaceChildren();
    /** @type {(each: QuantityResults, percent: number) => Percentile | undefined} */
    const percentile = (each, percent) => each.percentiles.find((found) => found.percent === percent);
    const { value: at95th, low = null, high = null } = percentile(one, 95) ?? {};
    /** @type {(value: number | null | undefined) => string} */
    const told = (value) => shown(looked, value);
    const at95 = `95 of 100 pairs stay below ${told(at95th)} ${printed} ${low === null || high === null ? "(too few members to say how surely)" : `(with 95 % confidence between ${told(low)} and ${told(high)})`}; half are below ${told(percentile(one, 50)?.value)}.`;
    const beyond = Object.entries(results.beyond_total_pitch_tolerance)
      .filter(([, share]) => share !== null)
      .map(
        ([gear, share]) => `${fixed(100 * (share ?? NaN), 1)} % of the ${gear} gears are beyond F_pT of their class.`,
      );
    const rejected = Object.entries(results.rejected_by_inspection ?? {})
      .filter(([, share]) => share !== null)
      .map(
        ([gear, share]) =>
          `${fixed(100 * (share ?? NaN), 1)} % of the ${gear} gears made were rejected by the inspection.`,
      );
    /** @type {(name: string, number: number) => HTMLButtonElement} */
    const member = (name, number) => button(`Open the ${name} member`, () => this.#openMember(address, number));
    const width = roomIn(this.out);
    const pictures = [
      figure({
        lines: [outlineOf(one.histogram, factor)],
        x: inUnit(looked),
        y: "members",
        title: `Histogram of the ${words}`,
        width,
      }),
      ...(all.length > 1
        ? [
            figure({
              lines: [
                { percent: 95, dash: [5, 4] },
                { percent: 50, dash: [] },
                { percent: 5, dash: [2, 3] },
              ].map(({ percent, dash }) => ({
                name: `${percent} % are below`,
                color: "currentColor",
                dash,
                x: all.map((each) => each.output_torque_n_m ?? NaN),
                y: all.map((each) => (percentile(each, percent)?.value ?? NaN) * factor),
              })),
              x: "output torque in N m",
              y: inUnit(looked),
              title: `Percentiles of the ${words} over the torque`,
              width,
            }),
          ]
        : []),
    ];
    this.out.replaceChildren(
      h("p", {}, at95, " ", [...beyond, ...rejected].join(" ")),
      ...pictures,
      this.#influencesOf(one),
      h(
        "div",
        { className: "buttons" },
        member("median", one.members.median),
        member("smallest", one.members.smallest),
        member("largest", one.members.largest),
      ),
    );
  }

  /**
   * What makes the variance, as bars with their limits.
   *
   * @param {QuantityResults} quantity
   */
  #influencesOf({ influences }) {
    if (!influences.length) return note("Nothing varies so far.");
    /** @type {(influence: QuantityResults["influences"][number]) => string} */
    const name = ({ path, accuracy }) => (path ? this.form.names.named(path) : `teeth of the ${accuracy} gear`);
    const rows = influences.map((each) => {
      const [low, high] = [each.low ?? each.share, each.high ?? each.share];
      const bar = s(
        "svg",
        { viewBox: "0 0 200 14", width: 200, height: 14, "aria-hidden": "true" },
        s("rect", { x: 0, y: 3, width: 200 * each.share, height: 8, class: "dot" }),
        s("line", { x1: 200 * low, x2: 200 * high, y1: 7, y2: 7, stroke: "currentColor", "stroke-width": 1.5 }),
      );
      const limits = each.low === null ? "–" : `${fixed(100 * low, 0)} to ${fixed(100 * high, 0)} %`;
      return tableRow(name(each), bar, `${fixed(100 * each.share, 0)} %`, limits);
    });
    const found = table(["Part of the variance by", unseen("Bar"), "Share", "95 % limits"], rows);
    found.className = "influences";
    return region("Influences", found);
  }

  /**
   * @param {string} address
   * @param {number} member
   */
  async #openMember(address, member) {
    this.onOpen({ ...(await json(`${address}/designs/${member}`)), ...apart(this.design.submission).further }, null);
  }
}

/**
 * The outline of a histogram's bars.
 *
 * @type {(histogram: QuantityResults["histogram"], factor: number) => { x: number[], y: number[] }}
 */
function outlineOf({ edges, counts }, factor) {
  const x = [edges[0], ...counts.flatMap((_, i) => [edges[i], edges[i + 1]]), edges[edges.length - 1]];
  return { x: x.map((each) => each * factor), y: [0, ...counts.flatMap((count) => [count, count]), 0] };
}

/** A field and the law that it follows, around the value that the design has. */
class Law extends FieldChoice {
  /**
   * @param {Design} design
   * @param {Form} form
   * @param {number} index
   */
  constructor(design, form, index) {
    const id = `law-${index}`;
    super(design, form, { id, index, words: "Vary", none: "nothing else" });
    this.kind = h(
      "select",
      { id: `${id}-kind`, ariaLabel: "Law" },
      h("option", { value: "normal" }, "normal, standard deviation"),
      h("option", { value: "uniform" }, "uniform, plus or minus"),
      h("option", { value: "triangular" }, "triangular, plus or minus"),
    );
    this.spread = numeric({ id: `${id}-spread`, ariaLabel: "Spread" });
    this.element = inLine(this.label, this.field, ...labelled("by", this.kind), this.spread);
    this.isBegun = false;
  }

  suggest() {
    const usual = FIRST.find(([path]) => path === this.field.value)?.[1];
    const { value } = this;
    const about = typeof value === "number" && value ? Number(Math.abs(0.02 * value).toPrecision(2)) : 0.01;
    put(this.spread, String(usual ?? about));
  }

  /** @returns {NonNullable<AskedPopulation["population"]["vary"]>} */
  read() {
    const { value } = this;
    const by = given(this.spread) ?? 0;
    const path = this.field.value;
    if (!path || typeof value !== "number" || !(by > 0)) return [];
    const ends = { low: value - by, high: value + by };
    if (this.kind.value === "uniform") return [{ path, kind: "uniform", ...ends }];
    if (this.kind.value === "triangular") return [{ path, kind: "triangular", mode: value, ...ends }];
    return [{ path, kind: "normal", mean: value, standard_deviation: by, low: value - 3 * by, high: value + 3 * by }];
  }

  /** Only fields that have a number in this design can vary. */
  refresh() {
    const fields = this.numbers();
    this.offer(fields);
    const [first] = FIRST[this.index];
    if (!this.isBegun && fields.some(({ pointer }) => pointer === first)) this.field.value = first;
    this.isBegun = true;
    if (!this.spread.value) this.suggest();
  }
}
