// @ts-check
// The form of a submission, made from the schema: every field with its unit, bounds, default and words.

import { button, h } from "../draw/dom.js";
import { numeric, put, read, write } from "../draw/inputs.js";
import { Beginnings } from "../state/beginnings.js";
import { at, HELIX } from "../state/design.js";
import { helix, intoPlane, intoSolid, isSolid, kindOfTeeth, needsThird, offers, teeth } from "../state/dimensions.js";
import { number, unit } from "../state/numbers.js";
import {
  help,
  insteadOf,
  kindOf,
  ofNamedMaterial,
  partOf,
  resolve,
  saidDefault,
  schemaAt,
  SUBMISSION,
} from "../state/schema.js";
import { chooseReading, inOtherUnit, parsed, readingsOf, stepped, turned, unreadable } from "../state/typed.js";
import { deviations } from "./deviations.js";
import { limitsTool, loadTool, materialTool } from "./limits.js";

/** @import { Properties } from "../draw/dom.js" */
/** @import { Cause, Design } from "../state/design.js" */
/** @import { Step } from "../state/dimensions.js" */
/** @import { FieldError, GearName, Limits, Results } from "../state/documents.js" */
/** @import { Api, Kind, Schema } from "../state/schema.js" */

/** Fields that a designer looks for first; they stand above the others of their object. */
const FIRST = ["holes", "tip_relief", "tooth_count", "profile_shift"];

/** Fields that both gears have to have alike: they stand once, with the pair, until they are unlocked. */
const ALIKE = ["module_mm", "pressure_angle_deg"];

/** What other lengths are given in multiples of, or number teeth by. */
const BASIC = ["module_mm", "pressure_angle_deg", "tooth_count"];

/** @type {GearName[]} */
const MEMBERS = ["driving", "driven"];

/**
 * A field of the form: `show` shows its value, `kind` is there where it takes a value of its own, and `described` is
 * what its words are called.
 *
 * @typedef {object} Field
 * @property {HTMLElement} element
 * @property {string} pointer
 * @property {Schema} schema
 * @property {() => void} show
 * @property {Kind | null} kind
 * @property {string | null} described
 */

/** @typedef {{ pointer: string, kind: Kind, title: string }} Offered */

/**
 * Fields of a gear that go with a change of another one: what is said of it, and their values.
 *
 * @typedef {Record<string, [words: string, value: unknown]>} Followed
 */

/** @typedef {Partial<Record<GearName, Record<string, number>>> & { helix?: number }} Last */

export class Form {
  /** @type {Map<string, Field>} */
  #fields = new Map();
  /**
   * The last module and number of teeth of each gear that were numbers: what is typed passes through none.
   *
   * @type {Last}
   */
  #last = {};
  /** @type {Set<string>} */
  #unlocked = new Set();

  /**
   * `notify` says what else a change has changed; `limits` are those of the service, and `results` the last that there
   * are.
   *
   * @param {HTMLElement} place
   * @param {Api} api
   * @param {Design} design
   * @param {{ notify: (words: string) => void, limits: Limits, results: () => Results | undefined }} page
   */
  constructor(place, api, design, { notify, limits, results }) {
    this.place = place;
    this.api = api;
    this.design = design;
    this.notify = notify;
    this.beginnings = new Beginnings(api, design, { limits, results });
    place.addEventListener("submit", (event) => event.preventDefault());
    // Made once: what they say stays while fields are made anew around them.
    this.tools = Object.fromEntries(MEMBERS.map((member) => [member, deviations(member, design)]));
    this.materials = new Map(MEMBERS.map((member) => [`/pair/${member}/material`, materialTool(member, design)]));
    this.ofPair = limitsTool(design);
    this.ofLoad = loadTool(design);
    this.render();
  }

