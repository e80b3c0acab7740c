// @ts-check
// Many designs at once: axes of values over any fields, a table, a picture of two of its columns, and which designs no
// other beats; or a search that chooses the values itself.

import { asking, button, h, inLine, labelled, note, region, table, unseen, within } from "../draw/dom.js";
import { saveTable } from "../draw/download.js";
import { figure } from "../draw/figure.js";
import { allGiven, given, numeric, put } from "../draw/inputs.js";
import { offer, options } from "./offer.js";
import { Question } from "./question.js";
import { search } from "./search.js";
import { json, request } from "../state/api.js";
import { at, nameOf, withValue } from "../state/design.js";
import { number } from "../state/numbers.js";
import { calledOf, inRow, inUnit, inWords, quantityOf, shown, worstInRow } from "../state/quantities.js";
import { usualAt } from "../state/schema.js";
import { fileOfDesign } from "../state/tables.js";

/** @import { Watching } from "./question.js" */
/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, Open, RowCurve, StudyResults, TableRow } from "../state/documents.js" */
/** @import { Quantity } from "../state/quantities.js" */
/** @import { Form } from "../views/form.js" */

/** A table is fetched so often at most while a study runs, in milliseconds. */
const PAUSE = 400;

/** What the picture shows first, over what. */
const [ACROSS, UP] = ["pair_mass_kg", "transmission_error_um.peak_to_peak"];
/** The columns of the table before the torque, of the gear of the study where they are of one, and behind it. */
const OF_ROW = ["pair_mass_kg", "mass_removed_percent", "least_ligament_mm"];
const OF_CURVE = [UP, "mesh_stiffness_tangent_n_per_m.mean", "hole_order_um", "mesh_order_um"];

const TORQUE = "/output_torques_n_m";
/** With which field the first axis begins until somebody chooses another one, and the values of such a field. */
const [COUNT, COUNTS] = [/^\/pair\/driven\/blank\/holes\/(0\/)?count$/, "6, 8, 10"];

/** The parts of gears that a design may lack and an axis may change all the same, and their fields. */
const PART = /^(\/pair\/\w+\/(?:blank\/holes|blank\/web|tip_relief))\//;
/** @type {string[]} */
const LACKING = ["driving", "driven"].flatMap((gear) =>
  [
    "tip_relief/amount_um",
    "blank/holes/count",
    "blank/holes/circle_radius_mm",
    "blank/holes/radius_mm",
    "blank/web/thickness_mm",
    "blank/web/inner_radius_mm",
    "blank/web/outer_radius_mm",
  ].map((name) => `/pair/${gear}/${name}`),
);

/**
 * The study of `design` in `place`; `form` knows the fields, `onOpen` opens the design of a row.
 *
 * @param {HTMLElement} place
 * @param {Design} design
 * @param {Form} form
 * @param {Open} onOpen
 */
