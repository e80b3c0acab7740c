// @ts-check
// The geometry report: what a gear engineer checks first, of both gears.

/**
 * A row: its name, symbol and unit, and one value or that of each gear.
 *
 * @typedef {[name: string, symbol: string, unit: string, ...values: string[]]} Row
 */

import { button, h, note, table } from "../draw/dom.js";
import { MEMBERS } from "../state/design.js";
import { fixed, number } from "../state/numbers.js";

/** @import { Gear, NamedDesign, Pair, Results } from "../state/documents.js" */

/** @type {(radius: number) => number} */
const twice = (radius) => 2 * radius;

/**
 * Rows of the table of gears: what it is called, its symbol and unit, and how it is read from a gear's geometry and
 * document.
 *
 * @type {[name: string, symbol: string, unit: string, read: (geometry: Results["pair"]["driving"], gear: Gear) =>
 *   string][]}
 */
export const OF_GEARS = [
  ["Teeth", "z", "", (_, gear) => String(gear.tooth_count)],
  ["Module, normal", "m_n", "mm", (_, gear) => number(gear.module_mm, 5)],
  ["Profile shift", "x", "", (_, gear) => number(gear.profile_shift ?? 0, 5)],
  ["Generating profile shift", "x_E", "", (it) => fixed(it.generating_profile_shift, 4)],
  ["Face width", "b", "mm", (_, gear) => number(gear.face_width_mm, 6)],
  ["Reference diameter", "d", "mm", (it) => fixed(twice(it.reference_radius_mm), 3)],
  ["Base diameter", "d_b", "mm", (it) => fixed(twice(it.base_radius_mm), 3)],
  ["Tip diameter", "d_a", "mm", (it) => fixed(twice(it.tip_radius_mm), 3)],
  ["Tip form diameter", "d_Fa", "mm", (it) => fixed(twice(it.tip_form_radius_mm), 3)],
  ["Working pitch diameter", "d_w", "mm", (it) => fixed(it.working_pitch_diameter_mm, 3)],
  ["Active root diameter", "d_Nf", "mm", (it) => fixed(it.active_root_diameter_mm, 3)],
  ["Root form diameter", "d_Ff", "mm", (it) => fixed(it.form_diameter_mm, 3)],
  ["Root diameter", "d_f", "mm", (it) => fixed(twice(it.root_radius_mm), 3)],
  ["Tip thickness", "s_an", "mm", (it) => fixed(it.tip_thickness_mm, 3)],
  ["Tip thickness, transverse", "s_at", "mm", (it) => fixed(it.tip_thickness_transverse_mm, 3)],
  ["Tip clearance", "c", "mm", (it) => fixed(it.tip_clearance_mm, 3)],
  ["Specific sliding at A", "ζ_A", "", (it) => fixed(it.specific_sliding_a, 3)],
  ["Specific sliding at E", "ζ_E", "", (it) => fixed(it.specific_sliding_e, 3)],
  ["Relief starts at diameter", "", "mm", (it) => fixed(twice(it.relief_start_radius_mm ?? NaN), 3)],
  ["Least material around holes", "", "mm", (it) => fixed(it.least_ligament_mm, 2)],
  ["Mass", "m", "kg", (it) => fixed(it.mass_kg, 4)],
  ["Removed by holes", "", "%", (it) => fixed(it.mass_removed_percent, 1)],
  ["Polar inertia", "J", "kg cm²", (it) => number(1e4 * it.polar_inertia_kg_m2, 5)],
  ["Imbalance", "", "kg mm", (it) => number(it.imbalance_kg_mm, 3)],
  ["Alike again after", "", "mesh periods", (it) => String(it.period_mesh_periods)],
];

/**
 * Rows of the table of the pair.
 *
 * @type {[name: string, symbol: string, unit: string, read: (geometry: Results["pair"], pair: Pair) => string][]}
 */
