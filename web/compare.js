// Designs beside each other: their numbers under names that the user gives, and the fields in which they differ.

import { h, fixed, number } from "./dom.js";
import { differences, parts } from "./design.js";
import { csvOf, save } from "./download.js";
import { largestStress } from "./headline.js";
import { looks } from "./charts.js";

const order = (curve, pattern) => curve.spectrum?.named.find(({ label }) => pattern.test(label))?.transmission_error_um;
/** The value of a stress at the roots of both gears that is farthest from none. */
const root = (name) => ({ stress }) => {
  const known = ["driving", "driven"].flatMap((gear) => stress?.[gear][name] ?? []).filter((value) => value !== null);
  return known.length ? known.reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most)) : undefined;
};
const pressure = (curve) => {
  const known = curve.peak_contact_pressure_mpa.filter((value) => value !== null);
  return known.length ? Math.max(...known) : undefined;
};

/** The columns: name, unit, how a number is read from a curve and its results, and how it is printed. */
const COLUMNS = [
  ["Torque", "N m", (curve) => curve.output_torque_n_m, (value) => number(value, 6)],
  ["STE mean", "µm", (curve) => curve.statistics.transmission_error_um.mean, (value) => fixed(value, 3)],
  ["STE rms", "µm", (curve) => curve.statistics.transmission_error_um.rms, (value) => fixed(value, 3)],
  ["STE p-p", "µm", (curve) => curve.statistics.transmission_error_um.peak_to_peak, (value) => fixed(value, 3)],
  ["k mean", "N/µm", (curve) => curve.statistics.mesh_stiffness_tangent_n_per_m.mean * 1e-6, (value) => fixed(value, 2)],
  ["k p-p", "N/µm", (curve) => curve.statistics.mesh_stiffness_tangent_n_per_m.peak_to_peak * 1e-6, (value) => fixed(value, 2)],
  ["K_Hβ", "", (curve) => curve.face?.face_load_factor, (value) => fixed(value, 3)],
  ["H_N", "µm", (curve) => order(curve, /^H_N\d?$/), (value) => number(value, 3)],
  ["H_Z2", "µm", (curve) => order(curve, /^H_Z2?$/), (value) => number(value, 3)],
  ["Max pressure", "MPa", pressure, (value) => fixed(value, 0)],
  ["Max stress", "MPa", (curve) => largestStress(curve) ?? undefined, (value) => fixed(value, 1)],
  ["Root tension", "MPa", root("root_tension_mpa"), (value) => fixed(value, 1)],
  ["Root compression", "MPa", root("root_compression_mpa"), (value) => fixed(value, 1)],
  ["Driving mass", "kg", (_, { pair }) => pair.driving.mass_kg, (value) => fixed(value, 3)],
  ["Driven mass", "kg", (_, { pair }) => pair.driven.mass_kg, (value) => fixed(value, 3)],
  ["Removed", "%", (_, { pair }) => pair.driven.mass_removed_percent, (value) => fixed(value, 1)],
];

/** Columns that are there where stresses were asked for. */
const STRESSES = ["Max stress", "Root tension", "Root compression"];

/** The numbers of `designs` as CSV: a line for each design and torque. */
export function designsCsv(designs) {
  const lines = [["design", "method", ...COLUMNS.map(([name, unit]) => `${name} (${unit})`)]];
  for (const { name, results } of designs) for (const curve of results.curves) lines.push([name, results.method, ...COLUMNS.map(([, , read]) => read(curve, results))]);
  return csvOf(lines);
}

/** The comparison in `place`. `named` says what the field at a pointer is called, and of which gear it is. */
export class Compare {
  #key = "";

