// @ts-check
// The schema of a submission, as the service describes it.

import { checked, json } from "./api.js";
import { at } from "./design.js";
import { numberOfMaterial } from "./materials.js";

/** @import { Submission } from "./documents.js" */

/**
 * A part of the OpenAPI document that says what a value may be.
 *
 * @typedef {object} Schema
 * @property {string} [$ref]
 * @property {string | string[]} [type]
 * @property {string} [title]
 * @property {string} [description]
 * @property {any} [default] a value of the field
 * @property {(string | number | null)[]} [enum]
 * @property {Schema[]} [oneOf]
 * @property {Schema[]} [allOf]
 * @property {Schema} [not]
 * @property {Record<string, Schema>} [properties]
 * @property {string[]} [required]
 * @property {Schema} [items]
 * @property {number} [minimum]
 * @property {number} [maximum]
 * @property {string} [x-unit]
 * @property {number} [x-default-modules]
 * @property {string} [x-absent]
 * @property {number} [x-dimensions]
 */

/**
 * What a field takes: of a list its `items`, of one of several its `variants`.
 *
 * @typedef {object} Kind
 * @property {"variants" | "choice" | "object" | "number" | "numbers" | "texts" | "json" | "list" | "flag" | "text"}
 *   kind
 * @property {Schema} schema
 * @property {boolean} optional
 * @property {boolean} [whole]
 * @property {Kind} [items]
 * @property {Schema[]} [variants]
 */

/** @typedef {{ components: { schemas: Record<string, Schema> } }} Api */

/** @type {Promise<Api> | null} */
let documentOf = null;

/**
 * The OpenAPI document; asked for once, and again where it did not come.
 *
 * @type {() => Promise<Api>}
 */
export function openapi() {
  documentOf ??= json("openapi.json").catch((error) => {
    documentOf = null;
    throw error;
  });
  return documentOf;
}

/** The schema of a submission. */
export const SUBMISSION = { $ref: "#/components/schemas/Submission" };

/**
 * Follows references.
 *
 * @type {(api: Api, schema: Schema) => Schema}
 */
export function resolve(api, schema) {
  let seen = schema;
  while (seen?.$ref)
    seen = seen.$ref
      .slice(2)
      .split("/")
      .reduce((/** @type {any} */ place, name) => place[name], api);
  // A reference may bear words of its own.
  return schema?.$ref && (schema.title || schema.description) ? { ...seen, ...withoutRef(schema) } : seen;
}

/** @type {(schema: Schema) => Schema} */
function withoutRef({ $ref: _, ...rest }) {
  return rest;
}

/**
 * What a list of such values is.
 *
 * @type {Partial<Record<Kind["kind"], Kind["kind"]>>}
 */
const LISTS = { number: "numbers", text: "texts", list: "json" };

/**
 * What a field takes: `{ kind, schema, optional, ... }`. Null as one of several is told by `optional`.
 *
 * @type {(api: Api, given: Schema) => Kind}
 */
export function kindOf(api, given) {
  const schema = resolve(api, given);
  const types = [schema.type].flat().filter((type) => type && type !== "null");
  const optional = [schema.type].flat().includes("null");
  if (schema.oneOf) {
    const choices = schema.oneOf.map((each) => resolve(api, each));
    const meant = choices.filter((each) => each.type !== "null");
    const nullable = meant.length < choices.length;
    if (meant.length === 1) {
      const inner = kindOf(api, meant[0]);
      const titles = {
        title: schema.title && !/^[A-Z]\w*[a-z][A-Z]/.test(schema.title) ? schema.title : inner.schema.title,
        description: schema.description ?? inner.schema.description,
      };
      return { ...inner, schema: { ...inner.schema, ...titles, default: schema.default }, optional: nullable };
    }
    return { kind: "variants", schema, variants: meant, optional: nullable };
  }
  if (schema.enum) return { kind: "choice", schema, optional };
  if (types[0] === "object" && schema.properties) return { kind: "object", schema, optional };
  if (types[0] === "array") {
    const items = kindOf(api, schema.items ?? {});
    // Lists of lists are typed as they are.
    return { kind: LISTS[items.kind] ?? "list", schema, items, optional };
  }
  if (types[0] === "number" || types[0] === "integer")
    return { kind: "number", whole: types[0] === "integer", schema, optional };
  if (types[0] === "boolean") return { kind: "flag", schema, optional };
  if (types[0] === "string") return { kind: "text", schema, optional };
  return { kind: "json", schema, optional };
}

