// @ts-check
// The project: its name, notes and kept designs, where it is kept, and what to do when somebody else has changed it.

import { button, byId, h, inLine, labelled, note, table, tableRow } from "../draw/dom.js";
import { save } from "../draw/download.js";
import { ProblemError } from "../state/api.js";
import { same } from "../state/design.js";
import {
  contentOf,
  documentOf,
  fileOf,
  isName,
  LONGEST_NAME,
  MOST_WORK,
  NoProject,
  projectOf,
} from "../state/project.js";
import { add, change, ChangedMeanwhile, isShared, list, read, remove } from "../state/projects.js";
import { fileOfDesign } from "../state/tables.js";
import { onSubmitted } from "../state/work.js";

/** @import { Design } from "../state/design.js" */
/** @import { Content, KeptDesign, RememberedProject } from "../state/project.js" */
/** @import { Known, Listed } from "../state/projects.js" */
/** @import { Submitted } from "../state/work.js" */

const UNNAMED = "Project";

/**
 * @typedef {object} Around
 * @property {() => void} onChange is called when what is remembered has changed
 * @property {() => void} onWork is called when the submitted work is another one
 * @property {(kept: KeptDesign) => Promise<unknown>} compute computes a design and keeps it beside the live one
 */

/** @type {(time: string) => string} */
const when = (time) => new Date(time).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });

export class Project {
  /** @type {Known | null} */
  #known = null;
  /** @type {object | null} */
  #saved = null;
  /** @type {KeptDesign[]} */
  #waiting = [];
  /** @type {Submitted[]} */
  #work = [];
  #dialog = byId("project-dialog", HTMLDialogElement);
  #opener = byId("project-button");
  #name = h("input", { type: "text", id: "project-name", maxLength: LONGEST_NAME, autocomplete: "off" });
  #notes = h("textarea", { id: "project-notes", rows: 3, on: { input: () => this.changed() } });
  #author = this.#line("author");
  #drawing = this.#line("drawing");
  #state = h("p", { className: "note", role: "status" });
  #wrong = h("p", { className: "field-error", role: "alert" });
  #conflict = h("div", { className: "conflict", hidden: true });
  #uncomputed = h("div", { hidden: true });
  #list = h("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: "Projects" });
  #file = h("input", { type: "file", id: "project-file", accept: ".json", hidden: true });

