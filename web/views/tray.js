// @ts-check
// The list of work: what runs for the project, with how far it is, what it costs and a button that stops it, and the
// jobs and studies that were submitted for the project.

import { button, byId, h, inLine, note, table, tableRow } from "../draw/dom.js";
import { hasEnded, json, ProblemError, request } from "../state/api.js";
import { timeOf } from "../state/numbers.js";
import { onWork, running } from "../state/work.js";

/** @import { Store } from "../state/store.js" */
/** @import { Running, Submitted } from "../state/work.js" */

/** Work that takes less, in milliseconds, is not listed. */
const MOMENT = 600;
/**
 * The time between two requests for what runs in the service without this page, in milliseconds: of an open list, and
 * of a closed one.
 */
const [OPEN, CLOSED] = [2000, 10_000];
/** The name of the statuses of submitted work that has ended, kept over a reload. */
const ENDED = "meshwright-ended";
/** The state of what the service does not keep any more. */
const GONE = "removed by the service";

/**
 * A row of what runs.
 *
 * @typedef {{ element: HTMLLIElement, bar: HTMLProgressElement, said: HTMLElement }} Row
 */

/** @type {(work: Submitted) => string} */
const addressOf = ({ id, kind }) => `v1/${kind === "job" ? "jobs" : "studies"}/${id}`;

export class Tray {
  #button = byId("work-button");
  #place = byId("tray");
  #list = h("ul", { id: "tray-running" });
  #kept = h("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: "Submitted for the project" });
  #none = note("Nothing runs.");
  #wrong = h("p", { className: "field-error", role: "alert" });
  /** @type {Map<string, Row>} */
  #rows = new Map();
  /**
   * How submitted work ended that this page has heard of.
   *
   * @type {Record<string, string>}
   */
  #ended = JSON.parse(sessionStorage.getItem(ENDED) ?? "{}");
  /**
   * What runs in the service without this page.
   *
   * @type {Map<string, Running>}
   */
  #elsewhere = new Map();
  /**
   * The name of each entry in the list, which keeps its row.
   *
   * @type {WeakMap<Running, string>}
   */
  #keys = new WeakMap();
  #count = 0;
  #drawnKept = "";
  /** @type {number | undefined} */
  #drawing;
  /** @type {number | undefined} */
  #later;
  /** @type {number | undefined} */
  #asking;

