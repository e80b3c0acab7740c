// @ts-check
// What a part of the form begins with when it is asked for: values that fit the gear it is for, else defaults.

import { between, OPENINGS, reachOf, rounded, slotOf } from "./openings.js";
import { USUAL_POSITIONS } from "./preview.js";
import { kindOf, lastOf, resolve } from "./schema.js";
import { dedendumOf, rootRadius, toolShift } from "./tool.js";

/** @import { Design } from "./design.js" */
/** @import { Gear, GearName, Limits, Results } from "./documents.js" */
/** @import { Api, Kind } from "./schema.js" */

const TURN = Math.PI / 180;

/** A run-up begins with so many speeds, up to so many times that of the resonance at the mesh order. */
const SPEEDS = 100;
const BEYOND_RESONANCE = 1.3;

export class Beginnings {
  /**
   * `limits` are those of the service; `results` gives those of the design as it was computed last, null before.
   *
   * @param {Api} api
   * @param {Design} design
   * @param {{ limits: Limits, results: () => Results | undefined }} known
   */
  constructor(api, design, { limits, results }) {
    this.api = api;
    this.design = design;
    this.limits = limits;
    this.results = results;
  }

  /**
   * All that is set where an object is asked for that is not there yet: itself, and what it needs beside it.
   *
   * @param {string} pointer
   * @param {Kind | null} kind
   * @returns {Record<string, unknown>}
   */
  values(pointer, kind) {
    /** @returns */
    const values = { [pointer]: this.object(pointer, kind) };
    const table = pointer === "/dynamics" && !this.design.get("/force_table") ? this.#table() : {};
    return Object.keys(table).length ? { ...values, "/force_table": table } : values;
  }

  /**
   * An object that is not there yet.
   *
   * @param {string} pointer
   * @param {Kind | null} kind
   * @returns {any} a value for the field, which the schema describes
   */
  object(pointer, kind) {
    if (pointer.endsWith("/slot")) return slotOf(this.design.get(pointer.slice(0, -"/slot".length)));
    if (pointer === "/force_table") return this.#table();
    if (pointer === "/dynamics") return this.#runUp();
    const fitting = this.#fitting(pointer, lastOf(pointer));
    return fitting ?? this.#begin(kind);
  }

  /**
   * One of several forms to begin with: what is there in the other form, as far as it goes.
   *
   * @param {string} pointer
   * @param {Kind} kind
   * @returns {any} a value for the field
   */
  variant(pointer, kind) {
    const there = this.design.get(pointer);
    const name = lastOf(pointer);
    if (name === "start") return this.#start(pointer, Object.keys(kind.schema.properties ?? {})[0], there);
    if (/\/profile_modifications\/\d+$/.test(pointer)) return this.#modification(pointer, kind);
    if (/\/lead_modifications\/\d+$/.test(pointer)) return this.#lead(pointer, kind);
    if (name === "interface_radius_mm") return this.#interface(kind);
    if (name === "driving_speed_rpm") {
      const { driving_speed_rpm: range } = this.#runUp();
      return kind.kind === "number" ? range.to / 2 : range;
    }
    if (name !== "holes") return this.#begin(kind);
    const patterns = there ? [there].flat() : [this.object(pointer, kind)];
    return kind.kind === "list" ? patterns : patterns[0];
  }

  /**
   * A further entry of a list.
   *
   * @param {string} pointer
   * @param {Kind} kind
   * @param {any[]} values
   * @returns {any} a value for the list
   */
  further(pointer, kind, values) {
    if (pointer.endsWith("/profile_modifications"))
      return this.#modification(pointer, kindOf(this.api, kind.items?.variants?.[0] ?? kind.items?.schema ?? {}));
    if (pointer.endsWith("/lead_modifications")) return { kind: "crowning", amount_um: 5 };
    if (!pointer.endsWith("/holes")) return this.#begin(kind.items);
    const gear = this.#gear(pointer);
    return values.length && gear ? between(values.at(-1), this.#ligament(gear.module_mm)) : this.object(pointer, kind);
  }

  /**
   * @param {string} pointer
   * @returns {Gear | null}
   */
  #gear(pointer) {
    const member = /\/pair\/(driving|driven)/.exec(pointer)?.[0];
    return member ? this.design.get(member) : null;
  }

