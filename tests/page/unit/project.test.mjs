// A project as a document and as a file: what is read again, and what is refused.

import assert from "node:assert/strict";
import { test } from "node:test";
import { contentOf, documentOf, fileOf, isName, NoProject, projectOf } from "../../../web/state/project.js";
import { example } from "./contract.mjs";

const submission = example("standard-pair");
const kept = { name: "<b>before</b>", submission, asked: submission, results: { curves: [] }, look: 1, teeth: 50 };
const work = [{ id: "0198-a", kind: "population", name: "<i>as made</i>", at: "2026-11-27T10:00:00Z" }];
const content = {
  submission,
  typed: { "/pair/center_distance_mm": 0 },
  kept: [kept],
  work,
  notes: "quiet\nat 100 N m",
  author: 'R. "D"',
  drawing: "4711-A",
};
const name = "E-axle & <i>stage</i> 2";

const refused = (work, words) =>
  assert.throws(work, (error) => error instanceof NoProject && words.test(error.message), String(words));

test("a project comes back from its document and its file as it was, without results", () => {
  const document = documentOf(content);
  assert.ok(!JSON.stringify(document).includes("curves"));
  const { kept: read, ...rest } = contentOf(JSON.parse(JSON.stringify(document)));
  assert.deepEqual(rest, {
    submission,
    typed: content.typed,
    work,
    notes: content.notes,
    author: content.author,
    drawing: content.drawing,
  });
  assert.deepEqual(read, [{ name: kept.name, submission, asked: submission }]);
  const opened = projectOf(fileOf(name, document));
  assert.equal(opened.name, name);
  assert.deepEqual(documentOf(opened.content), document);
});

test("a foreign, a newer and a damaged file are refused, each with its reason", () => {
  const text = fileOf(name, documentOf(content));
  for (const foreign of ["", "gear", "{}", "[1]", JSON.stringify(submission), '{"format":"other"}'])
    refused(() => projectOf(foreign), /no project of Meshwright/);
  refused(() => projectOf(text.replace('"version":1', '"version":2')), /later Meshwright.*version 2/);
  refused(() => projectOf(text.slice(0, -50)), /cut off/);
  refused(() => projectOf(text.replace('"tooth_count":50', '"tooth_count":51')), /not what was saved/);
  refused(() => projectOf(text.replace("stage", "stadt")), /not what was saved/);
  const document = documentOf(content);
  refused(() => contentOf({ ...document, version: 2 }), /later Meshwright/);
  for (const part of ["submission", "typed", "kept", "notes", "version"])
    refused(() => contentOf({ ...document, [part]: undefined }), /damaged/);
  for (const wrong of [{ id: "a/../b" }, { kind: "hunt" }, { name: 3 }, { at: "yesterday" }])
    refused(() => contentOf({ ...document, work: [{ ...work[0], ...wrong }] }), /damaged/);
  refused(() => contentOf({ ...document, author: 3 }), /damaged/);
  const first = { ...document, work: undefined, author: undefined, drawing_number: undefined };
  const { work: none, author, drawing } = contentOf(first);
  assert.deepEqual([none, author, drawing], [[], "", ""], "the first documents had none");
  for (const wrong of [{ kept: [{}] }, { kept: {} }, { typed: { a: "1" } }, { submission: {} }, { version: "1" }])
    refused(() => contentOf({ ...document, ...wrong }), /damaged/);
});

test("a project is called by words, and by no empty, long or unprintable ones", () => {
  for (const good of ["a", "Getriebe Ü", "n".repeat(200), "<b>"]) assert.ok(isName(good), good);
  for (const bad of ["", "  ", "n".repeat(201), "a\nb", "a\0", 3, null]) assert.ok(!isName(bad), String(bad));
});
