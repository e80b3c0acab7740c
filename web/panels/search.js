// @ts-check
// A search: fields that may differ, what is to be small and what has to hold; the service chooses which designs to
// compute.

import { asking, button, h, inLine, labelled, note, region, table, tableRow, unseen } from "../draw/dom.js";
import { figure, roomIn } from "../draw/figure.js";
import { given, numeric } from "../draw/inputs.js";
import { FieldChoice, options } from "./offer.js";
import { mostOften, StudyPanel } from "./panel.js";
import { json, ProblemError, request } from "../state/api.js";
import { apart, at, nameOf, withValue } from "../state/design.js";
import { fixed, number } from "../state/numbers.js";
import { withPoints } from "../state/points.js";
import { preview } from "../state/preview.js";
import { inUnit, inWords, quantityOf } from "../state/quantities.js";
import { DASHES } from "../state/series.js";

/** @import { Design } from "../state/design.js" */
/** @import { AskedSearch, FoundDesign, Open, Search as AskedOf, StudyState } from "../state/documents.js" */
/** @import { Submission } from "../state/documents.js" */
/** @import { Quantity } from "../state/quantities.js" */
/** @import { Form } from "../views/form.js" */

/** What is made small unless somebody chooses otherwise. */
const FIRST_GOAL = "transmission_error_um.peak_to_peak";

/**
 * Fields that are searched first, as far as a design has them: each variable begins with the first that no other has.
 */
const FIRST = [
  "/pair/driving/tip_relief/amount_um",
  "/pair/driven/tip_relief/amount_um",
  "/pair/driving/lead_modifications/0/amount_um",
  "/pair/driving/profile_modifications/0/amount_um",
  "/pair/driven/blank/holes/radius_mm",
  "/pair/driven/blank/web/thickness_mm",
];
const VARIABLES = 3;
/** So many of them begin with a field. */
const BEGUN = 2;

/** @type {(id: string, label: string, none: string | null) => HTMLSelectElement} */
const chosen = (id, label, none) =>
  h(
    "select",
    { id, ariaLabel: label },
    ...(none ? [h("option", { value: "" }, none)] : []),
    ...options(none ? "" : FIRST_GOAL),
  );

/**
 * The search for a better design.
 *
 * @augments {StudyPanel<StudyState>}
 */
export class Search extends StudyPanel {
  part = "";
  pause = 500;
  /** The design that the search began with and the best one, drawn beside each other; which row that is. */
  #beside = h("div", { className: "beside", id: "search-beside" });
  /** @type {string | null} */
  #drawn = null;
  /**
   * What the design has beside its curves: no design that is looked at needs it, and the one that is opened has it
   * again.
   *
   * @type {Partial<Submission>}
   */
  #further = {};

  /**
   * The search of `design` in `place`; `form` knows the fields, `onOpen` opens a design.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {Form} form
   * @param {Open} onOpen
   */
  constructor(place, design, form, onOpen) {
    super(place, design, { id: "search", words: "Search", inWords: (detail) => form.names.inWords(detail) });
    this.form = form;
    this.onOpen = onOpen;
    this.variables = Array.from({ length: VARIABLES }, (_, i) => new Variable(design, form, i));
    this.goals = [
      chosen("search-goal", "What is to be small", null),
      chosen("search-goal-2", "And what besides", "nothing else"),
    ];
    this.conditions = ["", "-2"].map(condition);
    this.evaluations = h("input", {
      type: "number",
      id: "search-evaluations",
      value: 150,
      min: 2,
      max: 20000,
      step: 1,
    });
    const [first, second] = this.goals;
    place.replaceChildren(
      note(
        "Each generation of designs is chosen by what came of those before; it begins with this design. ",
        h("a", { href: "guides/find-a-design" }, "Find a design"),
      ),
      asking(
        () => void this.start(),
        ...this.variables.map((each) => each.element),
        inLine(...labelled("for the least", first), ...labelled("and", second)),
        ...this.conditions.map((each) => each.element),
        inLine(...labelled("Designs", this.evaluations), this.run, this.cancel),
      ),
      this.state,
      this.outdated,
      this.out,
    );
    this.refresh();
  }

