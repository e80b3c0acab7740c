// @ts-check
// The deviations of a gear's teeth: drawn by an accuracy class, pasted from a spreadsheet, or dropped as a file of a
// measurement.

import { button, h, inLine, note } from "../draw/dom.js";
import { given, numeric } from "../draw/inputs.js";
import { post, ProblemError } from "../state/api.js";
import { fixed, number } from "../state/numbers.js";

/** @import { Properties } from "../draw/dom.js" */
/** @import { Design } from "../state/design.js" */
/** @import { Gear, GearName } from "../state/documents.js" */

/** @typedef {keyof NonNullable<Gear["tooth_deviations"]>} Lists */

/**
 * What a column of measured teeth may be called, and the field that it is.
 *
 * @type {[field: Lists, pattern: RegExp][]}
 */
const COLUMNS = [
  ["other_flank_pitch_cumulative_um", /other/i],
  ["pitch_single_um", /single|^f_?pt?\b|^fp$/i],
  ["pitch_cumulative_um", /cumulative|total|index|^f_?pk?\b|pitch/i],
  ["profile_slope_um", /slope|f_?h_?(a|α|alpha)/i],
];

/**
 * Traces of single flanks: the field that they are of, and that of their places.
 *
 * @type {Record<string, [field: Lists, places: string]>}
 */
const TRACES = {
  profiles_by_roll_length: ["profiles", "roll_length_mm"],
  profiles_by_diameter: ["profiles", "diameter_mm"],
  leads: ["leads", "z_mm"],
};

/** @type {(cell: string) => boolean} */
const isNumber = (cell) => cell !== "" && Number.isFinite(Number(cell));

/**
 * The cells of a table as spreadsheets write it: with points or commas in its numbers, in columns between tabs,
 * semicolons or commas.
 *
 * @type {(text: string) => string[][]}
 */
function cellsOf(text) {
  const lines = text
    .trim()
    .split(/\r?\n/)
    .filter((line) => line.trim());
  const separator = [/\t/, /;/].find((each) => lines.some((line) => each.test(line)));
  return lines.map((line) => {
    // A comma within a number is its decimal comma where something else stands between columns.
    if (separator)
      return line.split(separator).map((cell) =>
        cell
          .trim()
          .replace(/^"|"$/g, "")
          .replace(/^(-?\d+),(\d+)$/, "$1.$2"),
      );
    if (
      /^\s*-?\d+,\d+\s*$/.test(line) &&
      lines.every((each) => /^\s*-?\d+(,\d+)?\s*$/.test(each) || /[a-z]/i.test(each))
    )
      return [line.trim().replace(",", ".")];
    return line
      .split(/,|\s+/)
      .map((cell) => cell.trim().replace(/^"|"$/g, ""))
      .filter((cell) => cell !== "");
  });
}

/**
 * Numbers in columns, with names in the first line or without.
 *
 * @type {(text: string) => { head: string[], rows: number[][] }}
 */
export function tableOf(text) {
  const cells = cellsOf(text);
  const head = (cells.length && !cells[0].every(isNumber) && cells.shift()) || [];
  const rows = cells.map((row) => row.map(Number));
  return { head, rows: rows.length === 1 && head.length === 0 ? rows[0].map((value) => [value]) : rows };
}

/**
 * The lists of deviations in a text, for a gear of so many teeth: by the names of its columns, or of a single column
 * the kind that `kind` says. Throws with a reason where it cannot be read.
 *
 * @type {(text: string, teeth: number, kind: string) => Partial<Record<string, number[]>>}
 */
export function measured(text, teeth, kind) {
  const { head, rows } = tableOf(text);
  const bad = rows.findIndex((row) => row.some((value) => !Number.isFinite(value)));
  if (bad >= 0) throw new Error(`Line ${bad + 1 + (head.length ? 1 : 0)} has something that is no number.`);
  if (rows.length !== teeth)
    throw new Error(`There are ${rows.length} numbers; ${teeth} are needed, one for each tooth.`);
  /** @type {Partial<Record<string, number[]>>} */
  const lists = {};
  head.forEach((name, i) => {
    const field = COLUMNS.find(([each, pattern]) => each === name || pattern.test(name))?.[0];
    if (field && !lists[field]) lists[field] = rows.map((row) => row[i]);
  });
  if (!Object.keys(lists).length) {
    const width = rows[0].length;
    if (width > 2)
      throw new Error(
        `There are ${width} columns without names; name them pitch_single_um, pitch_cumulative_um or profile_slope_um.`,
      );
    lists[kind] = rows.map((row) => row[width - 1]);
  }
  if (lists.pitch_single_um) {
    delete lists.pitch_cumulative_um;
    lists.pitch_single_um = closing(lists.pitch_single_um);
  }
  return lists;
}

