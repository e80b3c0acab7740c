// The numbers of every design shown, and what they mean.

import { h, fixed, number } from "./dom.js";

const COLUMNS = [
  ["Design", ""], ["Torque", "N m"], ["STE mean", "µm"], ["STE rms", "µm"], ["STE p-p", "µm"], ["k mean", "N/µm"], ["k p-p", "N/µm"],
  ["H_N", "µm"], ["H_Z2", "µm"], ["Max pressure", "MPa"], ["Driven mass", "kg"], ["Removed", "%"],
];

/** What is shown beside, where any design tells it. */
const STRESSES = [["Stress at a root", "MPa"], ["at a hole", "MPa"]];

/** The largest stresses of both gears at roots and at holes; nothing where they were not asked for. */
function largest({ stress }) {
  if (!stress) return ["–", "–"];
  const gears = [stress.driving, stress.driven];
  const holes = gears.flatMap(({ hole_mpa: hole }) => (hole === undefined ? [] : [hole]));
  return [fixed(Math.max(...gears.map(({ root_mpa: root }) => root)), 1), holes.length ? fixed(Math.max(...holes), 1) : "–"];
}

/** The table of `designs`; the first is the live one. `onRemove` takes away one that was kept, `onOpen` makes it the live one. */
export function table(designs, { onRemove, onOpen }) {
  const stressed = designs.some(({ results }) => results.curves.some(({ statistics }) => statistics.stress));
  const head = h("tr", {}, ...[...COLUMNS, ...(stressed ? STRESSES : [])].map(([name, unit]) => h("th", { scope: "col" }, name, unit ? h("small", {}, ` ${unit}`) : null)), h("th", { scope: "col" }, h("span", { className: "visually-hidden" }, "Actions")));
  const rows = designs.flatMap((design, i) => design.results.curves.map((curve, j) => row(design, curve, i, j, { onRemove, onOpen, stressed })));
  return h("table", {}, h("caption", { className: "visually-hidden" }, "Statistics over the true period"), h("thead", {}, head), h("tbody", {}, ...rows));
}

function row(design, curve, i, j, { onRemove, onOpen, stressed }) {
  const ste = curve.statistics.transmission_error_um;
  const k = curve.statistics.mesh_stiffness_tangent_n_per_m;
  const order = (pattern) => curve.spectrum?.named.find(({ label }) => pattern.test(label))?.transmission_error_um;
  const pressures = curve.peak_contact_pressure_mpa.filter((value) => value !== null);
  const { driven } = design.results.pair;
  const cells = [
    number(curve.output_torque_n_m, 6), fixed(ste.mean, 3), fixed(ste.rms, 3), fixed(ste.peak_to_peak, 3), fixed(k.mean * 1e-6, 2), fixed(k.peak_to_peak * 1e-6, 2),
    number(order(/^H_N\d?$/), 3), number(order(/^H_Z2?$/), 3), pressures.length ? fixed(Math.max(...pressures), 0) : "–", fixed(driven.mass_kg, 3), fixed(driven.mass_removed_percent, 1),
    ...(stressed ? largest(curve.statistics) : []),
  ];
  const swatch = h("span", { className: "swatch" });
  swatch.style.borderColor = design.color;
  const name = h("th", { scope: "row" }, swatch, design.name, h("small", {}, ` ${design.results.method.replace(/_/g, " ")}${curve.statistics.partial ? ", partial" : ""}`));
  const actions = h("td", { className: "actions" });
  if (i > 0 && j === 0) {
    actions.append(
      h("button", { type: "button", on: { click: () => onOpen(design) }, ariaLabel: `Open ${design.name}` }, "Open"),
      h("button", { type: "button", on: { click: () => onRemove(design) }, ariaLabel: `Remove ${design.name}` }, "×"),
    );
  }
  return h("tr", { className: i === 0 ? "live" : "" }, name, ...cells.map((cell) => h("td", {}, cell)), actions);
}
