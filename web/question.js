// What the panels share that ask for many designs: one question at a time, how far it is, why it was refused, and of which design its answer is.

import { follow, hasEnded, json, post, ProblemError, request } from "./api.js";
import { h } from "./dom.js";
import { outdated } from "./outdated.js";

export class Question {
  #cancel = () => {};

  /** A question about `design`: its button says `words`, and `id` begins what its parts are called; `inWords` puts what the service says into the words of the page; answers do not depend on the fields `ignored`. */
  constructor(design, { id, words, inWords = (detail) => detail, ignored = [] }) {
    this.inWords = inWords;
    this.run = h("button", { type: "submit", id: `${id}-run`, className: "primary" }, words);
    this.cancel = h("button", { type: "button", hidden: true, on: { click: () => this.#cancel() } }, "Cancel");
    this.state = h("p", { className: "note", role: "status", id: `${id}-state` });
    this.of = outdated(design, ignored);
  }

  say(words) {
    this.state.textContent = words;
  }

  refuse(...details) {
    this.state.replaceChildren(...details.map((detail) => h("span", { className: "field-error" }, this.inWords(detail), " ")));
  }

  /** Does `work`, which is given what tells how to cancel it; nothing else is asked meanwhile, and a refusal is told. */
  async ask(work) {
    this.run.disabled = true;
    this.of.renew();
    try {
      await work((cancel) => {
        this.#cancel = cancel;
        this.cancel.hidden = false;
      });
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      this.refuse(...(error.problem.errors?.length ? error.problem.errors.map(({ detail }) => detail) : [error.message]));
    } finally {
      this.run.disabled = false;
      this.cancel.hidden = true;
    }
  }

  /**
   * Asks for the study `asked` and shows it as its events tell of it: `show` is given what `part` of it tells, once in `pause` milliseconds at most, and its
   * address; `progress` says how far it is of `done`, `total` and when it began, `ended` how it ended.
   */
  study(asked, { part = "", pause, progress, show, ended }) {
    return this.ask(async (cancelling) => {
      const made = await post("v1/studies", asked);
      const address = `v1/studies/${made.id}`;
      cancelling(() => request(`${address}/cancel`, { method: "POST" }).catch(() => {}));
      const begun = performance.now();
      let [shown, whole] = [begun, false];
      const told = (event, { done, total }) => {
        if (event === "away") this.say("The service does not answer; it is asked again until it does.");
        if (total) this.say(progress(done, total, begun));
        if (performance.now() - shown < pause) return;
        shown = performance.now();
        json(address + part).then((found) => whole || show(found, address), () => {});
      };
      if (!hasEnded(made.status)) await follow(address, told);
      const found = await json(address + part);
      whole = true;
      show(found, address);
      this.say(ended(found));
    });
  }
}