/**
 * Traces of a measuring machine, for a gear of so many teeth: one row a tooth and flank, of which those of `flank` are
 * taken. The first line names the columns: tooth, flank where there are both, then the places in mm. A machine counts
 * material that is there as positive, a submission what is taken off. Throws with a reason where it cannot be read.
 *
 * @type {(text: string, teeth: number, kind: string, flank: string) => Record<string, object>}
 */
export function traced(text, teeth, kind, flank) {
  const [field, name] = TRACES[kind];
  const [head = [], ...rows] = cellsOf(text);
  const first = head.findIndex(isNumber);
  const places = head.slice(first).map(Number);
  if (first < 1 || places.length < 2 || places.some((place) => !Number.isFinite(place)))
    throw new Error("The first line has to name the columns: tooth, flank, and then the places in mm.");
  const flanks = head.slice(0, first).findIndex((each) => /flank|side|seite/i.test(each));
  const own =
    flanks < 0
      ? rows
      : rows.filter((row) => (row[flanks] ?? "").toLowerCase().startsWith(flank.slice(0, 1).toLowerCase()));
  if (own.length !== teeth)
    throw new Error(
      `There are ${own.length} traces${flanks < 0 ? "" : ` of the ${flank} flank`}; ${teeth} are needed, one for each tooth.`,
    );
  const tooth = flanks === 0 ? 1 : 0;
  const sorted = own.map((row) => row.map(Number)).sort((one, other) => one[tooth] - other[tooth]);
  if (sorted.some((row, i) => row[tooth] !== sorted[0][tooth] + i))
    throw new Error("Teeth have to be numbered one after the other, each once.");
  const removed = sorted.map((row) => row.slice(first).map((value) => 0 - value));
  const bad = removed.findIndex((row) => row.length !== places.length || row.some((value) => !Number.isFinite(value)));
  if (bad >= 0)
    throw new Error(`The trace of tooth ${sorted[bad][tooth]} has not ${places.length} numbers, one for each place.`);
  return { [field]: { [name]: places, removed_um: removed } };
}

/**
 * Single pitch deviations that sum to zero: what a measurement leaves is shared by all teeth.
 *
 * @type {(values: number[]) => number[]}
 */
function closing(values) {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  return values.map((value) => Number((value - mean).toFixed(6)));
}

/**
 * The tool for the gear `member` of `design`.
 *
 * @type {(member: GearName, design: Design) => HTMLElement}
 */