export function study(place, design, form, onOpen) {
  const axes = [axis(0, design, form), axis(1, design, form)];
  const constant = h("input", { type: "checkbox", id: "study-mass" });
  const gear = h(
    "select",
    { id: "study-gear", ariaLabel: "Gear of the same mass" },
    h("option", { value: "driven" }, "driven"),
    h("option", { value: "driving" }, "driving"),
  );
  const removed = numeric({ id: "study-removed", value: 25, ariaLabel: "Mass removed in percent" });
  const question = new Question(design, {
    id: "study",
    words: "Run the study",
    inWords: (detail) => form.inWords(detail),
  });
  const [across, up] = [ACROSS, UP].map((chosen, i) =>
    h("select", { id: `study-${i ? "up" : "across"}`, on: { change: () => last && draw(last) } }, ...options(chosen)),
  );
  const picture = h("div", {});
  const picker = h(
    "div",
    { className: "line", hidden: true },
    ...labelled("Picture:", up),
    ...labelled("over", across),
  );
  const out = h("div", { className: "out" });
  const searched = h("div", {});
  const formOf = asking(
    start,
    ...axes.map((each) => each.element),
    inLine(
      constant,
      h("label", { htmlFor: "study-mass" }, "Same mass: holes remove"),
      removed,
      h("span", { className: "unit" }, "% of the"),
      gear,
      h("span", {}, "blank, all equally wide"),
    ),
    inLine(question.run, question.cancel),
  );
  place.replaceChildren(
    note(
      "Every combination of these values is computed from the design; values stand apart by spaces. “Best” is a design that no other beats: none is at least as good in mass, peak-to-peak and mean stiffness, and better in one.",
    ),
    formOf,
    question.state,
    question.of.element,
    picker,
    picture,
    out,
    h("details", { id: "search" }, h("summary", {}, "Let a search choose the values"), searched),
  );
  const seeker = search(searched, design, form, onOpen);
  /** @type {StudyResults | null} */
  let last = null;
  /** The name of the study. */
  let called = "";

  /** @type {Watching<StudyResults>} */
  const how = {
    part: "/results",
    pause: PAUSE,
    show,
    progress: (done, total, left) => `${done} of ${total} designs${left(done, total)}`,
    ended: ({ done, total, status }) => `${done} of ${total} designs, ${status}`,
  };

  function clear() {
    last = null;
    picture.replaceChildren();
    out.replaceChildren();
  }

  function start() {
    clear();
    return question.study(() => {
      /** @type {AskedStudy} */
      const asked = { base: base(), axes: axes.flatMap((each) => each.read()), name: nameOf(design.submission) };
      if (constant.checked) {
        // What is missing the service says.
        const mass_removed_percent = /** @type {number} */ (given(removed));
        asked.constant_mass = { gear: gear.value === "driving" ? "driving" : "driven", mass_removed_percent };
      }
      called = asked.name ?? "";
      return asked;
    }, how);
  }

  /**
   * Shows a study, or the search, that was asked for before.
   *
   * @param {string} id
   * @param {AskedStudy} asked
   */
  function resume(id, asked) {
    if (asked.search) {
      within(place, "#search", HTMLDetailsElement).open = true;
      return seeker.resume(id, { ...asked, search: asked.search });
    }
    clear();
    called = asked.name ?? "";
    return question.resume(id, asked.base, how);
  }

  /** The design, with holes or a web to begin with where an axis changes what it lacks. */
  function base() {
    const touched = axes.flatMap((each) => each.read()).flatMap(({ path }) => PART.exec(path)?.[1] ?? []);
    let submission = design.submission;
    for (const pointer of touched)
      if (!at(submission, pointer)) submission = withValue(submission, pointer, form.beginnings.object(pointer, null));
    return submission;
  }

  /**
   * @param {StudyResults} results
   * @param {string} address
   */
  function show(results, address) {
    last = results;
    draw(results);
    const csv = button("Table as CSV", async () =>
      saveTable(fileOfDesign(called, "study.csv"), await (await request(`${address}/results/table.csv`)).text()),
    );
    out.replaceChildren(region("Designs of the study", tableOf(results)), h("div", { className: "buttons" }, csv));
  }

  /** @param {StudyResults} results */
  function draw({ rows, gear }) {
    const computed = rows.filter((row) => row.curves?.length && row.curves[0].statistics);
    for (const option of [...across.options, ...up.options])
      option.hidden = !computed.some((row) => Number.isFinite(worstInRow(quantityOf(option.value), row, gear)));
    const [x, y] = [quantityOf(across.value), quantityOf(up.value)];
    /** @type {(quantity: Quantity, row: TableRow) => number} */
    const readOf = (quantity, row) => quantity.factor * worstInRow(quantity, row, gear);
    const points = computed
      .map((row) => ({ x: readOf(x, row), y: readOf(y, row), label: nameOfRow(row), strong: row.pareto }))
      .filter((point) => Number.isFinite(point.x) && Number.isFinite(point.y));
    picker.hidden = computed.length < 2;
    const title = `Designs by ${inWords(x)} and ${inWords(y)}, of several torques the worst; large points are the best`;
    picture.replaceChildren(...(points.length > 1 ? [figure({ points, x: inUnit(x), y: inUnit(y), title })] : []));
  }

  /** @param {StudyResults} results */
  function tableOf({ rows, gear }) {
    const ofRow = OF_ROW.map(
      (name) => [name, `${name}.${gear}`].map(quantityOf).find((each) => each.of) ?? quantityOf(name),
    );
    const ofCurve = OF_CURVE.map(quantityOf);
    /** @type {(quantity: Quantity) => string} */
    const named = (quantity) => `${calledOf(quantity)} ${quantity.printed}`;
    const names = ["Design", "Best", ...ofRow.map(named), "Torque N m", ...ofCurve.map(named), unseen("Actions")];
    /** @type {(row: TableRow, curve: RowCurve) => string[]} */
    const cells = (row, curve) => {
      /** @type {(quantity: Quantity) => string} */
      const each = (quantity) => shown(quantity, inRow(quantity, row, curve, gear));
      return [...ofRow.map(each), number(curve.output_torque_n_m), ...ofCurve.map(each)];
    };
    return table(
      names,
      rows.flatMap((row) => rowsOf(row, cells)),
    );
  }

  /**
   * @param {TableRow} row
   * @param {(row: TableRow, curve: RowCurve) => string[]} cells
   */
  function rowsOf(row, cells) {
    const lead = [
      h("th", { scope: "row" }, nameOfRow(row)),
      h(
        "td",
        {},
        row.pareto
          ? h(
              "strong",
              { title: "No other design is at least as good in mass, peak-to-peak and stiffness, and better in one" },
              "yes",
            )
          : "",
      ),
    ];
    if (!row.curves?.length)
      return [
        h(
          "tr",
          {},
          ...lead,
          h("td", { colSpan: 9 }, row.problem ? (row.problem.errors?.[0]?.detail ?? row.problem.detail) : row.status),
        ),
      ];
    const open = button("Open", () => openRow(row), { ariaLabel: `Open ${nameOfRow(row)}` });
    return row.curves.map((curve, i) =>
      h(
        "tr",
        { className: row.pareto ? "strong" : "" },
        ...(i ? [h("th", { scope: "row" }, nameOfRow(row)), h("td")] : lead),
        ...cells(row, curve).map((cell) => h("td", {}, cell)),
        h("td", {}, i ? "" : open),
      ),
    );
  }

  /**
   * What a row changes, in the words of the form.
   *
   * @param {TableRow} row
   */
  function nameOfRow({ label, changes }) {
    const words = Object.entries(/** @type {Record<string, unknown>} */ (changes)).map(
      ([pointer, value]) =>
        `${form.named(pointer)} ${typeof value === "number" ? number(value, 5) : Array.isArray(value) ? value.join(", ") : String(value).replace(/_/g, " ")}`,
    );
    return words.join("; ") || label;
  }

  /** @param {TableRow} row */
  async function openRow(row) {
    const job = await json(`v1/jobs/${row.job}`);
    onOpen(job.submission, null);
  }

  return { refresh: () => [...axes, seeker].forEach((each) => each.refresh()), resume };
}