/**
 * The schema of the field at a pointer of a submission, whether a design has it or not; null where there is none.
 *
 * @type {(api: Api, pointer: string) => Schema | null}
 */
export function schemaAt(api, pointer) {
  /** @type {(given: Schema, part: string) => Schema | undefined} */
  const step = (given, part) => {
    const { kind, schema, variants = [], items } = kindOf(api, given);
    if (/^\d+$/.test(part))
      return kind === "variants" ? variants.map((each) => step(each, part)).find(Boolean) : items?.schema;
    return schema.properties?.[part] ?? variants.map((each) => step(each, part)).find(Boolean);
  };
  const found = pointer
    .split("/")
    .slice(1)
    .reduce((/** @type {Schema | undefined} */ schema, part) => schema && step(schema, part), SUBMISSION);
  return found ? kindOf(api, found).schema : null;
}

/** @type {(pointer: string) => string} */
export const lastOf = (pointer) => pointer.slice(pointer.lastIndexOf("/") + 1);

/**
 * What the field at a pointer is called.
 *
 * @type {(api: Api, pointer: string) => string}
 */
export const titleAt = (api, pointer) => schemaAt(api, pointer)?.title ?? lastOf(pointer).replace(/_/g, " ");

/** @type {(words: string) => string[]} */
const stems = (words) =>
  words
    .toLowerCase()
    .match(/[a-z]{3,}/g)
    ?.map((word) => word.replace(/s$/, "")) ?? [];

/**
 * The name of the part that the field at a pointer is of, a part being what a design may do without; empty where it is
 * of none, or where its title has a word of that name.
 *
 * @type {(api: Api, pointer: string, title: string) => string}
 */
export function partOf(api, pointer, title) {
  const places = pointer.split("/").slice(0, -1);
  for (; places.length > 1; places.pop()) {
    const name = places.at(-1) ?? "";
    const part = schemaAt(api, places.slice(0, -1).join("/"))?.properties?.[name];
    const { kind, optional, schema } = part ? kindOf(api, part) : { kind: "", optional: false, schema: {} };
    if (kind !== "object" || !optional) continue;
    const words = (schema.title ?? "").replace(/ request$/, "").toLowerCase();
    return stems(words).some((stem) => stems(title).includes(stem)) ? "" : words;
  }
  return "";
}

/**
 * The fields that the one at a pointer stands in place of: where it has a value they have none.
 *
 * @type {(api: Api, pointer: string) => string[]}
 */
export function insteadOf(api, pointer) {
  const [holder, name] = [pointer.slice(0, pointer.lastIndexOf("/")), pointer.slice(pointer.lastIndexOf("/") + 1)];
  const schema = schemaAt(api, holder);
  const objects = schema ? [schema, ...(kindOf(api, schema).variants ?? [])] : [];
  // Each of `allOf` says of some fields that one alone is not null.
  const groups = objects
    .flatMap(({ allOf = [] }) => allOf)
    .map(({ oneOf = [] }) => oneOf.flatMap(({ not }) => Object.keys(not?.properties ?? {})));
  return [...new Set(groups.filter((group) => group.includes(name)).flat())].filter((other) => other !== name);
}

/**
 * The words of a description without the unit and the default, which stand elsewhere.
 *
 * @type {(schema: Schema) => string}
 */
