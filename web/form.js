// The form of a submission, made from the schema: every field with its unit, bounds, default and words.

import { Beginnings } from "./beginnings.js";
import { at } from "./design.js";
import { h, number, unit } from "./dom.js";
import { parsed, read, stepped, write } from "./inputs.js";
import { help, kindOf, resolve, saidDefault } from "./schema.js";

/** Fields that a designer looks for first; they stand above the others of their object. */
const FIRST = ["holes", "tip_relief", "tooth_count", "module_mm"];

/** Fields that stand in place of each other: one that gets a value takes those of the others away. */
const INSTEAD = {
  radius_mm: ["slot"], slot: ["radius_mm"], at_deg: ["count", "phase_deg"], count: ["at_deg"], phase_deg: ["at_deg"],
  tip_diameter_mm: ["addendum_mm"], addendum_mm: ["tip_diameter_mm"], tip_rounding_mm: ["tip_chamfer_mm"], tip_chamfer_mm: ["tip_rounding_mm"],
};

export class Form {
  #fields = new Map();

  constructor(place, api, design) {
    Object.assign(this, { place, api, design, beginnings: new Beginnings(api, design) });
    place.addEventListener("submit", (event) => event.preventDefault());
    this.render();
  }

  /** Makes the form anew from the design, keeping the place of the cursor and what was open. */
  render() {
    const open = new Set([...this.place.querySelectorAll("details[open]")].map((each) => each.dataset.pointer));
    const known = this.place.childElementCount > 0;
    const focused = document.activeElement?.id;
    this.#fields.clear();
    const submission = kindOf(this.api, { $ref: "#/components/schemas/Submission" });
    const { pair, method, output_torques_n_m: torques, ...rest } = submission.schema.properties;
    const members = resolve(this.api, pair).properties;
    this.place.replaceChildren(
      this.#field("/output_torques_n_m", torques, true),
      this.#field("/method", method, true),
      this.#field("/pair/center_distance_mm", members.center_distance_mm, true),
      this.#gear("driving", members.driving),
      this.#gear("driven", members.driven),
      this.#group("More", "/", Object.entries(rest).map(([name, schema]) => this.#field(`/${name}`, schema, false)), false),
    );
    for (const each of this.place.querySelectorAll("details")) if (known) each.open = open.has(each.dataset.pointer);
    if (focused && document.activeElement?.id !== focused) document.getElementById(focused)?.focus();
  }