/**
 * Values over a field that is chosen from all that the form has.
 *
 * @param {number} index
 * @param {Design} design
 * @param {Form} form
 */
function axis(index, design, form) {
  const id = `axis-${index}`;
  const values = h("input", {
    type: "text",
    id: `${id}-values`,
    ariaLabel: `Values of axis ${index + 1}`,
    spellcheck: false,
  });
  const field = h("select", {
    id,
    on: {
      change: () => {
        field.dataset.chosen = "yes";
        put(values, suggested());
      },
    },
  });
  const element = inLine(h("label", { htmlFor: id }, index ? "and" : "Vary"), field, ...labelled("over", values));

  /** Values around the one that the design has. */
  function suggested() {
    if (COUNT.test(field.value)) return COUNTS;
    const known = form.fields().find(({ pointer }) => pointer === field.value);
    const [, part] = PART.exec(field.value) ?? [];
    const begun =
      part && !at(design.submission, part)
        ? at(form.beginnings.object(part, null), field.value.slice(part.length))
        : undefined;
    const value = at(design.submission, field.value) ?? usualAt(form.api, design.submission, field.value) ?? begun;
    if (known?.kind.kind === "choice") return (known.kind.schema.enum ?? []).join(", ");
    if (typeof value !== "number") return "";
    if (value === 0) return known?.kind.whole ? "0, 1, 2" : "0, 0.1, 0.2";
    return [0.9, 1, 1.1]
      .map((part) => (known?.kind.whole ? Math.round(part * value) : Number((part * value).toPrecision(3))))
      .join(", ");
  }

  /** @type {Record<string, boolean | null>} */
  const WORDS = { true: true, false: false, null: null };
  const isWord = () =>
    ["choice", "flag"].includes(form.fields().find(({ pointer }) => pointer === field.value)?.kind.kind ?? "");
  const listed = () =>
    isWord()
      ? values.value
          .split(/[\s,;]+/)
          .filter(Boolean)
          .map((word) => (word in WORDS ? WORDS[word] : word))
      : allGiven(values);
  const read = () =>
    field.value && values.value.trim() ? [pathOf(field.value, [...new Set(/** @type {unknown[]} */ (listed()))])] : [];

  /**
   * A field within a list is changed by its place; the torque as the list that it is.
   *
   * @param {string} path
   * @param {unknown[]} list
   */
  function pathOf(path, list) {
    return path === TORQUE ? { path, values: list.map((value) => [value]) } : { path, values: list };
  }

  function refresh() {
    const fields = form.fields().filter(({ pointer }) => pointer !== "/tags");
    // Several patterns have fields of their own, and none of one pattern.
    const absent = LACKING.filter(
      (pointer) =>
        !fields.some((each) => each.pointer === pointer) && !Array.isArray(design.get(PART.exec(pointer)?.[1] ?? "")),
    );
    const all = [...[...absent, TORQUE].map((pointer) => ({ pointer, title: form.titled(pointer) })), ...fields];
    const before = field.value;
    // The field that was chosen may not be there any more.
    if (!offer(field, "none", all)) values.value = "";
    if (index === 0 && !field.dataset.chosen)
      field.value = all.find(({ pointer }) => COUNT.test(pointer))?.pointer ?? "";
    if (field.value && field.value !== before) put(values, suggested());
  }

  refresh();
  return { element, read, refresh };
}
