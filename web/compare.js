// Designs beside each other: their numbers under names that the user gives, and the fields in which they differ.

import { extent, h, fixed, number } from "./dom.js";
import { differences, told } from "./design.js";
import { csvOf, fileOfDesign, save } from "./download.js";
import { largest, largestStress } from "./headline.js";
import { looks } from "./charts.js";

const order = (curve, pattern) => curve.spectrum?.named.find(({ label }) => pattern.test(label))?.transmission_error_um;
/** The value of a stress at the roots of both gears that is farthest from none. */
const root = (name) => ({ stress }) => {
  const known = ["driving", "driven"].flatMap((gear) => stress?.[gear][name] ?? []).filter((value) => value !== null);
  return known.length ? known.reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most)) : undefined;
};

/** What designs are compared by: name, unit, how a number is read from a curve and its results, how it is printed, and whether less of it is better, where one is. */
const QUANTITIES = [
  ["Torque", "N m", (curve) => curve.output_torque_n_m, (value) => number(value, 6)],
  ["STE mean", "µm", (curve) => curve.statistics.transmission_error_um.mean, (value) => fixed(value, 3)],
  ["STE rms", "µm", (curve) => curve.statistics.transmission_error_um.rms, (value) => fixed(value, 3), true],
  ["STE p-p", "µm", (curve) => curve.statistics.transmission_error_um.peak_to_peak, (value) => fixed(value, 3), true],
  ["k mean", "N/µm", (curve) => curve.statistics.mesh_stiffness_tangent_n_per_m.mean * 1e-6, (value) => fixed(value, 2), false],
  ["k p-p", "N/µm", (curve) => curve.statistics.mesh_stiffness_tangent_n_per_m.peak_to_peak * 1e-6, (value) => fixed(value, 2), true],
  ["K_Hβ", "", (curve) => curve.face?.face_load_factor, (value) => fixed(value, 3), true],
  ["H_N", "µm", (curve) => order(curve, /^H_N\d?$/), (value) => number(value, 3), true],
  ["H_Z2", "µm", (curve) => order(curve, /^H_Z2?$/), (value) => number(value, 3), true],
  ["Max pressure", "MPa", (curve) => largest(curve.peak_contact_pressure_mpa) ?? undefined, (value) => fixed(value, 0), true],
  ["Max stress", "MPa", (curve) => largestStress(curve) ?? undefined, (value) => fixed(value, 1), true],
  ["Root tension", "MPa", root("root_tension_mpa"), (value) => fixed(value, 1), true],
  ["Root compression", "MPa", root("root_compression_mpa"), (value) => fixed(value, 1)],
  ["Driving mass", "kg", (_, { pair }) => pair.driving.mass_kg, (value) => fixed(value, 3), true],
  ["Driven mass", "kg", (_, { pair }) => pair.driven.mass_kg, (value) => fixed(value, 3), true],
  ["Removed", "%", (_, { pair }) => pair.driven.mass_removed_percent, (value) => fixed(value, 1)],
];

/** Quantities that are told where stresses were asked for. */
const STRESSES = ["Max stress", "Root tension", "Root compression"];
/** What differs by less than this part is the same. */
const SAME = 1e-3;

/** The numbers of `designs` as CSV: a line for each design and torque. */
export function designsCsv(designs) {
  const lines = [["design", "method", ...QUANTITIES.map(([name, unit]) => `${name} (${unit})`)]];
  for (const { name, results } of designs) for (const curve of results.curves) lines.push([name, results.method, ...QUANTITIES.map(([, , read]) => read(curve, results))]);
  return csvOf(lines);
}

/** The comparison in `place`: a column for each design and torque. `named` says what the field at a pointer is called, and of which gear it is, `usual` what it is in a submission that does not give it. */
export class Compare {
  constructor(place, { onKept, onOpen, onMethods, named, usual }) {
    Object.assign(this, { onKept, onOpen, named, usual });
    this.table = h("div", { className: "scroll", id: "table", tabIndex: 0, role: "region", ariaLabel: "Designs beside each other" });
    this.note = h("p", { className: "note" });
    const button = (name, id, work) => h("button", { type: "button", id, on: { click: work } }, name);
    place.append(this.table, this.note, h("div", { className: "buttons wrap" },
      button("Compare methods", "methods", onMethods), button("Table as CSV", "table-csv", () => save(fileOfDesign(this.designs[0].name, "designs.csv"), "text/csv", designsCsv(this.designs)))));
  }

