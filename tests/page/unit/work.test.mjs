// The list of work: what stands in it, how far it says that it is, and the kinds of studies.

import assert from "node:assert/strict";
import { test } from "node:test";
import { begin, kindOf, onSubmitted, onWork, running, submitted, tellsOf } from "../../../web/state/work.js";

test("what begins is listed until it ends, and who watches hears how a study ended", () => {
  const ended = [];
  onWork((each) => each && ended.push(each));
  let stopped = 0;
  const stop = () => {
    stopped += 1;
  };
  const work = begin("50/50, as made", stop, { id: "a", seconds: 12 });
  const other = begin("a view", () => {});
  assert.deepEqual(
    running().map(({ name, seconds }) => [name, seconds]),
    [
      ["50/50, as made", 12],
      ["a view", null],
    ],
  );
  work.tell({ share: 0.25, said: "1 of 4" });
  running()[0].stop();
  assert.deepEqual([running()[0].share, stopped], [0.25, 1]);
  work.end("dismissed");
  work.end("successful");
  work.tell({ share: 1 });
  other.end("successful");
  assert.deepEqual(running(), []);
  assert.deepEqual(ended, [{ id: "a", status: "dismissed" }], "what has no id in the service is not told");
});

test("a job tells how far it is", () => {
  const work = begin("a job", () => {});
  const hear = tellsOf(work);
  hear("status", { id: "j", status: "accepted", progress_percent: 0 });
  assert.match(running()[0].said, /waits/);
  hear("progress", { progress_percent: 40 });
  assert.deepEqual([running()[0].id, running()[0].share, running()[0].said], ["j", 0.4, "40 %"]);
  hear("away", {});
  assert.deepEqual([running()[0].share, running()[0].said.includes("does not answer")], [0.4, true]);
  work.end();
});

test("the kind of a study follows from its document", () => {
  const torques = { path: "/output_torques_n_m", values: [[10], [20]] };
  assert.equal(kindOf({ population: { size: 2 } }), "population");
  assert.equal(kindOf({ search: {} }), "search");
  assert.equal(kindOf({ axes: [torques] }), "sweep");
  assert.equal(kindOf({ axes: [torques, { path: "/pair/center_distance_mm", values: [1] }] }), "study");
  assert.equal(kindOf({ axes: [{ ...torques, values: [[10, 20]] }] }), "study");
  assert.equal(
    kindOf({ designs: [{ label: "as it is" }, { label: "torque -" }, { label: "torque +" }] }),
    "sensitivity",
  );
  assert.equal(kindOf({ designs: [{ label: "8R34" }] }), "study");
  const heard = [];
  onSubmitted((each) => heard.push(each));
  submitted({ id: "s", kind: "sweep", name: "", at: "2026-11-27T10:00:00Z" });
  assert.equal(heard[0].id, "s");
});
