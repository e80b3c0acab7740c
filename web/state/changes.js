// @ts-check
// What a change of one field of the design brings with it: what it stands in place of, and what keeps its proportion.

import { HELIX, MEMBERS } from "./design.js";
import { helix, intoPlane, intoSolid, isSolid } from "./dimensions.js";
import { number } from "./numbers.js";
import { insteadOf, lastOf, schemaAt, titleAt } from "./schema.js";

/** @import { Cause, Design } from "./design.js" */
/** @import { Step } from "./dimensions.js" */
/** @import { GearName } from "./documents.js" */
/** @import { Api } from "./schema.js" */

/** Fields that both gears have to have alike: they stand once, with the pair, until they are unlocked. */
export const ALIKE = ["module_mm", "pressure_angle_deg"];

/** What other lengths are given in multiples of, or number teeth by. */
const BASIC = ["module_mm", "pressure_angle_deg", "tooth_count"];

/**
 * Fields of a gear that go with a change of another one: what is said of it, and their values.
 *
 * @typedef {Record<string, [words: string, value: unknown]>} Followed
 */

/** @typedef {Partial<Record<GearName, Record<string, number>>> & { helix?: number }} Last */

export class Changes {
  /**
   * The last module and number of teeth of each gear that were numbers: what is typed passes through none.
   *
   * @type {Last}
   */
  #last = {};
  /** @type {Set<string>} */
  #unlocked = new Set();

  /**
   * `notify` says what else a change has changed.
   *
   * @param {Api} api
   * @param {Design} design
   * @param {(words: string) => void} notify
   */
  constructor(api, design, notify) {
    this.api = api;
    this.design = design;
    this.notify = notify;
  }

  /** Unlocks what the gears of the design have differently, and remembers what lengths are in proportion to. */
  learn() {
    for (const name of ALIKE)
      if (new Set(MEMBERS.map((member) => this.design.get(`/pair/${member}/${name}`))).size > 1)
        this.#unlocked.add(name);
    this.remember();
  }

  /** Remembers what lengths are in proportion to. */
  remember() {
    for (const member of MEMBERS) this.#remember(member);
  }

  /**
   * Whether both gears have one value in a field of that name.
   *
   * @param {string} name
   */
  isLocked(name) {
    return ALIKE.includes(name) && !this.#unlocked.has(name);
  }

  /**
   * Gives both gears the value of the driving one, or each its own.
   *
   * @param {string} name
   * @param {boolean} locked
   */
  lock(name, locked) {
    if (!locked) return this.#unlocked.add(name);
    this.#unlocked.delete(name);
    this.design.set(`/pair/driven/${name}`, this.design.get(`/pair/driving/${name}`), "form");
  }

