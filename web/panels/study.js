// @ts-check
// Many designs at once: axes of values over any fields, a table, a picture of two of its columns, and which designs no
// other beats; or a search that chooses the values itself.

import { asking, button, h, inLine, labelled, note, region, table, unseen } from "../draw/dom.js";
import { saveTable } from "../draw/download.js";
import { figure, roomIn } from "../draw/figure.js";
import { allGiven, given, numeric, put } from "../draw/inputs.js";
import { FieldChoice, options } from "./offer.js";
import { offerTold, StudyPanel } from "./panel.js";
import { Search } from "./search.js";
import { json, request } from "../state/api.js";
import { at, nameOf, withValue } from "../state/design.js";
import { markInRow } from "../state/marks.js";
import { number } from "../state/numbers.js";
import { calledOf, inRow, inUnit, inWords, quantityOf, shown, worstInRow } from "../state/quantities.js";
import { usualAt } from "../state/schema.js";
import { fileOfDesign } from "../state/tables.js";

/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, Open, RowCurve, StudyResults, TableRow } from "../state/documents.js" */
/** @import { Quantity } from "../state/quantities.js" */
/** @import { Form } from "../views/form.js" */

/** What the picture shows first, over what. */
const [ACROSS, UP] = ["pair_mass_kg", "transmission_error_um.peak_to_peak"];
/** The columns of the table before the torque, of the gear of the study where they are of one, and behind it. */
const OF_ROW = ["pair_mass_kg", "mass_removed_percent", "least_ligament_mm"];
const STIFFNESS = "mesh_stiffness_tangent_n_per_m.mean";
const OF_CURVE = [UP, STIFFNESS, "hole_order_um", "mesh_order_um"];

const TORQUE = "/output_torques_n_m";
/** With which field the first axis begins until somebody chooses another one, and the values of such a field. */
const [COUNT, COUNTS] = [/^\/pair\/driven\/blank\/holes\/(0\/)?count$/, "6, 8, 10"];

/**
 * The words of values that are no numbers.
 *
 * @type {Record<string, boolean | null>}
 */
const WORDS = { true: true, false: false, null: null };

/** The parts of gears that a design may lack and an axis may change all the same, and their fields. */
const PART = /^(\/pair\/\w+\/(?:blank\/holes|blank\/web|tip_relief))\//;
/** @type {string[]} */
const LACKING = ["driving", "driven"].flatMap((gear) =>
  [
    "tip_relief/amount_um",
    "blank/holes/count",
    "blank/holes/circle_radius_mm",
    "blank/holes/radius_mm",
    "blank/web/thickness_mm",
    "blank/web/inner_radius_mm",
    "blank/web/outer_radius_mm",
  ].map((name) => `/pair/${gear}/${name}`),
);

/**
 * The study of a design, with a search below it.
 *
 * @augments {StudyPanel<StudyResults>}
 */