  /**
   * @param {Design} design
   * @param {Around} around
   */
  constructor(design, { onChange, onWork, compute }) {
    this.design = design;
    this.onChange = onChange;
    this.onWork = onWork;
    onSubmitted((work) => this.#setWork([...this.#work, work].slice(-MOST_WORK)));
    this.compute = compute;
    this.#opener.addEventListener("click", () => void this.#show());
    this.#name.addEventListener("input", () => this.changed());
    this.#file.addEventListener("change", () => void this.#import());
    this.#dialog.append(
      h("h2", { id: "project-title" }, "Project"),
      inLine(...labelled("Name", this.#name)),
      inLine(...labelled("Author", this.#author), ...labelled("Drawing number", this.#drawing)),
      inLine(...labelled("Notes", this.#notes)),
      inLine(
        button("Save", () => this.#act(() => this.#save()), { className: "primary", id: "project-save" }),
        button("Save as a new project", () => this.#act(() => this.#saveAnew()), { id: "project-save-as" }),
        button("Export a file", () => this.#act(() => this.#export()), { id: "project-export" }),
        button("Import a file", () => this.#file.click(), { id: "project-import" }),
        this.#file,
      ),
      this.#state,
      this.#wrong,
      this.#conflict,
      this.#uncomputed,
      this.#list,
      h(
        "div",
        { className: "buttons" },
        button("Close", () => this.#dialog.close()),
      ),
    );
  }

  /** @returns {RememberedProject} */
  get state() {
    return {
      known: this.#known,
      notes: this.#notes.value,
      author: this.#author.value,
      drawing: this.#drawing.value,
      work: this.#work,
      waiting: this.#waiting,
      saved: this.#saved,
    };
  }

  /** The words of the title block of a report. */
  get title() {
    return {
      name: this.#known?.name ?? this.#name.value,
      author: this.#author.value,
      drawing: this.#drawing.value,
      notes: this.#notes.value,
    };
  }

  /**
   * A line that is typed for the title block.
   *
   * @param {string} name
   */
  #line(name) {
    return h("input", {
      type: "text",
      id: `project-${name}`,
      maxLength: LONGEST_NAME,
      autocomplete: "off",
      on: { input: () => this.changed() },
    });
  }

  /** The jobs and studies that were submitted for the project, the oldest first. */
  get work() {
    return this.#work;
  }

  /** @param {Submitted[]} work */
  #setWork(work) {
    this.#work = work;
    this.changed();
    this.onWork();
  }

  /**
   * The project keeps this job or study no more; the service does.
   *
   * @param {string} id
   */
  forget(id) {
    this.#setWork(this.#work.filter((each) => each.id !== id));
  }

  /** @param {RememberedProject} remembered */
  restore({ known, notes, author = "", drawing = "", work = [], waiting, saved }) {
    [this.#known, this.#waiting, this.#saved] = [known, waiting, saved];
    this.#type({ notes, author, drawing });
    this.#name.value = known?.name ?? "";
    this.#setWork(work);
  }

  /** @param {{ notes: string, author: string, drawing: string }} words */
  #type({ notes, author, drawing }) {
    [this.#notes.value, this.#author.value, this.#drawing.value] = [notes, author, drawing];
  }

  /** Says whether there is something to be saved. */
  changed() {
    const isSaved = this.#isSaved();
    this.#opener.textContent = `${this.#known?.name ?? UNNAMED}${this.#known && !isSaved ? " *" : ""}`;
    this.#opener.title = this.#known && !isSaved ? "The project has changes that are not saved" : "Projects";
    const place = this.#known?.place === "browser" ? "in this browser" : "in the service";
    this.#state.textContent = !this.#known
      ? "Not saved yet."
      : isSaved
        ? `Saved ${place}, ${when(this.#known.updated_at)}.`
        : `Changed since it was saved ${place}, ${when(this.#known.updated_at)}.`;
    this.#showWaiting();
    this.onChange();
  }

  #isSaved() {
    return this.#known?.name === this.#name.value && same(this.#saved, this.#document());
  }

  #document() {
    const { submission, typed, kept } = this.design;
    return documentOf({
      submission,
      typed,
      kept: [...kept, ...this.#waiting],
      work: this.#work,
      notes: this.#notes.value,
      author: this.#author.value,
      drawing: this.#drawing.value,
    });
  }

  async #show() {
    this.#wrong.textContent = "";
    if (!this.#name.value) this.#name.value = this.#known?.name ?? "";
    this.changed();
    this.#dialog.showModal();
    await this.#act(() => this.#refresh());
  }

  /**
   * Does `work`, and says what is wrong with it.
   *
   * @param {() => unknown} work
   */
  async #act(work) {
    this.#wrong.textContent = "";
    try {
      await work();
    } catch (error) {
      if (error instanceof ProblemError) this.#wrong.textContent = error.reason;
      else if (error instanceof NoProject) this.#wrong.textContent = error.message;
      else throw error;
    }
  }

  /** The name that was typed; null, with the reason said, where it is none. */
  #named() {
    const name = this.#name.value;
    if (isName(name)) return name;
    this.#wrong.textContent = "Give the project a name.";
    this.#name.focus();
    return null;
  }

  async #save() {
    const name = this.#named();
    if (!name) return;
    if (!this.#known) return this.#saveAnew();
    const document = this.#document();
    try {
      this.#took(await change(this.#known, name, document), document);
    } catch (error) {
      if (!(error instanceof ChangedMeanwhile)) throw error;
      return this.#offerBoth(this.#known);
    }
    await this.#refresh();
  }

  async #saveAnew() {
    const name = this.#named();
    if (!name) return;
    const document = this.#document();
    this.#took(await add(name, document), document);
    await this.#refresh();
  }

  /**
   * @param {Known} known
   * @param {object} saved
   */
  #took(known, saved) {
    [this.#known, this.#saved] = [known, saved];
    this.#name.value = known.name;
    this.#conflict.hidden = true;
    this.changed();
  }

  /**
   * Offers both versions: that of somebody else, and the one on this page.
   *
   * @param {Known} mine
   */
  async #offerBoth(mine) {
    const theirs = await read(mine);
    const words = theirs
      ? `Somebody else saved this project as “${theirs.known.name}”, ${when(theirs.known.updated_at)}. Nothing was overwritten.`
      : "Somebody else deleted this project.";
    const keepMine = async () => {
      const document = this.#document();
      const name = this.#named();
      if (!name || !theirs) return;
      try {
        this.#took(await change(theirs.known, name, document), document);
      } catch (error) {
        if (!(error instanceof ChangedMeanwhile)) throw error;
        return this.#offerBoth(mine);
      }
      await this.#refresh();
    };
    this.#conflict.replaceChildren(
      note(words),
      inLine(
        ...(theirs
          ? [
              button("Open theirs", () => this.#act(() => this.#open(theirs.known)), { id: "project-theirs" }),
              button("Overwrite it with mine", () => this.#act(keepMine), { id: "project-mine" }),
            ]
          : []),
        button("Keep mine as a new project", () => this.#act(() => this.#saveAnew()), { id: "project-both" }),
      ),
    );
    this.#conflict.hidden = false;
  }

  /** @param {{ id: string, place: "service" | "browser" }} listed */
  async #open(listed) {
    const found = await read(listed);
    if (!found) {
      this.#wrong.textContent = "This project was deleted.";
      return this.#refresh();
    }
    this.#take(contentOf(found.document), found.known.name);
    this.#took(found.known, this.#document());
    await this.#refresh();
  }

  /**
   * Puts a content in place of what is worked on. The way back leads to that.
   *
   * @param {Content} content
   * @param {string} name
   */
  #take({ submission, typed, kept, work, ...words }, name) {
    this.#work = work;
    this.#waiting = kept;
    this.#type(words);
    this.#name.value = name;
    this.design.begin({ submission, typed, kept: [] });
    this.onWork();
  }

  #export() {
    const name = this.#named();
    if (!name) return;
    save(fileOfDesign(name, "project.json"), "application/json", fileOf(name, this.#document()));
  }

  async #import() {
    const file = this.#file.files?.[0];
    this.#file.value = "";
    if (!file) return;
    await this.#act(async () => {
      const { name, content } = projectOf(await file.text());
      [this.#known, this.#saved] = [null, null];
      this.#take(content, name);
      this.changed();
    });
  }

  /** The designs of an opened project that are not computed yet. */
  #showWaiting() {
    this.#uncomputed.hidden = this.#waiting.length === 0;
    this.#uncomputed.replaceChildren(
      note(`Kept designs that are not computed yet: ${this.#waiting.map(({ name }) => name).join("; ")}.`),
      inLine(button("Compute them", () => this.#act(() => this.#compute()), { id: "project-compute" })),
    );
  }

  async #compute() {
    while (this.#waiting.length) {
      const [next] = this.#waiting;
      await this.compute(next);
      this.#waiting = this.#waiting.filter((each) => each !== next);
      this.changed();
    }
  }

  async #refresh() {
    const { items, refused } = await list();
    const where = refused
      ? "The key does not open the projects of the service; what is saved stays in this browser."
      : isShared()
        ? "This service asks for no key: all who call it share its projects."
        : "";
    /** @type {(item: Listed) => HTMLTableRowElement} */
    const row = (item) =>
      tableRow(
        item.name,
        when(item.updated_at),
        item.place === "browser" ? "this browser" : "service",
        `${Math.max(1, Math.round(item.bytes / 1e3))} kB`,
        inLine(
          button("Open", () => this.#act(() => this.#open(item)), { ariaLabel: `Open ${item.name}` }),
          button("Delete", () => this.#act(() => this.#delete(item)), { ariaLabel: `Delete ${item.name}` }),
        ),
      );
    const rows = items.map(row);
    this.#list.replaceChildren(
      ...(where ? [note(where)] : []),
      rows.length ? table(["Name", "Saved", "Where", "Size", ""], rows) : note("There are no projects yet."),
    );
  }

  /** @param {Listed} item */
  async #delete(item) {
    if (!confirm(`Delete the project “${item.name}”? There is no way back.`)) return;
    await remove(item);
    if (item.id === this.#known?.id) {
      [this.#known, this.#saved] = [null, null];
      this.changed();
    }
    await this.#refresh();
  }
}
