// The kept designs of this tab, over a reload: what they were asked for is remembered, and computed again.

import { patiently, ProblemError } from "./api.js";
import { resultsOf } from "./preview.js";

const PLACE = "meshwright-kept";

export function remember(kept) {
  try {
    sessionStorage.setItem(PLACE, JSON.stringify(kept.map(({ name, submission, look, hidden }) => ({ name, submission, look, hidden }))));
  } catch {
    // No room, or not allowed: they last as long as the page.
  }
}

/** The designs that were kept, with their results, which are asked for once the page is `ready`; those that this service refuses are left out. */
export async function remembered(ready) {
  const all = JSON.parse(sessionStorage.getItem(PLACE) ?? "[]");
  const found = [];
  await ready;
  for (const each of all) {
    try {
      found.push({ ...each, results: await patiently(() => resultsOf(each.submission)), teeth: each.submission.pair.driven.tooth_count });
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
    }
  }
  return found;
}
