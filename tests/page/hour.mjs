// docs/an-hour-at-the-bench.md, click by click: what it says that the page answers is compared with what the page
// answers.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import {
  answered as firstAnswered,
  axe,
  changing,
  designOf,
  downloaded,
  ends,
  field,
  settled,
  stepsOn,
  tab,
  unfold,
} from "./harness.mjs";

/** Numbers of the guide may be off by so much: its last digit, or what another processor rounds. */
const TOLERANCE = 0.01;
const MINUTES = 180_000;

/**
 * The guide's answers, its quotations in the order in which they come, and the names that it tells a reader to look
 * for, in italics.
 */
function guide() {
  const text = readFileSync(process.env.HOUR, "utf8");
  return {
    answers: [...text.matchAll(/^> (.+)$/gm)].map(([, words]) => words),
    names: [...new Set([...text.matchAll(/\*([^*\n]+)\*/g)].map(([, words]) => words))],
  };
}

const NUMBER = /-?\d+(?:,\d{3})*(?:\.\d+)?/g;
const valueOf = (digits) => Number(digits.replace(/,/g, ""));

/** Whether two texts have the same words, and numbers that differ by what the guide may be off. */
function assertAlike(found, said) {
  const words = (text) => text.replace(NUMBER, "#").replace(/\s+/g, " ").trim();
  assert.equal(words(found), words(said));
  const pairs = (found.match(NUMBER) ?? []).map((digits, i) => [valueOf(digits), said.match(NUMBER)[i]]);
  for (const [value, digits] of pairs) {
    const last = 10 ** -(digits.split(".")[1]?.length ?? 0);
    assert.ok(
      Math.abs(value - valueOf(digits)) <= Math.max(TOLERANCE * Math.abs(value), 1.01 * last),
      `the guide says ${said}; the page says ${found}`,
    );
  }
}

