// @ts-check
// The numbers of designs as the service names them: what they are called, their units, and where results and rows of
// tables have them.

import { json } from "./api.js";
import { extent, fixed, number, unit } from "./numbers.js";

/** Units that are printed as multiples of the service's, and what numbers are multiplied by. */
const MULTIPLES = { "N/m": ["N/µm", 1e-6], "kg m^2": ["kg cm²", 1e4] };
/** So many decimals have numbers in a unit; small ones have three digits. */
const [DECIMALS, SMALL] = [{ "N/µm": 2, MPa: 1, "%": 1, mm: 2 }, 0.1];

let known = new Map();

/** Fetches them, once. */
export async function fetchQuantities() {
  const { items } = await json("v1/quantities");
  known = new Map(
    items.map((item) => {
      const [printed, factor] = MULTIPLES[item.unit] ?? [unit(item.unit), 1];
      return [item.name, { ...item, printed, factor }];
    }),
  );
}

export const quantities = () => [...known.values()];

/** The quantity of this name; one that a later service has is called by it. */
export const quantityOf = (name) =>
  known.get(name) ?? {
    name: String(name),
    title: String(name),
    symbol: String(name),
    printed: "",
    factor: 1,
    needs: [],
  };

/** A quantity with its unit, if it has one. */
export const inUnit = ({ title, printed }) => (printed ? `${title} in ${printed}` : title);

/** What a quantity is called beside its values: those of the pair and of one gear by their titles. */
export const calledOf = ({ of, gear, title, symbol }) => (gear || of === "pair" ? title : symbol);

/** What it is called in the middle of a sentence. */
export const inWords = ({ title }) => title[0].toLowerCase() + title.slice(1);

/** A value of a quantity as it is printed. */
export function shown({ printed, factor }, value) {
  if (!Number.isFinite(value)) return "–";
  return Math.abs(factor * value) < SMALL ? number(factor * value, 3) : fixed(factor * value, DECIMALS[printed] ?? 3);
}

const at = (object, name) => name.split(".").reduce((part, step) => part?.[step], object);
const order = (curve, pattern, value = "transmission_error_um") =>
  curve.spectrum?.named.find(({ label }) => pattern.test(label))?.[value];

/** Where results have what does not stand there under its name: of a curve, and of all results. */
const ELSEWHERE = {
  pair_mass_kg: (_, { pair }) => pair.driving.mass_kg + pair.driven.mass_kg,
  hole_order_um: (curve) => order(curve, /^H_N\d?$/),
  hole_order_of_holes_um: (curve) => order(curve, /^H_N\d?$/, "transmission_error_of_holes_um"),
  mesh_order_um: (curve) => order(curve, /^H_Z2?$/),
  face_load_factor: (curve) => curve.face?.face_load_factor,
  peak_contact_pressure_mpa: (curve) => extent(curve.peak_contact_pressure_mpa)?.[1],
  "dynamic_transmission_error_um.peak_to_peak": ({ dynamics }) =>
    dynamics &&
    extent(
      [dynamics.up, dynamics.down].flatMap((branch) => branch?.dynamic_transmission_error_um.peak_to_peak ?? []),
    )?.[1],
};

/** The value of a quantity in `results`, of one of their curves. */
export function inResults({ name, of }, curve, results) {
  if (ELSEWHERE[name]) return ELSEWHERE[name](curve, results);
  const [own, gear] = name.split(".");
  return of === "curve" ? at(curve.statistics, name) : gear ? results.pair[gear][own] : results.pair[name];
}

/**
 * The same in a row of the table of a study, whose numbers of one gear are those of `gear`; undefined where it has none
 * of it.
 */
export function inRow({ name, of, gear }, row, curve, studied) {
  if (of === "pair") return gear && gear !== studied ? undefined : row[name.split(".")[0]];
  const own = at(curve, name);
  return own === undefined ? at(curve.statistics, name) : own;
}

/** The worst in a row over its torques. */
export function worstInRow(quantity, row, studied) {
  const values = row.curves.map((curve) => inRow(quantity, row, curve, studied));
  return quantity.better === "larger" ? Math.min(...values) : Math.max(...values);
}
