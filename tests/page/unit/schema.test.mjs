// The schema of a submission, from which the form is made.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Beginnings } from "../../../web/state/beginnings.js";
import { Design } from "../../../web/state/design.js";
import {
  help,
  insteadOf,
  kindOf,
  partOf,
  resolve,
  saidDefault,
  schemaAt,
  SUBMISSION,
  usualAt,
} from "../../../web/state/schema.js";
import { api, example } from "./contract.mjs";

const kindAt = (pointer) => kindOf(api, schemaAt(api, pointer));

test("every field of a submission has a kind, and a title that the form can show", () => {
  const seen = new Set();
  const walk = (given, pointer) => {
    const kind = kindOf(api, given);
    seen.add(kind.kind);
    const { properties = {} } = kind.schema;
    for (const [name, schema] of Object.entries(properties)) walk(schema, `${pointer}/${name}`);
    for (const variant of kind.variants ?? []) walk(variant, pointer);
    if (kind.items) walk(kind.items.schema, `${pointer}/0`);
    if (pointer.split("/").length === 4) assert.ok(kind.schema.title, `${pointer} has no title`);
  };
  walk(SUBMISSION, "");
  assert.ok(seen.size >= 8, [...seen].join());
});

test("no two fields of a gear have one name, with the part that each is of", () => {
  const names = new Map();
  const walk = (given, pointer) => {
    const { kind, schema, variants = [] } = kindOf(api, given);
    for (const [name, each] of Object.entries(schema.properties ?? {})) walk(each, `${pointer}/${name}`);
    for (const variant of variants) walk(variant, pointer);
    if (["object", "variants", "list"].includes(kind)) return;
    const { title } = schemaAt(api, pointer);
    const part = partOf(api, pointer, title);
    const name = part ? `${title} (${part})` : title;
    names.set(name, new Set([...(names.get(name) ?? []), pointer]));
  };
  walk(schemaAt(api, "/pair/driven"), "/pair/driven");
  assert.ok(names.size > 50, String(names.size));
  assert.deepEqual(
    [...names].filter(([, pointers]) => pointers.size > 1),
    [],
  );
  const of = (pointer) => partOf(api, pointer, schemaAt(api, pointer).title);
  assert.deepEqual(
    ["span_measurement/teeth", "tip_relief/shape", "tip_relief/amount_um", "tooth_count", "material/density_kg_m3"].map(
      (name) => of(`/pair/driving/${name}`),
    ),
    ["span measurement", "tip relief", "", "", "material"],
  );
  assert.equal(of("/force_table/loads"), "force table");
});

test("the kinds of fields are those of their schemas", () => {
  assert.deepEqual(
    [kindAt("/pair/driving/tooth_count").kind, kindAt("/pair/driving/tooth_count").whole],
    ["number", true],
  );
  assert.equal(kindAt("/method").kind, "choice");
  assert.equal(kindAt("/output_torques_n_m").kind, "numbers");
  assert.equal(kindAt("/tags").kind, "texts");
  assert.equal(kindAt("/stress").kind, "flag");
  assert.equal(kindAt("/pair/driven/blank/holes").kind, "variants");
  assert.equal(schemaAt(api, "/pair/driven/blank/holes/0/radius_mm").type.includes("number"), true);
  assert.equal(schemaAt(api, "/pair/driven/none"), null);
});

test("the schema says which fields stand in place of each other", () => {
  const sorted = (pointer) => insteadOf(api, pointer).sort();
  const gear = "/pair/driving";
  const thicknesses = ["ball_measurement", "span_measurement", "tooth_thickness_deviation_normal_um"];
  assert.deepEqual(sorted(`${gear}/tooth_thickness_deviation_um`), thicknesses);
  assert.deepEqual(sorted(`${gear}/tip_diameter_mm`), ["addendum_mm"]);
  assert.deepEqual(sorted(`${gear}/tip_rounding_mm`), ["tip_chamfer_mm"]);
  assert.deepEqual(sorted(`${gear}/blank/shaft`), ["bore_radius_mm"]);
  for (const holes of [`${gear}/blank/holes`, `${gear}/blank/holes/1`]) {
    assert.deepEqual(sorted(`${holes}/at_deg`), ["count", "phase_deg"]);
    assert.deepEqual(sorted(`${holes}/slot`), ["radius_mm"]);
  }
  assert.deepEqual(sorted(`${gear}/module_mm`), []);
  assert.deepEqual(sorted("/method"), []);
});

test("what a field has where nobody gives it is told, in modules too", () => {
  const submission = example("standard-pair");
  assert.equal(usualAt(api, submission, "/pair/driving/dedendum_mm"), 1.25 * submission.pair.driving.module_mm);
  assert.equal(usualAt(api, submission, "/pair/driven/pressure_angle_deg"), 20);
  assert.equal(usualAt(api, submission, "/pair/driven/blank/web/offset_mm"), undefined, "there is no web");
  const dedendum = schemaAt(api, "/pair/driving/dedendum_mm");
  assert.equal(saidDefault(dedendum), "1.25 modules");
  assert.doesNotMatch(help(dedendum), /Unit:|`/);
});

test("a part that is asked for begins with values that fit its gear and are complete", () => {
  const design = new Design();
  design.replace(example("standard-pair"), "start");
  const limits = { least_ligament_modules: 1, positions: 20_000 };
  const beginnings = new Beginnings(api, design, { limits, results: () => undefined });
  const { module_mm: module, tooth_count: teeth } = design.get("/pair/driven");
  const root = module * (teeth / 2 - 1.25);
  const holes = beginnings.object("/pair/driven/blank/holes", null);
  assert.ok(holes.circle_radius_mm + holes.radius_mm < root, JSON.stringify(holes));
  const web = beginnings.object("/pair/driven/blank/web", null);
  assert.ok(web.inner_radius_mm < web.outer_radius_mm && web.outer_radius_mm < root, JSON.stringify(web));
  const second = beginnings.further("/pair/driven/blank/holes", kindOf(api, { type: "array" }), [holes]);
  assert.ok(second.radius_mm < holes.radius_mm && second.count === holes.count);
  const misalignment = beginnings.object("/pair/misalignment_um", kindAt("/pair/misalignment_um"));
  const { required = [] } = resolve(api, schemaAt(api, "/pair/misalignment_um"));
  for (const name of required) assert.ok(name in misalignment);
});
