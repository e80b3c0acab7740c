// @ts-check
// Tools of the form: the pair at its least, nominal or most backlash, the load by the driving gear's torque or by power
// and speed, and a material at a temperature.

import { button, h, inLine, labelled, note } from "../draw/dom.js";
import { given, numeric, put } from "../draw/inputs.js";
import { ProblemError } from "../state/api.js";
import { drivingOf, outputOf, powerOf, sizesOf, torqueOf, valuesAt } from "../state/limits.js";
import { materialAt, sourceOf } from "../state/materials.js";
import { number } from "../state/numbers.js";
import { js7 } from "../state/sensitivity.js";

/** @import { Design } from "../state/design.js" */
/** @import { GearName } from "../state/documents.js" */
/** @import { Which } from "../state/limits.js" */

const TORQUES = "/output_torques_n_m";
const SPEED = "/driving_speed_rpm";

/**
 * The tool that puts center distance and thicknesses at their limits.
 *
 * @param {Design} design
 */
export function limitsTool(design) {
  const said = h("p", { className: "note", role: "status" });
  /** @type {(id: string, label: string) => [HTMLInputElement, HTMLInputElement]} */
  const both = (id, label) => [
    numeric({ id: `limits-${id}-lower`, ariaLabel: `Lower limit of ${label}, off the nominal size` }),
    numeric({ id: `limits-${id}-upper`, ariaLabel: `Upper limit of ${label}, off the nominal size` }),
  ];
  const inputs = [
    both("distance", "the center distance"),
    both("driving", "the driving gear"),
    both("driven", "the driven gear"),
  ];
  const names = inputs.map(() => h("span", {}));
  const units = inputs.map(() => h("span", { className: "unit" }));
  /**
   * The sizes between the limits, while the design stands at one of these.
   *
   * @type {{ nominal: number[], pointers: string, set: number[] } | null}
   */
  let known = null;

  /** @param {Which} which */
  function press(which) {
    said.textContent = "";
    const sizes = sizesOf(design.submission.pair);
    const pointers = sizes.map(({ pointer }) => pointer).join();
    const now = sizes.map(({ value }) => value);
    const isAtLimit = known?.pointers === pointers && known.set.join() === now.join();
    const nominal = known && isAtLimit ? known.nominal : now;
    try {
      const off = inputs.map(
        ([lower, upper]) => /** @type {[number, number]} */ ([given(lower) ?? 0, given(upper) ?? 0]),
      );
      const values = valuesAt(sizes, nominal, off, which);
      if (!Object.keys(values).length) throw new ProblemError({ detail: "Give the limits of at least one size." });
      known = { nominal, pointers, set: sizes.map(({ pointer, value }) => values[pointer] ?? value) };
      design.setAll(values, "mend");
      said.textContent = `The pair stands at its ${which === "nominal" ? "nominal sizes" : `${which} backlash`}.`;
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      said.replaceChildren(h("span", { className: "field-error" }, error.message));
    }
  }

  const choices = /** @type {[Which, string][]} */ ([
    ["least", "Least backlash"],
    ["nominal", "Nominal"],
    ["most", "Most backlash"],
  ]);
  const element = h(
    "details",
    { className: "tool", data: { pointer: "limits" } },
    h("summary", {}, "Limits and backlash"),
    note("How far each size may be off, its sign with it: the lower limit, then the upper one."),
    ...inputs.map(([lower, upper], i) => h("div", {}, names[i], inLine(lower, upper, units[i]))),
    h("div", { className: "buttons wrap" }, ...choices.map(([which, words]) => button(words, () => press(which)))),
    said,
  );
  const refresh = () => {
    const { pair } = design.submission;
    if (!pair?.driving || !pair.driven) return;
    sizesOf(pair).forEach(({ title, unit }, i) => {
      names[i].textContent = title;
      units[i].textContent = unit;
    });
    const [lower, upper] = inputs[0];
    if (lower.value || upper.value || !pair.center_distance_mm) return;
    const limit = js7(pair.center_distance_mm);
    put(lower, String(-limit));
    put(upper, String(limit));
  };
  refresh();
  design.onChange(refresh);
  return element;
}