  /** Shows the values of the design in the fields that are there; makes the form anew where other fields are needed. */
  refresh() {
    if (this.#shape() !== this.shape) return this.render();
    for (const { show } of this.#fields.values()) show();
  }

  /** Shows what is wrong at the fields; gives back the errors whose field is not in the form. */
  showErrors(errors = []) {
    for (const { element } of this.#fields.values()) this.#clear(element);
    return errors.filter((error) => {
      const field = this.#nearest(error.pointer);
      if (!field) return true;
      this.#mark(field, error);
      return false;
    });
  }

  /** Brings the field of a pointer into view. */
  focus(pointer) {
    const field = this.#nearest(pointer);
    if (!field) return;
    for (let parent = field.element.closest("details"); parent; parent = parent.parentElement?.closest("details")) parent.open = true;
    const input = field.element.querySelector("input, select, textarea");
    input?.scrollIntoView({ block: "center" });
    input?.focus({ preventScroll: true });
  }

  #nearest(pointer) {
    for (let place = pointer; place; place = place.slice(0, place.lastIndexOf("/"))) {
      if (this.#fields.has(place)) return this.#fields.get(place);
    }
    return null;
  }

  #clear(element) {
    element.classList.remove("wrong");
    for (const old of element.querySelectorAll(":scope > .field-error")) old.remove();
    for (const input of element.querySelectorAll(":scope > .row > [aria-invalid]")) input.removeAttribute("aria-invalid");
  }

  #mark({ element, pointer, schema }, error) {
    const mend = error.nearest === null || error.nearest === undefined ? null
      : h("button", { type: "button", className: "mend", on: { click: () => this.design.set(error.pointer, error.nearest, "mend") } }, `Use ${number(error.nearest, 8)} ${unit(schema["x-unit"] ?? schema.items?.["x-unit"])}`.trim());
    element.classList.add("wrong");
    element.append(h("p", { className: "field-error", id: `error-${pointer}` }, error.detail, " ", mend));
    const input = element.querySelector(":scope > .row > input, :scope > .row > select, :scope > .row > textarea");
    input?.setAttribute("aria-invalid", "true");
    for (let parent = element.closest("details"); parent; parent = parent.parentElement?.closest("details")) parent.open = true;
  }

  #gear(member, schema) {
    const pointer = `/pair/${member}`;
    const title = member === "driving" ? "Driving gear" : "Driven gear";
    const { properties, required = [] } = resolve(this.api, schema);
    const { blank, ...own } = properties;
    const inner = resolve(this.api, blank).properties;
    const names = [...FIRST.filter((name) => name in own && name !== "tip_relief"), ...required.filter((name) => name in own && !FIRST.includes(name))];
    const shown = names.map((name) => this.#field(`${pointer}/${name}`, own[name], true));
    const body = Object.entries(inner).sort(([a], [b]) => rank(a) - rank(b)).map(([name, each]) => this.#field(`${pointer}/blank/${name}`, each, name === "bore_radius_mm"));
    const relief = own.tip_relief ? [this.#field(`${pointer}/tip_relief`, own.tip_relief, false)] : [];
    const others = Object.keys(own).filter((name) => !names.includes(name) && name !== "tip_relief");
    const more = this.#group(`More of the ${title.toLowerCase()}`, `${pointer}/more`, others.map((name) => this.#field(`${pointer}/${name}`, own[name], false)), false);
    return this.#group(title, pointer, [...shown, ...body, ...relief, more], true);
  }

  #group(title, pointer, children, open) {
    return h("details", { className: "group", open, data: { pointer } }, h("summary", {}, title), h("div", { className: "fields" }, ...children));
  }

  #field(pointer, given, needed) {
    const kind = kindOf(this.api, given);
    const make = { object: "#object", variants: "#variants", list: "#list" }[kind.kind];
    const element = make === "#object" ? this.#object(pointer, kind, needed) : make === "#variants" ? this.#variants(pointer, kind, needed) : make === "#list" ? this.#list(pointer, kind) : this.#input(pointer, kind, needed);
    this.shape = this.#shape();
    return element;
  }

  /** What decides which fields there are: which objects, variants and list entries the design has. */
  #shape() {
    const isNested = (value) => value && typeof value === "object";
    const shape = (value) => {
      if (Array.isArray(value)) return isNested(value[0]) ? value.map(shape) : 0;
      if (!isNested(value)) return 0;
      const nested = Object.entries(value).filter(([, each]) => isNested(each));
      return Object.fromEntries([...nested.map(([name, each]) => [name, Object.keys(each).length && shape(each)]), ...variantOf(value)]);
    };
    return JSON.stringify(shape(this.design.submission));
  }