  refresh() {
    for (const each of this.variables) each.refresh();
  }

  /** @returns {AskedSearch} */
  asked() {
    // The names of the choices are those of the service.
    const minimize = this.goals
      .map(({ value }) => value)
      .filter(Boolean)
      .map((quantity) => /** @type {AskedOf["minimize"][number]} */ ({ quantity }));
    const subject_to = this.conditions.flatMap((each) => each.read());
    // What is asked for by a goal or a bound is told; gears are what they are.
    const needs = [...minimize, ...subject_to]
      .flatMap(({ quantity }) => quantityOf(quantity ?? "").needs)
      .filter((pointer) => !pointer.startsWith("/pair/"));
    /** @type {(base: Submission, pointer: string) => Submission} */
    const give = (base, pointer) =>
      withValue(
        base,
        pointer,
        this.design.get(pointer) || pointer === "/stress" || this.form.beginnings.object(pointer, null),
      );
    return {
      base: needs.reduce(give, apart(this.design.submission).curves),
      name: `${nameOf(this.design.submission)}, searched`,
      search: {
        variables: this.variables.flatMap((each) => each.read()),
        minimize,
        subject_to,
        evaluations: Number(this.evaluations.value),
      },
    };
  }

  /** @type {StudyPanel<StudyState>["progress"]} */
  progress(done, total, left) {
    return `${done} of at most ${total} designs${left(done, total)}`;
  }

  /** @param {StudyState} study */
  ended({ problem, search, status }) {
    return problem?.detail ?? `${search?.evaluations} designs looked at, ${status}`;
  }

  clear() {
    super.clear();
    this.#further = apart(this.design.submission).further;
    this.#beside.replaceChildren();
    this.#drawn = null;
  }

