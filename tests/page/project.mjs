// Projects: saved, listed, opened, written by two, exported and imported, and kept in the browser where no key may write.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { tmpdir } from "node:os";
import { axe, computed, designOf, downloaded, ends, field, named, open, service, stepsOn, tab } from "./harness.mjs";

const COUNT = "/pair/driven/blank/holes/count";
const NAME = 'E-axle <b id="injected">stage 2</b>';

const dialog = (page) => page.locator("#project-dialog");
const press = (page, id) => page.locator(`#project-${id}`).click();
const says = (page, words) => dialog(page).getByText(words).first().waitFor();
const close = (page) => dialog(page).getByRole("button", { name: "Close" }).click();
const show = (page) => press(page, "button");
const openListed = (page, name) =>
  dialog(page)
    .getByRole("button", { name: `Open ${name}`, exact: true })
    .click();

/** Gives the driven gear so many holes. */
async function holes(page, count) {
  await (await field(page, COUNT)).fill(String(count));
  await named(page, `${count}×`);
  await computed(page);
}

/** Waits until a reload finds the driven gear with so many holes. */
const remembers = (page, count) =>
  page.waitForFunction(async (holes) => {
    const { remembered } = await import(new URL("web/state/kept.js", document.baseURI).href);
    return (await remembered())?.submission.pair.driven.blank.holes.count === holes;
  }, count);

const holesOf = async (page) => (await designOf(page)).pair.driven.blank.holes.count;

async function choose(page, text) {
  const path = join(tmpdir(), `meshwright-project-${process.pid}.json`);
  writeFileSync(path, text);
  await page.locator("#project-file").setInputFiles(path);
}