  #register(pointer, element, schema, show) {
    this.#fields.set(pointer, { element, pointer, schema, show });
    show();
    return element;
  }

  #input(pointer, kind, needed) {
    const { schema } = kind;
    const id = `field-${pointer}`;
    const input = this.#control(kind, id, pointer);
    const said = help(schema);
    const label = h("label", { htmlFor: id, title: said }, schema.title ?? pointer.split("/").pop());
    if (kind.kind === "number") this.#scrub(label, pointer, kind);
    const printed = unit(schema["x-unit"] ?? kind.items?.schema?.["x-unit"]);
    const words = said ? h("p", { className: "help", id: `help-${pointer}`, hidden: true }, said, bounds(kind)) : null;
    if (words) input.setAttribute("aria-describedby", words.id);
    const more = words ? h("button", { type: "button", className: "about", ariaLabel: `About ${label.textContent}`, aria: { expanded: "false", controls: words.id }, on: { click: (event) => toggle(event.currentTarget, words) } }, "?") : null;
    const element = h("div", { className: `field ${kind.kind}` }, h("div", { className: "row" }, label, input, h("span", { className: "unit" }, printed), more), words);
    if (!needed && "placeholder" in input) input.placeholder = schema.default !== undefined && schema.default !== null ? String(schema.default) : saidDefault(schema);
    return this.#register(pointer, element, schema, () => {
      if (document.activeElement !== input || this.design.by === "drag" || this.design.by === "mend") write(input, kind, this.design.get(pointer));
    });
  }

  /** Sets a field, and takes away what it stands in place of. */
  #put(pointer, value) {
    const holder = pointer.slice(0, pointer.lastIndexOf("/") + 1);
    const others = value === undefined ? [] : (INSTEAD[pointer.slice(holder.length)] ?? []).filter((name) => this.design.get(holder + name) !== undefined);
    this.design.setAll({ [pointer]: value, ...Object.fromEntries(others.map((name) => [holder + name, undefined])) }, "form");
  }

  #control(kind, id, pointer) {
    const { schema } = kind;
    const put = (value) => this.#put(pointer, value);
    if (kind.kind === "choice") {
      const options = schema.enum.map((word) => h("option", { value: word }, word.replace(/_/g, " ")));
      return h("select", { id, on: { change: (event) => put(event.target.value) } }, ...options);
    }
    if (kind.kind === "flag") return h("input", { id, type: "checkbox", on: { change: (event) => put(event.target.checked) } });
    if (kind.kind === "json") return h("textarea", { id, rows: 2, spellcheck: false, on: { change: (event) => put(parsed(event.target.value)) } });
    const type = kind.kind === "number" ? "number" : "text";
    const input = h("input", { id, type, spellcheck: false, on: { input: (event) => put(read(event.target, kind)) } });
    if (kind.kind === "number") {
      input.step = kind.whole ? 1 : "any";
      input.inputMode = "decimal";
      input.addEventListener("keydown", (event) => this.#step(event, pointer, kind));
    }
    return input;
  }

  /** Arrow keys change a number by a step that suits its size. */
  #step(event, pointer, kind) {
    const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    const value = this.design.get(pointer) ?? kind.schema.default;
    if (!sign || typeof value !== "number") return;
    event.preventDefault();
    this.design.set(pointer, stepped(value, sign * (event.shiftKey ? 10 : 1), kind), "drag");
  }

  /** The name of a number is dragged sideways to change it. */
  #scrub(label, pointer, kind) {
    label.classList.add("scrub");
    label.addEventListener("pointerdown", (event) => {
      const value = this.design.get(pointer) ?? kind.schema.default;
      if (event.button !== 0 || typeof value !== "number") return;
      let begun = false;
      const move = (moved) => {
        const by = Math.round((moved.clientX - event.clientX) / 4);
        if (!begun && Math.abs(by) < 1) return;
        begun = true;
        this.design.set(pointer, stepped(value, by, kind), "drag");
      };
      label.setPointerCapture(event.pointerId);
      label.addEventListener("pointermove", move);
      const end = () => label.removeEventListener("pointermove", move);
      for (const name of ["pointerup", "pointercancel"]) label.addEventListener(name, end, { once: true });
    });
  }

  #object(pointer, kind, needed) {
    const { properties = {}, required = [], title } = kind.schema;
    const there = at(this.design.submission, pointer) ?? null;
    const open = needed || !kind.optional || there !== null;
    const fields = open ? Object.entries(properties).map(([name, schema]) => this.#field(`${pointer}/${name}`, schema, required.includes(name))) : [];
    return this.#fieldset(pointer, kind, title, fields, kind.optional && !needed);
  }

  #fieldset(pointer, kind, title, fields, optional) {
    const said = help(kind.schema);
    const box = h("input", { type: "checkbox", id: `field-${pointer}`, on: { change: (event) => (event.target.checked ? this.#put(pointer, this.beginnings.object(pointer, kind)) : this.#takeAway(pointer)) } });
    const legend = optional ? h("legend", {}, h("label", { title: said }, box, ` ${title}`)) : h("legend", { title: said }, title);
    const element = h("fieldset", { className: "field" }, legend, ...fields);
    return this.#register(pointer, element, kind.schema, () => {
      box.checked = (at(this.design.submission, pointer) ?? null) !== null;
    });
  }

  /** Takes an object away; holes that are no slots any more are round, and as wide. */
  #takeAway(pointer) {
    const { width_mm: width } = this.design.get(pointer) ?? {};
    const round = pointer.endsWith("/slot") && width ? { [pointer.replace(/slot$/, "radius_mm")]: width / 2 } : {};
    this.design.setAll({ [pointer]: undefined, ...round }, "form");
  }

  #variants(pointer, kind) {
    const value = this.design.get(pointer);
    const index = value === undefined || value === null ? -1 : kind.variants.findIndex((variant) => fits(variant, value));
    const none = kind.optional || kind.schema.default !== undefined ? [h("option", { value: "" }, "default")] : [];
    const options = kind.variants.map((variant, i) => h("option", { value: i }, variant.title ?? `variant ${i + 1}`));
    const id = `field-${pointer}`;
    const select = h("select", { id, on: { change: (event) => this.design.set(pointer, event.target.value === "" ? undefined : this.beginnings.variant(pointer, kindOf(this.api, kind.variants[event.target.value])), "form") } }, ...none, ...options);
    const chosen = kind.variants[index];
    const inner = chosen ? kindOf(this.api, chosen) : null;
    const fields = inner?.kind === "object" ? Object.entries(inner.schema.properties).map(([name, schema]) => this.#field(`${pointer}/${name}`, schema, (inner.schema.required ?? []).includes(name))) : inner?.kind === "list" ? [this.#list(pointer, inner)] : [];
    const element = h("div", { className: "field variants" }, h("div", { className: "row" }, h("label", { htmlFor: id, title: help(kind.schema) }, kind.schema.title), select, h("span", { className: "unit" })), ...fields);
    return this.#register(pointer, element, kind.schema, () => {
      select.value = index < 0 ? "" : String(index);
    });
  }

  #list(pointer, kind) {
    const values = this.design.get(pointer) ?? [];
    const entries = values.map((_, i) => h("div", { className: "entry-of-list" },
      this.#field(`${pointer}/${i}`, kind.items.schema, true),
      h("button", { type: "button", on: { click: () => this.design.set(`${pointer}/${i}`, undefined, "form") } }, "Remove")));
    const add = h("button", { type: "button", on: { click: () => this.design.set(pointer, [...values, this.beginnings.further(pointer, kind, values)], "form") } }, `Add to ${(kind.schema.title ?? "the list").toLowerCase()}`);
    const element = h("fieldset", { className: "field list" }, h("legend", { title: help(kind.schema) }, kind.schema.title ?? ""), ...entries, add);
    return this.#fields.has(pointer) ? element : this.#register(pointer, element, kind.schema, () => {});
  }
}

const rank = (name) => ["bore_radius_mm", "holes"].indexOf(name) >>> 0;

/** The only key of a document that is one of several. */
function variantOf(value) {
  const keys = Object.keys(value);
  return keys.length === 1 ? [["only", keys[0]]] : [];
}

function fits(variant, value) {
  if (variant.enum) return variant.enum.includes(value);
  if (variant.type === "array") return Array.isArray(value);
  return typeof value === "object" && !Array.isArray(value) && (variant.required ?? []).every((name) => name in value);
}

function bounds({ kind, schema }) {
  if (kind !== "number" || schema.minimum === undefined) return "";
  return ` From ${number(schema.minimum)} to ${number(schema.maximum)} ${unit(schema["x-unit"])}.`;
}

function toggle(button, words) {
  words.hidden = !words.hidden;
  button.setAttribute("aria-expanded", String(!words.hidden));
}
