// @ts-check
// Marks of numbers: where a warning limits what a number says, and is told beside it.

/** @import { TableRow, Warning } from "./documents.js" */

const PEAK_TO_PEAK = "transmission_error_um.peak_to_peak";
const MEAN = "transmission_error_um.mean";
const STIFFNESS = "mesh_stiffness_tangent_n_per_m.mean";
const PRESSURE = "peak_contact_pressure_mpa";
const HOLES = "hole_order_um";
const MESH = "mesh_order_um";
/** The service has no quantity of this: it is named as in the headline. */
const FREQUENCY = "natural-frequency";

/**
 * The warning that sets each mark, and the numbers that it concerns by their names. A marked number is never called
 * better or worse than another one.
 *
 * @type {{ code: string, mark: string, of: string[] }[]}
 */
const MARKS = [
  { code: "few_positions", mark: "few positions", of: [PEAK_TO_PEAK, HOLES, MESH, STIFFNESS] },
  { code: "partial_span", mark: "part of the period", of: [PEAK_TO_PEAK, MEAN, HOLES, MESH] },
  { code: "projection_doubtful", mark: "estimate", of: [PEAK_TO_PEAK, HOLES] },
  { code: "holes_not_seen", mark: "without holes", of: [PEAK_TO_PEAK, MEAN, STIFFNESS, HOLES] },
  { code: "web_outside_plane_model", mark: "estimate", of: [PEAK_TO_PEAK, MEAN, STIFFNESS, HOLES] },
  { code: "tip_corner_contact", mark: "corner", of: [PRESSURE] },
  { code: "pressure_at_kink", mark: "kink", of: [PRESSURE] },
  { code: "contact_beyond_elasticity", mark: "beyond elasticity", of: [PRESSURE] },
  { code: "rim_inertia_on_hub", mark: "estimate", of: [FREQUENCY] },
  { code: "motion_unbounded", mark: "no damping", of: [FREQUENCY] },
];

/**
 * The mark of the number of this name among the warnings of its design, with the sentence of the warning; undefined
 * where none limits it.
 *
 * @type {(name: string, warnings: Pick<Warning, "code" | "detail">[]) => { word: string, detail: string } | undefined}
 */
export function markOf(name, warnings) {
  for (const { code, mark: word, of } of MARKS) {
    const warning = of.includes(name) && warnings.find((each) => each.code === code);
    if (warning) return { word, detail: warning.detail };
  }
  return undefined;
}

/** The mark of every number of a row that a version before 0.6 computed. */
const UNKNOWN = {
  word: "warnings not known",
  detail: "An older version of the service computed this design, and tables did not tell warnings then.",
};

/**
 * The mark of the number of this name in a row of the table of a study, which tells the codes of its warnings alone.
 *
 * @type {(name: string, row: Pick<TableRow, "warnings">) => { word: string, detail: string } | undefined}
 */
export function markInRow(name, { warnings }) {
  if (!warnings) return MARKS.some(({ of }) => of.includes(name)) ? UNKNOWN : undefined;
  const detail = "The design has a warning about this number: open it to read the sentence.";
  return markOf(
    name,
    warnings.map((code) => ({ code, detail })),
  );
}
