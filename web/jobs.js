// The jobs of this client: submitted, followed, cancelled, opened, run again.

import { json, post, ProblemError, request } from "./api.js";
import { h, number } from "./dom.js";
import { save } from "./download.js";

const PAUSE = 500;
const ENDED = ["successful", "failed", "dismissed"];
const SHOWN = 20;

/** The jobs in `place`; a finished one is opened into `design`. */
export function jobs(place, design) {
  const out = h("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: "Jobs" });
  const state = h("p", { className: "note", role: "status" });
  const submit = h("button", { type: "button", className: "primary", on: { click: () => act(() => post("v1/jobs", design.submission)) } }, "Submit this design as a job");
  const look = h("button", { type: "button", on: { click: () => refresh() } }, "Look again");
  place.replaceChildren(h("p", { className: "note" }, "A job is kept: its results can be fetched and linked to for weeks. What the page shows while you change numbers is not."), h("div", { className: "buttons" }, submit, look), state, out);
  let following = false;

  /** Does something to a job, then shows how the jobs stand. */
  async function act(work) {
    try {
      state.textContent = "";
      await work();
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      state.textContent = error.problem.errors?.[0]?.detail ?? error.message;
    }
    await refresh();
  }

  async function refresh() {
    if (following) return;
    following = true;
    try {
      for (;;) {
        const { items } = await json(`v1/jobs?limit=${SHOWN}`);
        out.replaceChildren(items.length ? tableOf(items) : h("p", { className: "note" }, "There are no jobs yet."));
        if (place.hidden || items.every(({ status }) => ENDED.includes(status))) return;
        await new Promise((resolve) => setTimeout(resolve, PAUSE));
      }
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      state.textContent = error.message;
    } finally {
      following = false;
    }
  }

  function tableOf(items) {
    const head = h("tr", {}, ...["Submitted", "Method", "State", "Time", "Actions"].map((name) => h("th", { scope: "col" }, name)));
    return h("table", {}, h("thead", {}, head), h("tbody", {}, ...items.map(rowOf)));
  }

  function rowOf(job) {
    const address = `v1/jobs/${job.id}`;
    const button = (name, work) => h("button", { type: "button", on: { click: () => act(work) }, ariaLabel: `${name} ${job.id.slice(-6)}` }, name);
    const file = (name) => async () => save(`${job.id}-${name}`, "", await (await request(`${address}/results${name === "results.json" ? "" : `/${name}`}`)).blob());
    const buttons = [button("Open", async () => design.replace((await json(address)).submission, "open"))];
    if (!ENDED.includes(job.status)) buttons.push(button("Cancel", () => request(`${address}/cancel`, { method: "POST" })));
    else buttons.push(button("Run again", async () => post("v1/jobs", (await json(address)).submission)));
    if (job.status === "successful") buttons.push(button("JSON", file("results.json")), button("CSV", file("ste.csv")), button("SVG", file("ste.svg")), button("VTU", file("fields.vtu")));
    const progress = ENDED.includes(job.status) ? job.status : h("span", {}, `${job.status} `, h("progress", { max: 100, value: job.progress_percent, ariaLabel: "Progress" }), ` ${job.progress_percent} %`);
    const why = job.problem ? h("small", {}, ` ${job.problem.detail}`) : null;
    return h("tr", {}, h("th", { scope: "row" }, new Date(job.submitted_at).toLocaleString()), h("td", {}, job.method.replace(/_/g, " ")), h("td", {}, progress, why), h("td", {}, job.wall_time_seconds === null ? "" : `${number(job.wall_time_seconds, 2)} s`), h("td", { className: "actions" }, ...buttons));
  }

  return { refresh };
}