/**
 * The tool that gives the load by the torque of the driving gear, or by power and speed.
 *
 * @param {Design} design
 */
export function loadTool(design) {
  const said = h("p", { className: "field-error", role: "alert" });
  const torque = numeric({ id: "load-torque" });
  const power = numeric({ id: "load-power" });
  const speed = numeric({ id: "load-speed" });

  /** @param {() => void} work */
  const attempt = (work) => {
    said.textContent = "";
    try {
      work();
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      said.textContent = error.message;
    }
  };
  /** @type {(driving: number) => void} */
  const load = (driving) => design.set(TORQUES, [outputOf(driving, design.submission.pair)], "form");
  torque.addEventListener("input", () =>
    attempt(() => {
      const driving = given(torque);
      if (driving) load(driving);
    }),
  );
  for (const each of [power, speed])
    each.addEventListener("input", () =>
      attempt(() => {
        const [kilowatts, rpm] = [given(power), given(speed)];
        if (each === speed && rpm) design.set(SPEED, rpm, "form");
        if (kilowatts && rpm) load(torqueOf(kilowatts, rpm));
      }),
    );
  const refresh = () => {
    const { pair, output_torques_n_m: torques, driving_speed_rpm: rpm } = design.submission;
    const [output] = Array.isArray(torques) ? torques : [];
    if (typeof output !== "number" || !pair?.driving?.tooth_count || !pair.driven?.tooth_count) return;
    const driving = drivingOf(output, pair);
    /** @type {[HTMLInputElement, number | null][]} */
    const shown = [
      [torque, driving],
      [speed, rpm ?? null],
      [power, rpm ? powerOf(driving, rpm) : null],
    ];
    // What is typed stays as it is typed.
    for (const [input, value] of shown)
      if (document.activeElement !== input && (value !== null || input !== power))
        put(input, value === null ? "" : number(value, 6));
  };
  refresh();
  design.onChange(refresh);
  return h(
    "details",
    { className: "tool", data: { pointer: "load" } },
    h("summary", {}, "By the driving gear's torque, or by power"),
    inLine(...labelled("Torque of the driving gear", torque), h("span", { className: "unit" }, "N m")),
    inLine(
      ...labelled("Power", power),
      h("span", { className: "unit" }, "kW"),
      ...labelled("at", speed),
      h("span", { className: "unit" }, "rpm of the driving gear"),
    ),
    said,
  );
}

/**
 * The tool that gives a gear's material the modulus and the expansion that are printed for a temperature. It is there
 * where the material has a name.
 *
 * @param {GearName} member
 * @param {Design} design
 */
export function materialTool(member, design) {
  const pointer = `/pair/${member}/material`;
  const said = h("p", { className: "note", role: "status" });
  const source = note("");
  const temperature = numeric({ id: `temperature-${member}` });
  const press = () => {
    const name = String(design.get(`${pointer}/name`) ?? "");
    try {
      const wanted = given(temperature);
      if (wanted === undefined) throw new ProblemError({ detail: "Give the temperature." });
      const numbers = materialAt(name, wanted);
      const changes = Object.entries(numbers).map(([field, value]) => [`${pointer}/${field}`, value]);
      design.setAll(Object.fromEntries(changes), "mend");
      said.textContent = `${name} at ${number(wanted)} °C: ${number(numbers.youngs_modulus_gpa, 4)} GPa. Its yield strength is left at that of the cold material.`;
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      said.replaceChildren(h("span", { className: "field-error" }, error.message));
    }
  };
  temperature.addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    press();
  });
  const element = h(
    "div",
    { className: "tool" },
    inLine(
      ...labelled("Numbers at", temperature),
      h("span", { className: "unit" }, "°C"),
      button("Take", press, { ariaLabel: `Take the numbers of the ${member} gear's material at this temperature` }),
    ),
    said,
    source,
  );
  let known = "";
  const refresh = () => {
    const name = String(design.get(`${pointer}/name`) ?? "");
    element.hidden = !name;
    if (name === known) return;
    known = name;
    said.textContent = "";
    source.textContent = name && `Sources: ${sourceOf(name)}.`;
  };
  refresh();
  design.onChange(refresh);
  return element;
}
