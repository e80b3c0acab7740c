// The design that is worked on: its fields, the way back, and the address that carries it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { apart, at, Design, differences, flattened, fromFragment, nameOf, told } from "../../../web/state/design.js";
import { toFragment, withValue } from "../../../web/state/design.js";
import { helix, intoPlane, intoSolid, learnDimensions } from "../../../web/state/dimensions.js";
import { needsSolid, needsThird, offers, teeth } from "../../../web/state/dimensions.js";
import { beyondPlane } from "../../../web/state/schema.js";
import { api, example } from "./contract.mjs";

learnDimensions(beyondPlane(api));

const HOLES = "/pair/driven/blank/holes";
const begun = () => {
  const design = new Design();
  design.replace(example("test-case-2"), "start");
  return design;
};

test("a pointer finds and sets a field, makes objects on the way, and takes fields away", () => {
  const submission = example("test-case-2");
  assert.equal(at(submission, `${HOLES}/count`), 10);
  assert.equal(at(submission, "/pair/none/at/all"), undefined);
  const set = withValue(submission, "/resolution/grid", "coarse");
  assert.equal(set.resolution.grid, "coarse");
  assert.equal(at(withValue(submission, `${HOLES}/count`, undefined), `${HOLES}/count`), undefined);
  assert.deepEqual(withValue({ list: [1, 2, 3] }, "/list/1", undefined), { list: [1, 3] });
  assert.equal(at(submission, `${HOLES}/count`), 10, "what was given is not changed");
});

test("every change can be taken back and made again, and what follows in one field is one change", () => {
  const design = begun();
  const causes = [];
  design.onChange((by) => causes.push(by));
  design.set(`${HOLES}/radius_mm`, 6, "form");
  design.set(`${HOLES}/radius_mm`, 6.5, "form");
  design.set("/output_torques_n_m", [60], "form");
  design.set("/output_torques_n_m", [60], "form");
  assert.deepEqual(causes, ["form", "form", "form"], "the same value is no change");
  design.undo();
  assert.equal(design.get(`${HOLES}/radius_mm`), 6.5);
  design.undo();
  assert.equal(design.get(`${HOLES}/radius_mm`), 7.5);
  assert.ok(!design.canUndo && design.canRedo);
  design.redo();
  design.redo();
  assert.deepEqual(design.get("/output_torques_n_m"), [60]);
  design.undo();
  design.set("/method", "decomposition", "mend");
  assert.ok(!design.canRedo, "another change leaves what was taken back");
});

test("each press of a button is a change, and all that a hand moves until it lets go is one", () => {
  const design = begun();
  for (const radius of [6, 5]) design.set(`${HOLES}/radius_mm`, radius, "mend");
  design.undo();
  assert.equal(design.get(`${HOLES}/radius_mm`), 6);
  design.hold();
  design.set(`${HOLES}/radius_mm`, 7, "drag");
  design.setAll({ [`${HOLES}/circle_radius_mm`]: 30, [`${HOLES}/phase_deg`]: 3 }, "drag");
  design.release();
  design.undo();
  assert.deepEqual([design.get(`${HOLES}/radius_mm`), design.get(`${HOLES}/circle_radius_mm`)], [6, 34]);
});

test("a hand that is sent back leaves no change behind", () => {
  const design = begun();
  const before = design.submission;
  design.hold();
  design.set(`${HOLES}/radius_mm`, 60, "drag");
  design.release();
  design.snapBack(before);
  assert.ok(!design.canUndo);
  assert.equal(design.by, "snap");
});

test("what was remembered is the way back only from the design that it leads from", () => {
  const design = begun();
  design.set("/output_torques_n_m", [60], "mend");
  const state = structuredClone(design.state);
  const other = new Design();
  other.restore(state.submission, state);
  assert.ok(other.canUndo);
  const third = new Design();
  third.restore(example("bad-case-3-as-printed"), state);
  assert.ok(!third.canUndo);
});

// Node packs without a header from 20.12 on.
const packs = (() => {
  try {
    return Boolean(new CompressionStream("deflate-raw"));
  } catch {
    return false;
  }
})();

