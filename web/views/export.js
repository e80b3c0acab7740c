// @ts-check
// What is on the screen for other programs: curves, orders, tables, pictures, files of a job, and the request as a
// program.

import { looks } from "../draw/looks.js";
import { button, h, inLine, labelled, note } from "../draw/dom.js";
import { chooseCommas, copied, drawingOf, hasCommas, save, saveTable } from "../draw/download.js";
import { captioned, fileOf, pictureOf, stacked } from "../draw/figure.js";
import { filesOf, saveFile } from "../draw/files.js";
import { isAborted, ProblemError, request, solved } from "../state/api.js";
import { number } from "../state/numbers.js";
import { snippets } from "../state/snippets.js";
import { csv, fileOfDesign, ordersCsv } from "../state/tables.js";
import { begin, tellsOf } from "../state/work.js";
import { designsCsv } from "./compare.js";
import { inLight } from "./sheet.js";

/** @import { Charts } from "../draw/charts.js" */
/** @import { Drawing } from "../draw/drawing.js" */
/** @import { NamedDesign } from "../state/documents.js" */

/**
 * @typedef {object} Sources
 * @property {() => Promise<NamedDesign | null>} current
 * @property {() => NamedDesign[]} designs
 * @property {Drawing} drawing
 * @property {Charts} charts
 * @property {() => number} position
 * @property {(live: NamedDesign) => SVGSVGElement} sheet
 */

/** @type {Record<keyof ReturnType<typeof snippets>, string>} */
const LANGUAGES = { curl: "curl", python: "Python", typescript: "TypeScript" };

/**
 * What a picture of a design says of it: its name, torques and method, and the version that computed it.
 *
 * @type {(live: NamedDesign) => string}
 */
const saidOf = ({ name, results: { curves, method, evidence } }) =>
  [
    name,
    `${curves.map(({ output_torque_n_m: torque }) => number(torque, 6)).join(", ")} N m`,
    method.replace(/_/g, " "),
    evidence.solver_version.replace(/^m/, "M"),
  ].join(", ");

/**
 * The exports in `place`. `current` waits for the live design and gives it, or null where it cannot be computed;
 * `designs` gives all that are shown, and `sheet` the page of one.
 *
 * @param {HTMLElement} place
 * @param {Sources} sources
 */
export function exporting(place, { current, designs, drawing, charts, position, sheet }) {
  const state = h("p", { className: "note", role: "status" });
  /** @type {Record<string, [name: string, work: (live: NamedDesign) => unknown]>} */
  const kinds = {
    json: [
      "Submission and results, JSON",
      (live) =>
        save(
          called(live, "results.json"),
          "application/json",
          JSON.stringify({ submission: live.asked, results: live.results }, null, 1),
        ),
    ],
    csv: ["Curves, CSV", (live) => saveTable(called(live, "curves.csv"), csv(live.results))],
    orders: ["Orders, CSV", (live) => saveTable(called(live, "orders.csv"), ordersCsv(live.results))],
    designs: ["Designs, CSV", (live) => saveTable(called(live, "designs.csv"), designsCsv(designs()))],
    svg: ["Curves, SVG", (live) => save(called(live, "curves.svg"), "image/svg+xml", fileOf(curves(live)))],
    png: ["Curves, PNG", async (live) => save(called(live, "curves.png"), "image/png", await pictureOf(curves(live)))],
    pair: ["Drawing, SVG", (live) => save(called(live, "pair.svg"), "image/svg+xml", fileOf(pair(live)))],
    page: ["Report page, SVG", (live) => save(called(live, "report.svg"), "image/svg+xml", fileOf(sheet(live)))],
  };
  const buttons = Object.entries(kinds).map(([kind, [name, work]]) =>
    button(name, () => run(work), { data: { download: kind } }),
  );
  const ofJob = h("div", { className: "buttons wrap" });
  const commas = h("input", {
    type: "checkbox",
    id: "decimal-commas",
    checked: hasCommas(),
    on: { change: ({ target }) => chooseCommas(target.checked) },
  });
  const code = h("pre", { id: "code", tabIndex: 0, ariaLabel: "Program" });
  const language = h(
    "select",
    { id: "language", on: { change: () => void show() } },
    ...Object.entries(LANGUAGES).map(([value, name]) => h("option", { value }, name)),
  );
  const copy = button("Copy it", async () => {
    state.textContent = (await copied(code.textContent ?? ""))
      ? "The program is copied."
      : "Copying is not allowed here: select the text.";
  });
  place.replaceChildren(
    note("Everything is of one design: the one that is drawn, with the curves and numbers that are shown."),
    h("div", { className: "buttons wrap" }, ...buttons),
    inLine(h("label", {}, commas, " CSV with semicolons and decimal commas, here and in other tabs")),
    h("h3", {}, "Files that a job makes"),
    ofJob,
    state,
    h("h3", {}, "This as a program"),
    inLine(...labelled("Language", language), copy),
    code,
  );

  /** @type {(design: NamedDesign, rest: string) => string} */
  const called = ({ name }, rest) => fileOfDesign(name, rest);
  /** @type {(live: NamedDesign) => SVGSVGElement} */
  const curves = (live) =>
    inLight(() => captioned(stacked(charts.figures(), looks().panel), saidOf(live), looks().panel));
  /** @type {(live: NamedDesign) => SVGSVGElement} */
  const pair = (live) => inLight(() => captioned(drawingOf(drawing.element), saidOf(live), looks().panel));

  /** @type {(work: (live: NamedDesign) => unknown) => Promise<void>} */
  async function run(work) {
    state.textContent = "";
    try {
      const live = await current();
      if (!live) {
        state.textContent = "This design cannot be computed, so nothing is exported: mend what is wrong, or go back.";
        return;
      }
      await work(live);
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      state.textContent = error.reason;
    }
  }

  /** @type {(live: NamedDesign, file: string) => Promise<void>} */
  async function fileOfJob(live, file) {
    state.textContent = "A job computes it.";
    const asking = new AbortController();
    const { signal } = asking;
    /** @type {string | null} */
    let job = null;
    const work = begin(`${live.name}, ${file}`, () => asking.abort());
    const hear = tellsOf(work);
    /** @type {(event: string, data: any) => void} */
    const told = (event, data) => {
      job = data.id ?? job;
      hear(event, data);
    };
    try {
      const { id } = await solved(live.asked, { told, signal });
      const query = file === "fields.vtu" ? `?mesh_position=${position().toFixed(4)}` : "";
      await saveFile(id, file, called(live, ""), query, signal);
      state.textContent = "";
    } catch (error) {
      if (!isAborted(error)) throw error;
      // A job that has ended is not cancelled any more.
      if (job) request(`v1/jobs/${job}/cancel`, { method: "POST" }).catch(() => {});
      state.textContent = "Stopped.";
    } finally {
      work.end();
    }
  }

  async function show() {
    const live = await current();
    const files = live ? filesOf(live.asked) : [];
    // The same buttons stay, with whoever stands on one.
    if (
      files.map(({ name }) => name).join() !==
      [...ofJob.querySelectorAll("button")].map((each) => each.dataset.download).join()
    ) {
      ofJob.replaceChildren(
        ...files.map(({ name, title }) =>
          button(title, () => run((live) => fileOfJob(live, name)), { data: { download: name } }),
        ),
      );
    }
    if (live)
      code.textContent =
        Object.entries(snippets(live.asked, new URL(".", document.baseURI).href)).find(
          ([name]) => name === language.value,
        )?.[1] ?? "";
  }

  return { refresh: show };
}
