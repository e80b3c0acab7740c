// The state of the page without the page: answers, kept designs and the project.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Store } from "../../../web/state/store.js";
import { submitted } from "../../../web/state/work.js";

const SUBMISSION = {
  pair: { driving: { tooth_count: 18 }, driven: { tooth_count: 83 } },
  method: "flexible",
  output_torques_n_m: [8.5],
};
const RESULTS = { pair: { period_mesh_periods: 4 }, curves: [] };
const torque = (newton_meters) => ({ ...SUBMISSION, output_torques_n_m: [newton_meters] });

/** A store whose design is computed. */
function computed() {
  const store = new Store();
  store.design.replace(SUBMISSION, "start");
  store.came(RESULTS, store.design.submission, { draft: false, asked: SUBMISSION });
  return store;
}

test("results are those of the design until it is another one, or refused", () => {
  const store = computed();
  assert.equal(store.current.name, "18/83, no holes");
  store.refuse({ title: "No" }, store.design.submission);
  assert.equal(store.current, null);
  store.pardon();
  assert.notEqual(store.current, null);
  store.design.set("/output_torques_n_m", [4], "form");
  assert.equal(store.current, null);
  // A draft is shown, and is not what is exported.
  store.came(RESULTS, store.design.submission, { draft: true, asked: torque(4) });
  assert.equal(store.answer.shown.asked.output_torques_n_m[0], 4);
  assert.equal(store.current, null);
});

test("the gears stand within the true period", () => {
  const store = computed();
  const standing = [5.5, -0.5, 4].map((to) => {
    store.turn(to);
    return store.position;
  });
  assert.deepEqual(standing, [1.5, 3.5, 0]);
});

test("kept designs have names and looks of their own, and one of them is compared with", () => {
  const store = computed();
  assert.equal(store.against, null);
  for (let i = 0; i < 3; i += 1) store.keep(store.current);
  assert.deepEqual(
    store.design.kept.map(({ name, look }) => [name, look]),
    [
      ["18/83, no holes", 1],
      ["18/83, no holes (2)", 2],
      ["18/83, no holes (3)", 3],
    ],
  );
  assert.equal(store.designs[0].name, "18/83, no holes (now)");
  assert.equal(store.against.look, 1);
  store.compareWith(1);
  store.changeKept(1, { name: "second" });
  assert.equal(store.against.name, "second");
  // What is compared with and goes leaves the first; the look that is free is taken again.
  store.changeKept(1, null);
  assert.equal(store.against.look, 1);
  store.keep(store.current);
  assert.deepEqual(
    store.design.kept.map(({ look }) => look),
    [1, 3, 2],
  );
  store.design.undo();
  assert.equal(store.design.kept.length, 2);
});

test("a project is saved until something of it changes, and comes back over a reload", () => {
  const store = computed();
  let told = 0;
  store.onProject(() => {
    told += 1;
  });
  store.describe({ name: "Drive", notes: "first" });
  store.save({ id: "a", name: "Drive", place: "browser" }, store.document);
  assert.ok(store.isSaved);
  submitted({ id: "b", kind: "sweep", name: "torques", at: "2026-01-01T00:00:00Z" });
  assert.equal(told, 3);
  assert.ok(!store.isSaved, "its work is part of it");
  store.forget("b");
  assert.ok(store.isSaved);
  store.design.set("/output_torques_n_m", [4], "form");
  assert.ok(!store.isSaved);

  const { project, ...state } = structuredClone(store.remembered);
  const again = new Store();
  again.restore(project);
  again.design.restore(state.submission, state);
  assert.equal(again.project.name, "Drive");
  assert.ok(!again.isSaved);
  again.design.undo();
  assert.ok(again.isSaved);
});

test("an opened project takes the place of the one before, and its kept designs wait", () => {
  const store = computed();
  store.keep(store.current);
  const [kept] = store.design.kept;
  const { name, submission, asked } = kept;
  const waiting = { name, submission, asked };
  const words = { notes: "n", author: "a", drawing: "d" };
  store.open({ submission: torque(2), typed: {}, kept: [waiting], work: [], ...words }, "Other");
  assert.deepEqual(store.design.kept, []);
  assert.equal(store.document.kept.length, 1, "what waits is part of the document");
  assert.deepEqual([store.project.name, store.project.author, store.project.drawing], ["Other", "a", "d"]);
  store.arrived(waiting);
  assert.deepEqual(store.project.waiting, []);
  store.design.undo();
  assert.equal(store.design.kept[0], kept, "the way back leads to what was worked on");
});
