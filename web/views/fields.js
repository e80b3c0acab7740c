// @ts-check
// Fields by their schema: a control for a value, a box for an object, a choice for one of several, entries for a list.

import { button, h, toggle } from "../draw/dom.js";
import { numeric, read, write } from "../draw/inputs.js";
import { at } from "../state/design.js";
import { needsThird } from "../state/dimensions.js";
import { number, unit } from "../state/numbers.js";
import { fits, help, kindOf, lastOf, ofNamedMaterial, saidDefault } from "../state/schema.js";
import { parsed } from "../state/typed.js";
import { turnByKey, turnByName } from "./turned.js";

/** @import { Properties } from "../draw/dom.js" */
/** @import { Beginnings } from "../state/beginnings.js" */
/** @import { Changes } from "../state/changes.js" */
/** @import { Design } from "../state/design.js" */
/** @import { Api, Kind, Schema } from "../state/schema.js" */

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

/** A choice of so many letters stands beside its name. */
const LONGEST_BESIDE = 16;

export class Fields {
  /**
   * The fields that are shown.
   *
   * @type {Map<string, Field>}
   */
  shown = new Map();

  /**
   * `tools` stand at the end of the objects that they are of, by the pointers of these.
   *
   * @param {Api} api
   * @param {Design} design
   * @param {{ changes: Changes, beginnings: Beginnings, tools: Map<string, HTMLElement> }} with
   */
  constructor(api, design, { changes, beginnings, tools }) {
    this.api = api;
    this.design = design;
    this.changes = changes;
    this.beginnings = beginnings;
    this.tools = tools;
  }

  /**
   * The field at a pointer, or else the one that it is in.
   *
   * @param {string} pointer
   * @returns {Field | null}
   */
  nearest(pointer) {
    for (let place = pointer; place; place = place.slice(0, place.lastIndexOf("/"))) {
      const field = this.shown.get(place);
      if (field) return field;
    }
    return null;
  }

  /**
   * A field with what is in it.
   *
   * @param {string} pointer
   * @param {Schema} given
   * @param {boolean} needed
   * @returns {HTMLElement}
   */
  of(pointer, given, needed) {
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
    return element;
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
    this.shown.set(pointer, { element, pointer, schema, show, kind, described });
    show();
    return element;
  }