export function deviations(member, design) {
  const pointer = `/pair/${member}/tooth_deviations`;
  const id = `deviations-${member}`;
  /** @type {(name: string, value: number, more: Properties<HTMLInputElement>) => HTMLInputElement} */
  const number_ = (name, value, more) => h("input", { type: "number", id: `${id}-${name}`, value, ...more });
  const [quality, seed, capability] = [
    number_("class", 6, { min: 1, max: 11, step: 1 }),
    number_("seed", 1, { min: 0, step: 1 }),
    numeric({ id: `${id}-capability`, value: 1 }),
  ];
  const out = h("p", { className: "note", role: "status" });
  const kind = h(
    "select",
    { id: `${id}-kind` },
    h("option", { value: "pitch_single_um" }, "single pitch"),
    h("option", { value: "pitch_cumulative_um" }, "cumulative pitch"),
    h("option", { value: "profile_slope_um" }, "profile slope"),
    h("option", { value: "profiles_by_roll_length" }, "profile traces over roll length"),
    h("option", { value: "profiles_by_diameter" }, "profile traces over diameter"),
    h("option", { value: "leads" }, "lead traces"),
  );
  const flank = h(
    "select",
    { id: `${id}-flank` },
    h("option", { value: "right" }, "right"),
    h("option", { value: "left" }, "left"),
  );
  const text = h("textarea", {
    id: `${id}-text`,
    rows: 3,
    spellcheck: false,
    placeholder: "one number a tooth, in µm; or columns with names",
  });
  /** @type {(name: string, input: HTMLInputElement | HTMLSelectElement) => HTMLElement} */
  const named = (name, input) => h("span", {}, h("label", { htmlFor: input.id }, name), " ", input);

  async function draw() {
    try {
      const drawn = await post("v1/draw-deviations", {
        gear: gear(),
        iso_1328_class: Number(quality.value),
        capability: given(capability),
        seed: Number(seed.value),
      });
      design.set(pointer, drawn.tooth_deviations, "mend");
      const um = drawn.tolerances_um;
      out.textContent = `Class ${quality.value}: f_pT ${fixed(um.single_pitch, 1)}, F_pT ${fixed(um.total_pitch, 1)}, f_HαT ${fixed(um.profile_slope, 1)}, F_rT ${fixed(um.runout, 1)} µm. These teeth: F_p ${fixed(drawn.total_pitch_deviation_um, 1)} µm${drawn.total_pitch_deviation_um > um.total_pitch ? ", more than the class allows" : ""}.`;
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      out.textContent = error.reason;
    }
  }

  /** @type {() => Partial<Gear>} */
  const gear = () => {
    const { tooth_deviations: _, ...rest } = design.get(`/pair/${member}`);
    return rest;
  };

  /** @type {(given: string) => void} */
  function take(given) {
    try {
      if (TRACES[kind.value]) {
        const teeth = design.get(`/pair/${member}/tooth_count`);
        design.set(pointer, { ...design.get(pointer), ...traced(given, teeth, kind.value, flank.value) }, "mend");
        out.textContent = `Taken: a trace of the ${flank.value} flank of each of ${teeth} teeth.`;
        text.value = "";
        return;
      }
      const lists = measured(given, design.get(`/pair/${member}/tooth_count`), kind.value);
      const {
        pitch_single_um: _,
        pitch_cumulative_um: __,
        other_flank_pitch_cumulative_um: ___,
        ...kept
      } = design.get(pointer) ?? {};
      design.set(
        pointer,
        { ...(lists.pitch_single_um || lists.pitch_cumulative_um ? kept : design.get(pointer)), ...lists },
        "mend",
      );
      out.textContent = `Taken: ${Object.entries(lists)
        .map(
          ([name, values = []]) =>
            `${name} from ${number(Math.min(...values), 3)} to ${number(Math.max(...values), 3)} µm`,
        )
        .join(", ")}.`;
      text.value = "";
    } catch (error) {
      out.textContent = error instanceof Error ? error.message : String(error);
    }
  }

  const element = h(
    "details",
    { className: "tool", data: { pointer: `${pointer}/tool` } },
    h("summary", {}, "Draw or paste teeth"),
    inLine(
      named("ISO 1328 class", quality),
      named("seed", seed),
      named("capability", capability),
      button("Draw teeth", draw),
    ),
    note(
      "Teeth as a production of the class makes them: a tolerance is three standard deviations over the capability wide. Another seed is another gear.",
    ),
    inLine(
      named("Measured", kind),
      named("loaded flank", flank),
      h("label", { htmlFor: text.id, className: "visually-hidden" }, "Measured deviations"),
      text,
      button("Take them", () => take(text.value)),
    ),
    note(
      "Paste a column of a spreadsheet, or drop a CSV file here. Traces of a measuring machine have one row a tooth and flank: the first line names tooth, flank and the places in mm, and material that is there counts as positive, in µm.",
    ),
    out,
  );
  element.addEventListener("dragover", (event) => {
    event.preventDefault();
    element.classList.add("over");
  });
  element.addEventListener("dragleave", () => element.classList.remove("over"));
  element.addEventListener("drop", async (event) => {
    event.preventDefault();
    element.classList.remove("over");
    const file = event.dataTransfer?.files[0];
    if (file) take((await file.text()).slice(0, 1_000_000));
  });
  return element;
}
