// The numbers of a named material at a temperature.

import assert from "node:assert/strict";
import { test } from "node:test";
import { learnMaterials, materialAt } from "../../../web/state/materials.js";

const plain = { title: "", poisson_ratio: 0.3, density_kg_m3: 1410, yield_strength_mpa: 64, source: "" };
const point = (temperature_c, youngs_modulus_gpa, expansion_per_k) => ({
  temperature_c,
  youngs_modulus_gpa,
  expansion_per_k,
});
learnMaterials([
  {
    ...plain,
    name: "A",
    ...point(20, 210, 12e-6),
    at_temperatures: [point(100, 205, 12.5e-6), point(200, 195, 13e-6)],
  },
  { ...plain, name: "B", ...point(23, 3, 1e-4), at_temperatures: [] },
]);

test("between two temperatures the modulus lies in proportion, and at each it is what is printed", () => {
  assert.deepEqual(materialAt("A", 100), { youngs_modulus_gpa: 205, expansion_per_k: 12.5e-6 });
  assert.deepEqual(materialAt("A", 150), { youngs_modulus_gpa: 200, expansion_per_k: 12.75e-6 });
  // A quarter of the way from 20 to 100 degrees: 210 - 5/4.
  assert.equal(materialAt("A", 40).youngs_modulus_gpa, 208.8);
  assert.deepEqual(materialAt("A", 20), { youngs_modulus_gpa: 210, expansion_per_k: 12e-6 });
  assert.deepEqual(materialAt("A", 200), { youngs_modulus_gpa: 195, expansion_per_k: 13e-6 });
});

test("where nothing is printed nothing is told", () => {
  assert.throws(() => materialAt("A", 201), /from 20 to 200 °C/);
  assert.throws(() => materialAt("A", 19), /from 20 to 200 °C/);
  assert.equal(materialAt("B", 23).youngs_modulus_gpa, 3);
  assert.throws(() => materialAt("B", 24), /from 23 to 23 °C/);
  assert.throws(() => materialAt("", 24), /by its name/);
});
