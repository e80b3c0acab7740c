// @ts-check
// Designs beside each other: their numbers under names that the user gives, and the fields in which they differ.

import { looks } from "../draw/looks.js";
import { button, h, note } from "../draw/dom.js";
import { saveTable } from "../draw/download.js";
import { differences, told } from "../state/design.js";
import { markOf } from "../state/marks.js";
import { extent, number } from "../state/numbers.js";
import { calledOf, inCurve, quantities, shown } from "../state/quantities.js";
import { csvOf, fileOfDesign } from "../state/tables.js";

/** @import { Curve, NamedDesign, Results, Submission } from "../state/documents.js" */
/** @import { Quantity } from "../state/quantities.js" */

/** @typedef {{ name: string, curve: Curve, results: Results, live: boolean }} Column */

/**
 * `onKept` changes the kept design of an index, or takes it away; `onOpen` opens a design, `onMethods` compares
 * methods.
 *
 * @typedef {object} Hearers
 * @property {(index: number, change: Partial<NamedDesign> | null) => void} onKept
 * @property {(design: NamedDesign) => void} onOpen
 * @property {() => void} onMethods
 * @property {(pointer: string) => string} named
 * @property {(submission: Submission, pointer: string) => unknown} usual
 */

/** What differs by less than this part is the same. */
const SAME = 1e-3;

/**
 * The quantities that any of `columns` tells, each with its values in them.
 *
 * @param {Column[]} columns
 */
export function toldBy(columns) {
  /** @type {(quantity: Quantity) => (number | undefined)[]} */
  const read = (quantity) => columns.map(({ curve }) => inCurve(quantity, curve) ?? undefined);
  return quantities()
    .map((quantity) => ({ quantity, values: read(quantity) }))
    .filter(({ values }) => values.some(Number.isFinite));
}

/**
 * A column for each torque of each of the designs, the live one first.
 *
 * @type {(designs: NamedDesign[]) => Column[]}
 */
export const columnsOf = (designs) =>
  designs.flatMap(({ name, results }, i) => results.curves.map((curve) => ({ name, curve, results, live: i === 0 })));

/**
 * The numbers of `designs` as CSV: a line for each design and torque.
 *
 * @type {(designs: NamedDesign[]) => string}
 */
export function designsCsv(designs) {
  const columns = columnsOf(designs);
  const told = toldBy(columns);
  const head = [
    "design",
    "method",
    "Torque (N m)",
    ...told.map(({ quantity }) =>
      quantity.printed ? `${calledOf(quantity)} (${quantity.printed})` : calledOf(quantity),
    ),
  ];
  return csvOf([
    head,
    ...columns.map(({ name, curve, results }, i) => [
      name,
      results.method,
      curve.output_torque_n_m,
      ...told.map(({ quantity: { factor }, values: { [i]: value } }) => value && factor * value),
    ]),
  ]);
}

/**
 * The comparison in `place`: a column for each design and torque. `named` says what the field at a pointer is called,
 * and of which gear it is, `usual` what it is in a submission that does not give it.
 */
export class Compare {
  /**
   * @param {HTMLElement} place
   * @param {Hearers} hearers
   */
  constructor(place, { onKept, onOpen, onMethods, named, usual }) {
    /** @type {NamedDesign[]} */
    this.designs = [];
    this.onKept = onKept;
    this.onOpen = onOpen;
    this.named = named;
    this.usual = usual;
    this.table = h("div", {
      className: "scroll",
      id: "table",
      tabIndex: 0,
      role: "region",
      ariaLabel: "Designs beside each other",
    });
    this.note = note();
    place.append(
      this.table,
      this.note,
      h(
        "div",
        { className: "buttons wrap" },
        button("Compare methods", onMethods, { id: "methods" }),
        button(
          "Table as CSV",
          () => saveTable(fileOfDesign(this.designs[0].name, "designs.csv"), designsCsv(this.designs)),
          { id: "table-csv" },
        ),
      ),
    );
  }

