// What every module of the page keeps: who may know whom, what is fetched ahead, and how it is written.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join, normalize } from "node:path";
import { test } from "node:test";

const WEB = new URL("../../../web/", import.meta.url);
/** Which folders the modules of a folder may import from. */
const KNOWS = {
  state: ["state"],
  draw: ["state", "draw", "vendor"],
  views: ["state", "draw", "views"],
  panels: ["state", "draw", "panels"],
  ".": ["state", "draw", "views", "panels"],
};
/** Fetched when they are first asked for, or never. */
const LATER = ["draw/raster.js", "draw/solid.js", "draw/space.js", "state/documents.js"];
const MOST_COLUMNS = 120;

const textOf = (name) => readFileSync(new URL(name, WEB), "utf8");
const modules = readdirSync(WEB, { recursive: true }).filter(
  (name) => name.endsWith(".js") && !name.startsWith("vendor"),
);
const importsOf = (name) =>
  [...textOf(name).matchAll(/^import [^;]*?"(\.[^"]+)";$/gm)].map(([, path]) => normalize(join(dirname(name), path)));

test("modules import from the folders that theirs may know, and form no circles", () => {
  const visited = new Map();
  const visit = (name, path) => {
    assert.ok(!path.includes(name), `a circle: ${[...path, name].join(" ")}`);
    if (visited.has(name) || name.startsWith("vendor")) return;
    visited.set(name, true);
    for (const other of importsOf(name)) {
      assert.ok(KNOWS[dirname(name)].includes(dirname(other)), `${name} imports ${other}`);
      visit(other, [...path, name]);
    }
  };
  for (const name of modules) visit(name, []);
  assert.ok(modules.length > 40, `there are ${modules.length} modules`);
});

test("what the page needs at once is fetched ahead, and nothing else", () => {
  const ahead = [...textOf("index.html").matchAll(/modulepreload" href="web\/([^"]+)"/g)].map(([, name]) => name);
  const needed = [...modules, "vendor/uplot.js"].filter((name) => name !== "main.js" && !LATER.includes(name));
  assert.deepEqual(ahead.sort(), needed.sort());
});

test("every module is checked, and its comments have no more than 120 columns", () => {
  for (const name of modules) {
    const lines = textOf(name).split("\n");
    assert.equal(lines[0], "// @ts-check", name);
    // Prettier lays out code, and leaves comments as they are.
    const long = lines.filter((line) => line.length > MOST_COLUMNS && /^ *(\/\/|\/?\*)/.test(line));
    assert.deepEqual(long, [], name);
  }
});
