// What a part of the form begins with when it is asked for: values that suit the pair, else defaults.

import { kindOf } from "./schema.js";

export class Beginnings {
  constructor(api, design) {
    Object.assign(this, { api, design });
  }

  /** An object that is not there yet. */
  object(pointer, kind) {
    if (pointer.endsWith("/slot")) return slotOf(this.design.get(pointer.slice(0, -"/slot".length)));
    const member = /\/pair\/(driving|driven)/.exec(pointer)?.[0];
    const gear = member ? this.design.get(member) : null;
    const usual = gear ? usualValues(gear) : {};
    const name = pointer.split("/").pop();
    if (usual[name]) return usual[name];
    return this.#begin(kind);
  }

  /** One of several forms to begin with: what is there in the other form, as far as it goes. */
  variant(pointer, kind) {
    const there = this.design.get(pointer);
    if (!pointer.endsWith("/holes")) return this.#begin(kind);
    const patterns = there ? [there].flat() : [this.object(pointer, kind)];
    return kind.kind === "list" ? patterns : patterns[0];
  }

  /** A further entry of a list. */
  further(pointer, kind, values) {
    if (!pointer.endsWith("/holes")) return this.#begin(kind.items);
    return values.length ? between(values.at(-1)) : this.object(pointer, kind);
  }

  /** The default that the schema says, or the least that it takes. */
  #begin(kind) {
    const { schema } = kind;
    if (kind.kind === "object") {
      const needed = Object.entries(schema.properties).filter(([name]) => schema.required?.includes(name));
      return Object.fromEntries(needed.map(([name, each]) => [name, this.#begin(kindOf(this.api, each))]));
    }
    if (kind.kind === "variants") return this.#begin(kindOf(this.api, kind.variants[0]));
    if (kind.kind === "list") return [this.#begin(kind.items)];
    if (kind.kind === "numbers") return [];
    if (schema.default !== undefined && schema.default !== null) return schema.default;
    if (kind.kind === "choice") return schema.enum[0];
    return kind.kind === "number" ? Math.max(schema.minimum ?? 0, Math.min(1, schema.maximum ?? 1)) : "";
  }
}

const numberOf = (pattern) => pattern.count ?? pattern.at_deg?.length ?? 1;
const twoDigits = (value) => Number(value.toPrecision(2));

/** Slots in place of the round holes of a pattern, with material left between them. */
function slotOf(pattern) {
  return { width_mm: twoDigits(pattern.radius_mm ?? pattern.circle_radius_mm / 10), angle_deg: twoDigits(180 / Math.max(numberOf(pattern), 3)) };
}

/** A further pattern: small round holes midway between those of `pattern`. */
function between(pattern) {
  const half = 180 / numberOf(pattern);
  const places = pattern.at_deg ? { at_deg: pattern.at_deg.map((angle) => angle + half) } : { count: pattern.count, phase_deg: (pattern.phase_deg ?? 0) + half };
  return { ...places, circle_radius_mm: pattern.circle_radius_mm, radius_mm: twoDigits(0.4 * (pattern.radius_mm ?? pattern.slot?.width_mm / 2)) };
}

/** What a gear gets where holes or a relief are added: six holes in the middle of the blank, a usual relief. */
function usualValues(gear) {
  const root = (gear.module_mm * gear.tooth_count) / 2 - (gear.dedendum_mm ?? 1.25 * gear.module_mm);
  const bore = gear.blank?.bore_radius_mm ?? root / 3;
  const circle = Number(((root + bore) / 2).toPrecision(3));
  const radius = Number(Math.min(0.27 * (root - bore), 0.3 * circle).toPrecision(2));
  return {
    holes: { count: 6, circle_radius_mm: circle, radius_mm: radius, phase_deg: 0 },
    tip_relief: { amount_um: 10, shape: "linear", start: { radial_length_mm: Number((0.5 * gear.module_mm).toPrecision(2)) } },
  };
}