  /**
   * Shows `designs`, the live one first.
   *
   * @param {NamedDesign[]} designs
   */
  show(designs) {
    this.designs = designs;
    const focused = document.activeElement?.id;
    const colors = looks();
    // What is not given has its default: a design that gives it is not another one.
    const given = differences(designs.map(({ submission }) => submission)).map(({ pointer, values }) => ({
      pointer,
      values: values.map((value, i) => value ?? this.usual(designs[i].submission, pointer)),
    }));
    const rows = given.filter(
      ({ pointer, values }) => pointer !== "/tags" && values.some((value) => told(value) !== told(values[0])),
    );
    this.table.replaceChildren(
      h(
        "table",
        {},
        h(
          "caption",
          { className: "visually-hidden" },
          "Statistics over the true period, and the fields in which the designs differ",
        ),
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            h("th", { scope: "col" }, "Design"),
            ...designs.map((design, i) => this.#head(design, i, colors)),
          ),
        ),
        h("tbody", { id: "quantities" }, ...this.#quantities(designs)),
        ...(rows.length
          ? [
              h(
                "tbody",
                { id: "differences" },
                h(
                  "tr",
                  {},
                  h(
                    "th",
                    {
                      scope: "rowgroup",
                      colSpan: 1 + designs.reduce((sum, { results }) => sum + results.curves.length, 0),
                    },
                    "Differs in",
                  ),
                ),
                ...rows.map((row) => this.#difference(row, designs)),
              ),
            ]
          : []),
      ),
    );
    this.note.textContent =
      designs.length < 2
        ? "Keep to compare puts the design beside what you change next: its curves, its numbers, and the fields in which both differ."
        : rows.length
          ? ""
          : "These designs are the same in every field.";
    if (focused && document.activeElement?.id !== focused) document.getElementById(focused)?.focus();
  }

  /**
   * The name of a design over its columns, and what can be done with a kept one.
   *
   * @param {NamedDesign} design
   * @param {number} i
   * @param {ReturnType<typeof looks>} colors
   */
  #head(design, i, colors) {
    const swatch = h("span", { className: "swatch" });
    swatch.style.borderColor = colors.series(design.look);
    const { curves, method } = design.results;
    const how = h("small", {}, `${method.replace(/_/g, " ")}${curves[0].statistics.partial ? ", partial" : ""}`);
    const span = { colSpan: curves.length, scope: curves.length > 1 ? "colgroup" : "col" };
    if (i === 0) return h("th", { ...span, className: "live" }, swatch, design.name, how);
    // Two lines of a narrow column tell names apart that begin alike.
    const name = h("textarea", {
      id: `name-${i}`,
      rows: 2,
      value: design.name,
      spellcheck: false,
      ariaLabel: `Name of ${design.name}`,
      maxLength: 80,
      on: {
        change: (event) => this.onKept(i - 1, { name: event.target.value.replace(/\s+/g, " ").trim() || design.name }),
        keydown: (event) => {
          if (event.key === "Enter") {
            event.preventDefault();
            event.target.blur();
          }
        },
      },
    });
    const seen = h("input", {
      type: "checkbox",
      checked: !design.hidden,
      on: { change: (event) => this.onKept(i - 1, { hidden: !event.target.checked }) },
    });
    return h(
      "th",
      span,
      swatch,
      name,
      how,
      h(
        "div",
        { className: "actions" },
        h("label", { title: "Show its curves" }, seen, " curves"),
        button("Open", () => this.onOpen(design), { ariaLabel: `Open ${design.name}` }),
        button("×", () => this.onKept(i - 1, null), { ariaLabel: `Remove ${design.name}`, title: "Remove" }),
      ),
    );
  }

  /**
   * A line for each quantity that any of the designs tells. The best of designs at one torque is marked, unless a
   * warning limits what one of them says.
   *
   * @param {NamedDesign[]} designs
   */
  #quantities(designs) {
    const columns = columnsOf(designs);
    /** @type {(name: string, printed: string, cells: HTMLElement[]) => HTMLElement} */
    const line = (name, printed, cells) =>
      h("tr", {}, h("th", { scope: "row" }, name, printed ? h("small", {}, ` ${printed}`) : null), ...cells);
    const torques = line(
      "Torque",
      "N m",
      columns.map(({ curve, live }) => h("td", { className: live ? "live" : "" }, number(curve.output_torque_n_m, 6))),
    );
    return [
      torques,
      ...toldBy(columns).map(({ quantity, values }) =>
        line(
          calledOf(quantity),
          quantity.printed,
          columns.map(({ curve: { output_torque_n_m: torque }, results, live }, i) => {
            const rivals = columns.flatMap(({ curve, results }, k) =>
              values[k] !== undefined && curve.output_torque_n_m === torque
                ? [{ value: values[k], mark: markOf(quantity.name, results.warnings) }]
                : [],
            );
            const value = values[i];
            const mark = value === undefined ? undefined : markOf(quantity.name, results.warnings);
            const best =
              value !== undefined &&
              rivals.every((rival) => !rival.mark) &&
              isBest(
                value,
                rivals.map((rival) => rival.value),
                quantity.better,
              );
            return h(
              "td",
              { className: [best ? "best" : "", live ? "live" : ""].join(" ").trim() },
              shown(quantity, value),
              best ? h("span", { className: "visually-hidden" }, " best") : null,
              mark ? h("small", { title: mark.detail }, ` ${mark.word}`) : null,
            );
          }),
        ),
      ),
    ];
  }

  /**
   * A field in which the designs differ.
   *
   * @param {{ pointer: string, values: unknown[] }} row
   * @param {NamedDesign[]} designs
   */
  #difference({ pointer, values }, designs) {
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, this.named(pointer)),
      ...values.map((value, i) => h("td", { colSpan: designs[i].results.curves.length }, told(value))),
    );
  }
}

/**
 * Whether a value is better than all of its rivals that are not as good.
 *
 * @type {(value: number, rivals: (number | undefined)[], better: Quantity["better"]) => boolean}
 */
function isBest(value, rivals, better) {
  if (!better || rivals.length < 2) return false;
  const [least, most] = extent(rivals) ?? [0, 0];
  if (most - least <= SAME * Math.abs(most)) return false;
  return Math.abs(value - (better === "smaller" ? least : most)) <= SAME * Math.abs(value);
}
