// Many designs at once: axes of values, a table, and which of them no other beats.

import { json, post, ProblemError, request } from "./api.js";
import { h, fixed, number } from "./dom.js";
import { at, nameOf, withValue } from "./design.js";
import { save } from "./download.js";
import { scatter } from "./scatter.js";

const PAUSE = 400;
const FIELDS = [
  ["/pair/driven/blank/holes/count", "Holes, driven gear", "6, 8, 10"],
  ["/pair/driven/blank/holes/circle_radius_mm", "Hole circle, driven gear (mm)", "30, 32, 34"],
  ["/pair/driven/blank/holes/radius_mm", "Hole radius, driven gear (mm)", "5, 6, 7"],
  ["/pair/driven/blank/holes/phase_deg", "Hole phase, driven gear (deg)", "0, 9, 18"],
  ["/pair/driving/blank/holes/count", "Holes, driving gear", "6, 8, 10"],
  ["/pair/driving/blank/holes/circle_radius_mm", "Hole circle, driving gear (mm)", "30, 32, 34"],
  ["/pair/driving/tip_relief/amount_um", "Tip relief, driving gear (µm)", "0, 5, 10, 15"],
  ["/pair/driven/tip_relief/amount_um", "Tip relief, driven gear (µm)", "0, 5, 10, 15"],
  ["/pair/center_distance_mm", "Center distance (mm)", ""],
  ["/method", "Method", "flexible, decomposition"],
];