export async function projectSteps() {
  const { dailyEngine, engine } = stepsOn(service);

  await dailyEngine.opened(
    "a project is saved, survives a reload, is opened by another tab, and of two writers neither loses anything",
    async (page, context) => {
      await holes(page, 8);
      await page.locator("#pin").click();
      await show(page);
      await press(page, "save");
      await says(page, "Give the project a name.");
      await page.locator("#project-name").fill(NAME);
      await page.locator("#project-notes").fill("quiet at 100 N m");
      await press(page, "save");
      await says(page, /^Saved in the service/);
      await says(page, "asks for no key: all who call it share");
      await axe(page);
      assert.equal(await page.locator("#injected").count(), 0, "names are text");
      if (process.argv.includes("--screenshots")) await page.screenshot({ path: `${import.meta.dirname}/project.png` });
      await close(page);
      assert.equal(await page.locator("#project-button").innerText(), NAME);
      await holes(page, 7);
      assert.equal(await page.locator("#project-button").innerText(), `${NAME} *`, "it has changes");

      await remembers(page, 7);
      await page.reload();
      await named(page, "7×");
      assert.equal(await page.locator("#project-button").innerText(), `${NAME} *`);

      // Another tab opens what was saved; its kept design is computed by one press.
      const other = await context.newPage();
      await open(other, service);
      await show(other);
      await openListed(other, NAME);
      await says(other, "Kept designs that are not computed yet");
      assert.equal(await other.locator("#project-notes").inputValue(), "quiet at 100 N m");
      await press(other, "compute");
      await other.locator("#project-compute").waitFor({ state: "hidden" });
      await close(other);
      await named(other, "8×");
      assert.equal(await other.locator("#against option").count(), 1);
      await holes(other, 9);
      await show(other);
      await press(other, "save");
      await says(other, /^Saved in the service/);

      // The first tab is told, and offered both.
      await show(page);
      await press(page, "save");
      await says(page, "Somebody else saved this project");
      await axe(page);
      if (process.argv.includes("--screenshots"))
        await page.screenshot({ path: `${import.meta.dirname}/project-conflict.png` });
      await press(page, "both");
      await says(page, /^Saved in the service/);
      await dialog(page)
        .getByRole("button", { name: `Open ${NAME}`, exact: true })
        .nth(1)
        .waitFor();
      await close(page);
      assert.equal(await holesOf(page), 7, "mine is a project of its own");
      await close(other);
      await holes(other, 6);
      await show(other);
      await press(other, "save");
      await says(other, /^Saved in the service/);
      assert.equal(await holesOf(other), 6, "theirs is as it was left");

      // A project that somebody has deleted is told as such, and nothing is lost.
      for (const item of (await (await fetch(`${service.url}v1/projects`)).json()).items)
        await fetch(`${service.url}v1/projects/${item.id}`, { method: "DELETE", headers: { "if-match": "*" } });
      await close(other);
      await holes(other, 5);
      await show(other);
      await press(other, "save");
      await says(other, "Somebody else deleted this project.");
      assert.equal(await holesOf(other), 5);
    },
  );

  await dailyEngine.opened(
    "what runs stands in the list of work, is stopped there, and belongs to the project wherever that is opened",
    async (page, context) => {
      const tray = page.locator("#tray");
      await tab(page, "robustness");
      await page.locator("#population-size").fill("3000");
      await page.locator("#population-run").click();
      await page.waitForFunction(() => document.querySelector("#work-button").textContent === "Work: 1");
      await page.locator("#work-button").click();
      const row = tray.locator("#tray-running li");
      await row.getByText(/\d+ of 3000 members/).waitFor();
      assert.match(await row.innerText(), /as made[\s\S]*of a core in all/);
      await axe(page);
      if (process.argv.includes("--screenshots")) await page.screenshot({ path: `${import.meta.dirname}/tray.png` });
      // A reload leaves it running; it stands there all the same, and is stopped.
      await page.waitForTimeout(600);
      await page.reload();
      await page.waitForFunction(() => document.querySelector("#work-button").textContent === "Work: 1");
      await page.locator("#work-button").click();
      await row.getByText(/\d+ of 3000/).waitFor();
      await tray.getByRole("button", { name: /^Stop/ }).click();
      const kept = tray.locator("table tbody tr");
      await kept.getByText("dismissed").waitFor();
      assert.equal(await row.count(), 0);
      await tray.getByRole("button", { name: "Close" }).click();

      await show(page);
      await page.locator("#project-name").fill("With work");
      await press(page, "save");
      await says(page, /^Saved in the service/);
      // Another tab remembers nothing of this one, as another machine does.
      const other = await context.newPage();
      await open(other, service);
      await show(other);
      await openListed(other, "With work");
      await close(other);
      await other.locator("#work-button").click();
      const there = other.locator("#tray table tbody tr");
      await there.getByText("dismissed").waitFor();
      await there.getByRole("button", { name: /^Show/ }).click();
      await ends(other, "#population-state", /of 3000 members, dismissed/);
      await there.getByRole("button", { name: /^Forget/ }).click();
      await there.waitFor({ state: "detached" });
    },
  );

  await engine.opened(
    "the report of a project has its pages on A4, with the words of its title block",
    async (page) => {
      await page.locator("#pin").click();
      await (await field(page, "/pair/driven/blank/holes/radius_mm")).fill("7");
      await computed(page);
      await (await field(page, "/pair/driven/material/name")).selectOption("GG-25");
      await (await field(page, "/dynamics")).check();
      await tab(page, "robustness");
      await page.locator("#sensitivity-run").click();
      await ends(page, "#sensitivity-state", /5 of 5 designs, successful/);
      await tab(page, "speed");
      await page.locator("#run-up .scatter").first().waitFor();
      await show(page);
      await page.locator("#project-name").fill(NAME);
      await page.locator("#project-author").fill('R. "D" \\ Ü');
      await page.locator("#project-drawing").fill("4711-A");
      await page.locator("#project-notes").fill("first line\nsecond line");
      await axe(page);
      await close(page);
      const pdf = await page.pdf({ preferCSSPageSize: true });
      const text = pdf.toString("latin1");
      const pages = [...text.matchAll(/\/Type\s*\/Page\b/g)].length;
      assert.ok(pages >= 5 && pages <= 9, `${pages} pages`);
      // A4 in points.
      for (const [, width, height] of text.matchAll(/\/MediaBox\s*\[0 0 ([\d.]+) ([\d.]+)\]/g))
        assert.ok(Math.abs(width - 595.3) < 1 && Math.abs(height - 841.9) < 1, `${width} by ${height}`);
      if (process.argv.includes("--screenshots")) writeFileSync(`${import.meta.dirname}/report.pdf`, pdf);
      const said = await page.locator("#sheet").textContent();
      for (const words of [
        NAME,
        'R. "D" \\ Ü',
        "4711-A",
        "second line",
        // GG-25 has the modulus of grey iron.
        /Young's modulus[^A-Z]*110/,
        /Radius of a hole.*7[^.].*7\.5/,
        "Spectrum",
        /Resonance.*rpm/,
        /Sensitivity.*Torque ± 20 %/,
        "Equilibrium residual",
      ])
        assert.ok(words instanceof RegExp ? words.test(said) : said.includes(words), String(words));
      assert.doesNotMatch(said, /NaN|undefined/);
      assert.equal(await page.locator("#sheet :is(button, input, select)").count(), 0);
      assert.equal(await page.locator("#injected").count(), 0, "names are text");
    },
  );

  await dailyEngine.opened(
    "a project is a file, and a foreign, newer or damaged one leaves everything as it is",
    async (page) => {
      await holes(page, 8);
      await show(page);
      await page.locator("#project-name").fill("As a file");
      const { name, bytes } = await downloaded(page, () => press(page, "export"));
      assert.equal(name, "meshwright-As-a-file-project.json");
      const text = bytes.toString("utf8");
      await close(page);
      await holes(page, 7);
      await show(page);
      for (const [file, words] of [
        ['{"pair":{}}', "This is no project of Meshwright."],
        [text.replace('"version":1', '"version":9'), "A later Meshwright wrote this project"],
        [text.slice(0, 300), "The file is damaged: it is cut off."],
        [text.replace('"count":8', '"count":6'), "The file is damaged: it is not what was saved."],
      ]) {
        await choose(page, file);
        await says(page, words);
        assert.equal(await holesOf(page), 7, words);
        assert.equal(await page.locator("#project-name").inputValue(), "As a file");
      }
      await choose(page, text);
      await close(page);
      await named(page, "8×");
      assert.equal(await page.locator("#undo").isDisabled(), false, "there is a way back");
    },
  );

  await dailyEngine.opened("without a key that may write a project stays in the browser", async (page, context) => {
    const refuse = async (each) =>
      each.route("**/v1/projects**", (route) =>
        route.request().method() === "GET"
          ? route.continue()
          : route.fulfill({
              status: 403,
              contentType: "application/problem+json",
              body: JSON.stringify({ code: "forbidden", status: 403, title: "", detail: "The key may look." }),
            }),
      );
    await refuse(page);
    await holes(page, 8);
    await show(page);
    await page.locator("#project-name").fill("In this browser");
    await press(page, "save");
    await says(page, /^Saved in this browser/);
    await dialog(page).getByRole("cell", { name: "this browser", exact: true }).waitFor();
    const other = await context.newPage();
    await refuse(other);
    await open(other, service);
    await show(other);
    await openListed(other, "In this browser");
    await says(other, /^Saved in this browser/);
    await close(other);
    await named(other, "8×");
    await holes(other, 9);
    await show(other);
    await press(other, "save");
    await says(other, /^Saved in this browser/);
    await page.locator("#project-notes").fill("mine");
    await press(page, "save");
    await says(page, "Somebody else saved this project");
    await press(page, "theirs");
    await says(page, /^Saved in this browser/);
    assert.equal(await page.locator("#project-notes").inputValue(), "");
    await close(page);
    await named(page, "9×");
  });
}