  /**
   * @param {string} selector
   * @returns {NodeListOf<HTMLDetailsElement>}
   */
  #details(selector) {
    return this.place.querySelectorAll(selector);
  }

  /** Makes the form anew from the design, keeping the place of the cursor and what was open. */
  render() {
    const open = new Set([...this.#details("details[open]")].map((each) => each.dataset.pointer));
    const known = this.place.childElementCount > 0;
    const focused = document.activeElement?.id;
    this.#fields.clear();
    for (const name of ALIKE)
      if (new Set(MEMBERS.map((member) => this.design.get(`/pair/${member}/${name}`))).size > 1)
        this.#unlocked.add(name);
    const submission = kindOf(this.api, SUBMISSION);
    const { pair, method, output_torques_n_m: torques, ...rest } = submission.schema.properties ?? {};
    const members = resolve(this.api, pair).properties ?? {};
    const gear = resolve(this.api, members.driving);
    this.place.replaceChildren(
      this.#section(
        "Pair",
        "/pair",
        [
          this.#field("/pair/center_distance_mm", members.center_distance_mm, true),
          ...ALIKE.map((name) => this.#alike(name, gear)),
          this.#teeth(),
          ...Object.entries(members)
            .filter(([name]) => ![...MEMBERS, "center_distance_mm"].some((other) => other === name))
            .map(([name, schema]) => this.#field(`/pair/${name}`, schema, false)),
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
          this.#field("/output_torques_n_m", torques, true),
          this.ofLoad,
          this.#field("/method", method, true),
          ...Object.entries(rest).map(([name, schema]) => this.#field(`/${name}`, schema, false)),
        ],
        false,
      ),
    );
    for (const each of this.#details("details")) if (known) each.open = open.has(each.dataset.pointer);
    for (const member of MEMBERS) this.#remember(member);
    this.#showDimensions();
    if (focused && document.activeElement?.id !== focused) document.getElementById(focused)?.focus();
  }

  /** Shows the values of the design in the fields that are there; makes the form anew where other fields are needed. */
  refresh() {
    for (const member of MEMBERS) this.#remember(member);
    if (this.#shape() !== this.shape) return this.render();
    for (const { show } of this.#fields.values()) show();
    this.#showDimensions();
  }

  /**
   * Computes the pair in three dimensions, or in the plane without what has an extent along the axis; says what went
   * with it.
   *
   * @param {boolean} inSolid
   */
  compute(inSolid) {
    this.#follow(inSolid ? intoSolid(this.design) : intoPlane(this.design), "mend");
  }

  /**
   * Shows what is wrong at the fields. A section that is closed says so at its head: to open it would close the one
   * that is worked in.
   *
   * @param {FieldError[]} errors
   */
  showErrors(errors = []) {
    for (const field of this.#fields.values()) this.#clear(field);
    for (const each of this.place.querySelectorAll(".section.wrong")) each.classList.remove("wrong");
    for (const error of errors) {
      const field = this.#nearest(error.pointer);
      if (field) this.#mark(field, error);
    }
  }

  /**
   * Opens every section, or leaves one of them open at a time.
   *
   * @param {boolean} all
   */
  unfold(all) {
    this.unfolded = all;
    for (const section of this.#details(".section")) {
      section.name = all ? "" : "section";
      if (all) section.open = true;
    }
  }

  /**
   * What the field at a pointer is called.
   *
   * @param {string} pointer
   * @returns {string}
   */
  titleOf(pointer) {
    const place = pointer.replace(/\/\d+$/, "");
    return (this.#fields.get(place)?.schema ?? schemaAt(this.api, place))?.title ?? lastOf(place).replace(/_/g, " ");
  }

  /**
   * What the field at a pointer is called, and of which part and gear it is.
   *
   * @param {string} pointer
   */
  named(pointer) {
    const member = /^\/pair\/(driving|driven)\//.exec(pointer)?.[1];
    const place = /\/(\d+)\//.exec(pointer)?.[1];
    const title = this.titleOf(pointer);
    const details = [partOf(this.api, pointer, title), place ? String(Number(place) + 1) : ""].filter(Boolean);
    const words = title + details.map((each) => ` (${each})`).join("");
    return member && !this.#isAlike(pointer) ? `${words}, ${member} gear` : words;
  }

  /**
   * What the service says of fields by their pointers, in the words of the form.
   *
   * @param {string} detail
   */
  inWords(detail) {
    return detail
      .replace(
        /\/(?:pair|population|resolution|output_torques_n_m|force_table|dynamics|face_load)[\w/]*/g,
        (pointer) => `“${this.named(pointer)}”`,
      )
      .replace(
        /\b(three_dimensional_projected|three_dimensional|projected_decomposition|load_distribution)\b/g,
        (method) => method.replace(/_/g, " "),
      );
  }

  /**
   * The numbers, words and flags of the form: `{ pointer, title, kind }`.
   *
   * @returns {Offered[]}
   */
  fields() {
    // What both gears have alike cannot be changed by one field, and what stands in place of another not beside it.
    /** @type {(field: Field) => boolean} */
    const stands = ({ pointer }) => {
      const holder = pointer.slice(0, pointer.lastIndexOf("/") + 1);
      return (
        this.design.get(pointer) !== undefined ||
        !insteadOf(this.api, pointer).some((other) => this.design.get(holder + other) !== undefined)
      );
    };
    return [...this.#fields.values()].flatMap((field) => {
      const { pointer, kind } = field;
      const isOffered = kind && ["number", "choice", "flag"].includes(kind.kind) && !this.#isAlike(pointer);
      return isOffered && stands(field) ? [{ pointer, kind, title: this.titled(pointer) }] : [];
    });
  }

  /**
   * What the field at a pointer is called, with its gear and its unit.
   *
   * @param {string} pointer
   */
  titled(pointer) {
    const printed = this.unitOf(pointer);
    return `${this.named(pointer)}${printed ? ` (${printed})` : ""}`;
  }

  /** @param {string} pointer */
  unitOf(pointer) {
    const schema = this.#fields.get(pointer)?.schema ?? schemaAt(this.api, pointer);
    return unit(schema?.["x-unit"] ?? schema?.items?.["x-unit"]);
  }

  /**
   * Whether the field at a pointer stands for both gears.
   *
   * @param {string} pointer
   */
  #isAlike(pointer) {
    const name = lastOf(pointer);
    return ALIKE.includes(name) && !this.#unlocked.has(name);
  }

  /**
   * Brings the field of a pointer into view.
   *
   * @param {string} pointer
   */
  focus(pointer) {
    const field = this.#nearest(pointer);
    if (!field) return;
    for (const parent of around(field.element)) parent.open = true;
    /** @type {HTMLElement | null} */
    const input = field.element.querySelector("input, select, textarea");
    input?.scrollIntoView({ block: "center" });
    input?.focus({ preventScroll: true });
  }

  /**
   * @param {string} pointer
   * @returns {Field | null}
   */
  #nearest(pointer) {
    for (let place = pointer; place; place = place.slice(0, place.lastIndexOf("/"))) {
      const field = this.#fields.get(place);
      if (field) return field;
    }
    return null;
  }

  /** @param {Field} field */
  #clear({ element, described }) {
    element.classList.remove("wrong");
    for (const old of element.querySelectorAll(":scope > .field-error")) old.remove();
    for (const input of element.querySelectorAll(":scope > .row > [aria-invalid]")) {
      input.removeAttribute("aria-invalid");
      if (described) input.setAttribute("aria-describedby", described);
      else input.removeAttribute("aria-describedby");
    }
  }

  /**
   * @param {Field} field
   * @param {FieldError} error
   */
  #mark({ element, pointer, schema, described }, error) {
    const typed = this.design.get(error.pointer);
    const readings = typeof typed === "string" ? readingsOf(typed) : null;
    const other = inOtherUnit(typed, schema);
    const nearest = other?.value ?? error.nearest ?? null;
    const printed = unit(schema["x-unit"] ?? schema.items?.["x-unit"]);
    const meant = other ? `, which are ${number(typed, 8)} ${other.unit}` : "";
    const mends = (readings ?? (nearest === null ? [] : [nearest])).map((value, i) =>
      button(
        `Use ${number(value, 8)} ${printed}`.trim() + meant,
        () => {
          if (readings) chooseReading(i === 0);
          this.design.set(error.pointer, value, "mend");
        },
        { className: "mend" },
      ),
    );
    element.classList.add("wrong");
    const id = `error-${pointer}-${element.querySelectorAll(":scope > .field-error").length}`;
    element.append(
      h(
        "p",
        { className: "field-error", id },
        error.code === "wrong_type" && typeof typed === "string" ? unreadable(typed) : this.inWords(error.detail),
        ...mends.flatMap((mend) => [" ", mend]),
      ),
    );
    const input = element.querySelector(":scope > .row > input, :scope > .row > select, :scope > .row > textarea");
    input?.setAttribute("aria-invalid", "true");
    input?.setAttribute(
      "aria-describedby",
      [input.getAttribute("aria-describedby") ?? described, id].filter(Boolean).join(" "),
    );
    for (const parent of around(element)) {
      if (parent.classList.contains("section")) parent.classList.add("wrong");
      else parent.open = true;
    }
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
    const own = Object.fromEntries(
      Object.entries(all).filter(([name]) => !ALIKE.includes(name) || this.#unlocked.has(name)),
    );
    const inner = resolve(this.api, blank).properties ?? {};
    const names = [
      ...FIRST.filter((name) => name in own && name !== "tip_relief"),
      ...required.filter((name) => name in own && !FIRST.includes(name)),
    ];
    const shown = names.map((name) => this.#field(`${pointer}/${name}`, own[name], required.includes(name)));
    const body = Object.entries(inner)
      .sort(([a], [b]) => rank(a) - rank(b))
      .map(([name, each]) => this.#field(`${pointer}/blank/${name}`, each, name === "bore_radius_mm"));
    const relief = own.tip_relief ? [this.#field(`${pointer}/tip_relief`, own.tip_relief, false)] : [];
    const others = Object.keys(own).filter((name) => !names.includes(name) && name !== "tip_relief");
    // What the design gives, it shows: nothing that counts is folded away.
    /** @type {(name: string) => boolean} */
    const isGiven = (name) =>
      (this.design.get(`${pointer}/${name}`) ?? null) !== null &&
      JSON.stringify(this.design.get(`${pointer}/${name}`)) !== "[]";
    /** @type {(name: string) => HTMLElement} */
    const of = (name) => this.#field(`${pointer}/${name}`, own[name], false);
    const given = others.filter((name) => isGiven(name) && name !== "tooth_deviations");
    /** @type {(name: string) => boolean} */
    const isPart = (name) => typeof this.design.get(`${pointer}/${name}`) === "object";
    const more = this.#group(
      `More of the ${title.toLowerCase()}`,
      `${pointer}/more`,
      others.filter((name) => !given.includes(name) && name !== "tooth_deviations").map(of),
      false,
    );
    const teeth = own.tooth_deviations ? [of("tooth_deviations"), this.tools[member]] : [];
    return this.#section(
      title,
      pointer,
      [
        ...shown,
        ...given.filter((name) => !isPart(name)).map(of),
        ...body,
        ...relief,
        ...given.filter(isPart).map(of),
        ...teeth,
        more,
      ],
      false,
    );
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
    const locked = !this.#unlocked.has(name);
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
    const element = this.#field(both[0], schema, needed);
    element.classList.add("alike");
    element.querySelector(".row")?.append(lock);
    const field = this.#fields.get(both[0]);
    if (field) this.#fields.set(both[1], field);
    return element;
  }

  /**
   * @param {string} name
   * @param {boolean} locked
   */
  #lock(name, locked) {
    if (locked) {
      this.#unlocked.delete(name);
      this.design.set(`/pair/driven/${name}`, this.design.get(`/pair/driving/${name}`), "form");
    } else this.#unlocked.add(name);
    this.render();
  }

  /** Straight teeth or helical ones: one step, with the method that knows them. */
  #teeth() {
    const id = "field-teeth";
    const words = { straight: "straight", helical: "helical" };
    this.kindOfTeeth = h(
      "select",
      { id, on: { change: (event) => this.#follow(teeth(this.design, event.target.value), "mend") } },
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

  /** Fields that the method does not know are marked, and what was typed for another helix angle is offered anew. */
  #showDimensions() {
    if (this.kindOfTeeth) this.kindOfTeeth.value = kindOfTeeth(this.design.get(HELIX));
    this.place.dataset.dimensions = isSolid(this.design.get("/method")) ? "3" : "2";
    for (const old of this.place.querySelectorAll(".field-offer")) old.remove();
    for (const { pointer, value, angle } of offers(this.design)) {
      const words = `Typed for a helix angle of ${number(angle)}°; ${number(value, 7)} mm has the same teeth at ${number(this.design.get(HELIX) ?? 0)}°. `;
      /** @type {(name: string, work: () => void) => HTMLButtonElement} */
      const mend = (name, work) => button(name, work, { className: "mend" });
      this.#nearest(pointer)?.element.append(
        h(
          "p",
          { className: "field-offer", role: "status" },
          words,
          mend(`Use ${number(value, 7)} mm`, () => this.design.set(pointer, value, "mend")),
          " ",
          mend("Keep what was typed", () => this.design.confirm(pointer)),
        ),
      );
    }
  }

  /**
   * Makes changes that belong together, and says what they are.
   *
   * @param {Step} step
   * @param {Cause} by
   */
  #follow({ changes, told }, by) {
    this.design.setAll(changes, by, [HELIX]);
    this.#remember("driving");
    if (told.length) this.notify(`${told.join(". ")}.`);
  }

  /**
   * @param {string} title
   * @param {string} pointer
   * @param {HTMLElement[]} children
   * @param {boolean} open
   */
  #section(title, pointer, children, open) {
    return h(
      "details",
      {
        className: "group section",
        name: this.unfolded ? "" : "section",
        open: open || this.unfolded,
        data: { pointer },
      },
      h("summary", {}, title),
      h("div", { className: "fields" }, ...children),
    );
  }

  /**
   * @param {string} title
   * @param {string} pointer
   * @param {HTMLElement[]} children
   * @param {boolean} open
   */
  #group(title, pointer, children, open) {
    return h(
      "details",
      { className: "group", open, data: { pointer } },
      h("summary", {}, title),
      h("div", { className: "fields" }, ...children),
    );
  }

  /**
   * @param {string} pointer
   * @param {Schema} given
   * @param {boolean} needed
   * @returns {HTMLElement}
   */
  #field(pointer, given, needed) {
    const kind = kindOf(this.api, given);
    const element =
      kind.kind === "object"
        ? this.#object(pointer, kind, needed)
        : kind.kind === "variants"
          ? this.#variants(pointer, kind)
          : kind.kind === "list"
            ? this.#list(pointer, kind)
            : this.#input(pointer, kind, needed);
    if (needsThird(pointer)) element.classList.add("needs-third");
    this.shape = this.#shape();
    return element;
  }

  /** What decides which fields there are: which objects, variants and list entries the design has. */
  #shape() {
    /** @type {(value: unknown) => value is object} */
    const isNested = (value) => value !== null && typeof value === "object";
    /**
     * @param {unknown} value
     * @returns {unknown}
     */
    const shape = (value) => {
      if (Array.isArray(value)) return isNested(value[0]) ? value.map(shape) : 0;
      if (!isNested(value)) return 0;
      const nested = Object.entries(value).filter(([, each]) => isNested(each));
      return Object.fromEntries([
        ...nested.map(([name, each]) => [name, Object.keys(each).length && shape(each)]),
        ...variantOf(value),
      ]);
    };
    return JSON.stringify(shape(this.design.submission));
  }

  /**
   * @template {HTMLElement} E
   * @param {string} pointer
   * @param {E} element
   * @param {Schema} schema
   * @param {() => void} show
   * @param {Kind | null} kind
   * @param {string | null} described
   */
  #register(pointer, element, schema, show, kind = null, described = null) {
    this.#fields.set(pointer, { element, pointer, schema, show, kind, described });
    show();
    return element;
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   * @param {boolean} needed
   */
  #input(pointer, kind, needed) {
    const { schema } = kind;
    const id = `field-${pointer}`;
    const input = this.#control(kind, id, pointer);
    const said = help(schema);
    const label = h("label", { htmlFor: id, title: said }, schema.title ?? lastOf(pointer));
    if (kind.kind === "number") this.#scrub(label, pointer, kind);
    const printed = unit(schema["x-unit"] ?? kind.items?.schema?.["x-unit"]);
    const words = said ? h("p", { className: "help", id: `help-${pointer}`, hidden: true }, said, bounds(kind)) : null;
    if (words) input.setAttribute("aria-describedby", words.id);
    const more = words
      ? button("?", (event) => toggle(event.currentTarget, words), {
          className: "about",
          tabIndex: -1,
          title: "What this is; in the field, the key ?",
          ariaLabel: `About ${label.textContent}`,
          aria: { expanded: "false", controls: words.id },
        })
      : null;
    // A value that has a default is marked as given, and goes back to it: by a button, or by the choice that it is.
    const clear =
      needed || ["flag", "choice"].includes(kind.kind)
        ? null
        : button(
            "×",
            () => (pointer === HELIX ? this.#putHelix(undefined, "mend") : this.design.set(pointer, undefined, "mend")),
            {
              className: "clear",
              hidden: true,
              ariaLabel: `${label.textContent}: back to the default`,
              title: "Given; press for the default",
            },
          );
    const element = h(
      "div",
      { className: `field ${kind.kind}` },
      h("div", { className: "row" }, label, input, h("span", { className: "unit" }, printed), more, clear),
      words,
    );
    // Tab goes from number to number; their words are a key away, where no text is typed.
    if (more && !["text", "texts", "json"].includes(kind.kind))
      input.addEventListener("keydown", (event) => {
        if (!(event instanceof KeyboardEvent) || event.key !== "?") return;
        event.preventDefault();
        more.click();
      });
    return this.#register(
      pointer,
      element,
      schema,
      () => {
        if (!needed && "placeholder" in input) {
          const modules =
            (schema["x-default-modules"] ?? NaN) *
            this.design.get(`${pointer.slice(0, pointer.lastIndexOf("/"))}/module_mm`);
          const usual = ofNamedMaterial(this.design.submission, pointer) ?? schema.default;
          input.placeholder =
            usual !== undefined && usual !== null
              ? String(usual)
              : modules > 0
                ? number(modules, 5)
                : saidDefault(schema);
          input.title = input.placeholder === "0" ? "" : saidDefault(schema);
        }
        const value = this.design.get(pointer);
        if (document.activeElement !== input || this.design.by !== "form") write(input, kind, value);
        const given = !needed && value !== undefined && value !== null && value !== schema.default;
        element.classList.toggle("given", given);
        if (clear) clear.hidden = !given;
      },
      kind,
      words?.id ?? null,
    );
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

  /**
   * Sets a field and `further` ones, and takes away what it stands in place of.
   *
   * @param {string} pointer
   * @param {unknown} value
   * @returns {void}
   */
  #put(pointer, value, further = {}) {
    const basic = this.#basic(pointer);
    if (basic) return this.#putBasic(basic.members, basic.name, value);
    if (pointer === HELIX) return this.#putHelix(value, "form");
    if (pointer.endsWith("/material/name")) return this.#putMaterial(pointer, value);
    if (pointer === "/method" && isSolid(String(value)) && !isSolid(this.design.get("/method"))) {
      const { changes, told } = intoSolid(this.design);
      return this.#follow({ changes: { ...changes, [pointer]: value }, told: told.slice(1) }, "mend");
    }
    this.design.setAll(
      { [pointer]: value, ...further, ...(value === undefined ? {} : this.#displaced(pointer)) },
      "form",
    );
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
    return { name, members: this.#isAlike(pointer) ? MEMBERS : [member] };
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
    this.#follow(helix(this.design, value ?? 0, this.#last.helix), by);
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
      const title = this.titleOf(`${pointer}/${field}`);
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
   * @param {Kind} kind
   * @param {string} id
   * @param {string} pointer
   */
  #control(kind, id, pointer) {
    const { schema } = kind;
    /** @type {(value: unknown) => void} */
    const put = (value) => this.#put(pointer, value);
    if (kind.kind === "choice") {
      const options = (schema.enum ?? []).map((word) =>
        word === null
          ? h("option", { value: "" }, saidDefault(schema))
          : h("option", { value: word }, String(word).replace(/_/g, " ")),
      );
      return h("select", { id, on: { change: (event) => put(event.target.value || undefined) } }, ...options);
    }
    if (kind.kind === "flag")
      return h("input", { id, type: "checkbox", on: { change: (event) => put(event.target.checked) } });
    if (kind.kind === "json")
      return h("textarea", {
        id,
        rows: 2,
        spellcheck: false,
        on: { change: (event) => put(parsed(event.target.value)) },
      });
    /** @type {Properties<HTMLInputElement>} */
    const properties = { id, spellcheck: false, on: { input: (event) => put(read(event.target, kind)) } };
    if (kind.kind !== "number") return h("input", { type: "text", ...properties });
    const input = numeric(properties);
    input.addEventListener("keydown", (event) => this.#step(event, pointer, kind));
    return input;
  }

  /**
   * Arrow keys turn the last digit of a number, and with Shift the one before.
   *
   * @param {KeyboardEvent} event
   * @param {string} pointer
   * @param {Kind} kind
   */
  #step(event, pointer, kind) {
    const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    const value = this.design.get(pointer) ?? kind.schema.default;
    const input = event.target;
    if (!sign || typeof value !== "number" || !(input instanceof HTMLInputElement)) return;
    event.preventDefault();
    const text = turned(input.value, value, sign * (event.shiftKey ? 10 : 1), kind);
    this.#turn(pointer, Number(text));
    // A zero at its end is the digit that is turned next.
    put(input, text);
  }

  /**
   * Sets a number as a hand does.
   *
   * @param {string} pointer
   * @param {number} value
   */
  #turn(pointer, value) {
    const basic = this.#basic(pointer);
    if (basic) this.#putBasic(basic.members, basic.name, value, "drag");
    else if (pointer === HELIX) this.#putHelix(value, "drag");
    else this.design.set(pointer, value, "drag");
  }

  /**
   * The name of a number is dragged sideways to change it.
   *
   * @param {HTMLElement} label
   * @param {string} pointer
   * @param {Kind} kind
   */
  #scrub(label, pointer, kind) {
    label.classList.add("scrub");
    label.addEventListener("pointerdown", (event) => {
      const value = this.design.get(pointer) ?? kind.schema.default;
      if (event.button !== 0 || typeof value !== "number") return;
      let begun = false;
      /** @type {(moved: PointerEvent) => void} */
      const move = (moved) => {
        const by = Math.round((moved.clientX - event.clientX) / 4);
        if (!begun && Math.abs(by) < 1) return;
        if (!begun) this.design.hold();
        begun = true;
        this.#turn(pointer, stepped(value, by, kind));
      };
      label.setPointerCapture(event.pointerId);
      label.addEventListener("pointermove", move);
      const end = () => {
        label.removeEventListener("pointermove", move);
        if (begun) this.design.release();
      };
      for (const name of ["pointerup", "pointercancel"]) label.addEventListener(name, end, { once: true });
    });
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   * @param {boolean} needed
   */
  #object(pointer, kind, needed) {
    const { properties = {}, required = [] } = kind.schema;
    const title = (kind.schema.title ?? "").replace(/ request$/, "");
    const there = at(this.design.submission, pointer) ?? null;
    const open = needed || !kind.optional || there !== null;
    const fields = open
      ? Object.entries(properties).map(([name, schema]) =>
          this.#field(`${pointer}/${name}`, schema, required.includes(name)),
        )
      : [];
    const tool = this.materials.get(pointer);
    return this.#fieldset(pointer, kind, title, tool ? [...fields, tool] : fields, kind.optional && !needed);
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   * @param {string} title
   * @param {HTMLElement[]} fields
   * @param {boolean} optional
   */
  #fieldset(pointer, kind, title, fields, optional) {
    const said = help(kind.schema);
    const box = h("input", {
      type: "checkbox",
      id: `field-${pointer}`,
      on: { change: (event) => (event.target.checked ? this.begin(pointer, kind) : this.#takeAway(pointer)) },
    });
    const legend = optional
      ? h("legend", {}, h("label", { title: said }, box, ` ${title}`))
      : h("legend", { title: said }, title);
    const element = h("fieldset", { className: "field" }, legend, ...fields);
    return this.#register(pointer, element, kind.schema, () => {
      box.checked = (at(this.design.submission, pointer) ?? null) !== null;
    });
  }

  /**
   * Puts an object into the design that is not there yet, with what it begins with.
   *
   * @param {string} pointer
   * @param {Kind | null} kind
   */
  begin(pointer, kind = null) {
    const { [pointer]: value, ...others } = this.beginnings.values(pointer, kind);
    this.#put(pointer, value, others);
  }

  /**
   * Takes an object away; holes that are no slots any more are round, and as wide.
   *
   * @param {string} pointer
   */
  #takeAway(pointer) {
    const { width_mm: width } = this.design.get(pointer) ?? {};
    const round = pointer.endsWith("/slot") && width ? { [pointer.replace(/slot$/, "radius_mm")]: width / 2 } : {};
    this.design.setAll({ [pointer]: undefined, ...round }, "form");
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   */
  #variants(pointer, kind) {
    const { variants = [] } = kind;
    const value = this.design.get(pointer);
    const index = value === undefined || value === null ? -1 : variants.findIndex((variant) => fits(variant, value));
    const none =
      kind.optional || kind.schema.default !== undefined
        ? [h("option", { value: "" }, pointer.endsWith("/holes") ? "none" : "default")]
        : [];
    const options = variants.map((variant, i) =>
      h(
        "option",
        { value: i },
        (variant.title ?? `variant ${i + 1}`)
          .replace(/^Holes$/, "one pattern")
          .replace(/ of holes$| modification$/, ""),
      ),
    );
    const id = `field-${pointer}`;
    /** @type {(place: string) => unknown} */
    const choose = (place) =>
      place === "" ? undefined : this.beginnings.variant(pointer, kindOf(this.api, variants[Number(place)]));
    const select = h(
      "select",
      { id, on: { change: (event) => this.design.set(pointer, choose(event.target.value), "mend") } },
      ...none,
      ...options,
    );
    const chosen = variants[index];
    const inner = chosen ? kindOf(this.api, chosen) : null;
    const fields =
      inner?.kind === "object"
        ? Object.entries(inner.schema.properties ?? {})
            .filter(([, { enum: words }]) => words?.length !== 1)
            .map(([name, schema]) =>
              this.#field(`${pointer}/${name}`, schema, (inner.schema.required ?? []).includes(name)),
            )
        : inner?.kind === "list"
          ? [this.#list(pointer, inner)]
          : [];
    const element = h(
      "div",
      { className: "field variants" },
      h(
        "div",
        { className: "row" },
        h("label", { htmlFor: id, title: help(kind.schema) }, kind.schema.title),
        select,
        h("span", { className: "unit" }),
      ),
      ...fields,
    );
    return this.#register(pointer, element, kind.schema, () => {
      select.value = index < 0 ? "" : String(index);
    });
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   */
  #list(pointer, kind) {
    /** @type {unknown[]} */
    const values = this.design.get(pointer) ?? [];
    const entries = values.map((_, i) =>
      h(
        "div",
        { className: "entry-of-list" },
        this.#field(`${pointer}/${i}`, kind.items?.schema ?? {}, true),
        button("Remove", () => this.design.set(`${pointer}/${i}`, undefined, "mend")),
      ),
    );
    // The list as it is then: its entries may have changed since they were drawn.
    const further = () => {
      const now = this.design.get(pointer) ?? [];
      this.design.set(pointer, [...now, this.beginnings.further(pointer, kind, now)], "mend");
    };
    const add = button(`Add to ${(kind.schema.title ?? "the list").toLowerCase()}`, further);
    const element = h(
      "fieldset",
      { className: "field list" },
      h("legend", { title: help(kind.schema) }, kind.schema.title ?? ""),
      ...entries,
      add,
    );
    return this.#fields.has(pointer) ? element : this.#register(pointer, element, kind.schema, () => {});
  }
}