  /**
   * @param {StudyState} study
   * @param {string} address
   */
  show({ search: found }, address) {
    const about = /** @type {AskedSearch | null} */ (this.about);
    if (!found || !about) return;
    /** @type {(asked: { quantity?: string | null, percent?: number | null }) => Quantity} */
    const called = ({ quantity, percent }) => {
      const known = quantityOf(quantity ?? "Cost");
      return percent ? { ...known, title: `${known.title} (p${percent})` } : known;
    };
    const [parts, held] = [about.search.minimize, about.search.subject_to ?? []].map((asked) => asked.map(called));
    /** @type {(values: (number | null)[], names: Quantity[]) => string} */
    const told = (values, names) =>
      names
        .map((quantity, i) =>
          `${inWords(quantity)} ${values?.[i] === null || values?.[i] === undefined ? "?" : number(quantity.factor * values[i], 4)} ${quantity.printed}`.trim(),
        )
        .join(", ");
    const { best, front = [], confirmed, generations } = found;
    const failed = [
      { what: "designs", refusals: found.refusals },
      { what: "members of the others", refusals: found.member_refusals },
    ].flatMap(({ what, refusals = [] }) =>
      refusals.length
        ? [
            `${refusals.reduce((sum, { count }) => sum + count, 0)} ${what} cannot be computed${mostOften(refusals, this.inWords)}.`,
          ]
        : [],
    );
    const missing = h("p", { className: "outdated", hidden: !failed.length }, failed.join(" "));
    if (!best) return this.out.replaceChildren(missing);
    const rows = Object.entries(best.values).map(([path, value]) =>
      tableRow(this.form.names.named(path), number(at(about.base, path) ?? null, 5), number(value, 5)),
    );

    const atEnd = about.search.variables
      .filter(({ path, low, high }) => [low, high].includes(at(best, "/values")?.[path]))
      .map(({ path }) => this.form.names.named(path));
    /** @type {(row: number) => Promise<void>} */
    const open = async (row) =>
      void this.onOpen({ ...(await json(`${address}/designs/${row}`)), ...this.#further }, null);
    /** @type {(row: number, words: string) => HTMLButtonElement} */
    const use = (row, words) => button(words, () => open(row));
    void this.#drawBeside(address, best.row, about.base);
    const reached = generations.flatMap(({ best: value = null }, i) =>
      value === null ? [] : [[i + 1, parts[0].factor * value]],
    );
    const width = roomIn(this.out);
    const pictures =
      front.length > 1
        ? [
            figure({
              points: front.map(({ goals: [x, y], row }) => ({
                x: parts[0].factor * (x ?? NaN),
                y: parts[1].factor * (y ?? NaN),
                label: `design ${row}`,
                strong: row === best.row,
                open: () => open(row),
              })),
              x: inUnit(parts[0]),
              y: inUnit(parts[1]),
              width,
              title:
                "The front: no design found is better in both; the large point is the best compromise. Press a point to open its design",
            }),
            this.#frontOf(front, parts, use),
          ]
        : reached.length > 1
          ? [
              figure({
                lines: [{ x: reached.map(([i]) => i), y: reached.map(([, value]) => value) }],
                x: "generation",
                y: inUnit(parts[0]),
                width,
                title: "The best so far, generation by generation",
              }),
            ]
          : [];
    const fine =
      confirmed &&
      (confirmed.error_estimate
        ? `By the ${about.base.method.startsWith("three") ? "three-dimensional" : "flexible"} method on the fine grid: ${told(confirmed.goals, parts)}; another grid level changes the peak-to-peak value by ${fixed(confirmed.error_estimate.transmission_error_peak_to_peak_um, 4)} µm.`
        : `It could not be confirmed: ${confirmed.problem?.detail ?? "there are no results"}`);
    this.out.replaceChildren(
      h(
        "p",
        {},
        h("strong", {}, told(best.goals, parts)),
        held.length ? `, with ${told(best.conditions, held)}` : "",
        best.feasible ? "" : ". No design so far keeps what has to hold; this one comes nearest to it",
        best.failed_share
          ? `. ${fixed(100 * best.failed_share, 1)} % of its members have no results, and count as beyond every bound`
          : "",
      ),
      missing,
      region("Best design of the search", table(["Field", "Begun with", "Best so far"], rows)),
      ...(atEnd.length && parts.length === 1
        ? [note(`At an end of its range: ${atEnd.join("; ")}. A wider one may find better.`)]
        : []),
      h("div", { className: "buttons" }, use(best.row, "Use this design")),
      ...(fine ? [h("p", {}, fine)] : []),
      this.#beside,
      ...pictures,
    );
  }

  /**
   * Draws the design of a row beside the one that the search began with, and their curves where a preview takes them.
   *
   * @param {string} address
   * @param {number} row
   * @param {Submission} base
   */
  async #drawBeside(address, row, base) {
    if (this.#drawn === `${address} ${row}`) return;
    const asked = (this.#drawn = `${address} ${row}`);
    try {
      const best = await json(`${address}/designs/${row}`);
      const both = [
        ["Begun with", base],
        ["Best so far", best],
      ];
      const pictures = await Promise.all(
        both.map(async ([name, submission]) => {
          const text = await (
            await request("v1/outline", { method: "POST", body: submission, headers: { accept: "image/svg+xml" } })
          ).text();
          return h(
            "figure",
            {},
            h("img", {
              src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`,
              alt: `${name}: ${nameOf(submission)}`,
            }),
            h("figcaption", {}, name),
          );
        }),
      );
      if (asked !== this.#drawn) return;
      this.#beside.replaceChildren(...pictures);
      const curves = await Promise.all(
        both.map(async ([name, submission]) => ({ name, curve: withPoints((await preview(submission)).curves[0]) })),
      );
      if (asked !== this.#drawn) return;
      const lines = curves.map(({ name, curve }, i) => ({
        name,
        x: curve.mesh_position,
        y: curve.transmission_error_um,
        color: `var(--series-${i + 1})`,
        dash: DASHES[i],
      }));
      this.#beside.append(
        h(
          "figure",
          {},
          figure({
            lines,
            x: "mesh position in mesh periods",
            y: "transmission error in µm",
            title: "Transmission error of the design that the search began with and of the best so far",
          }),
          h("figcaption", {}, "Their transmission error"),
        ),
      );
    } catch (error) {
      // A search goes on without its pictures.
      if (!(error instanceof ProblemError)) throw error;
    }
  }

  /**
   * The designs of a front, each to be used.
   *
   * @param {FoundDesign[]} front
   * @param {Quantity[]} parts
   * @param {(row: number, words: string) => HTMLButtonElement} use
   */
  #frontOf(front, parts, use) {
    const rows = front.map(({ row, goals }) =>
      h(
        "tr",
        {},
        ...goals.map((value, i) => h("td", {}, number(parts[i].factor * (value ?? NaN), 4))),
        h("td", {}, use(row, "Use")),
      ),
    );
    return region("Designs of the front", table([...parts.map(inUnit), unseen("Actions")], rows));
  }
}

/**
 * A quantity and the bound that it has to keep.
 *
 * @param {string} end
 * @param {number} index
 */
function condition(end, index) {
  const bounded = chosen(`search-bounded${end}`, "What has to hold", index ? "nothing else" : "nothing");
  const side = h(
    "select",
    { id: `search-side${end}`, ariaLabel: "Side of the bound" },
    h("option", { value: "at_least" }, "at least"),
    h("option", { value: "at_most" }, "at most"),
  );
  const bound = numeric({ id: `search-bound${end}`, ariaLabel: "Bound" });
  const element = inLine(...labelled(index ? "and" : "with", bounded), side, bound);
  const read = () =>
    bounded.value && bound.value
      ? [
          /** @type {NonNullable<AskedOf["subject_to"]>[number]} */ ({
            quantity: bounded.value,
            [side.value]: (given(bound) ?? NaN) / quantityOf(bounded.value).factor,
          }),
        ]
      : [];
  return { element, read };
}

/** A field and the range that is searched, around the value that the design has. */
class Variable extends FieldChoice {
  /**
   * @param {Design} design
   * @param {Form} form
   * @param {number} index
   */
  constructor(design, form, index) {
    const id = `variable-${index}`;
    super(design, form, { id, index, words: "Choose", none: index ? "nothing else" : "a field" });
    /** @type {(name: string, label: string) => HTMLInputElement} */
    const number = (name, label) =>
      numeric({ id: `${id}-${name}`, ariaLabel: `${label} value of variable ${index + 1}` });
    this.low = number("low", "Smallest");
    this.high = number("high", "Largest");
    this.step = number("step", "Step of the");
    this.element = inLine(
      this.label,
      this.field,
      ...labelled("from", this.low),
      ...labelled("to", this.high),
      ...labelled("in steps of", this.step),
    );
  }

  suggest() {
    const { value } = this;
    if (typeof value !== "number") return;
    const isWhole = this.known?.kind.whole;
    const ends = value === 0 ? [0, 1] : [0.4 * value, 2 * value].sort((a, b) => a - b);
    /** @type {(end: number) => number} */
    const round = (end) => (isWhole ? Math.round(end) : Number(end.toPrecision(3)));
    [this.low.value, this.high.value, this.step.value] = [`${round(ends[0])}`, `${round(ends[1])}`, isWhole ? "1" : ""];
  }

  read() {
    const { low, high, step } = this;
    return this.field.value && low.value !== "" && high.value !== ""
      ? [{ path: this.field.value, low: given(low) ?? NaN, high: given(high) ?? NaN, step: given(step) ?? null }]
      : [];
  }

  /** Only fields that have a number in this design can be searched. */
  refresh() {
    const fields = this.numbers();
    const offered = FIRST.filter((first) => fields.some(({ pointer }) => pointer === first)).slice(0, BEGUN);
    const before = this.field.value;
    this.offer(fields);
    // Until somebody chooses one the field is one that the design has, whichever design that is.
    if (!this.isChosen) this.field.value = offered[this.index] ?? "";
    if (this.low.value === "" || this.field.value !== before) this.suggest();
  }
}
