// @ts-check
// The dialog for a report or a table that is pasted: what is understood of it, what is not, and a button that fills the
// form.

import { button, byId, debounced, h, inLine, labelled, note, region, table, tableRow } from "../draw/dom.js";
import { MEMBERS, withValue } from "../state/design.js";
import { materialIn } from "../state/materials.js";
import { read, valuesOfPasted } from "../state/pasted.js";
import { newPair } from "./start.js";

/** @import { Design } from "../state/design.js" */
/** @import { Submission } from "../state/documents.js" */
/** @import { Pasted } from "../state/pasted.js" */

const REST = 150;
/** The number of lines that are shown of those that are not understood. */
const LINES = 40;
/** The bore of a new pair whose text gives none, as a part of the reference radius. */
const BORE = 0.5;

/**
 * The dialog of pasted texts, which changes `design`.
 *
 * @param {Design} design
 */
export function setUpPaste(design) {
  const dialog = byId("paste-dialog", HTMLDialogElement);
  const text = h("textarea", {
    id: "paste-text",
    rows: 8,
    spellcheck: false,
    on: { input: debounced(REST, () => show()) },
  });
  const decimal = h(
    "select",
    { id: "paste-decimal", on: { change: () => show() } },
    h("option", { value: "" }, "as the text has it"),
    h("option", { value: "." }, "point"),
    h("option", { value: "," }, "comma"),
  );
  const anew = h("input", { type: "checkbox", id: "paste-anew", checked: true });
  const said = h("p", { className: "note", role: "status" });
  const found = h("div", {});
  const fill = button("Fill the form", () => take(), { className: "primary", id: "paste-fill", disabled: true });
  dialog.append(
    h("h2", { id: "paste-title" }, "Paste a report or a table"),
    note(
      "Lines with a name or a symbol in German or English, and a value for each gear or for the pair: the text of a report, columns of a spreadsheet. The first column is the driving gear unless a heading says otherwise.",
    ),
    h("label", { htmlFor: text.id }, "Text"),
    text,
    inLine(
      ...labelled("Decimals after a", decimal),
      anew,
      h("label", { htmlFor: anew.id }, "Begin with a new pair: what the text does not give has its default"),
    ),
    said,
    found,
    inLine(
      fill,
      button("Cancel", () => dialog.close()),
    ),
  );
  byId("paste-button").addEventListener("click", () => {
    show();
    dialog.showModal();
    text.focus();
  });

  /** @returns {Pasted} */
  const pasted = () => read(text.value, decimal.value === "." || decimal.value === "," ? decimal.value : null);

  function show() {
    const { taken, left, decimal: sign } = pasted();
    fill.disabled = taken.length === 0;
    said.textContent = text.value.trim()
      ? `${taken.length} fields are understood, with decimals after a ${sign === "," ? "comma" : "point"}; ${left.length} lines are not.`
      : "";
    const rows = taken.map(({ title, values: [one, other = one], line }) =>
      tableRow(
        title,
        ...[one, other].map((value) => (Number.isNaN(value) ? "–" : String(value))),
        h("small", {}, line),
      ),
    );
    found.replaceChildren(
      ...(rows.length ? [region("Understood", table(["Understood", "Driving", "Driven", "Of the line"], rows))] : []),
      ...(left.length
        ? [
            h(
              "details",
              { open: rows.length === 0 },
              h("summary", {}, `Not understood: ${left.length} lines`),
              h("ul", {}, ...left.slice(0, LINES).map((line) => h("li", {}, line))),
            ),
          ]
        : []),
    );
  }

  function take() {
    const base = anew.checked ? newPair() : design.submission;
    /** @type {Submission} */
    let next = base;
    const values = valuesOfPasted(pasted(), base, materialIn);
    for (const [pointer, value] of Object.entries(values)) next = withValue(next, pointer, value);
    if (anew.checked)
      for (const gear of MEMBERS) {
        const pointer = `/pair/${gear}/blank/bore_radius_mm`;
        const { module_mm: module, tooth_count: teeth } = next.pair[gear];
        if (!(pointer in values)) next = withValue(next, pointer, Number(((BORE * module * teeth) / 2).toPrecision(2)));
      }
    dialog.close();
    design.replace(next, "open");
  }
}