  /**
   * A value with its name, its unit, its words and the way back to its default.
   *
   * @param {string} pointer
   * @param {Kind} kind
   * @param {boolean} needed
   */
  #input(pointer, kind, needed) {
    const { schema } = kind;
    const id = `field-${pointer}`;
    const input = this.#control(kind, id, pointer);
    const said = help(schema);
    const name = schema.title ?? lastOf(pointer);
    const label = h("label", { htmlFor: id, title: said }, name);
    if (kind.kind === "number") turnByName(label, pointer, kind, this.changes);
    const words = said ? h("p", { className: "help", id: `help-${pointer}`, hidden: true }, said, bounds(kind)) : null;
    // A value that has a default is marked as given, and goes back to it: by a button, or by the choice that it is.
    const clear = needed || ["flag", "choice"].includes(kind.kind) ? null : this.#clear(pointer, name);
    const printed = h("span", { className: "unit" }, unit(schema["x-unit"] ?? kind.items?.schema?.["x-unit"]));
    const row = h(
      "div",
      { className: "row" },
      label,
      input,
      printed,
      words && aboutOf(input, kind, name, words),
      clear,
    );
    const element = h("div", { className: `field ${kind.kind}${isLong(input) ? " long" : ""}` }, row, words);
    const show = () => {
      if (!needed && "placeholder" in input) {
        input.placeholder = this.#usual(pointer, schema);
        input.title = input.placeholder === "0" ? "" : saidDefault(schema);
      }
      const value = this.design.get(pointer);
      if (document.activeElement !== input || this.design.by !== "form") write(input, kind, value);
      const given = !needed && value !== undefined && value !== null && value !== schema.default;
      element.classList.toggle("given", given);
      if (clear) clear.hidden = !given;
    };
    return this.#register(pointer, element, schema, show, kind, words?.id ?? null);
  }

  /**
   * The button that gives a field its default.
   *
   * @param {string} pointer
   * @param {string} name
   */
  #clear(pointer, name) {
    return button("×", () => this.changes.reset(pointer), {
      className: "clear",
      hidden: true,
      ariaLabel: `${name}: back to the default`,
      title: "Given; press for the default",
    });
  }

  /**
   * What stands in an empty control: the value that the field has then, or words for it.
   *
   * @param {string} pointer
   * @param {Schema} schema
   */
  #usual(pointer, schema) {
    const usual = ofNamedMaterial(this.design.submission, pointer) ?? schema.default ?? null;
    if (usual !== null) return String(usual);
    const module = this.design.get(`${pointer.slice(0, pointer.lastIndexOf("/"))}/module_mm`);
    const modules = (schema["x-default-modules"] ?? NaN) * module;
    return modules > 0 ? number(modules, 5) : saidDefault(schema);
  }

  /**
   * @param {Kind} kind
   * @param {string} id
   * @param {string} pointer
   */
  #control(kind, id, pointer) {
    const { schema } = kind;
    /** @type {(value: unknown) => void} */
    const put = (value) => this.changes.put(pointer, value);
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
    input.addEventListener("keydown", (event) => turnByKey(event, pointer, kind, this.changes));
    return input;
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
          this.of(`${pointer}/${name}`, schema, required.includes(name)),
        )
      : [];
    const tool = this.tools.get(pointer);
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
      on: { change: (event) => (event.target.checked ? this.begin(pointer, kind) : this.changes.takeAway(pointer)) },
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
    this.changes.put(pointer, value, others);
  }

  /**
   * @param {string} pointer
   * @param {Kind} kind
   */
  #variants(pointer, kind) {
    const { variants = [], schema } = kind;
    const value = this.design.get(pointer) ?? null;
    const index = value === null ? -1 : variants.findIndex((variant) => fits(variant, value));
    const isLeft = kind.optional || schema.default !== undefined;
    const none = isLeft ? [h("option", { value: "" }, pointer.endsWith("/holes") ? "none" : "default")] : [];
    const options = variants.map(({ title }, i) => h("option", { value: i }, wordOf(title ?? `variant ${i + 1}`)));
    const id = `field-${pointer}`;
    /** @type {(place: string) => unknown} */
    const valueAt = (place) =>
      place === "" ? undefined : this.beginnings.variant(pointer, kindOf(this.api, variants[Number(place)]));
    const choose = (/** @type {{ target: HTMLSelectElement }} */ { target }) =>
      this.design.set(pointer, valueAt(target.value), "mend");
    const select = h("select", { id, on: { change: choose } }, ...none, ...options);
    const label = h("label", { htmlFor: id, title: help(schema) }, schema.title);
    const row = h("div", { className: "row" }, label, select, h("span", { className: "unit" }));
    const fields = index < 0 ? [] : this.#within(pointer, kindOf(this.api, variants[index]));
    const element = h("div", { className: `field variants${isLong(select) ? " long" : ""}` }, row, ...fields);
    return this.#register(pointer, element, schema, () => {
      select.value = index < 0 ? "" : String(index);
    });
  }

  /**
   * The fields of the variant that a design has.
   *
   * @param {string} pointer
   * @param {Kind} variant
   */
  #within(pointer, variant) {
    if (variant.kind === "list") return [this.#list(pointer, variant)];
    if (variant.kind !== "object") return [];
    const { properties = {}, required = [] } = variant.schema;
    // A field of one word tells the variants apart.
    return Object.entries(properties)
      .filter(([, { enum: words }]) => words?.length !== 1)
      .map(([name, schema]) => this.of(`${pointer}/${name}`, schema, required.includes(name)));
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
        this.of(`${pointer}/${i}`, kind.items?.schema ?? {}, true),
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
    return this.shown.has(pointer) ? element : this.#register(pointer, element, kind.schema, () => {});
  }
}

/**
 * The button that shows the words of a field; the key ? does too, where no text is typed.
 *
 * @param {HTMLElement} input
 * @param {Kind} kind
 * @param {string} name
 * @param {HTMLElement} words
 */
function aboutOf(input, { kind }, name, words) {
  input.setAttribute("aria-describedby", words.id);
  const about = button("?", (event) => toggle(event.currentTarget, words), {
    className: "about",
    // Tab goes from number to number.
    tabIndex: -1,
    title: "What this is; in the field, the key ?",
    ariaLabel: `About ${name}`,
    aria: { expanded: "false", controls: words.id },
  });
  if (!["text", "texts", "json"].includes(kind))
    input.addEventListener("keydown", (event) => {
      if (event.key !== "?") return;
      event.preventDefault();
      about.click();
    });
  return about;
}

/**
 * Whether what is chosen needs a line of its own to be read in full.
 *
 * @type {(input: HTMLElement) => boolean}
 */
const isLong = (input) =>
  input instanceof HTMLSelectElement && [...input.options].some(({ text }) => text.length > LONGEST_BESIDE);

/**
 * The title of a variant as one choice of several.
 *
 * @type {(title: string) => string}
 */
const wordOf = (title) => title.replace(/^Holes$/, "one pattern").replace(/ of holes$| modification$/, "");

/**
 * What decides which fields there are: which objects, variants and list entries a design has.
 *
 * @type {(submission: object) => string}
 */
export function shapeOf(submission) {
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
  return JSON.stringify(shape(submission));
}

/**
 * What tells a document that is one of several from the others: its kind, or its only key.
 *
 * @type {(value: object) => [string, unknown][]}
 */
function variantOf(value) {
  const keys = Object.keys(value);
  return "kind" in value ? [["kind", value.kind]] : keys.length === 1 ? [["only", keys[0]]] : [];
}

/** @type {(kind: Kind) => string} */
function bounds({ kind, schema }) {
  if (kind !== "number" || schema.minimum === undefined) return "";
  return ` From ${number(schema.minimum)} to ${number(schema.maximum)} ${unit(schema["x-unit"])}.`;
}