  /** Shows `designs`, the live one first. */
  show(designs) {
    this.designs = designs;
    const focused = document.activeElement?.id;
    const colors = looks();
    // What is not given has its default: a design that gives it is not another one.
    const given = differences(designs.map(({ submission }) => submission)).map(({ pointer, values }) => ({ pointer, values: values.map((value, i) => value ?? this.usual(designs[i].submission, pointer)) }));
    const rows = given.filter(({ pointer, values }) => pointer !== "/tags" && values.some((value) => told(value) !== told(values[0])));
    this.table.replaceChildren(h("table", {}, h("caption", { className: "visually-hidden" }, "Statistics over the true period, and the fields in which the designs differ"),
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Design"), ...designs.map((design, i) => this.#head(design, i, colors)))),
      h("tbody", { id: "quantities" }, ...this.#quantities(designs)),
      ...(rows.length ? [h("tbody", { id: "differences" }, h("tr", {}, h("th", { scope: "rowgroup", colSpan: 1 + designs.reduce((sum, { results }) => sum + results.curves.length, 0) }, "Differs in")), ...rows.map((row) => this.#difference(row, designs)))] : [])));
    this.note.textContent = designs.length < 2 ? "Keep to compare puts the design beside what you change next: its curves, its numbers, and the fields in which both differ."
      : rows.length ? "" : "These designs are the same in every field.";
    if (focused && document.activeElement?.id !== focused) document.getElementById(focused)?.focus();
  }

  /** The name of a design over its columns, and what can be done with a kept one. */
  #head(design, i, colors) {
    const swatch = h("span", { className: "swatch" });
    swatch.style.borderColor = colors.series(design.look);
    const { curves, method } = design.results;
    const how = h("small", {}, `${method.replace(/_/g, " ")}${curves[0].statistics.partial ? ", partial" : ""}`);
    const span = { colSpan: curves.length, scope: curves.length > 1 ? "colgroup" : "col" };
    if (i === 0) return h("th", { ...span, className: "live" }, swatch, design.name, how);
    // Two lines of a narrow column tell names apart that begin alike.
    const name = h("textarea", { id: `name-${i}`, rows: 2, value: design.name, spellcheck: false, ariaLabel: `Name of ${design.name}`, maxLength: 80, on: {
      change: (event) => this.onKept(i - 1, { name: event.target.value.replace(/\s+/g, " ").trim() || design.name }),
      keydown: (event) => { if (event.key === "Enter") { event.preventDefault(); event.target.blur(); } },
    } });
    const seen = h("input", { type: "checkbox", checked: !design.hidden, on: { change: (event) => this.onKept(i - 1, { hidden: !event.target.checked }) } });
    return h("th", span, swatch, name, how, h("div", { className: "actions" }, h("label", { title: "Show its curves" }, seen, " curves"),
      h("button", { type: "button", on: { click: () => this.onOpen(design) }, ariaLabel: `Open ${design.name}` }, "Open"),
      h("button", { type: "button", on: { click: () => this.onKept(i - 1, null) }, ariaLabel: `Remove ${design.name}`, title: "Remove" }, "×")));
  }

  /** A line for each quantity that any of the designs tells, the best of designs at one torque marked. */
  #quantities(designs) {
    const columns = designs.flatMap(({ results }, i) => results.curves.map((curve) => ({ curve, results, live: i === 0 })));
    const stressed = columns.some(({ curve }) => curve.stress);
    const alongFaces = columns.some(({ curve }) => curve.face);
    return QUANTITIES.filter(([name]) => (stressed || !STRESSES.includes(name)) && (alongFaces || name !== "K_Hβ")).map(([name, unit, read, print, less]) => {
      const values = columns.map(({ curve, results }) => read(curve, results));
      const cells = columns.map(({ curve: { output_torque_n_m: torque } }, i) => {
        const rivals = values.filter((value, k) => value !== undefined && columns[k].curve.output_torque_n_m === torque);
        const best = values[i] !== undefined && isBest(values[i], rivals, less);
        return h("td", { className: [best ? "best" : "", columns[i].live ? "live" : ""].join(" ").trim() }, values[i] === undefined ? "–" : print(values[i]), best ? h("span", { className: "visually-hidden" }, " best") : null);
      });
      return h("tr", {}, h("th", { scope: "row" }, name, unit ? h("small", {}, ` ${unit}`) : null), ...cells);
    });
  }

  /** A field in which the designs differ. */
  #difference({ pointer, values }, designs) {
    return h("tr", {}, h("th", { scope: "row" }, this.named(pointer)), ...values.map((value, i) => h("td", { colSpan: designs[i].results.curves.length }, told(value))));
  }
}

/** Whether a value is better than all of its rivals that are not as good. */
function isBest(value, rivals, less) {
  if (less === undefined || rivals.length < 2) return false;
  const [least, most] = extent(rivals);
  if (most - least <= SAME * Math.abs(most)) return false;
  return Math.abs(value - (less ? least : most)) <= SAME * Math.abs(value);
}
