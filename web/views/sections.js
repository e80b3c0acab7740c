// @ts-check
// The sections of the form: the pair, each gear, load and method, and the order of the fields in them.

import { button, h } from "../draw/dom.js";
import { ALIKE } from "../state/changes.js";
import { MEMBERS } from "../state/design.js";
import { teeth } from "../state/dimensions.js";
import { kindOf, resolve, SUBMISSION } from "../state/schema.js";
import { deviations } from "./deviations.js";
import { limitsTool, loadTool } from "./limits.js";

/** @import { Properties } from "../draw/dom.js" */
/** @import { Changes } from "../state/changes.js" */
/** @import { Design } from "../state/design.js" */
/** @import { GearName } from "../state/documents.js" */
/** @import { Api, Schema } from "../state/schema.js" */
/** @import { Fields } from "./fields.js" */

/** Fields of a gear that a designer looks for first. */
const FIRST = ["tooth_count", "profile_shift"];
/** Fields of a gear that stand below its blank. */
const [RELIEF, DEVIATIONS] = ["tip_relief", "tooth_deviations"];

export class Sections {
  /** Whether all sections are open, or one at a time. */
  unfolded = false;

  /**
   * `renew` makes the form anew, as other fields are needed.
   *
   * @param {Api} api
   * @param {Design} design
   * @param {{ changes: Changes, fields: Fields, renew: () => void }} with
   */
  constructor(api, design, { changes, fields, renew }) {
    this.api = api;
    this.design = design;
    this.changes = changes;
    this.fields = fields;
    this.renew = renew;
    // Made once: what they say stays while fields are made anew around them.
    this.tools = Object.fromEntries(MEMBERS.map((member) => [member, deviations(member, design)]));
    this.ofPair = limitsTool(design);
    this.ofLoad = loadTool(design);
  }

