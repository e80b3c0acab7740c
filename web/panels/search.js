// @ts-check
// A search: fields that may differ, what is to be small and what has to hold; the service chooses which designs to
// compute.

import { asking, button, h, inLine, labelled, note, region, table, tableRow, unseen } from "../draw/dom.js";
import { figure } from "../draw/figure.js";
import { given, numeric } from "../draw/inputs.js";
import { offer, options } from "./offer.js";
import { mostOften, Question } from "./question.js";
import { json, ProblemError, request } from "../state/api.js";
import { apart, at, nameOf, withValue } from "../state/design.js";
import { fixed, number } from "../state/numbers.js";
import { withPoints } from "../state/points.js";
import { preview } from "../state/preview.js";
import { inUnit, inWords, quantityOf } from "../state/quantities.js";
import { DASHES } from "../state/series.js";

/** @import { Watching } from "./question.js" */
/** @import { Design } from "../state/design.js" */
/** @import { AskedSearch, FoundDesign, Open, Search, SearchProgress, StudyState } from "../state/documents.js" */
/** @import { Submission } from "../state/documents.js" */
/** @import { Quantity } from "../state/quantities.js" */
/** @import { Form } from "../views/form.js" */

/** How a search stands is fetched so often at most, in milliseconds. */
const PAUSE = 500;

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
 * The search of `design` in `place`; `form` knows the fields, `onOpen` opens a design.
 *
 * @param {HTMLElement} place
 * @param {Design} design
 * @param {Form} form
 * @param {Open} onOpen
 */
