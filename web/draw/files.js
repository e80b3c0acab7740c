// @ts-check
// The files that the service makes of a job.

import { save, saveTable } from "./download.js";
import { made } from "../state/api.js";
import { isSolid } from "../state/dimensions.js";

/** @import { Submission } from "../state/documents.js" */

/** @type {(submission: Submission) => unknown} */
const hasHolesInBoth = ({ method, pair: { driving, driven } }) =>
  !isSolid(method) && driving.blank.holes && driven.blank.holes;
/** @type {(submission: Submission) => boolean} */
const isInThree = ({ method }) => isSolid(method);
/** @type {(submission: Submission) => unknown} */
const runsUp = ({ dynamics }) => dynamics;
/** @type {(submission: Submission) => unknown} */
const hasForces = ({ dynamics, force_table: table }) => dynamics || table;
/** @type {(submission: Submission) => unknown} */
const hasModes = ({ modes }) => modes;

/**
 * The name of each file, what it is called on the page, and what its submission asks for, if not every job has it.
 *
 * @type {[name: string, title: string, asks?: (submission: Submission) => unknown][]}
 */
const FILES = [
  ["submission.rexs", "Pair for a gearbox program, REXS"],
  ["look-up-table.csv", "Look-up table, CSV"],
  ["look-up-table.txt", "Look-up table, Modelica text"],
  ["fields.vtu", "Stress and displacement, VTU"],
  ["hole-phase.svg", "Phase of the holes, SVG", hasHolesInBoth],
  ["contact-pattern.json", "Contact pattern, JSON", isInThree],
  ["contact-pattern.svg", "Contact pattern, SVG", isInThree],
  ["face-load.csv", "Load along the face, CSV", isInThree],
  ["face-load.svg", "Load along the face, SVG", isInThree],
  ["run-up.csv", "Run-up, CSV", runsUp],
  ["run-up.svg", "Run-up, SVG", runsUp],
  ["campbell.csv", "Natural modes and speeds, CSV", hasModes],
  ["campbell.svg", "Campbell diagram, SVG", hasModes],
  ["modes/1.vtu", "Lowest mode of the driving gear, VTU", hasModes],
  ...[
    ["csv", "CSV"],
    ["txt", "CombiTable2D"],
    ["mo", "Modelica"],
    ["fmu", "FMU"],
  ].map(
    ([kind, name]) =>
      /** @type {[string, string, typeof hasForces]} */ ([`force-table.${kind}`, `Force table, ${name}`, hasForces]),
  ),
];

/**
 * Names and titles of the files of a job of `submission`.
 *
 * @type {(submission: Submission) => { name: string, title: string }[]}
 */
export const filesOf = (submission) =>
  FILES.filter(([, , asks]) => !asks || asks(submission)).map(([name, title]) => ({ name, title }));

/**
 * Saves the file `name` of the job `id`, with `prefix` before its name, which ends with a hyphen, as it is asked for by
 * `query`; `signal` gives it up.
 *
 * @type {(id: string, name: string, prefix: string, query?: string, signal?: AbortSignal) => Promise<void>}
 */
export async function saveFile(id, name, prefix, query = "", signal = undefined) {
  const place = name === "submission.rexs" ? name : `results${name === "results.json" ? "" : `/${name}`}`;
  const answer = await made(`v1/jobs/${id}/${place}${query}`, { signal });
  const saved = `${prefix}${name.replace("/", "-")}`;
  if (name.endsWith(".csv")) saveTable(saved, await answer.text());
  else save(saved, "", await answer.blob());
}