  constructor(place, { onKept, onOpen, onMethods, named }) {
    Object.assign(this, { onKept, onOpen, named });
    this.table = h("div", { className: "scroll", id: "table", tabIndex: 0, role: "region", ariaLabel: "Statistics" });
    this.fields = h("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: "Fields in which the designs differ" });
    const button = (name, id, work) => h("button", { type: "button", id, on: { click: work } }, name);
    place.append(this.table, h("div", { className: "buttons wrap" },
      button("Compare methods", "methods", onMethods), button("Table as CSV", "table-csv", () => save("meshwright-designs.csv", "text/csv", designsCsv(this.designs)))), this.fields);
  }

  /** Shows `designs`, the live one first. */
  show(designs) {
    this.designs = designs;
    const focused = document.activeElement?.id;
    const stressed = designs.some(({ results }) => results.curves.some(({ stress }) => stress));
    const alongFaces = designs.some(({ results }) => results.curves.some(({ face }) => face));
    const columns = COLUMNS.filter(([name]) => (stressed || !STRESSES.includes(name)) && (alongFaces || name !== "K_Hβ"));
    const head = h("tr", {}, h("th", { scope: "col" }, "Design"), ...columns.map(([name, unit]) => h("th", { scope: "col" }, name, h("small", {}, ` ${unit}`))), h("th", { scope: "col" }, h("span", { className: "visually-hidden" }, "Actions")));
    const colors = looks();
    const rows = designs.flatMap((design, i) => design.results.curves.map((curve, j) => this.#row(design, curve, [i, j], columns, colors)));
    this.table.replaceChildren(h("table", {}, h("caption", { className: "visually-hidden" }, "Statistics over the true period"), h("thead", {}, head), h("tbody", {}, ...rows)));
    this.#differ(designs);
    if (focused && document.activeElement?.id !== focused) document.getElementById(focused)?.focus();
  }

  #row(design, curve, [i, j], columns, colors) {
    const swatch = h("span", { className: "swatch" });
    swatch.style.borderColor = colors.series[design.look % 7];
    const partial = curve.statistics.partial ? ", partial" : "";
    const method = h("small", {}, ` ${design.results.method.replace(/_/g, " ")}${partial}`);
    const name = i > 0 && j === 0
      ? h("input", { type: "text", id: `name-${i}`, value: design.name, ariaLabel: `Name of ${design.name}`, maxLength: 80, on: { change: (event) => this.onKept(i - 1, { name: event.target.value.trim() || design.name }) } })
      : design.name;
    const cells = columns.map(([, , read, print]) => {
      const value = read(curve, design.results);
      return h("td", {}, value === undefined ? "–" : print(value));
    });
    const actions = h("td", { className: "actions" });
    if (i > 0 && j === 0) {
      const seen = h("input", { type: "checkbox", checked: !design.hidden, on: { change: (event) => this.onKept(i - 1, { hidden: !event.target.checked }) } });
      actions.append(h("label", { title: "Show its curves" }, seen, " curves"),
        h("button", { type: "button", on: { click: () => this.onOpen(design) }, ariaLabel: `Open ${design.name}` }, "Open"),
        h("button", { type: "button", on: { click: () => this.onKept(i - 1, null) }, ariaLabel: `Remove ${design.name}` }, "×"));
    }
    return h("tr", { className: i === 0 ? "live" : "" }, h("th", { scope: "row" }, swatch, name, method), ...cells, actions);
  }

  /** The fields in which the designs differ, one a line. */
  #differ(designs) {
    const rows = designs.length > 1 ? differences(designs.map(({ submission }) => submission)) : [];
    const key = JSON.stringify([rows, designs.map(({ name }) => name)]);
    if (key === this.#key) return;
    this.#key = key;
    if (designs.length < 2) return this.fields.replaceChildren(h("p", { className: "note" }, "Keep to compare puts the design beside what you change next: its curves, its numbers, and the fields in which both differ."));
    const shown = (value) => (value === undefined ? "not given" : Array.isArray(value) ? (value.length > 4 ? `${value.length} numbers` : value.join(", ")) : String(value));
    const head = h("tr", {}, h("th", { scope: "col" }, "Differs in"), ...designs.map(({ name }) => h("th", { scope: "col" }, name)));
    const body = rows.map(({ pointer, values }) => h("tr", {}, h("th", { scope: "row" }, this.named(pointer)), ...values.map((value) => h("td", {}, shown(value)))));
    this.fields.replaceChildren(rows.length ? h("table", {}, h("caption", {}, "Differences"), h("thead", {}, head), h("tbody", {}, ...body)) : h("p", { className: "note" }, "These designs are the same in every field."));
  }
}