export const OF_PAIRS = [
  ["Center distance", "a", "mm", (it) => number(it.center_distance_mm, 8)],
  ["Helix angle", "β", "°", (_, { helix_angle_deg: angle }) => (angle ? number(angle, 6) : "–")],
  ["Working pressure angle", "α_w", "°", (it) => fixed(it.working_pressure_angle_deg, 4)],
  ["Contact ratio", "ε_α", "", (it) => fixed(it.contact_ratio, 4)],
  ["Length of the path of contact", "g_α", "mm", (it) => fixed(it.path_of_contact.length_mm, 4)],
  ["Overlap ratio", "ε_β", "", (it) => fixed(it.overlap_ratio, 4)],
  ["Total contact ratio", "ε_γ", "", (it) => fixed(it.total_contact_ratio, 4)],
  ["Base helix angle", "β_b", "°", (it) => fixed(it.helix_angle_base_deg, 4)],
  ["Transverse module", "m_t", "mm", (it) => fixed(it.transverse_module_mm, 4)],
  ["Transverse pressure angle", "α_t", "°", (it) => fixed(it.transverse_pressure_angle_deg, 4)],
  ["Base pitch", "p_b", "mm", (it) => fixed(it.base_pitch_mm, 4)],
  ["Normal backlash", "j_bn", "mm", (it) => fixed(it.backlash_mm, 4)],
  ["Circumferential backlash (working pitch circle)", "j_wt", "mm", (it) => fixed(it.backlash_transverse_mm, 4)],
  ["Backlash along the line of action", "", "mm", (it) => fixed(it.backlash_line_of_action_mm, 4)],
  ["Least normal backlash", "", "mm", (it) => fixed(it.least_backlash_mm, 4)],
  ["Common face width", "", "mm", (it) => number(it.contact_width_mm, 6)],
  ["True period", "", "mesh periods", (it) => String(it.period_mesh_periods)],
];

/**
 * Every row of the report: `[name, symbol, unit, driving, driven]`, the pair's with one value.
 *
 * @type {(design: NamedDesign) => { gears: Row[], both: Row[] }}
 */
export function rowsOf({ results, submission }) {
  const { pair } = results;
  const ofGears = OF_GEARS.map(([name, symbol, unit, read]) => {
    const values = MEMBERS.map((member) => read(pair[member], submission.pair[member]));
    return /** @type {Row} */ ([name, symbol, unit, ...values]);
  });
  const gears = ofGears.filter(([, , , ...values]) => values.some((value) => value !== "–"));
  // What only some gears or pairs have is left out of the others.
  const both = OF_PAIRS.map(
    ([name, symbol, unit, read]) => /** @type {Row} */ ([name, symbol, unit, read(pair, submission.pair)]),
  ).filter(([, , , value]) => value !== "–");
  return { gears, both };
}

/** The report of the live design in `place`; `onPrint`, `onReport` and `onPicture` are what its buttons do. */
export class Geometry {
  /**
   * @param {HTMLElement} place
   * @param {{ onPrint: () => void, onReport: () => void, onPicture: (kind: "svg" | "png") => void }} hearers
   */
  constructor(place, { onPrint, onReport, onPicture }) {
    this.out = h("div", { className: "columns" });
    place.append(
      note(
        "Computed from the true profile, without load. Specific sliding is the sliding velocity over the velocity at which the contact runs along a flank.",
      ),
      this.out,
      h(
        "div",
        { className: "buttons wrap" },
        button("Print one page, or save it as PDF", onPrint),
        button("Report of the project, on paper or as PDF", onReport),
        button("Page as SVG", () => onPicture("svg")),
        button("Page as PNG", () => onPicture("png")),
      ),
    );
  }

  /** @param {NamedDesign} live */
  show(live) {
    const { gears, both } = rowsOf(live);
    /** @type {(text: string) => HTMLElement} */
    const symbol = (text) => h("small", {}, ` ${text}`);
    /** @type {(list: Row[]) => HTMLTableRowElement[]} */
    const rows = (list) =>
      list.map(([name, mark, unit, ...values]) =>
        h(
          "tr",
          {},
          h("th", { scope: "row" }, name, mark ? symbol(mark) : null),
          ...values.map((value) => h("td", {}, value)),
          h("td", { className: "unit" }, unit),
        ),
      );
    this.out.replaceChildren(
      table(["Quantity", "Driving", "Driven", "Unit"], rows(gears), "Gears"),
      table(["Quantity", "Value", "Unit"], rows(both), "Pair"),
    );
  }
}