/** @type {(pointer: string) => string} */
const lastOf = (pointer) => pointer.slice(pointer.lastIndexOf("/") + 1);

/**
 * What an element is folded away in.
 *
 * @type {(element: HTMLElement) => HTMLDetailsElement[]}
 */
function around(element) {
  const parent = element.closest("details");
  return parent ? [parent, ...(parent.parentElement ? around(parent.parentElement) : [])] : [];
}

/** @type {(name: string) => number} */
const rank = (name) => ["bore_radius_mm", "holes"].indexOf(name) >>> 0;

/**
 * What tells a document that is one of several from the others: its kind, or its only key.
 *
 * @type {(value: object) => [string, unknown][]}
 */
function variantOf(value) {
  const keys = Object.keys(value);
  return "kind" in value ? [["kind", value.kind]] : keys.length === 1 ? [["only", keys[0]]] : [];
}

/**
 * @param {Schema} variant
 * @param {any} value that of the field
 */
function fits(variant, value) {
  if (variant.enum) return variant.enum.includes(value);
  if (variant.type === "array") return Array.isArray(value);
  if (variant.type === "number") return typeof value === "number";
  /** @type {(field: [string, Schema]) => boolean} */
  const word = ([name, schema]) => schema.enum?.length !== 1 || value[name] === schema.enum[0];
  return (
    typeof value === "object" &&
    !Array.isArray(value) &&
    (variant.required ?? []).every((name) => name in value) &&
    Object.entries(variant.properties ?? {}).every(word)
  );
}

/** @type {(kind: Kind) => string} */
function bounds({ kind, schema }) {
  if (kind !== "number" || schema.minimum === undefined) return "";
  return ` From ${number(schema.minimum)} to ${number(schema.maximum)} ${unit(schema["x-unit"])}.`;
}

/** @type {(button: HTMLElement, words: HTMLElement) => void} */
function toggle(button, words) {
  words.hidden = !words.hidden;
  button.setAttribute("aria-expanded", String(!words.hidden));
}