/** @param service the service whose page is used */
export async function hourSteps(service) {
  const { engine } = stepsOn(service);
  await engine.step("an hour at the bench goes as its guide says, click by click", async (page) => {
    page.setDefaultTimeout(MINUTES);
    const { answers, names } = guide();
    let seen = "";
    let begun = Date.now();
    /** Remembers what stands on the page, for the names that the guide uses. */
    const look = async () => {
      seen += await page.evaluate(() =>
        [
          document.body.innerText,
          ...[...document.querySelectorAll("summary, option, label, legend, button, h2, th, [role=tab]")].map(
            (each) => each.textContent,
          ),
          ...[...document.querySelectorAll("svg text")].map((each) => each.textContent),
        ].join("\n"),
      );
    };
    /** The next answer of the guide is what the page says. */
    const answered = async (found) => {
      await look();
      const said = answers.shift();
      if (process.env.HOUR_LOG) console.log(`hour: ${Date.now() - begun} ms: ${found}\n      guide: ${said}`);
      else assertAlike(found, said);
      begun = Date.now();
    };
    /** The whole headline is what the guide says next: every name, number and unit that is shown, with its mark. */
    const headline = async () => {
      await settled(page);
      await answered(
        await page.evaluate(() =>
          [...document.querySelectorAll("#headline .tile:not([hidden])")]
            .map((tile) =>
              [...tile.querySelectorAll(".name, .value, small:not([hidden]), .mark:not([hidden])")]
                .map((each) => (each.matches(".mark") ? `(${each.textContent})` : each.textContent.trim()))
                .filter(Boolean)
                .join(" "),
            )
            .join(", "),
        ),
      );
    };
    /** The headline of a tab is what the guide says next. */
    const headlineOf = async (name) => {
      await tab(page, name);
      await headline();
    };
    /** A row of the study: its name, and the numbers below these heads of its table. */
    const rowOfStudy = (index) =>
      page.locator("#study table").evaluate((table, row) => {
        const heads = [...table.querySelectorAll("thead th")].map((each) => each.textContent.trim());
        const { children } = table.querySelectorAll("tbody tr")[row];
        const cells = ["Mass of both gears kg", "STE p-p µm", "H_N µm"].map((head) => {
          const [, name, unit] = head.match(/^(.*) (\S+)$/);
          return `${name} ${children[heads.indexOf(head)]?.textContent} ${unit}`;
        });
        return `${children[0].textContent}: ${cells.join(", ")}`;
      }, index);
    const typed = async (input, value) => {
      await input.click();
      await input.press("Control+a");
      await input.pressSequentially(String(value));
      await input.press("Tab");
    };
    const type = async (pointer, value) => typed(await field(page, pointer), value);
    const press = (place, words) => page.locator(`${place} button:visible`, { hasText: words }).first().click();

    // The pair.
    await page.goto(service.url);
    await firstAnswered(page);
    await page.locator("#form .field").first().waitFor();
    await page.locator("#start").selectOption({ label: "a new pair, all by default" });
    for (const [name, value] of [
      ["driving/module_mm", 2.5],
      ["center_distance_mm", 106],
      ["driving/tooth_count", 23],
      ["driving/profile_shift", 0.3],
      ["driving/face_width_mm", 24],
      ["driven/tooth_count", 61],
      ["driven/profile_shift", -0.1],
      ["driven/face_width_mm", 22],
    ])
      await type(`/pair/${name}`, value);
    await type("/output_torques_n_m", 150);
    await headline();
    await headlineOf("contact");
    await tab(page, "noise");

    // The web and its holes.
    const blank = "/pair/driven/blank";
    await changing(page, async () => (await field(page, `${blank}/web`)).check());
    await type(`${blank}/web/thickness_mm`, 8);
    await settled(page);
    await changing(page, async () => (await field(page, `${blank}/holes`)).selectOption({ label: "Several patterns" }));
    await changing(page, async () => (await field(page, `${blank}/holes/0/slot`)).check());
    await changing(page, () => press("#form", "Add to several patterns"));
    await headline();
    await page.locator("#warned").click();
    await answered(
      await page
        .locator("#warnings li")
        .filter({ hasText: "The web of" })
        .evaluate((item) => item.firstChild.textContent),
    );
    await page.locator("#warned").click();

    // Crowning, and the torque that it suits.
    const list = page
      .locator("#form fieldset.list", { has: page.locator("legend", { hasText: /profile modifications/i }) })
      .first();
    await unfold(list);
    await changing(page, () => list.locator(":scope > button").click());
    await changing(page, async () =>
      (await field(page, "/pair/driving/profile_modifications/0")).selectOption({ label: "Crowning" }),
    );
    await headline();
    await headlineOf("contact");
    await tab(page, "noise");
    await typed(page.locator("#sweep-from"), 25);
    await typed(page.locator("#sweep-to"), 300);
    await page.locator("#sweep button[type=submit]").click();
    await page.locator("#sweep .scatter").waitFor();
    await answered(
      await page
        .locator("#sweep .out p")
        .first()
        .evaluate((line) => line.firstChild.textContent + line.querySelector(".mark").textContent),
    );

    // Two designs under names.
    await page.locator("#pin").click();
    await tab(page, "designs");
    await page.locator("#name-1").fill("crowned by 5");
    await page.locator("#name-1").press("Enter");
    await type("/pair/driving/profile_modifications/0/amount_um", 8);
    await headline();
    await answered(
      (await page.locator("#differences tr").last().innerText()).replace(/\t/g, ": ").replace(/: (\d+)$/, " and $1"),
    );

    // A study, and a search.
    await tab(page, "designs");
    await page.locator("#axis-0").selectOption(`${blank}/web/thickness_mm`);
    await typed(page.locator("#axis-0-values"), "6 8 10");
    await page.locator("#study-run").click();
    await ends(page, "#study-state", /3 of 3 designs, successful/);
    for (const row of [0, 2]) await answered(await rowOfStudy(row));
    await page.locator("#search summary").click();
    await page.locator("#variable-0").selectOption("/pair/driving/profile_modifications/0/amount_um");
    await page.locator("#variable-1").selectOption("");
    for (const [name, value] of [
      ["low", 2],
      ["high", 16],
      ["step", 1],
    ])
      await typed(page.locator(`#variable-0-${name}`), value);
    await typed(page.locator("#search-evaluations"), 15);
    await page.locator("#search-run").click();
    await ends(page, "#search-state", /designs looked at, successful/);
    await answered(
      await page
        .locator("#search-out")
        .evaluate(
          (out) =>
            `${out.querySelector("strong").textContent} with ${out.querySelector("tbody th").textContent} ${out.querySelectorAll("tbody td")[1].textContent}`,
        ),
    );
    await changing(page, () => press("#search-out", "Use this design"));
    await page.locator("#study .outdated", { hasText: "The design has changed since" }).first().waitFor();
    await headlineOf("noise");

    // As it will be made.
    const tool = page.locator("#deviations-driven-class");
    await unfold(tool);
    await changing(page, () => page.locator("details.tool[open] button", { hasText: "Draw teeth" }).last().click());
    await headline();
    await answered(await page.locator("details.tool[open] [role=status]").last().innerText());
    await changing(page, () => page.locator("#undo").click());
    await tab(page, "robustness");
    await typed(page.locator("#population-size"), 80);
    await typed(page.locator("#population-torques"), "150");
    await page.locator("#population button[type=submit]").click();
    await ends(page, "#population-state", /80 of 80 members, successful/);
    await page.locator("#population-quantity").selectOption("mesh_order_um");
    await answered((await page.locator("#population .out p").first().innerText()).split(";")[0]);

    // Over speed.
    await tab(page, "speed");
    await page.locator("#run-up-ask").click();
    await page.locator("#run-up .waterfall").waitFor();
    await settled(page);
    await headline();
    await answered((await page.locator("#speed-readout").innerText()).split(". ")[0]);
    const without = async () => {
      for (const name of ["dynamics", "force_table"])
        await changing(page, async () => (await field(page, `/${name}`)).uncheck());
    };
    await without();

    // Out of the page.
    await tab(page, "export");
    const sizes = {};
    for (const kind of ["json", "csv", "orders", "designs", "svg", "png", "submission.rexs", "look-up-table.csv"])
      sizes[kind] = (await downloaded(page, () => page.locator(`[data-download="${kind}"]`).click())).bytes.length;
    assert.ok(
      Object.values(sizes).every((bytes) => bytes > 300),
      JSON.stringify(sizes),
    );
    await tab(page, "data");
    await page.evaluate(() => {
      window.print = () => {};
    });
    await press("#geometry", "Print one page");
    assert.equal(
      [...(await page.pdf({ preferCSSPageSize: true })).toString("latin1").matchAll(/\/Type\s*\/Page\b/g)].length,
      1,
    );
    await axe(page);
    const last = await designOf(page);
    // Back to the example by keys alone, and forth again.
    await page.locator("body").press("Control+z");
    await look();
    while (await page.locator("#undo").isEnabled()) await page.keyboard.press("Control+z");
    await settled(page);
    assert.equal((await designOf(page)).pair.driven.tooth_count, 50);
    while (await page.locator("#redo").isEnabled()) await page.keyboard.press("Control+Shift+z");
    await settled(page);
    assert.deepEqual(await designOf(page), last);

    // Helical, on a thin web at one side.
    begun = Date.now();
    await page.locator("#start").selectOption({ label: "a new pair, all by default" });
    await settled(page);
    await changing(page, async () => (await field(page, "teeth")).selectOption("helical"));
    await headlineOf("noise");
    await headlineOf("contact");
    await changing(page, async () => (await field(page, `${blank}/web`)).check());
    await type(`${blank}/web/thickness_mm`, 6);
    await type(`${blank}/web/offset_mm`, 4);
    await headlineOf("noise");
    await headlineOf("contact");
    await answered((await page.locator("#cure").evaluate((line) => line.firstChild.textContent)).trim());
    await changing(page, () => page.locator("#cure button").click());
    await headlineOf("noise");
    await headlineOf("contact");
    await page.locator('[data-view="space"]').click();
    const canvas = page.locator("canvas.space");
    await canvas.waitFor();
    const box = await canvas.boundingBox();
    await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.4 * box.height);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.55 * box.width, box.y + 0.55 * box.height, { steps: 6 });
    await page.mouse.up();
    await tab(page, "export");
    assert.match(
      (await downloaded(page, () => page.locator('[data-download="contact-pattern.svg"]').click())).bytes.toString(),
      /<svg/,
    );
    await look();
    assert.deepEqual(answers, [], "the guide says no more than this");
    assert.deepEqual(
      names.filter((name) => !seen.toLowerCase().includes(name.toLowerCase())),
      [],
      "names of the guide that are nowhere on the page",
    );
  });
}