export class StudyOfAxes extends StudyPanel {
  /**
   * The study of `design` in `place`; `form` knows the fields, `onOpen` opens the design of a row.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {Form} form
   * @param {Open} onOpen
   */
  constructor(place, design, form, onOpen) {
    super(place, design, { id: "study", words: "Run the study", inWords: (detail) => form.names.inWords(detail) });
    this.form = form;
    this.onOpen = onOpen;
    this.axes = [0, 1].map((index) => new Axis(design, form, index));
    this.constant = h("input", { type: "checkbox", id: "study-mass" });
    this.gear = h(
      "select",
      { id: "study-gear", ariaLabel: "Gear of the same mass" },
      h("option", { value: "driven" }, "driven"),
      h("option", { value: "driving" }, "driving"),
    );
    this.removed = numeric({ id: "study-removed", value: 25, ariaLabel: "Mass removed in percent" });
    /** @type {(id: string, chosen: string) => HTMLSelectElement} */
    const axisOf = (id, chosen) =>
      h("select", { id, on: { change: () => this.last && this.#draw(this.last.found) } }, ...options(chosen));
    this.across = axisOf("study-across", ACROSS);
    this.up = axisOf("study-up", UP);
    this.picture = h("div", {});
    this.picker = inLine(...labelled("Picture:", this.up), ...labelled("over", this.across));
    this.picker.hidden = true;
    const searched = h("div", {});
    this.details = h("details", { id: "search" }, h("summary", {}, "Let a search choose the values"), searched);
    place.replaceChildren(
      note(
        "Every combination of these values is computed from the design; values stand apart by spaces. “Best” is a design that no other beats: none is at least as good in mass, peak-to-peak and mean stiffness, and better in one. Where one of these numbers has a mark, the design is not called best.",
      ),
      asking(
        () => void this.start(),
        ...this.axes.map((each) => each.element),
        inLine(
          this.constant,
          h("label", { htmlFor: "study-mass" }, "Same mass: holes remove"),
          this.removed,
          h("span", { className: "unit" }, "% of the"),
          this.gear,
          h("span", {}, "blank, all equally wide"),
        ),
        inLine(this.run, this.cancel),
      ),
      this.state,
      this.outdated,
      this.picker,
      this.picture,
      this.out,
      this.details,
    );
    this.search = new Search(searched, design, form, onOpen);
  }

  refresh() {
    for (const each of [...this.axes, this.search]) each.refresh();
  }

  clear() {
    super.clear();
    this.picture.replaceChildren();
  }

  asked() {
    /** @type {AskedStudy} */
    const asked = {
      base: this.#base(),
      axes: this.axes.flatMap((each) => each.read()),
      name: nameOf(this.design.submission),
    };
    if (this.constant.checked) {
      // What is missing the service says.
      const mass_removed_percent = /** @type {number} */ (given(this.removed));
      asked.constant_mass = { gear: this.gear.value === "driving" ? "driving" : "driven", mass_removed_percent };
    }
    return asked;
  }

  /**
   * Shows a study, or the search, that was asked for before.
   *
   * @param {string} id
   * @param {AskedStudy} asked
   */
  async resume(id, asked) {
    if (!asked.search) return super.resume(id, asked);
    this.details.open = true;
    return this.search.resume(id, asked);
  }

  /** The design, with holes or a web to begin with where an axis changes what it lacks. */
  #base() {
    const touched = this.axes.flatMap((each) => each.read()).flatMap(({ path }) => PART.exec(path)?.[1] ?? []);
    let { submission } = this.design;
    for (const pointer of touched)
      if (!at(submission, pointer))
        submission = withValue(submission, pointer, this.form.beginnings.object(pointer, null));
    return submission;
  }

  /**
   * @param {StudyResults} results
   * @param {string} address
   */
  show(results, address) {
    this.#draw(results);
    const csv = button("Table as CSV", async () =>
      saveTable(
        fileOfDesign(this.about?.name ?? "", "study.csv"),
        await (await request(`${address}/results/table.csv`)).text(),
      ),
    );
    this.out.replaceChildren(
      region("Designs of the study", this.#tableOf(results)),
      h("div", { className: "buttons" }, csv),
    );
  }

  /** @param {StudyResults} results */
  #draw(results) {
    const [computed] = [this.across, this.up].map((select) => offerTold(select, results));
    const [x, y] = [quantityOf(this.across.value), quantityOf(this.up.value)];
    /** @type {(quantity: Quantity, row: TableRow) => number} */
    const readOf = (quantity, row) => quantity.factor * worstInRow(quantity, row, results.gear);
    const points = computed
      .map((row) => ({ x: readOf(x, row), y: readOf(y, row), label: this.#nameOfRow(row), strong: isBest(row) }))
      .filter((point) => Number.isFinite(point.x) && Number.isFinite(point.y));
    this.picker.hidden = computed.length < 2;
    const title = `Designs by ${inWords(x)} and ${inWords(y)}, of several torques the worst; large points are the best`;
    this.picture.replaceChildren(
      ...(points.length > 1 ? [figure({ points, x: inUnit(x), y: inUnit(y), title, width: roomIn(this.out) })] : []),
    );
  }

  /** @param {StudyResults} results */
  #tableOf({ rows, gear }) {
    const ofRow = OF_ROW.map(
      (name) => [name, `${name}.${gear}`].map(quantityOf).find((each) => each.of) ?? quantityOf(name),
    );
    const ofCurve = OF_CURVE.map(quantityOf);
    /** @type {(quantity: Quantity) => string} */
    const named = (quantity) => `${calledOf(quantity)} ${quantity.printed}`;
    const names = ["Design", "Best", ...ofRow.map(named), "Torque N m", ...ofCurve.map(named), unseen("Actions")];
    /** @type {(row: TableRow, curve: RowCurve) => (string | HTMLElement)[]} */
    const cells = (row, curve) => {
      /** @type {(quantity: Quantity) => string | HTMLElement} */
      const each = (quantity) => {
        const value = inRow(quantity, row, curve, gear);
        const mark = typeof value === "number" ? markInRow(quantity.name, row) : undefined;
        const told = shown(quantity, value);
        return mark ? h("span", {}, told, h("small", { title: mark.detail }, ` ${mark.word}`)) : told;
      };
      return [...ofRow.map(each), number(curve.output_torque_n_m), ...ofCurve.map(each)];
    };
    return table(
      names,
      rows.flatMap((row) => this.#rowsOf(row, cells)),
    );
  }

  /**
   * @param {TableRow} row
   * @param {(row: TableRow, curve: RowCurve) => (string | HTMLElement)[]} cells
   */
  #rowsOf(row, cells) {
    const lead = [
      h("th", { scope: "row" }, this.#nameOfRow(row)),
      h(
        "td",
        {},
        isBest(row)
          ? h(
              "strong",
              { title: "No other design is at least as good in mass, peak-to-peak and stiffness, and better in one" },
              "yes",
            )
          : "",
      ),
    ];
    if (!row.curves?.length)
      return [
        h(
          "tr",
          {},
          ...lead,
          h("td", { colSpan: 9 }, row.problem ? (row.problem.errors?.[0]?.detail ?? row.problem.detail) : row.status),
        ),
      ];
    const open = button("Open", () => this.#openRow(row), { ariaLabel: `Open ${this.#nameOfRow(row)}` });
    return row.curves.map((curve, i) =>
      h(
        "tr",
        { className: isBest(row) ? "strong" : "" },
        ...(i ? [h("th", { scope: "row" }, this.#nameOfRow(row)), h("td")] : lead),
        ...cells(row, curve).map((cell) => h("td", {}, cell)),
        h("td", {}, i ? "" : open),
      ),
    );
  }

  /**
   * What a row changes, in the words of the form.
   *
   * @param {TableRow} row
   */
  #nameOfRow({ label, changes }) {
    const words = Object.entries(/** @type {Record<string, unknown>} */ (changes)).map(
      ([pointer, value]) =>
        `${this.form.names.named(pointer)} ${typeof value === "number" ? number(value, 5) : Array.isArray(value) ? value.join(", ") : String(value).replace(/_/g, " ")}`,
    );
    return words.join("; ") || label;
  }

  /** @param {TableRow} row */
  async #openRow(row) {
    const job = await json(`v1/jobs/${row.job}`);
    this.onOpen(job.submission, null);
  }
}

/**
 * Whether no other design beats that of a row, and no mark limits the numbers by which they are compared.
 *
 * @type {(row: TableRow) => boolean}
 */
const isBest = (row) => row.pareto && ![UP, STIFFNESS].some((name) => markInRow(name, row));

/** Values over a field that is chosen from all that the form has. */
class Axis extends FieldChoice {
  /**
   * @param {Design} design
   * @param {Form} form
   * @param {number} index
   */
  constructor(design, form, index) {
    const id = `axis-${index}`;
    super(design, form, { id, index, words: "Vary", none: "none" });
    this.values = h("input", {
      type: "text",
      id: `${id}-values`,
      ariaLabel: `Values of axis ${index + 1}`,
      spellcheck: false,
    });
    this.element = inLine(this.label, this.field, ...labelled("over", this.values));
    this.refresh();
  }

  suggest() {
    put(this.values, this.#suggested());
  }

  /** Values around the one that the design has. */
  #suggested() {
    const path = this.field.value;
    if (COUNT.test(path)) return COUNTS;
    const { kind } = this.known ?? {};
    const [, part] = PART.exec(path) ?? [];
    const begun =
      part && !this.design.get(part) ? at(this.form.beginnings.object(part, null), path.slice(part.length)) : undefined;
    const value = this.value ?? usualAt(this.form.api, this.design.submission, path) ?? begun;
    if (kind?.kind === "choice") return (kind.schema.enum ?? []).join(", ");
    if (typeof value !== "number") return "";
    if (value === 0) return kind?.whole ? "0, 1, 2" : "0, 0.1, 0.2";
    return [0.9, 1, 1.1]
      .map((part) => (kind?.whole ? Math.round(part * value) : Number((part * value).toPrecision(3))))
      .join(", ");
  }

  /**
   * The axis; none without a field or values. A field within a list is changed by its place; the torque as the list
   * that it is.
   *
   * @returns {{ path: string, values: unknown[] }[]}
   */
  read() {
    const path = this.field.value;
    if (!path || !this.values.value.trim()) return [];
    /** @type {unknown[]} */
    const listed = ["choice", "flag"].includes(this.known?.kind.kind ?? "")
      ? this.values.value
          .split(/[\s,;]+/)
          .filter(Boolean)
          .map((word) => (word in WORDS ? WORDS[word] : word))
      : allGiven(this.values);
    const values = [...new Set(listed)];
    return [{ path, values: path === TORQUE ? values.map((value) => [value]) : values }];
  }

  refresh() {
    const fields = this.form.offered().filter(({ pointer }) => pointer !== "/tags");
    // Several patterns have fields of their own, and none of one pattern.
    const absent = LACKING.filter(
      (pointer) =>
        !fields.some((each) => each.pointer === pointer) &&
        !Array.isArray(this.design.get(PART.exec(pointer)?.[1] ?? "")),
    );
    const all = [
      ...[...absent, TORQUE].map((pointer) => ({ pointer, title: this.form.names.titled(pointer) })),
      ...fields,
    ];
    const before = this.field.value;
    // The field that was chosen may not be there any more.
    if (!this.offer(all)) this.values.value = "";
    if (this.index === 0 && !this.isChosen)
      this.field.value = all.find(({ pointer }) => COUNT.test(pointer))?.pointer ?? "";
    if (this.field.value && this.field.value !== before) this.suggest();
  }
}
