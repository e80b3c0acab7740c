// @ts-check
// What a design starts from: an example, a new pair, or a file.

import { byId, h } from "../draw/dom.js";
import { post, ProblemError } from "../state/api.js";

/** @import { Design } from "../state/design.js" */
/** @import { Example, Gear, RexsModel, Submission } from "../state/documents.js" */

export const FIRST_EXAMPLE = "test-case-2";
const NEW_PAIR = "new pair";

/**
 * What no drawing leaves out, and nothing else.
 *
 * @returns {Submission}
 */
export function newPair() {
  /** @type {(tooth_count: number, bore_radius_mm: number) => Gear} */
  const gear = (tooth_count, bore_radius_mm) => ({
    tooth_count,
    module_mm: 2,
    face_width_mm: 20,
    blank: { bore_radius_mm },
  });
  return {
    method: "flexible",
    pair: { center_distance_mm: 75.2, driving: gear(25, 10), driven: gear(50, 16) },
    output_torques_n_m: [100],
  };
}

/**
 * The choice of examples; `given` says that the page began with a design of its own.
 *
 * @param {Design} design
 * @param {Example[]} examples
 * @param {boolean} given
 */
export function setUpStart(design, examples, given) {
  const select = byId("start", HTMLSelectElement);
  const buildable = examples.filter(({ valid }) => valid);
  const chosen = () => buildable.find(({ name }) => name === select.value);
  select.replaceChildren(
    h("option", { value: NEW_PAIR }, "a new pair, all by default"),
    ...buildable.map(({ name }) => h("option", { value: name }, name.replace(/-/g, " "))),
    h("option", { value: "" }, "Your own"),
  );
  const note = () => {
    byId("start-note").textContent =
      select.value === NEW_PAIR
        ? "Only what no drawing leaves out is given; everything else has its default."
        : (chosen()?.description ?? "");
  };
  select.addEventListener("change", () => {
    const submission = select.value === NEW_PAIR ? newPair() : chosen()?.submission;
    note();
    if (submission) design.replace(submission, "start");
  });
  design.onChange((by) => {
    if (by === "start" || by === "kept") return;
    select.value = "";
    note();
  });
  select.value = given ? "" : FIRST_EXAMPLE;
  note();
}

/**
 * The choice of a file.
 *
 * @param {Design} design
 */
export function setUpFiles(design) {
  const input = byId("open-file", HTMLInputElement);
  input.addEventListener("change", async () => {
    const file = input.files?.[0];
    if (file) await openFile(design, file);
    // The same file may be opened again.
    input.value = "";
  });
}

/**
 * Takes the pair of a file: a model of a gearbox, a submission, or what the page itself has saved.
 *
 * @param {Design} design
 * @param {File} file
 */
async function openFile(design, file) {
  const note = byId("start-note");
  try {
    const text = await file.text();
    // What is a model, and of which kind, the service sees by its content.
    const document = text.trimStart().startsWith("{") ? JSON.parse(text) : null;
    if (document && !document.model) {
      design.replace(document.submission ?? document, "open");
      return;
    }
    const model = await post("v1/rexs", file, { headers: { "content-type": "application/octet-stream" } });
    const [submission] = model.submissions;
    const refused = model.refused.map(({ place, detail }) => `${place}: ${detail}`).join(" ");
    if (!submission) throw new ProblemError({ detail: refused || "The model has no pair of external gears." });
    design.replace(submission, "open");
    note.replaceChildren(wordsOf(model));
  } catch (error) {
    if (!(error instanceof ProblemError || error instanceof SyntaxError)) throw error;
    const why =
      error instanceof ProblemError
        ? error.reason
        : `${file.name} is neither a model of a gearbox nor a submission: ${error.message}`;
    note.replaceChildren(h("span", { className: "field-error" }, why));
  }
}

/**
 * What was taken of a model, assumed, and not read.
 *
 * @param {RexsModel} model
 */
function wordsOf({ submissions, not_read, assumed }) {
  const left = not_read.map(({ component, attribute }) => [component, attribute].filter(Boolean).join(" "));
  return [
    ...(submissions.length > 1 ? [`The first of ${submissions.length} pairs.`] : []),
    ...assumed,
    ...(left.length ? [`Not read: ${left.join(", ")}.`] : []),
  ].join(" ");
}