/** The study of `design` in `place`. */
export function study(place, design) {
  const axes = [axis(0), axis(1)];
  const constant = h("input", { type: "checkbox", id: "study-mass" });
  const removed = h("input", { type: "number", id: "study-removed", value: 25, min: 0.01, max: 99, step: "any", ariaLabel: "Mass removed in percent" });
  const run = h("button", { type: "submit", className: "primary" }, "Run the study");
  const cancel = h("button", { type: "button", hidden: true }, "Cancel");
  const out = h("div", { className: "out" });
  const state = h("p", { className: "note", role: "status" });
  const form = h("form", { on: { submit: (event) => { event.preventDefault(); start(); } } },
    ...axes.map((each) => each.element),
    h("div", { className: "line" }, constant, h("label", { htmlFor: "study-mass" }, "Same mass: holes remove"), removed, h("span", { className: "unit" }, "% of the driven blank")),
    h("div", { className: "line" }, run, cancel));
  place.replaceChildren(h("p", { className: "note" }, "Every combination of these values is computed from the pair above."), form, state, out);
  axes[0].choose(FIELDS[0][0]);

  async function start() {
    run.disabled = true;
    out.replaceChildren();
    try {
      const asked = { base: base(), axes: axes.flatMap((each) => each.read()), name: nameOf(design.submission) };
      if (constant.checked) asked.constant_mass = { gear: "driven", mass_removed_percent: Number(removed.value) };
      await follow(await post("v1/studies", asked));
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      const details = error.problem.errors?.map(({ detail }) => detail) ?? [error.message];
      state.replaceChildren(...details.map((detail) => h("span", { className: "field-error" }, detail, " ")));
    } finally {
      run.disabled = false;
      cancel.hidden = true;
    }
  }

  /** The design, with holes to begin with where an axis changes holes that it lacks. */
  function base() {
    const touched = axes.flatMap((each) => each.read()).map(({ path }) => /^(\/pair\/\w+\/blank\/holes)\//.exec(path)?.[1]).filter(Boolean);
    let submission = design.submission;
    for (const pointer of touched) {
      if (at(submission, pointer)) continue;
      const bore = at(submission, pointer.replace(/holes$/, "bore_radius_mm"));
      submission = withValue(submission, pointer, { count: 6, circle_radius_mm: 2 * bore, radius_mm: bore / 3 });
    }
    return submission;
  }

  async function follow(made) {
    const address = `v1/studies/${made.id}`;
    cancel.hidden = false;
    cancel.onclick = () => request(`${address}/cancel`, { method: "POST" }).catch(() => {});
    for (;;) {
      const results = await json(`${address}/results`);
      state.textContent = `${results.done} of ${results.total} designs${results.status === "running" || results.status === "accepted" ? "" : `, ${results.status}`}`;
      out.replaceChildren(...shown(results, address));
      if (!["accepted", "running"].includes(results.status)) return;
      await new Promise((resolve) => setTimeout(resolve, PAUSE));
    }
  }

  function shown(results, address) {
    const rows = results.rows.filter((row) => row.curves?.length && row.curves[0].statistics);
    const worst = (row) => Math.max(...row.curves.map((curve) => curve.statistics.transmission_error_um.peak_to_peak));
    const points = rows.map((row) => ({ x: row.pair_mass_kg, y: worst(row), label: row.label, strong: row.pareto }));
    const picture = points.length > 1 ? [scatter({ points, x: "mass of both gears in kg", y: "largest STE peak-to-peak in µm", title: "Designs by mass and peak-to-peak transmission error" })] : [];
    const csv = h("button", { type: "button", on: { click: async () => save("study.csv", "text/csv", await (await request(`${address}/results/table.csv`)).blob()) } }, "Table as CSV");
    return [...picture, h("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: "Designs of the study" }, tableOf(results.rows)), h("div", { className: "buttons" }, csv)];
  }

  function tableOf(rows) {
    const names = ["Design", "Best", "Mass kg", "Removed %", "Ligament mm", "Torque N m", "STE p-p µm", "k mean N/µm", "H_N µm", "H_Z2 µm", ""];
    const head = h("tr", {}, ...names.map((name) => h("th", { scope: "col" }, name || h("span", { className: "visually-hidden" }, "Actions"))));
    return h("table", {}, h("thead", {}, head), h("tbody", {}, ...rows.flatMap(rowsOf)));
  }

  function rowsOf(row) {
    const lead = [h("th", { scope: "row" }, row.label), h("td", {}, row.pareto ? h("strong", { title: "No other design is at least as good in mass, peak-to-peak and stiffness, and better in one" }, "yes") : "")];
    if (!row.curves?.length) return [h("tr", {}, ...lead, h("td", { colSpan: 9 }, row.problem ? (row.problem.errors?.[0]?.detail ?? row.problem.detail) : row.status))];
    const open = h("button", { type: "button", on: { click: () => openRow(row) }, ariaLabel: `Open ${row.label}` }, "Open");
    return row.curves.map((curve, i) => {
      const statistics = curve.statistics;
      const cells = [fixed(row.mass_kg, 3), fixed(row.mass_removed_percent, 1), fixed(row.least_ligament_mm, 2), number(curve.output_torque_n_m), fixed(statistics?.transmission_error_um.peak_to_peak, 3), fixed(statistics && statistics.mesh_stiffness_tangent_n_per_m.mean * 1e-6, 2), number(curve.hole_order_um, 3), number(curve.mesh_order_um, 3)];
      return h("tr", { className: row.pareto ? "strong" : "" }, ...(i ? [h("th", { scope: "row" }, row.label), h("td")] : lead), ...cells.map((cell) => h("td", {}, cell)), h("td", {}, i ? "" : open));
    });
  }

  async function openRow(row) {
    const job = await json(`v1/jobs/${row.job}`);
    design.replace(job.submission, "open");
  }
}

function axis(index) {
  const id = `axis-${index}`;
  const values = h("input", { type: "text", id: `${id}-values`, ariaLabel: `Values of axis ${index + 1}`, spellcheck: false });
  const field = h("select", { id, on: { change: () => { values.value = FIELDS.find(([path]) => path === field.value)?.[2] ?? ""; } } },
    h("option", { value: "" }, "none"), ...FIELDS.map(([path, name]) => h("option", { value: path }, name)));
  const element = h("div", { className: "line" }, h("label", { htmlFor: id }, index ? "and" : "Vary"), field, h("label", { htmlFor: values.id }, "over"), values);
  const read = () => (field.value && values.value.trim() ? [{ path: field.value, values: values.value.split(/[\s,;]+/).filter(Boolean).map((word) => (Number.isNaN(Number(word)) ? word : Number(word))) }] : []);
  const choose = (path) => {
    field.value = path;
    field.dispatchEvent(new Event("change"));
  };
  return { element, read, choose };
}