test("an address carries a design; one that is cut carries none", { skip: !packs }, async () => {
  const submission = example("test-case-2");
  const fragment = await toFragment(submission);
  assert.match(fragment, /^#design=[\w-]+$/);
  assert.deepEqual(await fromFragment(fragment), submission);
  assert.equal(await fromFragment(fragment.slice(0, -20)), null);
  assert.equal(await fromFragment("#answers"), null);
});

test("designs are named by their teeth and holes, and told apart by the fields in which they differ", () => {
  const submission = example("test-case-2");
  assert.equal(nameOf(submission), "50/50, 10×r7.5@34");
  const other = withValue(submission, `${HOLES}/radius_mm`, 6);
  assert.deepEqual(differences([submission, other]), [{ pointer: `${HOLES}/radius_mm`, values: [7.5, 6] }]);
  assert.equal(flattened({ a: { b: [1, 2] }, c: null }).size, 1, "a list of numbers is one value, null is none");
  assert.deepEqual(
    [told(undefined), told([1, 2]), told([1, 2, 3, 4, 5]), told("three_dimensional")],
    ["not given", "1, 2", "5 numbers", "three dimensional"],
  );
});

test("what goes on from the curves is asked for apart from them", () => {
  const submission = { ...example("test-case-2"), stress: true, dynamics: { driving_speed_rpm: 100 } };
  const { curves, further } = apart(submission);
  assert.deepEqual(Object.keys(further).sort(), ["dynamics", "stress"]);
  assert.deepEqual(curves, apart(curves).curves);
});

test("a helix moves the gears apart and takes the method that knows it; straight teeth bring both back", () => {
  const design = begun();
  const distance = design.get("/pair/center_distance_mm");
  design.setAll(helix(design, 15).changes, "mend");
  assert.equal(design.get("/method"), "three_dimensional");
  assert.ok(design.get("/pair/center_distance_mm") > distance);
  assert.ok(needsSolid(design));
  design.setAll(teeth(design, "straight").changes, "mend");
  assert.equal(design.get("/pair/helix_angle_deg"), undefined);
  assert.equal(design.get("/method"), "flexible");
  assert.ok(Math.abs(design.get("/pair/center_distance_mm") - distance) < 1e-3);
  assert.deepEqual(offers(design), []);
});

test("the schema says which fields plane methods refuse", () => {
  const ofGear = ["lead_modifications", "tooth_deviations/lead_slope_um", "tooth_deviations/leads", "blank/hub"];
  const expected = [
    ...["helix_angle_deg", "axial_offset_mm", "misalignment_um"].map((name) => `/pair/${name}`),
    ...["driving", "driven"].flatMap((gear) =>
      [...ofGear, "blank/web/offset_mm", "blank/shaft/torque_at"].map((name) => `/pair/${gear}/${name}`),
    ),
  ];
  assert.deepEqual(beyondPlane(api).sort(), expected.sort());
  assert.ok(needsThird("/pair/driven/blank/hub") && !needsThird("/pair/driven/blank/hub/width_mm"));
});

test("measured leads go with what else has an extent along the axis", () => {
  const design = begun();
  design.setAll(intoSolid(design).changes, "mend");
  design.set("/pair/driven/tooth_deviations", { leads: { z_mm: [0, 1], removed_um: [[0, 1]] } }, "form");
  assert.ok(needsSolid(design));
  assert.ok("/pair/driven/tooth_deviations/leads" in intoPlane(design).changes);
});

test("what plane methods refuse goes when the pair is computed in the plane, and is named", () => {
  const design = begun();
  design.setAll(intoSolid(design).changes, "mend");
  design.set("/pair/axial_offset_mm", 2, "form");
  const { changes, told: words } = intoPlane(design);
  assert.ok("/pair/axial_offset_mm" in changes && changes["/pair/axial_offset_mm"] === undefined);
  assert.equal(changes["/method"], "flexible");
  assert.match(words.join(), /Left out: axial offset/);
});