  /**
   * What suits the gear at `pointer` where `name` is asked for; undefined where nothing depends on the gear.
   *
   * @param {string} pointer
   * @param {string} name
   * @returns {object | undefined}
   */
  #fitting(pointer, name) {
    const gear = this.#gear(pointer);
    if (!gear) return undefined;
    const { root, bore, module } = circlesOf(gear);
    const { web, holes } = gear.blank ?? {};
    // It stands in place of the bore.
    if (name === "shaft") return { radius_mm: rounded(bore) };
    const opening = OPENINGS[name];
    if (opening) {
      const [inner, outer] = web ? [web.inner_radius_mm, web.outer_radius_mm] : [bore, root];
      return opening({ inner, outer, isWeb: Boolean(web), whole: root - bore, ligament: this.#ligament(module) });
    }
    const [low, high] = reachOf(holes);
    if (name === "tip_relief")
      return { amount_um: 10, shape: "linear", start: { radial_length_mm: rounded(0.5 * module, 2) } };
    const hub = Math.min(bore + 0.2 * (root - bore), (bore + low) / 2);
    if (name === "hub")
      return { outer_radius_mm: rounded(Math.min(hub, web?.inner_radius_mm ?? hub)), width_mm: gear.face_width_mm };
    if (name !== "web") return undefined;
    // Half the face, around the holes, under a rim that a plane model stands for where there is room for it.
    const outer = Math.max(root - 3.6 * module, bore + 0.6 * (root - bore), high ? (high + root) / 2 : 0);
    return {
      inner_radius_mm: rounded(hub),
      outer_radius_mm: rounded(outer),
      thickness_mm: rounded(gear.face_width_mm / 2),
    };
  }

  /**
   * As much material between openings, in mm, as is computed without a warning, and a fifth more.
   *
   * @param {number} module
   */
  #ligament(module) {
    return 1.2 * this.limits.least_ligament_modules * module;
  }