export function search(place, design, form, onOpen) {
  const variables = Array.from({ length: VARIABLES }, (_, i) => variable(i, design, form));
  const goals = [
    chosen("search-goal", "What is to be small", null),
    chosen("search-goal-2", "And what besides", "nothing else"),
  ];
  const conditions = ["", "-2"].map(condition);
  const evaluations = h("input", { type: "number", id: "search-evaluations", value: 150, min: 2, max: 20000, step: 1 });
  const question = new Question(design, { id: "search", words: "Search", inWords: (detail) => form.inWords(detail) });
  const out = h("div", { className: "out", id: "search-out" });
  /** The design that the search began with and the best one, drawn beside each other; which row that is. */
  const beside = h("div", { className: "beside", id: "search-beside" });
  /** @type {string | null} */
  let drawn = null;
  /**
   * What the design has beside its curves: no design that is looked at needs it, and the one that is opened has it
   * again.
   *
   * @type {Partial<Submission>}
   */
  let further = {};
  place.replaceChildren(
    note(
      "Each generation of designs is chosen by what came of those before; it begins with this design. ",
      h("a", { href: "guides/find-a-design" }, "Find a design"),
    ),
    asking(
      start,
      ...variables.map((each) => each.element),
      inLine(...labelled("for the least", goals[0]), ...labelled("and", goals[1])),
      ...conditions.map((each) => each.element),
      inLine(...labelled("Designs", evaluations), question.run, question.cancel),
    ),
    question.state,
    question.of.element,
    out,
  );

  /** @returns {AskedSearch} */
  function asked() {
    // The names of the choices are those of the service.
    const minimize = goals
      .map(({ value }) => value)
      .filter(Boolean)
      .map((quantity) => /** @type {Search["minimize"][number]} */ ({ quantity }));
    const subject_to = conditions.flatMap((each) => each.read());
    // What is asked for by a goal or a bound is told; gears are what they are.
    const needs = [...minimize, ...subject_to]
      .flatMap(({ quantity }) => quantityOf(quantity ?? "").needs)
      .filter((pointer) => !pointer.startsWith("/pair/"));
    /** @type {(base: Submission, pointer: string) => Submission} */
    const give = (base, pointer) =>
      withValue(
        base,
        pointer,
        at(design.submission, pointer) || pointer === "/stress" || form.beginnings.object(pointer, null),
      );
    return {
      base: needs.reduce(give, apart(design.submission).curves),
      name: `${nameOf(design.submission)}, searched`,
      search: {
        variables: variables.flatMap((each) => each.read()),
        minimize,
        subject_to,
        evaluations: Number(evaluations.value),
      },
    };
  }

  /** @type {(about: () => AskedSearch | null) => Watching<StudyState>} */
  const how = (about) => ({
    pause: PAUSE,
    show: (study, address) => show(study.search, address, about()),
    progress: (done, total, left) => `${done} of at most ${total} designs${left(done, total)}`,
    ended: (study) => study.problem?.detail ?? `${study.search?.evaluations} designs looked at, ${study.status}`,
  });

  function clear() {
    ({ further } = apart(design.submission));
    out.replaceChildren();
    beside.replaceChildren();
    drawn = null;
  }

  function start() {
    clear();
    /** @type {AskedSearch | null} */
    let about = null;
    return question.study(
      () => (about = asked()),
      how(() => about),
    );
  }

  /**
   * Shows a search that was asked for before.
   *
   * @param {string} id
   * @param {AskedSearch} about
   */
  function resume(id, about) {
    clear();
    return question.resume(
      id,
      about.base,
      how(() => about),
    );
  }

  /**
   * @param {SearchProgress | null | undefined} found
   * @param {string} address
   * @param {AskedSearch | null} about
   */
  function show(found, address, about) {
    /** @type {(asked: { quantity?: string | null, percent?: number | null }) => Quantity} */
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
            `${refusals.reduce((sum, { count }) => sum + count, 0)} ${what} cannot be computed${mostOften(refusals, (detail) => form.inWords(detail))}.`,
          ]
        : [],
    );
    const missing = h("p", { className: "outdated", hidden: !failed.length }, failed.join(" "));
    if (!best) return out.replaceChildren(missing);
    const rows = Object.entries(best.values).map(([path, value]) =>
      tableRow(form.named(path), number(at(about.base, path) ?? null, 5), number(value, 5)),
    );

    const atEnd = about.search.variables
      .filter(({ path, low, high }) => [low, high].includes(at(best, "/values")?.[path]))
      .map(({ path }) => form.named(path));
    /** @type {(row: number) => Promise<void>} */
    const open = async (row) => void onOpen({ ...(await json(`${address}/designs/${row}`)), ...further }, null);
    /** @type {(row: number, words: string) => HTMLButtonElement} */
    const use = (row, words) => button(words, () => open(row));
    drawBeside(address, best.row, about.base);
    const reached = generations.flatMap(({ best: value = null }, i) =>
      value === null ? [] : [[i + 1, parts[0].factor * value]],
    );
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
              title:
                "The front: no design found is better in both; the large point is the best compromise. Press a point to open its design",
            }),
            frontOf(front, parts, use),
          ]
        : reached.length > 1
          ? [
              figure({
                lines: [{ x: reached.map(([i]) => i), y: reached.map(([, value]) => value) }],
                x: "generation",
                y: inUnit(parts[0]),
                title: "The best so far, generation by generation",
              }),
            ]
          : [];
    const fine =
      confirmed &&
      (confirmed.error_estimate
        ? `By the ${about.base.method.startsWith("three") ? "three-dimensional" : "flexible"} method on the fine grid: ${told(confirmed.goals, parts)}; another grid level changes the peak-to-peak value by ${fixed(confirmed.error_estimate.transmission_error_peak_to_peak_um, 4)} µm.`
        : `It could not be confirmed: ${confirmed.problem?.detail ?? "there are no results"}`);
    out.replaceChildren(
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
      beside,
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
  async function drawBeside(address, row, base) {
    if (drawn === `${address} ${row}`) return;
    const asked = (drawn = `${address} ${row}`);
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
      if (asked !== drawn) return;
      beside.replaceChildren(...pictures);
      const curves = await Promise.all(
        both.map(async ([name, submission]) => ({ name, curve: withPoints((await preview(submission)).curves[0]) })),
      );
      if (asked !== drawn) return;
      const lines = curves.map(({ name, curve }, i) => ({
        name,
        x: curve.mesh_position,
        y: curve.transmission_error_um,
        color: `var(--series-${i + 1})`,
        dash: DASHES[i],
      }));
      beside.append(
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
  function frontOf(front, parts, use) {
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

  const refresh = () => variables.forEach((each) => each.refresh());
  refresh();
  return { refresh, resume };
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
          /** @type {NonNullable<Search["subject_to"]>[number]} */ ({
            quantity: bounded.value,
            [side.value]: (given(bound) ?? NaN) / quantityOf(bounded.value).factor,
          }),
        ]
      : [];
  return { element, read };
}

/**
 * A field and the range that is searched, around the value that the design has.
 *
 * @param {number} index
 * @param {Design} design
 * @param {Form} form
 */
function variable(index, design, form) {
  const id = `variable-${index}`;
  // Until somebody chooses one the field is one that the design has, whichever design that is.
  const field = h("select", {
    id,
    on: {
      change: () => {
        field.dataset.chosen = "yes";
        suggest();
      },
    },
  });
  const [low, high, step] = ["low", "high", "step"].map((name) =>
    numeric({
      id: `${id}-${name}`,
      ariaLabel: `${{ low: "Smallest", high: "Largest", step: "Step of the" }[name]} value of variable ${index + 1}`,
    }),
  );
  const element = inLine(
    h("label", { htmlFor: id }, index ? "and" : "Choose"),
    field,
    ...labelled("from", low),
    ...labelled("to", high),
    ...labelled("in steps of", step),
  );

  function suggest() {
    const known = form.fields().find(({ pointer }) => pointer === field.value);
    const value = at(design.submission, field.value);
    if (typeof value !== "number") return;
    const ends = value === 0 ? [0, 1] : [0.4 * value, 2 * value].sort((a, b) => a - b);
    /** @type {(end: number) => number} */
    const round = (end) => (known?.kind.whole ? Math.round(end) : Number(end.toPrecision(3)));
    [low.value, high.value, step.value] = [`${round(ends[0])}`, `${round(ends[1])}`, known?.kind.whole ? "1" : ""];
  }

  const read = () =>
    field.value && low.value !== "" && high.value !== ""
      ? [{ path: field.value, low: given(low) ?? NaN, high: given(high) ?? NaN, step: given(step) ?? null }]
      : [];

  /** Only fields that have a number in this design can be searched. */
  function refresh() {
    const fields = form.fields().filter(({ pointer }) => typeof at(design.submission, pointer) === "number");
    const offered = FIRST.filter((first) => fields.some(({ pointer }) => pointer === first)).slice(0, BEGUN);
    const before = field.value;
    offer(field, index ? "nothing else" : "a field", fields);
    if (!field.dataset.chosen) field.value = offered[index] ?? "";
    if (low.value === "" || field.value !== before) suggest();
  }
  return { element, read, refresh };
}