  /** All sections, made from the design as it is. */
  all() {
    const submission = kindOf(this.api, SUBMISSION);
    const { pair, method, output_torques_n_m: torques, ...rest } = submission.schema.properties ?? {};
    const members = resolve(this.api, pair).properties ?? {};
    const gear = resolve(this.api, members.driving);
    return [
      this.#section(
        "Pair",
        "/pair",
        [
          this.fields.of("/pair/center_distance_mm", members.center_distance_mm, true),
          ...ALIKE.map((name) => this.#alike(name, gear)),
          this.#teeth(),
          ...Object.entries(members)
            .filter(([name]) => ![...MEMBERS, "center_distance_mm"].some((other) => other === name))
            .map(([name, schema]) => this.fields.of(`/pair/${name}`, schema, false)),
          this.ofPair,
        ],
        true,
      ),
      this.#gear("driving", members.driving),
      this.#gear("driven", members.driven),
      this.#section(
        "Load and method",
        "/",
        [
          this.fields.of("/output_torques_n_m", torques, true),
          this.ofLoad,
          this.fields.of("/method", method, true),
          ...Object.entries(rest).map(([name, schema]) => this.fields.of(`/${name}`, schema, false)),
        ],
        false,
      ),
    ];
  }

  /**
   * @param {GearName} member
   * @param {Schema} schema
   */
  #gear(member, schema) {
    const pointer = `/pair/${member}`;
    const title = member === "driving" ? "Driving gear" : "Driven gear";
    const { properties = {}, required = [] } = resolve(this.api, schema);
    const { blank, ...all } = properties;
    const names = Object.keys(all).filter((name) => !this.changes.isLocked(name));
    const first = [...FIRST, ...required.filter((name) => !FIRST.includes(name))].filter((name) =>
      names.includes(name),
    );
    const others = names.filter((name) => ![...first, RELIEF, DEVIATIONS].includes(name));
    const valueOf = (/** @type {string} */ name) => this.design.get(`${pointer}/${name}`) ?? null;
    // What the design gives, it shows: nothing that counts is folded away.
    const given = others.filter((name) => valueOf(name) !== null && JSON.stringify(valueOf(name)) !== "[]");
    const parts = given.filter((name) => typeof valueOf(name) === "object");
    /** @type {(names: string[]) => HTMLElement[]} */
    const fieldsOf = (wanted) =>
      wanted
        .filter((name) => names.includes(name))
        .map((name) => this.fields.of(`${pointer}/${name}`, all[name], required.includes(name)));
    const body = Object.entries(resolve(this.api, blank).properties ?? {})
      .sort(([a], [b]) => rank(a) - rank(b))
      .map(([name, each]) => this.fields.of(`${pointer}/blank/${name}`, each, name === "bore_radius_mm"));
    const children = [
      ...fieldsOf([...first, ...given.filter((name) => !parts.includes(name))]),
      ...body,
      ...fieldsOf([RELIEF, ...parts, DEVIATIONS]),
      ...(DEVIATIONS in all ? [this.tools[member]] : []),
      this.#folded(
        `More of the ${title.toLowerCase()}`,
        { data: { pointer: `${pointer}/more` } },
        fieldsOf(others.filter((name) => !given.includes(name))),
      ),
    ];
    return this.#section(title, pointer, children, false);
  }

  /**
   * A field that both gears have alike, or the button that makes it one again.
   *
   * @param {string} name
   * @param {Schema} gear
   */
  #alike(name, gear) {
    const schema = gear.properties?.[name] ?? {};
    const needed = (gear.required ?? []).includes(name);
    const locked = this.changes.isLocked(name);
    const both = MEMBERS.map((member) => `/pair/${member}/${name}`);
    const lock = button(locked ? "=" : "≠", () => this.#lock(name, !locked), {
      className: "lock",
      ariaLabel: `${schema.title}: the same for both gears`,
      aria: { pressed: String(locked) },
      title: locked
        ? "The same for both gears; press to give each its own"
        : "Each gear has its own; press to give both that of the driving gear",
    });
    if (!locked)
      return h(
        "div",
        { className: "field alike" },
        h(
          "div",
          { className: "row" },
          h("span", {}, schema.title),
          h("span", { className: "note" }, "with each gear"),
          lock,
        ),
      );
    const element = this.fields.of(both[0], schema, needed);
    element.classList.add("alike");
    element.querySelector(".row")?.append(lock);
    const field = this.fields.shown.get(both[0]);
    if (field) this.fields.shown.set(both[1], field);
    return element;
  }

  /**
   * @param {string} name
   * @param {boolean} locked
   */
  #lock(name, locked) {
    this.changes.lock(name, locked);
    this.renew();
  }

  /** Straight teeth or helical ones: one step, with the method that knows them. */
  #teeth() {
    const id = "field-teeth";
    const words = { straight: "straight", helical: "helical" };
    this.kindOfTeeth = h(
      "select",
      { id, on: { change: (event) => this.changes.follow(teeth(this.design, event.target.value), "mend") } },
      ...Object.entries(words).map(([value, name]) => h("option", { value }, name)),
    );
    return h(
      "div",
      { className: "field choice" },
      h(
        "div",
        { className: "row" },
        h(
          "label",
          {
            htmlFor: id,
            title:
              "Helical teeth are computed in three dimensions; the module and the pressure angle are those of the normal section then",
          },
          "Teeth",
        ),
        this.kindOfTeeth,
      ),
    );
  }

  /**
   * @param {string} title
   * @param {string} pointer
   * @param {HTMLElement[]} children
   * @param {boolean} open
   */
  #section(title, pointer, children, open) {
    const name = this.unfolded ? "" : "section";
    return this.#folded(
      title,
      { className: "group section", name, open: open || this.unfolded, data: { pointer } },
      children,
    );
  }

  /**
   * @param {string} title
   * @param {Properties<HTMLDetailsElement>} properties
   * @param {HTMLElement[]} children
   */
  #folded(title, properties, children) {
    const fields = h("div", { className: "fields" }, ...children);
    return h("details", { className: "group", ...properties }, h("summary", {}, title), fields);
  }
}

/** @type {(name: string) => number} */
const rank = (name) => ["bore_radius_mm", "holes"].indexOf(name) >>> 0;