export function help(schema) {
  return (schema.description ?? "")
    .replace(/ ?Unit: [^.]*\.(?= |$)/, "")
    .replace(/`/g, "")
    .trim();
}

/**
 * What stands for a field that is left out, in words, where it is no value: so many modules, or what its absence means.
 *
 * @type {(schema: Schema) => string}
 */
export function saidDefault(schema) {
  const modules = schema["x-default-modules"];
  if (modules !== undefined) return modules === 1 ? "1 module" : `${modules} modules`;
  return schema["x-absent"] ?? "";
}

/**
 * `submission` without what the service fills in where it is left out, so that it says what somebody has chosen and no
 * more. What cannot be left out without changing it stays.
 *
 * @type {(api: Api, submission: Submission) => Promise<Submission>}
 */
export async function bare(api, submission) {
  const filled = await checked(submission);
  const asked = withoutDefaults(api, submission, filled.pair.period_mesh_periods);
  // The service has the last word on what is the same.
  return JSON.stringify((await checked(asked)).submission) === JSON.stringify(filled.submission) ? asked : submission;
}

/**
 * The value that a field of `submission` has where nobody gives it; undefined where there is none, or nothing that
 * could have it.
 *
 * @param {Api} api
 * @param {Submission} submission
 * @param {string} pointer
 */
export function usualAt(api, submission, pointer) {
  const holder = pointer.slice(0, pointer.lastIndexOf("/"));
  if (holder && !isNested(at(submission, holder)) && !isFilledIn(holder)) return undefined;
  const named = ofNamedMaterial(submission, pointer);
  if (named !== undefined) return named;
  const schema = schemaAt(api, pointer);
  const modules = schema?.["x-default-modules"];
  return modules === undefined ? (schema?.default ?? undefined) : modules * at(submission, `${holder}/module_mm`);
}

/**
 * The number that the name of a material gives to a field of it.
 *
 * @type {(submission: Submission, pointer: string) => number | undefined}
 */
export function ofNamedMaterial(submission, pointer) {
  const [, holder, field] = /^(.*\/material)\/(\w+)$/.exec(pointer) ?? [];
  return holder ? numberOfMaterial(at(submission, `${holder}/name`), field) : undefined;
}

/** @type {(api: Api, submission: Submission, period: number) => Submission} */
function withoutDefaults(api, submission, period) {
  /**
   * @param {any} value
   * @param {string} pointer
   * @returns {any} as much of the value as somebody has chosen
   */
  const left = (value, pointer) => {
    if (value === null) return undefined;
    if (Array.isArray(value))
      return value.length
        ? value.map((each, i) => (isNested(each) ? pruned(each, `${pointer}/${i}`) : each))
        : undefined;
    if (isNested(value)) {
      const rest = pruned(value, pointer);
      // An object that may be absent is not the same as an empty one.
      return Object.keys(rest).length || !isFilledIn(pointer) ? rest : undefined;
    }
    const usual = pointer === "/resolution/span_mesh_periods" ? period : usualAt(api, submission, pointer);
    return value === usual || Math.abs(value - usual) < 1e-9 ? undefined : value;
  };
  /**
   * @param {object} object
   * @param {string} pointer
   * @returns {any} the object without what is left out
   */
  const pruned = (object, pointer) =>
    Object.fromEntries(
      Object.entries(object)
        .map(([name, value]) => [name, left(value, `${pointer}/${name}`)])
        .filter(([, value]) => value !== undefined),
    );
  return pruned(submission, "");
}

/** @type {(value: unknown) => value is object} */
const isNested = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

/**
 * Whether the object at a pointer is there even if nobody gives it.
 *
 * @type {(pointer: string) => boolean}
 */
const isFilledIn = (pointer) =>
  pointer === "/resolution" || pointer === "/resolution/load_distribution" || /\/material$/.test(pointer);

/**
 * The pointers of the fields of a submission that methods in the plane refuse, as the schema says.
 *
 * @type {(api: Api) => string[]}
 */
export function beyondPlane(api) {
  /** @type {(given: Schema, pointer: string) => string[]} */
  const within = (given, pointer) => {
    if (given["x-dimensions"] === 3) return [pointer];
    const { kind, schema } = kindOf(api, given);
    if (kind !== "object") return [];
    return Object.entries(schema.properties ?? {}).flatMap(([name, each]) => within(each, `${pointer}/${name}`));
  };
  return within(SUBMISSION, "");
}

/**
 * Whether a value is of one of several variants.
 *
 * @param {Schema} variant
 * @param {any} value that of the field
 */
export function fits(variant, value) {
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