  /**
   * The work of the project of `store`; `onShow` shows a job or a study of it.
   *
   * @param {Store} store
   * @param {(work: Submitted) => unknown} onShow
   */
  constructor(store, onShow) {
    this.store = store;
    this.onShow = onShow;
    this.#place.append(
      h(
        "div",
        { className: "panel-head" },
        h("h2", { id: "tray-title" }, "Work"),
        button("Close", () => this.#open(false)),
      ),
      this.#wrong,
      this.#none,
      this.#list,
      h("h3", {}, "Submitted for the project"),
      this.#kept,
    );
    this.#button.addEventListener("click", () => this.#open(this.#place.hidden));
    this.#place.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.#open(false);
    });
    onWork((ended) => {
      if (ended) this.#end(ended.id, ended.status);
      this.#soon();
    });
    let { work } = store.project;
    store.onProject(() => {
      if (work === store.project.work) return;
      ({ work } = store.project);
      this.#renew();
    });
    this.#renew();
  }

  /** The jobs and studies that were submitted for the project, the oldest first. */
  get #work() {
    return this.store.project.work;
  }

  /** The submitted work of the project is another one now. */
  #renew() {
    this.#soon();
    this.#askAfter(0);
  }

  /** @param {boolean} open */
  #open(open) {
    this.#place.hidden = !open;
    this.#button.setAttribute("aria-expanded", String(open));
    if (open) this.#renew();
    else this.#button.focus();
  }

  /**
   * @param {string} id
   * @param {string} status
   */
  #end(id, status) {
    this.#ended[id] = status;
    this.#elsewhere.delete(id);
    sessionStorage.setItem(ENDED, JSON.stringify(this.#ended));
  }

  /** Draws once what has just changed has done so. */
  #soon() {
    this.#drawing ??= setTimeout(() => {
      this.#drawing = undefined;
      this.#draw();
    }, 50);
  }

  #draw() {
    const own = running();
    const known = new Set(own.map(({ id }) => id));
    const kept = this.#work;
    const others = [...this.#elsewhere.values()].filter(
      ({ id }) => !known.has(id) && kept.some((each) => each.id === id),
    );
    const all = [...own, ...others];
    const listed = all.filter(({ since }) => performance.now() - since >= MOMENT);
    clearTimeout(this.#later);
    if (listed.length < all.length) this.#later = setTimeout(() => this.#draw(), MOMENT);
    this.#button.textContent = listed.length ? `Work: ${listed.length}` : "Work";
    if (this.#place.hidden) return;
    const now = new Map(listed.map((each) => [this.#keyOf(each), each]));
    for (const [key, { element }] of this.#rows)
      if (!now.has(key)) {
        element.remove();
        this.#rows.delete(key);
      }
    for (const [key, each] of now) this.#tell(key, each);
    this.#none.hidden = listed.length > 0;
    this.#drawKept(kept, new Set(all.map(({ id }) => id)));
  }

  /** @param {Running} running */
  #keyOf(running) {
    const known = this.#keys.get(running) ?? running.id ?? String((this.#count += 1));
    this.#keys.set(running, known);
    return known;
  }

  /**
   * @param {string} key
   * @param {Running} running
   */
  #tell(key, running) {
    const { name, seconds, share, said } = running;
    const row = this.#rows.get(key) ?? this.#rowOf(key, running);
    if (share === null) row.bar.removeAttribute("value");
    else row.bar.value = share;
    const cost = seconds === null ? "" : `about ${timeOf(1000 * seconds)} of a core in all`;
    row.said.textContent = [said, cost].filter(Boolean).join("; ");
    row.bar.setAttribute("aria-label", `Progress of ${name}`);
  }

  /**
   * @param {string} key
   * @param {Running} running
   */
  #rowOf(key, running) {
    const bar = h("progress", { max: 1 });
    const said = h("span", { className: "note" });
    const stop = button("Stop", () => running.stop(), { ariaLabel: `Stop ${running.name}` });
    const element = h("li", {}, h("span", { className: "name" }, running.name), bar, said, stop);
    this.#list.append(element);
    const row = { element, bar, said };
    this.#rows.set(key, row);
    return row;
  }

  /**
   * @param {Submitted[]} kept
   * @param {Set<string | null>} goingOn
   */
  #drawKept(kept, goingOn) {
    const all = kept
      .toReversed()
      .map((work) => ({ ...work, status: goingOn.has(work.id) ? "running" : (this.#ended[work.id] ?? "not known") }));
    const drawn = JSON.stringify(all);
    if (drawn === this.#drawnKept) return;
    this.#drawnKept = drawn;
    const rows = all.map((work) =>
      tableRow(
        work.name || work.kind,
        work.kind,
        new Date(work.at).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" }),
        work.status,
        inLine(
          button("Show", () => this.#act(() => this.onShow(work)), {
            ariaLabel: `Show ${work.name}`,
            disabled: work.status === GONE,
          }),
          button("Forget", () => this.store.forget(work.id), { ariaLabel: `Forget ${work.name}` }),
        ),
      ),
    );
    this.#kept.replaceChildren(
      rows.length
        ? table(["Name", "Kind", "Submitted", "State", ""], rows)
        : note("No job, sweep, study, search or population yet."),
    );
  }

  /** @param {() => unknown} work */
  async #act(work) {
    this.#wrong.textContent = "";
    try {
      await work();
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      this.#wrong.textContent = error.reason;
    }
  }

  /** @param {number} milliseconds */
  #askAfter(milliseconds) {
    clearTimeout(this.#asking);
    this.#asking = setTimeout(() => void this.#ask(), milliseconds);
  }

  /** Asks the service for submitted work of which this page does not hear, until all of it has ended. */
  async #ask() {
    const known = new Set(running().map(({ id }) => id));
    const unknown = this.#work.filter(({ id }) => !(id in this.#ended) && !known.has(id));
    for (const work of unknown) await this.#askFor(work);
    if (unknown.length) this.#soon();
    if (this.#work.some(({ id }) => !(id in this.#ended))) this.#askAfter(this.#place.hidden ? CLOSED : OPEN);
  }

  /** @param {Submitted} work */
  async #askFor(work) {
    const { id, name } = work;
    const address = addressOf(work);
    try {
      const state = await json(address, { quiet: true });
      if (hasEnded(state.status)) return this.#end(id, state.status);
      const { done = 0, total = 0, progress_percent: percent = null, estimate } = state;
      const share = percent !== null ? percent / 100 : total ? done / total : null;
      const said = percent !== null ? `${percent} %` : `${done} of ${total}`;
      const entry = this.#elsewhere.get(id);
      const news = { share, said, seconds: estimate?.seconds ?? null };
      const stop = () => void this.#act(() => request(`${address}/cancel`, { method: "POST" }));
      if (entry) Object.assign(entry, news);
      else this.#elsewhere.set(id, { name, id, since: performance.now() - MOMENT, ...news, stop });
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      if (["job_not_found", "study_not_found"].includes(error.problem.code ?? "")) this.#end(id, GONE);
    }
    return undefined;
  }
}
