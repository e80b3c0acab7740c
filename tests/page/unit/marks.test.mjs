// Marks of numbers by the warnings of their design.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { markInRow, markOf } from "../../../web/state/marks.js";

const warning = (code) => ({ code, detail: `because of ${code}` });

test("a warning marks the numbers that it limits, and no other", () => {
  const few = [warning("off_the_line"), warning("few_positions")];
  assert.deepEqual(markOf("transmission_error_um.peak_to_peak", few), {
    word: "few positions",
    detail: "because of few_positions",
  });
  assert.equal(markOf("transmission_error_um.mean", few), undefined);
  assert.equal(markOf("mass_kg", few), undefined);
  assert.equal(markOf("natural-frequency", [warning("rim_inertia_on_hub")])?.word, "estimate");
});

test("every warning that sets a mark is one that the service gives", () => {
  const codes = readFileSync(new URL("../../../web/state/marks.js", import.meta.url), "utf8").matchAll(
    /code: "(\w+)"/g,
  );
  const contract = readFileSync(new URL("../../../api/openapi.json", import.meta.url), "utf8");
  for (const [, code] of codes) assert.ok(contract.includes(`"${code}"`), code);
});

test("a row of a table marks its numbers by the codes of its warnings, and says so where it has none", () => {
  assert.equal(markInRow("hole_order_um", { warnings: ["thin_ligament", "few_positions"] })?.word, "few positions");
  assert.equal(markInRow("hole_order_um", { warnings: ["thin_ligament"] }), undefined);
  assert.equal(markInRow("hole_order_um", {})?.word, "warnings not known");
  assert.equal(markInRow("mass_kg", {}), undefined);
});
