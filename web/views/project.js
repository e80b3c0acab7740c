// @ts-check
// The project: its name, notes and kept designs, where it is kept, and what to do when somebody else has changed it.

import { button, byId, h, inLine, labelled, note, table, tableRow } from "../draw/dom.js";
import { save } from "../draw/download.js";
import { ProblemError } from "../state/api.js";
import { contentOf, fileOf, isName, LONGEST_NAME, NoProject, projectOf } from "../state/project.js";
import { add, change, ChangedMeanwhile, isShared, list, read, remove } from "../state/projects.js";
import { fileOfDesign } from "../state/tables.js";

/** @import { KeptDesign } from "../state/project.js" */
/** @import { Known, Listed } from "../state/projects.js" */
/** @import { Store } from "../state/store.js" */

const UNNAMED = "Project";

/** @type {(time: string) => string} */
const when = (time) => new Date(time).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });

/** The dialog of the project. */
export class Project {
  #dialog = byId("project-dialog", HTMLDialogElement);
  #opener = byId("project-button");
  #name = this.#line("name");
  #notes = h("textarea", { id: "project-notes", rows: 3, on: { input: () => this.#describe() } });
  #author = this.#line("author");
  #drawing = this.#line("drawing");
  #state = h("p", { className: "note", role: "status" });
  #wrong = h("p", { className: "field-error", role: "alert" });
  #conflict = h("div", { className: "conflict", hidden: true });
  #uncomputed = h("div", { hidden: true });
  #list = h("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: "Projects" });
  #file = h("input", { type: "file", id: "project-file", accept: ".json", hidden: true });

  /**
   * The project of `store`; `compute` computes a design and keeps it beside the live one.
   *
   * @param {Store} store
   * @param {(kept: KeptDesign) => Promise<unknown>} compute
   */
  constructor(store, compute) {
    this.store = store;
    this.compute = compute;
    store.onProject(() => this.#tell());
    this.#opener.addEventListener("click", () => void this.#show());
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

  /**
   * A line that is typed.
   *
   * @param {string} name
   */
  #line(name) {
    return h("input", {
      type: "text",
      id: `project-${name}`,
      maxLength: LONGEST_NAME,
      autocomplete: "off",
      on: { input: () => this.#describe() },
    });
  }

  #describe() {
    const [name, notes, author, drawing] = [this.#name, this.#notes, this.#author, this.#drawing].map(
      ({ value }) => value,
    );
    this.store.describe({ name, notes, author, drawing });
  }

  /** Shows the project as it is, and whether there is something to be saved. */
  #tell() {
    const { project, isSaved } = this.store;
    const { known } = project;
    /** @type {[{ value: string }, string][]} */
    const typed = [
      [this.#name, project.name],
      [this.#notes, project.notes],
      [this.#author, project.author],
      [this.#drawing, project.drawing],
    ];
    // Writing moves the mark of whoever types.
    for (const [input, value] of typed) if (input.value !== value) input.value = value;
    this.#opener.textContent = `${known?.name ?? UNNAMED}${known && !isSaved ? " *" : ""}`;
    this.#opener.title = known && !isSaved ? "The project has changes that are not saved" : "Projects";
    const place = known?.place === "browser" ? "in this browser" : "in the service";
    this.#state.textContent = !known
      ? "Not saved yet."
      : isSaved
        ? `Saved ${place}, ${when(known.updated_at)}.`
        : `Changed since it was saved ${place}, ${when(known.updated_at)}.`;
    this.#showWaiting();
  }

  async #show() {
    this.#wrong.textContent = "";
    const { name, known } = this.store.project;
    this.store.describe({ name: name || (known?.name ?? "") });
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
    const { name } = this.store.project;
    if (isName(name)) return name;
    this.#wrong.textContent = "Give the project a name.";
    this.#name.focus();
    return null;
  }

  async #save() {
    const name = this.#named();
    if (!name) return;
    const { document, project } = this.store;
    if (!project.known) return this.#saveAnew();
    try {
      this.#took(await change(project.known, name, document), document);
    } catch (error) {
      if (!(error instanceof ChangedMeanwhile)) throw error;
      return this.#offerBoth(project.known);
    }
    await this.#refresh();
  }

  async #saveAnew() {
    const name = this.#named();
    if (!name) return;
    const { document } = this.store;
    this.#took(await add(name, document), document);
    await this.#refresh();
  }

  /**
   * @param {Known} known
   * @param {object} saved
   */
  #took(known, saved) {
    this.#conflict.hidden = true;
    this.store.save(known, saved);
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
      const { document } = this.store;
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
    this.store.open(contentOf(found.document), found.known.name);
    this.#took(found.known, this.store.document);
    await this.#refresh();
  }

  #export() {
    const name = this.#named();
    if (!name) return;
    save(fileOfDesign(name, "project.json"), "application/json", fileOf(name, this.store.document));
  }

  async #import() {
    const file = this.#file.files?.[0];
    this.#file.value = "";
    if (!file) return;
    await this.#act(async () => {
      const { name, content } = projectOf(await file.text());
      this.store.unsave();
      this.store.open(content, name);
    });
  }

  /** The designs of an opened project that are not computed yet. */
  #showWaiting() {
    const { waiting } = this.store.project;
    this.#uncomputed.hidden = waiting.length === 0;
    this.#uncomputed.replaceChildren(
      note(`Kept designs that are not computed yet: ${waiting.map(({ name }) => name).join("; ")}.`),
      inLine(button("Compute them", () => this.#act(() => this.#compute()), { id: "project-compute" })),
    );
  }

  async #compute() {
    for (const next of this.store.project.waiting) {
      await this.compute(next);
      this.store.arrived(next);
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
    if (item.id === this.store.project.known?.id) this.store.unsave();
    await this.#refresh();
  }
}