  /**
   * The usual table, or one of fewer loads where the true period is so long that more would be too many positions.
   *
   * @returns {{ loads?: number }}
   */
  #table() {
    const table = resolve(this.api, this.api.components.schemas.ForceTableRequest);
    const { minimum = 0, default: usual } = table.properties?.loads ?? {};
    const period = this.results()?.pair.period_mesh_periods ?? 1;
    const { positions_per_mesh_period: positions = USUAL_POSITIONS, span_mesh_periods: span } =
      this.design.get("/resolution") ?? {};
    const ofCurves = (span ?? period) * this.design.get("/output_torques_n_m").length;
    const loads = Math.floor((this.limits.positions / positions - ofCurves) / period);
    return loads < usual ? { loads: Math.max(loads, minimum) } : {};
  }

  /** From rest to beyond the speed at which the mesh order meets the gears on their teeth. */
  #runUp() {
    const results = this.results();
    const stiffness = results?.curves[0].statistics.mesh_stiffness_tangent_n_per_m.mean;
    if (!results || !stiffness) return { driving_speed_rpm: { from: 0, to: 6000, count: SPEEDS } };
    const [driving, driven] = [results.pair.driving, results.pair.driven].map(
      (gear) => (gear.base_radius_mm / 1000) ** 2 / gear.polar_inertia_kg_m2,
    );
    const frequency = Math.sqrt(stiffness * (driving + driven)) / (2 * Math.PI);
    const resonance = (60 * frequency) / this.design.get("/pair/driving/tooth_count");
    const step = 10 ** Math.floor(Math.log10(resonance));
    return {
      driving_speed_rpm: { from: 0, to: Math.ceil((BEYOND_RESONANCE * resonance) / step) * step, count: SPEEDS },
    };
  }

  /**
   * The start of a relief as the field `name` says it: at the same place of the flank as before, else half a module
   * below the tip, or above the root.
   *
   * @param {string} pointer
   * @param {string} name
   * @param {any} there
   */
  #start(pointer, name, there) {
    const gear = this.#gear(pointer);
    const holder = this.design.get(pointer.slice(0, -"/start".length));
    const atRoot = holder?.kind === "root_relief";
    if (!gear) return {};
    const flank = flankOf(gear);
    const known = there && flank.radiusOf(there, atRoot);
    const inside = known > flank.formRadius && known < flank.tipRadius;
    const radius = inside
      ? known
      : atRoot
        ? flank.radiusAt(flank.form + 0.25 * (flank.tip - flank.form))
        : flank.tipRadius - 0.5 * gear.module_mm;
    return { [name]: rounded(flank.said(radius, name, atRoot), 5) };
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   */
  #modification(pointer, kind) {
    const { kind: word } = kind.schema.properties ?? {};
    const name = word?.enum?.[0] ?? "tip_relief";
    const gear = this.#gear(pointer);
    if (!gear) return {};
    const flank = flankOf(gear);
    if (name === "table")
      return {
        kind: name,
        roll_length_mm: [rounded(flank.form, 5), rounded((flank.form + flank.tip) / 2, 5), rounded(flank.tip, 5)],
        removed_um: [0, 0, 5],
      };
    if (name === "tip_relief")
      return { kind: name, amount_um: 5, start: { radial_length_mm: rounded(0.5 * gear.module_mm, 2) } };
    if (name === "root_relief")
      return {
        kind: name,
        amount_um: 5,
        start: { diameter_mm: rounded(2 * flank.radiusAt(flank.form + 0.25 * (flank.tip - flank.form)), 6) },
      };
    return { kind: name, amount_um: 5 };
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   */
  #lead(pointer, kind) {
    const name = kind.schema.properties?.kind?.enum?.[0] ?? "crowning";
    const face = this.#gear(pointer)?.face_width_mm ?? 20;
    if (name === "table") return { kind: name, z_mm: [-face / 2, 0, face / 2], removed_um: [5, 0, 5] };
    if (name === "end_relief") return { kind: name, amount_um: 5, length_mm: rounded(0.2 * face, 2), side: "both" };
    return { kind: name, amount_um: 5 };
  }

  /**
   * Between the holes and the roots of the gears that have holes: one radius where one fits all, else one for each.
   *
   * @param {Kind} kind
   */
  #interface(kind) {
    /** @type {(member: GearName) => { holed: boolean, low: number, high: number, usual: number }} */
    const bounds = (member) => {
      const gear = this.design.get(`/pair/${member}`);
      const { root, module } = circlesOf(gear);
      const [, reach] = reachOf(gear.blank?.holes);
      return { holed: reach > 0, low: reach, high: root, usual: Math.max(root - module, (root + reach) / 2) };
    };
    const each = { driving: bounds("driving"), driven: bounds("driven") };
    const holed = Object.values(each).filter((gear) => gear.holed);
    const [low, high] = [Math.max(...holed.map((gear) => gear.low)), Math.min(...holed.map((gear) => gear.high))];
    if (kind.kind === "number" && low < high) return rounded(holed.length === 1 ? holed[0].usual : (low + high) / 2, 5);
    return { driving: rounded(each.driving.usual, 5), driven: rounded(each.driven.usual, 5) };
  }

  /**
   * The default that the schema says, or the least that it takes.
   *
   * @param {Kind | null | undefined} kind
   * @returns {any} a value for the field
   */
  #begin(kind) {
    if (!kind) return "";
    const { schema } = kind;
    if (kind.kind === "object") {
      const needed = Object.entries(schema.properties ?? {}).filter(([name]) => schema.required?.includes(name));
      return Object.fromEntries(needed.map(([name, each]) => [name, this.#begin(kindOf(this.api, each))]));
    }
    if (kind.kind === "variants") return this.#begin(kindOf(this.api, kind.variants?.[0] ?? {}));
    if (kind.kind === "list") return [this.#begin(kind.items)];
    if (kind.kind === "numbers") return [];
    if (schema.default !== undefined && schema.default !== null) return schema.default;
    if (kind.kind === "choice") return schema.enum?.[0];
    return kind.kind === "number" ? Math.max(schema.minimum ?? 0, Math.min(1, schema.maximum ?? 1)) : "";
  }
}

/**
 * The circles of a gear between which its parts have to fit, in mm.
 *
 * @param {Gear} gear
 */
function circlesOf(gear) {
  const { module_mm: module } = gear;
  const root = rootRadius(gear);
  return { module, root, bore: gear.blank?.bore_radius_mm ?? root / 3 };
}

/**
 * The involute of a gear: roll lengths of its form circle and its tip, and one measure of a place on it as another.
 *
 * @param {Gear} gear
 */
function flankOf(gear) {
  const { module_mm: m, tooth_count: z } = gear;
  const [alpha, x] = [(gear.pressure_angle_deg ?? 20) * TURN, gear.profile_shift ?? 0];
  const r = (m * z) / 2;
  const base = r * Math.cos(alpha);
  const tipRadius = gear.tip_diameter_mm ? gear.tip_diameter_mm / 2 : r + (gear.addendum_mm ?? m) + x * m;
  const straight = dedendumOf(gear) - (gear.rack_tip_radius_mm ?? 0.38 * m) * (1 - Math.sin(alpha));
  const form = Math.max(0, r * Math.sin(alpha) - (straight - toolShift(gear) * m) / Math.sin(alpha));
  /** @type {(radius: number) => number} */
  const roll = (radius) => Math.sqrt(Math.max(0, radius ** 2 - base ** 2));
  /** @type {(length: number) => number} */
  const radiusAt = (length) => Math.hypot(base, length);
  const tip = roll(tipRadius);
  const formRadius = radiusAt(form);
  /** @type {(start: Record<string, number>, atRoot: boolean) => number} */
  const radiusOf = (start, atRoot) => {
    if (start.diameter_mm) return start.diameter_mm / 2;
    if (start.roll_angle_deg) return radiusAt(start.roll_angle_deg * TURN * base);
    if (start.roll_length_from_tip_mm) return radiusAt(tip - start.roll_length_from_tip_mm);
    if (start.roll_length_from_form_mm) return radiusAt(form + start.roll_length_from_form_mm);
    return atRoot ? formRadius + start.radial_length_mm : tipRadius - start.radial_length_mm;
  };
  /** @type {(radius: number, name: string, atRoot: boolean) => number} */
  const said = (radius, name, atRoot) =>
    /** @type {Record<string, number>} */ ({
      diameter_mm: 2 * radius,
      roll_angle_deg: roll(radius) / base / TURN,
      roll_length_from_tip_mm: tip - roll(radius),
      roll_length_from_form_mm: roll(radius) - form,
      radial_length_mm: atRoot ? radius - formRadius : tipRadius - radius,
    })[name];
  return { form, tip, formRadius, tipRadius, radiusAt, radiusOf, said };
}
