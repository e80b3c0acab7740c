// Two days at the page, with pairs that are no examples: a steel pinion on a POM gear, and a helical stage on a thin web.
// Each asserts what a person looks for.

import assert from "node:assert/strict";
import {
  answer,
  answered,
  axe,
  changing,
  designOf,
  downloaded,
  ends,
  field,
  idle,
  openDesign,
  service,
  settled,
  stepsOn,
  tab,
} from "./harness.mjs";
import { ROBOT_DRIVE } from "./designs.mjs";

/** @type {(removed: number) => object} */
const flank = (removed) => ({
  module_mm: 1.9,
  pressure_angle_deg: 18.5,
  tip_relief: { amount_um: removed, shape: "parabolic", start: { radial_length_mm: 1.1 } },
  profile_modifications: [{ kind: "crowning", amount_um: 3 }],
  lead_modifications: [{ kind: "crowning", amount_um: 4 }],
});

/** A stage of an electric drive: a thin web with kidneys beside the middle, crowned flanks, axes askew. */
const E_AXLE = {
  method: "three_dimensional",
  pair: {
    center_distance_mm: 110.2,
    helix_angle_deg: 24,
    misalignment_um: { in_plane_um: 8, out_of_plane_um: 5 },
    driving: { ...flank(18), tooth_count: 27, face_width_mm: 32, profile_shift: 0.18, blank: { bore_radius_mm: 12 } },
    driven: {
      ...flank(15),
      tooth_count: 79,
      face_width_mm: 30,
      profile_shift: -0.22,
      blank: {
        bore_radius_mm: 22,
        web: { inner_radius_mm: 32.1, outer_radius_mm: 65.4, thickness_mm: 7, offset_mm: 2 },
        hub: { outer_radius_mm: 32.1, width_mm: 30 },
        holes: { count: 5, circle_radius_mm: 48.8, slot: { width_mm: 15, angle_deg: 34 }, phase_deg: 0 },
      },
    },
  },
  output_torques_n_m: [430],
};

/** What is printed as text. */
async function onPaper(page) {
  await page.pdf({ preferCSSPageSize: true });
  return page.locator("#sheet").textContent();
}

export async function daySteps() {
  const { engine } = stepsOn(service);

  await engine.step("a day with a robot drive of steel on plastic", async (page) => {
    await openDesign(page, service, ROBOT_DRIVE);
    await answered(page);
    await idle(page);

    // One peak-to-peak: that of the headline is that of the curves, on the page and as a file.
    const printed = await answer(page, "p-p");
    assert.match(await page.locator("#words-ste").textContent(), new RegExp(`peak-to-peak ${printed.toFixed(3)} µm`));
    await tab(page, "export");
    const { bytes } = await downloaded(page, () => page.locator("[data-download=csv]").click());
    const [head, ...lines] = bytes
      .toString()
      .trim()
      .split(/\r?\n/)
      .map((line) => line.split(","));
    const column = head.indexOf("transmission_error_um");
    const values = lines.map((line) => Number(line[column]));
    assert.ok(Math.abs(Math.max(...values) - Math.min(...values) - printed) < 0.0006, `${printed} in the headline`);

    // German habits, and keys that keep the digits.
    const distance = await field(page, "/pair/center_distance_mm");
    await changing(page, () => distance.fill("40,66"));
    assert.equal((await designOf(page)).pair.center_distance_mm, 40.66);
    await changing(page, () => distance.press("ArrowDown"));
    assert.equal(await distance.inputValue(), "40.65");
    const density = await field(page, "/pair/driven/material/density_kg_m3");
    await density.fill("1.41");
    await page.locator(".field-error", { hasText: "g/cm³" }).first().waitFor();
    await density.fill("1410");
    await settled(page);

    // A run-up by its default, above half of what the pair bears.
    await tab(page, "speed");
    await page.locator("#run-up-ask").click();
    await page.locator("#run-up .speeds .scatter").first().waitFor();
    assert.ok(await page.locator("#run-up", { hasText: "is being computed" }).locator(".speeds").first().isVisible());
    const largest = Number((await page.locator("#answer-natural-frequency .value").textContent()) ?? NaN);
    assert.ok(largest > 100, `${largest} Hz`);

    // On paper a field of a part is named with its part, and what was measured stands with its own name.
    const paper = await onPaper(page);
    assert.match(paper, /Number of teeth \(span measurement\)310/);
    assert.match(paper, /Density \(material\)78501410kg/);
    assert.doesNotMatch(paper, /NaN|undefined/);

    // 18 times 83 mesh periods: as many torques as there is room for stand in the field, and the hint counts these.
    await tab(page, "robustness");
    await page.locator("#population-ahead", { hasText: "A member has" }).waitFor();
    const { length } = (await page.locator("#population-torques").inputValue()).split(", ");
    const [, positions] = /A member has ([\d.e+]+) positions/.exec(await page.locator("#population-ahead").innerText());
    assert.equal(length, 1);
    assert.equal(Number(positions), length * 18 * 83 * 10);
    await page.locator("#sensitivity-run").click();
    await ends(page, "#sensitivity-state", /5 of 5 designs, successful/);
    await axe(page);
  });

  await engine.step("a day with a helical stage on a thin web", async (page) => {
    await openDesign(page, service, E_AXLE);
    await answered(page);
    await idle(page);
    await tab(page, "contact");
    assert.ok((await answer(page, "face")) > 1);

    // What a view needs in three dimensions is told, stands in the list of work, and is stopped there.
    await page.locator("#deformed").click();
    await page.locator("#deformed-note", { hasText: "Computing" }).waitFor();
    await page.waitForFunction(() => /^Work: \d/.test(document.querySelector("#work-button").textContent));
    await page.locator("#work-button").click();
    await page.locator("#tray-running li", { hasText: "deformed" }).getByRole("button", { name: /^Stop/ }).click();
    await page.locator("#deformed-note", { hasText: "Stopped" }).waitFor();
    await page.waitForFunction(() => document.querySelector("#work-button").textContent === "Work");
    await page.locator("#tray").getByRole("button", { name: "Close" }).click();

    // A kidney under the hand has a draft, and the line says what is computed.
    const hole = page.locator(".rotor.driven .hole[role=slider]");
    await hole.focus();
    const begun = Date.now();
    await page.evaluate(() => {
      window.drafts = [];
      document.addEventListener("drawn", (/** @type {CustomEvent} */ { detail }) => window.drafts.push(detail.draft));
    });
    await page.keyboard.press("ArrowDown");
    await page.waitForFunction(() => window.drafts.length > 0);
    console.log(`page: first curve ${Date.now() - begun} ms after a kidney was moved.`);
    assert.equal(await page.evaluate(() => window.drafts[0]), true, "a draft comes first");
    await axe(page);
  });
}