  /**
   * Sets a field and `further` ones, and takes away what it stands in place of.
   *
   * @param {string} pointer
   * @param {unknown} value
   * @returns {void}
   */
  put(pointer, value, further = {}) {
    const basic = this.#basic(pointer);
    if (basic) return this.#putBasic(basic.members, basic.name, value);
    if (pointer === HELIX) return this.#putHelix(value, "form");
    if (pointer.endsWith("/material/name")) return this.#putMaterial(pointer, value);
    if (pointer === "/method" && isSolid(String(value)) && !isSolid(this.design.get("/method"))) {
      const { changes, told } = intoSolid(this.design);
      return this.follow({ changes: { ...changes, [pointer]: value }, told: told.slice(1) }, "mend");
    }
    this.design.setAll(
      { [pointer]: value, ...further, ...(value === undefined ? {} : this.#displaced(pointer)) },
      "form",
    );
  }

  /**
   * Sets a number as a hand does.
   *
   * @param {string} pointer
   * @param {number} value
   */
  turn(pointer, value) {
    const basic = this.#basic(pointer);
    if (basic) this.#putBasic(basic.members, basic.name, value, "drag");
    else if (pointer === HELIX) this.#putHelix(value, "drag");
    else this.design.set(pointer, value, "drag");
  }

  /**
   * Gives a field its default.
   *
   * @param {string} pointer
   */
  reset(pointer) {
    if (pointer === HELIX) this.#putHelix(undefined, "mend");
    else this.design.set(pointer, undefined, "mend");
  }

  /**
   * Takes values by their pointers, as a warning offers them.
   *
   * @param {Record<string, unknown>} changes
   */
  take(changes) {
    this.design.setAll(
      { ...changes, ...Object.assign({}, ...Object.keys(changes).map((pointer) => this.#displaced(pointer))) },
      "mend",
    );
  }

  /**
   * Takes an object away; holes that are no slots any more are round, and as wide.
   *
   * @param {string} pointer
   */
  takeAway(pointer) {
    const { width_mm: width } = this.design.get(pointer) ?? {};
    const round = pointer.endsWith("/slot") && width ? { [pointer.replace(/slot$/, "radius_mm")]: width / 2 } : {};
    this.design.setAll({ [pointer]: undefined, ...round }, "form");
  }

  /**
   * Computes the pair in three dimensions, or in the plane without what has an extent along the axis; says what went
   * with it.
   *
   * @param {boolean} inSolid
   */
  compute(inSolid) {
    this.follow(inSolid ? intoSolid(this.design) : intoPlane(this.design), "mend");
  }

  /**
   * Makes changes that belong together, and says what they are.
   *
   * @param {Step} step
   * @param {Cause} by
   */
  follow({ changes, told }, by) {
    this.design.setAll(changes, by, [HELIX]);
    this.#remember("driving");
    if (told.length) this.notify(`${told.join(". ")}.`);
  }

  /**
   * What other fields go with: its name, and the gears that have it together; null for another field.
   *
   * @param {string} pointer
   */
  #basic(pointer) {
    const name = lastOf(pointer);
    const member = MEMBERS.find((each) => pointer === `/pair/${each}/${name}`);
    if (!member || !BASIC.includes(name)) return null;
    return { name, members: this.isLocked(name) ? MEMBERS : [member] };
  }

  /**
   * What goes where a field gets a value: those that it stands in place of.
   *
   * @param {string} pointer
   */
  #displaced(pointer) {
    const holder = pointer.slice(0, pointer.lastIndexOf("/") + 1);
    const others = insteadOf(this.api, pointer).filter((name) => this.design.get(holder + name) !== undefined);
    return Object.fromEntries(others.map((name) => [holder + name, undefined]));
  }

  /** @param {GearName} member */
  #remember(member) {
    const known = (this.#last[member] ??= {});
    for (const name of ["module_mm", "tooth_count"]) {
      const value = this.design.get(`/pair/${member}/${name}`);
      if (value > 0) known[name] = value;
    }
    const angle = this.design.get(HELIX) ?? 0;
    if (Number.isFinite(angle)) this.#last.helix = angle;
  }

  /**
   * Another helix angle, and what goes with it. What is typed passes through what is no number.
   *
   * @param {any} value what is typed, a number or not
   * @param {Cause} by
   */
  #putHelix(value, by) {
    if (value !== undefined && !(Math.abs(value) < 60)) return this.design.set(HELIX, value, by);
    this.follow(helix(this.design, value ?? 0, this.#last.helix), by);
  }

  /**
   * Sets what other lengths are given in multiples of, or number teeth by: those lengths go with it, and this is said.
   *
   * @param {GearName[]} members
   * @param {string} name
   * @param {any} value what is typed, a number or not
   * @param {Cause} by
   */
  #putBasic(members, name, value, by = "form") {
    /** @type {Record<string, unknown>} */
    const changes = {};
    const told = new Set();
    for (const member of members) {
      const pointer = `/pair/${member}`;
      const before = this.#last[member]?.[name] ?? 0;
      changes[`${pointer}/${name}`] = value;
      if (!(value > 0) || !(before > 0) || value === before) continue;
      const followed =
        name === "module_mm"
          ? this.#scaled(pointer, value, before)
          : name === "tooth_count"
            ? this.#renumbered(pointer, value, before)
            : {};
      for (const [field, [words, now]] of Object.entries(followed)) {
        changes[`${pointer}/${field}`] = now;
        told.add(words);
      }
    }
    this.design.setAll(
      changes,
      by,
      members.map((member) => `/pair/${member}/${name}`),
    );
    for (const member of members) this.#remember(member);
    if (told.size) this.notify(`${[...told].join(", ")}.`);
  }

  /**
   * The given lengths of a rack that go with the module: as many modules as before, or none where that is the default.
   *
   * @param {string} pointer
   * @param {number} value
   * @param {number} before
   */
  #scaled(pointer, value, before) {
    /** @type {Followed} */
    const followed = {};
    const { properties = {} } = schemaAt(this.api, pointer) ?? {};
    for (const [field, { "x-default-modules": usual }] of Object.entries(properties)) {
      if (usual === undefined && field !== "tip_diameter_mm") continue;
      const given = this.design.get(`${pointer}/${field}`);
      if (typeof given !== "number") continue;
      const modules = given / before;
      const isUsual = usual !== undefined && Math.abs(modules - usual) < 1e-6;
      const title = titleAt(this.api, `${pointer}/${field}`);
      followed[field] = isUsual
        ? [`${title} back to its default of ${usual} modules`, undefined]
        : [`${title} stays ${number(modules, 4)} modules`, Number((modules * value).toPrecision(9))];
    }
    return followed;
  }

  /**
   * What is given tooth by tooth, or to the tips of so many teeth.
   *
   * @param {string} pointer
   * @param {number} value
   * @param {number} before
   */
  #renumbered(pointer, value, before) {
    /** @type {Followed} */
    const followed = {};
    const tip = this.design.get(`${pointer}/tip_diameter_mm`);
    if (typeof tip === "number")
      followed.tip_diameter_mm = [
        "The tip diameter grows with the teeth",
        Number((tip + this.design.get(`${pointer}/module_mm`) * (value - before)).toPrecision(9)),
      ];
    const { eccentricity, ...lists } = this.design.get(`${pointer}/tooth_deviations`) ?? {};
    if (Object.values(lists).some((list) => Array.isArray(list) && list.length > 0 && list.length !== value))
      followed.tooth_deviations = [
        `The deviations of ${before} teeth were taken away`,
        eccentricity ? { eccentricity } : undefined,
      ];
    return followed;
  }

  /**
   * Names the material of a gear. Its numbers stand in place of those that were given before.
   *
   * @param {string} pointer
   * @param {unknown} name
   */
  #putMaterial(pointer, name) {
    const holder = pointer.slice(0, pointer.lastIndexOf("/"));
    const given = Object.keys(this.design.get(holder) ?? {}).filter((field) => field !== "name");
    const numbers = name === undefined ? [] : given.map((field) => [`${holder}/${field}`, undefined]);
    this.design.setAll({ [pointer]: name, ...Object.fromEntries(numbers) }, "form", [pointer]);
    if (numbers.length) this.notify(`The numbers of ${name} stand in place of those that were given.`);
  }
}
